"""Blocks in space from and to files of other programs."""

from __future__ import annotations

import json
import re
import struct
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

import concio
from commands import run
from concio import GeometryError, InputError, Model, Polyhedron
from concio.contact.detection import detect
from concio.io.solids_out import Drawn, _add_vertices
from concio.model.polyhedron import BOX

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)


def arch() -> Model:
    """Return an arch whose blocks have faces of four and more vertices."""
    plane = concio.arch_on_piers(
        span=3, ring=0.4, voussoirs=7, pier_width=1, pier_height=2, pier_courses=3, block="rigid"
    )
    return concio.extrude(plane, 0.5)


def obj_of(points: np.ndarray, faces: object = BOX, name: str = "c") -> str:
    lines = [f"o {name}"] + [f"v {x} {y} {z}" for x, y, z in points]
    return "\n".join(lines + ["f " + " ".join(str(v + 1) for v in face) for face in faces])  # type: ignore[attr-defined]


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".json", ".dxf", ".3dm"])
def test_what_is_written_is_read_back(tmp_path: Path, suffix: str) -> None:
    model = arch()
    path = tmp_path / f"arch{suffix}"
    concio.write_solids(path, model)
    again = concio.model_from_solids(path, block="rigid", layers={} if suffix != ".stl" else {"*ground": "fixed"})
    volume = {b.name: b.volume for b in model.bodies}
    assert len(again.bodies) == len(model.bodies)
    assert sum(b.kind == "fixed" for b in again.bodies) == 2
    if suffix != ".dxf":  # a drawing keeps no names
        assert {b.name: pytest.approx(b.volume, rel=1e-6) for b in again.bodies} == volume
    kept = {b.name: b for b in again.polyhedra}
    assert sum(b.volume for b in again.bodies) == pytest.approx(sum(volume.values()), rel=1e-6)
    joints, before = detect(again).patches, detect(model).patches
    assert sum(p.area for p in joints) == pytest.approx(sum(p.area for p in before), rel=1e-5)
    if suffix == ".stl":  # triangles in one plane are one face again
        assert len(kept["v04"].faces) == len(model.polyhedra[[b.name for b in model.bodies].index("v04")].faces)


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".json", ".dxf", ".3dm"])
def test_blocks_in_coordinates_of_a_map_keep_their_shape(tmp_path: Path, suffix: str) -> None:
    """3dm files held single precision: a block of 0.4 m3 was one of 0.25 m3 at 5,000 km from the origin."""
    far = np.array([512345.67, 4987654.32, 120.4])
    block = Polyhedron("a", CUBE * [1.0, 0.8, 0.5] + far, BOX, kind="rigid")
    model = Model((block,), {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.6)})
    concio.write_solids(tmp_path / f"m{suffix}", model)
    again = concio.model_from_solids(tmp_path / f"m{suffix}", block="rigid").polyhedra[0]
    assert again.volume == pytest.approx(0.4, rel=1e-6)
    assert again.vertices.min(0) == pytest.approx(far, abs=1e-6)


def test_a_package_with_single_precision_alone_distorts_no_block() -> None:
    added: list[tuple[float, ...]] = []
    old = SimpleNamespace(Add=lambda *at: added.append(at))
    near = Drawn("a", "", False, CUBE, BOX, np.zeros((0, 3), dtype=int))
    _add_vertices(Path("m.3dm"), old, near)
    assert len(added) == 8
    with pytest.raises(InputError, match="'a' lies so far from the origin"):
        _add_vertices(Path("m.3dm"), old, replace(near, points=CUBE + 4987654.32))


def test_a_scale_that_is_no_number_writes_nothing(tmp_path: Path) -> None:
    """Vertices were nan."""
    with pytest.raises(InputError, match="scale = nan is not a finite number"):
        concio.write_solids(tmp_path / "m.obj", arch(), scale=float("nan"))
    assert not (tmp_path / "m.obj").exists()


def test_gltf_is_what_another_reader_sees(tmp_path: Path) -> None:
    model = arch()
    concio.write_solids(tmp_path / "arch.glb", model)
    scene = trimesh.load(tmp_path / "arch.glb")
    assert set(scene.geometry) == {b.name for b in model.bodies}
    low, high = scene.bounds  # y is up there
    every = np.concatenate([b.vertices for b in model.bodies])
    assert np.allclose([low[1], high[1]], [every[:, 2].min(), every[:, 2].max()], atol=1e-6)
    assert np.allclose([-high[2], -low[2]], [every[:, 1].min(), every[:, 1].max()], atol=1e-6)
    volume = sum(abs(m.volume) for m in scene.geometry.values())
    for mesh in scene.geometry.values():
        mesh.merge_vertices(merge_norm=True)
        assert mesh.is_volume
    assert volume == pytest.approx(sum(b.volume for b in model.bodies), rel=1e-5)


def test_binary_stl_and_a_folder_of_them(tmp_path: Path) -> None:
    folder = tmp_path / "blocks"
    folder.mkdir()
    for name, at in (("low", 0.0), ("high", 1.0)):
        block = Polyhedron("b", CUBE + np.array([0, 0, at]), BOX)
        corners = block.vertices[block.triangles[0]].astype("<f4")
        raw = b"x" * 80 + struct.pack("<I", len(corners))
        raw += b"".join(b"\0" * 12 + c.tobytes() + b"\0\0" for c in corners)
        (folder / f"{name}.stl").write_bytes(raw)
    model = concio.model_from_solids(folder, block="rigid", ground=True)
    assert [b.name for b in model.bodies] == ["ground", "high", "low"]
    assert sorted(p.area for p in detect(model).patches) == [pytest.approx(1.0)] * 2
    (folder / "low.stl").write_bytes(raw[:-7])
    with pytest.raises(InputError, match=r"low\.stl.*was it cut off|was it cut off"):
        concio.model_from_solids(folder, block="rigid")


PLY_HEAD = """ply
format {} 1.0
comment by hand
element vertex 16
property float x
property float y
property double z
property uchar red
element edge 1
property int vertex1
element face 12
property list uchar int vertex_indices
property list uchar float texcoord
end_header
"""
STACK = np.vstack([CUBE, CUBE + np.array([0, 0, 1])])
TWO = [*BOX, *(tuple(v + 8 for v in face) for face in BOX)]


def ply_text() -> str:
    rows = [f"{x} {y} {z} 7" for x, y, z in STACK] + ["3"] + [f"4 {' '.join(map(str, f))} 2 0.5 1" for f in TWO]
    return PLY_HEAD.format("ascii") + "\n".join(rows) + "\n"


def ply_bytes(order: str) -> bytes:
    sign = "<" if order == "little" else ">"
    raw = PLY_HEAD.format(f"binary_{order}_endian").encode()
    raw += b"".join(struct.pack(f"{sign}ffdB", *p, 7) for p in STACK) + struct.pack(f"{sign}i", 3)
    return raw + b"".join(struct.pack(f"{sign}B4iB2f", 4, *f, 2, 0.5, 1) for f in TWO)


def off_text(word: str = "OFF\n16 12 0") -> str:
    rows = [f"{x} {y} {z} 9" for x, y, z in STACK] + [f"4 {' '.join(map(str, f))} 0.5 0.5 0.5" for f in TWO]
    return f"{word}\n# a comment\n" + "\n".join(rows)


SURFACES = {
    "t.ply": ply_text().encode(), "l.ply": ply_bytes("little"), "b.ply": ply_bytes("big"),
    "crlf.ply": ply_text().replace("\n", "\r\n").encode(), "o.off": off_text().encode(),
    "c.off": off_text("COFF 16 12 24").encode(),
}  # fmt: skip


@pytest.mark.parametrize("name", SURFACES)
def test_ply_and_off(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(SURFACES[name])
    model = concio.model_from_solids(tmp_path / name, block="rigid")
    assert [(b.name, b.volume, len(b.faces)) for b in model.polyhedra] == [
        (f"{name[:-4]}{end}", pytest.approx(1.0), 6) for end in ("", "-2")
    ]
    assert [p.area for p in detect(model).patches] == [pytest.approx(1.0)]
    (tmp_path / name).write_bytes(SURFACES[name][: -60 if name[-1] == "y" else -150])
    with pytest.raises(InputError, match=r"the file ends before|is not a row of 'face'"):
        concio.model_from_solids(tmp_path / name, block="rigid")


def off_of(*blocks: tuple[np.ndarray, object]) -> str:
    points, faces = np.vstack([p for p, _ in blocks]), []
    for k, (_, own) in enumerate(blocks):
        faces += [tuple(8 * k + v for v in face) for face in own]  # type: ignore[attr-defined]
    rows = [f"{x} {y} {z}" for x, y, z in points] + [f"{len(f)} {' '.join(map(str, f))}" for f in faces]
    return f"OFF {len(points)} {len(faces)} 0\n" + "\n".join(rows)


def off_as_ply(text: str) -> str:
    head, *rows = text.split("\n")
    _, points, faces, _ = head.split()
    lines = ["ply", "format ascii 1.0", f"element vertex {points}", *(f"property double {c}" for c in "xyz")]
    lines += [f"element face {faces}", "property list uchar int vertex_index", "end_header", *rows]
    return "\n".join(lines) + "\n"


WRONG = {
    "open": (off_of((CUBE, BOX[:5])), "block 'm': the surface is open"),
    "inside out": (off_of((CUBE, [f[::-1] for f in BOX])), "block 'm': the faces point inwards"),
    "crossing": (off_of((CUBE, [(0, 3, 2, 1), *BOX[1:]])), "block 'm': face 1 crosses itself"),
    "out of plane": (off_of((CUBE + np.eye(8)[:, 7:] * [0, 0, 0.2], BOX)), "face 2 is not planar: .* 49.51 mm off"),
    "inside": (off_of((CUBE, BOX), (CUBE / 2 + 0.25, BOX)), "'m-2' lies inside 'm'"),
    "overlap": (off_of((CUBE, BOX), (CUBE + np.array([0.9, 0, 0]), BOX)), "'m' and 'm-2' overlap .* 100 mm deep"),
    "millimetres": (off_of((CUBE * 300, BOX)), "longer than 300 m .* unit = 'mm'"),
    "index": (off_of((CUBE, [(0, 1, 9)])), "uses a vertex|uses vertex 9"),
    "two vertices": (off_of((CUBE, [(0, 1)])), "a face of 2 vertices|has 2 vertices"),
    "no number": (off_of((CUBE, BOX)).replace("1.0 1.0 1.0", "1.0 one 1.0"), "line .*cannot be read|not a row of"),
    "counts": (off_of((CUBE, BOX)).replace("8 6 0", f"{10**9} 6 0"), "more than 5,000,000 vertices"),
    "faces": (off_of((CUBE, BOX)).replace("8 6 0", f"8 {10**9} 0"), "the file ends before"),
    "no faces": (off_of((CUBE, [])), "no faces|holds no blocks"),
}  # fmt: skip


@pytest.mark.parametrize("end", [".off", ".ply"])
@pytest.mark.parametrize("fault", WRONG)
def test_what_is_wrong_in_surfaces_is_said_in_a_sentence(tmp_path: Path, fault: str, end: str) -> None:
    text, said = WRONG[fault]
    path = bad(tmp_path, text if end == ".off" else off_as_ply(text), f"m{end}")
    path.write_text(path.read_text().replace("[materials", "[solids]\nground = true\n[materials"))
    code, out, err = run("check", path)
    assert code == 2
    assert re.search(said, " ".join((out + err).split())), out + err
    assert "Traceback" not in out + err


HEADERS = {
    "no header": ("plyx", "is not PLY"),
    "big": ("ply\nformat ascii 1.0\nelement vertex 8\nproperty quad x\nend_header\n", "line 4 of the header"),
    "no format": ("ply\nelement vertex 0\nend_header\n", "does not say its format"),
    "no coordinates": ("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n", "no element 'vertex' with x, y"),
}


@pytest.mark.parametrize("fault", HEADERS)
def test_headers_that_cannot_be_read(tmp_path: Path, fault: str) -> None:
    (tmp_path / "m.ply").write_text(HEADERS[fault][0])
    with pytest.raises(InputError, match=HEADERS[fault][1]):
        concio.model_from_solids(tmp_path / "m.ply", block="rigid")
    (tmp_path / "m.off").write_text(HEADERS[fault][0])
    with pytest.raises(InputError, match="is not OFF as text"):
        concio.model_from_solids(tmp_path / "m.off", block="rigid")


def test_another_program_writes_what_is_read(tmp_path: Path) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=1)
    for name, how in (("a.ply", "ascii"), ("b.ply", "binary"), ("c.off", None)):
        mesh.export(tmp_path / name, **({"encoding": how} if how else {}))
    model = concio.model_from_solids(tmp_path, block="rigid", layers={"a": "ignore"})
    assert {b.name: b.volume for b in model.bodies} == {k: pytest.approx(mesh.volume, rel=1e-6) for k in "bc"}
    (tmp_path / "none").mkdir()
    with pytest.raises(InputError, match=r"holds no file that ends in \.stl"):
        concio.model_from_solids(tmp_path / "none", block="rigid")


def test_blocks_in_one_surface_are_parted(tmp_path: Path) -> None:
    text = obj_of(np.vstack([CUBE, CUBE + np.array([0, 0, 1])]), [*BOX, *(tuple(v + 8 for v in f) for f in BOX)])
    (tmp_path / "two.obj").write_text(text)
    model = concio.model_from_solids(tmp_path / "two.obj", block="rigid")
    assert [b.name for b in model.bodies] == ["c", "c-2"]
    assert len(detect(model).patches) == 1


def test_layers_units_and_mending(tmp_path: Path) -> None:
    path = tmp_path / "wall.obj"
    inside_out = [f[::-1] for f in BOX]
    text = obj_of(CUBE * 250, BOX, "base-1") + "\nusemtl stone\n"
    text += obj_of(CUBE * 250 + np.array([0, 0, 250]), inside_out, "b2")
    lines = text.split("\n")
    start = lines.index("o b2")
    for k in range(start, len(lines)):
        if lines[k][:2] == "f ":
            lines[k] = "f " + " ".join(str(int(v) + 8) for v in lines[k].split()[1:])
    path.write_text("\n".join(lines))
    with pytest.raises(InputError) as found:
        concio.model_from_solids(path)
    assert "250 m" in str(found.value)
    assert "unit = 'mm'" in str(found.value.hint)
    with pytest.raises(GeometryError, match="block 'b2': the faces point inwards"):
        concio.model_from_solids(path, unit="mm")
    rigid = concio.Rigid(22.0)
    meant = {"materials": {"stone": rigid}, "layers": {"base-*": "fixed"}}
    model = concio.model_from_solids(path, unit="mm", mend="1 mm", **meant)
    assert [(b.name, b.kind, b.material) for b in model.bodies] == [("base-1", "fixed", ""), ("b2", "rigid", "stone")]
    assert model.generator["moved"] == ("'b2': its faces were turned outwards",)
    assert model.bodies[1].volume == pytest.approx(0.25**3)
    with pytest.raises(InputError, match="no layer or block 'bsae-"):
        concio.model_from_solids(path, unit="mm", layers={"bsae-*": "fixed"})


def bad(tmp_path: Path, text: str, name: str = "bad.obj") -> Path:
    (tmp_path / name).write_text(text)
    (tmp_path / "m.toml").write_text(f'solids_file = "{name}"\n[materials.block]\nkind = "rigid"\nunit_weight = 20\n')
    return tmp_path / "m.toml"


PUSHED = CUBE.copy()
PUSHED[7, 2] += 0.2
CROSSED = [(0, 3, 2, 1), *BOX[1:]]
HOSTILE = {
    "open": (obj_of(CUBE, BOX[:5]), "block 'c': .*(open|no face)"),
    "inside out": (obj_of(CUBE, [f[::-1] for f in BOX]), "the faces point inwards"),
    "crossing": (obj_of(CUBE, CROSSED), "block 'c': "),
    "out of plane": (obj_of(PUSHED), "block 'c': face .* (mm|m)"),
    "millimetres": (obj_of(CUBE * 300), "longer than 300 m"),
    "vertices": ("\n".join(["o big", *["v 0 0 0"] * 30_000, "f 1 2 3"]), "bad.obj"),
    "no such vertex": ("o a\nv 0 0 0\nf 1 2 3", "line 3: a face uses a vertex that is not there"),
    "no number": ("o a\nv 0 0 zero", "line 2 cannot be read"),
    "nothing": ("# empty", "holds no blocks"),
    "nan": (obj_of(CUBE).replace("v 1.0 1.0 1.0", "v nan 1.0 1.0"), "not finite"),
    "flat": (obj_of(CUBE * [1, 1, 0]), "block 'c': "),
    "tiny": (obj_of(CUBE * 1e-5), "shorter than 1e-05 m"),
    "an edge for a face": (obj_of(CUBE) + "\nf 1 2", "line 16: a face has 2 vertices"),
}


@pytest.mark.parametrize("fault", HOSTILE)
def test_what_is_wrong_is_said_in_a_sentence(tmp_path: Path, fault: str) -> None:
    text, said = HOSTILE[fault]
    code, out, err = run("check", bad(tmp_path, text))
    assert code == 2
    assert re.search(said, " ".join((out + err).split())), out + err
    assert "Traceback" not in out + err
    assert len(err.strip().split("\n")) <= 6


def test_an_empty_file_is_told_before_its_layers(tmp_path: Path) -> None:
    (tmp_path / "nothing.obj").write_text("# nothing")
    with pytest.raises(InputError, match="holds no blocks"):
        concio.model_from_solids(tmp_path / "nothing.obj", layers={"ground": "fixed"})


def test_a_block_inside_another_is_an_overlap(tmp_path: Path) -> None:
    text = obj_of(CUBE) + "\n" + obj_of(0.5 * CUBE + 0.25, [tuple(v + 8 for v in f) for f in BOX], "inner")
    code, out, err = run("check", bad(tmp_path, text))
    assert code == 2
    assert "'c'" in out + err
    assert "'inner'" in out + err
    assert "overlap" in out + err


def test_too_many_vertices_are_refused_in_a_sentence(tmp_path: Path) -> None:
    n = 21_000  # triangles of a tube: closed parts would be judged, too many vertices are said first
    points = np.random.default_rng(1).normal(size=(n, 3))
    text = "o scan\n" + "\n".join(f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in points)
    text += "\n" + "\n".join(f"f {k} {k + 1} {k + 2}" for k in range(1, n - 2))
    code, out, err = run("check", bad(tmp_path, text))
    assert code == 2
    assert "vertices are more than the 20,000 a block may have" in " ".join((out + err).split())


def test_faces_that_share_no_vertex_are_one_block(tmp_path: Path) -> None:
    """3DFACEs, and meshes that give each face vertices of its own, are put together where these coincide."""
    ezdxf = pytest.importorskip("ezdxf")
    for closed in (True, False):
        document = ezdxf.new()
        for face in BOX if closed else BOX[:5]:
            document.modelspace().add_3dface([tuple(CUBE[v]) for v in face], dxfattribs={"layer": "stone"})
        document.saveas(tmp_path / "faces.dxf")
        if closed:
            model = concio.model_from_solids(tmp_path / "faces.dxf", block="rigid", unit="m")
            assert [(b.name, b.volume) for b in model.bodies] == [("stone", pytest.approx(1.0))]
        else:
            with pytest.raises(GeometryError, match="block 'stone': the surface is open"):
                concio.model_from_solids(tmp_path / "faces.dxf", block="rigid", unit="m")


def test_a_block_that_touches_nothing_is_told(tmp_path: Path) -> None:
    text = obj_of(CUBE) + "\n" + obj_of(CUBE + np.array([0, 0, 5.0]), [tuple(v + 8 for v in f) for f in BOX], "high")
    path = bad(tmp_path, text)
    path.write_text(path.read_text().replace("[materials", "[solids]\nground = true\n[materials"))
    code, out, _ = run("check", path)
    assert code == 0
    assert "attention    'high' is not connected to any support: it falls" in out
    assert "'c' touches" not in out


CHAPEL = """
[[parts]]
name = "wall"
[parts.walls]
lines = [[[0, 0], [2, 0]], {{ start = [0, 0], end = [0, 3], openings = [{{ x = 1.5, y = 0, width = 0.75, {} }}] }}]
height = 1.5
block_size = {}
block = "rigid"
[[parts]]
name = "vault"
at = {}
turn = -90
without = "right abutment"
[parts.barrel]
span = 2
ring = 0.25
length = 1
voussoirs = 7
block = "rigid"
[[ties]]
name = "bar"
body_a = "wall-w1-c06-b02"
at_a = [1, 0, {}]
at_b = [1, 3, 1.4]
stiffness = 1000
yield_force = 30
"""
SOUND = ("height = 1, lintel = 0.25", "[0.5, 0.25, 0.25]", "[0.5, 1.1, 1.5]", "1.4")
MISTAKES = {
    "none": ({}, 0, ""),
    "no lintel": ({0: "height = 1"}, 0, "'wall-w2-c05-b04' has no block or support below: only friction"),
    "millimetres": ({1: "[500, 250, 250]"}, 2, "the wall is 2 m long and 250 m thick -> .*is block_size in mm"),
    "elsewhere": ({2: "[0.5, 1.1, 9]"}, 0, "blocks are in 2 groups that do not touch: 'wall-w1-c01-b01' and 63 more"),
    "hanging": ({2: "[0.5, 1.6, 1.5]"}, 0, "'vault-v07-b01'.* have no block or support below: .*a pier missing"),
    "tie": ({3: "4.1"}, 0, "tie 'bar' ends at .1, 0, 4.1. m, 2.6 m outside 'wall-w1-c06-b02'"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_in_putting_parts_together_are_noticed(tmp_path: Path, mistake: str) -> None:
    changed, code, said = MISTAKES[mistake]
    (tmp_path / "m.toml").write_text(CHAPEL.format(*(changed.get(k, text) for k, text in enumerate(SOUND))))
    found, out, err = run("check", tmp_path / "m.toml")
    assert found == code, out + err
    words = " ".join((out + err).split())
    assert re.search(said, words), words
    assert ("attention" in words) == (mistake not in ("none", "millimetres"))


def test_compas_and_json_that_is_none(tmp_path: Path) -> None:
    block = {"vertex": {str(k): dict(zip("xyz", p, strict=True)) for k, p in enumerate(CUBE.tolist())}}
    block["face"] = {str(k): [str(v) for v in f] for k, f in enumerate(BOX)}  # type: ignore[assignment]
    whole = {"dtype": "a/Assembly", "data": {"graph": {"node": {"4": {"block": {"data": block}, "is_support": True}}}}}
    whole["meshes"] = [{"vertices": (CUBE + np.array([0, 0, 1])).tolist(), "faces": [list(f) for f in BOX]}]  # type: ignore[assignment]
    path = tmp_path / "a.json"
    path.write_text(json.dumps(whole))
    model = concio.model_from_solids(path, block="rigid")
    assert {(b.name, b.kind) for b in model.bodies} == {("b4", "fixed"), ("b1", "rigid")}
    del whole["data"]["graph"]["node"]["4"]["block"]["data"]["vertex"]["3"]  # type: ignore[index]
    path.write_text(json.dumps(whole))
    with pytest.raises(InputError, match="a face or a vertex lacks '3'"):
        concio.model_from_solids(path, block="rigid")
    path.write_text(json.dumps({"vertices": CUBE.tolist(), "faces": [[0, 1], [2], []]}))
    with pytest.raises(InputError, match="face 1 has 2 vertices"):
        concio.model_from_solids(path, block="rigid")


def test_files_with_solids(tmp_path: Path) -> None:
    concio.write_solids(tmp_path / "arch.obj", arch())
    text = 'solids_file = "arch.obj"\n[joints.dry]\nfriction = 0.7\n[materials.block]\nkind = "rigid"\nunit_weight = 20'
    model = concio.loads(text, folder=tmp_path)
    assert len(model.bodies) == len(arch().bodies)
    assert model.laws["dry"].friction == 0.7
    assert [load.kind for load in model.loads] == ["weight"]
    with pytest.raises(InputError, match="solids_file is not"):
        concio.loads("[solids]\nunit = 'mm'\n[column]\nwidth = 1\nheight = 1\nblocks = 1")


def test_a_file_whose_y_axis_points_up(tmp_path: Path) -> None:
    shown = concio.model_from_solids(_stack(tmp_path, "up.obj", y_up=True), up="y", block="rigid")
    stood = concio.model_from_solids(_stack(tmp_path, "stood.obj", y_up=False), block="rigid")
    for a, b in zip(shown.polyhedra, stood.polyhedra, strict=True):
        assert np.array_equal(a.vertices, b.vertices)
        assert a.faces == b.faces
    (tmp_path / "m.toml").write_text('solids_file = "up.obj"\n[solids]\nup = "y"\n[materials.block]\nkind = "rigid"\n'
                                     "unit_weight = 20\n[joints.dry]\nfriction = 0.6\n")  # fmt: skip
    assert np.array_equal(concio.load(tmp_path / "m.toml").polyhedra[1].vertices, stood.polyhedra[1].vertices)
    with pytest.raises(InputError, match="up = 'x' is not 'y' or 'z'"):
        concio.model_from_solids(tmp_path / "up.obj", up="x")  # type: ignore[arg-type]


def _stack(folder: Path, name: str, *, y_up: bool) -> Path:
    """Write two boxes that stand on each other, the lower fixed, with y or z upwards."""
    lines = []
    for k, word in enumerate(("ground", "block")):
        corners = [(x, y, z) for z in (k, k + 1) for x, y in ((0, 0), (2, 0), (2, 3), (0, 3))]
        lines += [f"o {word}"] + [f"v {x} {z} {-y}" if y_up else f"v {x} {y} {z}" for x, y, z in corners]
        faces = ((4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
        lines += ["f " + " ".join(str(8 * k + i) for i in face) for face in faces]
    (folder / name).write_text("\n".join(lines) + "\n")
    return folder / name
