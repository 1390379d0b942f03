"""Supports: unknowns held at the nodes, and movements of fixed bodies that act through the contact pairs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.contact.pairs import Pairs
from concio.errors import InputError

from concio.fem.discretisation import FIXED, RIGID, Discretisation, rigid_rows
from concio.model.model import Support

Array = np.ndarray


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
    """

    T: sp.csr_array
    bodies: Array
    imposed: dict[str, Array]
    R: sp.csc_array


def apply_supports(disc: Discretisation) -> Supported:
    """Return the free unknowns of a discretised model and its rigid motions.

    Raises
    ------
    InputError
        A support names no body, holds no node, or contradicts another.
    """
    held: dict[int, list[tuple[Array, Array, float, str]]] = {}
    number = {b.name: i for i, b in enumerate(disc.model.bodies)}
    for support in disc.model.supports:
        if support.body not in number:
            msg = f"holds '{support.body}', but no body has that name"
            raise InputError(msg, where=f"support '{support.name}'", hint="see the names with 'concio check'")
        b = number[support.body]
        if disc.shape_of[b] != FIXED:
            held.setdefault(b, []).extend(_conditions(disc, b, support))
    count = len(disc.model.bodies)
    rows, columns, values, sizes = [], [], [], np.zeros(count, dtype=np.int64)
    motions: list[tuple[int, Array]] = []
    imposed: dict[str, Array] = {}
    at = 0
    for b in range(count):
        first, last = int(disc.offsets[b]), int(disc.offsets[b + 1])
        n = last - first
        if n == 0:
            continue
        R = np.eye(3) if disc.shape_of[b] == RIGID else disc.shapes[disc.shape_of[b]].R
        if b not in held:
            rows.append(np.arange(first, last))
            columns.append(np.arange(at, at + n))
            values.append(np.ones(n))
            motions.append((at, R))
            sizes[b] = n
        else:
            basis, particular = _solve_conditions(held[b], n, disc.model.bodies[b].name)
            r, c = np.nonzero(basis)
            rows.append(first + r)
            columns.append(at + c)
            values.append(basis[r, c])
            sizes[b] = basis.shape[1]
            left = R - basis @ (basis.T @ R)
            _, s, vt = np.linalg.svd(left, full_matrices=True)
            rank = int((s > 1e-9).sum())
            if rank < R.shape[1]:
                free, _ = np.linalg.qr(basis.T @ (R @ vt[rank:].T))
                motions.append((at, free))
            for group, u0 in particular.items():
                imposed.setdefault(group, np.zeros(disc.unknowns))[first:last] += u0
        at += int(sizes[b])
    T = sp.csr_array((_cat(values), (_cat(rows), _cat(columns))), shape=(disc.unknowns, at))
    return Supported(T, np.concatenate([[0], np.cumsum(sizes)]), imposed, _motions(motions, at))


def moved_obstacles(disc: Discretisation, pairs: Pairs) -> dict[str, tuple[Array, Array]]:
    """Return for each group the change (m,) of the normal and tangential relative displacement by moved obstacles."""
    moved: dict[str, tuple[Array, Array]] = {}
    number = {b.name: i for i, b in enumerate(disc.model.bodies)}
    for support in disc.model.supports:
        b = number[support.body]
        if disc.shape_of[b] != FIXED:
            continue
        arm = pairs.point - disc.centroids[b]
        motion = np.array(support.displacement) + support.rotation * np.column_stack([-arm[:, 1], arm[:, 0]])
        sign = (pairs.body_b == b).astype(float) - (pairs.body_a == b)
        normal, tangential = moved.setdefault(support.group, (np.zeros(len(pairs)), np.zeros(len(pairs))))
        normal += sign * (motion * pairs.normal).sum(1)
        tangential += sign * (motion * pairs.tangent).sum(1)
    return moved


def _conditions(disc: Discretisation, b: int, support: Support) -> list[tuple[Array, Array, float, str]]:
    """Return conditions (unknowns of the body, coefficients, value, group)."""
    where = f"support '{support.name}'"
    axes = [i for i, axis in enumerate("xy") if axis in support.directions]
    if not axes or set(support.directions) - set("xy"):
        msg = f"directions '{support.directions}' are not 'x', 'y' or 'xy'"
        raise InputError(msg, where=where)
    if not np.isfinite([*support.displacement, support.rotation]).all():
        msg = "an imposed displacement is not finite"
        raise InputError(msg, where=where)
    points = disc.nodes(b)
    if support.edge is not None:
        p, q = (np.array(end, dtype=float) for end in support.edge)
        size = float(np.ptp(disc.model.bodies[b].outline, axis=0).max())
        points_on = _near(points, p, q, 1e-6 * size)
        if disc.shape_of[b] == RIGID:
            points = np.unique(np.vstack([p, q]), axis=0)
        elif not len(points_on):
            msg = f"no node of '{support.body}' lies on ({p[0]:g}, {p[1]:g}) - ({q[0]:g}, {q[1]:g})"
            raise InputError(msg, where=where, hint="give a segment on the outline of the block")
    elif disc.shape_of[b] != RIGID:
        points_on = np.arange(len(points))
    conditions: list[tuple[Array, Array, float, str]] = []
    centroid = disc.centroids[b]
    if disc.shape_of[b] == RIGID:
        for x in points:
            rows = rigid_rows(x, centroid, disc.reach[b])
            motion = _moved(support, x, centroid)
            conditions += [(np.arange(3), rows[i], float(motion[i]), support.group) for i in axes]
    else:
        for k in points_on:
            motion = _moved(support, points[k], centroid)
            conditions += [(np.array([2 * k + i]), np.ones(1), float(motion[i]), support.group) for i in axes]
    return conditions


def _moved(support: Support, point: Array, centroid: Array) -> Array:
    x, y = point - centroid
    return np.array(support.displacement) + support.rotation * np.array([-y, x])


def _near(points: Array, p: Array, q: Array, tolerance: float) -> Array:
    along = q - p
    length2 = float(along @ along)
    share = np.clip((points - p) @ along / length2, 0.0, 1.0) if length2 > 0 else np.zeros(len(points))
    return np.flatnonzero(np.linalg.norm(points - p - share[:, None] * along, axis=1) <= tolerance)


def _solve_conditions(
    conditions: list[tuple[Array, Array, float, str]], n: int, name: str
) -> tuple[Array, dict[str, Array]]:
    """Return an orthonormal basis (n, k) of what stays free and a particular solution (n,) of each group."""
    groups = dict.fromkeys(group for *_, group in conditions)
    A = np.zeros((len(conditions), n))
    values = {group: np.zeros(len(conditions)) for group in groups}
    for i, (dofs, coefficients, value, group) in enumerate(conditions):
        A[i, dofs] = coefficients
        values[group][i] = value
    single = (np.count_nonzero(A, axis=1) == 1).all()
    if single:
        fixed = np.unique(np.nonzero(A)[1])
        basis = np.delete(np.eye(n), fixed, axis=1)
    else:
        _, s, vt = np.linalg.svd(A)
        rank = int((s > 1e-9 * s.max()).sum())
        basis = vt[rank:].T
    particular = {}
    for group, value in values.items():
        u0, *_ = np.linalg.lstsq(A, value, rcond=None)
        if np.abs(A @ u0 - value).max() > 1e-9 * max(np.abs(value).max(), 1e-300):
            msg = f"supports impose contradictory displacements on '{name}'"
            raise InputError(msg, hint="a node can be moved only one way")
        if u0.any():
            particular[group] = u0
    return basis, particular


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


