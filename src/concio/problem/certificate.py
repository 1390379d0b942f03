r"""The certificate: residuals of an answer computed from the original data, never from what a solver kept.

Errors are measured in units of what they belong to (:mod:`concio.problem.error_units`): forces by the total load ``F``
of their connected part, gaps and slips by its largest displacement ``U``, or by what the compliance of the pair makes
of F where that is less. No length stands for a displacement where nothing moves. An answer is *certified* when the
worst entry, over all parts, is at most 1e-9.

Equilibrium is checked in two parts. The resultants on every floating body are sums of loads and contact forces alone:
displacements have no part in them and rounding hardly any. What is left is the balance at each node, where K u is the
difference of large numbers if a stiff body rests on soft joints: u, stored in double precision, is known to some
eps |u|, so that K u is known to eps |K| |u| and no better, whoever solves. :data:`BALANCE_ROUNDING` of that is granted,
but never more than :data:`GRANTED` of the load: beyond, rounding could hide how a joint shares its force.

Friction is measured by its natural map. In the plane, for forces inside the cone, that is
min(|y_t| / U, |t_t + (c + mu t_n) sign y_t| / F), U being that of the pair. In space the second of these would ask for
the direction of a slip, which rounding of u leaves uncertain by eps U / |y_t|: exact answers would seem wrong by 1e-9
where a pair hardly slips.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.error_units import in_units, measure, rounding
from concio.problem.products import largest_of_columns, product, product_of_sizes, transposed_product
from concio.problem.tolerances import BALANCE_ROUNDING, CERTIFIED, GRANTED
from concio.read_only import read_only
from concio.representation import short_repr


@dataclass(frozen=True)
class Certificate:
    """Relative residuals of an answer (all dimensionless, 0 is perfect).

    Parameters
    ----------
    equilibrium : float
        max |K u - f - C' t| / F, equation (12), apart from rounding of u; and of the resultants of f + C' t on bodies
        that float, moments divided by the distance of the farthest node.
    penetration : float
        max of -y_n / U over pairs without a cap, equation (5), apart from rounding of y, here and below.
    cone : float
        max of the excess of |t_t| over c + mu t_n, of -(t_n + T), and of t_n over the cap, / F, equation (6).
    slip_direction : float
        max over pairs of |t_t - P(t_t - (F/U) y_t)| / F, equations (6, 7): P projects onto the disc of radius
        c + mu t_n, and friction is what it should be exactly where this is zero.
    complementarity : float
        max over pairs of min(y_n / U, (t_n + T) / F), and the same for crushing and its cap, equation (5).
    """

    equilibrium: float
    penetration: float
    cone: float
    slip_direction: float
    complementarity: float

    @property
    def worst(self) -> float:
        """The largest of the five; ``nan`` counts as infinite."""
        entries = (self.equilibrium, self.penetration, self.cone, self.slip_direction, self.complementarity)
        return float(max(e if np.isfinite(e) else np.inf for e in entries))

    @property
    def certified(self) -> bool:
        """True when the worst entry is at most :data:`CERTIFIED`."""
        return self.worst <= CERTIFIED

    def as_dict(self) -> dict[str, float]:
        """Return the five entries and ``worst``."""
        return {**asdict(self), "worst": self.worst}


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Kinematics:
    """Gap, slip and crushing that follow from displacements and forces.

    Parameters
    ----------
    gap : (m,) array
        y_n before crushing is taken out [m]; below -0 only by an error, or where the cap is reached.
    slip : (m, d-1) array
        y_t [m].
    crushing : (m,) array
        p >= 0, plastic approach where the cap is reached [m].
    """

    gap: Array
    slip: Array
    crushing: Array


def kinematics(problem: ContactProblem, u: Array, t_n: Array, t_t: Array) -> Kinematics:
    """Return gaps, slips and crushing of displacements ``u`` (N,) and forces ``t_n`` (m,), ``t_t`` (m, d-1)."""
    law = problem.laws
    m = problem.pairs
    slip = product(problem.C_t, u).reshape(m, problem.dim - 1) - problem.slip_origin
    slip += law.tangential_compliance[:, None] * t_t
    dilated = np.where(problem.cone.rough, law.dilatancy * np.linalg.norm(slip, axis=1), 0.0)
    gap = problem.gap + product(problem.C_n, u) + law.normal_compliance * t_n - dilated
    crushing = np.where(problem.cone.capped, np.maximum(-gap, 0.0), 0.0)
    return Kinematics(gap + crushing, slip, crushing)


def imbalance(problem: ContactProblem, u: Array, t_n: Array, t_t: Array, force: Array) -> tuple[Array, Array]:
    """Return what equation (12) leaves [kN]: resultants of floating bodies (r,), and the rest at every unknown (N,).

    The first is R'(f + C' t), a force, or a moment over the distance of the farthest node; the second the size of what
    K u does not balance, less what rounding of u explains, at most :data:`GRANTED` of ``force`` (N,) [kN].
    """
    applied = problem.f + transposed_product(problem.C_n, t_n) + transposed_product(problem.C_t, t_t.ravel())
    R = problem.R
    moved = transposed_product(R, applied)
    rest = product(problem.K, u) - (applied - product(R, moved))
    rest = rest - product(R, transposed_product(R, rest))
    known = np.minimum(BALANCE_ROUNDING * product_of_sizes(problem.K, np.abs(u)), GRANTED * force)
    return moved / largest_of_columns(R), np.maximum(np.abs(rest) - known, 0.0)


def certify(
    problem: ContactProblem,
    u: Array,
    t_n: Array,
    t_t: Array,
    *,
    total_load: float | None = None,
    moved: Array | float = 0.0,
) -> Certificate:
    """Compute the certificate of an answer from the original problem.

    Parameters
    ----------
    problem : ContactProblem
    u : (N,) array
        Displacements [m].
    t_n : (m,) array
        Normal forces, compression positive [kN].
    t_t : (m, d-1) array
        Friction forces on side b along t [kN].
    total_load : float, optional
        F to measure forces of every part by, where the problem's own loads are not the measure [kN].
    moved : (m,) array or float
        How far obstacles, or the edges of a periodic cell, have moved at each pair: U is not less [m].
    """
    cone = problem.cone
    t_t = t_t.reshape(problem.pairs, problem.dim - 1)
    if not (np.isfinite(u).all() and np.isfinite(t_n).all() and np.isfinite(t_t).all()):
        return Certificate(*([np.inf] * 5))
    units = measure(problem, u, t_n, t_t, total_load=total_load, moved=moved)
    force, node_force = units.pair_force, units.node_force
    kin, known = kinematics(problem, u, t_n, t_t), rounding(problem, u, t_n, t_t, units)
    resultants, rest = imbalance(problem, u, t_n, t_t, node_force)
    shares = (np.abs(resultants) / node_force[first_unknowns(problem)], rest / node_force)
    length, along = (units.length_of(a) for a in (problem.laws.normal_compliance, problem.laws.tangential_compliance))
    gap = np.sign(kin.gap) * np.maximum(np.abs(kin.gap) - known[0], 0.0)
    crushing = np.maximum(kin.crushing - known[0], 0.0)
    size = np.linalg.norm(kin.slip, axis=1)
    left = np.maximum(size - known[1], 0.0)
    slip = kin.slip * (in_units(left, along) / np.where(size > 0, size, 1.0))[:, None]
    shifted = (t_n + cone.tension) / force
    trial = t_t - force[:, None] * slip
    size = np.linalg.norm(trial, axis=1)
    inside = np.minimum(1.0, cone.strength(t_n) / np.where(size > 0, size, 1.0))
    wrong_way = np.linalg.norm(t_t - inside[:, None] * trial, axis=1)
    crush = np.minimum(in_units(crushing, length), np.where(cone.capped, cone.cap - t_n, 0.0) / force)
    opened = np.minimum(in_units(gap, length), shifted)
    return Certificate(
        equilibrium=max(float(share.max(initial=0.0)) for share in shares),
        penetration=float(in_units(np.maximum(-gap, 0.0), length).max(initial=0.0)),
        cone=float((cone.excess(t_n, t_t) / force).max(initial=0.0)),
        slip_direction=float((wrong_way / force).max(initial=0.0)),
        complementarity=float(max(opened.max(initial=0.0), crush.max(initial=0.0))),
    )


def first_unknowns(problem: ContactProblem) -> Array:
    """Return an unknown that each rigid motion moves (r,)."""
    R = problem.R if problem.R.format == "csc" else sp.csc_array(problem.R)
    found: Array = R.indices[R.indptr[:-1]]
    return found
