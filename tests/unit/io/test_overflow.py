"""Numbers that a computer can write and no structure has: one message, exit code 2, and no warning of a library."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import pytest

from commands import run
from concio import Body, GeometryError, InputError, Polyhedron, Rigid
from concio.units import quantity
from ifc_files import IfcText
from pillars import pillar, sideways

HUGE = ("1e308", "-1e308", "1e200", "1.7976931348623157e308")
PLACES = {
    "a corner": ("[-0.2, 0.0]", "[{}, 0.0]"),
    "all corners": ("[-0.2, 0.0], [0.2, 0.0], [0.2, 1.6], [-0.2, 1.6]",
                    "[-{0}, 0.0], [{0}, 0.0], [{0}, {0}], [-{0}, {0}]"),
    "the floor": ("[-3.0, -0.5]", "[{}, -0.5]"),
    "a load": ("value = [0.2, 0.0]", "value = [{}, 0.0]"),
    "a weight": ('"20 kN/m3"', "{}"),
}  # fmt: skip
CUBE = "\n".join(
    [f"v {x} {y} {z}" for x in (0, 1) for y in (0, 1) for z in (0, "{top}")]
    + ["f 1 2 4 3", "f 5 7 8 6", "f 1 5 6 2", "f 3 4 8 7", "f 1 3 7 5", "f 2 6 8 4", ""]
)
SOLIDS = 'solids_file = "{name}"\n[materials.block]\nkind = "rigid"\nunit_weight = 20\n[joints.dry]\nfriction = 0.6\n'


def refused(path: Path, command: str = "run") -> str:
    """Return the message of a command that refuses a file, which is all that it prints."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        code, out, err = run(command, path)
    assert (code, out) == (2, ""), (code, out, err)
    lines = [line for line in err.splitlines() if line]
    assert lines[0].startswith("Error: ")
    assert sum(line.startswith("Error: ") for line in lines) == 1
    assert not any(word in err for word in ("Traceback", "Warning", "overflow", "nan"))
    return err


@pytest.mark.parametrize("number", HUGE)
@pytest.mark.parametrize("place", PLACES)
def test_a_model_file_with_a_number_beyond_any_structure(place: str, number: str, tmp_path: Path) -> None:
    old, new = PLACES[place]
    text = pillar(sideways(0.2)).replace("-3.0, -0.5", "-3.0, -0.5")
    assert old in text, text
    path = tmp_path / "model.toml"
    path.write_text(text.replace(old, new.format(number).replace("--", "")))
    assert "model.toml" in refused(path)


@pytest.mark.parametrize("number", HUGE)
def test_solids_of_an_obj_file(number: str, tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text("o cube\n" + CUBE.replace("{top}", number))
    path = tmp_path / "model.toml"
    path.write_text(SOLIDS.format(name="cube.obj"))
    refused(path)
    refused(path, "check")


@pytest.mark.parametrize("number", HUGE)
def test_solids_of_an_ifc_file(number: str, tmp_path: Path) -> None:
    made = IfcText()
    box = Polyhedron.box("b", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    made.product("cube", made.brep(box.vertices, box.faces))
    path = made.write(tmp_path / "cube.ifc")
    text = path.read_text()
    assert "0.,1.)" in text or "0.0,1.0)" in text
    path.write_text(re.sub(r"1\.0?\)\)", number + "))", text, count=1))
    model = tmp_path / "model.toml"
    model.write_text(SOLIDS.format(name="cube.ifc"))
    refused(model)
    refused(model, "check")


def test_a_quantity_beyond_any_structure_is_refused_in_python_and_infinity_keeps_its_meaning() -> None:
    with pytest.raises(InputError, match=r"1e\+40 is a number that no structure has"):
        Rigid(unit_weight=1e40)
    with pytest.raises(GeometryError, match=r"holds a coordinate of 1e\+60 m"):
        Body("b", [(0.0, 0.0), (1e60, 0.0), (1e60, 1.0)])
    assert quantity(float("inf"), "force") == float("inf")
