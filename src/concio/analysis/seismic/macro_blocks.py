r"""What a mechanism makes of the bodies: macro-blocks that move as one, and the joints between them.

Bodies that touch and have no relative motion are one *macro-block*: thirty courses that topple together count as the
one rigid body of the code. Where macro-blocks touch and carry force they are joined: by a *hinge* where two points stay
together, a *roller* where a point slides on a face (without dilatancy, whatever the flow of the limit programme), a
*bar* where a tie keeps its length. What does not move at all is macro-block -1.

In a joint that crushes, with strength f over the width w, the contact force N stands in the middle of the crushed
length N/(f w): there is its hinge, set back from the edge by N/(2 f w).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from concio.analysis.seismic.sliding_faces import ends_of_sliding, ends_set_back, face_ends, face_of
from concio.contact.assembly import Assembly
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.frames import turned_left
from concio.kinematics.rigid import motions, rigid_operator, swept
from concio.problem.tolerances import AT_BOUND

Array = np.ndarray

GROUND = -1
"""Number of the macro-block that does not move."""

STILL = {2: 1e-7, 3: 1e-6}
"""Relative velocities below this share of the largest are none; in space they come from cone programmes."""


@dataclass(frozen=True, eq=False)
class MacroBlock:
    """Bodies that move as one.

    Parameters
    ----------
    bodies : tuple of int
    names : tuple of str
    centre : (d,) array
        Of their volume [m].
    motion : (3,) or (6,) array
        Velocity (x, y) or (x, y, z) of the centre, and rotation.
    """

    bodies: tuple[int, ...]
    names: tuple[str, ...]
    centre: Array
    motion: Array

    def velocity(self, point: Array) -> Array:
        """Return the velocity (..., d) of points (..., d)."""
        return carried(self.motion, point - self.centre)

    @property
    def label(self) -> str:
        """Its bodies, in short."""
        return self.names[0] if len(self.names) == 1 else f"{self.names[0]} ... {self.names[-1]} ({len(self.names)})"


@dataclass(frozen=True, eq=False)
class MacroJoint:
    """A joint between two macro-blocks, ``b`` on ``a``.

    Parameters
    ----------
    kind : {"hinge", "roller", "bar"}
    a, b : int
        Macro-blocks; ``GROUND`` is what does not move.
    point : (d,) array
        Of a hinge; the point that slides, of a roller; the end on ``a``, of a bar [m].
    normal : (d,) array
        From a to b; the unit normal of the face on which a roller slides; of a bar from ``a`` to ``b``.
    face : {0, 1}
        Whether the face of a roller belongs to ``a`` or to ``b``.
    end : (d,) array
        The end on ``b`` of a bar, or of a hinge that begins where something has slid [m].
    low, high : float
        Where the face of a roller begins and ends, from the point along its normal turned left [m].
    friction, cohesion : float
        mu, and c [kN], of what slides.
    pulls : bool
        True where it may pull: supports and bars.
    set_back : float
        Distance of a hinge from the edge of its joint [m].
    strength : float
        Force that crushes a unit of length of its joint [kN/m]; of a bar, the force at which it yields [kN].
    inward : (2,) array
        Unit vector from the edge of the joint to the hinge.
    """

    kind: Literal["hinge", "roller", "bar"]
    a: int
    b: int
    point: Array
    normal: Array
    face: int = 0
    end: Array | None = None
    low: float = -float("inf")
    high: float = float("inf")
    friction: float = 0.0
    cohesion: float = 0.0
    pulls: bool = False
    set_back: float = 0.0
    strength: float = float("inf")
    inward: Array | None = None

    @property
    def on_b(self) -> Array:
        """Its point on b, as described: that on a unless the ends differ."""
        return self.point if self.end is None else self.end

    def slid(self, by: float, tolerance: float) -> MacroJoint:
        """Return a roller whose point has gone ``by`` [m] along its face: beyond its end, that end is what touches."""
        if self.low - tolerance <= by <= self.high + tolerance:
            return self
        end = self.point + min(max(by, self.low), self.high) * turned_left(self.normal)
        return replace(self, point=end, face=1 - self.face, low=-float("inf"), high=float("inf"))

    def set_back_by(self, force: float) -> MacroJoint:
        """Return the joint with its hinge in the middle of the length that ``force`` [kN] crushes."""
        assert self.inward is not None
        depth = force / (2.0 * self.strength)
        return replace(self, point=self.point + (depth - self.set_back) * self.inward, set_back=depth)


@dataclass(frozen=True, eq=False)
class Mechanics:
    """The macro-blocks of a mechanism and their joints.

    Parameters
    ----------
    blocks : tuple of MacroBlock
    joints : tuple of MacroJoint
    of_body : dict of int to int
        Macro-block of each body of the model that moves.
    """

    blocks: tuple[MacroBlock, ...]
    joints: tuple[MacroJoint, ...]
    of_body: dict[int, int]

    @property
    def slides(self) -> bool:
        """Whether a joint with friction slides."""
        return any(j.kind == "roller" and j.friction > 0 for j in self.joints)

    def reach(self, points: Sequence[Array]) -> float:
        """Return the largest distance along an axis of points (d,) from the first centre, 1 where it is zero [m]."""
        return float(np.abs(np.array(points) - self.blocks[0].centre).max()) or 1.0

    @property
    def level(self) -> float:
        """Mean height of the joints with what does not move [m]."""
        heights = [float(j.point[-1]) for j in self.joints if GROUND in (j.a, j.b)]
        return float(np.mean(heights)) if heights else min(float(b.centre[-1]) for b in self.blocks)


def carried(motion: Array, arm: Array) -> Array:
    """Return the velocity (..., d) at arms (..., d) from the centre of a rigid motion (3,) or (6,)."""
    d = arm.shape[-1]
    found: Array = motion[:d] + swept(motion[2] if d == 2 else motion[3:], arm)
    return found


def body_velocities(assembly: Assembly, velocity: Array) -> Array:
    """Return the rigid motion (B, 3 or 6) of each body in a velocity (N_all,): of its centroid, and its rotation."""
    disc = assembly.disc
    d = disc.dim
    found = np.zeros((len(disc.shape_of), motions(d)))
    for b, shape in enumerate(disc.shape_of):
        own = velocity[disc.offsets[b] : disc.offsets[b + 1]]
        if shape == FIXED:
            continue
        if shape == RIGID:
            found[b] = np.concatenate([own[:d], own[d:] / disc.reach[b]])
        else:
            modes = rigid_operator(disc.nodes(b) - disc.centroids[b], 1.0).reshape(-1, motions(d))
            found[b] = np.linalg.lstsq(modes, own, rcond=None)[0]
    return found


def mechanics_of(assembly: Assembly, velocity: Array, normal_force: Array) -> Mechanics:
    """Return the macro-blocks of a mechanism and the joints between them.

    Parameters
    ----------
    assembly : Assembly
    velocity : (N_all,) array
    normal_force : (m,) array
        That goes with it [kN].
    """
    disc, pairs = assembly.disc, assembly.pairs
    motion = body_velocities(assembly, velocity)
    size = disc.reach[:, None] if len(disc.reach) else np.ones((1, 1))
    d = disc.dim
    reach = np.hstack([np.ones((len(motion), d)), np.repeat(size, motion.shape[1] - d, axis=1)])
    top = float(np.abs(motion * reach).max()) or 1.0
    still = STILL[d] * top
    of_body = _grouped(assembly, motion, top)
    blocks = []
    for g in range(max(of_body.values(), default=-1) + 1):
        bodies = tuple(b for b, own in of_body.items() if own == g)
        volume = np.array([disc.model.bodies[b].volume for b in bodies])
        centre = volume @ disc.centroids[list(bodies)] / volume.sum()
        first = bodies[int(np.argmax(volume))]
        shifted = carried(motion[first], centre - disc.centroids[first])
        names = tuple(disc.model.bodies[b].name for b in bodies)
        blocks.append(MacroBlock(bodies, names, centre, np.concatenate([shifted, motion[first, d:]])))
    across = np.array([of_body.get(int(b), GROUND) for b in pairs.body_a])
    beyond = np.array([of_body.get(int(b), GROUND) for b in pairs.body_b])
    touches = np.maximum(across, beyond) != GROUND  # forces of what stands apart, however large, say nothing of these
    loaded = normal_force > AT_BOUND * float(np.abs(normal_force[touches]).max(initial=0.0))
    active = np.flatnonzero(loaded & (across != beyond))
    speed = np.linalg.norm((pairs.C_t @ velocity).reshape(len(pairs), d - 1), axis=1)
    joints: list[MacroJoint] = []
    crushing = np.isfinite(assembly.laws.cap) & (pairs.interface >= 0) & (d == 2)
    macro = np.array([of_body.get(i, GROUND) for i in range(len(motion))])
    for a, b in sorted({(int(across[k]), int(beyond[k])) for k in active if crushing[k]}):
        own = active[(across[active] == a) & (beyond[active] == b) & crushing[active]]
        joints += _set_back(assembly, blocks, macro, own, a, b, normal_force, top)
    single, cohesion = active[~crushing[active]], assembly.laws.cohesion
    if d == 2:
        stays = (np.abs(pairs.C_n @ velocity) <= still) & ~crushing
        single, cohesion = ends_of_sliding(assembly, macro, single, stays & (speed > still))
    for k in single:
        a, b = int(across[k]), int(beyond[k])
        if pairs.interface[k] < 0:
            tie = disc.model.ties[int(np.flatnonzero(np.flatnonzero(pairs.interface < 0) == k)[0])]
            if abs(float((pairs.C_n[[k]] @ velocity)[0])) <= still:
                at_a, at_b = np.array(tie.at_a), np.array(tie.at_b)
                along = (at_b - at_a) / float(np.linalg.norm(at_b - at_a))
                joints.append(MacroJoint("bar", a, b, at_a, along, end=at_b, pulls=True, strength=tie.most))
            continue
        if speed[k] <= still:
            joints.append(MacroJoint("hinge", a, b, pairs.point[k], pairs.normal[k]))
        else:
            law = assembly.laws
            face = face_of(assembly, int(k))
            ends = face_ends(assembly, macro, int(k), face) if d == 2 else (-np.inf, np.inf)
            joints.append(
                MacroJoint(
                    "roller", a, b, pairs.point[k], pairs.normal[k], face, low=ends[0], high=ends[1],
                    friction=float(law.friction[k]), cohesion=float(cohesion[k]),
                )
            )  # fmt: skip
    joints += _supports(assembly, of_body)
    return Mechanics(tuple(blocks), tuple(joints), of_body)


def _grouped(assembly: Assembly, motion: Array, top: float) -> dict[int, int]:
    """Return the macro-block of each body that moves: bodies that touch and move alike share one."""
    disc, pairs = assembly.disc, assembly.pairs
    still = STILL[disc.dim] * top
    parent = list(range(len(motion)))

    def root(b: int) -> int:
        while parent[b] != b:
            parent[b] = parent[parent[b]]
            b = parent[b]
        return b

    def speed(m: Array, b: int) -> float:
        return float(np.abs(carried(m, np.asarray(disc.model.bodies[b].vertices) - disc.centroids[b])).max())

    moving = [b for b in range(len(motion)) if disc.shape_of[b] != FIXED and speed(motion[b], b) > still]
    touching: Iterable[tuple[int, int]] = {
        (int(a), int(b)) for a, b, i in zip(pairs.body_a, pairs.body_b, pairs.interface, strict=True) if i >= 0
    }
    for a, b in sorted(touching):
        if a not in moving or b not in moving:
            continue
        along = motion[a].copy()
        along[: disc.dim] = carried(motion[a], disc.centroids[b] - disc.centroids[a])
        if speed(motion[b] - along, b) <= still:
            parent[root(a)] = root(b)
    roots: dict[int, int] = {}
    return {b: roots.setdefault(root(b), len(roots)) for b in moving}


def _set_back(
    assembly: Assembly, blocks: list[MacroBlock], macro: Array, own: Array, a: int, b: int, force: Array, top: float
) -> list[MacroJoint]:
    """Return the joint that crushing pairs make: a hinge set back from the edge, or rollers where it slides whole."""
    pairs, law = assembly.pairs, assembly.laws
    normal, tangent = pairs.normal[own[0]], pairs.tangents[own[0], 0]
    turns = [blocks[i].motion[2] if i != GROUND else 0.0 for i in (a, b)]
    every = np.flatnonzero(np.isin(pairs.interface, np.unique(pairs.interface[own])))
    along = (pairs.point[every] - pairs.point[own[0]]) @ tangent
    N = float(force[own].sum())
    per_length = float(law.cap[every].sum() / pairs.area[every].sum() * _width(assembly, own))
    turning = turns[1] - turns[0]
    if abs(turning) * max(float(np.ptp(along)), 1e-12) <= STILL[2] * top:
        share = float(law.cohesion[every].sum()) / 2
        return [
            MacroJoint("roller", a, b, point, normal, face, low=low, high=high, friction=float(law.friction[own[0]]),
                       cohesion=share)
            for point, face, low, high in ends_set_back(assembly, macro, int(own[0]), N / (2.0 * per_length))
        ]  # fmt: skip
    # points of b at the place s along the tangent approach a where turning * s is negative along the normal
    rising = float(turned_left(tangent) @ normal) * turning
    edge, inwards = (along.min(), 1.0) if rising > 0 else (along.max(), -1.0)
    at = pairs.point[own[0]] + edge * tangent
    joint = MacroJoint("hinge", a, b, at, normal, strength=per_length, inward=inwards * tangent)
    return [joint.set_back_by(N)]


def _width(assembly: Assembly, own: Array) -> float:
    bodies = assembly.model.outlines
    return min(
        bodies[int(assembly.pairs.body_a[own[0]])].thickness, bodies[int(assembly.pairs.body_b[own[0]])].thickness
    )


def _supports(assembly: Assembly, of_body: dict[int, int]) -> list[MacroJoint]:
    """Return the joints that supports of moving bodies are."""
    disc = assembly.disc
    number = {b.name: i for i, b in enumerate(disc.model.bodies)}
    found = []
    for support in disc.model.supports:
        b = number[support.body]
        if b not in of_body:
            continue
        given = support.edge if support.edge is not None else support.polygon
        points = np.unique(np.array(given), axis=0) if given is not None else disc.nodes(b)
        for point in points:
            for axis, normal in zip("xyz", np.eye(disc.dim), strict=False):
                if axis in support.directions or support.directions == "all":
                    found.append(MacroJoint("roller", GROUND, of_body[b], point, normal, pulls=True))
    return found
