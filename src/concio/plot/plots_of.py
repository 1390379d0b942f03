"""The figures of a result, whatever its dimension."""

from __future__ import annotations

from typing import TYPE_CHECKING

from concio.plot.accessor import Plots
from concio.plot.space_accessor import SpacePlots

if TYPE_CHECKING:
    from concio.analysis.result import Result


def plots_of(result: Result) -> Plots:
    """Return the figures of a result, in the plane or in space."""
    return Plots(result) if result.model.dim == 2 else SpacePlots(result)
