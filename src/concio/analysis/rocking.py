r"""Large displacements of rigid blocks: the load multiplier as the geometry of collapse changes.

In small displacements a toppling block keeps its multiplier for ever. Here the blocks are moved, contacts are looked
for again at the displaced corners, and the limit multiplier of the displaced structure is found by the static theorem
(:mod:`concio.solvers.statics.limit`); its mechanism gives the next movement. A block of width b and height h that rocks
about its toe falls from b/h to zero as its centroid passes above the toe: lambda = tan(atan(b/h) - theta).

Every interface of polygons begins and ends at a corner of one of them, so that corners near edges are all the contact
points rigid blocks need. A step turns each block about the instantaneous centre of its motion (no second-order drift
for a single hinge), then closes the gaps of the pairs that carry force by Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.arguments import strict
from concio.errors import InputError, SolverError
from concio.model.materials import Rigid
from concio.model.model import Model, require_model
from concio.problem.contact_problem import ContactProblem, Laws
from concio.representation import short_repr
from concio.solvers.statics.limit import associated_limit

Array = np.ndarray

MOST_STEPS = 2000
"""Steps after which rocking stops."""


@short_repr
@dataclass(frozen=True, eq=False)
class RockingResult:
    """A rocking curve.

    Parameters
    ----------
    multiplier : (n,) array
        Limit multiplier of the horizontal share at each step.
    rotation : (n, B) array
        Rotation of each free body, anticlockwise [rad].
    centroid : (n, B, 2) array
        Position of each free body's centroid [m].
    names : tuple of str
        Names of the free bodies.
    reason : str
        Why the curve ends, in words.
    """

    multiplier: Array
    rotation: Array
    centroid: Array
    names: tuple[str, ...]
    reason: str


@dataclass
class _Blocks:
    model: Model
    outlines: list[Array]
    weights: Array
    free: list[int]
    tolerance: float

    def friction(self, a: int, b: int) -> float:
        """Return the coefficient between two bodies, by the model's rules."""
        bodies, laws = self.model.bodies, self.model.laws
        return laws[self.model.rule_between(bodies[a], bodies[b]).law].friction

    def contacts(self) -> tuple[Array, Array, Array, Array]:
        """Return sides (m, 2), points (m, 2), normals (m, 2) from a to b, and gaps (m,): corners of b on edges of a."""
        sides, points, normals, gaps = [], [], [], []
        for a, edges in enumerate(self.outlines):
            start, along = edges, np.roll(edges, -1, axis=0) - edges
            length = np.linalg.norm(along, axis=1)
            unit = along / length[:, None]
            outward = np.column_stack([unit[:, 1], -unit[:, 0]])
            for b, corners in enumerate(self.outlines):
                if a == b or (a not in self.free and b not in self.free):
                    continue
                away = corners[:, None] - start[None]
                reach = (away * unit).sum(2)
                gap = (away * outward).sum(2)
                slack = self.tolerance
                near = (np.abs(gap) <= slack) & (reach >= -slack) & (reach <= length + slack)
                for i, e in zip(*np.nonzero(near), strict=True):
                    if not self._faces(b, int(i), outward[e]):
                        continue
                    sides.append((a, b))
                    points.append(corners[i])
                    normals.append(outward[e])
                    gaps.append(gap[i, e])
        return (
            np.array(sides, int).reshape(-1, 2),
            np.reshape(points, (-1, 2)),
            np.reshape(normals, (-1, 2)),
            np.array(gaps),
        )

    def _faces(self, b: int, i: int, outward: Array) -> bool:
        """Return True when the corner lies at the foot of its block: the block is on the outer side of the edge."""
        p = self.outlines[b]
        both = np.array([p[i - 1] - p[i], p[(i + 1) % len(p)] - p[i]])
        return bool((both @ outward >= -1e-6 * np.linalg.norm(both, axis=1)).all())

    def centroids(self) -> Array:
        return np.array([_centroid(self.outlines[b]) for b in self.free])

    def operators(self, sides: Array, points: Array, normals: Array) -> tuple[sp.csr_array, sp.csr_array]:
        """Return C_n and C_t (m, 3 B) on the motions (x, y, rotation about the centroid) of the free blocks."""
        number = {b: j for j, b in enumerate(self.free)}
        centre, m = self.centroids(), len(sides)
        rows = np.zeros((2, m, 3 * len(self.free)))
        for k in range(m):
            tangent = np.array([-normals[k, 1], normals[k, 0]])
            for side, sign in ((0, -1.0), (1, 1.0)):
                j = number.get(int(sides[k, side]))
                if j is None:
                    continue
                arm = points[k] - centre[j]
                for i, frame in enumerate((normals[k], tangent)):
                    turn = frame[1] * arm[0] - frame[0] * arm[1]
                    rows[i, k, 3 * j : 3 * j + 3] += sign * np.array([frame[0], frame[1], turn])
        return sp.csr_array(rows[0]), sp.csr_array(rows[1])

    def move(self, motion: Array) -> None:
        """Move the free blocks by (x, y, rotation) each, turning about the instantaneous centre."""
        for j, b in enumerate(self.free):
            x, y, turn = motion[3 * j : 3 * j + 3]
            centre = _centroid(self.outlines[b])
            if abs(turn) > 1e-14:
                pole = centre + np.array([-y, x]) / turn
                c, s = np.cos(turn), np.sin(turn)
                self.outlines[b] = pole + (self.outlines[b] - pole) @ np.array([[c, s], [-s, c]])
            else:
                self.outlines[b] = self.outlines[b] + np.array([x, y])


@strict
def rock(model: Model, *, direction: float = 1.0, step: float = 0.005, smallest: float = 0.0) -> RockingResult:
    """Follow the collapse of rigid blocks under a horizontal share of their weight in large displacements.

    Parameters
    ----------
    model : Model
        Rigid and fixed bodies; friction of their joint laws, own weight only.
    direction : {1, -1}
        Side to which the share acts.
    step : float
        Largest movement of a corner in one step [m].
    smallest : float
        Multiplier at which to stop.

    Raises
    ------
    InputError
        A body is elastic, or there is none that is rigid.
    SolverError
        The structure does not stand under its own weight to begin with.
    """
    require_model(model)
    blocks, names = _read(model)
    multiplier: list[float] = []
    rotation, centroid = [], []
    turned = np.zeros(len(blocks.free))
    reason = f"{MOST_STEPS} steps were made"
    for _ in range(MOST_STEPS):
        sides, points, normals, _gaps = blocks.contacts()
        C_n, C_t = blocks.operators(sides, points, normals)
        n = 3 * len(blocks.free)
        weight = np.zeros(n)
        weight[1::3] = -blocks.weights
        push = np.zeros(n)
        push[0::3] = direction * blocks.weights
        mu = np.array([blocks.friction(int(a), int(b)) for a, b in sides])
        problem = ContactProblem(
            sp.csr_array((n, n)), weight, C_n, C_t, np.zeros(len(sides)), Laws.coulomb(mu),
            sp.csc_array(sp.eye_array(n)), 3 * np.arange(len(blocks.free) + 1),
        )  # fmt: skip
        found = associated_limit(problem, push)
        if not np.isfinite(found.multiplier) or found.mechanism is None:
            if not multiplier:
                msg = "the blocks do not stand, or cannot be pushed over, at the beginning"
                raise SolverError(msg, hint="look at 'concio check': blocks must touch")
            reason = "no multiplier gives equilibrium of the displaced blocks any more"
            break
        multiplier.append(found.multiplier)
        rotation.append(turned.copy())
        centroid.append(blocks.centroids())
        if found.multiplier <= smallest:
            reason = f"the multiplier fell to {smallest:g}"
            break
        motion = found.mechanism.velocity
        turn = motion[2::3]
        reach = max(float(np.ptp(blocks.outlines[b], axis=0).max()) for b in blocks.free)
        motion = motion * (step / max(float(np.abs(motion).max()), reach * float(np.abs(turn).max(initial=0.0))))
        loaded = found.normal_force > 1e-9 * blocks.weights.sum()
        hinges = [(int(a), int(b), p) for (a, b), p in zip(sides[loaded], points[loaded], strict=True)]
        blocks.move(motion)
        turned = turned + motion[2::3]
        turned = turned + _close(blocks, hinges)
    return RockingResult(np.array(multiplier), np.array(rotation), np.array(centroid), names, reason)


def _close(blocks: _Blocks, hinges: list[tuple[int, int, Array]]) -> Array:
    """Close the gaps at the pairs that carried force; return the rotations this took (B,)."""
    wanted = {(a, b) for a, b, _ in hinges}
    total = np.zeros(len(blocks.free))
    for _ in range(5):
        sides, points, normals, gaps = blocks.contacts()
        keep = np.array([(int(a), int(b)) in wanted for a, b in sides], dtype=bool)
        if not keep.any() or np.abs(gaps[keep]).max() < 1e-14:
            break
        C_n, _ = blocks.operators(sides[keep], points[keep], normals[keep])
        motion = -np.linalg.lstsq(C_n.toarray(), gaps[keep], rcond=1e-9)[0]
        blocks.move(motion)
        total = total + motion[2::3]
    return total


def _read(model: Model) -> tuple[_Blocks, tuple[str, ...]]:
    bodies = model.outlines
    for body in bodies:
        if body.kind == "elastic":
            msg = "rocking needs rigid blocks, this one is elastic"
            raise InputError(msg, where=f"block '{body.name}'", hint="give it kind = 'rigid' and a Rigid material")
    free = [i for i, body in enumerate(bodies) if body.kind == "rigid"]
    if not free:
        msg = "there is no rigid body to rock"
        raise InputError(msg, hint="give the blocks kind = 'rigid'")
    weights = []
    for i in free:
        material = model.materials[bodies[i].material]
        assert isinstance(material, Rigid)  # the model has checked it
        weights.append(material.unit_weight * bodies[i].area * bodies[i].thickness)
    if not min(weights) > 0:
        msg = "a block has no weight"
        raise InputError(msg, hint="give the Rigid material a unit_weight")
    size = max(float(np.ptp(b.outline, axis=0).max()) for b in bodies if b.kind == "rigid")
    outlines = [np.array(b.outline) for b in bodies]
    names = tuple(bodies[i].name for i in free)
    return _Blocks(model, outlines, np.array(weights), free, 1e-6 * size), names


def _centroid(p: Array) -> Array:
    q = np.roll(p, -1, axis=0) - p[0]
    r = p - p[0]
    cross = r[:, 0] * q[:, 1] - q[:, 0] * r[:, 1]
    centre: Array = p[0] + ((r + q) * cross[:, None]).sum(0) / (3 * cross.sum())
    return centre
