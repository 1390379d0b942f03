"""Supports: unknowns held at the nodes, and movements of fixed bodies that act through the contact pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.arguments import closest
from concio.contact.face_loads import near_polygon
from concio.contact.pairs import Pairs
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID, Discretisation
from concio.kinematics.rigid import rigid_operator, swept
from concio.model.model import Support
from concio.problem.tolerances import NO_MOVEMENT
from concio.representation import short_repr

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Condition:
    """One displacement component of one point that a support holds.

    Parameters
    ----------
    support : int
        Number of the support in the model.
    axis : {0, 1, 2}
        Along x, y or z.
    unknowns, coefficients : (k,) arrays
        The component is ``coefficients @ u_body[unknowns]``.
    value : float
        Imposed value [m].
    """

    support: int
    axis: int
    unknowns: Array
    coefficients: Array
    value: float


@short_repr
@dataclass(frozen=True, eq=False)
class Supported:
    """What supports do to the unknowns: u = T q + sum over groups of factor * u0.

    Parameters
    ----------
    T : (N_all, N) CSR array
        From free unknowns q to all unknowns of the bodies; columns orthonormal.
    bodies : (B+1,) integer array
        Free unknowns of body b are ``bodies[b]:bodies[b+1]``.
    imposed : dict of (N_all,) arrays
        Imposed displacements u0 of each group [m].
    R : (N, r) CSC array
        Rigid motions left free, orthonormal body by body.
    held : dict of body number to tuple of Condition
    """

    T: sp.csr_array
    bodies: Array
    imposed: dict[str, Array]
    R: sp.csc_array
    held: dict[int, tuple[Condition, ...]]

    def reactions(self, disc: Discretisation, rest: Array) -> dict[str, tuple[float, ...]]:
        """Return the force (x, y) or (x, y, z) of each support on the structure [kN].

        Parameters
        ----------
        disc : Discretisation
        rest : (N_all,) array
            What the supports must balance: K u - f - C' t [kN].

        Notes
        -----
        Where several supports hold the same unknown, the force is shared among them by least norm.
        """
        total = np.zeros((len(disc.model.supports), disc.dim))
        for b, conditions in self.held.items():
            own = rest[disc.offsets[b] : disc.offsets[b + 1]]
            if disc.shape_of[b] == RIGID:
                A = _matrix(conditions, len(own))
                forces, *_ = np.linalg.lstsq(A.T, own, rcond=None)
            else:
                at = np.array([c.unknowns[0] for c in conditions])
                forces = own[at] / np.bincount(at)[at]
            for condition, force in zip(conditions, forces, strict=True):
                total[condition.support, condition.axis] += force
        supports = disc.model.supports
        named = {c.support for conditions in self.held.values() for c in conditions}
        return {supports[i].name: tuple(total[i].tolist()) for i in sorted(named)}


def apply_supports(disc: Discretisation) -> Supported:
    """Return the free unknowns of a discretised model and its rigid motions.

    Raises
    ------
    InputError
        A support names no body, holds no node, or contradicts another; two have one name.
    """
    model = disc.model
    held: dict[int, list[Condition]] = {}
    number = {b.name: i for i, b in enumerate(model.bodies)}
    names = {b.name for b in model.bodies if b.kind == "fixed"}
    for i, support in enumerate(model.supports):
        where = f"support '{support.name}'"
        if support.body not in number:
            msg = f"holds '{support.body}', but no body has that name"
            hint = closest(support.body, number, otherwise="see the names with 'concio check'")
            raise InputError(msg, where=where, hint=hint)
        if not np.isfinite([*support.displacement, *np.atleast_1d(support.rotation)]).all():
            msg = "an imposed displacement is not finite"
            raise InputError(msg, where=where)
        b = number[support.body]
        if disc.shape_of[b] == FIXED:
            if support.moves and (support.edge is not None or support.polygon is not None):
                msg = f"'{support.body}' is fixed and moves as a whole: no part of it can be moved"
                raise InputError(msg, where=where, hint="leave the place out, or divide it into several fixed blocks")
            continue
        if support.name in names:
            msg = "another support or fixed body has the same name"
            raise InputError(msg, where=where, hint="reactions are reported by name: give it one of its own")
        names.add(support.name)
        held.setdefault(b, []).extend(_conditions(disc, b, i))
    rows, columns, values = [], [], []
    sizes = np.zeros(len(model.bodies), dtype=np.int64)
    motions: list[tuple[int, Array]] = []
    imposed: dict[str, Array] = {}
    at = 0
    for b in range(len(model.bodies)):
        first, last = int(disc.offsets[b]), int(disc.offsets[b + 1])
        n = last - first
        if n == 0:
            continue
        R = np.eye(n) if disc.shape_of[b] == RIGID else disc.shapes[disc.shape_of[b]].R
        if b not in held:
            row, column, value, free = np.arange(n), np.arange(n), np.ones(n), R
        else:
            row, column, value, free = _left_free(held[b], R, disc.shape_of[b] == RIGID)
            for group, u0 in _particular(held[b], n, disc, b).items():
                imposed.setdefault(group, np.zeros(disc.unknowns))[first:last] += u0
        rows.append(first + row)
        columns.append(at + column)
        values.append(value)
        if free.shape[1]:
            motions.append((at, free))
        sizes[b] = free.shape[0]
        at += int(sizes[b])
    T = sp.csr_array((_cat(values), (_cat(rows), _cat(columns))), shape=(disc.unknowns, at))
    done = {b: tuple(conditions) for b, conditions in held.items()}
    return Supported(T, np.concatenate([[0], np.cumsum(sizes)]), imposed, _motions(motions, at), done)


def moved_obstacles(disc: Discretisation, pairs: Pairs) -> dict[str, tuple[Array, Array]]:
    """Return what moved obstacles add to the normal (m,) and tangential (m, d-1) displacement, by group [m]."""
    moved: dict[str, tuple[Array, Array]] = {}
    number = {b.name: i for i, b in enumerate(disc.model.bodies)}
    rough = pairs.interface >= 0  # ties have no tangential motion; along a tie a rigid motion is the same everywhere
    for support in disc.model.supports:
        b = number[support.body]
        if disc.shape_of[b] != FIXED:
            continue
        none = (np.zeros(len(pairs)), np.zeros((len(pairs), disc.dim - 1)))
        normal, tangential = moved.setdefault(support.group, none)
        motion = _moved(support, pairs.point, disc.centroids[b])
        sign = (pairs.body_b == b).astype(float) - (pairs.body_a == b)
        normal += sign * (motion * pairs.normal).sum(1)
        tangential += (sign * rough)[:, None] * np.einsum("md,mtd->mt", motion, pairs.tangents)
    return moved


def _conditions(disc: Discretisation, b: int, number: int) -> list[Condition]:
    """Return what one support holds of body b."""
    chosen, points, motion, axes = points_held(disc, b, number)
    found = []
    for k, point, moved in zip(chosen.tolist(), points, motion, strict=True):
        for axis in axes:
            if disc.shape_of[b] == RIGID:
                row = rigid_operator(point - disc.centroids[b], disc.reach[b])[axis]
                found.append(Condition(number, axis, np.arange(len(row)), row, float(moved[axis])))
            else:
                own = np.array([disc.dim * k + axis])
                found.append(Condition(number, axis, own, np.ones(1), float(moved[axis])))
    return found


def points_held(disc: Discretisation, b: int, number: int) -> tuple[Array, Array, Array, tuple[int, ...]]:
    """Return what a support holds of body b: nodes (k,), their places (k, d), imposed motions (k, d) [m], and axes.

    Raises
    ------
    InputError
        It holds no node.
    """
    support = disc.model.supports[number]
    where = f"support '{support.name}'"
    axes = tuple(i for i, axis in enumerate("xyz"[: disc.dim]) if axis in support.directions)
    points = disc.nodes(b)
    chosen = np.arange(len(points))
    region = support.edge if support.edge is not None else support.polygon
    if region is not None:
        corners = np.array(region, dtype=float)
        size = float(np.ptp(disc.model.bodies[b].vertices, axis=0).max())
        if disc.shape_of[b] == RIGID:
            points = np.unique(corners, axis=0)
            chosen = np.arange(len(points))
        elif support.edge is not None:
            chosen = _near(points, corners[0], corners[1], 1e-6 * size)
        else:
            chosen = np.flatnonzero(near_polygon(points, corners, 1e-6 * size))
        if not len(chosen):
            text = " - ".join(f"({', '.join(f'{v:g}' for v in point)})" for point in corners)
            msg = f"no node of '{support.body}' lies on {text}"
            raise InputError(msg, where=where, hint="give a segment or a polygon on the surface of the block")
    points = points[chosen]
    if len(points) == 1 and np.any(support.rotation):
        msg = f"one point of '{support.body}' is held: a rotation imposed there does not turn the body"
        raise InputError(msg, where=where, hint="hold a segment or the whole body, or give the point a displacement")
    motion = np.array([_moved(support, point, disc.centroids[b]) for point in points])
    return chosen, points, motion, axes


def _moved(support: Support, point: Array, centroid: Array) -> Array:
    moved = np.array(support.displacement) + swept(np.asarray(support.rotation), point - centroid)
    return np.where(np.abs(moved) < NO_MOVEMENT, 0.0, moved)


def _near(points: Array, p: Array, q: Array, tolerance: float) -> Array:
    along = q - p
    length2 = float(along @ along)
    share = np.clip((points - p) @ along / length2, 0.0, 1.0) if length2 > 0 else np.zeros(len(points))
    return np.flatnonzero(np.linalg.norm(points - p - share[:, None] * along, axis=1) <= tolerance)


def _matrix(conditions: Sequence[Condition], n: int) -> Array:
    A = np.zeros((len(conditions), n))
    for i, c in enumerate(conditions):
        A[i, c.unknowns] = c.coefficients
    return A


def _left_free(conditions: list[Condition], R: Array, rigid: bool) -> tuple[Array, Array, Array, Array]:
    """Return rows, columns, values of an orthonormal basis (n, k) of what stays free, and its rigid motions (k, r)."""
    n = len(R)
    if rigid:
        _, s, vt = np.linalg.svd(_matrix(conditions, n), full_matrices=True)
        basis = vt[int((s > 1e-9 * s.max()).sum()) :].T
        row, column = np.nonzero(basis)
        return row, column, basis[row, column], np.eye(basis.shape[1])
    fixed = np.unique([c.unknowns[0] for c in conditions])
    free = np.delete(np.arange(n), fixed)
    _, s, vt = np.linalg.svd(np.linalg.qr(R[fixed], mode="r"), full_matrices=True)
    left = vt[int((s > 1e-9).sum()) :].T
    motions = np.linalg.qr(R[free] @ left)[0] if left.shape[1] else np.zeros((len(free), 0))
    return free, np.arange(len(free)), np.ones(len(free)), motions


def _particular(conditions: list[Condition], n: int, disc: Discretisation, b: int) -> dict[str, Array]:
    """Return displacements (n,) of body b that satisfy the conditions, for each group that moves it.

    Raises
    ------
    InputError
        Two conditions contradict each other.
    """
    group = np.array([disc.model.supports[c.support].group for c in conditions])
    value = np.array([c.value for c in conditions])
    found = {}
    for name in dict.fromkeys(group[value != 0].tolist()):
        wanted = np.where(group == name, value, 0.0)
        if disc.shape_of[b] == RIGID:
            A = _matrix(conditions, n)
            u0, *_ = np.linalg.lstsq(A, wanted, rcond=None)
            error = np.abs(A @ u0 - wanted).max()
        else:
            at = np.array([c.unknowns[0] for c in conditions])
            u0 = np.zeros(n)
            u0[at] = wanted
            error = np.abs(u0[at] - wanted).max()
        if error > 1e-9 * np.abs(wanted).max():
            msg = f"supports impose contradictory displacements on '{disc.model.bodies[b].name}'"
            raise InputError(msg, hint="a node can be moved only one way")
        found[str(name)] = u0
    return found


def _motions(blocks: list[tuple[int, Array]], n: int) -> sp.csc_array:
    rows, values, counts = [], [], []
    for at, R in blocks:
        rows.append(np.tile(np.arange(at, at + R.shape[0]), R.shape[1]))
        values.append(R.T.ravel())
        counts.append(np.full(R.shape[1], R.shape[0]))
    if not rows:
        return sp.csc_array((n, 0))
    indptr = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    R_all = sp.csc_array((np.concatenate(values), np.concatenate(rows), indptr), shape=(n, len(indptr) - 1))
    R_all.eliminate_zeros()
    return R_all


def _cat(parts: list[Array]) -> Array:
    return np.concatenate(parts) if parts else np.zeros(0, dtype=int)
