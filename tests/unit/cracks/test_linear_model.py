"""Where readings are linear in motions: fits, intervals and further motions are those of linear statistics."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2, norm

from concio.analysis.cracks.additions import additions_of
from concio.analysis.cracks.cause import cause_of
from concio.analysis.cracks.fit import FAR, Fitter, without_each
from concio.analysis.cracks.search import search

CONFIDENCE = 0.95


class Linear:
    """Readings A s of motions s, each of which is reached; motions beyond their bounds are not asked for."""

    def __init__(self, A: np.ndarray, most: np.ndarray) -> None:
        self.A, self.most = A, most

    def predict(self, motions: np.ndarray) -> SimpleNamespace:
        """Return the prediction of motions."""
        assert (np.abs(motions) <= self.most * (1 + 1e-12)).all()
        return SimpleNamespace(reached=True, values=self.A @ motions, motions=motions)


def measured(
    seed: int, n: int, k: int, moves: dict[int, float], noise: float = 1.0, most: float | np.ndarray = 50.0
) -> Fitter:
    """Return the fits of n readings of k candidates, of which some have moved; errors and units differ."""
    rng = np.random.default_rng(seed)
    unit = 10.0 ** rng.uniform(-3, 1, k)  # of the motions
    error = 10.0 ** rng.uniform(-4, -2, n)
    A = rng.normal(size=(n, k)) * error[:, None] / unit * 30.0
    s = np.zeros(k)
    for c, size in moves.items():
        s[c] = size * unit[c]
    value = A @ s + noise * error * rng.normal(size=n)
    return Fitter(Linear(A, most * unit), value, error, -most * unit, most * unit, unit)


def least(fitter: Fitter, chosen: tuple[int, ...], kept: np.ndarray | None = None) -> tuple[float, np.ndarray]:
    """Return misfit and motions of the weighted least squares of some candidates."""
    J = fitter.forward.A[:, list(chosen)] / fitter.error[:, None]
    b = fitter.value / fitter.error
    if kept is not None:
        J, b = J[kept], b[kept]
    scale = fitter.scale[list(chosen)]
    x = np.linalg.lstsq(J * scale, b, rcond=None)[0]
    off = J * scale @ x - b
    return float(off @ off), x * scale


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("chosen", [(1,), (0, 2), (0, 1, 3)])
def test_a_fit_is_that_of_least_squares_and_its_interval_the_normal_one(seed: int, chosen: tuple[int, ...]) -> None:
    fitter = measured(seed, 9, 4, dict.fromkeys(chosen, 2.0))
    fit = fitter.fit(chosen, allowed=chi2.ppf(CONFIDENCE, 9 - len(chosen)))
    assert fit is not None
    misfit, motions = least(fitter, chosen)
    assert fit.misfit == pytest.approx(misfit, rel=1e-3)
    assert fit.freedom == 9 - len(chosen)
    found = cause_of(fitter, fit, ("a", "b", "c", "d"), CONFIDENCE)
    J = fitter.forward.A[:, list(chosen)] / fitter.error[:, None]
    deviation = np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    assert found.motion == pytest.approx(motions, abs=0.02 * deviation.max() + 1e-9)
    assert found.high - found.motion == pytest.approx(norm.ppf(0.5 + CONFIDENCE / 2) * deviation, rel=0.05)
    assert found.motion - found.low == pytest.approx(norm.ppf(0.5 + CONFIDENCE / 2) * deviation, rel=0.05)
    assert found.probability == pytest.approx(chi2.sf(found.misfit, found.freedom), rel=1e-9)
    own = np.arange(9)
    without = [least(fitter, chosen, own != i)[0] for i in own]
    exact = replace(fit, residual=J @ motions - fitter.value / fitter.error, slope=J)
    assert without_each(exact) == pytest.approx(without, rel=1e-8)


@pytest.mark.parametrize("seed", range(6))
def test_causes_are_the_smallest_choices_within_the_quantile(seed: int) -> None:
    """Of every choice the misfit of least squares decides; choices that contain a cause are not tried."""
    fitter = measured(seed, 8, 4, {seed % 4: 3.0, (seed + 1 + seed // 4) % 4: -2.0}, noise=0.7)
    wanted: list[tuple[int, ...]] = []
    for size in range(4):
        limit = chi2.ppf(CONFIDENCE, 8 - size)
        for c in combinations(range(4), size):
            if not any(set(a) <= set(c) for a in wanted) and least(fitter, c)[0] <= limit:
                wanted.append(c)
    found = search(fitter, ["m0", "m1", "m2", "m3"], most=3, beyond=3, confidence=CONFIDENCE)
    assert sorted(f.chosen for f in found.accepted) == sorted(wanted)
    assert wanted


@pytest.mark.parametrize("seed", range(8))
def test_a_further_motion_is_named_where_the_misfit_falls_by_more_than_its_share_of_chance(seed: int) -> None:
    """One motion is large, another hardly above the errors; the quantile is that of one degree of freedom."""
    fitter = measured(seed, 8, 4, {0: 4.0, 2: 0.02 + 0.02 * (seed % 4)})
    names = ("a", "b", "c", "d")
    fit = fitter.fit((0,), allowed=chi2.ppf(CONFIDENCE, 7))
    assert fit is not None
    found = additions_of(fitter, cause_of(fitter, fit, names, CONFIDENCE), names, CONFIDENCE)
    clear = chi2.ppf(1 - (1 - CONFIDENCE) / 3, 1)
    alone = least(fitter, (0,))[0]
    falls = {names[c]: alone - least(fitter, (0, c))[0] for c in (1, 2, 3)}
    assert [a.name for a in found] == sorted((n for n, f in falls.items() if f > clear), key=lambda n: -falls[n])
    for addition in found:
        misfit, motions = least(fitter, (0, "abcd".index(addition.name)))
        assert addition.misfit == pytest.approx(misfit, rel=2e-3)
        assert addition.motions == pytest.approx(motions, rel=1e-2, abs=1e-2 * np.abs(motions).min())
        assert addition.motion == addition.motions[1]
    assert all((a.cause is not None) == (i == 0) for i, a in enumerate(found))


def test_one_measurement_more_than_motions_names_nothing_more() -> None:
    """The quantile of the cause itself, of one degree of freedom, is no higher than that of a further motion."""
    told = 0
    for seed in range(40):
        fitter = measured(seed, 2, 3, {0: 4.0}, noise=1.2)
        fit = fitter.fit((0,), allowed=chi2.ppf(CONFIDENCE, 1))
        assert fit is not None
        if fit.misfit <= chi2.ppf(CONFIDENCE, 1):
            told += 1
            cause = cause_of(fitter, fit, ("a", "b", "c"), CONFIDENCE)
            assert additions_of(fitter, cause, ("a", "b", "c"), CONFIDENCE) == ()
    assert 20 < told < 40


def test_intervals_end_at_the_bounds_of_motions_and_no_state_beyond_is_asked_for() -> None:
    """The first motion is at its bound, the second far from its own: along their line one of two is outside."""
    fitter = measured(2, 9, 2, {0: 2.0, 1: 2.0}, noise=0.5, most=np.array([2.0, 50.0]))
    fit = fitter.fit((0, 1), allowed=chi2.ppf(CONFIDENCE, 7))
    assert fit is not None
    found = cause_of(fitter, fit, ("a", "b"), CONFIDENCE)
    assert (found.low < found.motion).all()
    assert (found.high <= fitter.high).all()
    assert found.high[0] == pytest.approx(fitter.high[0], rel=1e-3)
    assert found.high[1] < 0.1 * fitter.high[1]


@pytest.mark.parametrize(("first_motion", "second_motion"), [(3.0, -1.0), (0.5, -0.1)])
def test_what_coarser_paths_turned_down_clearly_is_not_fitted_again(
    monkeypatch: pytest.MonkeyPatch, first_motion: float, second_motion: float
) -> None:
    """What is near to be allowed is, and what may be for the change of the readings; causes stay the same."""
    fitter = measured(4, 8, 4, {1: first_motion, 2: second_motion})
    names = ["m0", "m1", "m2", "m3"]
    first = search(fitter, names, most=3, beyond=3, confidence=CONFIDENCE)
    known = {t.chosen: t for t in first.trials}
    fitted: list[tuple[int, ...]] = []
    fit = fitter.fit

    def counted(chosen: tuple[int, ...], **options: object) -> object:
        fitted.append(chosen)
        return fit(chosen, **options)

    monkeypatch.setattr(fitter, "fit", counted)
    counts = []
    for change in (0.0, *np.geomspace(0.1, 300.0, 14).tolist(), 1e9):
        fitted.clear()
        found = search(fitter, names, most=3, beyond=3, confidence=CONFIDENCE, coarse=first.trials, change=change)
        assert {f.chosen for f in found.accepted} == {f.chosen for f in first.accepted}
        kept = {t.chosen for t in found.trials if t.coarse}
        assert kept.isdisjoint(fitted)
        for chosen in kept | set(fitted):
            limit = chi2.ppf(CONFIDENCE, 8 - len(chosen))
            least = np.sqrt(without_each(known[chosen].fit).min())
            far = known[chosen].fit.misfit > limit and least > min(np.sqrt(FAR * limit), np.sqrt(limit) + 2.0 * change)
            assert (chosen in kept) == far, chosen
        counts.append(len(fitted))
    assert counts == sorted(counts)
    assert counts[0] < counts[-1] or counts[0] < len(first.trials) - 1
    fitted.clear()
    left = [replace(t, fit=replace(t.fit, left=True)) if t.fit is not None else t for t in first.trials]
    search(fitter, names, most=3, beyond=3, confidence=CONFIDENCE, coarse=left, change=1e9)
    allowed = {t.chosen for t in first.trials if t.fit.misfit <= chi2.ppf(CONFIDENCE, 8 - len(t.chosen))}
    assert set(fitted) <= allowed
