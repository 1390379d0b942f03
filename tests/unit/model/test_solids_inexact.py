"""Blocks of other programs that are not exact: rounded coordinates, warped faces, odd names, numbers beyond reason."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import concio
from concio import Body, GeometryError, InputError, JointLaw, Model, Rigid
from concio.contact.detection import detect


def rounded(model: Model, path: Path, digits: int) -> Path:
    """The blocks of a model in a file, with coordinates of so many decimals."""
    concio.write_solids(path, model)
    text = re.sub(r"-?\d+\.\d+(e-?\d+)?", lambda found: f"{float(found.group()):.{digits}f}", path.read_text())
    path.write_text(text)
    return path


def test_blocks_rounded_to_a_tenth_of_a_millimetre_are_snapped_and_joined(tmp_path: Path) -> None:
    """Vertices move into the planes of their faces by no more than the accuracy; what was moved how far is reported."""
    exact = concio.dome(span=4, ring=0.3, courses=3, blocks=8, block="rigid", friction=0.7, oculus=0.8)
    exact = concio.place(exact, turn=17, axis=(1, 2, 3))
    path = rounded(exact, tmp_path / "dome.obj", 4)
    model = concio.model_from_solids(path, block="rigid", friction=0.7, gap_tolerance="0.3 mm")
    assert model.gap_tolerance == pytest.approx(3e-4)
    found = detect(model)
    assert not found.report()
    assert {(p.a, p.b) for p in found.patches} == {(p.a, p.b) for p in detect(exact).patches}
    moved = model.generator["moved"]
    assert len(moved) > 10
    for sentence in moved:
        assert 0 < float(re.search(r"moved by up to (\S+) mm", sentence).group(1)) < 0.3


CORNERS = np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
FACES = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def warped_stack(path: Path, warp: float, digits: int = 6) -> Path:
    """Two blocks whose common face is twisted: a corner of it stands ``warp`` out of the plane of the others."""
    lines = []
    for k in range(2):
        points = CORNERS + np.array([0.0, 0.0, k])
        points[[5, 7] if k == 0 else [1, 3], 2] += warp
        lines += [f"o b{k}", *(f"v {x:.{digits}f} {y:.{digits}f} {z:.{digits}f}" for x, y, z in points)]
        lines += ["f " + " ".join(str(8 * k + v + 1) for v in face) for face in FACES]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_warped_faces_are_split_where_that_is_asked_for_and_alike_in_both_blocks(tmp_path: Path) -> None:
    path = warped_stack(tmp_path / "warped.obj", 0.03)
    with pytest.raises(GeometryError, match=r"not planar.*split_warped = true splits such"):
        concio.model_from_solids(path, block="rigid")
    model = concio.model_from_solids(path, block="rigid", friction=0.6, ground=True, split_warped=True)
    found = detect(model)
    assert not found.overlaps
    between = [p for p in found.patches if {model.bodies[p.a].name, model.bodies[p.b].name} == {"b0", "b1"}]
    assert len(between) == 2
    assert sum(p.area for p in between) == pytest.approx(1.0, rel=5e-3)
    assert max(np.abs(p.signed_gap).max() for p in between) < 1e-9
    assert "'b0': 1 faces that are not plane were split into triangles" in model.generator["moved"]
    assert concio.solve(model).solved
    text = 'solids_file = "warped.obj"\n[solids]\nsplit_warped = true\nground = true\n[materials.block]\n'
    text += 'kind = "rigid"\nunit_weight = 20\n[joints.dry]\nfriction = 0.6\n'
    assert len(concio.loads(text, folder=tmp_path).bodies) == 3


def test_faces_are_snapped_no_further_than_the_accuracy(tmp_path: Path) -> None:
    path = warped_stack(tmp_path / "warped.obj", 4e-4)
    with pytest.raises(GeometryError, match=r"gap_tolerance = 0.4 mm moves its corners into planes"):
        concio.model_from_solids(path, block="rigid")
    with pytest.raises(GeometryError, match="not planar"):
        concio.model_from_solids(path, block="rigid", gap_tolerance=2e-5)
    model = concio.model_from_solids(path, block="rigid", friction=0.6, ground=True, gap_tolerance=5e-4)
    for body in model.polyhedra:
        top = body.topology
        off = (body.vertices[top.start] * body.normals[top.face]).sum(1) - body.offsets[top.face]
        assert np.abs(off).max() < 1e-8
    assert concio.solve(model).solved
    with pytest.raises(InputError, match="gap_tolerance = -1 must be positive"):
        concio.model_from_solids(path, block="rigid", gap_tolerance=-1.0)


def test_a_ply_that_declares_an_element_or_a_property_twice_is_refused(tmp_path: Path) -> None:
    head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    for more, words in (
        ("element face 1\nelement face 1\nproperty list uchar int vertex_indices\n", "declares element 'face' twice"),
        ("property float z\nelement face 1\nproperty list uchar int vertex_indices\n", "line 7 of the header"),
    ):
        path = tmp_path / "twice.ply"
        path.write_text(head + more + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        with pytest.raises(InputError, match=words):
            concio.model_from_solids(path)


def test_names_with_control_characters_are_refused_or_written_without_them(tmp_path: Path) -> None:
    body = Body("a\x1b[2J", [(0, 0), (1, 0), (1, 1), (0, 1)], kind="rigid")
    with pytest.raises(InputError, match=r"the name 'a\\x1b\[2J' holds a control character"):
        Model((body,), {"block": Rigid()}, {"joint": JointLaw(0.6)})
    path = warped_stack(tmp_path / "named.obj", 0.0)
    path.write_text(path.read_text().replace("o b1", "o b\x07one"))
    assert "b_one" in {b.name for b in concio.model_from_solids(path, block="rigid").bodies}


def test_names_of_blocks_come_back_from_a_dxf(tmp_path: Path) -> None:
    model = concio.extrude(concio.arch(span=2, ring=0.3, voussoirs=5, block="rigid", friction=0.7), 0.4)
    concio.write_solids(tmp_path / "arch.dxf", model)
    again = concio.model_from_solids(tmp_path / "arch.dxf", block="rigid", friction=0.7)
    assert sorted(b.name for b in again.bodies) == sorted(b.name for b in model.bodies)
