"""Model files: what they may say, what they must not, and that writing and reading give back the same model."""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import fields, replace
from importlib.resources import files
from pathlib import Path
from types import NoneType
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.errors import GeometryError, InputError
from concio.fem.elements import FAMILIES, SOLID_FAMILIES
from concio.files import LARGEST
from concio.model.file.block_table import write_blocks
from concio.model.file.file_table import file_table, json_schema
from concio.model.file.generator_tables import KINDS, hints_of
from concio.model.file.tables import Element
from concio.model.generate.generators import GENERATORS

BLOCK = """
[materials.stone]
E = "5 GPa"
unit_weight = 20
[joints.dry]
friction = 0.6
[[blocks]]
name = "ground"
rectangle = [[0, -0.2], [1, 0]]
kind = "fixed"
[[blocks]]
name = "b"
rectangle = [[0, 0], ["100 cm", 0.5]]
material = "stone"
thickness = "20 cm"
"""


def assert_same(a: concio.Model, b: concio.Model) -> None:
    """Compare everything two models say, numbers to the last bit."""
    assert len(a.bodies) == len(b.bodies)
    for p, q in zip(a.bodies, b.bodies, strict=True):
        for f in fields(p):
            one, other = getattr(p, f.name), getattr(q, f.name)
            if f.name == "grid" and one is not None:
                assert all(np.array_equal(x, y) for x, y in zip(one, other, strict=True))
            else:
                assert np.array_equal(one, other), (p.name, f.name)
    for f in fields(a):
        if f.name not in ("bodies", "generator"):
            one, other = getattr(a, f.name), getattr(b, f.name)
            assert (dict(one) if hasattr(one, "items") else one) == (dict(other) if hasattr(other, "items") else other)
    plain = json.loads(json.dumps(dict(a.generator), default=str))
    assert plain == json.loads(json.dumps(dict(b.generator), default=str))


def test_panel_table_is_the_function() -> None:
    text = """
    [panel]
    courses = 2
    blocks = 3
    block_size = ["20 cm", 0.1]
    joint = "20 mm"
    friction = { friction = 0.6, cohesion = "50 kPa" }
    base = "bearings"
    top_pressure = "0.01 MPa"
    elements_per_block = [2, 1]
    block = { E = "100 MPa", nu = 0.1 }
    [panel.mortar]
    E = "50 MPa"
    """
    by_hand = concio.running_bond_panel(
        courses=2, blocks=3, joint=0.02, friction=concio.JointLaw(0.6, cohesion=50.0), base="bearings",
        top_pressure=10.0, elements_per_block=(2, 1), block=concio.Elastic(1e5, 0.1), mortar=concio.Elastic(5e4),
    )  # fmt: skip
    assert_same(concio.loads(text), by_hand)


MADE = {
    "panel": lambda: concio.running_bond_panel(joint=0.02, side_gap=1e-3, unit_weight=20, horizontal=0.1),
    "wall": lambda: concio.wall(
        length=2, height=1.5, openings=[{"x": 0.5, "y": 0, "width": 0.5, "height": 1, "lintel": 0.25}],
        lintel=concio.Rigid(7.0), top_pressure=3,
    ),
    "arch": lambda: concio.arch(span=3, ring=0.3, voussoirs=7, crown_load=1, block="rigid", base_friction=0.4),
    "column": lambda: concio.column(width=0.5, height=2, blocks=3, top_force=1, eccentricity=0.1),
    "rubble": lambda: concio.rubble(length=1, height=1, stone=0.3, seed=3),
}  # fmt: skip


@pytest.mark.parametrize("name", MADE)
def test_round_trip_of_generated_models(name: str) -> None:
    model = MADE[name]()
    text = concio.dumps(model)
    assert_same(concio.loads(text), model)
    assert concio.dumps(concio.loads(text)) == text


def test_round_trip_of_everything_a_model_can_say() -> None:
    start = concio.column(width=0.5, height=1, blocks=2)
    b01 = start.body("b01").name
    model = replace(
        start,
        title='quotes " and \\ and é',
        materials={**start.materials, "odd name.x": concio.Rigid(1 / 3)},
        laws={
            **start.laws,
            "soft": concio.JointLaw(0.7, 10.0, 5.0, 0.1, normal_stiffness=1e6, tangential_stiffness=4e5,
                                    compressive_strength=3e3),
        },
        rules=(*start.rules, concio.JointRule("soft", ("b01", "b02"), gap=1e-4)),
        supports=(concio.Support("s", "ground", None, "xy", (1e-3, -2e-3), 0.01, "moved"),
                  concio.Support("p", b01, ((0.25, 0.1), (0.25, 0.1)), "x")),
        loads=(*start.loads, concio.Load("pressure", (2.5,), ("b02",), ((-0.25, 1.0), (0.25, 1.0)), group="snow"),
               concio.Load("point", (1.0, -2.0), ("b02",), at=(0.25, 0.75), group="live"),
               concio.Load("body", (0.0, 0.1), ("b01",))),
        ties=(concio.Tie("rod", b01, (0.0, 0.2), "", (1.0, 0.2), 1e4, 3.0),),
        plane="strain", element="Q8", mesh_size=0.05, refinement=2, gap_tolerance=1e-5, gap_reach=1e-3,
        generator={"kind": "by hand", "n": 3, "parts": (1, 2.5), "yes": True},
    )  # fmt: skip
    assert_same(concio.loads(concio.dumps(model)), model)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-1e3, 1e3, allow_subnormal=False), min_size=8, max_size=8))
def test_numbers_survive_to_the_last_bit(numbers: list[float]) -> None:
    load = concio.Load("body", (numbers[0], numbers[1]), group="g")
    support = concio.Support("s", "ground", None, "xy", (numbers[2], numbers[3]), numbers[4])
    model = replace(concio.column(width=0.5, height=1, blocks=1), loads=(load,), supports=(support,))
    again = concio.loads(concio.dumps(model))
    assert again.loads == model.loads
    assert again.supports == model.supports


def test_save_replaces_only_when_complete(tmp_path: Path) -> None:
    model = concio.column(width=0.5, height=1, blocks=2)
    target = tmp_path / "c.toml"
    concio.save(model, target)
    assert_same(concio.load(target), model)
    with pytest.raises(InputError, match="cannot be written"):
        concio.save(model, tmp_path / "nowhere" / "c.toml")
    assert [p.name for p in tmp_path.iterdir()] == ["c.toml"]


@pytest.mark.parametrize("table", ["blocks.json", "blocks.csv"])
def test_blocks_beside_the_file(tmp_path: Path, table: str) -> None:
    model = concio.wall(length=2, height=1, block="rigid")
    concio.save(model, tmp_path / "wall.toml", blocks_file=table)
    assert "[[blocks]]" not in (tmp_path / "wall.toml").read_text()
    assert_same(concio.load(tmp_path / "wall.toml"), model)


def test_a_table_of_blocks_takes_the_kind_of_its_material(tmp_path: Path) -> None:
    bodies = [concio.Body("ground", [[0, -1], [1, -1], [1, 0], [0, 0]], "", "fixed"),
              concio.Body("b", [[0, 0], [1, 0], [1, 1], [0, 1]], "stone")]  # fmt: skip
    write_blocks(tmp_path / "b.json", bodies)
    text = "blocks_file = 'b.json'\n[materials.stone]\nkind = 'rigid'\nunit_weight = 1\n[joints.j]\nfriction = 1"
    assert concio.loads(text, folder=tmp_path).body("b").kind == "rigid"


def test_a_drawing_as_blocks(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new(units=4)  # millimetres
    for layer, corners in (("CONCIO_FIXED", [(0, -100), (500, -100), (500, 0), (0, 0)]),
                           ("STONE", [(0, 0), (500, 0), (500, 250), (0, 250)])):  # fmt: skip
        drawing.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    drawing.saveas(tmp_path / "d.dxf")
    text = """
    blocks_file = "d.dxf"
    [materials.STONE]
    E = "3 GPa"
    unit_weight = 22
    [joints.dry]
    friction = 0.5
    [drawing]
    mend = "0.2 mm"
    [analysis]
    thickness = 0.3
    """
    model = concio.loads(text, folder=tmp_path)
    (block,) = model.free_bodies
    assert (block.material, block.thickness) == ("STONE", 0.3)
    assert block.area == pytest.approx(0.125, rel=1e-12)
    assert model.materials["STONE"].unit_weight == 22
    assert model.rule_between(*model.bodies).law == "dry"
    assert model.laws["dry"].friction == 0.5
    assert set(model.materials) == {"STONE"}
    with pytest.raises(InputError, match="no material for blocks on layer 'STONE'"):
        concio.loads(text.replace("materials.STONE", "materials.BRICK"), folder=tmp_path)
    weightless = concio.loads(text.replace("unit_weight = 22", ""), folder=tmp_path)
    assert not weightless.loads
    default = concio.loads(text.replace("materials.STONE", "materials.block"), folder=tmp_path)
    assert default.materials["block"].E == 3e6


def test_units_of_the_file_are_those_of_bare_numbers() -> None:
    metres = "[arch]\nspan = 2\nring = 0.2\nvoussoirs = 7\ncrown_load = 3\nblock = { E = 5e6, unit_weight = 20 }"
    other = """
    units = { force = "N", length = "mm" }
    [arch]
    span = 2000
    ring = "20 cm"
    voussoirs = 7
    thickness = 1000
    crown_load = 3000
    block = { E = 5000, unit_weight = 2e-5 }
    """
    a, b = concio.loads(metres), concio.loads(other)
    assert math.isclose(b.materials["block"].E, a.materials["block"].E, rel_tol=1e-14)
    assert b.materials["block"].unit_weight == pytest.approx(20, rel=1e-14)
    assert b.loads[-1].value == pytest.approx(a.loads[-1].value, rel=1e-14)
    assert b.bodies[5].outline == pytest.approx(a.bodies[5].outline, rel=1e-13, abs=1e-13)


def test_units_of_the_file_reach_nested_tables() -> None:
    text = """
    units = { length = "cm" }
    [wall]
    length = 400
    height = 200
    block_size = [50, 25]
    [[wall.openings]]
    x = 100
    y = 0
    width = "0.5 m"
    height = 100
    lintel = 25
    """
    metres = concio.wall(
        length=4, height=2, block_size=(0.5, 0.25), thickness=1,
        openings=[{"x": 1, "y": 0, "width": 0.5, "height": 1, "lintel": 0.25}],
    )  # fmt: skip
    found = concio.loads(text)
    assert len(found.bodies) == len(metres.bodies)
    assert np.ptp(found.body("lintel1").outline, axis=0) == pytest.approx(
        np.ptp(metres.body("lintel1").outline, axis=0), rel=1e-12
    )


def test_a_bond_of_the_files_own() -> None:
    text = "[wall]\nlength = 2\nheight = 0.5\nblock_size = [0.5, 0.25]\nbond = "
    own = concio.loads(text + "[[1.0], { unit = [1.0], left = [0.5], right = [0.5] }]")
    assert_same_outlines(own, concio.loads(text + "'running'"))
    with pytest.raises(InputError, match=r"\[wall\], bond, 1, 2: 'x' is not a number"):
        concio.loads(text + "[[1.0, 'x']]")
    with pytest.raises(InputError, match=r"bond: 3 must be a text"):
        concio.loads(text + "3")


def assert_same_outlines(a: concio.Model, b: concio.Model) -> None:
    assert [p.name for p in a.bodies] == [q.name for q in b.bodies]
    for p, q in zip(a.bodies, b.bodies, strict=True):
        assert p.outline == pytest.approx(q.outline, abs=1e-12)


def test_a_generator_with_further_parts() -> None:
    text = """
    [arch]
    span = 3
    ring = 0.4
    voussoirs = 9
    block = "stone"
    friction = "dry"
    [materials.stone]
    E = "5 GPa"
    unit_weight = 25
    [materials.fill]
    kind = "rigid"
    unit_weight = 18
    [joints.dry]
    friction = 0.7
    [joints.fill]
    friction = 0.3
    [[rules]]
    law = "fill"
    between = ["load", "*"]
    [[blocks]]
    name = "statue"
    rectangle = [[-0.1, 1.9], [0.1, 2.2]]
    material = "fill"
    role = "load"
    [[supports]]
    name = "spreading"
    body = "right abutment"
    displacement = ["1 mm", 0]
    [analysis]
    plane = "strain"
    """
    model = concio.loads(text)
    assert model.materials["block"] == model.materials["stone"]
    assert model.body("statue").kind == "rigid"
    assert model.supports[0].displacement == (1e-3, 0.0)
    assert model.plane == "strain"
    assert model.element == "Q4"
    assert model.rule_between(model.body("statue"), model.body("v05")).law == "fill"
    assert model.laws[model.rule_between(model.body("v04"), model.body("v05")).law].friction == 0.7


WRONG = {
    "unknown key": ("[panel]\ncourse = 3", "[panel]: unknown key 'course' (did you mean 'courses'?)"),
    "unknown table": ("[pannel]\ncourses = 3", "f.toml: unknown key 'pannel' (did you mean 'panel'?)"),
    "another word for a table": (BLOCK.replace("[[blocks]]", "[[bodies]]"), "'bodies' (did you mean 'blocks'?)"),
    "another word for a key": (BLOCK + "vertici = [[0, 0]]", "unknown key 'vertici' (did you mean 'outline'?)"),
    "a symbol for a key": ("[joints.a]\nmu = 0.5\n[panel]", "unknown key 'mu' (did you mean 'friction'?)"),
    "unknown key of a block": (BLOCK + "colour = 'red'", "[[blocks]] 2 'b': unknown key 'colour'"),
    "unknown key of a material": ("[materials.a]\ne = 1\n[panel]", "unknown key 'e' (did you mean 'E'?)"),
    "unknown key of a joint": ("[joints.a]\nfricton = 1\n[panel]", "unknown key 'fricton' (did you mean 'friction'?)"),
    "unknown key of a friction": ("[panel.friction]\nfriction = 1\nfoo = 1", "[panel.friction]: unknown key 'foo'"),
    "unknown key of a hazard": (
        "[panel]\n[site.hazard.SLV]\na_g = 0.2\nFo = 2.4", "[site.hazard.SLV]: unknown key 'Fo' (known: a_g, F0, Tc"),
    "unknown key of a row of hazards": (
        "[panel]\n[[site.hazard]]\na_g = 0.2\nFo = 2.4", "[[site.hazard]] 1: unknown key 'Fo' (known: a_g, F0, Tc"),
    "negative modulus": ("[panel]\nblock.E = -1", "[panel.block]: Young's modulus E = -1 must be positive"),
    "zero modulus": ("[panel]\nblock.E = 0", "[panel.block]: Young's modulus E = 0 must be positive"),
    "incompressible": ("[panel]\nblock = { E = 1e5, nu = 0.5 }", "[panel.block]: Poisson's ratio nu = 0.5"),
    "negative friction": ("[panel]\nfriction = -0.1", "[panel]: friction = -0.1 must be zero or positive"),
    "zero courses": ("[panel]\ncourses = 0", "[panel]: courses = 0 must be at least 1"),
    "half a course": ("[panel]\ncourses = 2.5", "[panel], courses: 2.5 must be a whole number"),
    "wrong unit": ("[panel]\njoint = '20 kN'", "[panel], joint: '20 kN' is not a length (expected a unit like m)"),
    "no unit we know": ("[panel]\njoint = '2 cubits'", "[panel], joint: unknown unit 'cubits'"),
    "wrong unit of a material": ("[panel]\nblock.E = '5 kN/m3'", "[panel.block], E: '5 kN/m3' is not a stress"),
    "not a number": ("[panel]\njoint = nan", "[panel], joint: the value is not a number (NaN)"),
    "infinite": ("[panel]\ntop_pressure = inf", "[panel], top_pressure: the value is not finite"),
    "NaN deep inside": (BLOCK.replace("-0.2", "nan"), "[[blocks]] 1 'ground', rectangle, 1, 2: the value is not a"),
    "a word for a number": ("[panel]\njoint = 'thin'", "[panel], joint: 'thin' is not a number with a unit"),
    "true for a number": ("[panel]\njoint = true", "[panel], joint: true is not a number"),
    "a number for a word": ("title = 3\n[panel]", "title: 3 must be a text in quotation marks"),
    "a word for true": ("[panel]\nside_walls = 'yes'", "[panel], side_walls: 'yes' must be true or false"),
    "not a choice": ("[panel]\nbase = 'half'", "[panel], base: 'half' is not one of 'full', 'bearings', 'none'"),
    "one number too few": ("[panel]\nblock_size = [0.2]", "[panel], block_size: value 2 is missing"),
    "no size": ("[arch]\nspan=1e-200\nring=1\nvoussoirs=5", "[arch], span: 1e-200 m is not a size of a structure"),
    "key left out": ("[arch]\nspan = 3", "[arch]: 'ring' is missing"),
    "two generators": ("[panel]\n[arch]\nspan=3\nring=0.3\nvoussoirs=7", "more than one of [panel], [arch]"),
    "no blocks": ("[joints.a]\nfriction = 1", "the file describes no blocks (add [[blocks]], blocks_file"),
    "no joint law": (BLOCK.replace("[joints.dry]\nfriction = 0.6", ""), "there are no joint laws"),
    "which joint law": (BLOCK + "[joints.two]\nfriction = 1", "there are 2 joint laws and no [[rules]]"),
    "no such law": (BLOCK + "[[rules]]\nlaw = 'drie'", "[[rules]] 1: joint law 'drie' is not defined (known: dry)"),
    "no such material": (BLOCK.replace("'stone'", "").replace('"stone"', '"stoen"'), "material 'stoen' is not"),
    "no such body": (BLOCK + "[[supports]]\nname = 's'\nbody = 'c'", "[[supports]] 's': there is no body called 'c'"),
    "no such loaded body": (
        BLOCK + "[[loads]]\nkind = 'point'\nvalue = [1, 0]\nbodies = ['c']\nat = [0, 0]", "no body called 'c'"),
    "no such tied body": (
        BLOCK + "[[ties]]\nname='t'\nbody_a='c'\nat_a=[0,0]\nat_b=[1,1]\nstiffness=1", "no body called 'c'"),
    "weight twice": (
        "[wall]\nlength = 2\nheight = 2\n[[loads]]\nkind = 'weight'\nvalue = [0, -1]",
        "[[loads]] 1: the weight would count twice: the table that makes the structure brings it already"),
    "load of one number": (BLOCK + "[[loads]]\nkind = 'point'\nvalue = 1", "a point load takes two numbers [x, y]"),
    "load in the wrong unit": (
        BLOCK + "[[loads]]\nkind = 'pressure'\nvalue = '1 kN'", "[[loads]] 1, value: '1 kN' is not a stress"),
    "outline and rectangle": (
        BLOCK + "outline = [[0, 0], [1, 0], [1, 1]]", "give either an outline or a rectangle, not both"),
    "neither of them": (BLOCK + "[[blocks]]\nname = 'c'", "[[blocks]] 3 'c': give either an outline or a rectangle"),
    "flat rectangle": (BLOCK.replace("0.5]]", "0]]"), "[[blocks]] 2 'b': the rectangle has no area"),
    "two bodies of one name": (BLOCK.replace('"b"', '"ground"'), "two bodies are called 'ground'"),
    "rigid with E": ("[panel]\nblock = { kind = 'rigid', E = 1 }", "a rigid material has no E and no nu"),
    "elastic without E": ("[panel]\nblock = { nu = 0.1 }", "[panel.block]: 'E' is missing"),
    "own material twice": ("[panel]\n[materials.block]\nE = 1", "[materials.block]: 'block' is the name of the"),
    "drawing without one": ("[panel]\n[drawing]\nmend = 1", "[drawing] is given, but blocks_file is not a .dxf"),
    "negative mesh": ("[panel]\n[analysis]\nmesh_size = 0", "[analysis]: mesh_size = 0 m must be positive"),
    "no refinement": ("[panel]\n[analysis]\nrefinement = 0", "[analysis]: refinement = 0 must be at least 1"),
    "opening misspelt": (
        "[wall]\nlength = 2\nheight = 2\n[[wall.openings]]\nx=0\ny=0\nwidht=1\nheight=1",
        "[[wall.openings]] 1: unknown key 'widht' (did you mean 'width'?)"),
    "unit system": ("units.force = 'lbf'\n[panel]", "[units], force: 'lbf' is not one of 'N', 'kN', 'MN'"),
    "syntax": ("[panel]\ncourses = \nblocks = 3", "f.toml, line 2, column 11: invalid value"),
    "number without a first digit": ("[panel]\njoint = .02", "numbers begin with a digit: 0.5, not .5"),
    "key twice": ("[panel]\ncourses = 1\ncourses = 2\nblocks = 3", "f.toml, line 3, column 12: cannot overwrite"),
    "empty": ("  \n", "f.toml: the file is empty"),
    "only comments": ("# nothing\n", "f.toml: the file holds only comments"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_said_with_its_place(case: str) -> None:
    text, said = WRONG[case]
    with pytest.raises(InputError) as caught:
        concio.loads(text, name="f.toml")
    assert said in str(caught.value)
    assert str(caught.value).startswith("f.toml")
    assert "\n" not in str(caught.value)


def test_open_and_crossing_polygons_are_named() -> None:
    crossing = BLOCK.replace('rectangle = [[0, 0], ["100 cm", 0.5]]', "outline = [[0, 0], [1, 1], [1, 0], [0, 1]]")
    with pytest.raises(GeometryError, match=r"\[\[blocks\]\] 2 'b'"):
        concio.loads(crossing)
    line = BLOCK.replace('rectangle = [[0, 0], ["100 cm", 0.5]]', "outline = [[0, 0], [1, 1]]")
    with pytest.raises(GeometryError, match="polygon needs at least 3"):
        concio.loads(line)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        concio.load(tmp_path / "no.toml")
    with pytest.raises(InputError, match="directory"):
        concio.load(tmp_path)
    (tmp_path / "latin.toml").write_bytes("title = 'x'\n# größe".encode("latin-1"))
    with pytest.raises(InputError, match=r"byte 16 \(line 2\) is not UTF-8"):
        concio.load(tmp_path / "latin.toml")
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")
    with pytest.raises(InputError, match="it is not a text"):
        concio.load(tmp_path / "picture.png")
    (tmp_path / "bom.toml").write_bytes("﻿[panel]\r\ncourses = 1\r\n".encode())
    assert len(concio.load(tmp_path / "bom.toml").free_bodies) == 3
    with (tmp_path / "huge.toml").open("wb") as huge:
        huge.truncate(LARGEST + 1)
    with pytest.raises(InputError, match="more than 200 MB"):
        concio.load(tmp_path / "huge.toml")


def test_missing_table_of_blocks_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.csv.*no such file"):
        concio.loads("blocks_file = 'no.csv'\n[joints.j]\nfriction = 1", folder=tmp_path)


@pytest.mark.parametrize("name", GENERATORS)
def test_every_argument_with_a_unit_has_a_kind(name: str) -> None:
    for argument, (hint, _) in hints_of(GENERATORS[name]).items():
        parts = set(get_args(hint)) - {NoneType}
        if parts == {float, str}:
            assert argument in KINDS, f"{name}({argument}=...) takes a unit: say which kind it is"


@pytest.mark.parametrize("name", GENERATORS)
def test_every_argument_is_a_key(name: str) -> None:
    table = file_table().model_fields[name].annotation
    assert set(table.model_fields) == set(hints_of(GENERATORS[name]))


def test_the_elements_a_file_may_name_are_those_there_are() -> None:
    assert set(get_args(Element)) == {*FAMILIES, *SOLID_FAMILIES}


TEMPLATES = sorted(p.name for p in files("concio.model").joinpath("templates").iterdir())


@pytest.fixture(scope="module")
def published() -> Any:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_obey_the_published_schema(name: str, published: Any) -> None:
    text = files("concio.model").joinpath("templates", name).read_text(encoding="utf-8")
    published.validate(tomllib.loads(text))
    assert not published.is_valid({**tomllib.loads(text), "colour": "red"})
    model = concio.loads(text)
    assert model.title
    assert all(math.isfinite(body.volume) for body in model.bodies)


@pytest.mark.parametrize("made", ["[column]\nwidth = 1\nheight = 2\nblocks = 2\n", None])
def test_a_title_of_the_file_stands_before_that_of_a_generator(made):
    own = "[[blocks]]\nname = 'a'\nrectangle = [[0, 0], [1, 1]]\nkind = 'fixed'\n[joints.joint]\nfriction = 0.5\n"
    assert concio.loads(f"title = 'mine'\n{made or own}").title == "mine"
    assert concio.loads(made or own).title == ("column of 2 blocks, 1 x 2 m" if made else "")
