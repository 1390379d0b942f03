r"""What a limit multiplier depends on: its derivative with respect to every number of the model, by duality.

The multiplier of associated friction is the optimum of a linear (in space a cone) programme. With its forces t and its
motion v, g'v = 1, kept as they are, the Lagrangian

.. math::

    L(p) = -v^T (f + \lambda g + C^T t) + \sum_k |w_t| (\mu t_n + c) + (w_n - \mu |w_t|)^+ T + (w_n - \mu |w_t|)^- N

has at the optimum the derivative of the multiplier with respect to any number p on which loads, joints and geometry
depend (envelope theorem); w = C v are the velocities of the pairs as the model has them. No programme is solved again.
Models at four values of p near its own give dL/dp; L is smooth, however many joints open or close.

Where several motions or several forces are optimal, the derivative may depend on which: the multiplier then has another
derivative to either side. That is tested with other optimal forces and motions; where it matters, both are found by
programmes on either side, whose derivatives are extended to the model as it is.

Source: R. T. Rockafellar, Convex Analysis (1970), sections 28 and 29; T. Gal, Postoptimal Analyses (1979).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from concio.analysis.parameters import Parameter, row_named
from concio.errors import ConcioError, InputError
from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit

if TYPE_CHECKING:
    from concio.model.model import Model

Array = np.ndarray

STEP, BESIDE = 1e-3, 2e-4
"""Steps of a number, relative, at which L is read, and beside the model at which programmes are solved."""

SAME = 1e-8
"""Derivatives that differ by less, relative to the largest of a model, are one."""

ACTIVE = 1e-9
"""Forces and velocities below this share of the largest are none."""

LARGEST_NULL_SPACE = 1500
"""Unknowns up to which other optimal forces and motions are looked for by a dense factor; beyond, both sides are."""

Loaded = tuple[ContactProblem, Array]
ProblemOf = Callable[["Model"], Loaded]


@dataclass(frozen=True)
class SensitivityRow:
    """Derivative of a limit multiplier with respect to one number of the model.

    Parameters
    ----------
    name, kind, of : str
        As :class:`~concio.analysis.parameters.Parameter`.
    value : float
    unit : str
    below, above : float
        Derivative as the number falls, and as it grows [1/unit]; ``nan`` where there is none to that side.
    multiplier : float
    """

    name: str
    kind: str
    of: str
    value: float
    unit: str
    below: float
    above: float
    multiplier: float

    @property
    def one_sided(self) -> bool:
        """Whether both sides differ, or one has none."""
        size = max(abs(self.below), abs(self.above), 1e-3 * abs(self.multiplier) / (abs(self.value) or 1.0))
        return not abs(self.below - self.above) <= 1e-6 * size

    @property
    def rate(self) -> float:
        """Derivative, where both sides are the same; ``nan`` elsewhere."""
        return float("nan") if self.one_sided else (self.below + self.above) / 2.0

    @property
    def per_percent(self) -> tuple[float, float]:
        """Change of the multiplier in per cent, as the number falls and as it grows by one per cent."""
        share = self.value / self.multiplier if self.multiplier else float("nan")
        return -self.below * share, self.above * share


@dataclass(frozen=True)
class Sensitivity:
    """What a limit multiplier depends on, the largest first.

    Parameters
    ----------
    multiplier : float
    rows : tuple of SensitivityRow
    without : tuple of SensitivityRow
        Numbers without a derivative: models beside have other joints, or it depends on which motion follows.
    """

    multiplier: float
    rows: tuple[SensitivityRow, ...]
    without: tuple[SensitivityRow, ...] = ()

    def __getitem__(self, name: str) -> SensitivityRow:
        """Return the row of a name.

        Raises
        ------
        InputError
            There is none.
        """
        return row_named(self.rows, name)

    @property
    def sentence(self) -> str:
        """The three numbers that matter most, in words; those that are no mirror of it as they fall, for both sides."""
        told = [f"{_words(row)} {_most(row):+.2g} %" for row in self.rows[:3] if abs(_most(row)) > 5e-4]
        falls = [(_words(row), row.per_percent[0]) for row in self.rows[:3] if row.one_sided]
        less = [f"{name} {change:+.2g} %" for name, change in falls if np.isfinite(change) and abs(change) > 5e-4]
        more = "One per cent more of each changes the multiplier by: " + ", ".join(told or ["nothing that shows"])
        none = ", ".join(_words(row) for row in self.without)
        falling = "; one per cent less by: " + ", ".join(less) if less else ""
        return more + falling + (f"; no derivative is known for: {none}" if none else "")

    def table(self) -> dict[str, Array]:
        """Return columns: name, value, unit, below, above, percent_below, percent_above."""
        shares = np.array([row.per_percent for row in self.rows]).reshape(-1, 2)
        return {
            "name": np.array([row.name for row in self.rows]), "value": np.array([row.value for row in self.rows]),
            "unit": np.array([row.unit for row in self.rows]), "below": np.array([row.below for row in self.rows]),
            "above": np.array([row.above for row in self.rows]), "percent_below": shares[:, 0],
            "percent_above": shares[:, 1],
        }  # fmt: skip


def _words(row: SensitivityRow) -> str:
    """Return what is changed, in words: a length is that of everything along an axis."""
    return f"all lengths along {row.of}" if row.kind == "length" else row.name


def _most(row: SensitivityRow) -> float:
    """Return the change for one per cent more; where there is none to that side, that for one less, with its sign."""
    less, more = row.per_percent
    return more if np.isfinite(more) else -less


def sensitivity_of(
    here: Loaded, problem_of: ProblemOf, limit: LimitLoad, parameters: Sequence[Parameter]
) -> Sensitivity:
    """Return the derivatives of an associated multiplier.

    Parameters
    ----------
    here : (ContactProblem, (N,) array)
        The problem under the constant loads, and the loads that are multiplied.
    problem_of : callable
        Returns the same of another model.
    limit : LimitLoad
        With its forces and its mechanism.
    parameters : sequence of Parameter

    Raises
    ------
    InputError
        There is no multiplier, or no mechanism proves it.
    """
    if limit.mechanism is None or not np.isfinite(limit.multiplier):
        msg = f"there is no limit multiplier to depend on anything: {limit.words}"
        raise InputError(msg)
    best = _Optimum(*here, limit)
    others = best.others()
    found = [_row(p, problem_of, best, others) for p in parameters]
    rows = tuple(sorted((r for r in found if r is not None), key=lambda r: -np.nanmax(np.abs((*r.per_percent, 0.0)))))
    return Sensitivity(limit.multiplier, rows, rowless(parameters, found, limit.multiplier))


def rowless(
    parameters: Sequence[Parameter], found: Sequence[SensitivityRow | None], multiplier: float
) -> tuple[SensitivityRow, ...]:
    """Return rows without derivatives of the parameters for which none was found."""
    none = float("nan")
    return tuple(SensitivityRow(p.name, p.kind, p.of, p.value, p.unit, none, none, multiplier)
                 for p, row in zip(parameters, found, strict=True) if row is None)  # fmt: skip


def _row(p: Parameter, problem_of: ProblemOf, here: _Optimum, others: Sequence[_Optimum]) -> SensitivityRow | None:
    """Return the derivative with respect to one number; None where the models beside have other joints."""
    size = abs(p.value) or 1.0
    models: dict[float, Loaded] = {}

    def at(value: float) -> Loaded:
        if value not in models:
            models[value] = problem_of(p.change(value))
        return models[value]

    sides = {}
    for sign in (-1.0, 1.0):
        try:
            slopes = [_slope(o, at, p.value, STEP * size, sign) for o in (here, *others)]
        except (ConcioError, ValueError):
            sides[sign] = float("nan")
            continue
        if np.ptp(slopes) <= SAME * max(float(np.abs(slopes).max()), 1e-3 * abs(here.multiplier) / size, 1e-12):
            sides[sign] = slopes[0]
        else:
            sides[sign] = _beside(p, at, sign * BESIDE * size)
    if not any(np.isfinite(v) for v in sides.values()):
        return None
    return SensitivityRow(p.name, p.kind, p.of, p.value, p.unit, sides[-1.0], sides[1.0], here.multiplier)


def _slope(o: _Optimum, at: Callable[[float], Loaded], value: float, h: float, sign: float) -> float:
    """Return dL/dp from models on both sides, or from one side where the other has none."""
    try:
        read = [o.lagrangian(*at(value + k * h)) for k in (-2, -1, 1, 2)]
        return float(read[0] - 8 * read[1] + 8 * read[2] - read[3]) / (12 * h)
    except InputError:
        read = [o.lagrangian(*at(value + sign * k * h)) for k in range(5)]
        if not np.isfinite(read).all():
            return float("nan")
        return sign * float(np.dot(read, [-25, 48, -36, 16, -3])) / (12 * h)


def _beside(p: Parameter, at: Callable[[float], Loaded], h: float) -> float:
    """Return the derivative to one side: of programmes at three values there, extended to the model as it is."""
    slopes = []
    for k in (1, 2, 3):
        value = p.value + k * h
        problem, live = at(value)
        limit = associated_limit(problem, live)
        if limit.mechanism is None:
            return float("nan")
        slopes.append(_slope(_Optimum(problem, live, limit), at, value, abs(h) / 4, np.sign(h)))
    return float(np.dot(slopes, [3.0, -3.0, 1.0]))


class _Optimum:
    """Forces and motion of an optimum, with the multipliers of its joint laws.

    Parameters
    ----------
    problem : ContactProblem
    live : (N,) array
    limit : LimitLoad
    """

    def __init__(self, problem: ContactProblem, live: Array, limit: LimitLoad) -> None:
        assert limit.mechanism is not None
        self.problem, self.live, self.multiplier = problem, live, limit.multiplier
        self.t_n, self.t_t = limit.normal_force, limit.friction_force.reshape(problem.pairs, -1)
        R = problem.R.toarray() if problem.unknowns <= LARGEST_NULL_SPACE else problem.R
        solve = np.linalg.lstsq(R, limit.mechanism.velocity, rcond=None)[0] if isinstance(R, np.ndarray) else \
            sp.linalg.lsqr(R, limit.mechanism.velocity, atol=1e-15, btol=1e-15)[0]  # fmt: skip
        self._moved(np.asarray(solve))

    def _moved(self, alpha: Array) -> None:
        """Take a motion, scaled so that the live load does the work one, and what it makes of the joints."""
        problem = self.problem
        alpha = alpha / float(self.live @ (problem.R @ alpha))
        self.alpha = alpha
        v = problem.R @ alpha
        self.w_n = problem.C_n @ v
        self.w_t = (problem.C_t @ v).reshape(problem.pairs, problem.dim - 1)
        self.slip = np.sqrt((self.w_t**2).sum(axis=1))
        out = self.w_n - problem.laws.friction * self.slip
        scale = ACTIVE * max(float(self.slip.max(initial=0.0)), float(np.abs(self.w_n).max(initial=0.0)), 1e-300)
        self.opens, self.crushes = np.where(out > scale, out, 0.0), np.where(out < -scale, -out, 0.0)

    def lagrangian(self, problem: ContactProblem, live: Array) -> float:
        """Return L of a model near this one.

        Raises
        ------
        InputError
            It has other joints.
        """
        if problem.pairs != self.problem.pairs or problem.R.shape != self.problem.R.shape:
            msg = "models beside this one have other joints"
            raise InputError(msg)
        v = problem.R @ self.alpha
        work = float(v @ (problem.f + self.multiplier * live))
        work += float((problem.C_n @ v) @ self.t_n) + float((problem.C_t @ v) @ self.t_t.ravel())
        law = problem.laws
        resists = float(self.slip @ (law.friction * self.t_n + law.cohesion)) + float(self.opens @ law.tension)
        capped = self.crushes > 0
        return -work + resists + float(self.crushes[capped] @ law.cap[capped])

    def others(self) -> list[_Optimum]:
        """Return optima with other forces, with another motion, and with both, where they may exist."""
        if self.problem.unknowns > LARGEST_NULL_SPACE or self.t_t.size > 4 * LARGEST_NULL_SPACE:
            return []
        draw = np.random.default_rng(7)
        forces, motions = self._forces(), self._motions()
        made = []
        z = forces @ draw.standard_normal(forces.shape[1]) if forces.shape[1] else None
        y = motions @ draw.standard_normal(motions.shape[1]) if motions.shape[1] else None
        size = float(np.abs(self.t_n).max(initial=0.0))
        both = ((z, y),) if z is not None and y is not None else ()
        for force, motion in ((z, None), (None, y), *both):
            if force is None and motion is None:
                continue
            other = object.__new__(_Optimum)
            other.__dict__.update(self.__dict__)
            if force is not None:
                step = force * size / (float(np.abs(force).max()) or 1.0)
                m = self.problem.pairs
                other.t_n, other.t_t = self.t_n + step[:m], self.t_t + step[m:].reshape(self.t_t.shape)
            if motion is not None:
                scale = 1e-3 * float(np.abs(self.alpha).max()) / (float(np.abs(motion).max()) or 1.0)
                other._moved(self.alpha + scale * motion)
            made.append(other)
        return made

    def _forces(self) -> Array:
        """Return a basis (m d, k) of what can be added to the forces while the motion stays optimal."""
        problem, m, s = self.problem, self.problem.pairs, self.problem.dim - 1
        top = max(float(self.slip.max(initial=0.0)), float(np.abs(self.w_n).max(initial=0.0)))
        free = (self.opens == 0) & (self.crushes == 0)
        slides = free & (self.slip > ACTIVE * top)
        sticks = free & ~slides & (np.abs(self.w_n) <= ACTIVE * top)
        columns, rows = [], []
        A_n = (problem.R.T @ problem.C_n.T).toarray()
        A_t = (problem.R.T @ problem.C_t.T).toarray()
        for k in np.flatnonzero(free & (sticks | slides)):
            if slides[k]:
                way = -self.w_t[k] / self.slip[k] * problem.laws.friction[k]
                columns.append(A_n[:, k] + A_t[:, k * s : (k + 1) * s] @ way)
                rows.append((k, way))
            else:
                columns.append(A_n[:, k])
                rows.append((k, np.zeros(s)))
                for j in range(s):
                    columns.append(A_t[:, k * s + j])
                    rows.append((-1 - k, np.eye(s)[j]))
        if not columns:
            return np.zeros((m * (1 + s), 0))
        null = scipy.linalg.null_space(np.array(columns).T, rcond=1e-10)
        found = np.zeros((m * (1 + s), null.shape[1]))
        for row, (k, way) in zip(null, rows, strict=True):
            pair = k if k >= 0 else -1 - k
            if k >= 0:
                found[pair] += row
            found[m + pair * s : m + (pair + 1) * s] += way[:, None] * row
        return found

    def _motions(self) -> Array:
        """Return a basis (n, k) of what can be added to the motion while the forces stay optimal."""
        problem, s = self.problem, self.problem.dim - 1
        top = float(np.abs(self.t_n).max(initial=0.0)) or 1.0
        law, size = problem.laws, np.sqrt((self.t_t**2).sum(axis=1))
        room = law.friction * self.t_n + law.cohesion - size
        pressed = self.t_n + law.tension > ACTIVE * top
        capped = self.t_n >= law.cap - ACTIVE * top
        W_n = (problem.C_n @ problem.R).toarray()
        W_t = (problem.C_t @ problem.R).toarray()
        rows = [self.live @ problem.R]
        for k in np.flatnonzero(pressed | (room > ACTIVE * top)):
            own = W_t[k * s : (k + 1) * s]
            if capped[k]:
                if room[k] > ACTIVE * top:
                    rows += list(own)
                continue
            if room[k] > ACTIVE * top:
                rows += [*([W_n[k]] if pressed[k] else []), *own]
            elif size[k] > 0:
                way = self.t_t[k] / size[k]
                rows.append(W_n[k] + law.friction[k] * (way @ own))
                rows += list(own - np.outer(way, way @ own))
        return scipy.linalg.null_space(np.array(rows), rcond=1e-10)
