"""Tables beside a model file whose [units] are not in m: a bare number was read in m where its author meant mm."""

from __future__ import annotations

from pathlib import Path

import pytest

import concio
from concio.analysis.cracks.diagnosis_asked import read_measurements
from concio.errors import InputError
from concio.model.body import Body
from concio.model.file.block_table import write_blocks

MODEL = """
blocks_file = "{table}"
[units]
force = "N"
length = "{unit}"
[analysis]
thickness = 30.0
[materials.block]
kind = "rigid"
unit_weight = 0.02
[joints.dry]
friction = 0.6
[[loads]]
kind = "weight"
value = [0, -1]
"""
ROWS = 'soil,"0 -20; 200 -20; 200 0; 0 0",,fixed,\npier,"10 0; 50 0; 50 120; 10 120",block,,{thickness}\n'


def written(folder: Path, text: str, table: str = "b.csv", unit: str = "cm") -> Path:
    """A model file that counts in some unit, and its table of blocks."""
    (folder / table).write_text(text)
    file = folder / "m.toml"
    file.write_text(MODEL.format(table=table, unit=unit))
    return file


@pytest.mark.parametrize("thickness", ["25", "250 mm"])
def test_a_column_has_the_unit_of_its_heading(tmp_path: Path, thickness: str) -> None:
    rows = ROWS.format(thickness=thickness)
    model = concio.load(written(tmp_path, f"name,outline [cm],material,kind,thickness [cm]\n{rows}"))
    _, pier = model.bodies
    assert isinstance(pier, Body)
    assert (pier.area, pier.thickness) == pytest.approx((0.4 * 1.2, 0.25))
    said = "name,outline [cm],thickness,mesh_size\na,0 0; 40 0; 40 20,250 mm,\n"  # the cell says it, or is empty
    (plate,) = concio.load(written(tmp_path, said)).bodies
    assert isinstance(plate, Body)
    assert (plate.thickness, plate.mesh_size) == (0.25, None)
    holed = "name,outline [cm],holes [cm]\na,0 0; 40 0; 40 20; 0 20,10 5; 20 5; 20 15\n"
    (plate,) = concio.load(written(tmp_path, holed)).bodies
    assert isinstance(plate, Body)
    assert plate.area == pytest.approx(0.4 * 0.2 - 0.1 * 0.1 / 2)


@pytest.mark.parametrize(
    ("table", "text", "hint"),
    [
        ("b.csv", "name,outline,material,kind\na,0 0; 40 0; 40 20,block,\n", "'outline \\[cm\\]'"),
        ("b.csv", "name,outline [cm],thickness\na,0 0; 40 0; 40 20,25\n", "'thickness \\[cm\\]'"),
        ("b.json", '{"blocks": [{"name": "a", "outline": [[0, 0], [40, 0], [40, 20]]}]}', '"unit": "cm"'),
        ("b.json", '[{"name": "a", "outline": [[0, 0], [40, 0], [40, 20]]}]', '"unit": "cm"'),
        ("b.json", '{"unit": "cm", "blocks": [{"name": "a", "outline": [[0, 0], [4, 0], [4, 2]], "thickness": 25}]}',
         '"thickness": "25 cm"'),
        ("b.json", '{"unit": "cm", "blocks": [{"name": "a", "outline": [[0, 0], [4, 0], [4, 2]], "mesh_size": "3"}]}',
         '"mesh_size": "3 cm"'),
        ("b.json", '{"unit": "", "blocks": [{"name": "a", "outline": [[0, 0], [40, 0], [40, 20]]}]}', '"unit": "cm"'),
        ("b.csv", "name,outline (cm)\na,0 0; 40 0; 40 20\n", "brackets: outline \\[cm\\]"),
        ("b.csv", "name,outline [cm],holes [mm]\na,0 0; 40 0; 40 20,1 1; 2 1; 2 2\n", "unit of the outline"),
    ],
)  # fmt: skip
def test_a_table_says_its_unit_where_the_file_counts_in_another_than_m(
    tmp_path: Path, table: str, text: str, hint: str
) -> None:
    with pytest.raises(InputError, match=hint):
        concio.load(written(tmp_path, text, table))


def test_a_table_of_a_file_in_metres_needs_no_unit(tmp_path: Path) -> None:
    text = "name,outline\na,0 0; 0.4 0; 0.4 0.2\n,\n\n"
    (block,) = concio.load(written(tmp_path, text, unit="m")).bodies
    assert isinstance(block, Body)
    assert block.area == pytest.approx(0.04)


def test_measurements_say_their_unit_where_the_file_counts_in_another_than_m(tmp_path: Path) -> None:
    table = tmp_path / "c.csv"
    table.write_text("name,kind,value,error,body_a,body_b\nT1,tilt,0.002,0.001,a,\nK1,opening,0.2,1 mm,a,b\n")
    assert read_measurements(table)[1].value == 0.2
    with pytest.raises(InputError, match=r"line 3.*the unit of 'value'.*'value \[cm\]'"):
        read_measurements(table, length="cm")
    table.write_text("name,kind,value [cm],error,body_a,body_b\nT1,tilt,2 mrad,1 mrad,a,\nK1,opening,1.2,1 mm,a,b\n")
    assert read_measurements(table, length="cm")[1].value == pytest.approx(0.012)


def test_a_table_that_concio_wrote_is_read_beside_any_file_once_it_says_metres(tmp_path: Path) -> None:
    """Tables are written in metres: the hint named the unit of the file alone, a factor of 100 if it is followed."""
    blocks = (Body("a", ((0.0, 0.0), (0.4, 0.0), (0.4, 0.2)), kind="rigid", thickness=0.25),)
    write_blocks(tmp_path / "b.csv", blocks)
    text = (tmp_path / "b.csv").read_text()
    with pytest.raises(InputError, match=r"'outline \[m\]' where it is in metres"):
        concio.load(written(tmp_path, text))
    said = text.replace("outline", "outline [m]", 1).replace("thickness", "thickness [m]", 1)
    (read,) = concio.load(written(tmp_path, said)).bodies
    assert isinstance(read, Body)
    assert (read.area, read.thickness) == pytest.approx((0.04, 0.25))
