r"""A linear load path of a contact problem, and the state of the structure at one of its points.

Along the path, with parameter tau,

.. math:: f(\tau) = f + \tau \dot f, \qquad x_n(\tau) = x_n + \tau \dot x_n, \qquad
          y_t = C_t u - x_t + \tau \dot x_t + a_t t_t - s,

so that loads grow and obstacles move (settlement). Friction is in rate form: the slip s of a pair is what it has
slipped up to now, it changes only while the pair slips, and friction opposes its rate. The crushing of a pair whose
cap is reached and the opening that dilatancy brings stay likewise, as an offset o of the gap,
y_n = x_n(tau) + C_n u + a_n t_n + o.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError
from concio.problem.certificate import Certificate, Kinematics, certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.error_units import measure
from concio.problem.pair_state import Normal, PairStates
from concio.problem.tolerances import AT_BOUND
from concio.read_only import read_only
from concio.representation import short_repr

OPEN, CLOSED, CRUSHED = int(Normal.OPEN), int(Normal.CLOSED), int(Normal.CRUSHED)
"""Normal states of a pair: at its tensile strength and free to open; in contact; at its cap."""

AWAY = 1.0
"""Gap of a tie that is gone, which nothing changes [m]."""

STICK = 0
"""Sign of the slip of a plane pair that does not slip; +1 and -1 slip in that direction."""


@short_repr
@dataclass(frozen=True, eq=False)
class LinearPath:
    """A contact problem whose loads and obstacles move in proportion to a parameter.

    Parameters
    ----------
    problem : ContactProblem
        The problem at parameter 0.
    load_rate : (N,) array
        Loads added for each unit of the parameter [kN].
    gap_rate : (m,) array, optional
    tangent_rate : (m, d-1) array, optional
        Normal and tangential movement of side b against side a that does not come from u [m].
    total_rate : float or (N,) array, optional
        Change of ``problem.load`` for each unit of the parameter [kN], where ``load_rate`` holds more than loads;
        default: forces are measured by f at each parameter.
    """

    problem: ContactProblem
    load_rate: Array
    gap_rate: Array = field(default_factory=lambda: np.zeros(0))
    tangent_rate: Array = field(default_factory=lambda: np.zeros(0))
    total_rate: float | Array | None = None

    def __post_init__(self) -> None:
        m, n = self.problem.pairs, self.problem.unknowns
        for name, shape in (("load_rate", (n,)), ("gap_rate", (m,)), ("tangent_rate", (m, self.problem.dim - 1))):
            value = np.asarray(getattr(self, name), dtype=float)
            if not value.size:
                value = np.zeros(shape)
            if value.shape != shape:
                msg = f"{name} has shape {value.shape}, expected {shape}"
                raise InputError(msg)
            object.__setattr__(self, name, value)

    def moved(self, parameter: float) -> Array:
        """Return how far obstacles have moved at each pair (m,) at a value of the parameter [m]."""
        rates: Array = np.maximum(np.abs(self.gap_rate), sizes(self.tangent_rate))
        return abs(parameter) * rates

    def at(self, parameter: float) -> ContactProblem:
        """Return the problem with the loads and obstacles at a value of the parameter, slip measured from s = 0."""
        return replace(
            self.problem,
            f=self.problem.f + parameter * self.load_rate,
            load=self._load(parameter),
            gap=self.problem.gap + parameter * self.gap_rate,
            slip_origin=self.problem.slip_origin - parameter * self.tangent_rate,
        )


    def _load(self, parameter: float) -> float | Array:
        """Return the loads that measure forces at a value of the parameter, 0 where f does."""
        if self.total_rate is None:
            return 0.0
        load = self.problem.load + parameter * self.total_rate
        return load if isinstance(load, np.ndarray) else max(load, 0.0)


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class PathState:
    """State of the structure at one point of a path.

    Parameters
    ----------
    parameter : float
    displacement : (N,) array
        u [m].
    normal_force : (m,) array
        t_n [kN].
    friction_force : (m, d-1) array
        t_t [kN].
    states : PairStates
        Of the pairs; the direction is without meaning where an open pair has no strength.
    slip : (m, d-1) array
        s, slip accumulated up to now [m].
    offset : (m,) array
        o, crushing less dilatancy accumulated up to now [m].
    work, dissipation : float
        Work of loads and obstacles, and energy dissipated, since the path began [kN m].
    broken : (m,) boolean array, optional
        Pairs that have lost their tensile strength and cohesion, and ties that are gone, from this state on; None where
        there are none.
    """

    parameter: float
    displacement: Array
    normal_force: Array
    friction_force: Array
    states: PairStates
    slip: Array
    offset: Array
    work: float = 0.0
    dissipation: float = 0.0
    broken: Array | None = None

    @property
    def contact(self) -> Array:
        """OPEN, CLOSED or CRUSHED, (m,) integers."""
        return self.states.normal


def at_rest(problem: ContactProblem) -> PathState:
    """Return the state before any load: nothing carries force, pairs without a gap touch."""
    m = problem.pairs
    zero, still = np.zeros(m), np.zeros((m, problem.dim - 1))
    states = PairStates(np.where(problem.gap > 0, OPEN, CLOSED).astype(np.int8), still)
    return PathState(0.0, np.zeros(problem.unknowns), zero, still, states, still, zero)


def sizes(tangential: Array) -> Array:
    """Return the sizes (m,) of tangential quantities (m, d-1)."""
    found: Array = np.abs(tangential[:, 0]) if tangential.shape[1] == 1 else np.linalg.norm(tangential, axis=1)
    return found


def elastic_energy(problem: ContactProblem, state: PathState) -> float:
    """Return the energy stored in bodies and compliant joints [kN m]."""
    u, law = state.displacement, problem.laws
    sheared = law.tangential_compliance @ sizes(state.friction_force) ** 2
    joints = law.normal_compliance @ state.normal_force**2 + sheared
    return 0.5 * float(u @ (problem.K @ u) + joints)


def plastic_position(path: LinearPath, state: PathState) -> tuple[Array, Array]:
    """Return x_n + C_n u + a_n t_n and C_t u - x_t + tau x_t' + a_t t_t: what opened and slipped for good [m]."""
    problem, law = path.problem, path.problem.laws
    u, tau = state.displacement, state.parameter
    opening = problem.gap + tau * path.gap_rate + problem.C_n @ u + law.normal_compliance * state.normal_force
    slip = (problem.C_t @ u).reshape(problem.slip_origin.shape) - problem.slip_origin
    return opening, slip + law.tangential_compliance[:, None] * state.friction_force + tau * path.tangent_rate


def path_kinematics(path: LinearPath, state: PathState) -> Kinematics:
    """Return gaps and slips of a state as its path left them: dilatancy opened with every slip, forth and back.

    The crushing of a pair that also dilates is what is left of its offset with the slip taken as one way.
    """
    opening, slip = plastic_position(path, state)
    law = path.problem.laws
    crushed = state.offset + law.dilatancy * sizes(slip)
    crushing = np.where(path.problem.cone.capped, np.maximum(crushed, 0.0), 0.0)
    return Kinematics(opening + state.offset, slip, crushing)


def energy_of_step(path: LinearPath, before: PathState, after: PathState) -> tuple[float, float]:
    """Return (work, dissipation) between two states joined by a straight line, exactly (trapezoidal rule) [kN m].

    The work is that of the loads and of the obstacles; the dissipation -sum int (t_n dy_n + t_t dy_t) holds friction,
    ductile opening at the tensile strength, crushing, and the negative share of dilatancy. It can fall: a joint that
    closes gives back what opening at its tensile strength took, and of a finite step that ends on a cone it did not
    begin on, only the share of the straight line is counted, which with much dilatancy may be negative.
    """
    problem = path.problem
    du = after.displacement - before.displacement
    dtau = after.parameter - before.parameter
    t_n = 0.5 * (before.normal_force + after.normal_force)
    t_t = 0.5 * (before.friction_force + after.friction_force)
    load = problem.f + 0.5 * (before.parameter + after.parameter) * path.load_rate
    work = float(load @ du) - dtau * float(t_n @ path.gap_rate + np.vdot(t_t, path.tangent_rate))
    (n0, s0), (n1, s1) = plastic_position(path, before), plastic_position(path, after)
    return work, -float(t_n @ (n1 - n0) + np.vdot(t_t, s1 - s0))


def weakened(problem: ContactProblem, broken: Array | None) -> ContactProblem:
    """Return the problem without the tensile strength and the cohesion of broken pairs (m,).

    What has neither and is broken is a tie: it is gone, a pair that no motion closes.
    """
    if broken is None or not broken.any():
        return problem
    law = problem.laws
    gone = broken & (law.tension == 0) & (law.cohesion == 0)
    tension, cohesion = np.where(broken, 0.0, law.tension), np.where(broken, 0.0, law.cohesion)
    found = replace(problem, laws=replace(law, tension=tension, cohesion=cohesion))
    if not gone.any():
        return found
    C_n = sp.csr_array(sp.diags_array((~gone).astype(float)) @ problem.C_n)
    C_n.eliminate_zeros()
    return replace(found, C_n=C_n, gap=np.where(gone, AWAY, problem.gap))


def exceeded(path: LinearPath, state: PathState) -> Array:
    """Return which pairs (m,) are broken after a state: those that were, and those whose strength it uses up.

    A pair at its tensile strength, or one with cohesion that slips, keeps them in this step and has lost both in
    the next.
    """
    law = path.problem.laws
    units = measure(path.at(state.parameter), state.displacement, state.normal_force, state.friction_force)
    force = units.pair_force
    torn = (law.tension > 0) & (state.normal_force + law.tension <= AT_BOUND * force)
    sheared = (law.cohesion > 0) & state.states.slips & ~state.states.open
    was = np.zeros(path.problem.pairs, dtype=bool) if state.broken is None else state.broken
    result: Array = was | torn | sheared
    return result


def step_problem(path: LinearPath, before: PathState, parameter: float) -> ContactProblem:
    """Return the one-step problem whose slip is measured from the state ``before`` (10, 11).

    Parameters
    ----------
    path : LinearPath
    before : PathState
        Last converged state: its slip is the origin, its crushing and dilatant opening are part of the gap, and what
        broke in it has no strength left.
    parameter : float
        Load parameter of the end of the step.
    """
    problem = weakened(path.at(parameter), before.broken)
    _, position = plastic_position(path, before)
    return replace(problem, gap=problem.gap + before.offset, slip_origin=problem.slip_origin + position)


def certify_step(path: LinearPath, before: PathState, after: PathState) -> Certificate:
    """Certify a state as the answer of the one-step problem that starts from ``before``."""
    problem = step_problem(path, before, after.parameter)
    moved = path.moved(after.parameter)
    return certify(problem, after.displacement, after.normal_force, after.friction_force, moved=moved)


def state_of(
    path: LinearPath,
    parameter: float,
    u: Array,
    t_n: Array,
    t_t: Array,
    *,
    before: PathState | None = None,
) -> PathState:
    """Read contact states off an answer u, t_n, t_t at a value of the parameter.

    Parameters
    ----------
    path : LinearPath
    parameter : float
    u, t_n, t_t : arrays (N,), (m,), (m, d-1)
    before : PathState, optional
        Last converged state; its work and dissipation are carried on, and slip directions are measured from it.
    """
    problem = path.problem if before is None else weakened(path.problem, before.broken)
    law = problem.laws
    units = measure(path.at(parameter), u, t_n, t_t)
    force, length = units.pair_force, units.pair_length
    contact = np.where(t_n + law.tension > AT_BOUND * force, CLOSED, OPEN)
    contact = np.where(law.cap - t_n <= AT_BOUND * force, CRUSHED, contact).astype(np.int8)
    zero, still = np.zeros(problem.pairs), np.zeros_like(t_t)
    state = PathState(parameter, u, t_n, t_t, PairStates(contact, still), still, zero)
    opening, position = plastic_position(path, state)
    start = plastic_position(path, before)[1] if before is not None else still
    used = sizes(t_t) >= problem.cone.strength(t_n) - AT_BOUND * force
    moved = sizes(position - start) > AT_BOUND * length
    against = -t_t / np.where(sizes(t_t) > 0, sizes(t_t), 1.0)[:, None]
    against[:, 0] = np.where(against.any(axis=1), against[:, 0], 1.0)  # any way where there is no friction to oppose
    direction = np.where((used & moved)[:, None], against, 0.0)
    carried = (before.offset if before is not None else zero) - law.dilatancy * sizes(position - start)
    plastic = (contact != OPEN) & ((law.dilatancy > 0) | np.isfinite(law.cap))
    offset = np.where(plastic, -opening, carried)
    state = replace(state, states=PairStates(contact, direction), slip=position, offset=offset)
    if before is None:
        return state
    work, dissipation = energy_of_step(path, before, state)
    state = replace(state, work=before.work + work, dissipation=before.dissipation + dissipation)
    return replace(state, broken=before.broken)
