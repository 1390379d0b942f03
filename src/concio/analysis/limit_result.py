"""What is known of how much load a model carries: one result, filled number by number."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.analysis.exact_proofs import against_slips
from concio.analysis.least_strengthening import Kind, LeastStrengthening, least_by_height, least_strengthening
from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.limit_torsion import SPREAD, SpreadSteps, twisting
from concio.analysis.load_steps import LoadSteps
from concio.analysis.parameters import own_parameters, parameters_of
from concio.analysis.sensitivity import Sensitivity, sensitivity_of
from concio.contact.assembly import Assembly
from concio.errors import InputError
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.solvers.path.record import EventPath
from concio.solvers.statics.associated_limit import LimitLoad
from concio.solvers.statics.collapse_state import CollapseState
from concio.solvers.statics.friction import FrictionBounds
from concio.verdict.limit_verdict import limit_verdict
from concio.verdict.limit_words import NOT_ASKED, limit_lines
from concio.verdict.no_limit import without_limit
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.limit_accessor import LimitPlots

Array = np.ndarray

NONE = 1e-12
"""Upper bound that is zero up to rounding, over :attr:`LimitResult.unit`."""


@dataclass(frozen=True, eq=False)
class LimitResult(Shown):
    """Limit multipliers of the live load.

    Parameters
    ----------
    assembly : Assembly
    associated : LimitLoad
        Upper bound with forces and mechanism.
    groups : tuple of str
        The live load groups.
    steps : LoadSteps or None
        What Coulomb friction is shown to carry as the load grows in steps; None where that was not asked for.
    path : EventPath or None
        The Coulomb path under displacement control; None where it was not followed.
    path_note : str
        Why there is no path, where there is none.
    collapse_state : CollapseState or None
        Certified state in which the structure can begin to move under Coulomb friction, the least found.
    search : str
        What the search for collapse states did, or why it was not tried.
    first_limit : float
        Multiplier at which the path under growing load first finds no continuous way on: that of its first jump, or
        its end; ``nan`` without a path.
    collapse_shown : bool
        Whether the largest multiplier of the path is shown to be that of its collapse: the structure can move at it,
        or a mechanism proves that it carries no more, or the load falls as the structure moves far beyond it. A path
        that was lost shows only what the structure carries.
    friction : FrictionBounds or None
        Smallest friction with which admissible forces carry the load as given; None where that was not asked for.
    lent_compliance : float
        Normal compliance added to hard joints of rigid blocks [m/kN]; 0 where none was needed.
    dead : Status or None
        What Coulomb friction says of all other loads alone; None where neither path nor steps asked.
    twisting : int
        Joints stated at their corners that a mechanism or the collapse state twists; their torsion is too strong.
    spread : SpreadSteps or None
        Load steps with pressure spread over the joints, taken where some twist and the size allows.
    untied : LimitLoad or None
        The bound without the ties that can break; None where none can.
    ties_whole : float
        Largest multiplier that the exact path reaches before a tie breaks; ``nan`` where none does on it.
    unit : float
        Multiplier at which the load is as large as the constant loads of its parts; 1 where these are none.
    """

    assembly: Assembly
    associated: LimitLoad
    groups: tuple[str, ...] = ("live",)
    steps: LoadSteps | None = None
    path: EventPath | None = None
    path_note: str = NOT_ASKED
    collapse_state: CollapseState | None = None
    search: str = NOT_ASKED
    first_limit: float = float("nan")
    collapse_shown: bool = False
    friction: FrictionBounds | None = None
    lent_compliance: float = 0.0
    dead: Status | None = None
    twisting: int = 0
    spread: SpreadSteps | None = None
    untied: LimitLoad | None = None
    ties_whole: float = float("nan")
    unit: float = 1.0

    def __repr__(self) -> str:
        title, *lines = limit_lines(self)
        return "\n".join([f"LimitResult: {title}", *lines])

    @property
    def plot(self) -> LimitPlots:
        """Figures by name: ``limit.plot.mechanism()``; matplotlib is loaded here."""
        plots: LimitPlots = view(self, "plot")
        return plots

    @property
    def verdict(self) -> Verdict:
        """The answer with its question: what acts, the design value, what is an upper bound only."""
        return limit_verdict(self)

    def sensitivity(self, changes: Mapping[str, Callable[[float], Model]] | None = None) -> Sensitivity:
        """Return the derivative of the associated multiplier with respect to every number of the model, by duality.

        Where the optimum is degenerate the multiplier has another derivative to either side, and both are given.

        Parameters
        ----------
        changes : mapping of str to callable, optional
            Numbers of your own in place of those of the model: for each name what returns the model that a change by
            so much makes, 0.0 being none. Its blocks and joints must stay in their order.

        Raises
        ------
        InputError
            There is no multiplier.

        Examples
        --------
        A pillar tips at width over height. One per cent more width is one per cent more:

        >>> import concio
        >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=1.0)
        >>> found = concio.limit(pillar, path=False).sensitivity()
        >>> [round(v, 6) for v in found["length of x"].per_percent]
        [-1.0, 1.0]
        """
        model = self.assembly.model
        own = parameters_of(model, self.groups) if changes is None else own_parameters(changes)

        def split(assembly: Assembly) -> tuple[ContactProblem, Array]:
            dead = assembly.problem(dict.fromkeys(self.groups, 0.0))
            return dead, assembly.problem(dict.fromkeys(self.groups, 1.0), like=dead).f - dead.f

        return sensitivity_of(split(self.assembly), lambda m: split(lent_assembly(m)), self.associated, own)

    def least(
        self, target: float, *, tie: str | None = None, cohesion: str | None = None, load: str | None = None,
        heights: Sequence[float] | None = None,
    ) -> LeastStrengthening:  # fmt: skip
        """Return the least strengthening that brings the associated multiplier to a target, with a proof.

        Name one thing: the tie whose yield force, the joint law whose cohesion, or the load group whose factor is
        sought; what the model gives it does not count.

        Parameters
        ----------
        target : float
            Multiplier that is wanted.
        tie, cohesion, load : str, optional
        heights : sequence of float, optional
            Heights at which the tie could be [m]: the one where it needs the least force is found too.

        Raises
        ------
        InputError
            Nothing, or more than one thing, is named; it does not exist; or the model does not stand without it.

        Examples
        --------
        A pillar tips at 0.25 of its weight of 20 kN. A tie at its head, 2 m high, is to bring that to 0.5: the moment
        that is missing, 0.25 x 20 kN x 1 m, needs 2.5 kN there:

        >>> import concio
        >>> import dataclasses
        >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=1.0)
        >>> rod = concio.Tie("rod", "b01", (0.25, 2.0), "", (-3.0, 2.0), stiffness=1e4, yield_force=1.0)
        >>> held = concio.limit(dataclasses.replace(pillar, ties=(rod,)), path=False)
        >>> round(held.least(0.5, tie="rod").amount, 6)
        2.5
        >>> placed = held.least(0.5, tie="rod", heights=[0.5, 1.0, 2.0])
        >>> placed.height, {h: round(f, 6) for h, f in placed.by_height.items()}
        (2.0, {0.5: 10.0, 1.0: 5.0, 2.0: 2.5})
        """
        named: list[tuple[Kind, str | None]] = [("tie", tie), ("cohesion", cohesion), ("load", load)]
        given = [(kind, of) for kind, of in named if of is not None]
        if len(given) != 1:
            msg = "name one strengthening: tie, cohesion or load"
            raise InputError(msg, hint='for example least(0.3, tie="roof tie")')
        kind, of = given[0]
        if heights is not None:
            if kind != "tie":
                msg = "heights are those of a tie"
                raise InputError(msg, hint='for example least(0.3, tie="roof tie", heights=[2.5, 5.0])')
            return least_by_height(self.assembly, self.groups, target, of, heights)
        return least_strengthening(self.assembly, self.groups, target, kind, of)

    @property
    def carried(self) -> float:
        """Largest multiplier that Coulomb friction was found to carry on a path or in steps; ``nan`` without both.

        With the joints as the model states them: where some twist, :attr:`design` is that of pressure spread over them.
        """
        path = self.path.peak if self.path is not None else -np.inf
        steps = self.steps.carried if self.steps is not None and self.steps.multipliers else -np.inf
        most = max(path, steps)
        return most if np.isfinite(most) else float("nan")

    @property
    def endless(self) -> bool:
        """Whether the load grows in certified steps without bound: the associated bound is locked, as it should be."""
        return self.associated.locked and self.steps is not None and bool(np.isfinite(self.steps.endless))

    @property
    def none_of_it(self) -> bool:
        """Whether it is proven that no multiple of the load is carried.

        The upper bound is zero, or nothing else acts, so that all multiples are alike, and one is not carried.
        """
        steps = self.steps
        if self.associated.bounds_hold and abs(self.associated.upper) <= NONE * self.unit:
            return True
        alike = self.associated.locked and steps is not None and steps.state is None and len(steps.multipliers) == 1
        return alike and steps is not None and steps.outcome in PROVEN_FAILURES

    @property
    def coulomb(self) -> float:
        """Collapse multiplier of the Coulomb path; ``nan`` without a path and where none was shown."""
        return self.path.peak if self.path is not None and self.collapse_shown else float("nan")

    @property
    def state_counts(self) -> bool:
        """Whether the collapse state says something of the structure, and not of the contact points of its joints.

        In a joint stated at points over its patch a state that twists it finds the points nearest to the middle: its
        multiplier falls without bound as points are added (:mod:`concio.analysis.limit_torsion`).
        """
        if self.collapse_state is None:
            return False
        if self.assembly.model.dim == 2:
            return True
        motion = np.asarray(self.assembly.supported.T @ self.collapse_state.velocity)
        return not len(twisting(self.assembly, motion, SPREAD))

    @property
    def design(self) -> float:
        """Multiplier to design with: the least of what path, steps and collapse state say; ``nan`` where none does.

        ``inf`` where certified steps grow without bound; 0 where all other loads alone are not carried. Where the
        structure wedges and no joint crushes it may be any large number: :attr:`verdict` says so, and that no limit was
        found.
        """
        if self.dead in PROVEN_FAILURES:
            return 0.0
        if self.none_of_it:
            return 0.0
        state = self.collapse_state.multiplier if self.collapse_state is not None and self.state_counts else np.inf
        shown = [self.coulomb if self.collapse_shown else self.carried]
        if self.endless:
            shown = [np.inf]
        if self.spread is not None and self.spread.steps.multipliers:
            shown = [*(shown if self.spread.points else []), self.spread.carried]
        if not np.isnan(self.ties_whole):
            shown.append(self.ties_whole)
        elif self.path is None and self.untied is not None:  # nobody knows how far they are stretched
            if np.isnan(self.untied.multiplier):
                return float("nan")
            state = min(state, self.untied.multiplier)
        known = [value for value in shown if not np.isnan(value)]
        low = min([*known, state])
        return max(float(low), 0.0) if known or np.isfinite(low) else float("nan")

    @property
    def bracket(self) -> tuple[float, float]:
        """(design value, associated multiplier): the least Coulomb multiplier found, and the upper bound.

        The peak of a path that was lost counts, and the last certified load step: the structure carries it, and
        collapses at it or above.
        """
        return self.design, self.associated.multiplier

    def mechanism(self) -> Array | None:
        """Velocity (N_all,) of the associated mechanism on all unknowns, largest entry 1; None where there is none."""
        if self.associated.mechanism is None:
            return None
        velocity: Array = self.assembly.supported.T @ self.associated.mechanism.velocity
        return velocity

    def collapse_motion(self) -> Array | None:
        """Last rate of displacement (N_all,) of the Coulomb path, largest entry 1; None without a path."""
        if self.path is None:
            return None
        velocity: Array = self.assembly.supported.T @ self.path.direction
        return velocity

    def proof(self, numbers: Literal["binary", "decimal"] = "binary") -> dict[str, Any]:
        """Return an exact certificate of the associated multiplier, for ``concio verify``.

        Parameters
        ----------
        numbers : {"binary", "decimal"}
            Numbers of the model as the computer holds them, or rounded to twelve decimal digits.

        Raises
        ------
        InputError
            The model has something that is not proved exactly yet.
        SolverError
            No exact forces and no exact motion were found.

        Examples
        --------
        Checked as ``concio verify`` does:

        >>> import concio
        >>> from concio.proof.verify import check
        >>> found = concio.limit(concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=1.0))
        >>> check(found.proof()).split(": ")[1:]
        ['the multiplier 1/4 = 0.25 is balanced; no multiplier above 1/4 = 0.25 is', 'proved exactly']
        """
        from concio.proof.exact_certificate import prove_limit

        return prove_limit(self.assembly, self.groups, numbers=numbers, directions=self._ways())

    @cached_property
    def proved(self) -> str:
        """What an exact certificate of the associated multiplier proves, in a sentence; empty where there is none.

        One is sought for up to a hundred blocks.
        """
        from concio.analysis.exact_proofs import sentence_proved

        return sentence_proved(self.assembly, self.proof)

    def _ways(self) -> tuple[Array, Array]:
        """Return directions (m, d) of friction forces, and of what would oppose the slips of the mechanism."""
        pairs, a = self.assembly.pairs, self.associated
        slips = np.zeros(pairs.normal.shape)
        if a.mechanism is not None:
            slips = against_slips(self.assembly, a.mechanism.velocity)
        return np.einsum("ki,kij->kj", a.friction_force, pairs.tangents), slips

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        a = self.associated
        return {
            "engine": self.assembly.model.engine,
            "verdict": self.verdict.as_dict(),
            "associated": "locked" if a.locked else "bounded",
            "associated_multiplier": _finite(a.multiplier),
            "associated_upper_bound": _finite(a.upper),
            "duality_gap": a.gap,
            "static_residual": a.residual,
            "mechanism_violation": None if a.mechanism is None else a.mechanism.violation,
            "checked": a.checked,
            "design_multiplier": None if without_limit(self) else _finite(self.design),
            "dead_load_alone": None if self.dead is None else self.dead.name.lower(),
            "grows_without_end": self.endless,
            "ties_whole_up_to": _finite(self.ties_whole),
            "joints_that_twist": self.twisting,
            "coulomb_spread_steps_carry": None if self.spread is None else _finite(self.spread.carried),
            "coulomb_spread_steps_fail": None if self.spread is None else _finite(self.spread.not_reached),
            "coulomb_path_multiplier": self.coulomb if self.collapse_shown else None,
            "coulomb_path_carries": None if self.path is None else self.path.peak,
            "coulomb_steps_carry": None if self.steps is None else _finite(self.steps.carried),
            "coulomb_steps_fail": None if self.steps is None else _finite(self.steps.failed),
            "coulomb_steps_outcome": None if self.steps is None or self.steps.outcome is None
            else self.steps.outcome.name.lower(),
            "collapse_state_multiplier": None if self.collapse_state is None else self.collapse_state.multiplier,
            "collapse_state_search": self.search,
            "coulomb_first_limit": None if self.path is None else self.first_limit,
            "path_note": self.path_note,
            "path_outcome": None if self.path is None else self.path.outcome.name.lower(),
            "path_events": None if self.path is None else len(self.path.events),
            "path_jumps": None if self.path is None else len(self.path.jumps),
            "friction_factor": None if self.friction is None else _finite(self.friction.factor),
            "friction_factor_below": None if self.friction is None else _finite(self.friction.below),
            "lent_compliance": self.lent_compliance,
        }


def _finite(value: float) -> float | None:
    """Return a number, or None for what is none: a word beside it says which."""
    return float(value) if np.isfinite(value) else None
