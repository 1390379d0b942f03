"""Numbers as people write them, in units of their choice."""

from __future__ import annotations

import math

import pytest

import concio
from concio.display import Units, number


@pytest.mark.parametrize(
    ("value", "size", "text"),
    [
        (0.0, 0.0, "0"),
        (-0.0, 0.0, "0"),
        (-4.49e-12, 10.0, "0"),
        (-4.49e-12, 0.0, "-4.49e-12"),
        (12.3456, 0.0, "12.3"),
        (-0.5, 0.0, "-0.5"),
        (99.97, 0.0, "100"),
        (999.7, 0.0, "1000"),
        (1234.5, 0.0, "1234"),
        (123456.0, 0.0, "123,500"),
        (0.000123, 0.0, "0.000123"),
        (1.2e-7, 0.0, "1.2e-7"),
        (math.inf, 0.0, "unlimited"),
        (math.nan, 0.0, "–"),
    ],
)
def test_number(value: float, size: float, text: str) -> None:
    assert number(value, size=size) == text


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("force", 12.34, "12.3 kN"),
        ("motion", -0.00123, "-1.23 mm"),
        ("motion", 5.56e-8, "0.0556 µm"),
        ("motion", 0.0, "0 mm"),
        ("length", 0.004, "4 mm"),
        ("length", 1.25, "1.25 m"),
        ("stress", 12.0, "12 kN/m2"),
        ("stress", -3.4e3, "-3.4 MPa"),
        ("modulus", 5e6, "5 GPa"),
        ("modulus", 1e5, "100 MPa"),
        ("unit weight", 20.0, "20 kN/m3"),
        ("moment", 3.0, "3 kN m"),
        ("rotation", 0.00021, "0.21 mrad"),
        ("compliance", 1e-6, "0.001 mm/kN"),
        ("number", 0.6, "0.6"),
    ],
)
def test_default_units(kind: str, value: float, text: str) -> None:
    assert Units().text(kind, value) == text


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        ("force", 12.34, "12,340 N"),
        ("length", 1.25, "1250 mm"),
        ("motion", -0.00123, "-1.23 mm"),
        ("stress", 12.0, "0.012 N/mm2"),
        ("modulus", 5e6, "5000 N/mm2"),
        ("unit weight", 20.0, "0.00002 N/mm3"),
        ("moment", 3.0, "3,000,000 N mm"),
    ],
)
def test_chosen_units(kind: str, value: float, text: str) -> None:
    units = Units.parse("N, mm, N/mm2")
    assert units == Units(force="N", length="mm", stress="N/mm2")
    told = units.text(kind, value)
    assert told == text or (kind == "unit weight" and told == "2e-5 N/mm3")


def test_signs_and_sizes() -> None:
    units = Units()
    assert units.text("force", 3.0, sign=True) == "+3 kN"
    assert units.text("force", 1e-12, size=5.0, sign=True) == "0 kN"
    assert units.text("stress", 10.0, size=5e3) == "0.01 MPa", "one unit for all that stand together"


def test_a_column_has_one_unit_and_equal_decimals() -> None:
    texts, symbol = Units().column("force", [12.3456, -0.1, 4.49e-12, math.nan])
    assert (texts, symbol) == (["12.35", "-0.10", "0", "–"], "kN")
    assert Units().column("stress", [1500.0, -20.0]) == (["1.500", "-0.020"], "MPa")
    assert Units().column("force", [0.0, -0.0]) == (["0", "0"], "kN")
    assert Units().column("force", [123456.7]) == (["123,457"], "kN")
    assert Units().column("force", [5.0, -0.0004])[0] == ["5.000", "0"], "no minus zero after rounding"


def test_units_that_are_none() -> None:
    with pytest.raises(concio.InputError, match=r"'lb' is not a unit of force for reports \(one of: kN, N"):
        Units(force="lb")
    with pytest.raises(concio.InputError, match=r"'MPA' is not a unit for reports \(did you mean 'MPa'"):
        Units.parse("kN, MPA")
    assert Units.parse("force = N, motion = cm") == Units(force="N", motion="cm")
