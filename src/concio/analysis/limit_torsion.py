"""Joints that twist as a structure in space begins to move, and what is carried with their pressure spread.

A hard joint is stated at the corners of its patch, which carry every resultant that the patch could; but of torsion
they resist up to 1.85 times as much as an even pressure does (:mod:`concio.contact.patch_points`). Where a mechanism
twists such joints the load steps are taken once more with points over every patch: a square footing under a couple
carries 2.83 at its corners, 1.54 at 6 x 6 points and 1.53 under an even pressure.

A collapse state leaves open where in a joint the pressure stands. Of a joint that twists it finds the place with the
least arm, the middle, and its multiplier falls without end as points are added there: such a state says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.load_steps import LoadSteps, load_steps
from concio.contact.assembly import Assembly
from concio.contact.pairs import CONTACT_MODELS
from concio.kinematics.frames import cross
from concio.problem.contact_problem import Array
from concio.problem.solution import ProgressCallback
from concio.representation import short_repr

CORNERS, SPREAD = CONTACT_MODELS.index("corners of the patch"), CONTACT_MODELS.index("points over the patch")

TWISTS = 1e-3
"""Share of the largest relative velocity that a joint must slip by turning about its normal to count as twisting."""

POINTS = (6, 4)
"""Points along each side that spread pressure, as many as the size allows: torsion is right to 0.5 and 2.3 %."""


@short_repr
@dataclass(frozen=True, eq=False)
class SpreadSteps:
    """Load steps of a model whose joints are stated at points over their patches.

    Parameters
    ----------
    steps : LoadSteps
    points : int
        Points along each side of a quadrilateral.
    pairs : int
        Contact pairs in all.
    """

    steps: LoadSteps
    points: int
    pairs: int


def twisting(assembly: Assembly, motion: Array, rule: int = CORNERS) -> Array:
    """Return the numbers of the patches that a motion (N_all,) slips by turning about their normals.

    Parameters
    ----------
    assembly : Assembly
        In space.
    motion : (N_all,) array
    rule : int
        Index into :data:`concio.contact.pairs.CONTACT_MODELS`: which patches are looked at.
    """
    pairs = assembly.pairs
    w_n, w_t = pairs.C_n @ motion, (pairs.C_t @ motion).reshape(-1, 2)
    speed = np.linalg.norm(w_t, axis=1)
    most = max(float(speed.max(initial=0.0)), float(np.abs(w_n).max(initial=0.0)))
    closed = (pairs.rule == rule) & (w_n <= assembly.laws.friction * speed * (1 + 1e-6) + TWISTS * most)
    number, count = pairs.interface[closed], len(assembly.detection.interfaces)
    points = np.bincount(number, minlength=count)
    at = np.einsum("mtd,md->mt", pairs.tangents[closed], pairs.point[closed])

    def centred(values: Array) -> Array:
        mean = np.stack([np.bincount(number, v, count) for v in values.T], axis=1) / np.maximum(points, 1)[:, None]
        return np.asarray(values - mean[number])

    arm, slip = centred(at), centred(w_t[closed])
    size = np.sqrt(np.bincount(number, (arm**2).sum(1), count) * np.maximum(points, 1))
    turn = np.abs(np.bincount(number, cross(arm, slip), count))
    return np.flatnonzero((points > 1) & (turn > TWISTS * most * size))


def twisted_joints(assembly: Assembly, motions: Sequence[Array]) -> int:
    """Return how many joints that are stated at their corners at least one of some motions twists."""
    if assembly.model.dim == 2:
        return 0
    found: set[int] = set()
    for motion in motions:
        found |= set(twisting(assembly, motion).tolist())
    return len(found)


def spread_steps(
    assembly: Assembly, live: Sequence[str], bound: float, most: int, *, progress: ProgressCallback | None = None
) -> SpreadSteps | None:
    """Return load steps with pressure spread over all patches; None where that takes more than ``most`` pairs.

    Parameters
    ----------
    assembly : Assembly
        Of blocks whose joints are stated at their corners.
    live : sequence of str
        Groups that are multiplied.
    bound : float
        Associated multiplier, which stays an upper bound: corners carry what any points of the patch carry.
    most : int
    progress : callable, optional
    """
    patches = len(assembly.detection.interfaces)
    for points in POINTS:
        if patches * points**2 > most:
            continue
        spread = lent_assembly(replace(assembly.model, contact_points=points))
        if len(spread.pairs) > most:
            continue
        dead = spread.problem(dict.fromkeys(live, 0.0))
        load = spread.problem(dict.fromkeys(live, 1.0)).f - dead.f
        return SpreadSteps(load_steps(dead, load, bound, progress=progress), points, len(spread.pairs))
    return None
