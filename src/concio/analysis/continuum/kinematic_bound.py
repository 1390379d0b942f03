r"""Upper bound of the limit load of a continuum: a mechanism whose strain rates the strength domain admits.

Velocities are quadratic in six-node triangles with straight sides, strain rates linear in each. At every corner of a
triangle the strain rate is a combination of the outward normals of the strength domain,

.. math:: \dot\varepsilon = \sum_i \mu_i n_i, \qquad \mu_i \ge 0, \qquad d = \sum_i \mu_i h_i ,

and, both being linear, everywhere between them, so that the power absorbed is a third of the area for each corner. On
supports velocities vary linearly and the joints open and slide likewise by normals of theirs. With the live power equal
to one, the least absorbed less dead power bounds the multiplier from above (after Makrodimopoulos and Martin, Upper
bound limit analysis using simplex strain elements and second-order cone programming, Int. J. Numer. Anal. Meth.
Geomech. 31, 2007; here with linear programmes, for the domain is a polyhedron).
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
from concio.kinematics.frames import turned_left
from concio.problem.tolerances import DEAD_POWER
from concio.read_only import read_only
from concio.solvers.statics.programme import Optimum, optimise

Array = np.ndarray


@dataclass(frozen=True, eq=False)
@read_only
class KinematicBound:
    """A mechanism that proves a multiplier from above.

    Parameters
    ----------
    multiplier : float
        ``inf`` where no mechanism bounds the load; ``-inf`` where one moves under the dead load, whatever the live one.
    wall : Continuum
        Mesh.
    velocity : (n, 2) array
        At the nodes of the mesh, largest entry 1.
    strain_rate : (e, 3) array
        Mean of each triangle, for the same velocity [1/m].
    residual : float
        Largest strain rate or joint motion that the normals do not make up, recomputed, over the largest of them.
    """

    multiplier: float
    wall: Continuum
    velocity: Array
    strain_rate: Array
    residual: float


def kinematic_bound(
    wall: Continuum,
    faces: HalfSpaces,
    dead: Mapping[str, float],
    live: Mapping[str, float],
    *,
    unsupported: bool = False,
) -> KinematicBound:
    """Return the best upper bound on this mesh; arguments as of the lower one (``static_bound``).

    Parameters
    ----------
    wall, faces, dead, live
    unsupported : bool
        No stresses were found that carry the dead load: a mechanism under it alone is sought first. Where there is one
        the programme of the multiplier has no end, and the simplex method may not find that out.

    Raises
    ------
    SolverError
        The linear programme stopped without an answer.
    """
    e = len(wall.triangles)
    nodes = six_nodes(wall)
    n = nodes.count
    length = float(np.sqrt(wall.areas.mean()))
    weights = np.repeat(wall.areas / length**2 / 3, 3)
    strain = corner_strains(wall, nodes) * length  # (9 e, 2 n), velocities in any unit
    normals = sp.kron(sp.eye_array(3 * e), sp.csr_array(faces.normals.T), format="csr")
    unit = faces.size
    cost_mu = np.repeat(weights, len(faces)) * np.tile(faces.offsets / unit, 3 * e)
    joint_rows, joint_normals, joint_cost = _joints(wall, nodes, unit, length)
    straight = _straight(wall, nodes)
    power = [_power(wall, nodes, g, length) / unit for g in (dead, live)]
    k_mu, k_nu = normals.shape[1], joint_normals.shape[1]
    A = sp.block_array(
        [
            [strain, -normals, None],
            [joint_rows, None, -joint_normals],
            [straight, None, None],
            [sp.csr_array(power[1][None] / (float(np.abs(power[1]).sum()) or 1.0)), None, None],
        ],
        format="csc",
    )
    b = np.r_[np.zeros(A.shape[0] - 1), 1.0]
    bounds = np.vstack([np.tile([-np.inf, np.inf], (2 * n, 1)), np.tile([0.0, np.inf], (k_mu + k_nu, 1))])
    cost = np.r_[-power[0], cost_mu, joint_cost]
    nothing = KinematicBound(np.inf, wall, np.zeros_like(wall.points), np.zeros((e, 3)), np.inf)
    result, worthless = _optimum(cost, (sp.csc_array(A), b), bounds, 2 * n, unsupported=unsupported)
    if result.status == 2:
        return nothing
    if result.status != 0:
        msg = f"the linear programme of the continuum's upper bound stopped: {result.message}"
        raise SolverError(msg, hint="use a coarser mesh")
    u, mu, nu = np.split(result.x, [2 * n, 2 * n + k_mu])
    mu, nu = np.maximum(mu, 0.0), np.maximum(nu, 0.0)
    rate, motion = strain @ u, joint_rows @ u
    size = float(max(np.abs(rate).max(initial=0.0), np.abs(motion).max(initial=0.0))) or 1.0
    parts = (rate - normals @ mu, motion - joint_normals @ nu, straight @ u)
    left = max(float(np.abs(part).max(initial=0.0)) for part in parts)
    needed = float(cost_mu @ mu + joint_cost @ nu) - float(power[0] @ u)
    if worthless:
        left = max(left, abs(float(power[1] @ u)) / (float(np.abs(power[1]).sum()) or 1.0))
        multiplier = -np.inf if needed < -DEAD_POWER * float(np.abs(power[0]) @ np.abs(u)) else np.nan
    else:
        multiplier = needed / float(power[1] @ u)
    top = float(np.abs(u).max()) or 1.0
    velocity = u.reshape(-1, 2)[: len(wall.points)] / top
    mean = (rate / length).reshape(e, 3, 3).mean(axis=1) / top
    return KinematicBound(multiplier, wall, velocity, mean, left / size)


def _optimum(
    cost: Array, equations: tuple[sp.csc_array, Array], bounds: Array, velocities: int, *, unsupported: bool
) -> tuple[Optimum, bool]:
    """Return the optimum, and whether it is a mechanism of bounded velocities on which the live load does no work."""
    A, b = equations
    slow = np.vstack([np.tile([-1.0, 1.0], (velocities, 1)), bounds[velocities:]])
    if unsupported:
        result = optimise(cost, (A, np.zeros_like(b)), slow, method="highs")
        power = np.abs(cost[:velocities]) @ np.abs(result.x[:velocities]) if result.status == 0 else np.inf
        if result.status == 0 and float(cost @ result.x) < -DEAD_POWER * float(power):
            return result, True
    result = optimise(cost, (A, b), bounds, method="highs")
    if result.status != 3:
        return result, False
    return optimise(cost, (A, np.zeros_like(b)), slow, method="highs"), True


@dataclass(frozen=True, eq=False)
class SixNodes:
    """Quadratic numbering: corners first, then the middles of all edges.

    Parameters
    ----------
    count : int
        Number of nodes.
    cells : (e, 6) array
        Corners 0, 1, 2, then the middles of edges 01, 12, 20.
    middle : dict of (int, int) to int
        Node in the middle of an edge by its sorted ends.
    """

    count: int
    cells: Array
    middle: Mapping[tuple[int, int], int]


def six_nodes(wall: Continuum) -> SixNodes:
    """Return the quadratic numbering of a mesh."""
    cells = wall.triangles
    edges = np.sort(np.concatenate([cells[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    known, back = np.unique(edges, axis=0, return_inverse=True)
    first = len(wall.points)
    middles = first + back.reshape(3, -1).T
    table = {(int(a), int(b)): first + k for k, (a, b) in enumerate(known)}
    return SixNodes(first + len(known), np.hstack([cells, middles]), table)


def corner_strains(wall: Continuum, nodes: SixNodes) -> sp.csr_array:
    """Return rows (9 e, 2 n): strain rates xx, yy, engineering xy at the corners of the triangles from velocities."""
    p, e = wall.points[wall.triangles], len(wall.triangles)
    double = 2 * wall.areas
    gradient = np.empty((e, 3, 2))
    for k in range(3):
        q, r = p[:, (k + 1) % 3], p[:, (k + 2) % 3]
        gradient[:, k] = np.column_stack([q[:, 1] - r[:, 1], r[:, 0] - q[:, 0]]) / double[:, None]
    rows, columns, values = [], [], []
    for c in range(3):  # at corner c: barycentric coordinate c is one, the others zero
        shape = np.zeros((e, 6, 2))
        for k in range(3):
            shape[:, k] = (4.0 * (k == c) - 1.0) * gradient[:, k]
        for m, (a, b) in enumerate(((0, 1), (1, 2), (2, 0))):
            shape[:, 3 + m] = 4.0 * ((a == c) * gradient[:, b] + (b == c) * gradient[:, a])
        at = 9 * np.arange(e) + 3 * c
        for v in range(6):
            node = nodes.cells[:, v]
            for row, axis, part in ((0, 0, 0), (1, 1, 1), (2, 0, 1), (2, 1, 0)):
                rows.append(at + row)
                columns.append(2 * node + axis)
                values.append(shape[:, v, part])
    shape_of = (9 * e, 2 * nodes.count)
    return sp.csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape_of)


def _joints(wall: Continuum, nodes: SixNodes, unit: float, length: float) -> tuple[sp.csr_array, sp.csr_array, Array]:
    """Return joint motions (4 b, 2 n) at both ends of held edges, their normals (4 b, k) and the power they absorb."""
    rows, columns, values = [], [], []
    blocks, costs, at = [], [], 0
    for number, (_, law) in enumerate(wall.supports):
        m, g = joint_half_planes(law)
        for b in np.flatnonzero(wall.held_by == number):
            n = wall.outward[b]
            frame = np.array([n, turned_left(n)])
            for node in wall.edges[b]:  # the joint opens where the wall moves against its outward normal
                for r in range(2):
                    for axis in range(2):
                        rows.append(at + r)
                        columns.append(2 * node + axis)
                        values.append(-frame[r, axis])
                blocks.append(m.T)
                costs.append(g / unit * wall.lengths[b] / length / 2)
                at += 2
    shape = (at, 2 * nodes.count)
    motions = sp.csr_array((np.array(values), (np.array(rows, dtype=int), np.array(columns, dtype=int))), shape=shape)
    normals = sp.block_diag(blocks, format="csr") if blocks else sp.csr_array((0, 0))
    return motions, sp.csr_array(normals), np.concatenate(costs) if costs else np.zeros(0)


def _straight(wall: Continuum, nodes: SixNodes) -> sp.csr_array:
    """Return rows (2 b, 2 n) that vanish where velocities are linear along held edges."""
    held = np.flatnonzero(wall.held_by >= 0)
    rows, columns, values = [], [], []
    for k, b in enumerate(held):
        a, c = (int(v) for v in wall.edges[b])
        middle = nodes.middle[min(a, c), max(a, c)]
        for axis in range(2):
            rows += [2 * k + axis] * 3
            columns += [2 * middle + axis, 2 * a + axis, 2 * c + axis]
            values += [1.0, -0.5, -0.5]
    return sp.csr_array((values, (rows, columns)), shape=(2 * len(held), 2 * nodes.count))


def _power(wall: Continuum, nodes: SixNodes, factors: Mapping[str, float], length: float) -> Array:
    """Return the power (2 n,) of the loads on unit velocities, over thickness and length [kN/m2]."""
    power = np.zeros((nodes.count, 2))
    force = wall.force(factors)
    np.add.at(power, nodes.cells[:, 3:], (wall.areas / 3)[:, None, None] * force)  # corners of a parabola have none
    pull = wall.pull(factors)
    for b in np.flatnonzero(np.abs(pull).any(axis=1)):
        a, c = (int(v) for v in wall.edges[b])
        middle = nodes.middle[min(a, c), max(a, c)]
        for node, share in ((a, 1 / 6), (c, 1 / 6), (middle, 2 / 3)):
            power[node] += share * wall.lengths[b] * pull[b]
    return power.ravel() / length
