"""Keys of [analysis]: they hold for all blocks of a file, or are refused where they mean nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

import concio
from concio.errors import InputError
from samples import first

GENERATED = {
    "column": "width = 0.5\nheight = 1.0\nblocks = 2\n",
    "wall": "length = 0.8\nheight = 0.4\nblock_size = [0.4, 0.2]\n",
    "arch": "span = 2.0\nring = 0.3\nvoussoirs = 5\n",
    "panel": "courses = 2\nblocks = 2\nblock_size = [0.2, 0.1]\n",
    "buttress": "base = 1.0\ntop = 0.5\nheight = 2.0\ncourses = 2\n",
    "bridge": "span = 3.0\nrise = 0.75\nring = 0.3\nvoussoirs = 6\n",
}
STATED = "[analysis]\nthickness = 0.3\n"
STONES = """
[materials.stone]
kind = "rigid"
unit_weight = 20.0
[joints.dry]
friction = 0.6
"""


def depths(model: concio.Model) -> set[float]:
    return {round(float(b.thickness), 9) for b in model.outlines}


@pytest.mark.parametrize("name", first(3, GENERATED))
def test_the_thickness_of_a_file_is_that_of_generated_blocks(name: str) -> None:
    """A thickness of 0.3 m beside [column] was left aside: its blocks were "1 m, the default where none is given"."""
    table = f"[{name}]\n{GENERATED[name]}"
    own = depths(concio.loads(f"{table}thickness = 0.3\n"))
    assert depths(concio.loads(table + STATED)) == own == {0.3}
    assert depths(concio.loads(f"{table}thickness = 0.7\n{STATED}")) == {0.7}


def test_the_width_of_a_bridge_goes_before_the_thickness_of_the_file() -> None:
    assert depths(concio.loads(f"[bridge]\n{GENERATED['bridge']}width = 4.0\n{STATED}")) == {4.0}


def test_the_thickness_of_a_file_is_that_of_its_parts_and_of_its_table_of_blocks(tmp_path: Path) -> None:
    parts = f"[[parts]]\nname = 'one'\n[parts.column]\n{GENERATED['column']}"
    assert depths(concio.loads(parts + STATED)) == {0.3}
    (tmp_path / "b.csv").write_text(
        "name,outline,kind,material,thickness\ng,0 -1; 1 -1; 1 0; 0 0,fixed,,\na,0 0; 1 0; 1 1; 0 1,rigid,stone,\n"
        "b,0 1; 1 1; 1 2; 0 2,rigid,stone,0.8\n"
    )
    (tmp_path / "m.toml").write_text("blocks_file = 'b.csv'\n" + STONES + STATED)
    read = concio.load(tmp_path / "m.toml")
    assert [b.thickness for b in read.outlines] == [0.3, 0.3, 0.8]


SPACE = STONES + '[[blocks]]\nname = "cube"\nbox = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]\nmaterial = "stone"\n'
NOTHING = {
    "thickness in space": (SPACE + STATED, "thickness means nothing for blocks in space"),
    "strain in space": (SPACE + "[analysis]\nplane = 'strain'\n", "plane means nothing for blocks in space"),
    "both in space": (SPACE + STATED + "plane = 'strain'\n", "thickness and plane mean nothing"),
    "points in the plane": (f"[column]\n{GENERATED['column']}[analysis]\ncontact_points = 4\n",
                            "contact_points = 4 means nothing for blocks in the plane"),
}  # fmt: skip


@pytest.mark.parametrize("key", NOTHING)
def test_a_key_that_means_nothing_is_refused(key: str) -> None:
    text, said = NOTHING[key]
    with pytest.raises(InputError, match=said):
        concio.loads(text)


def test_a_plane_model_that_is_swept_takes_the_keys_of_both() -> None:
    table = f"[column]\n{GENERATED['column']}[analysis]\nthickness = 0.3\ncontact_points = 4\n[extrusion]\n"
    swept = concio.loads(table)
    assert swept.dim == 3
    assert swept.contact_points == 4
    assert swept.bodies[-1].vertices[:, 1].max() - swept.bodies[-1].vertices[:, 1].min() == pytest.approx(0.3)
