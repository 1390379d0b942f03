"""The figures that suit a result, and writing them as PNG and SVG."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from concio.plot.plots_of import plots_of
from concio.plot.space_accessor import SpacePlots

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result

VIEWS = ("axonometry", "front", "side", "plan")
FORMATS = ("png", "svg")

TITLES: dict[str, str] = {
    "model": "The model",
    "deformed": "Deformed shape and state of the joints",
    "principal": "Mean principal stresses of each block",
    "stress": "Mean principal stresses of each element",
    "forces": "Force chains",
    "pressure": "Contact pressure along the joints",
    "slip": "Opening and slip of the joints",
    "thrust": "Line of thrust",
    "mechanism": "Collapse mechanism",
    **{f"deformed_{view}": f"Displaced shape and joints that open or slip, {view}" for view in VIEWS},
    **{f"mechanism_{view}": f"Collapse mechanism, {view}" for view in VIEWS},
}
"""Captions of the figures by name."""


def suitable_figures(result: Result) -> dict[str, Callable[[], Axes]]:
    """Return the figures that make sense for a result: what draws each, by name.

    A collapse shows its mechanism and no stresses; an outcome without an answer shows the model alone.
    """
    plots = plots_of(result)
    if isinstance(plots, SpacePlots):
        return plots.suitable()
    found: dict[str, Callable[[], Axes]] = {"model": plots.model}
    if result.mechanism is not None:
        found["mechanism"] = plots.mechanism
    if not result.solved:
        return found
    found["deformed"] = plots.deformed
    if any(b.kind == "elastic" for b in result.model.bodies):
        found["principal"] = plots.principal
        found["stress"] = lambda: plots.principal(of="elements")
    found["forces"] = plots.forces
    found["pressure"] = plots.pressure
    found["slip"] = plots.slip
    from concio.post.thrust_line import thrust_lines

    if 2 * sum(len(line.points) for line in thrust_lines(result)) > len(result.model.free_bodies):
        found["thrust"] = plots.thrust
    return found


def write_figures(
    result: Result,
    directory: Path,
    formats: tuple[str, ...] = FORMATS,
    dpi: int = 150,
    then: Callable[[str, Axes], object] | None = None,
) -> list[Path]:
    """Write the figures of a result into an existing directory.

    Parameters
    ----------
    result : Result
    directory : Path
    formats : tuple of str
        Endings matplotlib knows: "png", "svg", "pdf".
    dpi : int
        Dots per inch of images.
    then : callable, optional
        Takes the name and the axes of each figure once it is written, before the next is drawn: a figure in space
        takes longer to draw than to write.

    Returns
    -------
    list of Path
    """
    import matplotlib as mpl

    written = []
    with mpl.rc_context({"svg.hashsalt": "concio", "svg.fonttype": "none"}):
        for name, draw in suitable_figures(result).items():
            axes = draw()
            figure = axes.get_figure(root=True)
            assert figure is not None
            for ending in formats:
                path = directory / f"{name}.{ending}"
                figure.savefig(path, dpi=dpi, metadata={"Date": None} if ending == "svg" else None)
                written.append(path)
            if then is not None:
                then(name, axes)
    return written
