r"""Homogenised moduli of a periodic cell: the linear response while no joint changes its state.

Unit macroscopic strains are imposed one by one with every joint in its state; the macroscopic stresses that answer are
the columns of the matrix A,

.. math:: (\Sigma_{xx}, \Sigma_{yy}, \Sigma_{xy}) = A\,(E_{xx}, E_{yy}, \Gamma_{xy}), \qquad \Gamma_{xy} = 2 E_{xy}.

With all joints closed (the default) A is symmetric. It holds as long as all joints stay closed and none slips: a
polyhedron of stresses, which comes with the moduli. Unilateral joints without tensile strength still have moduli, but
in compression only.

What is shown has been checked from the original equations: balance at every node, joints that keep their states, the
macroscopic stress a symmetric tensor (turning moments of the contact forces cancel), the energy stored in bodies and
joints equal to the work of the macroscopic stress, and the mean of the stresses in the bodies equal to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.cells.tensors import rotation
from concio.analysis.entry_point import entry_point
from concio.analysis.stress import Stress
from concio.arguments import strict
from concio.contact.assembly import Assembly
from concio.contact.macroscopic_strain import COMPONENTS, STRAINS
from concio.errors import InputError, SolverError
from concio.model.model import Model
from concio.problem.certificate import imbalance
from concio.problem.contact_problem import ContactProblem
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import CHECKED, CONTRADICTION
from concio.read_only import read_only
from concio.representation import short_repr
from concio.solvers.path.path_state import CLOSED, OPEN, STICK, LinearPath
from concio.solvers.path.state_rates import state_rates
from concio.verdict.cell_verdict import cell_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.cell_accessor import ModuliPlots

Array = np.ndarray


@short_repr
@dataclass(frozen=True)
class ModuliCertificate:
    """Residuals of moduli, recomputed from the original equations, relative and dimensionless.

    Parameters
    ----------
    equilibrium : float
        Largest unbalanced force at any unknown, over the largest contact force.
    states : float
        Largest opening or slip of a joint that is closed or sticks, over the largest displacement.
    turning : float
        Difference of the stresses xy and yx, over the largest stress.
    symmetry : float
        Largest difference of A and its transpose, over the largest modulus; 0 where joints slip, for there A need not
        be symmetric.
    energy : float
        Difference of the energy stored and dissipated and the work of the stress, over the latter.
    mean_stress : float
        Difference of the mean stress of the bodies and the macroscopic one, over the largest; 0 where a body is rigid
        and has no stress.
    """

    equilibrium: float
    states: float
    turning: float
    symmetry: float
    energy: float
    mean_stress: float

    @property
    def worst(self) -> float:
        """The largest of all; ``nan`` counts as infinite."""
        entries = (self.equilibrium, self.states, self.turning, self.symmetry, self.energy, self.mean_stress)
        return float(max(e if np.isfinite(e) else np.inf for e in entries))

    @property
    def certified(self) -> bool:
        """True when the worst entry is at most :data:`concio.problem.tolerances.CHECKED`."""
        return self.worst <= CHECKED


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Moduli(Shown):
    """Homogenised moduli, with the states of the joints for which they hold.

    Parameters
    ----------
    cell : PeriodicCell
    matrix : (3, 3) array
        A: stresses xx, yy, xy by strains xx, yy and engineering shear xy [kN/m2].
    contact, sliding : (m,) integer arrays
        States of the contact pairs, as in :class:`concio.solvers.path.path_state.PathState`.
    normal_force, friction_force : (m, 3) arrays
        Forces of the pairs under unit strains [kN].
    displacement : (N, 3) array
        Displacements of the free unknowns under unit strains [m].
    certificate : ModuliCertificate
    """

    cell: PeriodicCell
    matrix: Array
    contact: Array
    sliding: Array
    normal_force: Array
    friction_force: Array
    displacement: Array
    certificate: ModuliCertificate

    @property
    def verdict(self) -> Verdict:
        """What the moduli hold for, and what proves them."""
        return cell_verdict(self.cell, self, None, None)

    @property
    def closed(self) -> bool:
        """Whether all joints are closed and none slips."""
        return bool((self.contact == CLOSED).all() and (self.sliding == STICK).all())

    @property
    def states(self) -> str:
        """The states of the joints in words."""
        if self.closed:
            return "all joints closed, none slips"
        open_, slips = self.contact == OPEN, (self.contact != OPEN) & (self.sliding != STICK)
        return f"{open_.sum()} of {open_.size} contact pairs open, {slips.sum()} slip, the others are closed and stick"

    def uniaxial(self, axis: int, angle: float = 0.0) -> tuple[float, float, float]:
        """Return (modulus, Poisson's ratio, shear for each unit of strain) under stress along one axis alone.

        Parameters
        ----------
        axis : {0, 1, 2}
            Stress xx, yy or (pure shear) xy.
        angle : float
            Of the axes x, y against those of the cell, anticlockwise [rad].
        """
        A = self.rotated(angle)
        others = [k for k in range(3) if k != axis]
        rest = -np.linalg.pinv(A[np.ix_(others, others)], rcond=1e-12) @ A[others, axis]
        modulus = float(A[axis, axis] + A[axis, others] @ rest)
        strain = dict(zip(others, rest, strict=True))
        across = 1 if axis == 0 else 0
        return modulus, -float(strain[across]), float(strain.get(2, 0.0))

    def rotated(self, angle: float) -> Array:
        """Return the matrix (3, 3) in axes turned anticlockwise by ``angle`` [rad].

        Examples
        --------
        Axes turned by a right angle change the places of the two directions:

        >>> import concio
        >>> import math
        >>> law = concio.JointLaw(0.6, normal_stiffness=10e6, tangential_stiffness=4e6)
        >>> moduli = concio.homogenise(concio.cell(bond="stack", block_size=(0.2, 0.1), friction=law))
        >>> turned = moduli.rotated(math.pi / 2)
        >>> bool(abs(turned[0, 0] / moduli.matrix[1, 1] - 1.0) < 1e-9)
        True
        """
        T = rotation(angle)
        return np.asarray(T @ self.matrix @ T.T)

    @property
    def E_x(self) -> float:
        """Young's modulus along x, stress along x alone [kN/m2]."""
        return self.uniaxial(0)[0]

    @property
    def E_y(self) -> float:
        """Young's modulus along y [kN/m2]."""
        return self.uniaxial(1)[0]

    @property
    def G_xy(self) -> float:
        """Shear modulus, shear stress alone [kN/m2]."""
        return self.uniaxial(2)[0]

    @property
    def nu_xy(self) -> float:
        """Contraction along y for each unit of strain along x, under stress along x."""
        return self.uniaxial(0)[1]

    @property
    def nu_yx(self) -> float:
        """Contraction along x for each unit of strain along y, under stress along y."""
        return self.uniaxial(1)[1]

    @cached_property
    def holds(self) -> HalfSpaces | None:
        """Stresses under which all joints stay closed and none slips; None where the matrix is singular.

        Only for the moduli of closed joints without initial gaps. At corners where joints share a force their shares
        are those of least norm.
        """
        if not self.closed or np.linalg.cond(self.matrix) > 1e12:
            return None
        problem = self.cell.problem()
        law, C, area = problem.laws, np.linalg.inv(self.matrix), problem.area
        n, t = (forces @ C / area[:, None] for forces in (self.normal_force, self.friction_force))
        mu, tension, cohesion, cap = law.friction[:, None], law.tension / area, law.cohesion / area, law.cap / area
        rows, room = np.vstack([-n, t - mu * n, -t - mu * n]), np.concatenate([tension, cohesion, cohesion])
        capped = np.isfinite(cap)
        return HalfSpaces.of(np.vstack([rows, n[capped]]), np.concatenate([room, cap[capped]]))

    def stress(self, strain: Array) -> Array:
        """Return the macroscopic stress (3,) of a strain (3,) [kN/m2]."""
        found: Array = self.matrix @ np.asarray(strain, dtype=float)
        return found

    @property
    def plot(self) -> ModuliPlots:
        """Figures by name; matplotlib is loaded here."""
        plots: ModuliPlots = view(self, "plot")
        return plots

    def summary(self) -> dict[str, Any]:
        """Return the numbers as plain types, kN and m."""
        faces = self.holds.reduced() if self.holds is not None else None
        return {
            "title": self.cell.model.title,
            "periods": self.cell.periods.tolist(),
            "components": list(COMPONENTS),
            "matrix": self.matrix.tolist(),
            "E_x": self.E_x,
            "E_y": self.E_y,
            "G_xy": self.G_xy,
            "nu_xy": self.nu_xy,
            "nu_yx": self.nu_yx,
            "states": self.states,
            "holds": None if faces is None else _table(faces),
            "certificate": {**vars(self.certificate), "worst": self.certificate.worst},
        }


def _table(faces: HalfSpaces) -> list[dict[str, Any]]:
    return [{"normal": n.tolist(), "offset": float(h)} for n, h in zip(faces.normals, faces.offsets, strict=True)]


@strict
@entry_point
def homogenise(
    cell: Model | Assembly | PeriodicCell, *, contact: Array | None = None, sliding: Array | None = None
) -> Moduli:
    """Return the homogenised moduli of a periodic cell.

    Parameters
    ----------
    cell : Model or Assembly
        With periods.
    contact, sliding : (m,) integer arrays, optional
        States of the contact pairs; by default all are closed and none slips. :meth:`CellPath.moduli` takes those of a
        point of a path.

    Raises
    ------
    InputError
        The model is not a cell, or its joints allow no strain (rigid blocks on hard joints).
    SolverError
        The answer does not stand up to its check.

    Examples
    --------
    Vertically, blocks of 1 GPa and 0.1 m height and bed joints of 10 GPa/m are springs in series:

    >>> import concio
    >>> law = concio.JointLaw(0.6, normal_stiffness=10e6, tangential_stiffness=4e6)
    >>> cell = concio.cell(bond="stack", block_size=(0.2, 0.1), friction=law, block=concio.Elastic(E=1e6, nu=0.0))
    >>> moduli = concio.homogenise(cell)
    >>> round(float(moduli.E_y), 3), round(1 / (1 / 1e6 + 1 / (10e6 * 0.1)), 3)
    (500000.0, 500000.0)
    """
    own = PeriodicCell.of(cell)
    problem = own.problem(free=(False,) * 3)
    m = problem.pairs
    contact = np.full(m, CLOSED, dtype=np.int8) if contact is None else _states(contact, m, (0, 1, 2), "contact")
    sliding = np.full(m, STICK, dtype=np.int8) if sliding is None else _states(sliding, m, (-1, 0, 1), "sliding")
    normal, tangential = own.columns
    u, t_n, t_t = np.zeros((problem.unknowns, 3)), np.zeros((m, 3)), np.zeros((m, 3))
    nothing = np.zeros(problem.unknowns)
    for k, name in enumerate(STRAINS):
        path = LinearPath(problem, nothing, normal[:, k], tangential[:, k, None])
        found = state_rates(path, PairStates.plane(contact, sliding))
        if found.residual > CONTRADICTION:
            msg = f"the joints allow no {name}: rigid blocks on hard joints do not deform, and have no moduli"
            raise InputError(msg, hint="give the joints stiffness, or make the blocks elastic")
        u[:, k], t_n[:, k], t_t[:, k] = found.displacement, found.normal_force, found.friction_force[:, 0]
    matrix = own.stress(t_n, t_t)
    certificate = _certify(own, problem, matrix, u, t_n, t_t, contact, sliding)
    if not certificate.certified:
        msg = f"the moduli do not stand up to their check: {certificate}"
        raise SolverError(msg, hint="change the units or the scale of the cell; otherwise this is a bug in concio")
    return Moduli(own, matrix, contact, sliding, t_n, t_t, u, certificate)


def _states(given: Array, m: int, allowed: tuple[int, ...], name: str) -> Array:
    found = np.asarray(given)
    if found.shape != (m,) or not np.isin(found, allowed).all():
        msg = f"{name} must hold one of {allowed} for each of {m} contact pairs"
        raise InputError(msg)
    return found.astype(np.int8)


def _certify(
    cell: PeriodicCell,
    problem: ContactProblem,
    matrix: Array,
    u: Array,
    t_n: Array,
    t_t: Array,
    contact: Array,
    sliding: Array,
) -> ModuliCertificate:
    """Return the certificate of displacements (N, 3) and forces (m, 3) under unit strains."""
    law = problem.laws
    normal, tangential = cell.columns
    opening = problem.C_n @ u + normal + law.normal_compliance[:, None] * t_n
    slip = problem.C_t @ u + tangential + law.tangential_compliance[:, None] * t_t
    force = float(max(np.abs(t_n).max(), np.abs(t_t).max())) or 1.0
    largest = float(np.abs(matrix).max()) or 1.0
    unbalanced = 0.0
    for k in range(3):
        loaded = problem.with_loads(np.zeros(problem.unknowns))
        rigid, rest = imbalance(loaded, u[:, k], t_n[:, k], t_t[:, k], np.full(problem.unknowns, force))
        unbalanced = max(unbalanced, float(np.abs(rigid).max(initial=0.0)), float(rest.max(initial=0.0)))
    tilted = opening - (law.dilatancy * sliding)[:, None] * slip
    kept = np.maximum(np.abs(tilted).max(1) * (contact == CLOSED), np.abs(slip).max(1) * (sliding == STICK))
    stored = np.einsum("ik,ik->k", u, problem.K @ u)
    stored += law.normal_compliance @ t_n**2 + law.tangential_compliance @ t_t**2
    lost = -np.einsum("ik,ik->k", t_n, opening) - np.einsum("ik,ik->k", t_t, slip)
    work = np.diag(matrix) * cell.volume
    sliding_pairs = bool((sliding != STICK).any())
    return ModuliCertificate(
        equilibrium=unbalanced / force,
        states=float(kept.max(initial=0.0)) / (float(np.abs(u).max(initial=0.0)) or cell.size),
        turning=max(abs(cell.turning(t_n[:, k], t_t[:, k])) for k in range(3)) / largest,
        symmetry=0.0 if sliding_pairs else float(np.abs(matrix - matrix.T).max()) / largest,
        energy=float(np.abs(stored + lost - work).max()) / (largest * cell.volume),
        mean_stress=_mean_stress(cell, matrix, u) / largest,
    )


def _mean_stress(cell: PeriodicCell, matrix: Array, u: Array) -> float:
    """Return how far the mean stresses of the bodies under unit strains are from the matrix; 0 for rigid bodies."""
    if any(b.kind != "elastic" for b in cell.model.bodies):
        return 0.0
    worst = 0.0
    for k in range(3):
        stress = Stress(cell.assembly.disc, cell.assembly.supported.T @ u[:, k])
        volumes = np.array([b.volume for b in cell.model.bodies])
        mean = volumes @ stress.mean / cell.volume
        worst = max(worst, float(np.abs(mean - matrix[:, k]).max()))
    return worst
