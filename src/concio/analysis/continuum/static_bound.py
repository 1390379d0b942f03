r"""Lower bound of the limit load of a continuum: stresses in balance that nowhere leave the strength domain.

In each triangle stresses vary linearly, from one triangle to the next they may jump. With dead and live loads b_0, b_1
in the body and p_0, p_1 on its edges, the largest lambda is sought with

.. math:: \mathrm{div}\,\sigma + b_0 + \lambda b_1 = 0, \qquad [\sigma n] = 0, \qquad
          \sigma n = p_0 + \lambda p_1, \qquad n_i \cdot \sigma \le h_i,

the strength of the joint in place of the third on supports. Everything is linear along edges and within triangles, so
that conditions at the corners hold everywhere, and the bound is one of the continuum, not of its mesh (Sloan, Lower
bound limit analysis using finite elements and linear programming, Int. J. Numer. Anal. Meth. Geomech. 12, 1988).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.continuum.continuum import Continuum
from concio.analysis.continuum.joint_domain import joint_half_planes
from concio.errors import SolverError
from concio.kinematics.frames import turned_left, turned_right
from concio.read_only import read_only
from concio.solvers.statics.programme import optimise

Array = np.ndarray


@dataclass(frozen=True, eq=False)
@read_only
class StaticBound:
    """Stresses that prove a multiplier from below.

    Parameters
    ----------
    multiplier : float
        ``inf`` where the load can grow without bound, ``nan`` where not even the dead load is carried by such stresses.
    wall : Continuum
        Mesh.
    stress : (e, 3, 3) array
        Of each triangle at its corners: xx, yy, xy [kN/m2].
    residual : float
        Largest imbalance and excess over the strength, recomputed, over the largest stress.
    """

    multiplier: float
    wall: Continuum
    stress: Array
    residual: float


def static_bound(
    wall: Continuum, faces: HalfSpaces, dead: Mapping[str, float], live: Mapping[str, float]
) -> StaticBound:
    """Return the best lower bound on this mesh.

    Parameters
    ----------
    wall : Continuum
    faces : HalfSpaces
        Strength domain [kN/m2].
    dead, live : mapping
        Load factors of the load that stays and of the load that grows, all groups named.
    """
    e = len(wall.triangles)
    unit = max(float(np.abs(wall.force(g)).max()) * float(np.ptp(wall.points, axis=0).max()) for g in (dead, live))
    unit = max([unit, *(float(np.abs(wall.pull(g)).max(initial=0.0)) for g in (dead, live))]) or 1.0
    A, b_dead, b_live = _equations(wall, dead, live, unit)
    G, h = _inequalities(wall, faces, unit)
    columns = sp.csc_array(sp.hstack([A, sp.csc_array(-b_live[:, None])]))
    rows = sp.csc_array(sp.hstack([G, sp.csc_array((G.shape[0], 1))]))
    bounds = np.tile([-np.inf, np.inf], (9 * e + 1, 1))
    cost = np.r_[np.zeros(9 * e), -1.0]
    result = optimise(cost, (columns, b_dead), bounds, (rows, h), method="highs")
    nothing = np.zeros((e, 3, 3))
    if result.status == 2:
        return StaticBound(np.nan, wall, nothing, np.inf)
    if result.status == 3:
        return _without_end(wall, (A, b_dead, b_live), (G, h), unit)
    if result.status != 0:
        msg = f"the linear programme of the continuum's lower bound stopped: {result.message}"
        raise SolverError(msg, hint="use a coarser mesh")
    x, multiplier = result.x[:-1], float(result.x[-1])
    size = float(np.abs(x).max()) or 1.0
    left = np.abs(A @ x - b_dead - multiplier * b_live).max(initial=0.0)
    excess = np.maximum(G @ x - h, 0.0).max(initial=0.0)
    return StaticBound(multiplier, wall, (x * unit).reshape(e, 3, 3), float(max(left, excess)) / size)


def _without_end(
    wall: Continuum, equations: tuple[sp.csc_array, Array, Array], strength: tuple[sp.csc_array, Array], unit: float
) -> StaticBound:
    """Return the bound that stresses for the dead load and others, in any multiple, for the live load prove."""
    (A, b_dead, b_live), (G, h) = equations, strength
    free = np.tile([-np.inf, np.inf], (A.shape[1], 1))
    residual, stress = 0.0, np.zeros(A.shape[1])
    for right, room in ((b_live, 0.0 * h), (b_dead, h)):
        result = optimise(np.zeros(A.shape[1]), (A, right), free, (G, room), method="highs")
        if result.status != 0:
            return StaticBound(np.nan, wall, np.zeros((len(wall.triangles), 3, 3)), np.inf)
        stress = result.x
        size = float(np.abs(stress).max()) or 1.0
        excess = max(np.abs(A @ stress - right).max(initial=0.0), np.maximum(G @ stress - room, 0.0).max(initial=0.0))
        residual = max(residual, float(excess) / size)
    return StaticBound(np.inf, wall, (stress * unit).reshape(len(wall.triangles), 3, 3), residual)


def _equations(
    wall: Continuum, dead: Mapping[str, float], live: Mapping[str, float], unit: float
) -> tuple[sp.csc_array, Array, Array]:
    """Return (A, b0, b1): A sigma = b0 + lambda b1, stresses in units of ``unit``, lengths in those of a triangle."""
    e, points, cells = len(wall.triangles), wall.points, wall.triangles
    length = float(np.sqrt(wall.areas.mean()))
    p = points[cells] / length
    area = 2 * wall.areas / length**2
    blocks, right = [], []
    # balance within: gradients of the corner functions
    rows, columns, values = [], [], []
    for k in range(3):
        q, r = p[:, (k + 1) % 3], p[:, (k + 2) % 3]
        gx, gy = (q[:, 1] - r[:, 1]) / area, (r[:, 0] - q[:, 0]) / area
        at = 9 * np.arange(e) + 3 * k
        for row, column, value in ((0, 0, gx), (0, 2, gy), (1, 2, gx), (1, 1, gy)):
            rows.append(2 * np.arange(e) + row)
            columns.append(at + column)
            values.append(value)
    blocks.append(sp.csr_array((_cat(values), (_cat(rows), _cat(columns))), shape=(2 * e, 9 * e)))
    right.append([-np.tile(wall.force(g) * length / unit, e) for g in (dead, live)])
    # traction from triangle to triangle
    a, ca, b, cb, normal = inner_edges(cells, points)
    jump = traction_rows(a, ca, normal, e) - traction_rows(b, cb, normal, e)
    blocks.append(jump)
    right.append([np.zeros(jump.shape[0])] * 2)
    # traction on free edges
    free = np.flatnonzero(wall.held_by < 0)
    ends = corners_of(wall, free)
    blocks.append(traction_rows(wall.element[free], ends, wall.outward[free], e))
    right.append([np.repeat(wall.pull(g)[free], 2, axis=0).ravel() / unit for g in (dead, live)])
    b_dead, b_live = (np.concatenate([part[k] for part in right]) for k in (0, 1))
    return sp.csc_array(sp.vstack(blocks)), b_dead, b_live


def _inequalities(wall: Continuum, faces: HalfSpaces, unit: float) -> tuple[sp.csc_array, Array]:
    """Return (G, h): the strength of the continuum at all corners, and of the joints on supports."""
    e = len(wall.triangles)
    blocks = [sp.kron(sp.eye_array(3 * e), sp.csr_array(faces.normals), format="csr")]
    right = [np.tile(faces.offsets / unit, 3 * e)]
    for number, (_, law) in enumerate(wall.supports):
        held = np.flatnonzero(wall.held_by == number)
        m, g = joint_half_planes(law)
        n = wall.outward[held]
        across = traction_rows(wall.element[held], corners_of(wall, held), n, e)
        turn = np.stack([n, turned_left(n)], axis=1)  # traction to (s, t)
        frames = np.repeat(turn, 2, axis=0)
        rows = sp.block_diag([m @ f for f in frames], format="csr") if len(frames) else sp.csr_array((0, 0))
        blocks.append(sp.csr_array(rows @ across))
        right.append(np.tile(g / unit, len(frames)))
    return sp.csc_array(sp.vstack(blocks)), np.concatenate(right)


def inner_edges(cells: Array, points: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return both triangles (i,) of each inner edge, the numbers (i, 2) of its ends in them, and its normal (i, 2)."""
    edges = np.concatenate([cells[:, [k, (k + 1) % 3]] for k in range(3)])
    owner = np.tile(np.arange(len(cells)), 3)
    local = np.repeat(np.arange(3), len(cells))
    order = np.lexsort(np.sort(edges, axis=1).T)
    same = (np.sort(edges[order], axis=1)[1:] == np.sort(edges[order], axis=1)[:-1]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    ca = np.column_stack([local[first], (local[first] + 1) % 3])
    cb = np.column_stack([(local[second] + 1) % 3, local[second]])  # runs the other way
    along = points[edges[first, 1]] - points[edges[first, 0]]
    normal = turned_right(along) / np.hypot(*along.T)[:, None]
    return owner[first], ca, owner[second], cb, normal


def corners_of(wall: Continuum, chosen: Array) -> Array:
    """Return the numbers (k, 2) of the ends of boundary edges in their triangles."""
    cells = wall.triangles[wall.element[chosen]]
    found: Array = np.argmax(cells[:, None, :] == wall.edges[chosen][:, :, None], axis=2)
    return found


def traction_rows(element: Array, corner: Array, normal: Array, e: int) -> sp.csr_array:
    """Return rows (4 k, 9 e): tractions (x, y) at both ends of k edges from the stresses at the triangles' corners."""
    k = len(element)
    at = 9 * element[:, None] + 3 * corner  # (k, 2)
    row = 4 * np.arange(k)[:, None] + 2 * np.arange(2)
    nx, ny = np.broadcast_to(normal[:, :1], (k, 2)), np.broadcast_to(normal[:, 1:], (k, 2))
    rows = np.concatenate([(row + r).ravel() for r in (0, 0, 1, 1)])
    columns = np.concatenate([(at + c).ravel() for c in (0, 2, 2, 1)])
    values = np.concatenate([v.ravel() for v in (nx, ny, nx, ny)])
    return sp.csr_array((values, (rows, columns)), shape=(4 * k, 9 * e))


def _cat(parts: list[Array]) -> Array:
    return np.concatenate(parts)
