"""concio behind compas_dem: files both ways, its problems solved and its results filled, with the real packages."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from concio.errors import InputError, NoEquilibriumError
from concio.io.compas_dem import model_of_problem, solve_problem

GRAVITY = 9.81
DENSITY = 2000.0


@pytest.fixture(scope="module")
def dem() -> Any:
    return pytest.importorskip("compas_dem", reason="the extra compas is not installed")


def stack(dem: Any, blocks: int = 3, push: float = 0.0) -> Any:
    """Return the problem of a pillar of cubes of 1 m on a support, pushed at the head [N]."""
    geometry, models = pytest.importorskip("compas.geometry"), pytest.importorskip("compas_dem.models")
    elements, problems = pytest.importorskip("compas_dem.elements"), pytest.importorskip("compas_dem.problem")
    material = pytest.importorskip("compas_dem.material.generic").GenericMaterial(density=DENSITY)
    model = models.BlockModel(name="pillar")
    model.add_material(material)
    for k in range(blocks + 1):
        box = geometry.Box(1.0, 1.0, 1.0, geometry.Frame([0, 0, 0.5], [1, 0, 0], [0, 1, 0]))
        shift = geometry.Translation.from_vector([0, 0, k])
        block = elements.Block.from_box(box, name=f"drum {k}", transformation=shift)
        block.is_support = k == 0
        model.add_element(block)
        model.assign_material(material, element=block)
    problem = problems.Problem(model)
    problem.set_contact_model("MohrCoulomb", mu=0.6)
    if push:
        group = problem.add_boundary_condition("live")
        problem.add_point_load_at_point(blocks, [-0.5, 0.0, blocks + 1.0], [push, 0.0, 0.0], boundary_condition=group)
    return problem


def test_names_supports_and_places_go_through_files_both_ways(dem: Any, tmp_path: Path) -> None:
    compas = pytest.importorskip("compas")
    compas.json_dump(stack(dem).model, tmp_path / "theirs.json")
    read = concio.model_from_solids(tmp_path / "theirs.json", block="rigid", friction=0.6)
    assert [(b.name, b.kind) for b in read.bodies] == [(f"drum {k}", "rigid" if k else "fixed") for k in range(4)]
    assert [b.centroid[2] for b in read.bodies] == pytest.approx([0.5, 1.5, 2.5, 3.5])
    concio.write_solids(tmp_path / "ours.json", read)
    again = compas.json_load(tmp_path / "ours.json")
    assert type(again).__name__ == "BlockModel"
    assert [(e.name, e.is_support) for e in again.elements()] == [(f"drum {k}", k == 0) for k in range(4)]
    assert [e.modelgeometry.volume() for e in again.elements()] == pytest.approx([1.0] * 4)


def test_a_pillar_weighs_on_each_joint_what_stands_above_it(dem: Any) -> None:
    problem = stack(dem)
    results = solve_problem(problem)
    weight = GRAVITY * DENSITY
    assert {tuple(sorted(edge)) for edge in results.edges()} == {(0, 1), (1, 2), (2, 3)}
    for edge in results.edges():
        above = 4 - max(edge)
        sign = 1.0 if edge[0] > edge[1] else -1.0  # the force on the first node; the upper block is held up
        assert results.resultant_global(edge) == pytest.approx([0.0, 0.0, sign * above * weight], abs=1e-6)
        assert results.resultant_local(edge)[2] == pytest.approx(above * weight)
        assert results.face_contact(edge)
        assert list(results.contact_data(edge).resultantpoint) == pytest.approx([0.0, 0.0, max(edge)], abs=1e-9)
    assert results.metadata["verdict"]["outcome"] == "holds"
    assert results.displacement(3) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_a_pillar_overturns_at_its_limit_and_not_below(dem: Any) -> None:
    """Three cubes overturn round their lower edge where push times 3 m is their weight times half a metre."""
    limit = 3.0 * GRAVITY * DENSITY * 0.5 / 3.0
    assert solve_problem(stack(dem, push=0.99 * limit)).metadata["verdict"]["outcome"] == "holds"
    with pytest.raises(NoEquilibriumError):
        solve_problem(stack(dem, push=1.01 * limit))
    fallen = solve_problem(stack(dem, push=1.01 * limit), on_failure="return")
    assert fallen.metadata["verdict"]["outcome"] == "fails"
    assert not list(fallen.edges())


def test_a_moved_support_takes_its_pillar_along(dem: Any) -> None:
    problem = stack(dem)
    group = problem.add_boundary_condition("settlement")
    problem.add_displacement(0, [0.01, 0.0, -0.02], boundary_condition=group)
    problem.add_rotation(0, [0.0, 0.0, 0.001], boundary_condition=group)
    results = solve_problem(problem)
    for node in range(4):
        assert results.displacement(node) == pytest.approx([0.01, 0.0, -0.02], abs=1e-5)
        assert results.rotation(node)[1][0] == pytest.approx(0.001, rel=1e-3)


def test_couples_and_loads_on_faces_count(dem: Any) -> None:
    """A couple of half the weight of the head block moves the force below it by half a metre less half the face."""
    problem = stack(dem, blocks=1)
    group = problem.add_boundary_condition("live")
    weight = GRAVITY * DENSITY
    problem.add_moment(1, [0.0, 0.25 * weight, 0.0], boundary_condition=group)
    results = solve_problem(problem)
    (edge,) = results.edges()
    assert list(results.contact_data(edge).resultantpoint) == pytest.approx([0.25, 0.0, 1.0], abs=1e-9)


def test_what_is_missing_is_told(dem: Any) -> None:
    problem = stack(dem)
    bare = type(problem)(problem.model)
    with pytest.raises(InputError, match="no contact model"):
        model_of_problem(bare)
    for element in problem.model.elements():
        element._material = None
    with pytest.raises(InputError, match="no material with a density"):
        model_of_problem(problem)
    held = stack(dem)
    group = held.add_boundary_condition("moved")
    held.add_displacement(2, [0.01, 0.0, 0.0], boundary_condition=group)
    with pytest.raises(InputError, match="block 2, which is not a support"):
        model_of_problem(held)


def test_groups_and_the_model_move_what_they_hold(tmp_path: Path) -> None:
    """Without COMPAS: a file of two elements in a group, each of the three with a shift of its own."""

    def shift(x: float, y: float, z: float) -> dict[str, Any]:
        matrix = np.eye(4)
        matrix[:3, 3] = x, y, z
        return {"dtype": "compas.geometry/Transformation", "data": {"matrix": matrix.tolist()}}

    box = concio.Polyhedron.box("b", (0, 0, 0), (1, 1, 1), kind="rigid")
    model = concio.Model((box,), {"block": concio.Rigid()}, {"joint": concio.JointLaw(0.6)})
    concio.write_solids(tmp_path / "a.json", model)
    data = json.loads((tmp_path / "a.json").read_text())
    inner, (key, element) = data["data"], next(iter(data["data"]["elements"].items()))
    element["data"]["transformation"] = shift(1, 0, 0)
    inner["transformation"] = shift(0, 0, 4)
    inner["elements"]["group"] = {"dtype": "compas_model.elements/Group", "data": {"transformation": shift(0, 2, 0)}}
    inner["tree"]["root"]["children"] = [{"element": "group", "children": [{"element": key}]}]
    (tmp_path / "a.json").write_text(json.dumps(data))
    (body,) = concio.model_from_solids(tmp_path / "a.json", block="rigid", friction=0.6).bodies
    assert body.name == "b"
    assert body.vertices.min(0) == pytest.approx([1, 2, 4])
    element["data"]["transformation"]["data"]["matrix"] = [[1.0]]
    (tmp_path / "a.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match="not a matrix of 4 x 4"):
        concio.model_from_solids(tmp_path / "a.json", block="rigid", friction=0.6)
