"""Fits of motions to measurements: what a choice of candidates reaches beside what a part of it reaches."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.cracks.fit import Fitter

WAVE = [0.0, 1.0, 2.0, 3.0, 4.0, 4.5, 6.0, 20.0], [1.0, 0.8, 3.0, 3.0, 2.5, 2.0, 3.0, 9.0]


class Wavy:
    """Predictions of readings: the first is the first motion, the second falls and rises with the second motion."""

    @staticmethod
    def predict(motions: np.ndarray) -> SimpleNamespace:
        values = np.array([motions[0], np.interp(motions[1], *WAVE), 0.0])
        return SimpleNamespace(reached=True, values=values, motions=motions)


def test_two_motions_fit_no_worse_than_one_of_them() -> None:
    """From rest the second motion is led astray, to a misfit of 4; beside the first one it is not."""
    one = np.ones(3)
    fitter = Fitter(Wavy(), np.array([1.0, 0.0, 0.0]), one, np.zeros(2), np.full(2, 50.0), one[:2])
    alone = fitter.fit((0,), allowed=1e-3)
    assert alone is not None
    astray, both = (fitter.fit((0, 1), allowed=1e-3, part=part) for part in (None, alone))
    assert astray is not None
    assert both is not None
    assert alone.misfit == pytest.approx(1.0)
    assert astray.misfit > 1.5
    assert both.misfit < 0.9
    assert both.motions[0] == pytest.approx(1.0, abs=0.01)
