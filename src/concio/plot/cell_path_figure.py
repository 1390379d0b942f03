"""Figure of the path of a cell: macroscopic stress against macroscopic strain, with its events."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.cells.periodic_cell import component
from concio.arguments import strict
from concio.contact.macroscopic_strain import COMPONENTS
from concio.plot.path_figure import plot_path
from concio.post.path_curve import Curve, CurveEvent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cells.cell_path_result import CellPath


@strict
def plot_cell_path(
    path: CellPath, ax: Axes | None = None, *, strain: str | None = None, stress: str | None = None
) -> Axes:
    """Draw a component of stress against a component of strain along a path, with its events.

    Parameters
    ----------
    path : CellPath
    ax : Axes, optional
        Where to draw; default a new figure.
    strain, stress : str, optional
        Components "xx", "yy", "xy"; default the strain that the last stage moves most, and the stress of that name.

    Returns
    -------
    Axes
    """
    if strain is None:
        last = [k for k, s in enumerate(path.steps) if s.stage == len(path.outcomes) - 1]
        strain = COMPONENTS[int(np.argmax(np.ptp(path.strain[[max(last[0] - 1, 0), *last]], axis=0)))]
    stress = strain if stress is None else stress
    e, s = path.strain[:, component(strain)], path.stress[:, component(stress)]
    events = tuple(CurveEvent(float(s[v.step]), float(e[v.step]), v.kind, " | ".join(v.bodies)) for v in path.events)
    return plot_path(
        Curve(e, s, events), ax, control_label=f"strain {strain} [-]", parameter_label=f"stress {stress} [kN/m2]",
        title=path.cell.model.title or "Path of a cell", unit="kN/m2",
    )  # fmt: skip
