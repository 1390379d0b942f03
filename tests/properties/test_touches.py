"""Where bodies touch, a joint is made or the place is reported: tilted feet, knife edges, corners, rough tolerances."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from concio import Body, JointLaw, Load, Model, Polyhedron, Rigid
from concio.contact.detection import detect
from concio.model.interfaces.detect import detect_interfaces
from concio.model.interfaces.patches import detect_patches
from samples import sample

TILTS = [0.0, 1e-8, 1e-6, 2e-6, 1e-5, 1e-4, 1e-3, 1e-2, 3e-2, 8e-2, 0.0871, 0.0873, 0.1, 0.3]
BOX = Polyhedron.box("b", (0, 0, 0), (1, 1, 1)).faces
STONE, LAW = {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(friction=0.6)}


def tilted_cube(tilt: float, space: bool) -> Model:
    """A cube whose foot rises by ``tilt`` along x, on the ground."""
    if space:
        corners = np.array([(x, y, z + tilt * x * (z == 0)) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        bodies = (
            Polyhedron.box("g", (-5, -5, -1), (5, 5, 0), kind="fixed"), Polyhedron("b", corners, faces, kind="rigid"),
        )  # fmt: skip
    else:
        bodies = (
            Body("g", [(-5, -1), (5, -1), (5, 0), (-5, 0)], kind="fixed"),
            Body("b", [(0, 0), (1, tilt), (1, 1), (0, 1)], kind="rigid"),
        )
    down = (0.0, 0.0, -1.0) if space else (0.0, -1.0)
    return Model(bodies, STONE, LAW, loads=(Load("weight", down),))


@pytest.mark.parametrize("space", [False, True])
def test_a_cube_comes_to_rest_on_its_tilted_foot_whatever_the_tilt(space: bool) -> None:
    """It turns by the tilt about the edge it touches with: its middle sinks by half of it, and no verdict jumps."""
    for tilt in TILTS:
        model = tilted_cube(tilt, space)
        result = concio.solve(model)
        sunk = -float(result.node_displacement("b").mean(0)[-1])
        assert sunk == pytest.approx(tilt / 2, rel=0.05, abs=1e-6 * model.size)
        assert not result.assembly.detection.near_misses


@pytest.mark.parametrize("space", [False, True])
def test_a_foot_tilted_by_more_than_faces_may_be_is_an_edge_about_which_the_cube_turns(space: bool) -> None:
    found = detect(tilted_cube(0.5, space))
    assert not found.not_made
    (edge,) = found.interfaces
    assert edge.kind == ("face-edge" if space else "face-corner")
    assert edge.normal == pytest.approx([0, 0, 1] if space else [0, 1])
    with pytest.raises(concio.NoEquilibriumError):
        concio.solve(tilted_cube(0.5, space))


@pytest.mark.parametrize("seed", range(sample(6, 16, 40)))
def test_a_knife_edge_in_the_plane_is_named_wherever_it_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle, shift, size = rng.uniform(0, 2 * np.pi), rng.uniform(-50, 50, 2), 10 ** rng.uniform(-2, 2)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    x, half = rng.uniform(1.0, 4.0), rng.uniform(0.05, 0.5)

    def body(name: str, outline: list[tuple[float, float]], kind: str) -> Body:
        return Body(name, size * (np.array(outline) @ turn.T) + shift, kind=kind)

    pier = body("pier", [(-0.5, 0), (0.2, 0), (0.2, 1), (-0.5, 1)], "fixed")
    knife = body("knife", [(x - half, 0.5), (x + half, 0.5), (x, 1)], "fixed")
    beam = body("beam", [(0, 1), (4.5, 1), (4.5, 1.3), (0, 1.3)], "rigid")
    bodies = [pier, knife, beam]
    rng.shuffle(bodies)
    found = detect_interfaces(bodies, tolerance=1e-6 * 5 * size)
    assert len(found.interfaces) == 1
    (miss,) = found.not_made
    assert (miss.kind, {miss.a, miss.b}) == ("corner", {"knife", "beam"})
    assert {bodies[k].name for k in miss.bodies} == {"knife", "beam"}
    assert miss.at == pytest.approx(size * (turn @ (x, 1.0)) + shift, abs=1e-3 * size)


def random_motion(rng: np.random.Generator):
    turn = Rotation.random(random_state=rng).as_matrix()
    shift, size = rng.uniform(-50, 50, 3), 10 ** rng.uniform(-2, 2)

    def moved(name: str, points, faces, kind: str = "rigid") -> Polyhedron:
        return Polyhedron(name, size * (np.asarray(points, float) @ turn.T) + shift, faces, kind=kind)

    return moved, lambda p: size * (turn @ np.asarray(p, float)) + shift, size


def prism_points(x: float, half: float, y0: float, y1: float) -> list[tuple[float, float, float]]:
    """A prism whose sharp edge runs along y at z = 1."""
    return [(x - half, y0, 0.5), (x + half, y0, 0.5), (x, y0, 1), (x - half, y1, 0.5), (x + half, y1, 0.5), (x, y1, 1)]


PRISM = [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)]


def box_points(low, high) -> np.ndarray:
    return Polyhedron.box("b", low, high).vertices


@pytest.mark.parametrize("seed", range(sample(6, 16, 40)))
def test_a_knife_edge_in_space_is_named_with_its_place_and_length(seed: int) -> None:
    """The edge may begin and end on the beam or beyond it."""
    rng = np.random.default_rng(seed)
    moved, where, size = random_motion(rng)
    x, half = rng.uniform(1.0, 4.0), rng.uniform(0.05, 0.5)
    y0, y1 = sorted(rng.uniform(-1, 2, 2))
    y0, y1 = min(y0, 0.7), max(y1, 0.75)
    bodies = [
        moved("pier", box_points((-0.5, 0, 0), (0.2, 1, 1)), BOX, "fixed"),
        moved("knife", prism_points(x, half, y0, y1), PRISM, "fixed"),
        moved("beam", box_points((0, 0, 1), (4.5, 1, 1.3)), BOX),
    ]
    rng.shuffle(bodies)
    found = detect_patches(bodies, tolerance=1e-6 * 5 * size)
    assert len(found.patches) == 1
    (miss,) = found.not_made
    lo, hi = max(y0, 0.0), min(y1, 1.0)
    assert (miss.kind, {miss.a, miss.b}) == ("edge", {"knife", "beam"})
    assert miss.length == pytest.approx(size * (hi - lo), abs=3e-3 * size)
    assert miss.at == pytest.approx(where((x, (lo + hi) / 2, 1)), abs=3e-3 * size)


@pytest.mark.parametrize("seed", range(sample(4, 8, 20)))
def test_edges_that_cross_and_corners_on_faces_are_named(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    moved, where, size = random_motion(rng)
    x = rng.uniform(0.3, 0.7)
    lower = moved("lower", prism_points(x, 0.3, 0, 1), PRISM, "fixed")
    upper = [(p[1], p[0], 2 - p[2]) for p in prism_points(rng.uniform(0.3, 0.7), 0.3, 0, 1)]
    at = (x, upper[2][1], 1.0)
    (miss,) = detect_patches([lower, moved("upper", upper, PRISM)], tolerance=1e-6 * size).not_made
    assert miss.kind == "corner"
    assert miss.at == pytest.approx(where(at), abs=3e-3 * size)

    floor = moved("floor", box_points((-1, -1, 0), (2, 2, 1)), BOX, "fixed")
    tip = [(0.2, 0.1, 1), (0.8, 0.1, 2), (0.2, 0.9, 2), (-0.4, 0.1, 2)]
    (miss,) = detect_patches(
        [floor, moved("tip", tip, [(0, 2, 1), (0, 3, 2), (0, 1, 3), (1, 2, 3)])], tolerance=1e-6 * size
    ).not_made
    assert miss.kind == "corner"
    assert miss.at == pytest.approx(where((0.2, 0.1, 1)), abs=3e-3 * size)


def test_a_pointed_foot_is_a_contact_beside_the_joint_that_another_foot_of_the_same_body_has() -> None:
    """A table with one flat and one pointed foot, in the plane and extruded."""
    table = Body("t", [(0, 0), (0.5, 0), (0.5, 1), (2.5, 1), (2.75, 0), (3, 1), (3, 1.2), (0, 1.2)], kind="rigid")
    floor = Body("f", [(-1, -1), (4, -1), (4, 0), (-1, 0)], kind="fixed")
    model = Model((floor, table), STONE, LAW, loads=(Load("weight", (0.0, -1.0)),))
    for one, kind in ((model, "corner"), (concio.extrude(model, 0.8), "edge")):
        found = detect(one)
        assert len(found.faces) == 1
        (tip,) = found.point_contacts
        assert tip.kind == f"face-{kind}"
        assert tip.middle[0] == pytest.approx(2.75)
        assert tip.middle[-1] == pytest.approx(0.0)
        assert not found.near_misses


def test_a_prop_in_the_corner_of_floor_and_wall_bears_on_the_floor() -> None:
    """Its face lies on the wall, which joins it to the floor at that place; its corner on the floor is reported."""
    wall = Body("wall", [(-1, 0), (0, 0), (0, 2), (-1, 2)], kind="fixed")
    floor = Body("floor", [(-2, -1), (3, -1), (3, 0), (-2, 0)], kind="fixed")
    prop = Body("prop", [(0, 0), (0.3, 0.2), (0.3, 1), (0, 1)], kind="rigid")
    (miss,) = detect_interfaces([wall, floor, prop], tolerance=1e-6).not_made
    assert {miss.a, miss.b} == {"floor", "prop"}


@pytest.mark.parametrize("tolerance", [1e-4, 1e-3, 5e-3, 0.02, 0.05, 0.1][-sample(3, 6) :])
def test_no_joint_of_a_vault_is_lost_unseen_at_a_rough_tolerance(tolerance: float) -> None:
    """Joints narrower than the tolerance are joints all the same."""
    rough = concio.dome(span=2.0, ring=0.06, courses=4, blocks=9, block="rigid", friction=0.6, oculus=0.3)
    fine = detect(rough)
    found = detect_patches(rough.polyhedra, tolerance=tolerance)
    made = {(p.a, p.b) for p in found.patches} | {m.bodies for m in found.near_misses}
    assert {(p.a, p.b) for p in fine.patches} <= made


def test_a_gap_is_not_bonded() -> None:
    """Blocks glued where they touch are not where they are apart at first: one that hangs above nothing falls."""
    ceiling = Body("ceiling", [(0, 1.0005), (1, 1.0005), (1, 2), (0, 2)], kind="fixed")
    block = Body("block", [(0, 0), (1, 0), (1, 1), (0, 1)], kind="rigid")
    glue = {"joint": JointLaw(friction=0.6, cohesion=500.0, tensile_strength=500.0)}
    model = Model((ceiling, block), STONE, glue, loads=(Load("weight", (0.0, -1.0)),))
    assert not concio.solve(model, on_failure="return").solved
