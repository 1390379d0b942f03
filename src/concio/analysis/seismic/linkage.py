r"""A mechanism followed at large displacements: its macro-blocks turn by finite angles about joints that stay joints.

The unknowns are the displacement and the rotation of each macro-block. Hinges keep two points together, rollers keep a
point on the (turning) line of its face without dilatancy, bars keep their length; the control point is moved by d_C. In
every such configuration the multiplier follows from equilibrium of all macro-blocks,

.. math:: J_f(q)^T s + f(q) + \alpha\, g(q) = 0,

with one force for each condition, friction opposing the slip at rollers, dead forces f and the forces g of the
earthquake at the points they act on, ties with the force their elongation gives them. For a chain with one degree of
freedom that is the principle of virtual work in the displaced configuration; with sliding joints it is equilibrium with
the friction they really have. Redundant conditions (two hinges on one line) do no harm: least squares, and a residual.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from concio.analysis.seismic.macro_blocks import GROUND, MacroJoint, Mechanics
from concio.kinematics.frames import turned, turned_left
from concio.model.model import Tie

Array = np.ndarray

CLOSED = 1e-11
"""Largest gap of a joint, over the size of the mechanism, in a configuration that counts."""

LINKAGE_BALANCED = 1e-8
"""Largest residual of equilibrium over the largest force."""

GRIP = 1e-4
"""Share of its strength by which the friction of a hinge may exceed it: of a block that has slid it is all of it."""

RANK = 1e-9
"""Singular values below this share of the largest are none."""


@dataclass(frozen=True, eq=False)
class Force:
    """A force of constant direction on a macro-block.

    Parameters
    ----------
    block : int
    force : (d,) array
        [kN].
    point : (d,) array
        In the initial configuration [m].
    """

    block: int
    force: Array
    point: Array


def merged(forces: Iterable[Force]) -> tuple[Force, ...]:
    """Return forces with those of one block and direction as one, in the centre of them, which turns with the block."""
    groups: dict[tuple[int, tuple[float, ...]], list[Force]] = {}
    for f in forces:
        size = math.hypot(*f.force)
        if size > 0:
            groups.setdefault((f.block, tuple(np.round(f.force / size, 12).tolist())), []).append(f)
    made = []
    for (block, _), own in groups.items():
        sizes = np.array([math.hypot(*f.force) for f in own])
        total: Array = np.sum([f.force for f in own], axis=0)
        made.append(Force(block, total, sizes @ np.array([f.point for f in own]) / sizes.sum()))
    return tuple(made)


@dataclass(frozen=True, eq=False)
class Point:
    """An equilibrium of the displaced mechanism.

    Parameters
    ----------
    q : (G, 3) array
        Displacement of the centre (x, y) and rotation of each macro-block [m, rad].
    multiplier : float
        alpha.
    tie_force, elongation : (n,) arrays
        [kN], [m].
    pressed : bool
        Whether every joint that cannot pull is pressed, and every bar pulls no more than it can.
    normal_force : (j,) array
        Of each joint: along the normal of hinges and rollers, the pull of bars [kN].
    """

    q: Array
    multiplier: float
    tie_force: Array
    elongation: Array
    pressed: bool
    normal_force: Array


@dataclass(frozen=True, eq=False)
class Linkage:
    """Macro-blocks with their joints and forces, and a control point.

    Parameters
    ----------
    mechanics : Mechanics
    dead, push : tuple of Force
    ties : tuple of (Tie, int, int)
        With the macro-blocks of their ends.
    control : (int, (2,) array, (2,) array)
        Macro-block, point and direction of the control displacement.
    """

    mechanics: Mechanics
    dead: tuple[Force, ...]
    push: tuple[Force, ...]
    ties: tuple[tuple[Tie, int, int], ...]
    control: tuple[int, Array, Array]

    @cached_property
    def size(self) -> float:
        """Largest distance of a joint or a force from the first centre [m]."""
        points = [j.point for j in self.mechanics.joints] + [f.point for f in (*self.dead, *self.push)]
        return self.mechanics.reach(points)

    @property
    def unknowns(self) -> int:
        """Three for each macro-block."""
        return 3 * len(self.mechanics.blocks)

    # -- places -------------------------------------------------------------------------------------------------------

    def arm(self, q: Array, block: int, point: Array) -> Array:
        """Return the turned vector (2,) from the centre of a macro-block to one of its points [m]."""
        return turned(point - self.mechanics.blocks[block].centre, q[block, 2])

    def went(self, q: Array, block: int, point: Array) -> Array:
        """Return the displacement (2,) of a point of a macro-block [m], to rounding wherever the origin is."""
        if block == GROUND:
            return np.zeros(2)
        moved: Array = q[block, :2] + self.arm(q, block, point) - (point - self.mechanics.blocks[block].centre)
        return moved

    def between(self, q: Array, a: int, at_a: Array, b: int, at_b: Array) -> Array:
        """Return the vector (2,) from a point of macro-block a to one of b [m]."""
        apart: Array = (at_b - at_a) + (self.went(q, b, at_b) - self.went(q, a, at_a))
        return apart

    def row(self, q: Array, block: int, point: Array, direction: Array) -> Array:
        """Return how fast a point (2,) moves along ``direction`` (2,) with each unknown (3 G,)."""
        found = np.zeros(self.unknowns)
        if block != GROUND:
            found[3 * block : 3 * block + 2] = direction
            found[3 * block + 2] = float(turned_left(self.arm(q, block, point)) @ direction)
        return found

    def rows(self, q: Array, block: int, point: Array) -> Array:
        """Return how fast a point (2,) moves along both axes with each unknown (2, 3 G)."""
        found = np.zeros((2, self.unknowns))
        if block != GROUND:
            found[0, 3 * block] = found[1, 3 * block + 1] = 1.0
            found[:, 3 * block + 2] = turned_left(self.arm(q, block, point))
        return found

    def normal(self, q: Array, joint: MacroJoint) -> Array:
        """Return the normal (2,) of the face of a roller, turned with its macro-block."""
        block = joint.b if joint.face else joint.a
        return joint.normal if block == GROUND else turned(joint.normal, q[block, 2])

    def apart(self, q: Array, joint: MacroJoint) -> Array:
        """Return the vector (2,) from the point of a joint on a to that on b [m]."""
        return self.between(q, joint.a, joint.point, joint.b, joint.on_b)

    def joints(self, q: Array) -> tuple[MacroJoint, ...]:
        """Return the joints with rollers at the ends of what touches: contact goes no further than either face."""
        found = []
        for joint in self.mechanics.joints:
            if joint.kind == "roller" and not joint.pulls:
                along = float(self.apart(q, joint) @ turned_left(self.normal(q, joint)))
                joint = joint.slid(-along if joint.face else along, CLOSED * self.size)
            found.append(joint)
        return tuple(found)

    # -- conditions ---------------------------------------------------------------------------------------------------

    def conditions(self, q: Array) -> tuple[Array, Array]:
        """Return the residuals (c,) [m] of all joints and their derivatives (c, 3 G)."""
        values: list[float] = []
        rows: list[Array] = []
        for joint in self.joints(q):
            apart = self.apart(q, joint)
            if joint.kind == "hinge":
                values += apart.tolist()
                rows += [*(self.rows(q, joint.b, joint.on_b) - self.rows(q, joint.a, joint.point))]
            elif joint.kind == "roller":
                normal = self.normal(q, joint)
                row = self.row(q, joint.b, joint.point, normal) - self.row(q, joint.a, joint.point, normal)
                block = joint.b if joint.face else joint.a
                if block != GROUND:
                    row[3 * block + 2] += float(apart @ turned_left(normal))
                values.append(float(apart @ normal))
                rows.append(row)
            else:
                assert joint.end is not None
                length = float(np.linalg.norm(apart))
                along = apart / length
                values.append(length - float(np.linalg.norm(joint.end - joint.point)))
                rows.append(self.row(q, joint.b, joint.end, along) - self.row(q, joint.a, joint.point, along))
        return np.array(values), np.array(rows).reshape(-1, self.unknowns)

    def controlled(self, q: Array) -> tuple[float, Array]:
        """Return the displacement of the control point [m], and its derivative (3 G,)."""
        block, point, direction = self.control
        moved = float(self.went(q, block, point) @ direction)
        return moved, self.row(q, block, point, direction)

    def set_back(self) -> Linkage:
        """Return the linkage with the hinges of crushing joints where the forces of the onset put them."""
        found = self
        for _ in range(20):
            now = found.balance(np.zeros((len(self.mechanics.blocks), 3)), plastic=True)
            if now is None:
                return found
            joints = tuple(
                joint.set_back_by(float(N)) if joint.inward is not None else joint
                for joint, N in zip(found.mechanics.joints, now.normal_force, strict=True)
            )
            gone = [abs(a.set_back - b.set_back) for a, b in zip(joints, found.mechanics.joints, strict=True)]
            found = replace(found, mechanics=replace(found.mechanics, joints=joints))
            if max(gone, default=0.0) <= CLOSED * self.size:
                break
        return found

    @cached_property
    def freedom(self) -> int:
        """Degrees of freedom at the onset."""
        return self.freedom_at(np.zeros((len(self.mechanics.blocks), 3)))

    def freedom_at(self, q: Array) -> int:
        """Return the degrees of freedom of a configuration (G, 3)."""
        _, J = self.conditions(q)
        scale = np.tile([1.0, 1.0, 1.0 / self.size], len(self.mechanics.blocks))
        values = np.linalg.svd(J * scale, compute_uv=False) if len(J) else np.zeros(0)
        return self.unknowns - int((values > RANK * values.max(initial=0.0)).sum())

    def velocity(self, q: Array) -> Array:
        """Return the motion (3 G,) of the displaced mechanism whose control point moves by one."""
        _, J = self.conditions(q)
        _, row = self.controlled(q)
        right = np.zeros(len(J) + 1)
        right[-1] = 1.0
        found: Array = self._least(np.vstack([J, row]), right)
        return found

    def _least(self, A: Array, b: Array) -> Array:
        """Return the least-squares solution, rotations measured by the size of the mechanism."""
        scale = np.tile([1.0, 1.0, 1.0 / self.size], len(self.mechanics.blocks))
        solved: Array = scale * np.linalg.lstsq(A * scale, b, rcond=RANK)[0]
        return solved

    def moved(self, q: Array, d: float) -> Array | None:
        """Return the configuration (G, 3) whose control point has moved by ``d``, from a near one; None if none is."""
        q = q.copy()
        for _ in range(30):
            values, J = self.conditions(q)
            at, row = self.controlled(q)
            wrong = np.append(values, at - d)
            if float(np.abs(wrong).max()) <= CLOSED * self.size:
                return q
            step = self._least(np.vstack([J, row]), -wrong).reshape(-1, 3)
            if not np.isfinite(step).all() or float(np.abs(step[:, 2]).max()) > 1.0:
                return None
            q = q + step
        return None

    # -- forces -------------------------------------------------------------------------------------------------------

    def gathered(self, q: Array, forces: tuple[Force, ...]) -> Array:
        """Return the forces on the unknowns (3 G,)."""
        total = np.zeros(self.unknowns)
        for f in forces:
            total += self.row(q, f.block, f.point, f.force)
        return total

    def tie_state(self, q: Array, rate: Array | None = None) -> tuple[Array, Array, Array]:
        """Return forces (n,) [kN], elongations (n,) [m] of the ties that are not bars, and their pull (3 G,).

        Parameters
        ----------
        q : (G, 3) array
        rate : (3 G,) array, optional
            Motion under which ties that get longer yield at once and others are slack, as at the onset of a mechanism;
            by default they have the force of their elongation.
        """
        pull = np.zeros(self.unknowns)
        forces, longer = np.zeros(len(self.ties)), np.zeros(len(self.ties))
        for k, (tie, a, b) in enumerate(self.ties):
            at_a, at_b = np.array(tie.at_a), np.array(tie.at_b)
            apart = self.between(q, a, at_a, b, at_b)
            length, first = float(np.linalg.norm(apart)), float(np.linalg.norm(at_b - at_a))
            longer[k] = length - first
            along = apart / length
            shortening = self.row(q, a, at_a, along) - self.row(q, b, at_b, along)
            forces[k] = tie.force(longer[k]) if rate is None else tie.most if shortening @ rate < 0 else 0.0
            pull += forces[k] * shortening
        return forces, longer, pull

    def balance(self, q: Array, *, plastic: bool = False) -> Point | None:
        """Return the equilibrium of a configuration (G, 3), or None where there is none."""
        v = self.velocity(q)
        columns: list[Array] = []
        first: list[int] = []
        fixed = np.zeros(self.unknowns)
        pushing: list[int] = []
        rough: list[tuple[int, float, float]] = []
        for joint in self.joints(q):
            first.append(len(columns))
            if joint.kind == "hinge":
                normal = joint.normal if joint.end is None else self.normal(q, joint)
                for axis in (normal, turned_left(normal)):
                    columns.append(self.row(q, joint.b, joint.on_b, axis) - self.row(q, joint.a, joint.point, axis))
                pushing += [first[-1]] if not joint.pulls else []
                if joint.end is not None:
                    rough.append((first[-1], joint.friction, joint.cohesion))
            elif joint.kind == "roller":
                normal = self.normal(q, joint)
                tangent = turned_left(normal)
                row = self.row(q, joint.b, joint.point, normal) - self.row(q, joint.a, joint.point, normal)
                block = joint.b if joint.face else joint.a
                if block != GROUND:
                    row[3 * block + 2] += float(self.apart(q, joint) @ tangent)
                if joint.friction or joint.cohesion:
                    along = self.row(q, joint.b, joint.point, tangent) - self.row(q, joint.a, joint.point, tangent)
                    slip = float(np.sign(along @ v))
                    row = row - slip * joint.friction * along
                    fixed -= slip * joint.cohesion * along
                pushing += [first[-1]] if not joint.pulls else []
                columns.append(row)
            else:
                assert joint.end is not None
                along = self.apart(q, joint)
                along = along / float(np.linalg.norm(along))
                columns.append(self.row(q, joint.a, joint.point, along) - self.row(q, joint.b, joint.end, along))
        forces, longer, pull = self.tie_state(q, v if plastic else None)
        load = self.gathered(q, self.dead) + fixed + pull
        push = self.gathered(q, self.push)
        weight = np.tile([1.0, 1.0, 1.0 / self.size], len(self.mechanics.blocks))
        A = np.column_stack([*columns, push]) * weight[:, None]
        solved = np.linalg.lstsq(A, -weight * load, rcond=RANK)[0]
        left = A @ solved + weight * load
        top = max(float(np.abs(f.force).max()) for f in (*self.dead, *self.push))
        if float(np.abs(left).max()) > LINKAGE_BALANCED * top * 10:
            return None
        pressed = all(solved[i] > -1e-6 * top for i in pushing) and all(
            -1e-6 * top < solved[i] < joint.strength + 1e-6 * top
            for i, joint in zip(first, self.mechanics.joints, strict=True)
            if joint.kind == "bar"
        )
        pressed = pressed and all(abs(solved[i + 1]) <= (1.0 + GRIP) * (mu * solved[i] + c) for i, mu, c in rough)
        return Point(q, float(solved[-1]), forces, longer, pressed, solved[first])
