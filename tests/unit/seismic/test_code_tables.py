"""Tables of the codes as they are printed: soils, topographies, corner periods, reference lives and return periods."""

from __future__ import annotations

import math

import pytest

from concio.analysis.seismic.code import find_code
from concio.analysis.seismic.site import LARGEST, Hazard, Site
from concio.errors import InputError

NTC = {  # table 3.2.IV: S_S between low and high of constant - slope F0 a_g/g, and C_C = factor T_C*^power; T_E
    "A": (1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 4.5), "B": (1.40, 0.40, 1.00, 1.20, 1.10, -0.20, 5.0),
    "C": (1.70, 0.60, 1.00, 1.50, 1.05, -0.33, 6.0), "D": (2.40, 1.50, 0.90, 1.80, 1.25, -0.50, 6.0),
    "E": (2.00, 1.10, 1.00, 1.60, 1.15, -0.40, 6.0),
}  # fmt: skip
EN = {  # tables 3.2, 3.3 and A.1: S, T_B, T_C, T_D of types 1 and 2
    "A": ((1.0, 0.15, 0.4, 2.0), (1.0, 0.05, 0.25, 1.2)), "B": ((1.2, 0.15, 0.5, 2.0), (1.35, 0.05, 0.25, 1.2)),
    "C": ((1.15, 0.20, 0.6, 2.0), (1.5, 0.10, 0.25, 1.2)), "D": ((1.35, 0.20, 0.8, 2.0), (1.8, 0.10, 0.30, 1.2)),
    "E": ((1.4, 0.15, 0.5, 2.0), (1.6, 0.05, 0.25, 1.2)),
}  # fmt: skip


@pytest.mark.parametrize("soil", NTC)
@pytest.mark.parametrize("a_g", [0.03, 0.12, 0.25, 0.45])
@pytest.mark.parametrize(("topography", "hill"), [("T1", 1.0), ("T2", 1.2), ("T3", 1.2), ("T4", 1.4)])
def test_italian_spectra_have_the_corners_of_their_soil(soil: str, a_g: float, topography: str, hill: float) -> None:
    constant, slope, low, high, factor, power, T_E = NTC[soil]
    F0, T_star, g = 2.47, 0.31, find_code("ntc2018").gravity
    found = find_code("ntc2018").spectrum(a_g * g, F0, T_star, soil, topography)
    assert pytest.approx(hill * min(max(constant - slope * F0 * a_g, low), high)) == found.S
    T_C = factor * T_star**power * T_star
    assert pytest.approx((T_C / 3.0, T_C)) == (found.T_B, found.T_C)
    assert pytest.approx((4.0 * a_g + 1.6, T_E, 10.0)) == (found.T_D, found.T_E, found.T_F)
    assert (found.F0, found.a_g) == (F0, a_g * g)


@pytest.mark.parametrize("soil", EN)
@pytest.mark.parametrize("kind", [1, 2])
def test_european_spectra_have_the_corners_of_their_type(soil: str, kind: int) -> None:
    found = find_code("en1998").spectrum(1.3, 9.9, 9.9, soil, "T1", str(kind))
    assert pytest.approx(EN[soil][kind - 1]) == (found.S, found.T_B, found.T_C, found.T_D)
    assert (found.F0, found.a_g, found.T_F) == pytest.approx((2.5, 1.3, 10.0))


@pytest.mark.parametrize(
    ("nominal", "use", "life"),
    [(50, "I", 35.0), (50, "II", 50.0), (50, "III", 75.0), (50, "IV", 100.0), (20, "II", 35.0), (100, "III", 150.0)],
)
def test_reference_lives_are_those_of_table_2_4(nominal: float, use: str, life: float) -> None:
    assert find_code("ntc2018").reference_life(nominal, use) == pytest.approx(life)


@pytest.mark.parametrize(("level", "years"), [("SLO", 30.0), ("SLD", 50.0), ("SLV", 475.0), ("SLC", 975.0)])
def test_return_periods_of_a_life_of_fifty_years_are_the_known_ones(level: str, years: float) -> None:
    code = find_code("ntc2018")
    assert code.return_period(level, 50.0) == pytest.approx(years, rel=0.01)
    assert code.return_period(level, 150.0) == pytest.approx(3.0 * code.return_period(level, 50.0))


def test_what_the_tables_do_not_hold_is_refused() -> None:
    code = find_code("ntc2018")
    for wrong in ({"soil": "F"}, {"topography": "T5"}):
        with pytest.raises(InputError, match="there is no"):
            code.spectrum(1.0, 2.5, 0.3, **({"soil": "A", "topography": "T1"} | wrong))
    with pytest.raises(InputError, match="there is no class of use 'V'"):
        code.reference_life(50.0, "V")
    for nominal in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(InputError, match="must be positive"):
            code.reference_life(nominal, "II")


def test_limit_states_that_are_known_asked_for_and_ultimate() -> None:
    points = {level: {"a_g": a_g, "F0": 2.4, "Tc": 0.3} for level, a_g in (("SLV", 0.2), ("SLD", 0.1), ("SLO", 0.08))}
    site = Site(points)
    assert site.levels == ("SLO", "SLD", "SLV")
    assert site.ultimate(("SLO", "SLD", "SLV", "SLC")) == ("SLV", "SLC")
    assert site.ultimate(("SLV",)) == ("SLV",)
    assert site.ultimate(("SLO", "SLD")) == ("SLO", "SLD"), "where there is none, all of them"
    assert site.ultimate(()) == ()
    assert "SLO" not in site.asked_by_code
    assert {"SLD", "SLV"} <= set(site.asked_by_code)
    table = Site([{"T_R": T_R, "a_g": a_g, "F0": 2.4, "Tc": 0.3} for T_R, a_g in ((30, 0.05), (475, 0.2), (975, 0.3))])
    assert table.levels == table.asked_by_code


@pytest.mark.parametrize(
    ("key", "low", "high", "beyond"),
    [("a_g", 1e-6, LARGEST, LARGEST * 1.001), ("F0", 1.0, 5.0, 5.001), ("T_star", 0.05, 2.0, 2.001)],
)
def test_the_numbers_of_a_hazard_have_bounds(key: str, low: float, high: float, beyond: float) -> None:
    given = {"T_R": 475.0, "a_g": 0.2, "F0": 2.4, "T_star": 0.3}
    for value in (low, 0.5 * (low + high), high):
        assert getattr(Hazard(**(given | {key: value})), key) == value
    for value in (0.0, -0.1, 0.999 * low if low > 1e-3 else 0.0, beyond, math.inf, math.nan):
        with pytest.raises(InputError):
            Hazard(**(given | {key: value}))
