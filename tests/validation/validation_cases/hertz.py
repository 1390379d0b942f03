r"""A cylinder of elastic material on a rigid flat base, without friction, plane strain.

Hertz: half-width a = sqrt(4 P R / (pi E*)), largest pressure p0 = 2 P / (pi a), E* = E / (1 - nu^2), P the force for
each unit of length. The body here is a block whose lower side is an arc of radius R, given as a polygon of chords,
twenty half-widths wide and high. Half-width and pressure are taken from moments of the contact forces, which converge
smoothly: sum t_n x^2 = P a^2 / 4, and sum t_n^2 / length = 8/(3 pi) p0 P.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = (
    "H. Hertz, Über die Berührung fester elastischer Körper, J. reine angew. Math. 92 (1882); K. L. Johnson, "
    "Contact Mechanics (1985), ch. 4."
)

RADIUS, MODULUS, NU, HALF_WIDTH, SIDE = 10.0, 1e6, 0.2, 0.05, 0.5
STAR = MODULUS / (1 - NU**2)


def force(a: float) -> float:
    """P [kN/m] that gives half-width a."""
    return np.pi * a**2 * STAR / (4 * RADIUS)


@cache
def pressed(chords: int, share: float = 1.0) -> concio.Result:
    """Contact with ``chords`` chords on the expected half-width, under ``share`` of the force."""
    inner = np.linspace(0.0, 1.6 * HALF_WIDTH, round(1.6 * chords) + 1)
    step = step0 = inner[1]
    outer = [inner[-1]]
    while outer[-1] + 1.3 * step < SIDE:
        step *= 1.3
        outer.append(outer[-1] + step)
    outer[-1] = SIDE
    half = np.concatenate([inner, outer[1:]])
    x = np.concatenate([-half[:0:-1], half])
    arc = np.column_stack([x, RADIUS - np.sqrt(RADIUS**2 - x**2)])
    top, rise = 2 * SIDE, [arc[-1, 1] + step0 / 2]
    while rise[-1] < 0.75 * top:
        rise.append(rise[-1] + min(1.3 * (rise[-1] - ([arc[-1, 1], *rise][-2])), 0.15 * top))
    side = np.column_stack([np.full(len(rise), SIDE), rise])
    outline = np.vstack([arc, side, [[SIDE, top], [-SIDE, top]], side[::-1] * [-1, 1]])
    model = concio.Model(
        bodies=(
            concio.Body("base", np.array([[-SIDE, -0.2], [SIDE, -0.2], [SIDE, 0.0], [-SIDE, 0.0]]), kind="fixed"),
            concio.Body("cylinder", outline, mesh_size=0.12),
        ),
        materials={"block": concio.Elastic(E=MODULUS, nu=NU)},
        laws={"joint": concio.JointLaw(friction=0.0)},
        loads=(concio.Load("pressure", (share * force(HALF_WIDTH) / (2 * SIDE),), edge=((-SIDE, top), (SIDE, top))),),
        supports=(concio.Support("axis", "cylinder", edge=((0.0, 0.0), (0.0, 0.0)), directions="x"),),
        plane="strain",
        element="Q4",
        gap_reach=0.05,
    )
    return concio.solve(model)


def half_width(result: concio.Result) -> float:
    """Half-width from the second moment of the contact forces [m]."""
    t, x = result.contacts.normal_force, result.contacts.point[:, 0]
    return 2 * float(np.sqrt((t * x**2).sum() / t.sum()))


def peak_pressure(result: concio.Result) -> float:
    """Largest pressure from the sum of squares of the contact forces [kN/m2]."""
    x, t = gathered(result)
    length = np.gradient(x)
    return 3 * np.pi / 8 * float((t**2 / length).sum() / t.sum())


def gathered(result: concio.Result) -> tuple[np.ndarray, np.ndarray]:
    """Positions and forces of the contact, the two pairs at a vertex of the polygon put together."""
    x = np.round(result.contacts.point[:, 0], 6)
    at, back = np.unique(x, return_inverse=True)
    return at, np.bincount(back, weights=result.contacts.normal_force)


def rows() -> list[Row]:
    P = force(HALF_WIDTH)
    finest = pressed(16)
    found = [
        Row("force on the base", P, finest.reactions["base"][1], 1e-9, "equilibrium", "kN/m"),
        Row(
            "half-width",
            HALF_WIDTH,
            half_width(finest),
            0.01,
            "block of finite size and chords: 1 % at a tenth of the block's half-width",
            "m",
        ),
    ]
    found.append(
        Row("largest pressure", 2 * P / (np.pi * HALF_WIDTH), peak_pressure(finest), 0.01, "as the half-width", "kN/m2")
    )
    small = pressed(16, 0.25)
    found.append(
        Row(
            "half-width at a quarter of the force, over half-width",
            0.5,
            half_width(small) / half_width(finest),
            0.015,
            "a grows with the root of the force; 8 chords on the smaller half-width",
        )
    )
    return found


def figure(axes: Any) -> None:
    result = pressed(16)
    x, t = gathered(result)
    p0 = 2 * force(HALF_WIDTH) / (np.pi * HALF_WIDTH)
    s = np.linspace(-1, 1, 200)
    axes.plot(s, np.sqrt(1 - s**2), "k-", lw=1, label="Hertz")
    axes.plot(x / HALF_WIDTH, t / np.gradient(x) / p0, "o", ms=3, label="concio")
    axes.set(xlim=(-1.6, 1.6), xlabel="x / a", ylabel="pressure / p0")
    axes.legend()
