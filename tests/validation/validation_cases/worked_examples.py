r"""Worked examples of two open textbooks: friction, levers, a ladder, a door, a wedge.

Each number is the one that the book prints, to its two to four digits; the tolerance is half a unit of the last digit,
or what the book has rounded on the way. Forces here are in newtons or pounds where the books have them; no number
depends on the unit. Gravity is 9.80 m/s2, as in the books. A slope is gravity that leans. Accelerations are read from
the distance of a motion from rest. Each acceleration of a truck acts on its crate as inertia.

A ladder touches floor and wall with its tips, the stick and the forearm turn about a knife edge. The third mass on the
stick, and the muscle of the forearm, are what a tie pulls. The string of the sliding blocks turns about a pulley
without friction: it pulls both blocks alike, and its force is that at which the upper block slides on a fixed one.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from concio import Body, JointLaw, JointRule, Load, Model, Rigid, Tie
from validation_cases.row import Row

SOURCE = (
    "W. Moebs, S. J. Ling and J. Sanny, University Physics, Volume 1, OpenStax (2016), section 5.6 (example: Weight on"
    " an Incline), section 6.2 (examples: Static and Kinetic Friction, and the exercise after it; Downhill Skier;"
    " Sliding Blocks; A Crate on an Accelerating Truck; Snowboarding), section 12.2 (examples: The Torque Balance;"
    " Forces in the Forearm; A Ladder Resting Against a Wall; Forces on Door Hinges); D. W. Baker and W. Haynes,"
    " Engineering Statics: Open and Interactive, section 9.3, Wedges (both examples)."
)

G = 9.80
FLOOR = [(-30.0, -1.0), (60.0, -1.0), (60.0, 0.0), (-30.0, 0.0)]


LAST = "half a unit of the last printed digit"


def digits(value: float, last: float) -> float:
    """Return half a unit of the last digit, relative to the value."""
    return 0.5 * last / abs(value) * (1 + 1e-9)


def crate(mass: float, friction: float, push: float = 0.0, slope: float = 0.0, live: float = 0.0) -> Model:
    """A crate on a floor, pushed with a force [N] at its centroid; gravity leans by a slope [degrees]."""
    weight, lean = mass * G, np.radians(slope)
    body = Body("crate", [(0, 0), (1.0, 0), (1.0, 0.2), (0, 0.2)], kind="rigid")
    loads = [Load("weight", (float(np.sin(lean)) + push / weight, -float(np.cos(lean))))]
    loads += [Load("weight", (live / weight, 0.0), group="live")] if live else []
    return Model(
        (Body("floor", FLOOR, kind="fixed"), body), {"block": Rigid(unit_weight=weight / 0.2)},
        {"joint": JointLaw(friction)}, loads=tuple(loads),
    )  # fmt: skip


def held(mass: float, friction: float, push: float) -> tuple[float, float]:
    """Return friction and normal force [N] on a crate that rests."""
    x, y = concio.solve(crate(mass, friction, push)).reactions["floor"]
    return abs(float(x)), float(y)


def most(mass: float, friction: float) -> float:
    """Return the push [N] at which a crate begins to slide."""
    return carried(crate(mass, friction, live=1.0))


def carried(model: Model) -> float:
    """Return the limit multiplier of the live load, nan where friction leaves it open."""
    low, high = concio.limit(model).bracket
    return float(high) if abs(high - low) <= 2e-2 * high else float("nan")


@cache
def acceleration(mass: float, friction: float, push: float = 0.0, slope: float = 0.0) -> float:
    """Return the acceleration [m/s2] with which a crate slides from rest."""
    found = concio.dynamics(
        crate(mass, friction, push, slope), duration=1.0, step=1e-2, gravity=G, start="as described"
    )
    return float(2.0 * (found.end.centre[1, 0] - found.shots.centre[0, 1, 0]) / found.end.time**2)


def sliding_blocks() -> tuple[float, float, float]:
    """Return the tension of the string, the force on the floor and the pull [N] on the lower of two blocks."""
    string = most(2.0, 0.4)
    lower = Body("lower", [(0, 0), (4.0, 0), (4.0, 0.2), (0, 0.2)], kind="rigid", material="heavy")
    upper = Body("upper", [(1.5, 0.2), (2.5, 0.2), (2.5, 0.4), (1.5, 0.4)], kind="rigid")
    model = Model(
        (Body("floor", FLOOR, kind="fixed"), lower, upper),
        {"heavy": Rigid(unit_weight=4.0 * G / 0.8), "block": Rigid(unit_weight=2.0 * G / 0.2)},
        {"joint": JointLaw(0.4)}, ties=(Tie("string", "upper", (2.5, 0.3), "", (9.0, 0.3), stiffness=1e6),),
        loads=(Load("weight", (0.0, -1.0)), Load("point", (-1.0, 0.0), bodies=("lower",), at=(0.0, 0.1), group="live")),
    )  # fmt: skip
    pressed = float(concio.solve(model, factors={"live": 0.0}).reactions["floor"][1])
    return string, pressed, carried(model) + string


@cache
def ladder() -> tuple[float, float, float, float]:
    """Return the forces of floor (normal, friction) and wall [N] on a ladder at 53 degrees, and the least friction."""
    angle = np.radians(53.0)
    along, across = np.array([np.cos(angle), np.sin(angle)]), 0.05 * np.array([np.sin(angle), -np.cos(angle)])
    top = 5.0 * along
    middle = 0.5 * top
    bar = Body("ladder", np.array([(0.0, 0.0), middle + across, top, middle - across]), kind="rigid")
    wall = [(top[0], 1.0), (top[0] + 1.0, 1.0), (top[0] + 1.0, 8.0), (top[0], 8.0)]
    model = Model(
        (Body("floor", FLOOR, kind="fixed"), Body("wall", wall, kind="fixed"), bar),
        {"block": Rigid(unit_weight=400.0 / 0.25)}, {"rough": JointLaw(0.5), "smooth": JointLaw(0.0)},
        rules=(JointRule("rough", ("floor", "ladder")), JointRule("smooth", ("wall", "ladder"))),
        loads=(Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    found = concio.solve(model).reactions
    return float(found["floor"][1]), abs(float(found["floor"][0])), abs(float(found["wall"][0])), (
        0.5 * concio.friction_margin(model).factor
    )  # fmt: skip


def knife(name: str, tip: tuple[float, float], towards: tuple[float, float]) -> Body:
    """A fixed wedge whose edge is at ``tip`` and points ``towards`` a side."""
    x, y = np.array(towards), np.array([-towards[1], towards[0]])
    end = np.array(tip)
    return Body(name, np.array([end, end - 0.4 * x + 0.2 * y, end - 0.4 * x - 0.2 * y]), kind="fixed")


def lever(
    bar: list[tuple[float, float]], weight: float, fixed: Body, ties: tuple[Tie, ...], loads: tuple[Load, ...] = ()
) -> concio.Result:
    """Solve one bar on a knife edge with ties; ``weight`` is that of the whole bar."""
    body = Body("bar", bar, kind="rigid")
    x, y = np.asarray(bar).max(0) - np.asarray(bar).min(0)
    model = Model(
        (fixed, body), {"block": Rigid(unit_weight=weight / float(x * y))}, {"joint": JointLaw(0.6)}, ties=ties,
        loads=(Load("weight", (0.0, -1.0)), *loads),
    )  # fmt: skip
    return concio.solve(model)


def tension(found: concio.Result, tie: str) -> float:
    """Return what a tie pulls."""
    return float(found.ties.tension[found.ties.names.index(tie)])


def pull(name: str, at: tuple[float, float], to: tuple[float, float]) -> Tie:
    return Tie(name, "bar", at, "", to, stiffness=1e6)


def balance() -> tuple[float, float]:
    """Return the third mass [g] of the torque balance, and the force [N] of its support."""
    down = [Load("point", (0.0, -1e-3 * m * G), bodies=("bar",), at=(x, 0.02)) for x, m in ((0.0, 50.0), (0.3, 75.0))]
    found = lever(
        [(0, 0), (1.0, 0), (1.0, 0.02), (0, 0.02)], 0.150 * G, knife("support", (0.7, 0.0), (0.0, 1.0)),
        (pull("third", (1.0, 0.0), (1.0, -5.0)),), tuple(down),
    )  # fmt: skip
    return 1e3 * tension(found, "third") / G, float(found.reactions["support"][1])


def forearm() -> tuple[float, float]:
    """Return the pull of the muscle and the force of the elbow [lb]; lengths in inches."""
    weight = Load("point", (0.0, -50.0), bodies=("bar",), at=(13.0, 0.0))
    found = lever(
        [(-1.0, 0), (14.0, 0), (14.0, 1.0), (-1.0, 1.0)], 1e-9, knife("elbow", (0.0, 1.0), (0.0, -1.0)),
        (pull("muscle", (1.5, 1.0), (1.5, 12.0)),), (weight,),
    )  # fmt: skip
    return tension(found, "muscle"), -float(found.reactions["elbow"][1])


def door() -> tuple[float, float]:
    """Return the horizontal forces [N] of the upper and the lower hinge; the upper one carries the weight."""
    found = lever(
        [(0, -0.5), (1.0, -0.5), (1.0, 2.5), (0, 2.5)], 400.0, knife("lower", (0.0, 0.0), (1.0, 0.0)),
        (pull("weight", (0.0, 2.0), (0.0, 9.0)), pull("upper", (0.0, 2.0), (-5.0, 2.0))),
    )  # fmt: skip
    return tension(found, "upper"), abs(float(found.reactions["lower"][0]))


def wedge(dead: float, live: float) -> Model:
    """A block of 10 lb against a smooth wall, on a wedge of 25 degrees that forces [lb] push under it."""
    t = float(np.tan(np.radians(25.0)))
    slope = [(0.3, 0.2 + 1.2 * t), (1.2, 0.2 + 0.3 * t)]
    block = Body("block", [*slope, (1.2, 2.0), (0.3, 2.0)], kind="rigid")
    area = 0.9 * (2.0 - 0.5 * (slope[0][1] + slope[1][1]))
    under = Body("wedge", [(0, 0), (1.5, 0), (1.5, 0.2), (0, 0.2 + 1.5 * t)], kind="rigid", material="none")
    wall = Body("wall", [(1.2, 1.0), (2.0, 1.0), (2.0, 2.5), (1.2, 2.5)], kind="fixed")
    at = (0.0, 0.1)
    loads = [Load("weight", (0.0, -1.0)), Load("point", (live, 0.0), bodies=("wedge",), at=at, group="live")]
    loads += [Load("point", (dead, 0.0), bodies=("wedge",), at=at)] if dead else []
    return Model(
        (Body("floor", FLOOR, kind="fixed"), wall, under, block),
        {"block": Rigid(unit_weight=10.0 / area), "none": Rigid(unit_weight=0.0)},
        {"rough": JointLaw(0.2), "smooth": JointLaw(0.0)},
        rules=(JointRule("rough", ("*", "*")), JointRule("smooth", ("wall", "block"))), loads=tuple(loads),
    )  # fmt: skip


def rows() -> list[Row]:
    found: list[Row] = []

    def add(name: str, printed: float, computed: float, last: float, unit: str, reason: str = LAST) -> None:
        found.append(Row(name, printed, computed, digits(printed, last), reason, unit, check="published"))

    add("crate of 20 kg, friction 0.7: normal force", 196.0, held(20.0, 0.7, 20.0)[1], 1.0, "N")
    add("crate of 20 kg: largest static friction", 137.0, most(20.0, 0.7), 1.0, "N")
    for push in (20.0, 30.0, 120.0):
        add(f"crate of 20 kg: friction under a push of {push:g} N", push, held(20.0, 0.7, push)[0], 0.1, "N")
    slides = acceleration(20.0, 0.6, 180.0)
    add("crate of 20 kg, friction 0.6: friction while it slides", 118.0, 180.0 - 20.0 * slides, 1.0, "N")
    add("crate of 20 kg, pushed with 180 N: acceleration", 3.10, slides, 0.05, "m/s2",
        "the book takes the difference of forces of three digits")  # fmt: skip
    add("block of 1 kg, friction 0.5: least push that moves it", 4.9, most(1.0, 0.5), 0.1, "N")
    add("block of 1 kg, friction 0.4, under that push: acceleration", 0.98, acceleration(1.0, 0.4, 4.9), 0.01, "m/s2")
    add("crate of 50 kg on a truck at 2 m/s2: friction", 100.0, held(50.0, 0.4, 100.0)[0], 1.0, "N")
    add("crate of 50 kg on a truck: normal force", 490.0, held(50.0, 0.4, 100.0)[1], 1.0, "N")
    add("crate of 50 kg, friction 0.4: largest static friction", 196.0, most(50.0, 0.4), 1.0, "N")
    back = acceleration(50.0, 0.3, 250.0)
    add("crate of 50 kg on a truck at 5 m/s2, friction 0.3: friction", 147.0, 250.0 - 50.0 * back, 1.0, "N")
    add("the same: acceleration relative to the ground", 2.94, 5.0 - back, 0.01, "m/s2")
    add("the same: acceleration relative to the truck", 2.06, back, 0.01, "m/s2")
    add("snowboard on 13 degrees, friction 0.2: acceleration", 0.29, acceleration(60.0, 0.2, slope=13.0), 0.02, "m/s2",
        "the book rounds 0.295 down")  # fmt: skip
    add("skier of 60 kg on 25 degrees, no friction: acceleration", 4.14, acceleration(60.0, 0.0, slope=25.0), 0.01,
        "m/s2")  # fmt: skip
    slowed = acceleration(60.0, 0.0, push=-45.0, slope=25.0)
    add("skier of 60 kg on 25 degrees, held back by 45 N: acceleration", 3.39, slowed, 0.01, "m/s2")
    skier = 62.0 * (G * float(np.sin(np.radians(25.0))) - acceleration(62.0, 0.082, slope=25.0))
    add("skier of 62 kg on 25 degrees, friction 0.082: friction", 45.0, skier, 0.6, "N",
        "two digits of the coefficient")  # fmt: skip
    string, pressed, pulled = sliding_blocks()
    add("sliding blocks: tension of the string", 7.84, string, 0.01, "N")
    add("sliding blocks: force on the floor", 58.8, pressed, 0.1, "N")
    add("sliding blocks: pull at constant speed", 39.2, pulled, 0.1, "N")
    normal, friction, wall, least = ladder()
    add("ladder: normal force of the floor", 400.0, normal, 0.1, "N")
    add("ladder: friction of the floor", 150.7, friction, 0.1, "N")
    add("ladder: force of the wall", 150.7, wall, 0.1, "N")
    add("ladder: coefficient of friction", 0.377, least, 0.001, "-")
    add("ladder: force of the floor", 427.4, float(np.hypot(normal, friction)), 0.2, "N",
        "the book adds rounded forces")  # fmt: skip
    add("ladder: its direction above the floor", 69.3, float(np.degrees(np.arctan2(normal, friction))), 0.2, "degrees",
        "the book rounds 69.35 down")  # fmt: skip
    upper, lower = door()
    add("door: horizontal force of the upper hinge", 100.0, upper, 0.1, "N")
    add("door: horizontal force of the lower hinge", 100.0, lower, 0.1, "N")
    third, support = balance()
    add("torque balance: third mass", 317.0, third, 1.0, "g")
    add("torque balance: force of the support", 5.8, support, 0.1, "N")
    muscle, elbow = forearm()
    add("forearm: pull of the muscle", 433.3, muscle, 0.1, "lb")
    add("forearm: force of the elbow", 383.3, elbow, 0.1, "lb")
    add("wedge: push that raises the block", 9.35, 5.0 + carried(wedge(5.0, 1.0)), 0.01, "lb")
    add("wedge: least push that holds it", 0.436, 5.0 - carried(wedge(5.0, -1.0)), 0.001, "lb")
    resting = float(concio.solve(wedge(5.0, 1.0), factors={"live": 0.0}).reactions["floor"][1])
    add("wedge: normal force of the floor", 10.0, resting, 0.1, "lb")
    return found
