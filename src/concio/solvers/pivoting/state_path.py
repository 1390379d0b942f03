r"""The piecewise linear path of a covered contact problem: complementary pivoting without a tableau.

The joint law of a pair is a piecewise linear surface whose pieces are its states
(:mod:`concio.solvers.pivoting.pair_rows`). With a
cover that makes some choice of states right at z0 = 1, the solutions (u, p, r, z0) form a path of straight pieces; it
is followed until z0 = 0 (a solution of the problem) or until a piece has no end (a ray). At an event, both the row the
pair gives up and the row it takes hold, which makes the matrix square; the direction of the next piece is the column
that belongs to the row given up. z0 may well rise in between: that is how turning points are passed.

*Why a ray means something.* Let a ray have direction (du, dt, dz0) and let the cover be a prestress (P > 0 with
|Q| < mu P) of every pair. Along it the joint laws hold homogeneously, so each pair does the work dt.dy <= 0, and
du'K du = sum dt.dy >= 0: du is a rigid motion, without penetration, no pair dissipates along it, and from equilibrium
f'du > 0 unless forces grow without bound among pairs that do not move. It is a way to fall, though under friction not
yet a proof that the structure must: :mod:`concio.solvers.statics.existence` decides that.

The prestress is drawn at random between half and one and a half times its size (fixed seed): for a generic cover no two
slacks vanish together while z0 > 0, which replaces the lexicographic rule.

References
----------
B. C. Eaves, H. Scarf, The solution of systems of piecewise linear equations, *Math. Oper. Res.* 1 (1976) 1-27. C. E.
Lemke, *Management Science* 11 (1965) 681-689.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal
from concio.problem.solution import Progress, ProgressCallback
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.algebra.updated_factor import UpdatedFactor
from concio.solvers.pivoting.pair_rows import PairSystem

FAR = 1e8
"""A piece longer than this, relative to the vertex it starts from, has no end."""

SOLVED = 1e-10
"""z0 (1 at the start) that counts as zero where a piece has no end."""

RATE = 1e-11
"""Rates below this share of the largest rate count as zero."""


@dataclass(frozen=True, eq=False)
class PathEnd:
    """How a path ended.

    Parameters
    ----------
    outcome : str
        "solution", "ray", "limit", "cancelled", "singular", or "lost": rounding took a wrong turn (no piece of a path
        is met twice).
    normal, sign : (m,) integer arrays
        States of the pairs on the last piece: normal codes, sign of the slip (0: sticks).
    unknowns : (N + 2 m + 1,) array
        u, (p, r) of each pair, z0.
    direction : (N + 2 m + 1,) array
        Of the last piece.
    events, factorisations : int
    """

    outcome: str
    normal: Array
    sign: Array
    unknowns: Array
    direction: Array
    events: int
    factorisations: int


class StatePath:
    """A walk along the path of a covered system.

    Parameters
    ----------
    system : PairSystem
        Its ``cover`` makes the states right at z0 = 1.
    normal, sign : (m,) integer arrays
        States at the start.
    refresh : int
        Rows replaced between factorisations.
    """

    def __init__(self, system: PairSystem, normal: Array, sign: Array, refresh: int = 64) -> None:
        self.system = system
        self.normal, self.sign = normal.copy(), sign.copy()
        n, m = system.n, system.m
        rows = system.equilibrium_rows()
        for k in range(m):
            rows.append(system.normal_row(k, int(normal[k]), sign[k]))
            rows.append(system.tangential_row(k, int(sign[k])))
        rows.append((np.array([system.size - 1]), np.array([1.0])))  # z0 = 1, the row given up at the start
        b_n, b_t = system.right_hand_side(normal, sign)
        self.b = np.concatenate([system.load + system.anchored, np.column_stack([b_n, b_t]).ravel(), [1.0]])
        self.place_n = n + 2 * np.arange(m)  # where the row of each pair stands
        self.place_t = self.place_n + 1
        self.float = n + 2 * m
        self.float_sign = -1.0
        self.factor = UpdatedFactor(rows, refresh)
        self.v = self._vertex()
        self.events = 0
        self._factorisations = self.factor.factorisations

    def _vertex(self) -> Array:
        """Solve for the current vertex, with iterative refinement."""
        matrix = self.factor.matrix()
        v = self.factor.solve(self.b)
        for _ in range(3):
            v = v + self.factor.solve(self.b - matrix @ v)
        if not np.isfinite(v).all():
            msg = "the system of the states is singular"
            raise SingularMatrixError(msg)
        return v

    def follow(self, limit: int, progress: ProgressCallback | None = None) -> PathEnd:
        """Follow the path for at most ``limit`` events."""
        try:
            outcome, d = self._follow(limit, progress)
        except SingularMatrixError:
            outcome, d = "singular", np.zeros_like(self.v)
        return PathEnd(outcome, self.normal, self.sign, self.v, d, self.events, self.factor.factorisations)

    def _follow(self, limit: int, progress: ProgressCallback | None) -> tuple[str, Array]:
        visited: set[int] = set()
        while True:
            d = self.float_sign * self.factor.column(self.float)
            step, k, kind = self._first_event(d)
            if kind == "":
                return ("solution" if abs(self.v[-1]) <= SOLVED else "ray"), d
            self.v = self.v + step * d
            if kind == "end":
                self.v[-1] = 0.0
                return "solution", d
            self.events += 1
            self._pass(k, kind)
            if self.factor.factorisations != self._factorisations:
                self._factorisations = self.factor.factorisations
                self.v = self._vertex()  # exact again
            if self.v[-1] < -1e-8:
                return "lost", d
            seen = (self.normal.tobytes(), self.sign.tobytes(), self.float)
            key = hash(seen)
            if key in visited:
                return "lost", d
            visited.add(key)
            if self.events >= limit:
                return "limit", d
            if progress and self.events % 32 == 0:
                z0 = float(self.v[-1])
                if progress(Progress("sparse-lemke", self.events, z0, f"z0 = {z0:.2e}")):
                    return "cancelled", d

    def _first_event(self, d: Array) -> tuple[float, int, str]:
        """Return the step to the first slack that vanishes, its pair and its name ("" for a ray, "end" for z0)."""
        system = self.system
        normal, sign = self.normal, self.sign
        value = system.slacks(self.v, sign)
        rate = system.slacks(d, sign, rate=True)
        closed, open_ = normal == Normal.CLOSED, normal == Normal.OPEN
        stick = sign == 0
        free = system.frictionless | (open_ & system.weak & (system.dilatancy == 0.0))
        watched = (
            ("p", closed, 1.0),
            ("room", closed & system.cone.capped, 1.0),
            ("y_n", open_, 1.0),
            ("crush", normal == Normal.CRUSHED, -1.0),
            ("plus", stick, 1.0),
            ("minus", stick, 1.0),
            ("slip", ~stick & ~free, sign),
        )
        names = {"crush": "y_n", "slip": "y_t"}
        lengths = float(np.abs(d[: system.n]).max(initial=0.0))
        forces = float(np.abs(d[system.n :]).max())
        best, at, kind = np.inf, -1, ""
        if d[-1] < -1e-14 * max(lengths, forces):
            best, kind = self.v[-1] / -d[-1], "end"
        for name, mask, factor in watched:
            source = names.get(name, name)
            going = rate[source] * factor
            least = RATE * (max(lengths, 1e-3 * forces) if source in ("y_n", "y_t") else max(forces, 1e-3 * lengths))
            pick = np.flatnonzero(mask & (going < -least))
            if not pick.size:
                continue
            speed = -going[pick]
            steps = np.maximum((value[source] * factor)[pick], 0.0) / speed
            near = steps <= steps.min() * (1.0 + 1e-12) + 1e-14
            i = int(np.flatnonzero(near)[np.argmax(speed[near])])
            if steps[i] < best:
                best, at, kind = float(steps[i]), int(pick[i]), name
        far = FAR * (1.0 + float(np.abs(self.v).max()))
        if best * max(lengths, forces) > far and kind != "end":
            return np.inf, -1, ""  # only rounding ends this piece
        return best, at, kind

    def _pass(self, k: int, kind: str) -> None:
        """Take pair ``k`` to the state beyond the event ``kind``."""
        system, sign = self.system, int(self.sign[k])
        if kind == "p":  # y_n grows
            self._exchange_normal(k, Normal.OPEN, 1.0)
        elif kind == "room":  # -y_n grows
            self._exchange_normal(k, Normal.CRUSHED, -1.0)
        elif kind == "crush":  # the room under the cap grows
            self._exchange_normal(k, Normal.CLOSED, -1.0)
        elif kind == "y_n":  # p grows
            y_t = system.slacks(self.v, self.sign)["y_t"][k]
            if system.weak[k] and not system.frictionless[k] and y_t * sign < 0:
                self._turn(k)  # it slid freely while open
            self._exchange_normal(k, Normal.CLOSED, 1.0)
        elif kind == "slip" and self.normal[k] == Normal.OPEN and system.weak[k]:
            self._turn(k)  # no force, nothing changes but the side on which it dilates
        elif kind == "slip":  # the distance to slipping grows: + or - the row of slip
            self._exchange_tangential(k, 0, sign)
        else:
            to = 1 if kind == "plus" else -1
            self._exchange_tangential(k, to, to)

    def _exchange_normal(self, k: int, state: int, sign: float) -> None:
        """Let the normal row of ``state`` hold; what the old row held fixed grows in the direction ``sign``."""
        self.normal[k] = state
        self.float, self.place_n[k], self.float_sign = int(self.place_n[k]), self.float, sign
        self._write_normal(k)

    def _exchange_tangential(self, k: int, state: int, sign: float) -> None:
        """Let pair k slip with the sign ``state``, or stick; see :meth:`_exchange_normal`."""
        self.sign[k] = state
        self.float, self.place_t[k], self.float_sign = int(self.place_t[k]), self.float, sign
        self._write_tangential(k)
        if self.system.dilatancy[k] and self.normal[k] == Normal.CLOSED:
            self._write_normal(k)

    def _turn(self, k: int) -> None:
        """Let an open pair without strength slide the other way."""
        self.sign[k] = -self.sign[k]
        self._write_tangential(k)

    def _write_normal(self, k: int) -> None:
        state, sign, place = int(self.normal[k]), float(self.sign[k]), int(self.place_n[k])
        self.b[place] = self.system.right_hand_side(self.normal, self.sign)[0][k]
        self.factor.replace(place, self.system.normal_row(k, state, sign))

    def _write_tangential(self, k: int) -> None:
        place = int(self.place_t[k])
        self.b[place] = self.system.right_hand_side(self.normal, self.sign)[1][k]
        self.factor.replace(place, self.system.tangential_row(k, int(self.sign[k])))
