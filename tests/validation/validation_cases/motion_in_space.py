r"""Rigid blocks that fly, spin, wobble, hit and rest in space.

* A brick with sides along its axes a, b, c that spins nearly about b: Euler's equations by elliptic functions give the
  period of its rates, the first zero of the rate about b, and a flip each half period.
* A heavy symmetric top with its tip held, leaning by t, with spin s about its axis: steady precession W is the smaller
  root of :math:`A W^2 \cos t - C s W + m g l = 0`, A and C about the tip.
* A column wobbling on its rim with its centroid at rest, leaning by t: :math:`W^2 = m g (a \cos t - h \sin t) / (\sin t
  (A \cos t - C (h/a) \sin t))`, :math:`A = m (a^2/4 + h^2/3)`, :math:`C = m a^2/2`. A rim of n corners loses something
  at each: the shortfall goes with 1/n, and what it tends to is the round column.
* A cube that hits a floor with a corner, its diagonal upright: with :math:`p_n = (1 + e) m v_n` the impulse of friction
  stops the corner, :math:`p_t = 2 m u / 11`, or is :math:`\mu p_n` against its velocity u. A spin about the diagonal
  stays.
* A rod that slides on its tip with friction 2 at tan q = 2 (Painleve), along a direction askew.
* A block pushed over: tan(atan(b/h) - theta) over an edge, and with sqrt(2) b over a corner.
* A stack of a hundred blocks and a wall at rest: nothing moves and nothing sinks.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

import concio
from concio.contact.reference import Reference
from validation_cases.row import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SOURCE = (
    "L. Euler, Mem. Acad. Sci. Berlin 14 (1758) 154-193; H. Goldstein, Classical Mechanics, 2nd ed. (1980), 5-7;"
    " P. Painleve, C. R. Acad. Sci. 121 (1895); elementary mechanics for the rest."
)
G = 9.81
PERIOD, FIRST_ZERO = 6.9980616997, 1.5664225246
"""Of the rates of the brick begun with (0.05, 5, 0.1) rad/s [s]."""
ORDER = "the scheme is of the second order: a fourth of the error for half the step"
ROUNDING = "rounding"


def model(*bodies: concio.Polyhedron, friction: float = 0.6, supports: tuple[concio.Support, ...] = (),
          weight: bool = True) -> concio.Model:  # fmt: skip
    floor = concio.Polyhedron.box("floor", (-5, -5, -0.5), (5, 5, 0), kind="fixed")
    return concio.Model(
        (floor, *bodies), {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(friction)}, supports=supports,
        loads=(concio.Load("weight", (0, 0, -1)),) if weight else (),
    )  # fmt: skip


def prism(name: str, ring: np.ndarray, low: float, high: float) -> concio.Polyhedron:
    """A prism over a ring (n, 2), anticlockwise."""
    n = len(ring)
    vertices = np.concatenate([np.column_stack([ring, np.full(n, z)]) for z in (low, high)])
    sides = [(i, (i + 1) % n, (i + 1) % n + n, i + n) for i in range(n)]
    faces = (tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *sides)
    return concio.Polyhedron(name, vertices, faces, kind="rigid")


def placed(body: concio.Polyhedron, turn: np.ndarray, low: float = 0.0) -> concio.Polyhedron:
    """A body turned, its lowest corner at a height."""
    vertices = body.vertices @ turn.T
    vertices[:, 2] += low - vertices[:, 2].min()
    return concio.Polyhedron(body.name, vertices, body.faces, kind="rigid")


def circle(n: int, radius: float) -> np.ndarray:
    angle = 2 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


@cache
def brick(step: float, duration: float) -> tuple[np.ndarray, float]:
    """Times at which the rate about the middle axis is zero, and the error of the energy."""
    body = concio.Polyhedron.box("brick", (-0.05, -0.1, 3.8), (0.05, 0.1, 4.2), kind="rigid")
    found = concio.dynamics(
        model(body, weight=False), duration=duration, step=step, gravity=G, start="as described", every=step,
        velocities={"brick": (0, 0, 0, 0.05, 5.0, 0.1)}, stop_overturned=False,
    )  # fmt: skip
    turns = np.array([r[1] for r in found.shots.rotation])
    steps = np.array([Rotation.from_matrix(b @ a.T).as_rotvec() for a, b in pairwise(turns)])
    middle = [Rotation.from_rotvec(0.5 * s).as_matrix() @ a for s, a in zip(steps, turns[:-1], strict=True)]
    rate = np.einsum("nij,ni->nj", np.array(middle), steps)[:, 1] / step
    k = np.flatnonzero(rate[:-1] * rate[1:] < 0)
    return step * (k + 0.5 + rate[k] / (rate[k] - rate[k + 1])), found.energy.error


@cache
def top(step: float) -> tuple[float, float, float]:
    """Precession and its closed form [rad/s], and how far the tilt changes [rad], of a pyramid on its tip."""
    lean, spin, n = np.deg2rad(30.0), 200.0, 8
    turn = Rotation.from_rotvec([0.0, lean, 0.0]).as_matrix()
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], np.column_stack([circle(n, 0.06), np.full(n, 0.06)])]) @ turn.T
    faces = (tuple(range(1, n + 1)), *((0, 1 + (i + 1) % n, 1 + i) for i in range(n)))
    body = concio.Polyhedron("top", vertices + np.array([0.0, 0.0, 1.0]), faces, kind="rigid")
    tip = ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    whole = model(body, supports=(concio.Support("tip", "top", edge=tip),))
    reference = Reference.of(whole, G)
    inertia = reference.mass[3:6] * reference.disc.reach[1] ** 2
    mass, axis = reference.body_mass[1], turn[:, 2]
    length = 0.045
    about, along = inertia.min() + mass * length**2, inertia.max()
    c = along * spin
    wanted = (c - np.sqrt(c**2 - 4 * about * np.cos(lean) * mass * G * length)) / (2 * about * np.cos(lean))
    rates = wanted * np.array([0, 0, 1]) + (spin - wanted * np.cos(lean)) * axis
    found = concio.dynamics(
        whole, duration=0.1, step=step, gravity=G, start="as described", stop_overturned=False,
        velocities={"top": (*np.cross(rates, length * axis), *rates)},
    )  # fmt: skip
    assert found.certified
    now = found.end.rotation[1] @ axis
    return float(np.arctan2(now[1], now[0]) / found.end.time), float(wanted), float(abs(np.arccos(now[2]) - lean))


RIM, HALF, LEAN = 0.25, 1.0, np.deg2rad(5.0)


@cache
def wobble(corners: int) -> tuple[float, float]:
    """Angle by which a column has turned its contact round in 0.1 s over that of the round one, and energy error."""
    turn = Rotation.from_rotvec([0.0, LEAN, 0.0]).as_matrix()
    body = placed(prism("column", circle(corners, RIM), -HALF, HALF), turn)
    about, along, c, s = RIM**2 / 4 + HALF**2 / 3, RIM**2 / 2, np.cos(LEAN), np.sin(LEAN)
    rate = np.sqrt(G * (RIM * c - HALF * s) / (s * (about * c - along * HALF / RIM * s)))
    spin = -(rate * s / RIM) * (RIM * turn[:, 0] - HALF * turn[:, 2])
    found = concio.dynamics(
        model(body), duration=0.1, step=1e-3, gravity=G, start="as described", stop_overturned=False,
        velocities={"column": (0, 0, 0, *spin)},
    )  # fmt: skip
    assert found.certified
    now = found.end.rotation[1] @ turn[:, 2]
    return float(np.arctan2(now[1], now[0]) / (rate * found.end.time)), found.energy.error


def corner(friction: float, restitution: float, velocity: tuple[float, ...]) -> float:
    """Largest difference of the velocities of a cube after it hit with a corner, over its velocity before."""
    way = Rotation.from_rotvec([0, 0, 0.3]) * Rotation.align_vectors([[0, 0, 1]], [np.ones(3) / np.sqrt(3)])[0]
    cube = concio.Polyhedron.box("cube", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1), kind="rigid")
    found = concio.dynamics(
        model(placed(cube, way.as_matrix(), 0.02), friction=friction, weight=False), duration=0.03, step=1e-3,
        gravity=G, restitution=restitution, start="as described", velocities={"cube": velocity}, stop_overturned=False,
    )  # fmt: skip
    assert found.certified
    v, w = np.array(velocity[:3]), np.array(velocity[3:] or (0, 0, 0), dtype=float)
    arm = np.array([0, 0, -np.sqrt(0.03)])
    mass = 20.0 * 0.008 / G
    inertia = mass * 0.2**2 / 6
    push = -(1 + restitution) * mass * v[2]
    held = -2.0 / 11.0 * mass * (v + np.cross(w, arm))[:2]
    held *= min(1.0, friction * push / float(np.linalg.norm(held)))
    impulse = np.array([*held, push])
    after = np.array([*(v + impulse / mass), *(w + np.cross(arm, impulse) / inertia)])
    seen = np.array([*found.end.velocity[1], *found.end.spin[1]])
    return float(np.abs(seen - after).max() / np.linalg.norm(v))


def painleve(sign: float) -> bool:
    """Whether every step of a rod that slides on its tip is certified and its energy balanced."""
    lean, askew = np.arctan(2.0), 0.7
    rod = concio.Polyhedron.box("rod", (0, -5e-3, -5e-3), (1, 5e-3, 5e-3), kind="rigid")
    turn = (Rotation.from_rotvec([0, 0, askew]) * Rotation.from_rotvec([0, -lean, 0])).as_matrix()
    found = concio.dynamics(
        model(placed(rod, turn), friction=2.0), duration=0.05, step=1e-3, gravity=G, start="as described",
        velocities={"rod": (3 * sign * np.cos(askew), 3 * sign * np.sin(askew), 0.0)}, stop_overturned=False,
    )  # fmt: skip
    return found.certified and bool(np.isfinite(found.shots.centre).all()) and found.energy.error < 1e-9


def pushed(half: float, direction: tuple[float, float], arm: float) -> tuple[float, float]:
    """Largest distance of a capacity curve from the closed form, and its end, of a block of two metres."""
    found = concio.push(
        model(concio.Polyhedron.box("b", (-half, -half, 0), (half, half, 2), kind="rigid")), direction=direction,
        gravity=G,
    )  # fmt: skip
    assert found.certified
    turned = np.linalg.norm(found.rotation_of("b"), axis=1)[1:]
    return float(np.abs(found.multiplier[1:] - np.tan(np.arctan(arm) - turned)).max()), found.capacity


def resting(whole: concio.Model, duration: float, step: float) -> tuple[float, float]:
    """How far anything has moved [m], and by how much the energy changes over weight times height of a block."""
    found = concio.dynamics(whole, duration=duration, step=step, stop_at_rest=False)
    assert found.certified
    assert found.stands
    weighs = float(found.reference.body_mass.sum()) * found.gravity
    return float(np.abs(found.shots.centre - found.shots.centre[0]).max()), float(np.ptp(found.energy.total)) / weighs


def stack(count: int) -> concio.Model:
    return model(*(concio.Polyhedron.box(f"b{k}", (-0.5, -0.4, 0.2 * k), (0.5, 0.4, 0.2 * k + 0.2), kind="rigid")
                   for k in range(count)))  # fmt: skip


def wall(courses: int, bricks: int) -> concio.Model:
    """A wall in running bond of bricks 0.2 by 0.1 by 0.1 m with halves at its ends."""
    bodies = []
    for c in range(courses):
        cuts = np.arange(bricks + 1) if c % 2 == 0 else np.array([0, *np.arange(0.5, bricks), bricks])
        for k, (a, b) in enumerate(pairwise(cuts)):
            low, high = (0.2 * a, 0.0, 0.1 * c), (0.2 * b, 0.1, 0.1 * c + 0.1)
            bodies.append(concio.Polyhedron.box(f"c{c}b{k}", low, high, kind="rigid"))
    return model(*bodies)


@cache
def rows() -> list[Row]:
    found = []
    errors = []
    for step in (4e-2, 2e-2):
        times, energy = brick(step, 9.0)
        errors.append(times[2] - times[0] - PERIOD)
    found += [
        Row("brick in flight: period of its rates, step 20 ms", PERIOD, PERIOD + errors[1], 3e-4, ORDER, "s"),
        Row("brick in flight: first zero, step 20 ms", FIRST_ZERO, brick(2e-2, 9.0)[0][0], 3e-4, ORDER, "s"),
        Row("brick in flight: error at 40 ms over that at 20 ms", 4.0, errors[0] / errors[1], 0.1, ORDER),
        Row("brick in flight: energy", 0.0, energy, 1e-12, ROUNDING),
        Row("brick in flight: flips in 100 s", 1 + int((100.0 - FIRST_ZERO) / (0.5 * PERIOD)),
            len(brick(4e-2, 100.0)[0]), 0.0, "a number of flips"),
    ]  # fmt: skip
    slow, wanted, _ = top(2e-3)
    fine, _, fine_tilt = top(1e-3)
    found += [
        Row("top of eight sides: precession, step 1 ms", wanted, fine, 1e-2, ORDER, "rad/s"),
        Row("top: precession at 2 ms and 1 ms, extrapolated", wanted, fine + (fine - slow) / 3, 5e-3, ORDER, "rad/s"),
        Row("top: tilt, step 1 ms", np.deg2rad(30.0), np.deg2rad(30.0) + fine_tilt, 1e-3, ORDER, "rad"),
    ]
    near, far = wobble(48), wobble(24)
    lost = "each of its corners is an impact: the shortfall goes with 1 over their number"
    found += [
        Row("wobbling column of 48 corners: turn of its contact over the round one's", 1.0, near[0], 0.02, lost),
        Row("wobbling column of 24 corners", 1.0, far[0], 0.04, lost),
        Row("wobbling column: extrapolated to a round one", 1.0, 2 * near[0] - far[0], 5e-3, lost),
        Row("wobbling column: energy balance", 0.0, max(near[1], far[1]), 1e-10, ROUNDING),
    ]
    for word, values in (
        ("sticks, e = 0", (0.3, 0.0, (0.5, 0.3, -1.5))),
        ("slips, e = 0.5", (0.3, 0.5, (2.5, -1.3, -1.5))),
        ("slips and spins, e = 0.8", (0.2, 0.8, (1.5, 2.0, -1.0, 0.0, 0.0, 4.0))),
    ):
        off = corner(*values)
        found.append(Row(f"cube that hits with a corner, {word}: velocities after", 0.0, off, 1e-5,
                         "the compliance added to the joint is taken back to this"))
    for sign, word in ((1.0, "into the tip"), (-1.0, "away from it")):
        found.append(
            Row(f"Painleve's rod askew, sliding {word}: every step certified, energy balanced", 1.0,
                float(painleve(sign)), 0.0, "yes or no", absolute=True)
        )  # fmt: skip
    equal = "rounding of equilibrium"
    for word, direction, arm in (("edge", (1.0, 0.0), 0.2), ("corner", (1.0, 1.0), 0.2 * np.sqrt(2.0))):
        off, end = pushed(0.2, direction, arm)
        found += [
            Row(f"block pushed over its {word}: largest distance from the closed form", 0.0, off, 1e-8, equal),
            Row(f"block pushed over its {word}: displacement at the end", arm, end, 1e-6, equal, "m"),
        ]
    for word, whole, duration in (("stack of 100 blocks", stack(100), 10.0), ("wall of 68 bricks", wall(8, 8), 1.0)):
        moved, energy = resting(whole, duration, 1e-2)
        found += [
            Row(f"{word} at rest for {duration:g} s: moves", 0.0, moved, 1e-9, ROUNDING, "m"),
            Row(f"{word}: energy over weight", 0.0, energy, 1e-9, ROUNDING, "m"),
        ]
    return found


def figure(axes: Axes) -> None:
    """Draw what a wobbling column of n corners falls short of the round one."""
    corners = np.array([12, 24, 48])
    short = [1.0 - wobble(int(n))[0] for n in corners]
    axes.loglog(corners, short, "ko-", lw=1.0, ms=4)
    axes.loglog(corners, short[-1] * corners[-1] / corners, "k:", lw=0.8, label="1 / n")
    axes.set(xlabel="corners of the rim", ylabel="shortfall of the turn [-]", title="Wobbling column of n corners")
    axes.legend(frameon=False)
