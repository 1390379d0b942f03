"""Fits of motions to measurements: what a choice of candidates reaches beside what a part of it reaches."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.cracks.fit import Fit, Fitter

ASTRAY = [0.0, 1.0, 2.0, 3.0, 4.0, 4.5, 6.0, 20.0], [1.0, 0.8, 3.0, 3.0, 2.5, 2.0, 3.0, 9.0]
"""From rest the second motion seems to help further on, where it does not; it does close by."""
LATE = [0.0, 0.9, 1.0, 3.0, 4.0, 20.0], [1.0, 1.0, 0.995, 0.0, 0.1, 9.0]
"""At first the second motion changes nothing, then little; it helps further on."""


class Wave:
    """Predictions of readings: the first is the first motion, five follow a line of the second motion.

    Parameters
    ----------
    line : (list, list)
    """

    def __init__(self, line: tuple[list[float], list[float]]) -> None:
        self.line = line

    def predict(self, motions: np.ndarray) -> SimpleNamespace:
        """Return the prediction of two motions."""
        wave = float(np.interp(motions[1], *self.line))
        return SimpleNamespace(reached=True, values=np.array([motions[0], *5 * [wave]]), motions=motions)


def fits(line: tuple[list[float], list[float]], most: float) -> tuple[Fit, Fit, Fit]:
    """Return the fit of the first motion, of both from rest, and of both beside the first."""
    one = np.ones(6)
    fitter = Fitter(Wave(line), np.array([1.0, *5 * [0.0]]), one, np.zeros(2), np.array([50.0, most]), one[:2])
    alone = fitter.fit((0,), allowed=1e-3)
    rest, both = (fitter.fit((0, 1), allowed=1e-3, part=part) for part in (None, alone))
    assert alone is not None
    assert rest is not None
    assert both is not None
    assert alone.misfit == pytest.approx(5.0)
    assert both.motions[0] == pytest.approx(1.0, abs=0.01)
    return alone, rest, both


def test_two_motions_fit_no_worse_than_one_of_them() -> None:
    alone, rest, both = fits(ASTRAY, 50.0)
    assert rest.misfit > alone.misfit
    assert both.misfit < 0.9 * alone.misfit


def test_a_choice_is_fitted_from_rest_where_its_part_does_not_lead_on() -> None:
    _, rest, both = fits(LATE, 4.0)
    assert rest.misfit < 0.1
    assert both.misfit <= 1.05 * rest.misfit, (both.misfit, rest.misfit)
