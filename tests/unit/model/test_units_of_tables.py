"""A table says the same in every system of a file: of anchors, strengthenings, points of a motion, own vehicles."""

from __future__ import annotations

import tomllib

import pytest

from concio.errors import InputError
from concio.model.file.assessment_table import assessment_tables
from concio.model.file.motion_table import motion_table
from concio.model.file.reading import file_units, loads
from concio.model.file.writing import dumps

SYSTEMS = [("kN", "m", 1.0, 1.0), ("N", "mm", 1e3, 1e3), ("N", "m", 1e3, 1.0), ("MN", "cm", 1e-3, 1e2)]

BRIDGE = """
[bridge]
span = "6 m"
rise = "1.5 m"
ring = "0.45 m"
voussoirs = 9
width = "4 m"
unit_weight = "22 kN/m3"
[fill]
cover = "0.4 m"
unit_weight = "19 kN/m3"
[vehicle]
position = "2 m"
"""


def system(force: str, length: str) -> str:
    """Return the table of a system."""
    return f'[units]\nforce = "{force}"\nlength = "{length}"\n'


@pytest.mark.parametrize(("force", "length", "f", "m"), SYSTEMS)
def test_a_bare_number_is_in_the_system_of_the_file(force: str, length: str, f: float, m: float) -> None:
    text = system(force, length) + (
        f'[[assessment.anchors]]\ntie = "t"\nsteel_area = {3.14e-4 * m * m!r}\nsteel_strength = {2e5 * f / m / m!r}\n'
    )
    data = tomllib.loads(text)
    _, table = assessment_tables(data, file_units(data, "file"), "file")
    (anchor,) = table.anchors
    assert anchor.steel_area == pytest.approx(3.14e-4)
    assert anchor.steel_area * anchor.steel_strength == pytest.approx(62.8)
    data = tomllib.loads(system(force, length) + f'[[motion.points]]\nbody = "b"\nat = [{0.3 * m!r}, {1.1 * m!r}]\n')
    (point,) = motion_table(data, "file", file_units(data, "file")).points
    assert point.at == pytest.approx((0.3, 1.1))


@pytest.mark.parametrize(("force", "length", "f", "m"), SYSTEMS)
@pytest.mark.parametrize("kind", ["tie", "mass", "buttress", "grout"])
def test_the_largest_strengthening_is_what_it_is_of(kind: str, force: str, length: str, f: float, m: float) -> None:
    unit = {"buttress": m, "grout": f / m / m}.get(kind, f)
    for value in (repr(30.0 * unit), {"buttress": "'30 m'", "grout": "'30 kPa'"}.get(kind, "'30 kN'")):
        text = system(force, length) + f'[assessment.strengthen]\nkind = "{kind}"\nof = ["a"]\nlargest = {value}\n'
        data = tomllib.loads(text)
        _, table = assessment_tables(data, file_units(data, "file"), "file")
        assert table.strengthen is not None
        assert table.strengthen.largest == pytest.approx(30.0)


@pytest.mark.parametrize(("force", "length", "f", "m"), SYSTEMS)
def test_an_own_vehicle_is_read_with_its_units_and_never_guessed(force: str, length: str, f: float, m: float) -> None:
    head = system(force, length)
    said = "axles = [[0.0, '60 kN'], { at = '1.2 m', load = '100 kN' }]\nlanes = [['-1 m', '2.5 m', '10 kN/m']]\n"
    vehicle = loads(head + BRIDGE + said).vehicle
    assert vehicle is not None
    assert [(a.at, a.load, a.length) for a in vehicle.axles] == [
        pytest.approx((0.0, 60.0, None)), pytest.approx((1.2, 100.0, None)), pytest.approx((0.75, 35.0, 3.5)),
    ]  # fmt: skip
    for bare in ("axles = [[0.0, 60.0]]\n", "axles = [{ at = 0.0, load = 60 }]\n", "lanes = [['0 m', '5 m', 9]]\n"):
        if (f, m) == (1.0, 1.0):
            assert loads(head + BRIDGE + bare).vehicle is not None
            continue
        with pytest.raises(InputError, match="has a bare number") as caught:
            loads(head + BRIDGE + bare)
        assert "write its unit" in (caught.value.hint or "")


@pytest.mark.parametrize(("force", "length", "f", "m"), SYSTEMS)
def test_a_text_without_a_unit_is_a_bare_number(force: str, length: str, f: float, m: float) -> None:
    """In the system of the file too; "35 -" was 35 m in a file in mm."""
    arch = "[arch]\nspan = {}\nring = {}\nvoussoirs = 9\nunit_weight = {}\n"
    numbers = (2.0 * m, 0.35 * m, 20.0 * f / m**3)
    bare, text = (loads(system(force, length) + arch.format(*map(form, numbers))) for form in (repr, "'{!r}'".format))
    assert dumps(bare) == dumps(text)
    assert bare.size == pytest.approx(2.7, rel=0.01)
    with pytest.raises(InputError, match="unknown unit '-'"):
        loads(system(force, length) + arch.format(numbers[0], "'35 -'", numbers[2]))
