"""Joints with stiffness and strength under rigid blocks that move in space: hand formulas, and the plane extruded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

import concio
from concio.analysis.motion.certified import Returned
from concio.analysis.motion.scheme import Drive
from concio.analysis.motion.structures import structures_of
from concio.contact.reference import Reference
from concio.model.interfaces.detect import SLIVER_SHARE
from models import box, model_of, weight
from motion_models import G, standing
from samples import first, sample
from space_motions import STILL, blocks, extruded, stepper_of

A, B, H = 0.3, 0.2, 0.5
"""Half sides and half height of the block [m]."""
SOFT = concio.JointLaw(0.8, normal_stiffness=2e4, tangential_stiffness=8e3, cohesion=1e4, tensile_strength=1e3)
TURN = Rotation.from_rotvec([0.3, 0.5, -0.8]).as_matrix()
AREA = 4 * A * B
MASS = 20.0 * AREA * 2 * H / G


def on_springs(turn=None, law=SOFT):
    return replace(blocks(((-A, -B, 0.0), (A, B, 2 * H)), turn=turn), laws={"joint": law})


def period(time, value):
    """Mean period of an oscillation by its zeros [s]."""
    k = np.flatnonzero(value[:-1] * value[1:] < 0)
    zeros = time[k] + (time[k + 1] - time[k]) * value[k] / (value[k] - value[k + 1])
    return 2 * np.diff(zeros).mean()


def modes():
    """Circular frequencies on the joint, and the velocities (6,) of their motions, by stiffness integrated over it."""
    k_n, k_t = 2e4, 8e3
    about_x, about_y = 4 * A * B**3 / 3, 4 * A**3 * B / 3
    sway = {0: about_y, 1: about_x}  # along x the block rocks about y
    bob = (np.sqrt(k_n * AREA / MASS), np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    twist_inertia = MASS * (A**2 + B**2) / 3
    twist = (np.sqrt(k_t * (about_x + about_y) / twist_inertia), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]))
    found = {"bob": bob, "twist": twist}
    for axis, second in sway.items():
        half = (A, B)[axis]
        inertia = MASS * (half**2 + H**2) / 3
        shear, turned = k_t * AREA, 20.0 * AREA * 2 * H * H
        K = np.array([[shear, -shear * H], [-shear * H, shear * H**2 + k_n * second - turned]])
        values, vectors = eigh(K, np.diag([MASS, inertia]))
        motion = np.zeros(6)
        motion[axis], motion[4 - axis] = vectors[0, 0], vectors[1, 0] * (1 if axis == 0 else -1)
        found[f"rock along {'xy'[axis]}"] = (np.sqrt(values[0]), motion / np.abs(motion).max())
    return found


@pytest.mark.long
@pytest.mark.parametrize("name", ["twist", "rock along x", "bob", "rock along y"][: sample(2, 4)])
def test_a_block_on_an_elastic_joint_oscillates_as_its_stiffness_over_the_face_says(name):
    """Trapezium rule: the period is longer by (omega h)^2 / 12, and no more."""
    omega, motion = modes()[name]
    whole = 2 * np.pi / omega
    begun = 1e-2 * motion
    found = concio.dynamics(
        on_springs(), duration=2.2 * whole, step=whole / 80, every=whole / 80, gravity=G, velocities={"b0": begun},
        adaptive=False,
    )  # fmt: skip
    place = found.shots.centre[:, 1] - found.shots.centre[0, 1]
    turned = np.array([Rotation.from_matrix(r).as_rotvec() for r in found.shots.rotation[:, 1]])
    value = np.hstack([place, turned])[:, np.argmax(np.abs(motion))]
    assert found.certified
    assert found.energy.error < 1e-8
    longer = 1.0 + (2 * np.pi / 80) ** 2 / 12
    assert period(found.shots.time, value) == pytest.approx(longer * whole, rel=5e-4)


def moved_alike(model, depth, steps, ground, error=1e-10, **options):
    """Step a plane model and its extruded and turned twin together, to the same places."""
    flat, state = stepper_of(model)
    solid, other = stepper_of(replace(extruded(model, depth, TURN), **options))
    assert solid.maker.width == pytest.approx(flat.maker.width, rel=1e-12)
    in_space = TURN @ np.array([ground[0], 0.0, ground[1]])
    for _ in range(steps):
        state, one = flat.step(state, 1e-3, Drive(np.array(ground), np.zeros(2), {}))
        other, two = solid.step(other, 1e-3, Drive(in_space, np.zeros(3), {}))
        assert max(one.solution.residual, two.solution.residual) < 1e-9
        for work in ("friction", "crushing", "overlap"):
            assert two.works[work] == pytest.approx(one.works[work], abs=error)
        assert (TURN.T @ other.centre[1])[[0, 2]] == pytest.approx(state.centre[1], abs=error)
    vector = TURN.T @ Rotation.from_matrix(other.rotation[1]).as_rotvec()
    assert vector == pytest.approx([0.0, -state.rotation[1], 0.0], abs=error)
    return state, other, flat, solid


def plane(law, width=0.4, height=1.2):
    depth = 2.0 * width * height / (width + height)  # of the same mean width
    model = standing(width=width, height=height, friction=law)
    return replace(model, bodies=tuple(replace(b, thickness=depth) for b in model.bodies)), depth


def test_a_block_on_a_closed_elastic_joint_extruded_and_turned_is_that_of_the_plane():
    model, depth = plane(concio.JointLaw(1.0, normal_stiffness=2e4, tangential_stiffness=8e3))
    state, *_ = moved_alike(model, depth, 40, (0.5, 0.2))
    assert abs(state.rotation[1]) > 1e-6


@pytest.mark.parametrize("strength", first(1, [60.0, 1e6]))
def test_a_joint_that_opens_and_crushes_extruded_and_turned_is_that_of_the_plane(strength):
    """Twenty graded points in the plane, and as many in each direction in space."""
    law = concio.JointLaw(1.0, normal_stiffness=2e4, tangential_stiffness=8e3, compressive_strength=strength)
    model, depth = plane(law)
    _, other, _, solid = moved_alike(model, depth, 45, (12.0, 0.0), contact_points=20)
    own = solid.maker.slots.face >= 0
    assert (other.memory.force[own, 0] == 0).any()  # it has opened
    assert (other.memory.crushing > 0).any() == (strength < 100)


@pytest.mark.parametrize("law", first(1, [
        concio.JointLaw(0.6, normal_stiffness=1e5, tangential_stiffness=4e4, cohesion=30.0, tensile_strength=30.0),
        concio.JointLaw(0.6, cohesion=30.0, tensile_strength=30.0),
    ]))  # fmt: skip
@pytest.mark.parametrize("share", [0.9, 1.1])
@pytest.mark.parametrize("space", [False, True])
def test_a_bonded_block_hangs_until_its_strength_is_passed(law, share, space):
    deep = share * 30.0 / 20.0
    if space:
        model = blocks(((-A, -B, -deep), (A, B, 0.0)), floor=((-2.0, -2.0, 0.0), (2.0, 2.0, 0.5)))
        model = replace(model, laws={"joint": law})
    else:
        outline = [(-A, -deep), (A, -deep), (A, 0.0), (-A, 0.0)]
        block = concio.Body("b0", outline, kind="rigid", material="stone", thickness=2 * B)
        ceiling = replace(box("floor", -2.0, 2.0, 0.0, 0.5, kind="fixed"), thickness=2 * B)
        model = model_of(ceiling, block, law=law, loads=(weight(),))
    found = concio.dynamics(model, duration=0.1, gravity=G)
    fallen = found.shots.centre[0, 1, -1] - found.shots.centre[-1, 1, -1]
    assert found.certified
    if share < 1:
        assert fallen < 1e-6
        assert found.end.memory.force[:, 0].sum() == pytest.approx(-20.0 * AREA * deep, rel=1e-6)
    else:
        assert fallen > 0.2 * 0.5 * G * 0.1**2
        assert not found.end.memory.force.any()


def test_a_bonded_block_is_pushed_over_at_the_sum_of_weight_and_bond():
    """Corners of the joint carry a quarter of the tensile strength each; both far ones hold until they break."""
    tension, weight = 5.0, 20.0 * AREA * 2 * H
    law = concio.JointLaw(2.0, cohesion=1e3, tensile_strength=tension)
    found = concio.push(on_springs(law=law), direction=(1, 0), until=0.05)
    assert found.certified
    assert found.peak == pytest.approx((weight * A + 0.5 * tension * AREA * 2 * A) / (weight * H), rel=1e-3)
    turned = np.linalg.norm(found.rotation_of("b0"), axis=1)
    late = turned > 1e-3  # broken: a dry block
    assert late.any()
    assert found.multiplier[late] == pytest.approx(np.tan(np.arctan(A / H) - turned[late]), rel=1e-3)


def test_a_block_on_springs_turned_with_its_gravity_is_turned():
    ground = np.array([5.0, 3.0, 0.0])
    found = []
    for turn in (np.eye(3), TURN):
        stepper, state = stepper_of(on_springs(turn))
        for _ in range(40):
            state, report = stepper.step(state, 1e-3, Drive(turn @ ground, np.zeros(3), {}))
            assert report.solution.residual < 1e-9
        found.append((state.centre[1] @ turn, turn.T @ state.rotation[1] @ turn))
    assert found[1][0] == pytest.approx(found[0][0], abs=1e-11)
    assert found[1][1] == pytest.approx(found[0][1], abs=1e-11)


@pytest.mark.parametrize("seed", range(sample(2, 4, 8)))
def test_the_area_of_a_joint_is_what_both_faces_have_in_common(seed):
    """Of faces that slide over each other; every point lies on both of them."""
    rng = np.random.default_rng(seed)
    low, high = ((-0.5, -0.4, 0.0), (0.5, 0.4, 0.2)), ((-0.3, -0.4, 0.2), (0.7, 0.4, 0.4))
    model = replace(blocks(low, high), laws={"joint": SOFT})
    reference = Reference.of(model, G)
    solids, slip = reference.solids, rng.uniform(-0.25, 0.25, 2)
    k = int(np.flatnonzero((solids.joints.body == [1, 2]).all(axis=1))[0])
    rest = reference.at_rest().placement
    centre = rest.centre.copy()
    centre[2, :2] += slip
    point, frame, gap, stands, share = solids.joints.touch(solids, solids.placed(replace(rest, centre=centre)))
    sides = np.array([min(0.5, 0.7 + slip[0]) - max(-0.5, -0.3 + slip[0]), 0.8 - abs(slip[1])])
    assert stands[k]
    assert share[k] * 0.8 * 0.8 == pytest.approx(sides.prod(), rel=1e-12)
    own = solids.joints.of == k
    assert (np.abs(point[own, :2]) <= [0.5 + 1e-12, 0.4 + 1e-12]).all()
    assert (np.abs(point[own, :2] - slip - [0.2, 0.0]) <= [0.5 + 1e-12, 0.4 + 1e-12]).all()
    assert np.ptp(point[own, :2], axis=0) == pytest.approx(sides, rel=1e-12)
    assert np.abs(gap[own]).max() < 1e-15
    assert frame[own, 0] == pytest.approx(np.tile([0.0, 0.0, 1.0], (own.sum(), 1)))


@pytest.mark.long
def test_a_block_that_slides_over_an_edge_tips_when_its_centroid_has_passed_it():
    law = concio.JointLaw(0.0, normal_stiffness=1e6)
    model = replace(blocks(((-0.5, -0.3, 0.0), (0.5, 0.3, 0.3)), ((-0.5, -0.3, 0.3), (0.5, 0.3, 0.6))),
                    laws={"joint": law, "glue": concio.JointLaw(2.0)},
                    rules=(concio.JointRule("glue", ("floor", "b0")), concio.JointRule("joint")))  # fmt: skip
    found = concio.dynamics(model, duration=0.35, gravity=G, velocities={"b1": (2.0, 0.0, 0.0)}, every=0.01)
    far, turned = found.shots.centre[:, 2, 0], found.rotation("b1")[:, 1]
    assert found.certified
    assert turned[far < 0.45].max() < 1e-3
    fall = G * (far[-1] - 0.5) ** 3 / (6 * 2.0**2 * ((1.0 + 0.09) / 12 + 0.0225))  # of m g x = I w' about the edge
    assert turned[-1] == pytest.approx(fall, rel=0.25)


def test_the_certificate_of_a_step_sees_wrong_forces_and_points_of_a_joint():
    stepper, state = stepper_of(on_springs())
    new, report = stepper.step(state, 1e-3, STILL)
    t = report.solution.t

    def judged(t):
        return stepper.certificate.step(state, new, state.memory, t, 1e-3, STILL, Returned(), stepper.matrix(1e-3))

    assert judged(t) < 1e-10
    own = np.flatnonzero(stepper.maker.slots.face >= 0)
    swapped = t.copy()  # the same resultant, but not what springs of these areas carry
    swapped[own[[0, 3]], 0] += [1e-2 * t[:, 0].max(), -1e-2 * t[:, 0].max()]
    assert judged(swapped) > 1e-6
    layout = stepper.maker.search.layout
    joints = layout.toucher.joints
    assert stepper.certificate.original.named(layout).sound
    turned = sp.csr_array(joints.weight.tocsr()[::-1])  # means of the corners still, of other points
    for wrong in (joints.weight * 0.99, turned):
        other = replace(layout, toucher=replace(layout.toucher, joints=replace(joints, weight=wrong)))
        assert not stepper.certificate.original.named(other).sound


def test_blocks_on_springs_that_stand_apart_move_each_by_itself():
    far = ((3.0, -0.3, 0.0), (3.5, 0.3, 0.8))
    both = replace(blocks(((-A, -B, 0.0), (A, B, 2 * H)), far), laws={"joint": SOFT})
    thrown = {"b0": (0.05, 0.02, 0.0, 0.1, 0.0, 0.2)}
    found, alone = (concio.dynamics(m, duration=0.03, gravity=G, velocities=thrown) for m in (both, on_springs()))
    assert found.certified
    assert found.end.centre[1] == pytest.approx(alone.end.centre[1], abs=1e-12)
    assert found.end.rotation[1] == pytest.approx(alone.end.rotation[1], abs=1e-12)
    assert found.end.memory.stored.sum() > alone.end.memory.stored.sum() > 0

    whole = Reference.of(both, G)
    memory = found.end.memory
    own = [(one, one.part(found.end).memory) for one in structures_of(whole)]
    assert [len(part.key) > 0 for _, part in own] == [True, True]
    assert sum(len(part.key) for _, part in own) == len(memory.key)
    for one, part in own:
        again = one.remembered(part)
        row = {int(name): k for k, name in enumerate(memory.key)}
        assert memory.force[[row[int(name)] for name in again.key]].tolist() == part.force.tolist()


def test_forces_are_handed_from_pairs_that_end_to_pairs_that_begin_and_to_no_others():
    stepper, state = stepper_of(blocks(((-A, -B, 0.0), (A, B, H)), ((-A, -B, H), (A, B, 2 * H))))
    search, still = stepper.maker.search, (np.zeros((3, 3)), np.zeros((3, 3)), state.strain)
    rows = search.rows(state.placement, *still)
    rng, handed = np.random.default_rng(3), 0
    for _ in range(30):
        carried, valid = rng.random((2, len(rows.gap))) < 0.5
        here = replace(rows, valid=valid, point=np.zeros_like(rows.point))  # all within reach of each other
        source, target, _ = search.handed_on(here, carried)
        assert (carried & ~valid)[source].all()
        assert (valid & ~carried)[target].all()
        assert len(np.unique(source)) == len(source) == len(np.unique(target))
        handed += len(source)
    assert handed > 0


SHAPES = {"plate": ((3.0, 3.0, 0.02), 5.0), "rod": ((0.02, 0.02, 3.0), 5.0), "cube on an edge": ((1.0, 1.0, 1.0), 0.1)}
"""Sizes of a block, and where the floor below it ends."""


@pytest.mark.parametrize("name", SHAPES)
def test_the_least_area_of_a_joint_goes_by_the_narrower_body_and_by_its_face(name):
    """Three volumes over the surface, squared, or what the two faces have in common."""
    (a, b, c), end = SHAPES[name]
    bodies = (
        concio.Polyhedron.box("floor", (-5.0, -5.0, -5.0), (end, end, 0.0), kind="fixed"),
        concio.Polyhedron.box("b", (0.0, 0.0, 0.0), (a, b, c), kind="rigid"),
    )
    loads = (concio.Load("weight", (0.0, 0.0, -1.0)),)
    law = concio.JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=5e5)
    solid, state = stepper_of(concio.Model(bodies, {"block": concio.Rigid(20.0)}, {"joint": law}, loads=loads))
    solid.step(state, 1e-4, Drive(np.zeros(3), np.zeros(3), {}))
    layout = solid.maker.search.layout
    narrow = 3.0 * a * b * c / (2.0 * (a * b + b * c + c * a))
    wanted = SLIVER_SHARE * min(narrow**2, min(a, end) * min(b, end))
    assert layout.toucher.joints.least == pytest.approx([wanted])
    assert solid.certificate.original.named(layout).joints.least == pytest.approx([wanted])
