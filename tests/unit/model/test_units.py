"""Values with units become numbers in kN and m."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from concio.errors import InputError
from concio.units import KINDS, LARGEST, SYMBOL, quantity

KNOWN = [
    ("100 MPa", "stress", 1e5),
    ("1e5 kN/m2", "stress", 1e5),
    ("1 N/mm2", "stress", 1e3),
    ("1 N/mm^2", "stress", 1e3),
    ("1 kN/m²", "stress", 1.0),
    ("2 GPa", "stress", 2e6),
    ("1 bar", "stress", 100.0),
    ("20 kN/m3", "unit weight", 20.0),
    ("20 kN/m³", "unit weight", 20.0),
    ("1 kgf", "force", 9.80665e-3),
    ("5 mm", "length", 5e-3),
    ("20cm", "length", 0.2),
    ("1 in", "length", 0.0254),
    ("-3 kN", "force", -3.0),
    ("7 N/m", "line load", 7e-3),
    ("1 MPa/m", "joint stiffness", 1e3),
    ("1 N/mm", "stiffness", 1.0),
    ("3 kN m", "moment", 3.0),
    (".5 m", "length", 0.5),
    ("0.6", "number", 0.6),
    ("4", "length", 4.0),
]


@pytest.mark.parametrize(("text", "kind", "value"), KNOWN)
def test_units_we_know(text: str, kind: str, value: float) -> None:
    assert quantity(text, kind) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_a_bare_number_is_in_kn_and_m_already(kind: str) -> None:
    assert quantity(3.25, kind) == 3.25
    assert quantity(f"3.25 {SYMBOL[kind]}", kind) == pytest.approx(3.25, rel=1e-15)


@pytest.mark.parametrize(
    ("value", "kind", "said"),
    [
        ("5 kN", "length", "'5 kN' is not a length (expected a unit like m)"),
        ("5 m", "number", "'5 m' must be a plain number"),
        ("5 furlongs", "length", "unknown unit 'furlongs'"),
        ("thick", "length", "'thick' is not a number with a unit"),
        ("1,5 m", "length", "unknown unit ',5 m' in '1,5 m' (the decimal separator is a point"),
        ("half", "number", "'half' is not a number with a unit (write for example 1.5)"),
        (math.nan, "length", "NaN"),
        ("nan", "length", "NaN"),
        (None, "length", "None is not a number"),
        ([1], "length", "is not a number"),
        ("5 kPa m", "length", "is not a length"),
        ("35 -", "length", "unknown unit '-'"),
    ],
)
def test_what_is_not_a_quantity(value: object, kind: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        quantity(value, kind, where="joint")  # type: ignore[arg-type]
    assert str(caught.value).startswith("joint: ")
    assert said in str(caught.value)


@given(st.floats(-LARGEST, LARGEST), st.sampled_from(sorted(KINDS)))
def test_writing_and_reading_a_number_with_its_unit(number: float, kind: str) -> None:
    assert quantity(f"{number!r} {SYMBOL[kind]}", kind) == number


def test_a_plain_number_with_an_unknown_unit_and_one_with_an_angle_are_told_apart() -> None:
    with pytest.raises(InputError, match="unknown unit 'foo' in '3 foo'"):
        quantity("3 foo", "number")
    with pytest.raises(InputError, match="'3 deg' must be a plain number"):
        quantity("3 deg", "number")
