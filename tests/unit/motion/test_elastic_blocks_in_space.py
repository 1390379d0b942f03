"""Elastic blocks that move in space: closed forms, the plane extruded, turned scenes, and what is checked of them."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import concio
from concio.analysis.motion import step_pairs as pairs
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.stepper import Stepper
from concio.contact.moving_solids import BESIDE
from concio.contact.original_nodes import nodes_belong
from concio.contact.reference import Reference
from concio.contact.solid_search import SHIFT
from concio.contact.solid_sides import FacetSides
from motion_models import G
from samples import first, sample

E, WEIGHT = 1e5, 20.0
BAR = 1.0
BASE = ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.5, 0.5, 0.0), (0.0, 0.5, 0.0))


def model_of(*bodies, nu=0.2, modulus=E, friction=0.5, mesh=0.25, turn=None, **more):
    """Bodies under their weight, turned by a rotation matrix."""
    turn = np.eye(3) if turn is None else turn
    return concio.Model(
        tuple(replace(b, vertices=b.vertices @ turn.T) for b in bodies),
        {"block": concio.Elastic(E=modulus, nu=nu, unit_weight=WEIGHT), "stone": concio.Rigid(WEIGHT)},
        {"joint": concio.JointLaw(friction)}, mesh_size=mesh,
        loads=(concio.Load("weight", tuple((turn @ np.array([0.0, 0.0, -1.0])).tolist())),), **more,
    )  # fmt: skip


def box(name, low, high, kind="elastic"):
    return concio.Polyhedron.box(name, low, high, kind=kind, material="block" if kind == "elastic" else "stone")


FLOOR = concio.Polyhedron.box("floor", (-2.0, -2.0, -0.5), (2.0, 2.0, 0.0), kind="fixed")


def bar_error(elements):
    """Largest error of the end of a bar that is held at its foot and rings in its first mode, over its amplitude."""
    hold = concio.Support("foot", "bar", polygon=BASE)
    model = replace(
        model_of(box("bar", (0, 0, 0), (0.5, 0.5, BAR)), nu=0.0, mesh=BAR / elements, supports=(hold,)), loads=()
    )  # fmt: skip
    reference = Reference.of(model, G)
    height = reference.node_arm[:, 2] + 0.5 * BAR
    speed = np.zeros_like(reference.node_arm)
    speed[:, 2] = 1e-3 * np.sin(0.5 * np.pi * height / BAR)
    w = 0.5 * np.pi / BAR * np.sqrt(E * G / WEIGHT)  # a quarter of a wave of speed sqrt(E / rho) over the length
    h = 2.0 * np.pi / w / (16 * elements)
    found = concio.dynamics(
        model, duration=16 * elements * h, step=h, gravity=G, every=h, adaptive=False,
        start=replace(MotionState.at_rest(reference), nodal=speed),
    )  # fmt: skip
    assert found.certified
    assert found.energy.error < 1e-10
    end = np.argmax(height)
    place = found.shots.centre[:, 0, 2] + 0.5 * BAR - BAR
    end_moves = place + np.einsum("nij,nj->ni", found.shots.rotation[:, 0], found.shots.strain[:, end])[:, 2]
    exact = 1e-3 / w * np.sin(w * found.shots.time)
    return np.abs(end_moves - exact).max() * w / 1e-3


@pytest.mark.long
def test_a_bar_rings_as_the_closed_form_says_with_order_two():
    errors = [bar_error(n) for n in (2, 4, 8)]
    assert errors[0] < 0.2
    assert errors[1] < errors[0] / 3.5
    assert errors[2] < errors[1] / 3.5


def ringing(turn, steps):
    """A block in flight that spins and rings in its softest mode: what its steps lead to, and its energy balance."""
    model = replace(model_of(FLOOR, box("b", (0, 0, 3.0), (0.5, 0.4, 5.0)), mesh=0.5, turn=turn), loads=())
    reference = Reference.of(model, G)
    flat = Reference.of(replace(model_of(FLOOR, box("b", (0, 0, 3.0), (0.5, 0.4, 5.0)), mesh=0.5), loads=()), G)
    root = np.sqrt(flat.mass)
    squares, modes = np.linalg.eigh(flat.disc.shapes[0].K.toarray() / np.outer(root, root))
    mode = (modes[:, 6] / root).reshape(-1, 3)
    mode *= np.sign(mode[np.argmax(np.abs(mode[:, 0])), 0])
    period = 2.0 * np.pi / np.sqrt(squares[6])
    speed = np.cross([1.0, 2.0, 0.5], flat.node_arm) + 0.05 * mode / np.abs(mode).max()
    order = np.argmin(np.linalg.norm(reference.node_arm[:, None] @ turn - flat.node_arm[None], axis=2), axis=1)
    start = replace(MotionState.at_rest(reference), nodal=speed[order] @ turn.T)
    return concio.dynamics(model, duration=2.0 * period, step=2.0 * period / steps, start=start, gravity=G)


def test_a_spinning_block_that_rings_keeps_its_energy_and_turns_with_its_axes():
    turn = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
    plain, other = ringing(np.eye(3), 25), ringing(turn, 25)
    assert plain.energy["strain"].max() > 1e-4 * plain.energy["kinetic"].max()
    for found in (plain, other):
        assert found.certified
        assert found.energy.error < 1e-11
    assert other.end.spin @ turn == pytest.approx(plain.end.spin, abs=1e-10)
    assert other.end.rotation[1] == pytest.approx(turn @ plain.end.rotation[1] @ turn.T, abs=1e-10)
    momentum = [f.shots.centre[-1, 1] - f.shots.centre[0, 1] for f in (plain, other)]
    assert np.abs(momentum).max() < 1e-12  # it turns about its centroid


def landing(turn, steps=80):
    """A brick that falls on a floor askew: the centroid, strains and energies after steps."""
    model = model_of(FLOOR, box("b", (0, 0, 0.02), (0.5, 0.25, 0.32)), turn=turn)
    found = concio.dynamics(
        model, duration=steps * 1e-3, step=1e-3, start="as described", adaptive=False, every=1e-3,
        velocities={"b": tuple((turn @ np.array([0.5, 0.3, -0.4])).tolist())},
    )  # fmt: skip
    assert found.certified
    assert found.energy["impact"][-1] > 0.0
    assert found.energy["friction"][-1] > 0.0
    assert found.energy.error < 1e-10
    return found


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 3)))
def test_a_brick_that_falls_on_a_floor_turned_with_its_gravity_falls_as_before(seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    plain, other = landing(np.eye(3)), landing(turn)
    assert np.abs(plain.end.strain).max() > 1e-6
    assert other.end.centre[1] @ turn == pytest.approx(plain.end.centre[1], abs=1e-10)
    assert other.end.rotation[1] == pytest.approx(turn @ plain.end.rotation[1] @ turn.T, abs=1e-10)
    assert np.linalg.norm(other.end.strain, axis=1).max() == pytest.approx(
        np.linalg.norm(plain.end.strain, axis=1).max(), abs=1e-10
    )


def test_a_brick_that_falls_in_the_plane_keeps_its_energy_balance():
    floor = concio.Body("floor", [(-2, -0.5), (2, -0.5), (2, 0), (-2, 0)], kind="fixed")
    model = concio.Model(
        (floor, concio.Body("b", [(0, 0.02), (0.5, 0.02), (0.5, 0.32), (0, 0.32)], kind="elastic")),
        {"block": concio.Elastic(E=E, nu=0.2, unit_weight=WEIGHT)}, {"joint": concio.JointLaw(0.5)},
        loads=(concio.Load("weight", (0, -1)),), mesh_size=0.25,
    )  # fmt: skip
    found = concio.dynamics(
        model, duration=0.08, step=1e-3, start="as described", velocities={"b": (0.5, -0.4, 1.0)}
    )
    assert found.certified
    assert found.energy["impact"][-1] > 0.0
    assert found.energy.error < 1e-10


@pytest.mark.long
def test_an_extruded_block_without_lateral_strain_moves_as_in_the_plane(monkeypatch):
    """Of the same total compliance of their joints: two nodes side by side in space stand for one of the plane."""
    floor = concio.Body("floor", [(-2, -0.5), (2, -0.5), (2, 0), (-2, 0)], kind="fixed", thickness=0.25)
    block = concio.Body("b", [(0, 0), (0.25, 0), (0.25, 1), (0, 1)], kind="elastic", thickness=0.25)
    plane = concio.Model(
        (floor, block), {"block": concio.Elastic(E=E, nu=0.0, unit_weight=WEIGHT)}, {"joint": concio.JointLaw(0.5)},
        loads=(concio.Load("weight", (0, -1)),), mesh_size=0.25,
    )  # fmt: skip
    found = []
    for model, share in ((plane, 1.0), (concio.extrude(plane), 2.0)):
        monkeypatch.setattr(pairs, "yielding", lambda _, share=share: np.array([0.0, share * 1e-8]))
        found.append(concio.dynamics(model, concio.Pulse("sine", 4.0, 0.5), duration=0.3, step=2e-3, adaptive=False))
    flat, deep = found
    assert len(deep.shots.strain[0]) == 2 * len(flat.shots.strain[0])
    assert np.abs(flat.shots.rotation[:, 1]).max() > np.deg2rad(0.1)
    assert deep.shots.centre[:, 1][:, [0, 2]] == pytest.approx(flat.shots.centre[:, 1], abs=1e-10)
    assert deep.rotation("b")[:, 1] == pytest.approx(-flat.rotation("b"), abs=1e-10)


def test_an_elastic_block_at_rest_is_compressed_as_by_hand_and_stays():
    """Its top sinks by gamma h^2 / (2 E) without lateral strain, and its floor carries its weight."""
    model = model_of(FLOOR, box("b", (0, 0, 0), (0.5, 0.25, 1.0)), nu=0.0)
    top = concio.ControlPoint("b", at=(0.25, 0.0, 1.0), direction=(0, 0, 1))
    found = concio.dynamics(model, duration=0.1, step=2e-3, points=(top,))
    assert found.energy.still
    assert found.point()[-1] == pytest.approx(-WEIGHT * 1.0**2 / (2 * E), rel=0.01)
    assert found.steps.reaction[-1, 0] == pytest.approx([0.0, 0.0, WEIGHT * 0.125], abs=1e-6)


@pytest.mark.parametrize(
    ("lower", "upper"), first(1, [("rigid", "elastic"), ("elastic", "elastic"), ("elastic", "rigid")])
)
def test_blocks_with_meshes_that_do_not_fit_stand_on_each_other(lower, upper):
    model = model_of(
        FLOOR, box("a", (0, 0, 0), (0.5, 0.25, 0.25), lower), box("b", (0.1, 0.05, 0.25), (0.45, 0.35, 0.5), upper)
    )
    found = concio.dynamics(model, concio.Pulse("sine", 2.0, 0.1), duration=0.06, step=2e-3)
    assert found.certified
    assert found.energy.error < 1e-9
    assert found.steps.depth.max() < 1e-5
    weight = WEIGHT * (0.5 * 0.25 * 0.25 + 0.35 * 0.3 * 0.25)
    assert found.steps.reaction[:, 0, 2].mean() == pytest.approx(weight, rel=0.05)


@pytest.mark.long
def test_an_elastic_block_slides_until_friction_has_taken_its_speed():
    """By v^2 / (2 mu g), over a slab that is elastic itself, whose facets it passes."""
    slab = box("slab", (-0.4, -0.4, 0.0), (1.2, 0.8, 0.2))
    model = model_of(FLOOR, slab, box("b", (0, 0, 0.2), (0.3, 0.3, 0.4)), mesh=0.4, modulus=1e6)
    found = concio.dynamics(model, duration=0.25, step=2.5e-3, velocities={"b": (1.0, 0.0, 0.0)})
    assert found.certified
    assert found.end.centre[2, 0] - 0.15 == pytest.approx(1.0 / (2 * 0.5 * 9.81), rel=0.03)


@pytest.mark.long
def test_an_elastic_block_that_slides_into_another_one_takes_it_along():
    """Edges meet where neither end has a node, and both structures become one."""
    model = model_of(FLOOR, box("a", (0, 0, 0), (0.4, 0.4, 0.3)), box("b", (1.0, 0.05, 0), (1.4, 0.35, 0.3)))
    found = concio.dynamics(model, duration=0.45, step=2e-3, velocities={"b": (-2.5, 0.0, 0.0)})
    assert found.ending.name == "COMPLETE"
    assert found.certified
    assert found.energy.error < 1e-10
    assert found.end.centre[1, 0] < 0.2 - 1e-4
    assert found.end.centre[2, 0] - found.end.centre[1, 0] > 0.4 - 1e-3


@pytest.mark.parametrize("seed", range(3))
def test_wrong_nodes_of_a_contact_are_found_by_the_certificate(seed):
    model = model_of(FLOOR, box("a", (0, 0, 0), (0.5, 0.25, 0.25)), box("b", (0.1, 0.05, 0.25), (0.4, 0.2, 0.5)))
    stepper = Stepper(Reference.of(model, G), Scheme())
    still = Drive(np.zeros(3), np.zeros(3), {})
    state, _ = stepper.step(stepper.located(MotionState.at_rest(stepper.reference)), 1e-3, still)
    _, report = stepper.step(state, 1e-3, still)
    assert report.solution.residual < 1e-9
    layout, rng = stepper.maker.search.layout, np.random.default_rng(seed)
    side = layout.slots.side_b
    loaded = np.flatnonzero((report.solution.t[: report.pairs, 0] > 1e-6) & (side.weight[:, 0] > 0))
    node = side.node.copy()
    node[rng.choice(loaded), 0] += 1
    changed = replace(layout.slots, side_b=replace(side, node=node))
    stepper.maker.search.layout = replace(layout, slots=changed)
    stepper.certificate.original._named = None
    _, report = stepper.step(state, 1e-3, still)
    assert report.solution.residual > 1e-6


@pytest.mark.parametrize(("share", "within"), [(0.0, True), (1.8, True), (2.2, False), (-2.2, False)])
@pytest.mark.parametrize("scale", [1.0, 64.0])
def test_nodes_belong_to_a_point_up_to_what_it_may_slide_before_they_are_sought_again(share, within, scale):
    a, b = ((0, 0, 0), (0.5, 0.25, 0.25)), ((0.1, 0.05, 0.25), (0.4, 0.2, 0.5))
    bodies = [box(name, *(tuple(scale * v for v in corner) for corner in at)) for name, at in (("a", a), ("b", b))]
    floor = concio.Polyhedron.box("floor", (-scale,) * 3, (scale, scale, 0.0), kind="fixed")
    stepper = Stepper(Reference.of(model_of(floor, *bodies, mesh=0.1 * scale), G), Scheme())
    state = stepper.located(MotionState.at_rest(stepper.reference))
    reference, slots = stepper.reference, stepper.maker.search.layout.slots
    side, arm = slots.side_b, np.vstack([reference.node_arm, np.zeros((1, 3))])
    mean = (side.weight[:, :, None] * arm[side.node]).sum(axis=1)
    spacing = reference.solids.spacing[slots.body_b]
    point = state.centre[slots.body_b] + mean
    elastic = np.isfinite(spacing)
    point[elastic] += share * (SHIFT + BESIDE) * spacing[elastic, None] * np.array([0.6, 0.8, 0.0])
    belong = nodes_belong(reference, slots, point, np.zeros(len(slots)), state.centre, state.rotation)
    assert elastic.sum() > 4
    assert (belong[elastic] == within).all()


@lru_cache
def turned_block(seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    return Reference.of(model_of(FLOOR, box("b", (0, 0, 0), (0.5, 0.25, 1.0)), turn=turn, mesh=0.2), G)


@given(x=st.floats(0.0, 1.0), y=st.floats(0.0, 1.0), seed=st.integers(0, 5))
def test_points_of_a_face_have_the_nodes_around_them(x, y, seed):
    """Their weights are a mean, and that of the nodes is the point itself; beside the face, its nearest point."""
    reference = turned_block(seed)
    solids = reference.solids
    sides = FacetSides(reference.disc, solids, reference.first_node, len(reference.body_of_node))
    for face in np.flatnonzero(solids.face_body == 1).tolist():
        ring, tangent = solids.start[solids.rings[face]], solids.tangent[face]
        place = ring[0] + x * (ring[1] - ring[0]) + y * (ring[3] - ring[0])
        ways = np.stack([tangent, np.cross(solids.normal[face], tangent)])
        away = ways @ (place - solids.start[solids.face_start[face]])
        out = ways @ (ring[0] - ring[1])
        for beside in (0.0, 0.3) if x == 0.0 else (0.0,):
            node, weight = sides._weights(face, (away + beside * out)[None])
            assert weight.sum() == pytest.approx(1.0, abs=1e-12)
            assert weight.min() > -1e-12
            assert weight[0] @ reference.node_arm[node[0]] == pytest.approx(place, abs=1e-12)


@pytest.mark.long
def test_an_elastic_pillar_in_space_is_pushed_as_the_rigid_one_where_it_is_stiff():
    found = []
    for kind in ("elastic", "rigid"):
        model = model_of(FLOOR, box("p", (0, 0, 0), (0.2, 0.25, 1.0), kind), friction=0.7, modulus=1e7)
        found.append(concio.push(model, direction=(1, 0)))
    assert found[0].peak == pytest.approx(found[1].peak, rel=2e-3)
    assert found[0].capacity == pytest.approx(found[1].capacity, rel=2e-3)


@pytest.mark.parametrize("law", [{"cohesion": 10.0}, {"normal_stiffness": 1e6, "tangential_stiffness": 4e5}])
def test_joints_with_areas_of_elastic_blocks_in_space_are_refused_in_a_sentence(law):
    model = model_of(FLOOR, box("b", (0, 0, 0), (0.5, 0.25, 1.0)))
    with pytest.raises(concio.InputError, match="elastic blocks that move have friction alone"):
        concio.dynamics(replace(model, laws={"joint": concio.JointLaw(0.5, **law)}), duration=0.1)
