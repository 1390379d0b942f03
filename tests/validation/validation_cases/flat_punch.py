r"""A rigid flat punch without friction on an elastic half-plane, plane strain.

Pressure p(x) = P / (pi sqrt(a^2 - x^2)), infinite at the edges; integrated quantities stay finite: half of the force is
carried within |x| < a / sqrt(2), and sum t_n x^2 = P a^2 / 2. The half-plane is a block sixty half-widths wide and
thirty high on rollers. A tilted punch, loaded at eccentricity e < a / 2, has the resultant at e.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import concio
from validation_cases.row import Row

SOURCE = (
    "M. A. Sadowsky, Zweidimensionale Probleme der Elastizitätstheorie, ZAMM 8 (1928); K. L. Johnson, Contact "
    "Mechanics (1985), section 2.8."
)

A, WIDTH, DEPTH, FORCE = 0.1, 3.0, 3.0, 100.0


@cache
def pressed(elements: int, eccentricity: float = 0.0) -> concio.Result:
    """Punch over ``elements`` elements of equal size on its half-width."""
    xs = graded(A, elements, WIDTH)
    ys = -graded(A / elements, 1, DEPTH)[graded(A / elements, 1, DEPTH) >= 0][::-1]
    half = concio.Body("half-plane", box(-WIDTH, WIDTH, -DEPTH, 0.0), grid=(xs, ys))
    punch = concio.Body("punch", box(-A, A, 0.0, 0.1), "punch", "rigid")
    model = concio.Model(
        bodies=(half, punch),
        materials={"block": concio.Elastic(E=1e6, nu=0.3), "punch": concio.Rigid()},
        laws={"joint": concio.JointLaw(friction=0.0)},
        loads=(concio.Load("point", (0.0, -FORCE), bodies=("punch",), at=(eccentricity, 0.1)),),
        supports=(
            concio.Support("rollers", "half-plane", edge=((-WIDTH, -DEPTH), (WIDTH, -DEPTH)), directions="y"),
            concio.Support("pin", "half-plane", edge=((0.0, -DEPTH), (0.0, -DEPTH)), directions="x"),
            concio.Support("guide", "punch", edge=((0.0, 0.1), (0.0, 0.1)), directions="x"),
        ),
        plane="strain",
    )
    return concio.solve(model)


def graded(inner: float, count: int, outer: float, growth: float = 1.25) -> np.ndarray:
    """Symmetric grid lines: equal parts to ``inner``, then growing to ``outer``."""
    lines = list(np.linspace(0.0, inner, count + 1))
    step = lines[1]
    while lines[-1] + growth * step < outer:
        step *= growth
        lines.append(lines[-1] + step)
    if outer - lines[-1] < 0.6 * step:
        lines[-1] = outer
    else:
        lines.append(outer)
    half = np.array(lines)
    return np.concatenate([-half[:0:-1], half])


def box(x0: float, x1: float, y0: float, y1: float) -> np.ndarray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def second_moment(result: concio.Result) -> float:
    """Sum t_n x^2 over P a^2 / 2."""
    t, x = result.contacts.normal_force, result.contacts.point[:, 0]
    return float((t * x**2).sum() / (FORCE * A**2 / 2))


def shares(result: concio.Result) -> tuple[np.ndarray, np.ndarray]:
    """Right ends x/a of the contact points' lengths, and the share of the force carried left of each."""
    t, x, length = result.contacts.normal_force, result.contacts.point[:, 0], result.contacts.pairs.length
    order = np.argsort(x)
    return (-A + np.cumsum(length[order])) / A, np.cumsum(t[order]) / t.sum()


def inner_share(result: concio.Result) -> float:
    """Share of the force within |x| < a / sqrt(2)."""
    x, share = shares(result)
    right, left = np.interp([np.sqrt(0.5), -np.sqrt(0.5)], x, share)
    return float(right - left)


def rows() -> list[Row]:
    tilted = pressed(16, 0.03)
    sizes = (16, 32)
    moments, parts = ([f(pressed(n)) for n in sizes] for f in (second_moment, inner_share))
    t, x = tilted.contacts.normal_force, tilted.contacts.point[:, 0]
    return [
        Row(
            "second moment over P a^2 / 2, extrapolated",
            1.0,
            2 * moments[1] - moments[0],
            0.003,
            "first order in element size; what is left after extrapolation from a/16 and a/32, and the block is finite",
        ),
        Row(
            "share of the force within a / sqrt 2, extrapolated",
            0.5,
            2 * parts[1] - parts[0],
            0.003,
            "as the second moment",
        ),
        Row(
            "order of the second moment",
            1.0,
            float(np.log2((moments[0] - 1) / (moments[1] - 1))),
            0.1,
            "strength 1/2 of the edge singularity: moments converge with the first power",
        ),
        Row("resultant of the tilted punch", 0.03, float((t * x).sum() / t.sum()), 1e-9, "equilibrium", "m"),
    ]


def figure(axes: Any) -> None:
    x, share = shares(pressed(32))
    s = np.linspace(-1, 1, 200)
    axes.plot(s, 0.5 + np.arcsin(s) / np.pi, "k-", lw=1, label="closed form")
    axes.plot(x, share, "o", ms=3, label="concio")
    axes.set(xlabel="x / a", ylabel="force left of x / P")
    axes.legend()
