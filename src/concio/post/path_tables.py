"""The tables of a load path: its curve and its events, with the columns of the CSV files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.model.stages import ControlPoint
from concio.post.path_curve import most_moving
from concio.post.result_tables import Table
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.path_result import PathResult


@short_repr
@dataclass(frozen=True, eq=False)
class PathTables:
    """Tables of a path as dicts of arrays; lengths in m, forces in kN.

    Parameters
    ----------
    path : PathResult

    Examples
    --------
    >>> import concio
    >>> wall = concio.wall(length=1.0, height=0.5, friction=0.6, horizontal=0.3, block="rigid")
    >>> path = concio.run_path(wall, [concio.Stage("weight", {"dead": 1.0}), concio.Stage("wind", {"live": 1.0})])
    >>> curve = path.tables.curve()
    >>> list(curve)
    ['stage [-]', 'parameter [-]', 'displacement [m]', 'factor dead [-]', 'factor live [-]', 'point']
    >>> float(curve["factor live [-]"][-1]), len(curve["stage [-]"]) == len(path.steps)
    (1.0, True)
    >>> str(path.tables.curve(concio.ControlPoint("c01-b01", at=(0.0, 0.1)))["point"][0])
    'c01-b01 at (0, 0.1) m, along (1, 0)'
    """

    path: PathResult

    def curve(self, point: ControlPoint | None = None) -> Table:
        """Return a row for each step: stage, displacement of a point, load factors, tensions of ties, and which point.

        Parameters
        ----------
        point : ControlPoint, optional
            By default the point that moves most.
        """
        path = self.path
        point = most_moving(path) if point is None else point
        motion, parameter = path.curve(point)
        tension = np.array([step.state.normal_force[path.assembly.ties] for step in path.steps])
        return {
            "stage [-]": np.array([step.stage + 1 for step in path.steps]),
            "parameter [-]": parameter,
            "displacement [m]": motion,
            **{f"factor {g} [-]": np.array([s.factors[g] for s in path.steps]) for g in path.assembly.groups},
            **{f"tension {tie.name} [kN]": tension[:, k] for k, tie in enumerate(path.assembly.model.ties)},
            "point": np.array([_in_words(point)] * len(path.steps)),
        }

    def events(self) -> Table:
        """Return a row for each event: stage, kind, the two bodies and the position."""
        events, dim = self.path.events, self.path.assembly.model.dim
        return {
            "stage [-]": np.array([e.stage + 1 for e in events]),
            "parameter [-]": np.array([e.parameter for e in events]),
            "kind": np.array([e.kind for e in events]),
            "body_a": np.array([e.bodies[0] for e in events]),
            "body_b": np.array([e.bodies[1] for e in events]),
            **{f"{axis} [m]": np.array([e.at[k] for e in events]) for k, axis in enumerate("xyz"[:dim])},
        }

    def all(self) -> dict[str, Table]:
        """Return all tables by name."""
        return {"curve": self.curve(), "events": self.events()}


def _in_words(point: ControlPoint) -> str:
    at, along = (", ".join(f"{x + 0.0:.6g}" for x in v) for v in (point.at, point.direction))
    return f"{point.body} at ({at}) m, along ({along})"
