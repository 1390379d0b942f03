"""What slides on a wall is carried as far as faces reach, whatever the order of the blocks in the file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import Body, JointLaw, Load, Model, Rigid, Site
from concio.analysis.seismic.curve import follow
from concio.analysis.seismic.linkage import Linkage
from concio.analysis.seismic.local_mechanism import LocalMechanism
from concio.analysis.seismic.macro_blocks import GROUND, MacroJoint
from concio.analysis.seismic.rocking_on import _rocking, followed_on
from samples import sample

SITE = Site(hazard={"SLV": {"a_g": 0.2, "F0": 2.45, "Tc": 0.32}})


def boxes(sizes: dict[str, tuple[float, float, float, float]]) -> tuple[Body, ...]:
    """Return rectangles from x0, x1, y0, y1; the one called "ground" is fixed."""
    return tuple(
        Body(name, np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), kind="fixed" if name == "ground" else "rigid")
        for name, (x0, x1, y0, y1) in sizes.items()
    )


def slides(bodies: tuple[Body, ...], law: JointLaw, way: str) -> LocalMechanism:
    """Return the mechanism in which the block called "top" slides alone."""
    model = Model(
        bodies, {"block": Rigid(unit_weight=20.0)}, {"joint": law},
        loads=(Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    found = concio.assess(model, site=SITE, direction=way, mechanisms={"top": ["top"]})
    own = next(m for m in (*found.mechanisms, *found.others) if m.name == "top")
    assert own.multiplier == pytest.approx(law.friction, rel=1e-6)
    return own


@pytest.mark.parametrize("strength", [None, 600.0])
@pytest.mark.parametrize("seed", range(sample(1, 24)))
def test_a_block_slides_until_its_resultant_comes_to_the_edge_of_the_wall_and_rocks(
    seed: int, strength: float | None
) -> None:
    """A low block on a wall, flush with it, set back or beyond it: H = mu W acts at half of its height.

    Then it rocks about the edge, until its centroid stands above it: its multiplier is the tangent of the angle of
    friction less that of its rotation. A joint that crushes under W = f w x at its edge turns half of x before it.
    """
    rng = np.random.default_rng([44, seed])
    low, high = -0.3, 0.3
    left, right = (float(rng.choice([0.0, 0.0, -0.05, 0.08])) for _ in range(2))
    b0, b1 = low + left, high - right
    height, friction = float(rng.uniform(0.2, 0.6)), float(rng.uniform(0.1, 0.4))
    wall = {"one": (low, high, 0.0, 1.0)} if rng.random() < 0.5 else {
        "one": (low, 0.1, 0.0, 1.0), "two": (0.1, high, 0.0, 1.0),
    }  # fmt: skip
    bodies = list(boxes({"ground": (-2.0, 2.0, -0.5, 0.0), **wall, "top": (b0, b1, 1.0, 1.0 + height)}))
    rng.shuffle(bodies)
    way = str(rng.choice(["left", "right"]))
    side = 1.0 if way == "right" else -1.0
    resultant = (b0 + b1) / 2 + side * friction * height / 2
    edge = high if way == "right" else low
    crushed = 0.0 if strength is None else 20.0 * (b1 - b0) * height / (2.0 * strength)
    own = slides(tuple(bodies), JointLaw(friction, compressive_strength=strength), way)
    slid = side * (edge - resultant) - crushed
    turn = np.linspace(0.0, np.arctan(friction), 999)
    rocks = slid + ((1.0 - np.cos(turn)) * friction + np.sin(turn)) * height / 2  # of the centroid, where H acts
    assert own.followed.kind == "followed"
    assert own.followed.reason == "falls"
    assert own.followed.end == pytest.approx(rocks[-1], abs=1e-5)
    at = np.linspace(0.0, own.followed.end, 40)
    right_ones = np.interp(at, rocks, np.tan(np.arctan(friction) - turn))
    assert [own.followed.at(d) for d in at] == pytest.approx(right_ones, abs=2e-3 * friction)


@pytest.mark.parametrize("friction", [0.05, 0.08, 0.11])
def test_what_slides_and_then_rocks_has_no_more_displacement_than_what_rocks(friction: float) -> None:
    """Its masses come as far as those of the block that does not slide: to where their centroid stands above the edge.

    d was that of a corner at the top, which goes twice as far, and zeta_E 1.10 in place of 0.63.
    """
    sizes = {"ground": (-2.0, 3.0, -0.5, 0.0), "low": (0.0, 0.5, 0.0, 1.0), "top": (0.0, 0.5, 1.0, 5.0)}
    model = Model(
        boxes(sizes), {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(friction)},
        loads=(Load("weight", (0.0, -1.0)), Load("point", (0.0, -6.0), bodies=("top",), at=(0.25, 4.0))),
    )  # fmt: skip
    asked = {"site": SITE, "direction": "left", "mechanisms": {"top": ["top"]}}

    def own(model: Model, **more: object) -> LocalMechanism:
        found = concio.assess(model, **asked, **more)
        return next(m for m in (*found.mechanisms, *found.others) if m.name == "top")

    slides, rocks = own(model), own(replace(model, laws={"joint": JointLaw(0.5)}))
    assert slides.multiplier == pytest.approx(friction)
    assert slides.control[1] == pytest.approx((0.25, (40.0 * 3.0 + 6.0 * 4.0) / 46.0))
    assert slides.d0 == pytest.approx(0.25, abs=1e-6)
    assert slides.zeta < 1.01 * rocks.zeta
    asked["direction"] = "-x"
    solid = concio.extrude(model)
    assert own(solid).zeta == pytest.approx(slides.zeta, rel=0.03)  # steps are long where it rocks
    outrun = own(solid, control=("top", (0.0, 0.0, 5.0)))
    assert outrun.followed.reason == "falls"
    assert outrun.d0 == pytest.approx(0.25, rel=0.03), "the masses come no further, whatever the corner does"
    assert outrun.zeta < 1.03 * slides.zeta
    given = own(solid, control=("top", (0.0, 0.0, 5.0)), limits={"SLV": 0.09}).limits["SLV"]
    height = slides.control[1][1] - 1.0
    slid = min(0.25 - friction * height, 0.09)
    assert given.why == "given"
    late = 0.016 * (1.0 - height / 4.0)  # it slides to the end of the step in which it comes to the edge
    assert given.control == pytest.approx(slid + (0.09 - slid) * height / 4.0, abs=late), "what the masses do there"
    asked["direction"] = "left"
    corner = own(model, control=("top", (0.0, 5.0)))
    assert corner.followed.reason == "joint opens", "a corner that would outrun the masses is not followed"
    assert corner.zeta < slides.zeta


def test_a_push_at_large_displacements_finds_the_same() -> None:
    """It slides to the edge and rocks about it; the curve of the linkage ended where rocking begins."""
    friction, height = 0.25, 0.4
    sizes = {"ground": (-0.3, 0.3, 0.0, 1.0), "top": (-0.3, 0.3, 1.0, 1.0 + height)}
    model = Model(
        boxes(sizes), {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(friction)},
        loads=(Load("weight", (0.0, -1.0)), Load("weight", (1.0, 0.0), ("top",), group="live")),
    )  # fmt: skip
    pushed = concio.push(model, control=concio.ControlPoint("top", (0.0, 1.0 + height / 2)), until=0.4, step=0.005)
    found = concio.assess(replace(model, loads=model.loads[:1]), site=SITE, direction="right")
    (own,) = found.mechanisms
    assert own.followed.end == pytest.approx(float(pushed.displacement[-1]), rel=1e-3)
    at = np.linspace(0.01, own.followed.end, 30)
    right = np.interp(at, pushed.displacement, pushed.multiplier)
    assert [own.followed.at(d) for d in at] == pytest.approx(right, abs=0.01 * friction)


@pytest.mark.parametrize("friction", [0.48, 0.6])
def test_what_slides_at_the_top_of_a_slender_wall_does_not_decide_by_where_rocking_begins(friction: float) -> None:
    """zeta_E was 0.82 with the least friction, of a part whose curve ended after 1 cm, and less friction gave more."""
    heights = np.linspace(0.0, 9.0, 19)
    sizes = {f"c{k + 1}": (0.0, 0.8, float(heights[k]), float(heights[k + 1])) for k in range(18)}
    loads = (Load("weight", (0.0, -1.0)), Load("point", (0.0, -12.0), bodies=("c18",), at=(0.5, 9.0)))
    wall = Model(
        boxes({"ground": (-1.0, 2.0, -0.5, 0.0), **sizes}), {"block": Rigid(19.0)}, {"joint": JointLaw(friction)},
        loads=loads,
    )  # fmt: skip
    site = Site(hazard={"SLV": {"a_g": 0.2, "F0": 2.45, "Tc": 0.32}}, soil="B",
                building={"height": 9.0, "storeys": 1, "T1": 0.25, "xi": 10})  # fmt: skip
    found = concio.assess(wall, site=site, direction="both", levels=["SLV"])
    assert found.worst is not None
    assert found.worst.multiplier < 0.1, "the wall as a whole"
    assert found.zeta > 1.1


@pytest.mark.parametrize("seed", range(sample(1, 10)))
def test_the_order_of_the_blocks_changes_no_assessment(seed: int) -> None:
    """A wall of courses that slide on each other, with floors and a tie: some of its curves end at an edge."""
    rng = np.random.default_rng([45, seed])
    heights = rng.choice([0.5, 0.8, 1.0], size=int(rng.integers(3, 6)))
    floors = np.concatenate([[0.0], np.cumsum(heights)])
    sizes = {f"c{k}": (0.0, 0.6, float(floors[k]), float(floors[k + 1])) for k in range(len(heights))}
    last, top = f"c{len(heights) - 1}", float(floors[-1])
    loads = (Load("weight", (0.0, -1.0)), Load("point", (float(-rng.uniform(0, 1)), -4.0), (last,), at=(0.3, top)))
    tie = concio.Tie(
        "tie", body_a=last, at_a=(0.3, top - 0.2), body_b="", at_b=(5.0, top - 0.2), stiffness=1e4,
        yield_force=float(rng.uniform(0.2, 3.0)),
    )  # fmt: skip
    model = Model(
        boxes({"ground": (-1.0, 2.0, -0.5, 0.0), **sizes}), {"block": Rigid(unit_weight=19.0)},
        {"joint": JointLaw(friction=float(rng.uniform(0.25, 0.45)))}, loads=loads, ties=(tie,),
    )  # fmt: skip
    alone = concio.assess(model, site=SITE, direction="both")
    shuffled = list(model.bodies)
    rng.shuffle(shuffled)
    other = concio.assess(replace(model, bodies=tuple(shuffled)), site=SITE, direction="both")
    assert other.verdict.outcome is alone.verdict.outcome
    assert other.zeta == pytest.approx(alone.zeta, rel=1e-6)


@pytest.mark.long
def test_parts_that_slide_at_one_multiplier_are_told() -> None:
    """Above every bed joint of a wall in bond parts of many shapes slide at mu W; a single block has no other part."""
    wall = concio.wall(length=1.5, height=1.25, block_size=(0.5, 0.25), block="rigid", unit_weight=18.0, friction=0.4,
                       thickness=2.0)  # fmt: skip
    found = concio.assess(wall, site=SITE, direction="left", levels=["SLV"])
    assert found.worst is not None
    assert found.worst.multiplier == pytest.approx(0.4)
    assert any("slide at the same alpha_0" in line and "the least zeta_E is reported" in line
               for line in found.verdict.limits)  # fmt: skip
    box = replace(wall, bodies=boxes({"ground": (-1.0, 2.0, -0.5, 0.0), "one": (0.0, 1.0, 0.0, 0.5)}))
    alone = concio.assess(box, site=SITE, direction="left", levels=["SLV"])
    assert not any("slide at the same alpha_0" in line for line in alone.verdict.limits)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 3, 10)))
def test_no_part_that_is_named_slides_worse_than_what_was_told(seed: int) -> None:
    """The order of the blocks decided which part was met: zeta_E of one wall was 2.634, and is 1.425 in any order."""
    rng = np.random.default_rng([46, seed])
    wall = concio.wall(
        length=float(rng.choice([1.5, 2.0])), height=float(rng.choice([0.75, 1.0])), block_size=(0.5, 0.25),
        block="rigid", unit_weight=18.0, friction=float(rng.uniform(0.25, 0.45)), thickness=2.0,
    )  # fmt: skip
    shuffled = [wall.bodies[k] for k in rng.permutation(len(wall.bodies))]
    asked = {"site": SITE, "direction": "left", "levels": ["SLV"]}
    alone = concio.assess(wall, **asked)
    other = concio.assess(replace(wall, bodies=tuple(shuffled)), **asked)
    assert other.zeta == pytest.approx(alone.zeta, rel=1e-6)
    free = [b for b in wall.bodies if b.kind != "fixed"]
    pick = free[int(rng.integers(len(free)))]
    above = [b.name for b in free if b is pick or b.centroid[1] > pick.centroid[1]]
    named = concio.assess(wall, mechanisms={"mine": above}, **asked)
    assert named.zeta >= alone.zeta * (1 - 1e-6)


@pytest.mark.long
def test_the_verdict_says_that_the_least_parts_were_followed_also_where_others_met_them_first() -> None:
    """A small block at an edge slides off after 4 cm, a large one beside it after 44: each part was sought."""
    sizes = {"ground": (-6.0, 6.0, -0.5, 0.0), "low": (-1.0, 1.0, 0.0, 0.5), "wide": (-0.9, 0.3, 0.5, 0.9)}
    model = Model(
        boxes({**sizes, "top": (0.9, 1.0, 0.5, 0.55)}), {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(0.3)},
        loads=(Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    found = concio.assess(model, site=SITE, direction="right")
    told = [line for line in found.verdict.limits if "slide at the same alpha_0" in line]
    assert len(told) == 1
    assert "the least zeta_E is reported" in told[0]
    assert "name the parts that matter" not in told[0]


def test_supports_stay_what_they_are_and_no_part_turns_into_what_carries_it() -> None:
    """What is held between the same two pieces is no end of the contact that opened; a point below the edge is no
    control of a part that rocks about it: moving on it would turn the part into the wall."""
    sizes = {"ground": (-0.3, 0.3, 0.0, 1.0), "top": (-0.3, 0.3, 1.0, 1.4)}
    model = Model(
        boxes(sizes), {"block": Rigid(unit_weight=20.0)}, {"joint": JointLaw(0.25)},
        loads=(Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    (own,) = concio.assess(model, site=SITE, direction="right").mechanisms
    linkage = own.linkage
    assert isinstance(linkage, Linkage)
    slides = follow(linkage)
    assert slides.reason == "joint opens"
    held = MacroJoint("roller", GROUND, 0, np.array([0.0, 1.0]), np.array([1.0, 0.0]), pulls=True)  # free to rise
    both = (*linkage.mechanics.joints, held)
    forces = np.append(slides.points[-1].normal_force, 1.0)
    more = replace(linkage, mechanics=replace(linkage.mechanics, joints=both))
    block, point, along = linkage.control
    rocks = _rocking(more, replace(slides.points[-1], normal_force=forces))
    assert rocks is not None
    assert [joint.kind for joint in rocks.mechanics.joints] == ["hinge", "roller"]
    low = replace(linkage, control=(block, point - np.array([0.0, 0.6]), along))
    assert followed_on(low, slides) is slides
    assert followed_on(linkage, slides).end > slides.end
