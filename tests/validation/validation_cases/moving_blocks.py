r"""Flight, sliding, bouncing, and structures pushed over.

* Sliding under a rectangular pulse A g of length T: :math:`(AgT)^2/(2 \mu g)\,(1 - \mu/A)` (Newmark); from a
  velocity v: :math:`v^2/(2\mu g)`; down an incline: :math:`\tfrac12 g (\sin\beta - \mu\cos\beta)\, t^2`.
* A block that falls from h on its flat foot with restitution e comes to rest after infinitely many impacts at
  :math:`\sqrt{2h/g}\,(1 + e)/(1 - e)`, having travelled :math:`h (1 + e^2)/(1 - e^2)`: a scheme of steps must end.
* In flight nothing but weight acts: momentum, angular momentum and energy are those of the throw.
* A disc thrown at v slides until it rolls, at 2/3 v (angular momentum about a point of the ground): a polygon of 240
  sides, which loses a little at each.
* Painleve's rod, sliding on its tip at tan q = 2 with friction 2, has no acceleration under rigid Coulomb friction, or
  two; the time-stepping scheme has impulses in every step.
* A pillar pushed over: :math:`\lambda = \tan(\arctan(b/h) - \theta)`, zero where its centroid stands above its toe.
* Arches under a horizontal share of their weight: four hinges; the multiplier by the static theorem on the arch as
  described, which the followed curve approaches from below as its first displacement vanishes.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import concio
from validation_cases.rocking_block import G, model, rectangle
from validation_cases.row import Row

SOURCE = (
    "N. M. Newmark, Geotechnique 15 (1965) 139-160; P. Painleve, C. R. Acad. Sci. 121 (1895); I. J. Oppenheim,"
    " Earthquake Eng. Struct. Dyn. 21 (1992) 1005-1017 for the arch; elementary mechanics for the rest."
)
SCHEME = "error of the scheme at this step"
WIDTH = 0.4


def low(friction: float = 0.3, height: float = 0.0) -> concio.Model:
    return model(concio.Body("block", rectangle(0.0, height, WIDTH, 0.4), kind="rigid"), friction=friction)


def newmark(base: str) -> float:
    pulse = concio.Pulse("rectangular", 0.5 * G, 0.3)
    found = concio.dynamics(low(0.2), pulse, 1.2, 1e-3, gravity=G, base=base)
    ground = float(pulse.displacement(np.array(1.2))) if base == "moving" else 0.0
    start = found.shots.centre[0, 1, 0]
    return float(ground + start - found.end.centre[1, 0])


def stopped() -> float:
    found = concio.dynamics(low(), duration=1.0, step=1e-3, gravity=G, velocities={"block": (2.0, 0.0)})
    return float(found.end.centre[1, 0] - found.shots.centre[0, 1, 0])


def incline() -> float:
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turn = np.array([[c, s], [-s, c]])
    plain = low()
    bodies = tuple(
        concio.Body(b.name, b.outline @ turn, material="block", kind=b.kind) for b in plain.outlines
    )  # fmt: skip
    leaning = concio.Model(bodies, plain.materials, plain.laws, loads=plain.loads)
    found = concio.dynamics(leaning, duration=1.0, step=1e-3, gravity=G, start="as described")
    return float(np.linalg.norm(found.end.centre[1] - found.shots.centre[0, 1]))


@cache
def bouncing() -> tuple[float, float, float]:
    """Time at rest, path, and energy error of a block dropped from 1 m with restitution 0.8."""
    step = 1e-3
    found = concio.dynamics(
        low(height=1.0), duration=4.6, step=step, gravity=G, restitution=0.8, every=step, start="as described",
        adaptive=False,
    )  # fmt: skip
    z = found.shots.centre[:, 1, 1] - 0.2
    last = float(found.shots.time[np.flatnonzero(np.abs(np.diff(z)) > 1e-5 * step)[-1]])
    return last, float(np.abs(np.diff(z)).sum()), found.energy.error


def flight() -> tuple[float, float, float]:
    """Largest relative errors of momentum, angular momentum and energy of a box thrown spinning for a second."""
    found = concio.dynamics(
        low(height=20.0), duration=1.0, step=1e-2, gravity=G, velocities={"block": (1.5, 2.0, 30.0)}, every=1e-2
    )
    t, end = found.end.time, found.end
    thrown = np.array([1.5, 2.0 - G * t])
    return (
        float(np.abs(end.velocity[1] - thrown).max() / np.abs(thrown).max()), float(abs(end.spin[1] / 30.0 - 1)),
        found.energy.error,
    )  # fmt: skip


def rolling(sides: int) -> tuple[float, float]:
    """Velocity of a polygon of many sides when it rolls, and its energy error; thrown at 3 m/s, friction 0.2."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides - np.pi / 2
    radius = 0.5
    disc = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    disc[:, 1] -= disc[:, 1].min()
    found = concio.dynamics(
        model(concio.Body("disc", disc, kind="rigid"), friction=0.2), duration=0.6, step=1e-3, gravity=G,
        start="as described", velocities={"disc": (3.0, 0.0, 0.0)}, stop_overturned=False,
    )  # fmt: skip
    return float(found.end.velocity[1, 0]), found.energy.error


def painleve(direction: float) -> concio.DynamicsResult:
    q, thick = np.arctan(2.0), 1e-2  # no step passes more than the thickness
    c, s = np.cos(q), np.sin(q)
    outline = rectangle(0.0, -thick / 2, 1.0, thick) @ np.array([[c, s], [-s, c]])
    outline[:, 1] -= outline[:, 1].min()
    rod = model(concio.Body("rod", outline, kind="rigid"), friction=2.0)
    return concio.dynamics(
        rod, duration=0.2, step=1e-3, gravity=G, start="as described", velocities={"rod": (3.0 * direction, 0.0, 0.0)},
        stop_overturned=False,
    )  # fmt: skip


def arch(voussoirs: int, ring: float) -> tuple[float, float]:
    """Multiplier by the static theorem, and the peak of the followed curve, of a semicircular arch of radius 10."""
    options = {
        "span": 20.0 - ring, "ring": ring, "voussoirs": voussoirs, "edges": "straight", "friction": 1.5,
        "block": concio.Rigid(20.0),
    }  # fmt: skip
    bound = concio.limit(concio.arch(**options, horizontal=1.0), path=False, search=False)
    pushed = concio.push(concio.arch(**options), step=0.02)
    assert pushed.certified
    return bound.associated.multiplier, pushed.peak


def oppenheim() -> tuple[float, float]:
    """Multiplier by the static theorem, and the peak of the followed curve, of Oppenheim's arch of seven voussoirs."""
    half = np.deg2rad(157.5) / 2
    options = {
        "span": 2 * 9.25 * np.sin(half), "rise": 9.25 * (1 - np.cos(half)), "ring": 1.5, "voussoirs": 7,
        "shape": "segmental", "edges": "straight", "friction": 1.5, "block": concio.Rigid(20.0),
    }  # fmt: skip
    bound = concio.limit(concio.arch(**options, horizontal=1.0), path=False, search=False)
    pushed = concio.push(concio.arch(**options), step=0.05, until=0.2)
    return bound.associated.multiplier, pushed.peak


@cache
def rows() -> list[Row]:
    newmark_exact = (0.5 * G * 0.3) ** 2 / (2 * 0.2 * G) * (1 - 0.2 / 0.5)
    found = [
        Row("rectangular pulse, ground as inertia", newmark_exact, newmark("inertia"), 1e-4, SCHEME, "m"),
        Row("rectangular pulse, base that moves", newmark_exact, newmark("moving"), 1e-4, SCHEME, "m"),
        Row("thrown at 2 m/s: stops after", 4 / (2 * 0.3 * G), stopped(), 1e-4, SCHEME, "m"),
        Row("down 30 degrees for a second", 0.5 * G * (0.5 - 0.3 * np.cos(np.pi / 6)), incline(), 1e-4, SCHEME, "m"),
    ]
    for word, off in zip(("momentum", "angular momentum", "energy"), flight(), strict=True):
        found.append(Row(f"spinning box in flight: {word}, relative error", 0.0, off, 1e-12, "rounding"))
    rolls, error = rolling(240)
    sides = "a polygon of 240 sides: each of its impacts takes something"
    found += [
        Row("disc thrown at 3 m/s: velocity when it rolls", 2.0, rolls, 0.02, sides, "m/s"),
        Row("disc: energy balance", 0.0, error, 1e-9, "rounding"),
    ]
    rest, path, error = bouncing()
    late = "each of the infinitely many impacts is felt up to a step late, and they shorten below a step"
    e = 0.8
    found += [
        Row("bouncing block: at rest", np.sqrt(2 / G) * (1 + e) / (1 - e), rest, 0.03, late, "s"),
        Row("bouncing block: path", (1 + e**2) / (1 - e**2), path, 0.03, late, "m"),
        Row("bouncing block: energy balance", 0.0, error, 1e-9, "rounding"),
    ]
    for direction, word in ((1.0, "into the tip"), (-1.0, "away from it")):
        rod = painleve(direction)
        good = rod.certified and bool(np.isfinite(rod.shots.centre).all()) and rod.energy.error < 1e-9
        found.append(
            Row(f"Painleve's rod, sliding {word}: every step certified, energy balanced", 1.0, float(good), 0.0,
                "yes or no", absolute=True)
        )  # fmt: skip
    pillar = concio.push(model(concio.Body("block", rectangle(0.0, 0.0, 0.2, 1.0), kind="rigid")), gravity=G)
    theta = -pillar.rotation_of("block")[1:]
    worst = float(np.abs(pillar.multiplier[1:] - np.tan(np.arctan(0.2) - theta)).max())
    hinge = "the hinge sinks by 1e-5 of the width"
    found += [
        Row("pillar pushed over: largest distance from the closed form", 0.0, worst, 1e-8, "rounding of equilibrium"),
        Row("pillar pushed over: displacement of its centroid at the end", 0.1, pillar.capacity, 1e-4, hinge, "m"),
    ]
    bound, peak = oppenheim()
    found += [
        Row("Oppenheim's arch, seven straight-edged voussoirs: onset by the static theorem", 0.37361, bound, 1e-4,
            "five digits of the reference"),
        Row("Oppenheim's arch: peak of the curve", 0.37361, peak, 5e-3, "hinges sink in, the first step is not zero"),
    ]
    for voussoirs, ring in ((20, 1.5), (20, 1.2)):
        bound, peak = arch(voussoirs, ring)
        found.append(
            Row(f"arch of {voussoirs} voussoirs, t/R {ring / 10:g}: peak of the curve", bound, peak, 5e-3,
                "the curve bends down from its beginning, and begins with a step that is not zero",
                check="second method")
        )  # fmt: skip
    return found
