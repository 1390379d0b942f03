"""``path.plot.curve()``, ``path.plot.stages()``: figures of load paths by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from concio.plot.path_figure import plot_path
from concio.post.path_curve import most_moving, path_curve
from concio.representation import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.path_result import PathResult
    from concio.model.stages import ControlPoint

MOST_STAGES = 4
"""More stages than this are not drawn beside each other: the last ones are."""


@short_repr
@dataclass(frozen=True, eq=False)
class PathPlots:
    """Figures of a load path.

    Parameters
    ----------
    path : PathResult
    """

    path: PathResult

    def curve(self, ax: Axes | None = None, *, point: ControlPoint | None = None, stage: int = -1) -> Axes:
        """Draw the load of a stage against the motion of a point.

        Parameters
        ----------
        ax : Axes, optional
        point : ControlPoint, optional
            By default the point that moved most in the end.
        stage : int
            By default the last one that was begun.
        """
        chosen = most_moving(self.path) if point is None else point
        name, _ = self.path.load(stage)
        number = stage % len(self.path.outcomes)
        return plot_path(
            path_curve(self.path, chosen, number),
            ax,
            control_label=f"displacement of '{chosen.body}' [m]",
            parameter_label=name if name.startswith("share") else f"multiplier of {name} [-]",
            title=self.path.stages[number].name,
        )

    def stages(self, *, point: ControlPoint | None = None) -> list[Axes]:
        """Draw every stage that was begun in axes of its own, beside each other in one figure.

        Parameters
        ----------
        point : ControlPoint, optional
            By default the point that moved most in the end.
        """
        from concio.plot.shown import new_figure

        chosen = most_moving(self.path) if point is None else point
        numbers = list(range(len(self.path.outcomes)))[-MOST_STAGES:]
        figure = new_figure((max(7.6, 4.6 * len(numbers)), 4.8), layout="constrained")
        return [
            self.curve(ax, point=chosen, stage=number)
            for number, ax in zip(numbers, figure.subplots(1, len(numbers), squeeze=False)[0], strict=True)
        ]
