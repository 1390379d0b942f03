"""Pushes in space: blocks about edges and corners by hand, turned models, and the plane extruded and turned."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from commands import run
from concio.analysis.motion.push_result import PushEnding
from concio.analysis.motion.resistance import RESISTANCE, Resistance
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.contact.applied import free_group, pushed
from concio.contact.reference import Reference
from models import box, model_of, weight
from motion_models import G, standing
from samples import first, sample
from space_motions import blocks, extruded

TURN = Rotation.from_rotvec([0.3, 0.5, -0.8]).as_matrix()
A, B, H = 0.25, 0.2, 1.0
"""Half sides and half height of the block that is pushed [m]."""
TALL = blocks(((-A, -B, 0.0), (A, B, 2 * H)))


def statics_of(model, along, sag=1e-10):
    """Equilibria of a model under a share of its weights; joints sink in by next to nothing."""
    group = free_group(model)
    if model.dim == 2:
        model = pushed(model, along, group)
    else:  # the weight of a turned model does not act along -z
        model = replace(model, loads=(*model.loads, concio.Load("weight", tuple(along), group=group)))
    reference = Reference.of(model, G)
    return Statics(reference, Scheme(), {}, (group,), sag=sag), MotionState.at_rest(reference)


@pytest.mark.parametrize(("stack", "seed"), first(1, [(1, 0), (3, 1)]))
def test_an_extruded_and_turned_pillar_is_pushed_like_that_of_the_plane(stack, seed):
    """Multiplier and places to 1e-10, past the peak; depth so that the mean width is that of the plane."""
    width, height = 0.4, 1.5
    depth = 2 * width * (height / stack) / (width + height / stack)
    rng = np.random.default_rng(seed)
    floor = box("floor", -30.0, 30.0, -1.0, 0.0, kind="fixed")
    levels = np.linspace(0.0, height, stack + 1)
    parts = [concio.Body(f"b{k}", [(-0.2, low), (0.2, low), (0.2, high), (-0.2, high)], kind="rigid", material="stone",
                         thickness=depth) for k, (low, high) in enumerate(itertools.pairwise(levels))]
    model = model_of(replace(floor, thickness=depth), *parts, law=0.7, loads=(weight(),))
    flat, state = statics_of(model, (1.0,))
    solid, other = statics_of(extruded(model, depth, TURN), TURN @ [1.0, 0.0, 0.0])
    one, two = flat.balance(state, 0.0), solid.balance(other, 0.0)
    for target in (1e-6, 1e-3, 0.02 + 0.02 * rng.random(), 0.05, 0.05):
        one = flat.balance(one.state, one.multiplier, target=target)
        two = solid.balance(two.state, two.multiplier, target=target)
        assert one.found
        assert two.found
        assert two.multiplier == pytest.approx(one.multiplier, abs=1e-10)
        own = two.state.centre[1:] @ TURN
        assert own[:, [0, 2]] == pytest.approx(one.state.centre[1:], abs=1e-10)
        assert own[:, 1] == pytest.approx(0.0, abs=1e-10)
    assert 0.0 < one.multiplier < 0.5 * width / height


@pytest.mark.parametrize(("direction", "half"), first(2, [((-1, 0, 0), A), (1.0, A), ((1, 0), A), ((0, 1), B)]))
def test_a_block_turns_over_its_edge_as_hand_statics_says(direction, half):
    """Peak b/h; at a rotation theta tan(atan(b/h) - theta), and nothing once the centroid has moved by b."""
    found = concio.push(TALL, direction=direction)
    assert found.ending is PushEnding.LOST
    assert found.certified
    assert found.verdict.holds
    assert found.peak == pytest.approx(half / H, rel=2e-5)
    assert found.capacity == pytest.approx(half, rel=2e-4)
    turned = np.linalg.norm(found.rotation_of("b0"), axis=1)
    assert found.multiplier[1:] == pytest.approx(np.tan(np.arctan(half / H) - turned[1:]), abs=2e-5)
    axis = found.rotation_of("b0")[-1] / turned[-1]
    way = found.direction
    assert axis == pytest.approx(np.cross([0.0, 0.0, 1.0], way), abs=1e-6)


@pytest.mark.parametrize("seed", range(sample(1, 4, 8)))
def test_a_block_pushed_askew_turns_over_the_edge_that_gives_first(seed):
    """Along a direction n the multiplier is the least of a / (n_x h) and b / (n_y h)."""
    angle = np.random.default_rng(seed).uniform(0.15, 1.4)
    way = np.array([np.cos(angle), np.sin(angle)])
    found = concio.push(TALL, direction=tuple(way), until=1e-3)
    assert found.certified
    assert found.peak == pytest.approx(min(A / way[0], B / way[1]) / H, rel=1e-4)


@pytest.mark.long
@pytest.mark.parametrize("way", [(1, 1), (-1, 1)])
def test_a_square_block_pushed_along_its_diagonal_turns_over_its_corner(way):
    """Past the peak to the end: sideways it stands on a corner like a pencil on its tip."""
    square = blocks(((-A, -A, 0.0), (A, A, 2 * H)))
    reach = np.sqrt(2.0) * A
    found = concio.push(square, direction=way)
    assert found.ending is PushEnding.LOST
    assert found.certified
    assert found.peak == pytest.approx(reach / H, rel=2e-5)
    assert found.capacity == pytest.approx(reach, rel=1e-6)
    turned = np.linalg.norm(found.rotation_of("b0"), axis=1)
    assert found.multiplier[1:] == pytest.approx(np.tan(np.arctan(reach / H) - turned[1:]), abs=2e-5)
    corner = found.centre[-1, 1] + found.rotation[-1, 1] @ [way[0] * A, way[1] * A, -H]
    assert corner == pytest.approx([way[0] * A, way[1] * A, 0.0], abs=1e-4)
    assert not any("unstable aside" in note for note in concio.push(square, until=0.1).notes)


@pytest.mark.parametrize("stiffness", [-0.02, -1.0, -50.0])
def test_iterations_meet_an_unstable_equilibrium(stiffness):
    """A displacement x = (f - k y) / e with negative k: it moves away, whatever e, until it is extrapolated."""
    resistance, y, wanted, turned_back = Resistance(1), 1e-3, 0.4, False
    for iteration in range(1, 40):
        x = np.array([stiffness * (wanted - y)]) / RESISTANCE[resistance.level]
        share = resistance.share(iteration, x, controlled=True)
        turned_back |= share < 0
        y = y + share * float(x[0])
        resistance.adapt(iteration, share * x)
        if abs(y - wanted) < 1e-12:
            break
    assert turned_back
    assert y == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("controlled", [False, True])
@pytest.mark.parametrize("stiffness", [0.0, 1e-3, 1.0, 4.0])
def test_iterations_that_creep_or_converge_go_on_the_same_way(stiffness, controlled):
    """What resists beside the stiffness leaves a ratio 1 / (1 + k / e) between iterations: the rest is made at once."""
    resistance, y, far = Resistance(1), 0.0, 0
    for iteration in range(1, 12):
        x = np.array([1e-3 - stiffness * y]) / (stiffness + RESISTANCE[resistance.level])
        share = resistance.share(iteration, x, controlled=controlled)
        assert share >= 1.0
        far += share > 1.0
        y += share * float(x[0])
        resistance.adapt(iteration, share * x)
        if stiffness and abs(stiffness * y - 1e-3) < 1e-13:
            break
    assert far == 0 or stiffness
    if stiffness >= 1.0:
        assert far
        assert stiffness * y == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.long  # the pillar extruded and turned
def test_a_model_that_is_turned_about_the_vertical_is_pushed_the_same():
    about = Rotation.from_rotvec([0.0, 0.0, 0.7]).as_matrix()
    found = concio.push(TALL, direction=(1, 0.4))
    turned = replace(TALL, bodies=tuple(replace(b, vertices=b.vertices @ about.T) for b in TALL.bodies))
    other = concio.push(turned, direction=tuple(about[:2, :2] @ [1.0, 0.4]))
    assert other.peak == pytest.approx(found.peak, rel=1e-9)
    assert other.capacity == pytest.approx(found.capacity, rel=1e-6)
    assert other.centre[-1, 1] == pytest.approx(about @ found.centre[-1, 1], abs=1e-6)


@pytest.mark.long
def test_a_block_mirrored_is_the_mirrored_push():
    found, other = (concio.push(TALL, direction=(1, side * 0.4)) for side in (1, -1))
    assert other.multiplier == pytest.approx(found.multiplier, abs=1e-9)
    assert other.centre[:, 1] * [1, -1, 1] == pytest.approx(found.centre[:, 1], abs=1e-9)


def test_a_low_block_slides_at_its_friction_in_any_direction():
    found = concio.push(blocks(((-0.4, -0.4, 0.0), (0.4, 0.4, 0.3)), friction=0.3), direction=(0.6, -0.8), until=0.05)
    assert found.certified
    assert found.multiplier[1:] == pytest.approx(0.3, abs=1e-6)
    assert found.centre[-1, 1, :2] == pytest.approx([0.03, -0.04], abs=1e-6)


def test_a_tie_in_space_adds_its_force_at_its_present_place():
    """Moments about the edge at every point of the curve: weight, earthquake, and the tie to a fixed point behind."""
    behind = np.array([-2.0, 0.0, 1.8])
    rod = concio.Tie("rod", "b0", (-A, 0.0, 1.8), "", tuple(behind), stiffness=20.0, prestress=0.5)
    found = concio.push(replace(blocks(((-A, -B, 0.0), (A, B, 2 * H)), friction=2.0), ties=(rod,)), until=0.1)
    weighs = 20.0 * 8 * A * B * H
    assert found.certified
    for k in range(2, len(found)):
        turn = found.rotation[k, 1]
        edge = found.centre[k, 1] + turn @ [A, 0.0, -H]
        end = found.centre[k, 1] + turn @ [-A, 0.0, 0.8]
        span = behind - end
        force = 0.5 + 20.0 * (np.linalg.norm(span) - (2.0 - A))
        pull = np.cross(end - edge, force * span / np.linalg.norm(span))[1]
        arm = found.centre[k, 1] - edge
        wanted = -(pull + np.cross(arm, [0.0, 0.0, -weighs])[1]) / np.cross(arm, [weighs, 0.0, 0.0])[1]
        assert found.multiplier[k] == pytest.approx(wanted, rel=2e-4)


@pytest.mark.long
def test_a_pillar_on_a_floor_that_has_turned_in_space_carries_what_hand_statics_says():
    angle = np.deg2rad(4.0)
    leaning = replace(TALL, supports=(concio.Support("turn", "floor", rotation=(0.0, angle, 0.0)),))
    for side in (1.0, -1.0):
        found = concio.push(leaning, direction=side)
        assert found.certified
        assert found.peak == pytest.approx(np.tan(np.arctan(A / H) - side * angle), rel=3e-4)


@pytest.mark.long
def test_two_blocks_that_stand_apart_are_pushed_each_by_itself():
    far = blocks(((-A, -B, 0.0), (A, B, 2 * H)), ((-0.4, 2.0, 0.0), (0.4, 2.8, 2 * H)))
    found, alone = concio.push(far), concio.push(TALL)
    assert found.certified
    assert found.multiplier == pytest.approx(alone.multiplier, abs=1e-12)
    assert found.displacement == pytest.approx(alone.displacement, abs=1e-12)


@pytest.mark.long  # the extruded and turned pillar
def test_the_plane_says_the_same_of_a_pillar_through_the_public_door():
    """To what hard joints give way: half as much at twice as many points."""
    flat = concio.push(standing(width=2 * A, height=2 * H))
    solid = concio.push(TALL)
    assert solid.peak == pytest.approx(flat.peak, rel=1e-5)
    assert solid.capacity == pytest.approx(flat.capacity, rel=1e-4)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"direction": (0.0, 0.0, 0.0)}, "is not a direction"),
        ({"direction": (1.0, 0.0, 0.0, 0.0)}, "is not a direction"),
        ({"direction": "right"}, "is not a direction"),
        ({"control": concio.ControlPoint("b9", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))}, "no body called 'b9'"),
    ],
)
def test_bad_arguments_in_space(options, words):
    with pytest.raises(concio.InputError, match=words):
        concio.push(TALL, **options)


@pytest.mark.long
def test_a_push_in_space_from_the_command_line(tmp_path):
    file, out = tmp_path / "pillar.toml", tmp_path / "pushed"
    concio.save(TALL, file)
    point = "b0,0.25,0.2,2.0"
    code, text, err = run("push", file, "--direction", "0,1", "--point", point, "--along", "y", "--json", "--out", out)
    assert code == 0, err
    told = json.loads(text)
    assert told["peak"]["multiplier"] == pytest.approx(B / H, rel=1e-4)
    head = (out / "events.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head.endswith("z [m]")
    assert "reaction z of floor" in (out / "curve.csv").read_text(encoding="utf-8").splitlines()[0]
    read = concio.load_motion(out / "motion.npz")
    assert read.peak == told["peak"]["multiplier"]
    assert read.rotation_of("b0").shape == (len(read), 3)
    code, _, err = run("push", file, "--direction", "up")
    assert code == 2
    assert "'up' is not a direction" in err
