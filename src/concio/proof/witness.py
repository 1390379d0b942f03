r"""Exact forces and motions that prove a multiplier from below and from above.

With the joint forces written as sums of rays of the friction cones, F = sum p_j r_j with p >= 0 (and sums of some p_j
bounded, where a joint has cohesion, tension or a cap), balance of every free block under dead and x times live loads is
a linear programme for the largest x, and its dual the least work of a motion that no ray resists. A simplex code finds
a basis in floating point. The basis says which p_j are not zero and which rays the motion leaves at rest: two square
systems of fractions, solved exactly (:mod:`concio.proof.exact_solve`). In the plane the rays are the two edges of the
cone, and both answers are one fraction. In space the cone is round: rays inside it give forces, rays round it motions,
and what lies between the two fractions is reported.

Nothing that floating point says is part of the proof: what comes out is handed to :mod:`concio.proof.verify`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import highspy
import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp

from concio.proof.exact_pivots import Need, Pair, pivoted, square, transposed
from concio.proof.exact_solve import Row, solve_exactly
from concio.proof.joint_rays import Ray, Side, Vector, joint_rays
from concio.proof.verify import cross, vector
from concio.proof.verify import loads as loads_on

Ways = Sequence[Sequence[float]] | np.ndarray | None

REACHED = 1e-8
"""Share of a column, beside those of a basis, from which it counts as reaching further rows."""
ORIGIN = 64
"""Moments are taken about points whose coordinates are multiples of 1 / ORIGIN m, near each block."""
MOST = 100
"""Largest sum of the shares of all rays, in loads, where forces are sought that are far inside their cones."""
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
    """The balance of every free block, its joint forces as sums of rays, and what bounds those sums.

    Parameters
    ----------
    data : mapping
        Of :func:`concio.proof.statement.statement`.
    dead, live : sequences of (force, moment)
        Loads on each body, about the origin.
    rays : sequence of Ray
    base : sequence of vectors
        Force of each joint where every ray is 0.
    most : sequence of Fraction
        Right sides of the sums.
    """

    data: dict[str, Any]
    dead: Sequence[Sequence[Vector]]
    live: Sequence[Sequence[Vector]]
    rays: Sequence[Ray]
    base: Sequence[Vector]
    most: Sequence[Fraction]

    def columns(self) -> tuple[list[Row], list[Fraction], dict[int, int], list[Vector]]:
        """Return columns of the rays and of the multiplier last, right side, first row of each free body, origins."""
        bodies = self.data["bodies"]
        d = len(bodies[0]["pieces"][0][0])
        rows = d + (1 if d == 2 else 3)
        first = {b: rows * k for k, b in enumerate(b for b, body in enumerate(bodies) if not body["fixed"])}
        origin = [_middle(body) for body in bodies]
        sums = rows * len(first)
        found = [
            {**self._acting(ray.joint, ray.force, first, origin), **{sums + i: Fraction(1) for i in ray.sums}}
            for ray in self.rays
        ]
        found.append(self._loaded(self.live, first, origin))
        right = [Fraction(0)] * sums + list(self.most)
        held = [self._acting(k, force, first, origin) for k, force in enumerate(self.base) if any(force)]
        for part in (self._loaded(self.dead, first, origin), *held):
            for i, value in part.items():
                right[i] -= value
        return found, right, first, origin

    def _acting(self, k: int, force: Vector, first: Mapping[int, int], origin: Sequence[Vector]) -> Row:
        """Return what a force of a joint does to the balance of its two bodies."""
        joint = self.data["joints"][k]
        at, column = vector(joint["at"]), {}
        for body, sign in ((joint["b"], 1), (joint["a"], -1)):
            if body in first:
                arm = [p - q for p, q in zip(at, origin[body], strict=True)]
                for i, value in enumerate([*force, *cross(arm, force)]):
                    if value:
                        column[first[body] + i] = sign * value
        return column

    def _loaded(self, loads: Sequence[Sequence[Vector]], first: Mapping[int, int], origin: Sequence[Vector]) -> Row:
        column: Row = {}
        for b, row in first.items():
            force, moment = loads[b]
            about = [m - c for m, c in zip(moment, cross(origin[b], force), strict=True)]
            for i, value in enumerate([*force, *about]):
                if value:
                    column[row + i] = value
        return column

    def forces(self, value: Mapping[int, Fraction]) -> list[Vector]:
        """Return the force of each joint from the shares of the rays."""
        found = [list(force) for force in self.base]
        for column, share in value.items():
            if column < len(self.rays) and share:
                k, force = self.rays[column].joint, self.rays[column].force
                found[k] = [f + share * r for f, r in zip(found[k], force, strict=True)]
        return found


def programme(
    data: dict[str, Any], constant: Mapping[str, Fraction], multiplied: Mapping[str, Fraction], side: Side,
    directions: Ways, wider: Fraction = Fraction(0),
) -> Programme:  # fmt: skip
    """Return the programme of a statement under its loads, see :func:`witness`."""
    rays: list[Ray] = []
    base: list[Vector] = []
    most: list[Fraction] = []
    for k, joint in enumerate(data["joints"]):
        toward = directions[k] if directions is not None and k < len(directions) else None  # none where supports hold
        found = joint_rays(joint, side, toward, wider)
        rays += [Ray(k, force, tuple(len(most) + i for i in sums)) for force, sums in found.rays]
        base.append(found.base)
        most += found.most
    return Programme(data, loads_on(data, dict(constant)), loads_on(data, dict(multiplied)), rays, base, most)


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
    made = programme(data, constant, multiplied, side, directions, wider)
    columns, right, first, origin = made.columns()
    plane = len(origin[0]) == 2
    found = _at_basis(columns, right, "both" if plane else "shares" if side == "inside" else "dual")
    if found is None:
        return None
    value, dual = found
    last = len(columns) - 1
    whole = value is not None and all(v >= 0 for c, v in value.items() if c != last)
    motion = None if dual is None else _motion(data, first, origin, dual)
    if value is not None:
        return Witness(value[last], made.forces(value) if whole else None, motion)
    bound = sum((y * right[row] for row, y in (dual or {}).items()), Fraction(0))
    return Witness(bound, None, motion)


def forces_below(
    data: dict[str, Any], constant: Mapping[str, Fraction], multiplied: Mapping[str, Fraction], multiplier: Fraction,
    directions: Ways = None,
) -> Witness | None:  # fmt: skip
    """Return exact forces at a multiplier a little below the largest, as far inside the cones as they can be.

    Where several bases are those of one corner, that of :func:`witness` may have forces negative by less than rounding.
    Here the least share of all rays is made as large as it gets, so that rounding has no say.
    """
    acting = {**constant, **{group: multiplier * factor for group, factor in multiplied.items()}}
    made = programme(data, acting, {}, "inside", directions)
    columns, right, first, _ = made.columns()
    total = sum((abs(x) for b in first for x in made.dead[b][0]), Fraction(0))
    columns[-1] = {}  # what is left of the largest sum of all shares, without which self-stress has no end
    columns = [{**column, len(right): Fraction(1)} for column in columns]
    right = [*right, MOST * total + sum(made.most, Fraction(0))]
    even: Row = {}
    for column in columns:
        for row, value in column.items():
            even[row] = even.get(row, Fraction(0)) + value
    columns.append({row: value for row, value in even.items() if value})
    found = _at_basis(columns, right, "shares")
    if found is None or found[0] is None:
        return None
    least = found[0][len(columns) - 1]
    shares = {k: least + found[0].get(k, Fraction(0)) for k in range(len(made.rays))}
    if not all(v >= 0 for v in shares.values()):
        return None
    return Witness(multiplier, made.forces(shares), None)


def _at_basis(columns: Sequence[Row], right: Sequence[Fraction], need: Need) -> Pair | None:
    """Return the exact values of the basic columns and the exact dual of the rows; None without the last column.

    What is not needed is left out where it takes a system of its own.
    """
    basis = _basis(columns, right)
    last = len(columns) - 1
    if basis is None or last not in basis[0]:
        return None
    used, rows = basis
    everywhere, every = _completed(columns, used, rows, len(right))
    optimal = pivoted(columns, right, everywhere, need) if len(every) == len(right) else None
    if optimal is not None:
        return optimal
    shares, motion = None, None
    if need != "dual":
        primal = solve_exactly(square(columns, everywhere, every), [right[row] for row in every])
        shares = None if primal is None else dict(zip(everywhere, primal, strict=True))
    if need != "shares":
        dual = solve_exactly(transposed(square(columns, used, rows)), [Fraction(int(j == last)) for j in used])
        motion = None if dual is None else {row: dual[i] for i, row in enumerate(rows)}
    if need == "both" and (shares is None or motion is None):
        return None
    return shares, motion


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
