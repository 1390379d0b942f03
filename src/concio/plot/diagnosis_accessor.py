"""``found.plot.cracks()``, ``found.plot.readings()``, ``found.plot.causes()``: figures of a diagnosis by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from concio.plot.diagnosis_figure import plot_causes, plot_cracks, plot_readings
from concio.representation import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cracks.diagnosis import Diagnosis


@short_repr
@dataclass(frozen=True, eq=False)
class DiagnosisPlots:
    """Figures of a diagnosis.

    Parameters
    ----------
    found : Diagnosis
    """

    found: Diagnosis

    def cracks(self, ax: Axes | None = None, *, cause: int = 0, language: str = "en") -> Axes:
        """Draw the structure as a cause has moved it, measured beside predicted: :func:`plot_cracks`."""
        return plot_cracks(self.found, ax, cause=cause, language=language)

    def readings(self, ax: Axes | None = None, *, language: str = "en") -> Axes:
        """Draw every measurement and what each cause predicts: :func:`plot_readings`."""
        return plot_readings(self.found, ax, language=language)

    def causes(self, ax: Axes | None = None, *, language: str = "en") -> Axes:
        """Draw the motions of every cause with their intervals: :func:`plot_causes`."""
        return plot_causes(self.found, ax, language=language)
