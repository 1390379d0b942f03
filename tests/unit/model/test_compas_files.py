"""COMPAS files as other programs and older versions write them: places, supports, solids that are not meshes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import concio
from concio import GeometryError, InputError
from concio.model.polyhedron import BOX
from samples import sample

CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
angles = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


def mesh(at: Any = (0.0, 0.0, 0.0), sizes: Any = (1.0, 1.0, 1.0)) -> dict[str, Any]:
    vertices = CUBE * sizes + at
    return {
        "dtype": "compas.datastructures/Mesh", "data": {
            "attributes": {"name": "Mesh"}, "face": {str(k): list(face) for k, face in enumerate(BOX)},
            "vertex": {str(k): dict(zip("xyz", v.tolist(), strict=True)) for k, v in enumerate(vertices)},
        },
    }  # fmt: skip


def frame(turn: np.ndarray, point: Any) -> dict[str, Any]:
    data = {"point": list(point), "xaxis": turn[:, 0].tolist(), "yaxis": turn[:, 1].tolist()}
    return {"dtype": "compas.geometry/Frame", "data": data}


def element(geometry: Any, **data: Any) -> dict[str, Any]:
    return {"dtype": "compas_model.elements/BlockElement", "data": {"geometry": geometry, **data}}


def read(folder: Path, data: Any, **options: Any) -> concio.Model:
    path = folder / "blocks.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    return concio.model_from_solids(path, block="rigid", **options)


@given(angles=angles, point=st.tuples(*[st.floats(-5.0, 5.0)] * 3))
@settings(max_examples=sample(5, 20), deadline=None)
def test_elements_stand_in_their_frames(angles, point, tmp_path_factory):
    """The frame comes before the transformation; such elements were read at the origin."""
    turn = Rotation.from_rotvec(angles).as_matrix()
    shift = np.eye(4)
    shift[:3, 3] = 0.5, -1.0, 2.0
    moved = {"dtype": "compas.geometry/Transformation", "data": {"matrix": shift.tolist()}}
    folder, sizes = tmp_path_factory.mktemp("frames"), (1.0, 2.0, 3.0)
    found = [
        read(folder, element(mesh(sizes=sizes), frame=frame(turn, point), transformation=t)).bodies[0].vertices
        for t in (None, moved)
    ]
    own = CUBE * sizes
    assert found[0] == pytest.approx(own @ turn.T + point, abs=1e-12)
    assert found[1] == pytest.approx((own + shift[:3, 3]) @ turn.T + point, abs=1e-12)


def test_boxes_stand_about_the_origin_of_their_frames(tmp_path):
    """They were left out without a word where meshes stood beside them."""
    turn = Rotation.from_rotvec([0.1, -0.4, 0.7]).as_matrix()
    data = {"xsize": 1.0, "ysize": 2.0, "zsize": 3.0, "frame": frame(turn, (5.0, 0.0, 1.0))}
    box = {"dtype": "compas.geometry/Box", "data": data}
    found = read(tmp_path, [box, mesh()]).bodies
    assert [b.volume for b in found] == pytest.approx([6.0, 1.0])
    expected = (CUBE - 0.5) * (1.0, 2.0, 3.0) @ turn.T + (5.0, 0.0, 1.0)
    assert sorted(map(tuple, found[0].vertices.round(9).tolist())) == sorted(map(tuple, expected.round(9).tolist()))


@pytest.mark.parametrize("kind", ["Cylinder", "Brep", "VolMesh", "CellNetwork"])
def test_solids_that_are_not_read_are_not_passed_over(tmp_path, kind):
    data = {"dtype": f"compas.geometry/{kind}", "data": {"radius": 1.0}}
    with pytest.raises(GeometryError, match=f"is a {kind}, which is not read"):
        read(tmp_path, [data, mesh()])
    assert len(read(tmp_path, [data, mesh()], on_fault="skip").bodies) == 1


@pytest.mark.parametrize(("said", "kind"), [(True, "fixed"), (1, "fixed"), (False, ""), (0, ""), (None, "")])
def test_supports_are_said_by_true_or_one(tmp_path, said, kind):
    found = read(tmp_path, [element(mesh(), is_support=said), mesh((0.0, 0.0, 1.0))])
    assert found.bodies[0].kind == (kind or "rigid")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"is_support": "true"}, 'is_support is "true"'),
        ({"transformation": np.eye(4).tolist()}, "a transformation is not a matrix"),
        ({"frame": {"data": {"point": [0, 0, 0], "xaxis": [1, 0, 0], "yaxis": [2, 0, 0]}}}, "a frame is not"),
    ],
)
def test_what_is_not_understood_is_refused(tmp_path, data, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, element(mesh(), **data))


def test_features_of_an_element_are_not_passed_over(tmp_path):
    """A block with a cut was read as it is without."""
    cut = element(mesh(), transformation=None, features=[{"dtype": "compas_model.elements/Cut", "data": {}}])
    with pytest.raises(GeometryError, match="has features, which are not applied"):
        read(tmp_path, [cut, mesh()])
    assert len(read(tmp_path, [cut, mesh()], on_fault="skip").bodies) == 1
    assert len(read(tmp_path, element(mesh(), transformation=None, features=[])).bodies) == 1
