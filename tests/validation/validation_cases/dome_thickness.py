r"""Least thickness of a hemispherical dome under its own weight, radial joints, friction 0.7.

A dome of so many rings and lunes; under its own weight all lunes move alike, so that one lune between two frictionless
vertical planes stands for it: a lune can push its neighbours, not pull them. Each piece is rigid and has the weight and
the centroid of its part of the shell; the joints between rings are met at their two edges on the middle plane of the
lune, meridian faces at their four corners. The thickness at which forces in balance cease to exist is bracketed by
proofs on both sides. With an oculus the hoop that closes it is missing below less and less of the dome, and thinner
domes stand. The literature has 0.042 for the closed hemisphere.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import scipy.sparse as sp

from concio.kinematics.frames import tangents
from concio.kinematics.rigid import rigid_operator
from concio.problem.contact_problem import ContactProblem, Laws
from concio.solvers.statics.existence import statically_admissible
from validation_cases.row import Row

SOURCE = "computed independently beforehand by two programmes; J. Heyman, The Stone Skeleton (1995): about 0.042."


def lune(rings: int, lunes: int, ratio: float, mu: float = 0.7, oculus: float = 0.0) -> ContactProblem:
    """One lune of a hemisphere of mean radius 1, thickness ``ratio``, half-opening ``oculus`` [degrees] at the top."""
    inner, outer, half = 1.0 - 0.5 * ratio, 1.0 + 0.5 * ratio, np.pi / lunes
    latitude = np.linspace(0.0, np.pi / 2 - np.radians(oculus), rings + 1)
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
            owners.append((k - 1, k))
            friction.append(mu)
        for side in (-1.0, 1.0):
            for r in (inner, outer):
                for angle in (low, high):
                    flat = r * np.cos(angle)
                    points.append(np.array([flat * np.cos(half), side * flat * np.sin(half), r * np.sin(angle)]))
                    normals.append([np.sin(half), -side * np.cos(half), 0.0])
                    owners.append((-1, k))
                    friction.append(0.0)
    m, frames = len(points), np.concatenate([np.array(normals)[:, None], tangents(np.array(normals))], axis=1)
    C = np.zeros((m, 3, 6 * rings))
    for i, (a, b) in enumerate(owners):
        for body, sign in ((a, -1.0), (b, 1.0)):
            if body >= 0:
                C[i, :, 6 * body : 6 * body + 6] += sign * frames[i] @ rigid_operator(points[i] - centres[body], 1.0)
    f = np.zeros(6 * rings)
    f[2::6] = -np.array(weights) / sum(weights)
    laws = Laws.coulomb(0.0, m)
    return ContactProblem(
        K=sp.csr_array((6 * rings, 6 * rings)), f=f, C_n=sp.csr_array(C[:, 0]),
        C_t=sp.csr_array(C[:, 1:].reshape(2 * m, -1)), gap=np.zeros(m),
        laws=type(laws)(**{**laws.__dict__, "friction": np.array(friction)}),
        R=sp.csc_array(sp.eye_array(6 * rings)), bodies=np.arange(0, 6 * rings + 1, 6),
    )  # fmt: skip


@cache
def least(rings: int, lunes: int, mu: float = 0.7, oculus: float = 0.0, tolerance: float = 1e-6) -> float:
    """Least thickness over the mean radius; nan where an end of the bracket is no proof."""
    low, high = 0.01, 0.12
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        state = statically_admissible(lune(rings, lunes, middle, mu, oculus))
        if not state.decided:
            return float("nan")
        low, high = (low, middle) if state.exists else (middle, high)
    return high


def rows() -> list[Row]:
    cases = ((8, 16, 0.041966), (60, 360, 0.042812))
    found = [
        Row(f"{rings} rings, {lunes} lunes", value, least(rings, lunes), 5e-5, "bisected to 1e-6",
            check="second method")
        for rings, lunes, value in cases
    ]  # fmt: skip
    limits = ((10, 0.04061), (20, 0.03497), (30, 0.02774))
    found += [
        Row(f"oculus of half-opening {angle} degrees", value, least(60, 360, 0.7, angle), 5e-3,
            "60 rings instead of a limit", check="second method")
        for angle, value in limits
    ]  # fmt: skip
    return found
