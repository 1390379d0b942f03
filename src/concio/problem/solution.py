"""What a solver returns: an immutable value that judges itself by :func:`concio.problem.certificate.certify`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp

from concio.problem.certificate import Certificate, Kinematics, certify, kinematics
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.error_units import measure
from concio.problem.pair_state import Normal, PairStates
from concio.problem.tolerances import AT_BOUND, CERTIFIED
from concio.read_only import read_only
from concio.representation import short_repr


class Status(Enum):
    """Outcome of a solve; the value is the sentence a user reads."""

    SOLVED = "In equilibrium: the certificate proves it."
    NO_EQUILIBRIUM = "No equilibrium is possible with the joints that were made: a mechanism proves it."
    COLLAPSES = (
        "Collapses with the joints that were made: released at rest it moves away; an accelerating motion that obeys "
        "contact and friction proves it."
    )
    NO_COULOMB_STATE = "No Coulomb equilibrium exists: every combination of joint states was excluded."
    UNDECIDED = (
        "Undecided: statically admissible forces exist, but no state that also obeys Coulomb friction was found, "
        "and none was shown impossible."
    )
    GAVE_UP = "The solver stopped without an answer and without a proof that there is none."
    CANCELLED = "Stopped on request."

    @property
    def exit_code(self) -> int:
        """Exit code of the command line for this outcome."""
        return {Status.SOLVED: 0, **dict.fromkeys(PROVEN_FAILURES, 3)}.get(self, 4)


PROVEN_FAILURES = (Status.NO_EQUILIBRIUM, Status.COLLAPSES, Status.NO_COULOMB_STATE)
"""Outcomes that are proofs that the structure does not stand."""


@short_repr
@dataclass(frozen=True)
class Progress:
    """What a progress callback receives; ``share`` is the share of the work that is done, where it is known."""

    method: str
    iteration: int
    residual: float
    message: str = ""
    share: float = math.nan


ProgressCallback = Callable[[Progress], "bool | None"]
"""Called as the solver works; a true return value asks it to stop (status CANCELLED)."""


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Mechanism:
    """A rigid motion that proves there is no equilibrium (theory page, section 6), or the direction of a departure.

    Parameters
    ----------
    velocity : (N,) array
        Direction of the motion, scaled to largest entry 1.
    power : float
        f' v minus the most the joints can absorb (cohesion, tension, cap), positive [kN]; in a departure f' v.
    violation : float
        Largest violation of C_n v >= mu |C_t v| (relative to the largest velocity), and of K v = 0; in a departure its
        own.
    """

    velocity: Array
    power: float
    violation: float


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Departure:
    """A motion that starts from rest and never ends: constant acceleration and constant forces that obey every law.

    See :mod:`concio.solvers.relaxation.unbounded_motion` for the equations.

    Parameters
    ----------
    acceleration : (N,) array
        a: rigid motion of each body [m/s2 where the masses are in t].
    inertia : (N, N) CSR array
        The mass matrix M that resists it [t].
    displacement : (N,) array
        u + s_0 a, a state on the way [m].
    normal_force, friction_force : (m,), (m, d-1) arrays
        Forces during the motion [kN].
    power : float
        f'a over the total load and the largest acceleration, positive.
    violation : float
        Worst of: the certificate under the loads f - M a, K a = 0, and the laws of the joints' rates along a.
    """

    acceleration: Array
    inertia: sp.csr_array
    displacement: Array
    normal_force: Array
    friction_force: Array
    power: float
    violation: float

    @property
    def certified(self) -> bool:
        """True where every residual is rounding and the motion really takes power from the loads."""
        return self.violation <= CERTIFIED and self.power > 10.0 * CERTIFIED


@short_repr
@dataclass(frozen=True, eq=False)
class PartOutcome:
    """What became of one connected part of a structure (:mod:`concio.problem.parts`).

    Parameters
    ----------
    bodies, pairs : integer arrays
        Its bodies, those that have unknowns, and its pairs.
    status : Status
    certificate : Certificate
        In the units of the part.
    method : str
    """

    bodies: Array
    pairs: Array
    status: Status
    certificate: Certificate
    method: str


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class Solution:
    """Answer of a solver for one load step.

    Parameters
    ----------
    status : Status
    displacement : (N,) array
        u [m].
    normal_force : (m,) array
        t_n, compression positive [kN].
    friction_force : (m, d-1) array
        t_t on side b along t [kN].
    kinematics : Kinematics
        Gaps, slips and crushing that follow from them.
    certificate : Certificate
        Residuals computed from the original problem.
    method : str
        Name of the method that produced the answer.
    iterations, factorisations : int
        Work done.
    mechanism : Mechanism or None
        Proof that there is no equilibrium, or the direction of the departure.
    departure : Departure or None
        Proof that the structure moves away.
    trace : tuple of str
        What was tried, in order, in words.
    info : mapping
        Numbers particular to the method (pivots, condition, residual history...).
    parts : tuple of PartOutcome
        What became of each connected part, where there are several that were solved one by one; else empty.
    """

    status: Status
    displacement: Array
    normal_force: Array
    friction_force: Array
    kinematics: Kinematics
    certificate: Certificate
    method: str
    iterations: int = 0
    factorisations: int = 0
    mechanism: Mechanism | None = None
    departure: Departure | None = None
    trace: tuple[str, ...] = ()
    info: Mapping[str, Any] = field(default_factory=dict)
    parts: tuple[PartOutcome, ...] = ()

    @property
    def solved(self) -> bool:
        """True for a certified equilibrium."""
        return self.status is Status.SOLVED

    @property
    def gap(self) -> Array:
        """y_n (m,) [m]."""
        return self.kinematics.gap

    @property
    def slip(self) -> Array:
        """y_t (m, d-1) [m]."""
        return self.kinematics.slip


class Solver(Protocol):
    """A method: takes a problem, options of its own and a progress callback, returns a :class:`Solution`."""

    def __call__(
        self, problem: ContactProblem, *, progress: ProgressCallback | None = None, **options: Any
    ) -> Solution:
        """Solve one load step."""
        ...


def judge(
    problem: ContactProblem,
    u: Array,
    t_n: Array,
    t_t: Array,
    *,
    method: str,
    failure: Status = Status.GAVE_UP,
    **extra: Any,
) -> Solution:
    """Build the solution of a solver's ``u, t_n, t_t``; it is SOLVED only if the certificate says so.

    Parameters
    ----------
    problem : ContactProblem
    u, t_n, t_t : arrays
        Shapes (N,), (m,), (m, d-1) or (m (d-1),).
    method : str
    failure : Status
        Status where the certificate does not hold.
    **extra
        Further fields of :class:`Solution`.
    """
    t_t = np.asarray(t_t, dtype=float).reshape(problem.pairs, problem.dim - 1)
    certificate = certify(problem, u, t_n, t_t)
    status = Status.SOLVED if certificate.certified else failure
    return Solution(status, u, t_n, t_t, kinematics(problem, u, t_n, t_t), certificate, method, **extra)


def failed(problem: ContactProblem, status: Status, *, method: str, **extra: Any) -> Solution:
    """Return a solution without numbers: zero displacements and forces, never called solved."""
    m = problem.pairs
    u, t_n, t_t = np.zeros(problem.unknowns), np.zeros(m), np.zeros((m, problem.dim - 1))
    certificate = Certificate(*([np.inf] * 5))
    return Solution(status, u, t_n, t_t, kinematics(problem, u, t_n, t_t), certificate, method, **extra)


def pair_states(problem: ContactProblem, solution: Solution, tolerance: float = AT_BOUND) -> PairStates:
    """Return the states of the pairs in an answer, see :func:`read_pair_states`."""
    return read_pair_states(
        problem, solution.displacement, solution.normal_force, solution.friction_force, tolerance=tolerance
    )


def read_pair_states(
    problem: ContactProblem, u: Array, t_n: Array, t_t: Array, *, tolerance: float = AT_BOUND
) -> PairStates:
    """Read the states of the pairs off displacements and forces.

    A pair is open when its force is below ``tolerance`` times the total load of its part, crushed when it is that near
    to its cap; it slips when its slip exceeds ``tolerance`` times the largest displacement of its part and friction is
    exhausted.

    Parameters
    ----------
    problem : ContactProblem
    u, t_n, t_t : (N,), (m,), (m, d-1) arrays
        [m], [kN].
    tolerance : float
    """
    units = measure(problem, u, t_n, t_t)
    force, length = units.pair_force, units.pair_length
    slip = kinematics(problem, u, t_n, t_t).slip
    size = np.linalg.norm(slip, axis=1)
    used = np.linalg.norm(t_t, axis=1) >= problem.cone.strength(t_n) - tolerance * force
    slips = used & (size > tolerance * length)
    normal = np.where(t_n + problem.cone.tension > tolerance * force, Normal.CLOSED, Normal.OPEN)
    normal = np.where(problem.cone.cap - t_n <= tolerance * force, Normal.CRUSHED, normal)
    return PairStates(normal.astype(np.int8), np.where(slips[:, None], slip / np.where(slips, size, 1.0)[:, None], 0.0))
