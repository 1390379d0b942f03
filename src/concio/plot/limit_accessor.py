"""``limit.plot.mechanism()`` and its like: the motions that a limit load is known by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.result import Result
from concio.errors import InputError
from concio.plot.deformed import plot_mechanism
from concio.problem.solution import Mechanism, Status, failed
from concio.representation import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.limit_result import LimitResult

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class LimitPlots:
    """Figures of a limit load. Each method takes ``ax=`` and returns the axes it drew on.

    Parameters
    ----------
    found : LimitResult
    """

    found: LimitResult

    def mechanism(self, ax: Axes | None = None) -> Axes:
        """Draw the associated mechanism."""
        bound = self.found.associated
        if bound.mechanism is None:
            msg = "there is no mechanism to draw: no load bounds it"
            raise InputError(msg)
        return self._draw(
            ax, bound.mechanism.velocity, f"Associated mechanism at {bound.multiplier:.6g} times {self._load}",
            "joints that slide open by the friction coefficient times their slip",
        )  # fmt: skip

    def collapse_state(self, ax: Axes | None = None) -> Axes:
        """Draw how the structure begins to move in the collapse state."""
        state = self.found.collapse_state
        if state is None:
            msg = f"there is no collapse state to draw: {self.found.search}"
            raise InputError(msg)
        title = f"Coulomb collapse state at {state.multiplier:.6g} times {self._load}"
        return self._draw(ax, state.velocity, title, "joints that slide stay closed")

    def path_mechanism(self, ax: Axes | None = None) -> Axes:
        """Draw the motion at the end of the Coulomb path."""
        path = self.found.path
        if path is None or not np.abs(path.direction).any():
            msg = "there is no motion at the end of a path to draw"
            raise InputError(msg, hint="follow the path with path=True")
        end = "end of the Coulomb path" if self.found.collapse_shown else "point where the Coulomb path was lost"
        title = f"Motion at the {end}, peak {self.found.carried:.6g} times {self._load}"
        return self._draw(ax, path.direction, title, "joints that slide stay closed")

    def motions(self) -> list[tuple[str, Result]]:
        """Return every motion that the limit load is known by, with what it is, as a result that draws it."""
        found, bound, state, path = self.found, self.found.associated, self.found.collapse_state, self.found.path
        known: list[tuple[str, Array]] = []
        if state is not None:
            known.append((f"collapse state at {state.multiplier:.6g} times {self._load}", state.velocity))
        if path is not None and np.abs(path.direction).any():
            known.append((f"end of the path, peak {found.carried:.6g} times {self._load}", path.direction))
        if bound.mechanism is not None:
            words = f"associated mechanism at {bound.multiplier:.6g} times {self._load}"
            known.append((words, bound.mechanism.velocity))
        return [(words, self._moving(velocity)) for words, velocity in known]

    @property
    def _load(self) -> str:
        return "the load of '" + "' and '".join(self.found.groups) + "'"

    def _moving(self, velocity: Array) -> Result:
        """Return a result whose mechanism is a motion (N,) of the free unknowns."""
        assembly = self.found.assembly
        motion = Mechanism(velocity / float(np.abs(velocity).max()), 0.0, 0.0)
        solution = failed(assembly.problem(), Status.NO_EQUILIBRIUM, method="limit", mechanism=motion)
        return Result(assembly, {}, solution, {})

    def _draw(self, ax: Axes | None, velocity: Array, title: str, note: str) -> Axes:
        """Draw a motion (N,) of the free unknowns."""
        result = self._moving(velocity)
        if result.model.dim == 3:
            from concio.plot.space_figures import plot_space

            return plot_space(result, ax)
        return plot_mechanism(result, ax, title=title, note=note)
