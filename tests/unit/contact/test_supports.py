"""Supports: what they hold, what stays free, imposed and contradictory movements, moved obstacles, reactions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.contact.assembly import assemble
from concio.errors import InputError
from concio.model.materials import Elastic, JointLaw
from concio.model.model import Load, Support
from models import box, model_of, on_ground, weight
from pillars import pillar, sideways, turned

STONE = {"kind": "rigid", "material": "stone"}
LEFT, RIGHT, BASE = ((0, 0), (0, 0)), ((4, 0), (4, 0)), ((0, 0), (4, 0))

WEIGHT = weight()


def beam(*supports, stone=False, loads=(WEIGHT,), **options):
    """A 4 x 1 beam on supports beside a pebble on the ground, so that there is an interface."""
    kind = STONE if stone else {"mesh_size": 0.5}
    return model_of(
        box("beam", 0, 4, 0, 1, **kind),
        box("ground", 10, 12, -1, 0, kind="fixed"),
        box("pebble", 10, 11, 0, 1, **STONE),
        supports=supports, loads=loads, **options,
    )  # fmt: skip


stone = pytest.mark.parametrize("stone", [False, True], ids=["elastic", "rigid"])


@stone
def test_simple_beam_has_no_rigid_motion_and_hand_reactions(stone):
    live = Load("point", (3.0, -8.0), bodies=("beam",), at=(1.0, 1.0))
    model = beam(Support("A", "beam", LEFT), Support("B", "beam", RIGHT, "y"), stone=stone, loads=(weight(), live))
    problem = assemble(model).problem()
    assert problem.rigid_motions == 3  # the pebble's
    result = concio.solve(model)
    # weight 80 in the middle; moments about A: B = (80 * 2 + 8 * 1 + 3 * 1) / 4
    assert result.reactions["B"] == pytest.approx((0.0, 42.75), abs=1e-9)
    assert result.reactions["A"] == pytest.approx((-3.0, 45.25), abs=1e-9)
    assert result.reactions["ground"] == pytest.approx((0.0, 20.0), abs=1e-9)


@stone
@pytest.mark.parametrize(
    ("supports", "motions"),
    [
        ((Support("A", "beam", LEFT, "x"),), 2),
        ((Support("A", "beam", LEFT, "y"),), 2),
        ((Support("A", "beam", LEFT),), 1),
        ((Support("A", "beam", BASE, "y"),), 1),
        ((Support("A", "beam", BASE, "x"),), 2),
        ((Support("A", "beam", BASE),), 0),
        ((Support("A", "beam"),), 0),
        ((Support("A", "beam", LEFT, "y"), Support("B", "beam", RIGHT, "y")), 1),
        ((Support("A", "beam", LEFT), Support("B", "beam", RIGHT)), 0),
    ],
)
def test_rigid_motions_left(supports, motions, stone):
    assembly = assemble(beam(*supports, stone=stone))
    problem = assembly.problem()
    own = problem.R[: problem.bodies[1]].toarray()
    assert (np.linalg.matrix_rank(own) if own.size else 0) == motions
    assert problem.R.shape[1] == motions + 3
    np.testing.assert_allclose((problem.R.T @ problem.R).toarray(), np.eye(motions + 3), atol=1e-13)
    assert abs(problem.K @ problem.R).max() < 1e-9 * max(abs(problem.K).max(), 1.0)
    T = assembly.supported.T
    np.testing.assert_allclose((T.T @ T).toarray(), np.eye(T.shape[1]), atol=1e-13)


@stone
def test_imposed_movement_of_a_determinate_beam_is_a_rigid_motion(stone):
    model = beam(
        Support("A", "beam", LEFT, displacement=(1e-3, 0)), Support("B", "beam", RIGHT, "y", displacement=(0, -4e-3)),
        stone=stone, loads=(weight(y=-1.0),), materials={"block": Elastic(1e5, 0.2)},
    )  # fmt: skip
    result = concio.solve(model)
    u, nodes = result.node_displacement("beam"), result.nodes("beam")
    turn = -1e-3  # 4 mm over 4 m
    np.testing.assert_allclose(u, np.column_stack([1e-3 - turn * nodes[:, 1], turn * nodes[:, 0]]), atol=1e-12)
    half = concio.solve(model, factors={"settlement": 0.5})
    np.testing.assert_allclose(half.node_displacement("beam"), u / 2, atol=1e-12)


def test_rotation_of_a_whole_held_body():
    model = beam(Support("A", "beam", rotation=1e-3, displacement=(2e-3, 0.0)))
    u, nodes = concio.solve(model).node_displacement("beam"), concio.solve(model).nodes("beam")
    x, y = (nodes - [2.0, 0.5]).T
    np.testing.assert_allclose(u, np.column_stack([2e-3 - 1e-3 * y, 1e-3 * x]), atol=1e-15)


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_supports_may_hold_every_block(space):
    model = model_of(box("ground", -1, 2, -1, 0, kind="fixed"), box("a", 0, 1, 0, 1, **STONE), loads=(WEIGHT,))
    held = replace(concio.extrude(model) if space else model, supports=(Support("s", "a"),))
    result = concio.solve(held)
    assert result.solved
    assert result.reactions["s"][-1] == pytest.approx(-concio.solve(model).total_load[1])


def test_two_supports_of_one_body_share_what_both_hold():
    """Both hold the left end's horizontal movement; each gets half of the push, and its own vertical reaction."""
    push = Load("traction", (6.0, 0.0), edge=((4, 0), (4, 1)))
    model = beam(
        Support("A", "beam", LEFT), Support("C", "beam", LEFT, "x"), Support("B", "beam", RIGHT, "y"), loads=(push,)
    )
    found = concio.solve(model).reactions
    assert found["A"][0] == pytest.approx(-3.0)
    assert found["C"] == pytest.approx((-3.0, 0.0))
    assert found["B"][1] == pytest.approx(-found["A"][1], abs=1e-9)
    assert found["B"][1] * 4 == pytest.approx(3.0)  # couple of the push, half a metre above the supports


@pytest.mark.parametrize("kind", ["elastic", "rigid"])
def test_a_moved_obstacle_carries_what_stands_on_it(kind):
    body = box("b", 0, 1, 0, 1, mesh_size=0.5) if kind == "elastic" else box("b", 0, 1, 0, 1, **STONE)
    move = Support("settle", "ground", displacement=(0.01, -0.02), rotation=0.001)
    rest, moved = (concio.solve(on_ground(body, loads=(weight(),), supports=s)) for s in ((), (move,)))
    nodes = rest.nodes("b")
    x, y = (nodes - [0.0, -0.5]).T
    shift = np.column_stack([0.01 - 0.001 * y, -0.02 + 0.001 * x])
    np.testing.assert_allclose(moved.node_displacement("b") - rest.node_displacement("b"), shift, atol=1e-10)
    assert moved.reactions["ground"] == pytest.approx((0.0, 20.0), abs=1e-9)
    ground = moved.node_displacement("ground")
    corner = np.array([5.0, 0.0]) - [0.0, -0.5]
    np.testing.assert_allclose(ground[2], [0.01 - 0.001 * corner[1], -0.02 + 0.001 * corner[0]])


@stone
@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
@pytest.mark.parametrize(("along", "down"), [(3e-4, 1e-3), (-3e-4, 1e-3), (2e-4, 5e-4), (1.0, 1e-3), (0.0, -1e-3)])
def test_a_held_body_that_moves_along_its_joint_is_resisted_by_its_springs(along, down, space, stone):
    """A block of 1 x 1 that is pressed onto the ground and along it: springs of the joint, friction at most."""
    law = JointLaw(0.5, normal_stiffness=1e5, tangential_stiffness=1e5)
    block = box("b", 0, 1, 0, 1, **(STONE if stone else {"mesh_size": 0.5}))
    support = Support("s", "b", displacement=(along, -down))
    model = on_ground(block, law=law, loads=(weight(),), supports=(support,))
    whole = {} if not space else {"supports": (replace(support, displacement=(along, 0.0, -down)),)}
    result = concio.solve(replace(concio.extrude(replace(model, supports=())) if space else model, **whole))
    pressed = 1e5 * max(down, 0.0)
    shear = np.clip(1e5 * along, -0.5 * pressed, 0.5 * pressed)
    across = (0.0,) if space else ()
    assert result.reactions["ground"] == pytest.approx((-shear, *across, pressed), abs=1e-6)
    half = concio.solve(result.model, factors={"settlement": 0.5})
    if abs(along) < 0.5 * down:
        assert half.reactions["ground"] == pytest.approx((-shear / 2, *across, pressed / 2), abs=1e-6)


def test_a_large_held_body_needs_no_dense_matrices():
    model = beam(Support("A", "beam", BASE), Support("B", "beam"), materials={"block": Elastic(1e5, 0.2)})
    big = concio.Model(
        (box("beam", 0, 4, 0, 1, mesh_size=0.02), *model.bodies[1:]),
        model.materials,
        model.laws,
        supports=model.supports,
    )
    problem = assemble(big).problem()
    assert problem.bodies[1] == 0  # all 20,502 unknowns held


@pytest.mark.parametrize(
    ("supports", "message"),
    [
        ((Support("A", "plank"),), "no body has that name"),
        ((Support("A", "beam", LEFT, "z"),), "directions 'z'"),
        ((Support("A", "beam", LEFT, ""),), "directions ''"),
        ((Support("A", "beam", ((0, 0.33), (0, 0.34))),), "no node"),
        ((Support("A", "beam", LEFT, displacement=(np.nan, 0)),), "not finite"),
        ((Support("A", "ground", displacement=(np.inf, 0)),), "not finite"),
        ((Support("A", "beam", LEFT), Support("B", "beam", LEFT, displacement=(1e-3, 0))), "contradictory.*'beam'"),
        ((Support("A", "beam", LEFT), Support("A", "beam", RIGHT)), "same name"),
        ((Support("ground", "beam", LEFT),), "same name"),
    ],
)
def test_refused(supports, message):
    with pytest.raises(InputError, match=message):
        assemble(beam(*supports))


@pytest.mark.parametrize("stone", [False, True])
@pytest.mark.parametrize("moved", [1e-9, 1e-3, 0.05])
def test_how_far_two_movements_may_differ_goes_by_their_size(stone, moved):
    """A millionth of the movement contradicts it, whatever its size; what rounding makes of one number does not."""

    def twice(share):
        same = [
            Support(n, "beam", LEFT, displacement=(moved * k, moved * k)) for n, k in (("A", 1.0), ("B", 1.0 + share))
        ]
        return beam(*same, stone=stone)

    for share in (1e-6, -1e-6):
        with pytest.raises(InputError, match="contradictory"):
            assemble(twice(share))
    assemble(twice(4e-16))


def test_contradictory_movements_of_a_rigid_body():
    stretch = (Support("A", "beam", LEFT), Support("B", "beam", RIGHT, displacement=(1e-3, 0)))
    with pytest.raises(InputError, match="contradictory"):
        assemble(beam(*stretch, stone=True))


@pytest.mark.parametrize("power", [-300, -120, -31, -27, -20, -15, -14, -13, -9, -6])
def test_a_support_that_moves_by_next_to_nothing_forces_nothing_together(power: int) -> None:
    """A pillar on a floor that turns by 10^power degrees: it follows, with the forces of a floor that rests."""
    still = concio.solve(concio.loads(pillar(sideways(0.1), more=turned(0.0))))
    found = concio.solve(concio.loads(pillar(sideways(0.1), more=turned(10.0**power))))
    assert found.verdict.attention == still.verdict.attention == ()
    assert found.assembly.lent_compliance == 0.0
    angle = 0.0 if power < -28 else np.deg2rad(10.0**power)  # a floor that moves by no length there is
    assert np.abs(found.displacement).max() <= 2.0 * angle
    assert found.displacement.any() == (power > -28)
    assert found.solution.normal_force == pytest.approx(still.solution.normal_force, rel=1e-6)


@pytest.mark.parametrize("body", ["block", "ground"])
@pytest.mark.parametrize(("held", "moved"), [("x", (0.0, -0.002)), ("y", (0.001, 0.0)), ("y", (0.001, -0.002))])
def test_a_movement_along_a_direction_that_is_not_held_is_refused(
    body: str, held: str, moved: tuple[float, float]
) -> None:
    """A settlement of 2 mm of a support that holds along x alone was left aside, and the block was in equilibrium."""
    pillar = concio.column(width=0.5, height=1.0, blocks=1, block="rigid", unit_weight=20.0)
    names = {"block": "b01", "ground": "ground"}
    support = concio.Support("moved", names[body], directions=held, displacement=moved)
    with pytest.raises(InputError, match=rf"it holds only '{held}' \(directions = 'xy' holds what is moved\)"):
        replace(pillar, supports=(support,))


def test_movements_in_texts_are_those_in_metres_and_radians() -> None:
    texts = concio.Support("s", "b", displacement=("1 mm", "-0.2 cm"), rotation="1 deg")
    assert texts.displacement == pytest.approx((0.001, -0.002))
    assert texts.rotation == pytest.approx(np.deg2rad(1.0))
    space = concio.Support("s", "b", displacement=("1 mm", 0.0, 0.0), rotation=("1 deg", 0.0, "0.02 rad"))
    assert space.rotation == pytest.approx((np.deg2rad(1.0), 0.0, 0.02))
    with pytest.raises(InputError, match="is not a length"):
        concio.Support("s", "b", displacement=("1 kN", 0.0))


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_a_support_at_one_point_turns_nothing(kind: str) -> None:
    """A segment of a rigid body turns it by what it says; one point cannot."""
    block = concio.Body("b", np.array([[0, 0], [2, 0], [2, 1], [0, 1.0]]), kind=kind)

    def held(*edge: tuple[float, float]) -> concio.Model:
        support = Support("s", "b", edge=edge, rotation=1e-3)
        materials = {"block": concio.Rigid(20.0) if kind == "rigid" else concio.Elastic(E=1e6, unit_weight=20.0)}
        return concio.Model((block,), materials, {"joint": concio.JointLaw(0.5)}, supports=(support,),
                            loads=(concio.Load("weight", (0.0, -1.0)),))  # fmt: skip

    with pytest.raises(concio.InputError, match="does not turn the body"):
        concio.solve(held((0.0, 0.0), (0.0, 0.0)))
    if kind == "rigid":
        turned = concio.solve(held((0.0, 0.0), (2.0, 0.0)))
        ends = turned.node_displacement("b")
        assert ends[1, 1] - ends[0, 1] == pytest.approx(2e-3, rel=1e-9)
