r"""The whole strength domain of a cell, as a polyhedron of macroscopic stresses proven from inside and outside.

In the plane the forces a pair may carry are a polygon; the stresses of all forces in balance are the projection of a
polyhedron, a polyhedron again. Every mechanism v with strain rate D bounds it from outside,

.. math:: D \cdot \Sigma \le h(v) / V,

h the power its joints absorb; every stress that forces in balance carry lies inside. Both come out of each linear
programme of limit analysis. From a point inside, rays are shot at the corners of the half-spaces found so far. A corner
that is reached belongs to the domain; where the ray stops before, its mechanism is a new half-space. When all corners
are reached nothing is between inside and outside, and the half-spaces are the domain, exactly. Corners farthest beyond
the hull of all that is known to be carried come first, so that a search that is ended before (rubble has hundreds of
half-spaces) has left little between, and says how much. What is unbounded is closed by a distant box and its corners
are reached or not like others. (An outer approximation as for polyhedral
projections; compare Löhne, Vector Optimization with Infimum and Supremum, 2011, for its cousins.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from concio.analysis.cells.half_spaces import FAR, HalfSpaces
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Mechanism, Progress, ProgressCallback
from concio.problem.tolerances import ADMISSIBLE, CHECKED
from concio.representation import short_repr
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit
from concio.solvers.statics.mechanism import absorbed_power

Array = np.ndarray

REACHED = 1e-7
"""A corner counts as reached by a ray that ends within this share of its length before it."""

BATCH = 12
"""Corners that rays are shot at before the half-spaces are put together again."""

INSIDE = 1e-6
"""Distance from the point inside to the boundary, in sizes of the domain, below which there is no inside."""


@short_repr
@dataclass(frozen=True, eq=False)
class StrengthFaces:
    """Half-spaces around the strength domain, and stresses in it.

    Parameters
    ----------
    faces : HalfSpaces
        The domain lies within them [kN/m2].
    mechanisms : tuple of Mechanism
        One for each half-space, strain rates last.
    points : (p, 3) array
        Stresses proven to be carried [kN/m2].
    exact : bool
        Whether every corner of the half-spaces is carried: then they are the domain.
    shortfall : float
        Largest share of the way from a stress inside to a corner that is not proven to be carried; 0 where exact.
    programmes : int
        Linear programmes solved.
    """

    faces: HalfSpaces
    mechanisms: tuple[Mechanism, ...]
    points: Array
    exact: bool
    shortfall: float
    programmes: int


def face_of(cell: PeriodicCell, problem: ContactProblem, mechanism: Mechanism) -> tuple[Array, float]:
    """Return the half-space (D (3,), h) that a mechanism of :meth:`PeriodicCell.problem` proves."""
    strain = mechanism.velocity[-3:] / cell.size
    return strain, absorbed_power(problem, mechanism.velocity) / cell.volume


def strength_faces(
    cell: PeriodicCell,
    found: Sequence[LimitLoad] = (),
    *,
    most: int = 400,
    progress: ProgressCallback | None = None,
) -> StrengthFaces | None:
    """Return the strength domain of a cell as half-spaces, or None where it has no inside.

    Parameters
    ----------
    cell : PeriodicCell
    found : sequence of LimitLoad
        Limit loads known already; their mechanisms are the first half-spaces.
    most : int
        Linear programmes after which to stop.
    progress : callable, optional
        True stops; what is found so far is returned.
    """
    return _Search(cell, most, progress).run(found)


class _Search:
    def __init__(self, cell: PeriodicCell, most: int, progress: ProgressCallback | None) -> None:
        self.cell, self.problem, self.most, self.progress = cell, cell.problem(), most, progress
        self.normals: list[Array] = []
        self.offsets: list[float] = []
        self.mechanisms: list[Mechanism] = []
        self.points: list[Array] = []
        self.programmes = 0
        self.unit = 1.0
        self.rng = np.random.default_rng(0)

    def run(self, found: Sequence[LimitLoad]) -> StrengthFaces | None:
        for limit in found:
            self.add(limit)
        inside = self.inside()
        if inside is None:
            return None
        for axis in (*np.eye(3), *-np.eye(3)):
            self.shoot(inside, axis)
        reached: set[bytes] = set()
        stuck: set[bytes] = set()
        while True:
            faces = HalfSpaces(np.array(self.normals).reshape(-1, 3), np.array(self.offsets))
            corners = self.keyed(HalfSpaces.of(faces.normals, faces.offsets).vertices[0])
            left = [k for k in corners if k not in reached and k not in stuck]
            far = self.carried(inside, np.array([corners[k] for k in left]))
            if not left or self.programmes >= self.most or self.stopped(len(left), 1.0 - float(far.min())):
                open_ = [k for k in corners if k not in reached]
                far = self.carried(inside, np.array([corners[k] for k in open_]))
                return self.result(faces, 1.0 - float(far.min()) if open_ else 0.0)
            for k in np.argsort(far)[:BATCH].tolist():
                key, way = left[k], corners[left[k]] - inside
                share, new = self.shoot(inside, way, 1.0)
                if share >= 1.0 - REACHED:
                    reached.add(key)
                elif not new and not any(self.shoot(inside, way + self.aside(share * way), 1.0)[1] for _ in range(4)):
                    stuck.add(key)  # all that was found there is known already

    def aside(self, way: Array) -> Array:
        """Return a small vector (3,) in a random direction."""
        return 0.1 * float(np.linalg.norm(way)) * self.rng.normal(size=3)

    def keyed(self, corners: Array) -> dict[bytes, Array]:
        """Return corners (v, 3) by keys that do not change with rounding."""
        near = np.round(corners / (1e-6 * np.abs(corners).max(axis=1, keepdims=True).clip(self.unit)))
        return {k.tobytes(): c for k, c in zip(near, corners, strict=True)}

    def carried(self, inside: Array, corners: Array) -> Array:
        """Return the shares (v,) of the ways to corners (v, 3) that the hull of all carried stresses holds."""
        if not len(corners):
            return np.ones(1)
        hull = ConvexHull(np.array(self.points) / self.unit).equations
        room = -(hull[:, :3] @ (inside / self.unit) + hull[:, 3])
        rate = (corners - inside) / self.unit @ hull[:, :3].T
        with np.errstate(divide="ignore"):
            found: Array = np.where(rate > 0, np.maximum(room, 0.0) / rate, np.inf).min(axis=1)
        shares: Array = np.minimum(found, 1.0)
        return shares

    def stopped(self, left: int, short: float) -> bool:
        note = f"{len(self.offsets)} half-spaces, {left} corners to reach, at most {100 * short:.2g} % short"
        return bool(self.progress is not None and self.progress(Progress("strength", self.programmes, short, note)))

    def inside(self) -> Array | None:
        """Return a stress inside the domain: under pressure from all sides, or at rest."""
        pressure = np.array([-1.0, -1.0, 0.0])
        squeezed = self.limit(np.zeros(3), pressure)
        if not squeezed > 0:
            return None
        self.unit = min(squeezed, max((abs(o) for o in self.offsets if o), default=1.0))
        self.points = []
        for share in (0.5, 0.1, 2.0):
            point = min(share * self.unit, 0.9 * squeezed) * pressure
            around = [self.limit(point, axis) for axis in (*np.eye(3), *-np.eye(3))]
            if min(around) > INSIDE * self.unit:
                return point
        return None

    def limit(self, base: Array, direction: Array, share: float = np.inf) -> float:
        """Return the multiplier of a direction from a stress that is carried, at most ``share``; keep the proofs."""
        dead = self.problem.with_loads(self.cell.load(base))
        found = associated_limit(dead, self.cell.load(direction))
        self.programmes += 1
        self.add(found)
        most = share if np.isfinite(share) else FAR * self.unit / float(np.abs(direction).max())
        if found.residual <= CHECKED and not np.isnan(found.multiplier):
            self.points.append(base + min(found.multiplier, most) * direction)
        return min(found.multiplier, share)

    def shoot(self, inside: Array, direction: Array, share: float = np.inf) -> tuple[float, bool]:
        """Return the share of a direction that is carried, and whether a new half-space was found."""
        before = len(self.offsets)
        carried = self.limit(inside, direction, share)
        return carried, len(self.offsets) > before

    def add(self, limit: LimitLoad) -> None:
        """Keep the half-space of a mechanism, unless it is known."""
        if limit.mechanism is None or limit.mechanism.violation > ADMISSIBLE:
            return
        normal, offset = face_of(self.cell, self.problem, limit.mechanism)
        length = float(np.linalg.norm(normal))
        if not length > 0:
            return
        normal, offset = normal / length, offset / length
        size = max([abs(o) for o in self.offsets] + [abs(offset)]) or 1.0
        for n, o in zip(self.normals, self.offsets, strict=True):
            if float(np.abs(n - normal).max()) <= 1e-8 and abs(o - offset) <= 1e-8 * size:
                return
        self.normals.append(normal)
        self.offsets.append(offset)
        self.mechanisms.append(limit.mechanism)

    def result(self, faces: HalfSpaces, shortfall: float) -> StrengthFaces:
        kept = faces.kept()
        return StrengthFaces(
            HalfSpaces(faces.normals[kept], faces.offsets[kept]),
            tuple(self.mechanisms[k] for k in kept),
            np.array(self.points).reshape(-1, 3),
            shortfall == 0.0,
            shortfall,
            self.programmes,
        )
