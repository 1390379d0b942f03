"""What is known of how much load a model carries: one result, filled number by number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.load_steps import LoadSteps
from concio.contact.assembly import Assembly
from concio.solvers.path.record import EventPath
from concio.solvers.statics.collapse_state import CollapseState
from concio.solvers.statics.friction import FrictionMargin
from concio.solvers.statics.limit import LimitLoad

if TYPE_CHECKING:
    from concio.plot.limit_accessor import LimitPlots

Array = np.ndarray

NOT_ASKED = "not asked for"


@dataclass(frozen=True, eq=False)
class LimitResult:
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
    friction : FrictionMargin or None
        Smallest friction with which admissible forces carry the load as given; None where that was not asked for.
    lent_compliance : float
        Normal compliance lent to hard joints of rigid blocks [m/kN]; 0 where none was needed.
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
    friction: FrictionMargin | None = None
    lent_compliance: float = 0.0

    def __repr__(self) -> str:
        from concio.report.limit_wording import limit_lines

        title, *lines = limit_lines(self)
        return "\n".join([f"LimitResult: {title}", *lines])

    def _repr_html_(self) -> str:
        from concio.report.notebook import limit_html

        return limit_html(self)

    @property
    def plot(self) -> LimitPlots:
        """Figures by name: ``limit.plot.mechanism()``; matplotlib is loaded here."""
        from concio.plot.limit_accessor import LimitPlots

        return LimitPlots(self)

    @property
    def carried(self) -> float:
        """Largest multiplier that Coulomb friction was found to carry on a path or in steps; ``nan`` without both."""
        path = self.path.peak if self.path is not None else -np.inf
        steps = self.steps.carried if self.steps is not None and self.steps.multipliers else -np.inf
        most = max(path, steps)
        return most if np.isfinite(most) else float("nan")

    @property
    def coulomb(self) -> float:
        """Collapse multiplier of the Coulomb path; ``nan`` without a path and where none was shown."""
        return self.path.peak if self.path is not None and self.collapse_shown else float("nan")

    @property
    def bracket(self) -> tuple[float, float]:
        """(least Coulomb multiplier found, associated multiplier): what was carried or a collapse state, the lesser.

        The peak of a path that was lost counts, and the last certified load step: the structure carries it, and
        collapses at it or above.
        """
        state = self.collapse_state.multiplier if self.collapse_state is not None else np.inf
        carried = self.coulomb if self.collapse_shown else self.carried
        low = min(carried if np.isfinite(carried) else np.inf, state)
        return (low if np.isfinite(low) else float("nan")), self.associated.multiplier

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

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        a = self.associated
        return {
            "engine": self.assembly.model.engine,
            "associated": "locked" if a.locked else "bounded",
            "associated_multiplier": _finite(a.multiplier),
            "associated_upper_bound": _finite(a.upper),
            "duality_gap": a.gap,
            "static_residual": a.residual,
            "mechanism_violation": None if a.mechanism is None else a.mechanism.violation,
            "checked": a.checked,
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
