"""Keys of [analysis], of laws and of loads: what is stated acts, or is refused where it means nothing."""

from __future__ import annotations

from dataclasses import replace
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


@pytest.mark.parametrize(
    ("part", "thickness"),
    [
        (f"[column]\n{GENERATED['column']}", 0.3),
        (f"[column]\n{GENERATED['column']}thickness = 0.5\n", 0.5),
        (f"[column]\n{GENERATED['column']}[analysis]\nthickness = 0.6\n", 0.6),
        (STONES + "[[blocks]]\nname = 'a'\nrectangle = [[0, 0], [1, 1]]\nmaterial = 'stone'\n", 0.3),
        (f"units.length = 'mm'\n[[parts]]\nname = 'in'\n[parts.column]\n{GENERATED['column']}", 0.3),
        ("[[parts]]\nname = 'in'\nfile = 'inner.toml'\n", 0.3),
    ],
)
def test_the_thickness_of_a_file_is_that_of_the_files_of_its_parts(
    part: str, thickness: float, tmp_path: Path
) -> None:
    (tmp_path / "inner.toml").write_text(f"[column]\n{GENERATED['column']}")
    (tmp_path / "part.toml").write_text(part)
    (tmp_path / "whole.toml").write_text("[[parts]]\nname = 'one'\nfile = 'part.toml'\n" + STATED)
    assert depths(concio.load(tmp_path / "whole.toml")) == {thickness}


def test_files_of_parts_in_space_have_no_thickness_to_take(tmp_path: Path) -> None:
    (tmp_path / "part.toml").write_text(f"[column]\n{GENERATED['column']}[extrusion]\nthickness = 0.4\n")
    (tmp_path / "whole.toml").write_text("[[parts]]\nname = 'one'\nfile = 'part.toml'\n" + STATED)
    with pytest.raises(concio.InputError, match=r"whole.toml, \[analysis\]: thickness means nothing"):
        concio.load(tmp_path / "whole.toml")


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


LAWS = {
    "column": ("friction = 0.4", "joint"),
    "wall": ("base_friction = 0.4", "base"),
    "bridge": ("ring = [0.15, 0.15]\nring_friction = 0.4", "ring joint"),
}


@pytest.mark.parametrize("name", LAWS)
def test_a_coefficient_that_is_stated_twice_is_refused(name: str) -> None:
    """Friction of 0.4 in [column] was left aside for the 0.1 of [joints.joint]."""
    stated, law = LAWS[name]
    table = f"[{name}]\n{GENERATED[name].replace('ring = 0.3', '')}{stated}\n"
    key = stated.split("\n")[-1].split(" = ")[0]
    with pytest.raises(InputError, match=rf"{key} of \[{name}\] and \[joints.{law}\] are both stated"):
        concio.loads(f'{table}[joints."{law}"]\nfriction = 0.1\n')
    assert concio.loads(f'{table}[joints."{law}"]\nfriction = 0.4\n').laws[law].friction == 0.4
    plain = f"[column]\n{GENERATED['column']}[joints.joint]\nfriction = 0.1\n"
    assert concio.loads(plain).laws["joint"].friction == 0.1


IDLE = {
    "edge of a weight": ("weight", (0.0, -1.0), {"edge": ((0.0, 0.0), (1.0, 0.0))}),
    "place of a body force": ("body", (0.0, -1.0), {"at": (0.0, 0.5)}),
    "face of a point load": ("point", (0.0, -1.0), {"at": (0.0, 0.5), "bodies": ("b01",), "face": "upper"}),
    "edge of a point load": ("point", (0.0, -1.0), {"at": (0.0, 0.5), "edge": ((0.0, 0.0), (1.0, 0.0))}),
    "place of a pressure": ("pressure", (1.0,), {"edge": ((-0.25, 1.0), (0.25, 1.0)), "at": (0.0, 1.0)}),
}


@pytest.mark.parametrize("sort", IDLE)
def test_a_place_that_a_load_does_not_take_is_refused(sort: str) -> None:
    """It was left aside, and all of a block was loaded where an edge was named."""
    kind, value, given = IDLE[sort]
    model = concio.column(width=0.5, height=1.0, blocks=1, block="rigid")
    with pytest.raises(InputError, match=rf"a {kind} load takes no '"):
        replace(model, loads=(concio.Load(kind, value, **given),))  # type: ignore[arg-type]


def test_a_part_of_a_fixed_block_does_not_move_alone() -> None:
    """Half of the ground was to sink by 1 mm: all of it sank, and nothing cracked."""
    model = concio.column(width=0.5, height=1.0, blocks=1, block="rigid")
    half = concio.Support("half", "ground", edge=((0.0, 0.0), (0.25, 0.0)), displacement=(0.0, -0.001))
    with pytest.raises(InputError, match="'ground' is fixed and moves as a whole"):
        concio.solve(replace(model, supports=(half,)))
    still = replace(half, displacement=())
    assert concio.solve(replace(model, supports=(still,))).reactions["ground"][1] == pytest.approx(10.0)
