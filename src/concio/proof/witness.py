r"""Exact forces and motions that prove a multiplier from below and from above.

With the joint forces written as sums of rays of the friction cones, F = sum p_j r_j with p >= 0, balance of every
free block under dead and x times live loads is a linear programme for the largest x, and its dual the least work of a
motion that no ray resists. A simplex code finds a basis in floating point. The basis says which p_j are not zero and
which rays the motion leaves at rest: two square systems of fractions, solved exactly
(:mod:`concio.proof.exact_solve`). In the plane the rays are the two edges of the cone, and both answers are one
fraction. In space the cone is round: rays inside it give forces, rays round it motions, and what lies between the two
fractions is told.

Nothing that floating point says is part of the proof: what comes out is handed to :mod:`concio.proof.verify`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

import highspy
import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp

from concio.kinematics.frames import cross as turned
from concio.proof.exact_solve import Row, solve_exactly
from concio.proof.verify import cross, exact, vector
from concio.proof.verify import loads as loads_on

Side = Literal["inside", "outside"]
Vector = list[Fraction]
Ways = Sequence[Sequence[float]] | np.ndarray | None

AROUND = 12
"""Rays of a round cone that are spread evenly."""
NEAR = 1e-3
"""Angle between the rays beside the direction in which a joint slides or is pulled [rad]."""
WITHIN = 1e-12
"""Share by which a ray of a round cone is drawn inwards or outwards, so that rounding leaves it on its side."""
REACHED = 1e-8
"""Share of a column, beside those of a basis, from which it counts as reaching further rows."""
ORIGIN = 64
"""Moments are taken about points whose coordinates are multiples of 1 / ORIGIN m, near each block."""
OPTIONS: tuple[tuple[str, object], ...] = (
    ("output_flag", False), ("solver", "simplex"), ("presolve", "off"), ("threads", 1), ("random_seed", 0),
    ("primal_feasibility_tolerance", 1e-10), ("dual_feasibility_tolerance", 1e-10),
)  # fmt: skip


@dataclass(frozen=True)
class Witness:
    """What a basis gives, exactly; None where it gives none.

    Parameters
    ----------
    multiplier : Fraction
    forces : list of vectors, or None
        Force on side b of each joint point; None where it was not asked for or one was outside its cone.
    motion : list of (velocity of the origin, rotation), or None
        Of each body.
    """

    multiplier: Fraction
    forces: list[Vector] | None
    motion: list[tuple[Vector, Vector]] | None


@dataclass(frozen=True)
class Programme:
    """The balance of every free block, its joint forces as sums of rays.

    Parameters
    ----------
    data : mapping
        Of :func:`concio.proof.statement.statement`.
    dead, live : sequences of (force, moment)
        Loads on each body, about the origin.
    rays : list of (joint, vector)
    """

    data: dict[str, Any]
    dead: Sequence[Sequence[Vector]]
    live: Sequence[Sequence[Vector]]
    rays: list[tuple[int, Vector]]

    def columns(self) -> tuple[list[Row], list[Fraction], dict[int, int], list[Vector]]:
        """Return columns of the rays and of the multiplier last, right side, first row of each free body, origins."""
        bodies, joints = self.data["bodies"], self.data["joints"]
        d = len(bodies[0]["pieces"][0][0])
        rows = d + (1 if d == 2 else 3)
        first = {b: rows * k for k, b in enumerate(b for b, body in enumerate(bodies) if not body["fixed"])}
        origin = [_middle(body) for body in bodies]
        found: list[Row] = []
        for k, ray in self.rays:
            joint, at = joints[k], vector(joints[k]["at"])
            column: Row = {}
            for body, sign in ((joint["b"], 1), (joint["a"], -1)):
                if body in first:
                    arm = [p - q for p, q in zip(at, origin[body], strict=True)]
                    for i, value in enumerate([*ray, *cross(arm, ray)]):
                        if value:
                            column[first[body] + i] = sign * value
            found.append(column)
        found.append(self._loaded(self.live, first, origin))
        right = [Fraction(0)] * (rows * len(first))
        for i, value in self._loaded(self.dead, first, origin).items():
            right[i] = -value
        return found, right, first, origin

    def _loaded(self, loads: Sequence[Sequence[Vector]], first: Mapping[int, int], origin: Sequence[Vector]) -> Row:
        column: Row = {}
        for b, row in first.items():
            force, moment = loads[b]
            about = [m - c for m, c in zip(moment, cross(origin[b], force), strict=True)]
            for i, value in enumerate([*force, *about]):
                if value:
                    column[row + i] = value
        return column


def witness(
    data: dict[str, Any], constant: Mapping[str, Fraction], multiplied: Mapping[str, Fraction], *, side: Side,
    directions: Ways = None, wider: Fraction = Fraction(0),
) -> Witness | None:  # fmt: skip
    """Return the exact forces (rays inside the cones) or the exact motion (rays round them) of the largest multiplier.

    Parameters
    ----------
    data : mapping
        Of :func:`concio.proof.statement.statement`.
    constant, multiplied : mappings of group to factor
    side : {"inside", "outside"}
        In the plane both are the cone itself, and either gives forces and motion.
    directions : sequence of vectors, optional
        In space a tangential direction of interest for each joint point.
    wider : Fraction
        Share by which friction is taken larger than it is: a motion that no such joint resists stays one where rounding
        chose between rays that are all but equal.

    Returns
    -------
    Witness or None
        None where the programme has no last multiplier, or its basis is not that of an exact solution.
    """
    dead, live = loads_on(data, dict(constant)), loads_on(data, dict(multiplied))
    rays = [
        (k, ray)
        for k, joint in enumerate(data["joints"])
        for ray in _rays(joint, side, None if directions is None else directions[k], wider)
    ]
    columns, right, first, origin = Programme(data, dead, live, rays).columns()
    found = _at_basis(columns, right)
    if found is None:
        return None
    value, dual = found
    last = len(columns) - 1
    whole = all(v >= 0 for c, v in value.items() if c != last)
    forces = _forces(data, rays, value) if whole else None
    return Witness(value[last], forces, _motion(data, first, origin, dual))


def forces_below(
    data: dict[str, Any], constant: Mapping[str, Fraction], multiplied: Mapping[str, Fraction], multiplier: Fraction,
    directions: Ways = None,
) -> Witness | None:  # fmt: skip
    """Return exact forces at a multiplier a little below the largest, as far inside the cones as they can be.

    Where several bases are those of one corner, that of :func:`witness` may have forces negative by less than rounding.
    Here the least share of all rays is made as large as it gets, so that rounding has no say.
    """
    acting = {**constant, **{group: multiplier * factor for group, factor in multiplied.items()}}
    rays = [
        (k, ray)
        for k, joint in enumerate(data["joints"])
        for ray in _rays(joint, "inside", None if directions is None else directions[k])
    ]
    nothing = loads_on(data, {})
    columns, right, _, _ = Programme(data, loads_on(data, acting), nothing, rays).columns()
    even: Row = {}
    for column in columns[:-1]:
        for row, value in column.items():
            even[row] = even.get(row, Fraction(0)) + value
    columns[-1] = {row: value for row, value in even.items() if value}
    found = _at_basis(columns, right)
    if found is None:
        return None
    least = found[0][len(columns) - 1]
    shares = {k: least + found[0].get(k, Fraction(0)) for k in range(len(rays))}
    if not all(v >= 0 for v in shares.values()):
        return None
    return Witness(multiplier, _forces(data, rays, shares), None)


def _at_basis(
    columns: Sequence[Row], right: Sequence[Fraction]
) -> tuple[dict[int, Fraction], dict[int, Fraction]] | None:
    """Return the exact values of the basic columns and the exact dual of the rows; None without the last column."""
    basis = _basis(columns, right)
    last = len(columns) - 1
    if basis is None or last not in basis[0]:
        return None
    used, rows = basis
    everywhere, every = _completed(columns, used, rows, len(right))
    primal = solve_exactly(_square(columns, everywhere, every), [right[row] for row in every])
    dual = solve_exactly(_transposed(_square(columns, used, rows)), [Fraction(int(column == last)) for column in used])
    if primal is None or dual is None:
        return None
    return dict(zip(everywhere, primal, strict=True)), {row: dual[i] for i, row in enumerate(rows)}


def _square(columns: Sequence[Row], used: Sequence[int], rows: Sequence[int]) -> list[Row]:
    """Return the rows of the square matrix of some columns and rows."""
    place = {row: i for i, row in enumerate(rows)}
    square: list[Row] = [{} for _ in rows]
    for j, column in enumerate(used):
        for row, value in columns[column].items():
            if row in place:
                square[place[row]][j] = value
    return square


def _transposed(square: Sequence[Row]) -> list[Row]:
    turned: list[Row] = [{} for _ in square]
    for i, row in enumerate(square):
        for j, value in row.items():
            turned[j][i] = value
    return turned


def _completed(columns: Sequence[Row], used: list[int], rows: list[int], m: int) -> tuple[list[int], list[int]]:
    """Return columns that span every row, and the rows: those of a basis and, where it leaves rows out, more columns.

    A basis of a degenerate corner leaves out rows that hold to rounding alone. The further columns take what is
    missing; rows that no column reaches stay left out.
    """
    if len(rows) == m:
        return used, rows
    dense = np.zeros((m, len(columns)))
    for j, column in enumerate(columns):
        for row, value in column.items():
            dense[row, j] = float(value)
    size = np.linalg.norm(dense, axis=0)
    dense /= np.where(size > 0, size, 1.0)
    q = sl.qr(dense[:, used], mode="economic")[0]
    others = np.array([j for j in range(len(columns)) if j not in set(used)], dtype=int)
    left = dense[:, others] - q @ (q.T @ dense[:, others])
    _, r, order = sl.qr(left, mode="economic", pivoting=True)
    count = min(m - len(rows), int((np.abs(np.diag(r)) > REACHED).sum()))
    more = [*used, *others[order[:count]].tolist()]
    if len(more) == m:
        return more, list(range(m))
    span = dense[:, more]
    _, _, kept = sl.qr(span.T, mode="economic", pivoting=True)
    return more, sorted(kept[: len(more)].tolist())


def _forces(data: Mapping[str, Any], rays: Sequence[tuple[int, Vector]], value: Mapping[int, Fraction]) -> list[Vector]:
    d = len(data["bodies"][0]["pieces"][0][0])
    forces = [[Fraction(0)] * d for _ in data["joints"]]
    for column, share in value.items():
        if column < len(rays) and share:
            k, ray = rays[column]
            forces[k] = [f + share * r for f, r in zip(forces[k], ray, strict=True)]
    return forces


def _motion(
    data: Mapping[str, Any], first: Mapping[int, int], origin: Sequence[Vector], dual: Mapping[int, Fraction]
) -> list[tuple[Vector, Vector]]:
    """Return the velocity at the origin and the rotation of each body, from the dual of its balance."""
    d = len(origin[0])
    turns = 1 if d == 2 else 3
    found = []
    for b in range(len(data["bodies"])):
        if b not in first:
            found.append(([Fraction(0)] * d, [Fraction(0)] * turns))
            continue
        v = [dual.get(first[b] + i, Fraction(0)) for i in range(d)]
        turn = [dual.get(first[b] + d + i, Fraction(0)) for i in range(turns)]
        swept = [-turn[0] * origin[b][1], turn[0] * origin[b][0]] if d == 2 else cross(turn, origin[b])
        found.append(([p - q for p, q in zip(v, swept, strict=True)], turn))
    return found


def _middle(body: Mapping[str, Any]) -> Vector:
    """Return a point near the middle of a body with short coordinates."""
    corners = [vector(corner) for piece in body["pieces"] for corner in piece]
    return [Fraction(round(float(sum(xs)) / len(corners) * ORIGIN), ORIGIN) for xs in zip(*corners, strict=True)]


def _rays(
    joint: Mapping[str, Any], side: Side, toward: Sequence[float] | np.ndarray | None, wider: Fraction = Fraction(0)
) -> list[Vector]:
    """Return rays of the friction cone of a joint point; in space inside or round it, more of them near a direction."""
    n, mu = vector(joint["normal"]), exact(joint["friction"]) * (1 + wider)
    if not mu:
        return [n]
    if len(n) == 2:
        return [[n[0] - s * mu * n[1], n[1] + s * mu * n[0]] for s in (1, -1)]
    t1, t2 = _tangents(n)
    angles = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    if toward is not None and np.any(toward):
        a, b = (float(np.dot([float(x) for x in t], toward)) for t in (t1, t2))
        angles = np.sort(
            np.concatenate([angles, np.arctan2(b, a) + NEAR * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])]) % (2 * np.pi)
        )
    radius = np.full(len(angles), 1.0 - WITHIN)
    if side == "outside":  # corners of the polygon of tangents at these angles
        half = np.diff(np.append(angles, angles[0] + 2.0 * np.pi)) / 2.0
        angles, radius = angles + half, (1.0 + WITHIN) / np.cos(half)
    return [
        [p + mu * (Fraction(float(c)) * x + Fraction(float(s)) * y) for p, x, y in zip(n, t1, t2, strict=True)]
        for c, s in zip(radius * np.cos(angles), radius * np.sin(angles), strict=True)
    ]


def _tangents(n: Vector) -> tuple[Vector, Vector]:
    """Return two vectors at right angles to n and to each other to rounding, as long as n, with short fractions."""
    normal = np.array([float(x) for x in n])
    first = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = first - (first @ normal) / (normal @ normal) * normal
    first *= np.linalg.norm(normal) / np.linalg.norm(first)
    second = turned(normal, first) / np.linalg.norm(normal)
    return [Fraction(float(x)) for x in first], [Fraction(float(x)) for x in second]


def _basis(columns: Sequence[Row], right: Sequence[Fraction]) -> tuple[list[int], list[int]] | None:
    """Return the basic columns and the rows that are not redundant, of the largest last column; None without one."""
    m, n = len(right), len(columns)
    row, column, value = (
        np.array(x) for x in zip(*((i, j, float(v)) for j, c in enumerate(columns) for i, v in c.items()), strict=True)
    )
    matrix = sp.csc_array((value, (row.astype(int), column.astype(int))), shape=(m, n))
    b = np.array([float(v) for v in right])
    force = float(np.abs(b).max(initial=0.0)) or 1.0
    unit = float(np.abs(matrix[:, [n - 1]].data).max(initial=0.0)) or 1.0
    matrix = sp.csc_array(matrix @ sp.diags_array(np.append(np.ones(n - 1), 1.0 / unit)))
    lp = highspy.HighsLp()
    lp.num_row_, lp.num_col_ = m, n
    lp.col_cost_ = np.append(np.zeros(n - 1), -1.0)
    lp.col_lower_ = np.append(np.zeros(n - 1), -np.inf)
    lp.col_upper_ = np.full(n, np.inf)
    lp.row_lower_ = lp.row_upper_ = b / force
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = matrix.indptr, matrix.indices, matrix.data
    made: Any = highspy.Highs  # its stubs leave out the constructor
    highs = made()
    for name, setting in OPTIONS:
        highs.setOptionValue(name, setting)
    highs.passModel(lp)
    highs.run()
    if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return None
    basis, basic = highs.getBasis(), highspy.HighsBasisStatus.kBasic
    used = [j for j, status in enumerate(basis.col_status) if status == basic]
    rows = [i for i, status in enumerate(basis.row_status) if status != basic]
    return (used, rows) if len(used) == len(rows) else None
