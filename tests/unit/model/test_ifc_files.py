"""Blocks from IFC files: every sort of geometry that is read, what chooses it, and one sentence for all else."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio import GeometryError, InputError, Polyhedron
from concio.contact.detection import detect
from concio.model.polyhedron import BOX
from concio.model.solids.step_file import decoded
from concio.verdict.attention import attention_of
from concio.verdict.italian import italian
from ifc_files import MILLIMETRE, IfcText, row

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
SIZES = np.array([0.4, 0.3, 0.2])


def read(text: IfcText, folder: Path, **options: object) -> concio.Model:
    return concio.model_from_solids(text.write(folder / "m.ifc"), **{"block": "rigid", **options})  # type: ignore[arg-type]


def tessellated(f: IfcText) -> str:
    return f.triangulated(CUBE * SIZES, Polyhedron("b", CUBE, BOX).triangles[0])


def by_line(f: IfcText) -> str:
    """Return an L of 0.6 and 0.5 by 0.2, extruded askew by 0.7 along a direction of its own axes."""
    corners = [(0, 0), (0.6, 0), (0.6, 0.2), (0.2, 0.2), (0.2, 0.5), (0, 0.5), (0, 0)]
    line = f.add(f"IFCPOLYLINE(({','.join(f.point(c) for c in corners)}))")
    profile = f.add(f"IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,{line})")
    return f.extruded(profile, 0.7, f.axes((0, 0, 4), (1, 0, 0), (0, 0, 1)), (0.2, 0.1, 1))


def with_a_void(f: IfcText) -> str:
    table = f.add(f"IFCCARTESIANPOINTLIST2D(({row((0, 0))},{row((1, 0))},{row((1, 0.8))},{row((0, 0.8))}))")
    outer = f.add(f"IFCINDEXEDPOLYCURVE({table},(IFCLINEINDEX((1,2,3)),IFCLINEINDEX((3,4,1))),$)")
    hole = [(0.3, 0.3), (0.6, 0.3), (0.6, 0.5), (0.3, 0.5), (0.3, 0.3)]
    inner = f.add(f"IFCPOLYLINE(({','.join(f.point(c) for c in hole)}))")
    return f.extruded(f.add(f"IFCARBITRARYPROFILEDEFWITHVOIDS(.AREA.,$,{outer},({inner}))"), 0.3)


def turned_rectangle(f: IfcText) -> str:
    own = f.add(f"IFCAXIS2PLACEMENT2D({f.point((0.1, 0.05))},{f.direction((0, 1))})")
    return f.extruded(f.rectangle(0.4, 0.2, own), 0.3, f.axes((0, 5, 0)))


def trapezium(f: IfcText) -> str:
    return f.extruded(f.add("IFCTRAPEZIUMPROFILEDEF(.AREA.,$,$,0.4,0.2,0.3,0.05)"), 0.5)


def mirrored(f: IfcText) -> str:
    """Return a box 1.5 times as large whose x and y change places, moved up by 12."""
    axes = f"{f.direction((0, 1, 0))},{f.direction((1, 0, 0))},{f.point((0, 0, 12))},1.5,{f.direction((0, 0, 1))}"
    target = f.add(f"IFCCARTESIANTRANSFORMATIONOPERATOR3D({axes})")
    return f.mapped(f.shape(f.brep(CUBE * SIZES, BOX)), target, f.axes((1, 0, 0)))


def with_a_hole(f: IfcText) -> str:
    """Return a cube with a square hole from below to above: faces with inner bounds."""
    inner = CUBE * [0.5, 0.5, 1.0] + [0.25, 0.25, 0.0]
    faces = [*BOX, *(tuple(v + 8 for v in reversed(face)) for face in BOX[2:])]
    holes = [(0, [v + 8 for v in reversed(BOX[0])]), (1, [v + 8 for v in reversed(BOX[1])])]
    return f.brep(np.vstack([CUBE, inner]), faces, holes)


SHEAR = 0.7 / np.sqrt(1.05)
GEOMETRY = {  # volume, centroid, number of vertices: all by hand
    "triangles": (tessellated, 0.024, (0.2, 0.15, 0.1), 8),
    "polygons": (lambda f: f.polygonal(CUBE * SIZES, BOX), 0.024, (0.2, 0.15, 0.1), 8),
    "brep": (lambda f: f.brep(CUBE * SIZES + 1, BOX), 0.024, (1.2, 1.15, 1.1), 8),
    "brep with a hole": (with_a_hole, 0.75, (0.5, 0.5, 0.5), 16),
    "line": (by_line, 0.18 * SHEAR, (SHEAR / 2, -0.033 / 0.18 - 0.05 * SHEAR, 4 + 0.042 / 0.18 + 0.1 * SHEAR), 12),
    "void": (with_a_void, 0.3 * 0.74, ((0.4 - 0.06 * 0.45) / 0.74, 0.4, 0.15), 16),
    "rectangle": (turned_rectangle, 0.024, (0.1, 5.05, 0.15), 8),
    "trapezium": (trapezium, 0.045, ((0.06 * 0.05 / 3 - 0.03 * 0.1) / 0.09, (0.03 - 0.06) * 0.05 / 0.09, 0.25), 8),
    "mapped": (mirrored, 0.024 * 1.5**3, (0.225, 1.8, 12.15), 8),
}  # fmt: skip


@pytest.mark.parametrize("sort", GEOMETRY)
def test_geometry_is_where_and_as_large_as_it_should_be(tmp_path: Path, sort: str) -> None:
    make, volume, centroid, corners = GEOMETRY[sort]
    f = IfcText()
    f.product("stone", make(f))
    (block,) = read(f, tmp_path).polyhedra
    assert block.name == "stone"
    assert len(block.vertices) == corners
    assert block.volume == pytest.approx(volume, rel=1e-12)
    assert block.centroid == pytest.approx(centroid, abs=1e-12)


def test_placements_and_units(tmp_path: Path) -> None:
    """A chain of two placements in millimetres, turned about z, then moved along what were the axes of the first."""
    f = IfcText(MILLIMETRE)
    first = f.placed(f.axes((1000, 2000, 0), (0, 0, 1), (0, 1, 0)))
    second = f.placed(f.axes((500, 0, 300)), first)
    f.product("a", f.brep(CUBE * 1000 * SIZES, BOX), placement=second)
    (a,) = read(f, tmp_path).polyhedra
    assert a.vertices.min(0) == pytest.approx([0.7, 2.5, 0.3])
    assert a.vertices.max(0) == pytest.approx([1.0, 2.9, 0.5])
    f = IfcText("IFCCONVERSIONBASEDUNIT($,.LENGTHUNIT.,'FOOT',#90)")
    f.product("b", f.brep(CUBE, BOX))
    metre = "#92= IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);"
    f.lines += [metre, "#90= IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.3048),#92);"]
    assert read(f, tmp_path).bodies[0].volume == pytest.approx(0.3048**3)
    f = IfcText("")
    f.product("c", f.brep(CUBE * 300, BOX))
    with pytest.raises(InputError, match=r"longer than 300 m \(the file does not say its unit.*unit = 'mm'"):
        read(f, tmp_path)
    assert read(f, tmp_path, unit="mm").bodies[0].volume == pytest.approx(0.027)


def church(f: IfcText) -> dict[str, str]:
    """Return products of several classes: a slab, two stones of tuff and one of brick, a door, a grid."""
    at = [f.placed(f.axes((0, 0, z))) for z in (-1.0, 0.0, 1.0, 2.0)]
    made = {
        "slab": f.product("foundation", f.brep(CUBE, BOX), kind="IFCSLAB", placement=at[0]),
        "low": f.product("Stone", f.brep(CUBE, BOX), kind="IFCBUILDINGELEMENTPART", placement=at[1]),
        "high": f.product("Stone", f.brep(CUBE, BOX), kind="IFCBUILDINGELEMENTPART", placement=at[2]),
        "brick": f.product("L\\X2\\00E9\\X0\\on''s", f.brep(CUBE, BOX), kind="IFCWALL", placement=at[3]),
        "grid": f.product("axis", f.brep(CUBE, BOX), kind="IFCGRID"),
        "empty": f.product("nothing", kind="IFCWALL"),
    }
    f.material("Tuff", made["low"], made["high"])
    brick = f.add("IFCTYPEPRODUCT('0',$,'Brick wall',$,$,$,$,$)")
    clay = f.add("IFCMATERIAL('Brick',$,$)")
    f.relate("IFCRELDEFINESBYTYPE", f"({made['brick']})", brick)
    f.relate("IFCRELASSOCIATESMATERIAL", f"({brick})", f.add(
        f"IFCMATERIALLAYERSET(({f.add(f'IFCMATERIALLAYER({clay},0.3,$)')}),$)"
    ))  # fmt: skip
    whole = f.add(f"IFCELEMENTASSEMBLY({f.identifier()},$,'Apse',$,$,$,$,$,$,$)")
    f.relate("IFCRELAGGREGATES", whole, f"({made['low']},{made['high']})")
    f.relate("IFCRELCONTAINEDINSPATIALSTRUCTURE", f"({whole},{made['brick']})", f.storey)
    return made


def test_names_materials_and_what_layers_choose(tmp_path: Path) -> None:
    f = IfcText()
    church(f)
    tuff, brick = concio.Rigid(16.0), concio.Rigid(18.0)
    model = read(f, tmp_path, materials={"Tuff": tuff, "b": brick}, layers={"ifcslab": "fixed", "Brick wall": "b"})
    kinds = {b.name: (b.kind, b.material, b.layer) for b in model.bodies}
    assert kinds == {
        "foundation": ("fixed", "", ""), "Stone": ("rigid", "Tuff", "Tuff"), "Stone-2": ("rigid", "Tuff", "Tuff"),
        "Léon's": ("rigid", "b", "Brick"),
    }  # fmt: skip
    assert [p.area for p in detect(model).patches] == pytest.approx([1.0] * 3)
    assert len(read(f, tmp_path, layers={"Level 1": "ignore"}).bodies) == 1
    assert len(read(f, tmp_path, layers={"apse": "ignore", "IfcSlab": "fixed"}).bodies) == 2
    with pytest.raises(InputError, match=r"no layer or block 'IfcWal'.*did you mean 'IfcWall'"):
        read(f, tmp_path, layers={"IfcWal": "ignore"})


def boolean(f: IfcText) -> str:
    return f.add(f"IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.,{f.brep(CUBE, BOX)},{f.brep(CUBE, BOX)})")


def arcs(f: IfcText) -> str:
    table = f.add(f"IFCCARTESIANPOINTLIST2D(({row((0, 0))},{row((1, 0))},{row((1, 1))}))")
    curve = f.add(f"IFCINDEXEDPOLYCURVE({table},(IFCARCINDEX((1,2,3)),IFCLINEINDEX((3,1))),$)")
    return f.extruded(f.add(f"IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,{curve})"), 1.0)


def circle(f: IfcText) -> str:
    return f.extruded(f.add("IFCCIRCLEPROFILEDEF(.AREA.,$,$,1.)"), 1.0)


def cyclic(f: IfcText) -> str:
    item = f"#{len(f.lines) + 6}"
    shape = f.add(f"IFCSHAPEREPRESENTATION($,'Body','MappedRepresentation',({item}))")
    target = f.add(f"IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,{f.point((0, 0, 0))},1.,$)")
    f.add("IFCDIRECTION((1.,0.,0.))")
    return f.mapped(shape, target, "$")


def without_end(f: IfcText) -> str:
    """Return thirty representations each of which shows the one before twice: a thousand million boxes."""
    item = f.brep(CUBE, BOX)
    target = f.add(f"IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,{f.point((0, 0, 0))},1.,$)")
    for _ in range(30):
        shape = f.shape(item, item)
        item = f.mapped(shape, target, "$")
    return item


REFUSED = {
    "boolean": (boolean, r"block 'stone' \(#\d+ IfcBuildingElementProxy\): #\d+ IFCBOOLEANCLIPPINGRESULT is cut by a"),
    "arcs": (arcs, r"#\d+ IFCINDEXEDPOLYCURVE has arcs, which are not read \(model it with straight sides"),
    "circle": (circle, r"#\d+ IFCCIRCLEPROFILEDEF is a profile that is not read"),
    "advanced": (lambda f: f.add("IFCADVANCEDBREP(#1)"), "has curved faces or edges"),
    "cyclic": (cyclic, r"#\d+ IFCMAPPEDITEM contains itself"),
    "without end": (without_end, "more than 100,000 solids"),
    "missing": (lambda f: f.add("IFCFACETEDBREP(#999999)"), "refers to #999999, which is not in the file"),
    "no number": (lambda f: f.brep(np.full((8, 3), np.inf), BOX), "cannot be read at 'inf"),
    "index": (lambda f: f.triangulated(CUBE, [(0, 1, 99)]), "uses point 100: there are 8"),
    "garbled": (lambda f: f.add("IFCFACETEDBREP((((#1)))"), "cannot be read at"),
    "deep": (lambda f: f.add(f"IFCFACETEDBREP({'(' * 90}#1{')' * 90})"), "nested more than 30 deep"),
    "size": (lambda f: f.extruded(f.rectangle(0, 1), 1), "has the size 0, which is not positive"),
    "flat": (lambda f: f.extruded(f.rectangle(1, 1), 1, along=(1, 0, 0)), "is a prism of no height"),
    "axes": (lambda f: f.extruded(f.rectangle(1, 1), 1, f.axes((0, 0, 0), (0, 0, 1), (0, 0, 2))), "two parallel"),
    "open": (lambda f: f.brep(CUBE, BOX[:5]), r"block 'stone' \(#\d+ IfcBuildingElementProxy\): the surface is open"),
    "inside out": (lambda f: f.brep(CUBE, [b[::-1] for b in BOX]), "the faces point inwards"),
    "out of plane": (lambda f: f.polygonal(np.vstack([CUBE[:7], [[1, 1, 1.1]]]), BOX),
                     r"face 2 is not planar: vertex 7 .* mm off its plane"),
    "crossing": (lambda f: f.polygonal(CUBE, [(0, 3, 2, 1), *BOX[1:]]), "face 1 crosses itself"),
    "millimetres": (lambda f: f.brep(CUBE * 300, BOX), r"longer than 300 m \(the file says so\).*unit = 'mm'"),
}  # fmt: skip


@pytest.mark.parametrize("fault", REFUSED)
def test_what_cannot_be_read_is_said_with_its_instance(tmp_path: Path, fault: str) -> None:
    make, said = REFUSED[fault]
    f = IfcText()
    f.product("stone", make(f))
    with pytest.raises(InputError, match=said):
        read(f, tmp_path)


def test_what_cannot_be_read_can_be_left_out(tmp_path: Path) -> None:
    f = IfcText()
    f.product("stone", f.brep(CUBE, BOX))
    opened = f.product("window", f.brep(CUBE, BOX), kind="IFCWALL")
    f.relate("IFCRELVOIDSELEMENT", opened, f.product("hole", f.brep(CUBE, BOX), kind="IFCOPENINGELEMENT"))
    with pytest.raises(GeometryError, match=r"block 'window' \(#\d+ IfcWall\): #\d+ IFCWALL has an opening, #\d+"):
        read(f, tmp_path)
    assert [b.name for b in read(f, tmp_path, layers={"IfcWall": "ignore"}).bodies] == ["stone"]
    skipped = read(f, tmp_path, on_fault="skip")
    assert [b.name for b in skipped.bodies] == ["stone"]
    assert "has an opening" in str(skipped.generator["faults"])


@pytest.mark.parametrize(
    ("kind", "relation", "said"),
    [("IFCVOIDINGFEATURE", "IFCRELVOIDSELEMENT", "has an opening, {}, which is not cut out"),
     ("IFCEARTHWORKSCUT", "IFCRELVOIDSELEMENT", "has an opening, {}, which is not cut out"),
     ("IFCPROJECTIONELEMENT", "IFCRELPROJECTSELEMENT", "has a projection, {}, which is not joined to it")],
)  # fmt: skip
def test_features_of_a_product_are_no_blocks(tmp_path: Path, kind: str, relation: str, said: str) -> None:
    """What is to be cut out was a block of stone, and a pilaster that a wall has stood beside it with a joint."""
    f = IfcText()
    wall = f.product("wall", f.brep(CUBE, BOX), kind="IFCWALL")
    feature = f.product("feature", f.brep(CUBE + np.array([1, 0, 0]), BOX), kind=kind)
    f.product("stone", f.brep(CUBE + np.array([0, 0, 1]), BOX))
    f.relate(relation, wall, feature)
    with pytest.raises(GeometryError, match=said.format(feature)):
        read(f, tmp_path)
    assert [b.name for b in read(f, tmp_path, on_fault="skip").bodies] == ["stone"]


def valid() -> str:
    f = IfcText()
    f.product("stone", f.brep(CUBE, BOX))
    return f.text()


FILES = {
    "cut off": (lambda t: t[: len(t) // 2], r"the file was cut off after #\d+ \(line \d+\)"),
    "no data": (lambda t: t[:60], "no section DATA"),
    "xml": (lambda _: "<?xml version='1.0'?><ifc/>", "does not begin with 'ISO-10303-21;'.*ifcXML"),
    "zip": (lambda _: "PK\3\4\33[2J" + "x" * 90, r"does not begin with .* with 'PK\?\?\?\[2Jx"),
    "other schema": (lambda t: t.replace("'IFC4'", "'AUTOMOTIVE_DESIGN'"), "'AUTOMOTIVE_DESIGN', not IFC"),
    "twice": (lambda t: t.replace("#7=", "#6="), "line 14: #6 is given twice"),
    "garbled": (lambda t: t.replace("#7= IFC", "#7: IFC"), "line 14 is not an instance: '#7: IFC"),
    "quote": (lambda t: t.replace("'Level 1'", "'Level 1"), "is not an instance|cannot be read|cut off"),
    "digits": (lambda t: t.replace("(1.0,1.0,1.0)", f"(1.0,1.0,{'9' * 5000})"), "something else than numbers"),
    "empty": (lambda t: re.sub(r"#\d+= IFCBUILDINGELEMENTPROXY.*\n", "", t), "holds no blocks"),
}


@pytest.mark.parametrize("fault", FILES)
def test_files_that_are_no_ifc_or_damaged(tmp_path: Path, fault: str) -> None:
    make, said = FILES[fault]
    (tmp_path / "m.ifc").write_text(make(valid()))
    (tmp_path / "m.toml").write_text('solids_file = "m.ifc"\n[materials.block]\nkind = "rigid"\nunit_weight = 20\n')
    code, out, err = run("check", tmp_path / "m.toml")
    assert code == 2
    assert re.search(said, " ".join((out + err).split())), out + err
    assert "Traceback" not in out + err


def test_a_placement_relative_to_itself_and_one_along_a_grid(tmp_path: Path) -> None:
    itself = ("IFCLOCALPLACEMENT(#{0},#{1})", "relative to itself")
    for text, said in (itself, ("IFCGRIDPLACEMENT($,$)", "along a grid")):
        f = IfcText()
        axes = f.axes()
        own = f.add(text.format(len(f.lines) + 1, axes[1:]))
        f.product("stone", f.brep(CUBE, BOX), placement=own)
        with pytest.raises(InputError, match=said):
            read(f, tmp_path)


def test_other_ways_to_write_it(tmp_path: Path) -> None:
    """Comments, line breaks within an instance, Latin-1, Windows line ends, and a byte order mark."""
    text = valid().replace("DATA;", "DATA; /* #1= nothing; */").replace("IFCPROJECT(", "IFCPROJECT\n (\n")
    for raw in (text.replace("\n", "\r\n").encode("utf-8-sig"), text.replace("stone", "pi\xe9dra").encode("latin-1")):
        (tmp_path / "m.ifc").write_bytes(raw)
        assert concio.model_from_solids(tmp_path / "m.ifc", block="rigid").bodies[0].volume == pytest.approx(1.0)
    assert decoded(r"\X2\03B103B2\X0\-\X\E9-\S\i-''-\\") == "αβ-é-é-'-\\"
    with pytest.raises(InputError, match=r"'.ifczip' is not a format.*save it as .ifc"):
        concio.model_from_solids(tmp_path / "m.ifczip", block="rigid")


def test_a_product_with_two_bodies_is_refused(tmp_path: Path) -> None:
    """The last one was read and the other one left out without a word."""
    file = IfcText()
    first, second = (file.shape(file.brep(CUBE + np.array([0, 0, up]), BOX)) for up in (0, 1))
    shape = file.add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({first},{second}))")
    file.add(f"IFCWALL({file.identifier()},$,'pier',$,$,$,{shape},$,$)")
    with pytest.raises(GeometryError, match=rf"has more than one body: {first}, {second}"):
        read(file, tmp_path)


def test_an_opening_in_what_a_product_is_part_of_is_not_passed_over(tmp_path: Path) -> None:
    """A leaf of a wall was read without the window that the wall has: 1 m3 of stone."""
    file = IfcText()
    wall = file.product("wall", kind="IFCWALL")
    leaf = file.product("leaf", file.brep(CUBE, BOX), kind="IFCBUILDINGELEMENTPART")
    window = file.product("window", file.brep(0.5 * CUBE, BOX), kind="IFCOPENINGELEMENT")
    file.relate("IFCRELAGGREGATES", wall, f"({leaf})")
    file.relate("IFCRELVOIDSELEMENT", wall, window)
    with pytest.raises(GeometryError, match=rf"is part of {wall} IFCWALL, which has an opening, {window}"):
        read(file, tmp_path)


WORLDS = {
    "at the origin": (((0, 0, 0),), None),
    "far away": (((4500.0, 1200.0, 30.0),), r"at \(4500, 1200, 30\) .*turned by 0 degrees"),
    "turned": (((0, 0, 0), (0, 0, 1), (0, 1, 0)), r"turned by 90 degrees about z"),
}


@pytest.mark.parametrize("world", WORLDS)
def test_a_coordinate_system_of_the_project_is_not_left_out_without_a_word(tmp_path: Path, world: str) -> None:
    at, said = WORLDS[world]
    f = IfcText(world=at)
    f.product("stone", f.brep(CUBE, BOX))
    model = read(f, tmp_path)
    assert np.allclose(model.bodies[0].vertices.min(0), 0.0)
    told = [line for line in attention_of(model, detect(model)) if "world coordinate system" in line]
    assert len(told) == (0 if said is None else 1)
    assert said is None or re.search(said, told[0])


def test_a_coordinate_system_that_lies_on_its_side_is_refused(tmp_path: Path) -> None:
    """Where z of the project is horizontal, gravity would act along another direction than the author meant."""
    f = IfcText(world=((0, 0, 0), (1, 0, 0), (0, 0, 1)))
    f.product("stone", f.brep(CUBE, BOX))
    with pytest.raises(InputError, match=r"z axis is not upright"):
        read(f, tmp_path)


TOLD = {
    "boolean": boolean, "profile": circle, "arcs": arcs, "geometry": lambda f: f.add("IFCSWEPTDISKSOLID(#1)"),
    "advanced": lambda f: f.add("IFCADVANCEDBREP(#1)"), "revolved": lambda f: f.add("IFCREVOLVEDAREASOLID(#1)"),
}  # fmt: skip


@pytest.mark.parametrize("fault", [*TOLD, "opening", "projection", "opening of part", "projection of part", "world"])
def test_what_was_left_out_is_said_in_italian(tmp_path: Path, fault: str) -> None:
    """Reports in Italian had these sentences in English."""
    f = IfcText(world=((4500.0, 1200.0, 30.0),) if fault == "world" else ())
    f.product("stone", f.brep(CUBE, BOX))
    if fault in TOLD:
        f.product("other", TOLD[fault](f), kind="IFCWALL")
    elif fault == "world":
        f.product("empty", kind="IFCWALL")
    else:
        wall, part = f.product("w", f.brep(CUBE, BOX)), f.product("o", f.brep(CUBE, BOX), kind="IFCOPENINGELEMENT")
        host = wall
        if "part" in fault:
            host = f.product("host", kind="IFCWALL")
            f.relate("IFCRELAGGREGATES", host, f"({wall})")
        f.relate(f"IFCREL{'VOIDS' if 'opening' in fault else 'PROJECTS'}ELEMENT", host, part)
    model = read(f, tmp_path, on_fault="skip")
    told = [line for line in attention_of(model, detect(model)) if "the drawing" in line]
    assert told
    pieces = [piece for line in told for piece in italian(line)]
    assert {piece.language for piece in pieces} == {"it"}
    assert not any(" is " in piece.text or " which " in piece.text for piece in pieces)
