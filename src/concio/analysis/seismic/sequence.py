"""A mechanism followed by limit analysis on its displaced macro-blocks, step by step.

Where the joints of a mechanism leave more than one way to move (courses that slide over each other, wedges torn out of
a wall), and in space, no linkage can be followed. Here the macro-blocks stay what they are at the onset, but how they
move is found again in each configuration: a collapse state of Coulomb friction without dilatancy
(:mod:`concio.solvers.statics.collapse_state`) gives the multiplier and the motion; the blocks are moved along it, each
by a screw of its own, and put back where contacts that press have come apart. Contacts open, close, begin and cease to
slide on the way. In the limit of small steps that is a quasi-static path; one block that topples is followed exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.analysis.seismic.curve import FARTHEST, CapacityCurve, not_followed
from concio.analysis.seismic.linkage import Force
from concio.analysis.seismic.macro_blocks import GROUND, Mechanics, carried
from concio.analysis.seismic.macro_contacts import on_blocks, problem_of
from concio.analysis.seismic.participation import moved_of_masses
from concio.analysis.seismic.tie_events import tie_event
from concio.analysis.seismic.tie_history import TieHistory
from concio.contact.face_points import FacePoints, Standing, Stated, stated
from concio.kinematics.rigid import motions
from concio.model.model import Tie
from concio.problem.contact_problem import Engine
from concio.problem.tolerances import AT_BOUND, CHECKED
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.collapse_search import find_collapse_state
from concio.solvers.statics.collapse_state import certify_collapse

Array = np.ndarray

STEPS = 30
"""Configurations of a curve, about."""

MOST = 150
"""Configurations of a curve, at most."""

TRIES = 12
"""Programmes in search of a collapse state of one configuration."""

JAMS = 2.0
"""Times the largest of alpha_0 and of the first multiplier above which the blocks jam: the curve is cut before."""

SAME = 1e-6
"""Relative difference below which multipliers are the same."""

CLOSED = 1e-6
"""Contacts nearer than this share of the size of the mechanism are closed."""

SLIGHT = 1e-3
"""Contacts that press are put back by moves that change them by more than this share of the move: of many conditions
that say the same, the directions left over turn a little in a finite step, and must not be taken for conditions."""

BEHIND = 0.01
"""Share of their displacement by which masses may fall behind the control point: rotations that are not small do that
in any mechanism, and the code counts the control point."""

LOST = 1e-3
"""Share of the size of the mechanism by which a step may leave contacts wrong after it was corrected."""

OVERLAP, DEEP, ROUNDS = 1e-10, 0.1, 4
"""Overlaps above this share of the size are put back, and end a step where they are above that share of it; rounds."""


@dataclass(frozen=True, eq=False)
class State:
    """How the mechanism moves in one configuration.

    Parameters
    ----------
    q : Standing
    multiplier : float
    velocity : (G, 3 or 6) array
        For a control point that moves by one.
    normal_force : (m,) array
        Of all contacts [kN].
    stays : (m,) boolean array
        Contacts that press and do not slide.
    contacts : Stated
    tie_force, elongation : (n,) arrays
    history : TieHistory
    """

    q: Standing
    multiplier: float
    velocity: Array
    normal_force: Array
    stays: Array
    contacts: Stated
    tie_force: Array
    elongation: Array
    history: TieHistory


@dataclass(frozen=True, eq=False)
class Sequence:
    """Macro-blocks with their contacts and forces, and a control point.

    Parameters
    ----------
    mechanics : Mechanics
    contacts : FacePoints
    dead, push : tuple of Force
    ties : tuple of (Tie, int, int)
        With the macro-blocks of their ends.
    control : (int, (d,) array, (d,) array)
        Macro-block, point and direction of the control displacement.
    engine : {"superlu", "pardiso"}
    """

    mechanics: Mechanics
    contacts: FacePoints
    dead: tuple[Force, ...]
    push: tuple[Force, ...]
    ties: tuple[tuple[Tie, int, int], ...]
    control: tuple[int, Array, Array]
    engine: Engine = "superlu"

    @cached_property
    def size(self) -> float:
        """Largest distance of a contact or a force from the first centre [m]."""
        return self.mechanics.reach([*self.contacts.point, *(f.point for f in (*self.dead, *self.push))])

    def near(self) -> Sequence:
        """Return the same with all places measured from the first centre: far from the origin they lose digits."""
        first = self.mechanics.blocks[0].centre
        at = tuple(first.tolist())

        def seen(forces: tuple[Force, ...]) -> tuple[Force, ...]:
            return tuple(replace(f, point=f.point - first) for f in forces)

        def end(point: tuple[float, ...]) -> tuple[float, ...]:
            return tuple(v - o for v, o in zip(point, at, strict=True))

        blocks = tuple(replace(b, centre=b.centre - first) for b in self.mechanics.blocks)
        ties = tuple((replace(t, at_a=end(t.at_a), at_b=end(t.at_b)), a, b) for t, a, b in self.ties)
        block, point, along = self.control
        return replace(
            self, mechanics=replace(self.mechanics, blocks=blocks), dead=seen(self.dead), push=seen(self.push),
            contacts=replace(self.contacts, point=self.contacts.point - first), ties=ties,
            control=(block, point - first, along),
        )  # fmt: skip

    def at_rest(self) -> Standing:
        """Return the macro-blocks where they were described."""
        return Standing.at_rest(np.array([b.centre for b in self.mechanics.blocks]))

    def controlled(self, q: Standing) -> float:
        """Return the displacement of the control point [m]."""
        block, point, along = self.control
        return float((q.carry(np.array([block]), point[None])[0] - point) @ along)

    def masses(self, first: Array, q: Standing) -> float:
        """Return by how much the masses have moved, as a displacement of the control point [m]."""

        def went(force: Force) -> Array:
            point: Array = q.carry(np.array([force.block]), force.point[None])[0] - force.point
            return point

        return moved_of_masses(self.push, self.mechanics, first, went)

    def elongations(self, q: Standing) -> Array:
        """Return the elongations (n,) of the ties [m]."""
        longer = np.zeros(len(self.ties))
        for k, (tie, a, b) in enumerate(self.ties):
            ends = np.array([tie.at_a, tie.at_b], dtype=float)
            now = q.carry(np.array([a, b]), ends)
            longer[k] = float(np.linalg.norm(now[1] - now[0])) - float(np.linalg.norm(ends[1] - ends[0]))
        return longer

    def pulls(self, q: Standing, history: TieHistory) -> tuple[Array, Array, Array]:
        """Return forces (n,) [kN] and elongations (n,) [m] of the ties, and their pull on the unknowns (N,)."""
        load = np.zeros(len(self.mechanics.blocks) * motions(q.centre.shape[1]))
        longer = self.elongations(q)
        forces = np.array([history.force(k, tie, float(longer[k])) for k, (tie, _, _) in enumerate(self.ties)])
        for k, (tie, a, b) in enumerate(self.ties):
            ends = np.array([tie.at_a, tie.at_b], dtype=float)
            now = q.carry(np.array([a, b]), ends)
            along = (now[1] - now[0]) / float(np.linalg.norm(now[1] - now[0]))
            pull = [Force(g, s * forces[k] * along, ends[i]) for i, (g, s) in enumerate(((a, 1.0), (b, -1.0)))]
            load += on_blocks(q, tuple(f for f in pull if f.block != GROUND), self.size)
        return forces, longer, load

    def state(self, q: Standing, normal_force: Array, history: TieHistory | None = None) -> State | None:
        """Return how the mechanism moves in a configuration, from normal forces (m,) near it; None if nothing tells."""
        history = TieHistory.none(len(self.ties)) if history is None else history
        L, d = self.size, q.centre.shape[1]
        now = stated(self.contacts, q, L)
        closed = np.flatnonzero(now.gap <= CLOSED * L)
        pull, longer, tied = self.pulls(q, history)
        problem = problem_of(self.contacts, now, closed, on_blocks(q, self.dead, L) + tied).by(self.engine)
        live = on_blocks(q, self.push, L)
        strength = problem.cone.strength(normal_force[closed])
        zero = np.zeros(len(closed))
        found = None
        for _ in range(TRIES):
            laws = replace(problem.laws, friction=zero, dilatancy=zero, cohesion=strength)
            bound = associated_limit(replace(problem, laws=laws), live)
            if bound.mechanism is None or not np.isfinite(bound.multiplier):
                return None
            if bound.residual > CHECKED:  # not even what is dead is carried with this strength
                break
            found = certify_collapse(problem, live, bound.mechanism.velocity, 0)
            if found is not None:
                break
            strength = 0.5 * strength + 0.5 * problem.cone.strength(bound.normal_force)
        if found is None and d == 2:
            found = find_collapse_state(problem, live, starts=4).state
        if found is None:
            return None
        velocity = found.velocity.reshape(-1, motions(d)).copy()
        velocity[:, d:] /= L
        block, point, along = self.control
        arm = q.carry(np.array([block]), point[None])[0] - q.centre[block]
        speed = float(carried(velocity[block], arm) @ along)
        if speed <= CLOSED * float(np.abs(found.velocity).max()):
            return None
        forces = np.zeros(len(now.gap))
        forces[closed] = found.normal_force
        slip = np.linalg.norm((problem.C_t @ found.velocity).reshape(len(closed), d - 1), axis=1)
        stays = np.zeros(len(now.gap), dtype=bool)
        presses = found.normal_force > AT_BOUND * float(found.normal_force.max(initial=0.0))
        stays[closed] = presses & (slip <= 1e-8)
        return State(q, found.multiplier, velocity / speed, forces, stays, now, pull, longer,
                     history.after(longer))  # fmt: skip

    def step(self, last: State, length: float) -> Standing | None:
        """Return the configuration after the control point has moved by about ``length``; None if it cannot be.

        Contacts that press are put back where they have come apart, and so are others that have come to overlap: those
        that only touch, without a force, would keep what each step leaves of overlap, and add to it.
        """
        L = self.size
        crushing = np.isfinite(self.contacts.laws.cap)
        kept = (last.normal_force > AT_BOUND * last.normal_force.max(initial=0.0)) & ~crushing
        moved = last.q.moved(last.velocity, length)
        for _ in range(ROUNDS):
            q = self._put_back(moved, kept, last)
            gap = stated(self.contacts, q, L).gap
            overlaps = (gap < -OVERLAP * L) & ~crushing & ~kept
            sunk = np.minimum(last.contacts.gap, 0.0) - gap  # in this step
            if not overlaps.any() or float(sunk[overlaps].max()) > DEEP * length:
                break
            kept = kept | overlaps
        off = max(float(np.abs(gap[kept]).max(initial=0.0)), float(-gap[~crushing].min(initial=0.0)))
        return q if off <= LOST * length and np.isfinite(q.centre).all() else None

    def _put_back(self, q: Standing, kept: Array, last: State) -> Standing:
        """Return a configuration near ``q`` in which ``kept`` (m,) contacts touch and what sticks has not slid."""
        L, d = self.size, q.centre.shape[1]
        presses, stuck = np.flatnonzero(kept), np.flatnonzero(last.stays)
        rows = (stuck[:, None] * (d - 1) + np.arange(d - 1)).ravel()
        before = np.inf
        for _ in range(8):
            now = stated(self.contacts, q, L)
            wrong = np.concatenate([now.gap[presses], (now.drift - last.contacts.drift)[stuck].ravel()])
            worst = float(np.abs(wrong).max(initial=0.0))
            if worst <= 1e-4 * CLOSED * L or worst > 0.5 * before:
                break
            before = worst
            J = sp.vstack([now.C_n[presses], now.C_t[rows]]).tocsc()
            factor = splu(sp.csc_matrix(J.T @ J + SLIGHT**2 * sp.eye_array(J.shape[1])))
            change = -factor.solve(J.T @ wrong)
            change -= factor.solve(J.T @ (J @ change + wrong))
            moved = change.reshape(-1, motions(d)).copy()
            moved[:, d:] /= L
            q = q.moved(moved, 1.0)
        return q

    def room(self, state: State) -> float:
        """Return how far the control point can move before an open contact closes [m]."""
        speed = state.velocity.copy()
        speed[:, state.q.centre.shape[1] :] *= self.size
        rate = state.contacts.C_n @ speed.ravel()
        gap = state.contacts.gap
        coming = (gap > CLOSED * self.size) & (rate < -1e-12)
        return float((gap[coming] / -rate[coming]).min(initial=np.inf))


def follow_in_steps(sequence: Sequence, onset: float = np.inf) -> CapacityCurve:
    """Follow a mechanism until its multiplier vanishes.

    Where a tie yields or breaks on the way, that very configuration is looked for, so that the curve has its peaks and
    its drops whatever the steps. Where the masses fall behind the control point by more
    than :data:`BEHIND`, the displacement is theirs and that.

    Parameters
    ----------
    sequence : Sequence
    onset : float
        alpha_0. Forces of sliding joints are not unique, and with frozen strength the search comes from above: where it
        meets states above alpha_0 though no tie pulls, all multipliers are reduced by alpha_0 over the largest.

    Returns
    -------
    CapacityCurve
        Of kind "steps"; where it ends early, its reason says why.
    """
    sequence = sequence.near()
    L = sequence.size
    state = sequence.state(sequence.at_rest(), sequence.contacts.force)
    if state is None:
        return not_followed("no state")
    first, began = state.multiplier, state.velocity
    costly = state.q.centre.shape[1] == 3
    d, alpha, ties = [0.0], [first], [state.tie_force]
    broken, control = list[float](), [(0.0, 0.0)]
    usual, reason, end = (1e-4 if sequence.ties else 1e-3) * L, "far", float("nan")
    step, least, fresh = usual, usual, True
    while d[-1] < FARTHEST * L:
        tried = max(min(step, sequence.room(state)), 1e-3 * step)
        q = sequence.step(state, tried)
        event = None if q is None else tie_event(sequence, state, q, tried)
        if event is not None:
            q, tried = event.q, event.length
        after = None if q is None else sequence.state(q, state.normal_force, state.history)
        overshot = after is not None and after.multiplier <= 0
        if after is None or (overshot and tried > 1e-2 * least):
            step = tried / 4
            if after is None and step < (0.05 if costly and q is not None else 1e-3) * least:
                end, reason = d[-1], "joints end" if q is None else "no state"
                break
            continue
        if not sequence.ties and after.multiplier > JAMS * (first if np.isinf(onset) else max(first, onset)):
            end, reason = d[-1], "jams"
            break
        went = sequence.controlled(after.q)
        at = max(d[-1], min(went, (1.0 + BEHIND) * sequence.masses(began, after.q)))
        control.append((went, at))
        if overshot:
            share = state.multiplier / (state.multiplier - after.multiplier)
            end, reason = d[-1] + share * (at - d[-1]), "falls"
            d, alpha, ties = [*d, end], [*alpha, 0.0], [*ties, after.tie_force]
            break
        if event is not None and event.breaks:
            broken.append(at)
            d, alpha, ties = [*d, at], [*alpha, after.multiplier], [*ties, after.tie_force]
            snapped = sequence.state(after.q, after.normal_force, after.history.after(after.elongation, [event.tie]))
            if snapped is None or snapped.multiplier <= 0:
                end, reason = at, "no state" if snapped is None else "falls"
                d, alpha, ties = [*d, at], [*alpha, 0.0], [*ties, ties[-1]]
                break
            after = snapped
        if fresh and event is None:
            fall = (alpha[-1] - after.multiplier) / max(at - d[-1], 1e-12)
            usual = min(max((alpha[-1] / fall if fall > 0 else L) / STEPS, usual), 0.05 * L)
            least = usual
        fresh = event is not None
        state, step = after, 1e-3 * L if fresh else min(2.0 * max(step, tried), usual)
        d, alpha, ties = [*d, at], [*alpha, after.multiplier], [*ties, after.tie_force]
        if len(d) >= MOST:
            end, reason = d[-1], "long"
            break
    if reason not in ("far", "falls"):  # what may still stand beyond does not count
        d, alpha, ties = [*d, end], [*alpha, 0.0], [*ties, ties[-1]]
    largest = max(alpha)
    ratio = onset / largest if not sequence.ties and largest > onset * (1.0 + SAME) else 1.0
    alpha[0] = min(alpha[0], onset) if ratio == 1.0 else largest
    return CapacityCurve(
        "steps", np.array(d), ratio * np.array(alpha), end, reason, tuple(broken), np.array(ties), reduced=ratio,
        control=np.array(control).T,
    )  # fmt: skip
