"""Contacts at corners and along edges in every analysis: reactions of hand statics, what is told, what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import concio
from concio import Body, Elastic, JointLaw, Load, Model, Polyhedron, Rigid, Stage
from concio.analysis.thrust import hinges
from concio.contact.detection import detect
from concio.contact.touching import _contacts
from concio.io.result_dir import write_result
from concio.io.result_file import load_result
from concio.verdict.attention import attention_of
from samples import sample

STONE, LAW = {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(friction=0.6)}
DOWN2, DOWN3 = (Load("weight", (0.0, -1.0)),), (Load("weight", (0.0, 0.0, -1.0)),)


def knife(name: str, x: float, half: float = 0.2) -> Body:
    return Body(name, [(x - half, 0.5), (x + half, 0.5), (x, 1.0)], kind="fixed")


def beam_on_knives(first: float = 1.0, second: float = 4.0, push: float = 0.1, kind: str = "rigid") -> Model:
    """A beam of 4.5 x 0.3 m, 27 kN, on two edges; a tenth of its weight pushes along it."""
    beam = Body("beam", [(0, 1), (4.5, 1), (4.5, 1.3), (0, 1.3)], kind=kind)
    materials = {"block": Rigid(20.0) if kind == "rigid" else Elastic(E=1e7, nu=0.2, unit_weight=20.0)}
    loads = (*DOWN2, Load("weight", (push, 0.0), group="live"))
    return Model((knife("k1", first), knife("k2", second), beam), materials, LAW, loads=loads)


def levers(first: float, second: float, weight: float = 27.0, middle: float = 2.25) -> tuple[float, float]:
    """Reactions of a beam on two supports [kN]."""
    right = weight * (middle - first) / (second - first)
    return weight - right, right


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("places", [(1.0, 4.0), (0.3, 2.3)])
def test_a_beam_on_two_knife_edges_has_the_reactions_of_the_lever(
    places: tuple[float, float], kind: str, space: bool
) -> None:
    model = beam_on_knives(*places, push=0.0, kind=kind)
    model = concio.extrude(model, 1.0) if space else model
    result = concio.solve(model)
    found = result.reactions
    assert [float(found[name][-1]) for name in ("k1", "k2")] == pytest.approx(levers(*places), rel=1e-6)
    assert result.certificate.worst < 1e-9
    assert {c.kind for c in result.assembly.detection.point_contacts} == {"edge-face" if space else "corner-face"}
    assert not result.assembly.detection.near_misses
    assert any("without area" in line for line in result.attention)


@pytest.mark.parametrize("space", [False, True])
def test_a_beam_whose_weight_lies_outside_its_knives_falls(space: bool) -> None:
    for second, falls in ((2.2499, True), (2.2501, False)):
        model = beam_on_knives(1.0, second, push=0.0)
        model = concio.extrude(model, 1.0) if space else model
        result = concio.solve(model, on_failure="return")
        assert (result.status is concio.Status.NO_EQUILIBRIUM) == falls
        assert result.solved != falls


def test_every_analysis_of_a_beam_on_knives_finds_that_it_slides_at_the_friction_of_its_weight() -> None:
    """0.6 x 27 kN against 2.7 kN: multiplier 6."""
    model = beam_on_knives()
    bound = concio.limit(model, path=False, steps=False, search=False).associated
    assert bound.multiplier == pytest.approx(6.0, rel=1e-6)
    assert concio.friction_margin(model).factor == pytest.approx(1 / 6, rel=1e-6)
    carried = concio.run_path(model, [Stage("weight", {"dead": 1.0}), Stage("push", {"live": 5.9})])
    assert carried.steps[-1].factors["live"] == pytest.approx(5.9)
    over = concio.run_path(model, [Stage("weight", {"dead": 1.0}), Stage("push", {"live": 6.1})])
    assert over.steps[-1].factors["live"] == pytest.approx(6.0, rel=1e-6)
    assert concio.push(model, until=0.01).peak == pytest.approx(6.0, rel=1e-3)


def test_a_beam_on_knives_rests_in_a_motion() -> None:
    found = concio.dynamics(beam_on_knives(push=0.0), duration=0.1)
    assert float(np.abs(found.shots.centre - found.shots.centre[0]).max()) < 1e-9


@pytest.mark.parametrize("space", [False, True])
def test_a_beam_on_a_bearing_and_a_knife_edge_stands(space: bool) -> None:
    """What it presses on the knife lies between its levers about the two ends of the bearing."""
    bearing = Body("s", [(-0.5, 0), (0.2, 0), (0.2, 1), (-0.5, 1)], kind="fixed")
    beam = Body("beam", [(0, 1), (4.5, 1), (4.5, 1.3), (0, 1.3)], kind="rigid")
    model = Model((bearing, knife("k", 4.0), beam), STONE, LAW, loads=DOWN2)
    result = concio.solve(concio.extrude(model, 0.7) if space else model)
    width = 0.7 if space else 1.0
    assert width * levers(0.2, 4.0)[1] <= result.reactions["k"][-1] <= width * levers(0.0, 4.0)[1]


def spike(name: str, x: float, y: float) -> Polyhedron:
    foot = [(x + i, y + j, 0.0) for i, j in ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))]
    sides = [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    return Polyhedron(name, [*foot, (x, y, 1.0)], sides, kind="fixed")


def tripod(places: np.ndarray) -> Model:
    """A slab of 2 x 2 x 0.2 m, 16 kN, on three corners."""
    slab = Polyhedron.box("slab", (0, 0, 1), (2, 2, 1.2), kind="rigid")
    return Model((*(spike(f"p{k}", *p) for k, p in enumerate(places)), slab), STONE, LAW, loads=DOWN3)


@pytest.mark.parametrize("seed", range(sample(4, 10, 25)))
def test_a_slab_on_three_corners_has_the_reactions_of_three_equations(seed: int) -> None:
    places = np.random.default_rng(seed).uniform(0.1, 1.9, (3, 2))
    forces = np.linalg.solve(np.vstack([np.ones(3), places.T]), 16.0 * np.array([1.0, 1.0, 1.0]))
    result = concio.solve(tripod(places), on_failure="return")
    assert result.solved == bool((forces >= 0).all())
    if result.solved:
        assert [result.reactions[f"p{k}"][2] for k in range(3)] == pytest.approx(forces, rel=1e-6)
        assert {c.kind for c in result.assembly.detection.point_contacts} == {"corner-face"}
    else:
        assert result.status is concio.Status.NO_EQUILIBRIUM


def test_the_top_of_a_pyramid_of_spheres_presses_along_the_lines_of_centres() -> None:
    """Polyhedra for the spheres: corners on faces square to these lines, which rise at acos sqrt(2/3); no friction."""
    ways = np.array([
        [np.cos(a) * np.sqrt(1 / 3), np.sin(a) * np.sqrt(1 / 3), -np.sqrt(2 / 3)] for a in np.deg2rad([0, 120, 240])
    ])  # fmt: skip
    points = np.vstack([ways, [0, 0, 1], 0.5 * ways[:, :2] @ [[1, 0, 0], [0, 1, 0]]])
    hull = ConvexHull(points)
    faces = [tuple((s if np.linalg.det(points[s]) > 0 else s[::-1]).tolist()) for s in hull.simplices]
    top = Polyhedron("top", points, faces, kind="rigid")
    below = []
    for k, way in enumerate(ways):
        across = np.linalg.svd(way[None])[2][1:]
        corners = [
            way * (1 + z) + 0.4 * (x * across[0] + y * across[1]) for z in (0, 0.5) for y in (-1, 1) for x in (-1, 1)
        ]
        box = ConvexHull(corners)
        middle = np.mean(corners, axis=0)
        sides = [s if np.linalg.det(np.array(corners)[s] - middle) > 0 else s[::-1] for s in box.simplices]
        below.append(Polyhedron(f"b{k}", corners, [tuple(s.tolist()) for s in sides], kind="fixed"))
    model = Model((*below, top), STONE, {"joint": JointLaw(friction=0.0)}, loads=DOWN3)
    result = concio.solve(model)
    expected = 20.0 * top.volume / (3 * np.sqrt(2 / 3))
    assert len(result.contacts) == 3
    assert result.contacts.normal_force == pytest.approx([expected] * 3, rel=1e-6)
    assert result.contacts.pairs.normal == pytest.approx(-ways, abs=1e-9)


ROOF = [(-0.2, -1, -0.5), (0.2, -1, -0.5), (0, -1, 0), (-0.2, 1, -0.5), (0.2, 1, -0.5), (0, 1, 0)]
SIDES = [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)]


def test_edges_that_cross_carry_at_their_crossing() -> None:
    """A cross of two beams with edges below, on four ridges: the corners of the middle, in pairs along each beam."""
    places = [np.array(ROOF) + np.array([x, 0, 0]) for x in (-1.0, 1.5)]
    ridges = [Polyhedron(f"r{k}", place, SIDES, kind="fixed") for k, place in enumerate(places)]
    keel = np.array(ROOF)[:, [1, 0, 2]] * [2, 1, -1]
    model = Model((*ridges, Polyhedron("keel", keel, SIDES, kind="rigid")), STONE, LAW, loads=DOWN3)
    result = concio.solve(model)
    assert [c.kind for c in result.assembly.detection.point_contacts] == ["edge-edge"] * 2
    weight = 20.0 * result.model.bodies[2].volume
    assert [result.reactions[f"r{k}"][2] for k in range(2)] == pytest.approx([0.6 * weight, 0.4 * weight], rel=1e-6)


def test_a_corner_on_a_corner_is_told_and_carries_along_the_middle_direction() -> None:
    """A block that stands with one corner on a tip, both alike, and with a face on a pier: the normal is upright."""
    tip = Body("tip", [(1.8, 0), (2.2, 0), (2, 1)], kind="fixed")
    pier = Body("pier", [(-0.3, 0), (0.3, 0), (0.3, 1), (-0.3, 1)], kind="fixed")
    outline = [(0, 1.0), (0.2, 1.0), (1.0, 1.8), (1.8, 1.8), (2, 1), (2.2, 1.8), (2.2, 2), (0, 2)]
    stone = Body("stone", outline, kind="rigid")
    model = Model((tip, pier, stone), STONE, LAW, loads=DOWN2)
    found = detect(model)
    (corner,) = found.point_contacts
    assert corner.kind == "corner-corner"
    assert corner.ambiguous
    assert corner.normal[1] > 0.9
    assert any("the normal is the middle of the directions" in line for line in attention_of(model, found))
    assert concio.solve(model).certificate.worst < 1e-9


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("seed", range(sample(3, 8, 20)))
def test_order_mirror_units_and_bodies_far_away_change_nothing(seed: int, space: bool) -> None:
    rng = np.random.default_rng(seed)
    places = np.array([(0.2, 0.2), (1.7, 0.3), (0.6, 1.5)])
    model = tripod(places) if space else beam_on_knives(push=0.05)
    first = concio.solve(model).reactions
    order = rng.permutation(len(model.bodies))
    mixed = concio.solve(replace(model, bodies=tuple(model.bodies[k] for k in order))).reactions
    for name, force in first.items():
        assert mixed[name] == pytest.approx(force, rel=1e-6, abs=1e-9)
    mirrored = concio.solve(concio.place(model, mirror="x")).reactions
    for name, force in first.items():
        assert np.abs(mirrored[name]) == pytest.approx(np.abs(force), rel=1e-6, abs=1e-9)
    size = 10.0 ** rng.uniform(-3, 3)
    scaled = concio.solve(_scaled(model, size)).reactions
    power = 3 if space else 2
    for name, force in first.items():
        assert np.array(scaled[name]) / size**power == pytest.approx(force, rel=1e-6, abs=1e-9)
    if space:
        far = (Polyhedron.box("ground", (50, 0, 0), (51, 1, 1), kind="fixed"),
               Polyhedron.box("stone", (50, 0, 1), (51, 1, 2), kind="rigid"))  # fmt: skip
    else:
        far = (Body("ground", [(50, 0), (51, 0), (51, 1), (50, 1)], kind="fixed"),
               Body("stone", [(50, 1), (51, 1), (51, 2), (50, 2)], kind="rigid"))  # fmt: skip
    more = concio.solve(replace(model, bodies=(*model.bodies, *far))).reactions
    for name, force in first.items():
        assert more[name] == pytest.approx(force, rel=1e-12, abs=1e-12)


def _scaled(model: Model, size: float) -> Model:
    bodies = tuple(
        replace(b, vertices=size * np.asarray(b.vertices)) if isinstance(b, Polyhedron)
        else replace(b, outline=size * np.asarray(b.outline))
        for b in model.bodies
    )  # fmt: skip
    return replace(model, bodies=bodies)


def test_contacts_without_area_have_friction_alone_and_that_is_told() -> None:
    model = beam_on_knives(push=0.0)
    stiff = {"normal_stiffness": 1e6, "tangential_stiffness": 1e6}
    glued = JointLaw(friction=0.6, cohesion=100.0, tensile_strength=50.0, **stiff)
    result = concio.solve(replace(model, laws={"joint": glued}))
    laws = result.assembly.laws
    assert not laws.cohesion.any()
    assert not laws.tension.any()
    assert np.isinf(laws.cap).all()
    assert any("stiffness of 'joint' do not act there" in line for line in result.attention)
    pushed = replace(beam_on_knives(), laws={"joint": glued})
    bound = concio.limit(pushed, path=False, steps=False, search=False).associated
    assert bound.multiplier == pytest.approx(6.0, rel=1e-6)
    assert np.isnan(result.contacts.pressure).all()


def test_a_law_that_crushes_is_refused_at_a_corner_with_the_reason() -> None:
    law = {"joint": JointLaw(friction=0.6, compressive_strength=3000.0)}
    found = detect(replace(beam_on_knives(), laws=law))
    assert not found.interfaces
    assert [m.kind for m in found.not_made] == ["corner"] * 2
    assert all("has a compressive strength, and a corner or an edge has no area" in m.sentence for m in found.not_made)


@pytest.mark.long
@pytest.mark.parametrize("space", [False, True])
@pytest.mark.usefixtures("blank_figures")
def test_results_with_contacts_at_corners_are_written_and_read(space: bool, tmp_path) -> None:
    model = beam_on_knives()
    result = concio.solve(concio.extrude(model, 1.0) if space else model)
    write_result(result, tmp_path / "out")
    again = load_result(tmp_path / "out")
    assert again.contacts.normal_force == pytest.approx(result.contacts.normal_force)
    assert [c.kind for c in again.assembly.detection.point_contacts] == [
        c.kind for c in result.assembly.detection.point_contacts
    ]
    table = result.tables.joints()
    assert sum(table["normal_force"]) == pytest.approx(27.0)
    assert not (table["area"] if space else table["length"]).any()


def test_corners_that_stand_apart_by_a_little_close_under_load() -> None:
    """One of three spikes is 0.2 mm low: the slab leans until it finds it."""
    places = np.array([(0.2, 0.2), (1.7, 0.3), (0.9, 1.7)])
    model = tripod(places)
    low = replace(model.bodies[2], vertices=np.asarray(model.bodies[2].vertices) - [0, 0, 2e-4])
    smooth = {"joint": JointLaw(friction=0.0)}
    result = concio.solve(replace(model, bodies=(*model.bodies[:2], low, model.bodies[3]), laws=smooth))
    gaps = [float(c.gap[0]) for c in result.assembly.detection.point_contacts]
    assert gaps == pytest.approx([0, 0, 2e-4], abs=1e-12)
    forces = np.linalg.solve(np.vstack([np.ones(3), places.T]), 16.0 * np.array([1.0, 1.0, 1.0]))
    assert [result.reactions[f"p{k}"][2] for k in range(3)] == pytest.approx(forces, rel=1e-6)
    assert -float(result.node_displacement("slab")[:, 2].min()) > 2e-4


def test_a_contact_at_a_corner_is_a_hinge_of_the_line_of_thrust() -> None:
    result = concio.solve(beam_on_knives(push=0.0))
    found = hinges(result)
    assert sorted(h.at for h in found) == [(1.0, 1.0), (4.0, 1.0)]
    assert [h.bodies for h in found] == [("k1", "beam"), ("k2", "beam")]
    line = concio.thrust_line(result)
    assert line.point[:, 0] == pytest.approx([1.0, 4.0])


@pytest.mark.parametrize("scale", [2.0**-6, 1.0, 2.0**8])
def test_faces_that_lie_on_each_other_are_no_contact_without_area(scale: float) -> None:
    """Of four pairs of boxes, one on another, edge on edge, corner on face and too far apart, two touch at a point."""
    square = scale * np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    turned = scale * 0.5**0.5 * np.array([(0, 0), (1, 1), (0, 2), (-1, 1)])
    places = [(0, 0), (0.25, 1), (5, 0), (6, 1), (12, 0), (11, 2)]
    bodies = [Body(f"b{k}", square + scale * np.array(at)) for k, at in enumerate(places)]
    bodies.append(Body("t", turned + scale * np.array((0.6, 2.0))))
    asked = {(0, 1), (2, 3), (1, 6), (4, 5)}
    reach = np.full(len(bodies), 1e-3 * scale)
    found = _contacts(bodies, asked, reach, 1e-6 * scale)
    assert sorted(zip(found.body_a.tolist(), found.body_b.tolist(), strict=True)) == [(1, 6), (2, 3)]
    k = found.body_b.tolist().index(6)
    assert found.on_a[found.first[k]] == pytest.approx(scale * np.array((0.6, 2.0)), abs=1e-9 * scale)
    assert found.normal[k] == pytest.approx([0.0, 1.0], abs=1e-9)
