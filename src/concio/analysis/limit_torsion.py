"""Joints that twist as a structure in space begins to move, and what is carried with their pressure spread.

A hard joint is stated at the corners of its patch, which carry every resultant that the patch could; but of torsion
they resist up to 1.85 times as much as an even pressure does (:mod:`concio.contact.patch_points`). Where a mechanism
twists such joints the load steps are taken once more with points over every patch: a square footing under a couple
carries 2.83 at its corners, 1.54 at 6 x 6 points and 1.53 under an even pressure.

Points over a patch resist torsion too well themselves, the less the more there are: their mean distance from the
middle is larger than that of the patch, by 2.3 % with 4 x 4 and by 0.5 % with 6 x 6 on a square. What load steps carry,
and the least that they did not reach, are divided by that ratio, and the steps are finer; an even pressure is between.

A collapse state leaves open where in a joint the pressure stands. Of a joint that twists it finds the place with the
least arm, the middle, and its multiplier falls without bound as points are added there: such a state says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.load_steps import LoadSteps, load_steps
from concio.contact.assembly import Assembly
from concio.contact.pairs import CONTACT_MODELS
from concio.contact.patch_points import SPREADING, spread_points
from concio.kinematics.frames import cross
from concio.model.interfaces.patch import Patch
from concio.problem.contact_problem import Array
from concio.problem.solution import ProgressCallback
from concio.representation import short_repr

CORNERS, SPREAD = CONTACT_MODELS.index("corners of the patch"), CONTACT_MODELS.index("points over the patch")

TWISTS = 1e-3
"""Share of the largest relative velocity that a joint must slip by turning about its normal to count as twisting."""

FINEST, FINE = 0.03, 24
"""Share of the usual least step of loads that twist joints, and points along each side that the torsion of others is
measured by: right to 1e-4."""


@short_repr
@dataclass(frozen=True, eq=False)
class SpreadSteps:
    """Load steps of a model whose joints are stated at points over their patches.

    Parameters
    ----------
    steps : LoadSteps
    points : int
        Points along each side of a quadrilateral; 0 where the model states its own.
    pairs : int
        Contact pairs in all.
    error : float
        Largest share by which the points of a joint that twists resist torsion better than an even pressure; negative
        where all resist it less, as points in odd number along the sides do: nothing is taken off then.
    """

    steps: LoadSteps
    points: int
    pairs: int
    error: float = 0.0

    @property
    def carried(self) -> float:
        """What the steps carry, less what the points resist torsion too well; ``nan`` where they carry nothing."""
        return self.steps.carried / (1.0 + max(self.error, 0.0))

    @property
    def not_reached(self) -> float:
        """The least load that the steps did not reach, likewise; ``nan`` where they reached all."""
        return self.steps.failed / (1.0 + max(self.error, 0.0))


def twisting(assembly: Assembly, motion: Array, rule: int = CORNERS) -> Array:
    """Return the numbers of the patches that a motion (N_all,) slips by turning about their normals.

    Parameters
    ----------
    assembly : Assembly
        In space.
    motion : (N_all,) array
    rule : int
        Index into :data:`concio.contact.pairs.CONTACT_MODELS`: which patches are examined.
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


def twisted_joints(assembly: Assembly, motions: Sequence[Array], rule: int = CORNERS) -> list[int]:
    """Return the numbers of the joints stated by a rule that at least one of some motions twists."""
    if assembly.model.dim == 2:
        return []
    found: set[int] = set()
    for motion in motions:
        found |= set(twisting(assembly, motion, rule).tolist())
    return sorted(found)


def torsion_error(assembly: Assembly, joints: Sequence[int]) -> float:
    """Return the largest share by which points resist the torsion of some joints better than an even pressure, signed.

    Parameters
    ----------
    assembly : Assembly
        Whose joints are stated at points over their patches.
    joints : sequence of int
        Numbers of the interfaces.
    """
    found, pairs = [], assembly.pairs
    for joint in joints:
        patch = assembly.detection.interfaces[joint]
        assert isinstance(patch, Patch)
        own = pairs.interface == joint
        even = _mean_distance(*spread_points(patch, FINE))
        found.append(_mean_distance(pairs.point[own], pairs.area[own]) / even - 1.0)
    return max(found, default=0.0)


def _mean_distance(points: Array, area: Array) -> float:
    """Return the mean distance of points (m, 3) from their middle, by the area (m,) of each."""
    middle = area @ points / area.sum()
    return float(area @ np.linalg.norm(points - middle, axis=1) / area.sum())


def spread_steps(
    assembly: Assembly,
    live: Sequence[str],
    bound: float,
    most: int,
    joints: Sequence[int],
    *,
    stated: bool = False,
    progress: ProgressCallback | None = None,
) -> SpreadSteps | None:
    """Return load steps with pressure spread over all patches; None where that takes more than ``most`` pairs.

    Parameters
    ----------
    assembly : Assembly
    live : sequence of str
        Groups that are multiplied.
    bound : float
        Associated multiplier, which stays an upper bound: corners carry what any points of the patch carry.
    most : int
    joints : sequence of int
        Numbers of the interfaces that twist.
    stated : bool
        Whether they are stated at points over their patches already, which stay what they are.
    progress : callable, optional
    """
    patches = len(assembly.detection.interfaces)
    for points in (0,) if stated else SPREADING:
        if max(patches * points**2, len(assembly.pairs)) > most:
            continue
        spread = assembly if stated else lent_assembly(replace(assembly.model, contact_points=points))
        if len(spread.pairs) > most:
            continue
        dead = spread.problem(dict.fromkeys(live, 0.0))
        load = spread.problem(dict.fromkeys(live, 1.0)).f - dead.f
        steps = load_steps(dead, load, bound, finest=FINEST, progress=progress)
        return SpreadSteps(steps, points, len(spread.pairs), torsion_error(spread, joints))
    return None
