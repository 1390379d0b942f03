r"""Least thickness of a hemispherical dome under its own weight, radial joints, friction 0.7.

The dome is divided into rings and lunes. Under its own weight all lunes move alike. One lune between two frictionless
vertical planes therefore represents the dome: a lune can push its neighbours, but not pull them. Each piece is rigid
and has the weight and the centroid of its part of the shell; the joints between rings are met at their two edges on the
middle plane of the lune, meridian faces at their four corners. The thickness at which forces in balance cease to exist
is bracketed by proofs on both sides. Domes with an oculus can be thinner. The literature gives 0.042 for the closed
hemisphere. Friction affects the closed hemisphere only below 0.25, but it determines the thickness of segmental domes,
which end above the horizontal. There the thrust crosses from one face to the other over a length of about t / mu. The
rings must resolve this length, so that thin domes need many rings.

The least horizontal thrust is the force that holds a springer on a smooth floor.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import scipy.sparse as sp

from concio.kinematics.frames import tangents
from concio.kinematics.rigid import rigid_operator
from concio.problem.contact_problem import ContactProblem, Laws
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.existence import statically_admissible
from validation_cases.row import Row

SOURCE = "computed independently beforehand by two programmes; J. Heyman, The Stone Skeleton (1995): about 0.042."


def lune(
    rings: int, lunes: int, ratio: float, mu: float = 0.7, oculus: float = 0.0, embrace: float = 90.0,
    *, freed: bool = False,
) -> ContactProblem:
    """One lune of a dome of mean radius 1, thickness ``ratio``, half-opening ``oculus`` [degrees] at the top.

    The dome reaches ``embrace`` degrees down from its top. ``freed`` puts a weightless springer, one more body, between
    its lowest joint and a smooth floor; nothing but a load can keep that from moving outward.
    """
    inner, outer, half = 1.0 - 0.5 * ratio, 1.0 + 0.5 * ratio, np.pi / lunes
    latitude = np.linspace(np.pi / 2 - np.radians(embrace), np.pi / 2 - np.radians(oculus), rings + 1)
    centres, weights = [], []
    for low, high in pairwise(latitude):
        rise = np.sin(high) - np.sin(low)
        spread = (outer**4 - inner**4) / 4 / ((outer**3 - inner**3) / 3) / rise
        flat = 0.5 * (high - low) + 0.25 * (np.sin(2 * high) - np.sin(2 * low))
        up = 0.5 * (np.sin(high) ** 2 - np.sin(low) ** 2)
        centres.append(spread * np.array([flat * np.sin(half) / half, 0.0, up]))
        weights.append((outer**3 - inner**3) / 3 * rise * 2 * half)
    normals, points, owners, friction = [], [], [], []
    for k, (low, high) in enumerate(pairwise(latitude)):
        for r in (inner, outer):
            points.append(r * np.array([np.cos(low), 0.0, np.sin(low)]))
            normals.append([-np.sin(low), 0.0, np.cos(low)])
            owners.append((k - 1 if k or not freed else rings, k))
            friction.append(mu)
        for side in (-1.0, 1.0):
            for r in (inner, outer):
                for angle in (low, high):
                    flat = r * np.cos(angle)
                    points.append(np.array([flat * np.cos(half), side * flat * np.sin(half), r * np.sin(angle)]))
                    normals.append([np.sin(half), -side * np.cos(half), 0.0])
                    owners.append((-1, k))
                    friction.append(0.0)
    if freed:
        low = latitude[0]
        centres.append(np.array([np.cos(low), 0.0, np.sin(low)]))
        weights.append(0.0)
        for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            points.append(centres[-1] + [x * ratio, y * ratio, 0.0])
            normals.append([0.0, 0.0, 1.0])
            owners.append((-1, rings))
            friction.append(0.0)
    m, frames = len(points), np.concatenate([np.array(normals)[:, None], tangents(np.array(normals))], axis=1)
    size = 6 * len(weights)
    C = np.zeros((m, 3, size))
    for i, (a, b) in enumerate(owners):
        for body, sign in ((a, -1.0), (b, 1.0)):
            if body >= 0:
                C[i, :, 6 * body : 6 * body + 6] += sign * frames[i] @ rigid_operator(points[i] - centres[body], 1.0)
    f = np.zeros(size)
    f[2::6] = -np.array(weights) / sum(weights)
    laws = Laws.coulomb(0.0, m)
    return ContactProblem(
        K=sp.csr_array((size, size)), f=f, C_n=sp.csr_array(C[:, 0]),
        C_t=sp.csr_array(C[:, 1:].reshape(2 * m, -1)), gap=np.zeros(m),
        laws=type(laws)(**{**laws.__dict__, "friction": np.array(friction)}),
        R=sp.csc_array(sp.eye_array(size)), bodies=np.arange(0, size + 1, 6),
    )  # fmt: skip


@cache
def stands(rings: int, lunes: int, ratio: float, mu: float, oculus: float = 0.0, embrace: float = 90.0) -> bool | None:
    """Whether forces in balance exist; None where neither yes nor no is proven."""
    state = statically_admissible(lune(rings, lunes, ratio, mu, oculus, embrace))
    return state.exists if state.decided else None


@cache
def least(
    rings: int, lunes: int, mu: float = 0.7, oculus: float = 0.0, embrace: float = 90.0, about: float = 0.04,
    tolerance: float = 1e-6,
) -> float:
    """Least thickness over the mean radius, bracketed by proofs; nan where an end of the bracket is none."""
    low, high = about / 1.6, about * 1.2
    ends = [stands(rings, lunes, ratio, mu, oculus, embrace) for ratio in (low, high)]
    if ends != [False, True]:
        return float("nan")
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        held = stands(rings, lunes, middle, mu, oculus, embrace)
        if held is None:
            return float("nan")
        low, high = (low, middle) if held else (middle, high)
    return high


@cache
def least_thrust(rings: int, lunes: int, ratio: float, mu: float = 0.7) -> float:
    """Least horizontal thrust at the springing over the weight."""
    problem = lune(rings, lunes, ratio, mu, freed=True)
    inward = np.zeros(problem.unknowns)
    inward[-6] = -1.0  # the weight of the lune is 1
    found = associated_limit(problem.with_loads(problem.f + inward), -inward)
    return 1.0 - found.multiplier if found.checked else float("nan")


def answer(proven: bool | None) -> float:
    """1 for yes, 0 for no, nan for neither."""
    return float("nan") if proven is None else float(proven)


def rows() -> list[Row]:
    cases = ((8, 16, 0.041966), (60, 360, 0.042812))
    found = [
        Row(f"{rings} rings, {lunes} lunes", value, least(rings, lunes), 5e-5, "bisected to 1e-6",
            check="second method")
        for rings, lunes, value in cases
    ]  # fmt: skip
    found.append(
        Row("limit of small pieces", 0.04284, least(60, 360), 1e-3, "60 rings instead of a limit",
            check="second method")
    )  # fmt: skip
    found += [
        Row(f"friction {mu:g}", value, least(60, 360, mu, about=value, tolerance=2e-5), 1e-3,
            "60 rings instead of a limit", check="second method")
        for mu, value in ((0.22, 0.06639), (0.20, 0.0925))
    ]  # fmt: skip
    found += [
        Row(f"oculus of half-opening {angle} degrees", value, least(60, 360, 0.7, angle, tolerance=2e-5), 2e-3,
            "60 rings instead of a limit", check="second method")
        for angle, value in ((10, 0.04061), (20, 0.03497), (30, 0.02774))
    ]  # fmt: skip
    for embrace, mu, value, rings in (
        (65.0, 0.5, 0.00167, 240), (75.0, 0.5, 0.00923, 240), (80.0, 0.5, 0.01677, 240), (88.0, 0.5, 0.03624, 60),
        (90.0, 0.25, 0.04284, 60),
    ):  # fmt: skip
        found += [
            Row(f"half-embrace {embrace:g} degrees, friction {mu:g}, {share:g} times {value}: stands", holds,
                answer(stands(rings, 360, share * value, mu, 0.0, embrace)), 0.0, "yes or no", check="second method")
            for share, holds in ((1.015, 1.0), (0.985, 0.0))
        ]  # fmt: skip
    found += [
        Row(f"least thrust over weight, thickness {ratio:g}", value, least_thrust(60, 360, ratio), 5e-4,
            "60 rings instead of a limit", check="second method")
        for ratio, value in ((0.05, 0.23390), (0.10, 0.19460), (0.20, 0.13202))
    ]  # fmt: skip
    return found
