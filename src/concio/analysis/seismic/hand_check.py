r"""alpha_0 of a mechanism once more, by virtual work, block by block: what NTC 2018, 10.2 asks of an independent check.

The virtual displacements are those of the mechanism, for a control point that moves by one. Weights, loads, ties and
friction do work on them,

.. math:: \alpha_0 = \frac{\sum P\,\delta_{P} - \sum F\,\delta_F + L_i}{\sum (P + Q)\,\delta_{PQ}}

(C8.7.1.1), with delta_P upwards, delta_F along the force, delta_PQ along the push. Areas, volumes, forces and their
points are integrated from the coordinates of the model by code of its own, :mod:`concio.analysis.seismic.hand_forces`.
Of the program's answer only two things are used: how each macro-block moves, which is checked at every joint that
carries force, and the normal forces of joints that slide, without which friction has no size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.seismic.hand_forces import HandForce, hand_forces, measured
from concio.analysis.seismic.linkage import Linkage
from concio.kinematics.rigid import motions
from concio.model.model import Model, Tie

if TYPE_CHECKING:
    from concio.analysis.seismic.local_mechanism import LocalMechanism

Array = np.ndarray

AGREES = {2: 1e-6, 3: 1e-5}
"""Largest relative difference of alpha_0 by hand and by the program; in space motions come from cone programmes."""

STILL = 10.0
"""Joints whose sides move along each other by less than this many times ``AGREES``, over the control point, do not
slide, and those that move apart by less do not open."""

CARRIES = 1e-9
"""Contact forces below this share of the largest are none."""


@dataclass(frozen=True)
class HandRow:
    """Work of one force on one body.

    Parameters
    ----------
    kind : {"weight", "load", "tie", "joint"}
        Of a joint: macro-blocks that slide on each other.
    name : str
        Of the body, the tie, or both sides of the joint.
    block : int
        Macro-block; of a joint the second of its two.
    load : int
        Number of the load, -1 for ties and joints.
    size : float
        The force; the normal force of joints [kN].
    point : tuple of float
        [m].
    rise : float
        Of weights: displacement of their point upwards; of loads: along them, with its sign turned; of ties:
        elongation; of joints: slip.
    along : float
        Displacement along the push, of what pushes.
    resists : float
        Work that resists: P delta_P, - F delta_F, T times elongation, mu N times slip.
    pushes : float
        (P + Q) delta_PQ.
    own : bool
        False where the force was taken from the program.
    """

    kind: str
    name: str
    block: int
    load: int
    size: float
    point: tuple[float, ...]
    rise: float
    along: float
    resists: float
    pushes: float
    own: bool = True


@dataclass(frozen=True)
class HandCheck:
    """alpha_0 of a mechanism by hand, beside that of the program.

    Parameters
    ----------
    rows : tuple of HandRow
    program : float
        alpha_0 of the program.
    open : float
        Largest displacement, over that of the control point, by which a joint that carries force would open or a block
        enter another.
    dim : int
    stuck : float
        The most that friction can work in joints that do not slide: what the coordinates of a drawing leave open.
    """

    rows: tuple[HandRow, ...]
    program: float
    open: float
    dim: int
    stuck: float = 0.0

    @cached_property
    def resists(self) -> float:
        """Work of all that resists."""
        return sum(r.resists for r in self.rows)

    @cached_property
    def pushes(self) -> float:
        """Work of the earthquake for a multiplier of one."""
        return sum(r.pushes for r in self.rows)

    @property
    def alpha(self) -> float:
        """alpha_0 by hand."""
        return self.resists / self.pushes

    @property
    def difference(self) -> float:
        """Relative to that of the program."""
        return abs(self.alpha - self.program) / max(abs(self.program), 1e-12)

    @property
    def left_open(self) -> float:
        """What ``stuck`` is of alpha_0, relative to that of the program."""
        return self.stuck / max(abs(self.pushes * self.program), 1e-12)

    @property
    def agrees(self) -> bool:
        """Whether both are the same, and the motion is one that the joints allow."""
        return self.difference <= AGREES[self.dim] + self.left_open and self.open <= STILL * AGREES[self.dim]

    def part(self, kind: str) -> tuple[HandRow, ...]:
        """Return the rows of a kind."""
        return tuple(r for r in self.rows if r.kind == kind)


def hand_check(
    m: LocalMechanism, model: Model, live: str | Sequence[str] | None = None, forces: Sequence[HandForce] | None = None
) -> HandCheck:
    """Return alpha_0 of a mechanism by virtual work.

    Parameters
    ----------
    m : LocalMechanism
    model : Model
        As it was given to the assessment.
    live : str or sequence of str, optional
        As it was given to the assessment.
    forces : sequence of HandForce, optional
        Those of the model, where they are at hand.
    """
    every = hand_forces(model) if forces is None else forces
    return _Hand(m, model, (live,) if isinstance(live, str) else tuple(live or ()), every).check()


ASIDE = {"outward": (-1, 0), "inward": (1, 0), "outward or inward": (-1, 0)}
"""Which way a section is pushed, in its own axes."""


class _Hand:
    """Does the sums of one mechanism."""

    def __init__(self, m: LocalMechanism, model: Model, live: tuple[str, ...], forces: Sequence[HandForce]) -> None:
        self.m, self.model, self.live, self.forces, self.dim = m, model, live, forces, model.dim
        self.of_body = m.mechanics.of_body
        self.centres = {g: self._centre(g) for g in set(self.of_body.values())}
        rows = m.velocity.reshape(len(m.mechanics.blocks), motions(model.dim))
        self.motion = {g: (rows[g][: self.dim], rows[g][self.dim :]) for g in self.centres}

    def _centre(self, g: int) -> Array:
        """Return the centroid of a macro-block, of which its motion is stated."""
        sizes = [measured(self.model.bodies[b]) for b, own in self.of_body.items() if own == g]
        volume = np.array([v for v, _ in sizes])
        found: Array = volume @ np.array([c for _, c in sizes]) / volume.sum()
        return found

    def moved(self, g: int | None, point: Array) -> Array:
        """Return the virtual displacement of a point of a macro-block; none is what stands."""
        if g is None or g not in self.motion:
            return np.zeros(self.dim)
        shift, turn = self.motion[g]
        arm = point - self.centres[g]
        if self.dim == 2:
            return np.asarray(shift + turn[0] * np.array([-arm[1], arm[0]]))
        x, y, z = turn
        turned = np.array([y * arm[2] - z * arm[1], z * arm[0] - x * arm[2], x * arm[1] - y * arm[0]])
        return np.asarray(shift + turned)

    @cached_property
    def way(self) -> Array:
        """Unit vector (d,) of the push."""
        words = {"right": (1, 0), "left": (-1, 0), **ASIDE} if self.dim == 2 else {
            "+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0)
        }  # fmt: skip
        word = self.m.direction
        if word in words:
            return np.array(words[word], dtype=float)
        x, y = (float(v) for v in word.strip("()").split(","))
        return np.array([x, y, 0.0]) / float(np.hypot(x, y))

    def check(self) -> HandCheck:
        """Return the whole."""
        forces = [f for f in self.forces if f.body in self.of_body]
        sign = self._sign()
        rows = [self.of_force(f, sign) for f in forces]
        joints, stuck = self.of_joints()
        rows += [*self.of_ties(), *joints]
        return HandCheck(tuple(rows), self.m.multiplier, self.opening(), self.dim, stuck)

    def _sign(self) -> float:
        """Return which way load groups that push are multiplied."""
        if self.dim == 2:
            return float(self.way[0])
        total = np.sum([f.force for f in self.forces if self.model.loads[f.load].group in self.live]
                       or [self.way], axis=0)  # fmt: skip
        return 1.0 if float(total @ self.way) > 0 else -1.0

    def of_force(self, f: HandForce, sign: float) -> HandRow:
        """Return the work of a weight or a load."""
        g = self.of_body[f.body]
        d = self.moved(g, f.point)
        load = self.model.loads[f.load]
        kind = "weight" if load.kind == "weight" else "load"
        pushing = load.group in self.live
        work = 0.0 if pushing else float(f.force @ d)
        down = 0.0 if self.live else max(-float(f.force[-1]), 0.0)
        push = sign * float(f.force @ d) if pushing else down * float(self.way @ d)
        size = math.hypot(*f.force)
        along = push / (size if pushing else down) if pushing or down > 0 else 0.0
        return HandRow(kind, self.model.bodies[f.body].name, g, f.load, size, tuple(f.point.tolist()), -work / size,
                       along, -work, push, f.own)  # fmt: skip

    def of_ties(self) -> list[HandRow]:
        """Return the work of ties, which pull with what they have at one displacement of the control point."""
        number = {b.name: self.of_body.get(k) for k, b in enumerate(self.model.bodies)}
        made: list[tuple[Tie, float, Array]] = []
        for tie in self.model.ties:
            a, b = np.array(tie.at_a, dtype=float), np.array(tie.at_b, dtype=float)
            unit = (b - a) / float(np.sqrt(((b - a) ** 2).sum()))
            rate = float((self.moved(number.get(tie.body_b), b) - self.moved(number.get(tie.body_a), a)) @ unit)
            if rate > CARRIES:
                made.append((tie, rate, a))
        ends = [e / r for t, r, _ in made for e in (_yields(t), t.break_elongation) if e is not None]
        at = max(ends, key=lambda s: sum(_pull(t, r * s) * r for t, r, _ in made), default=0.0)
        return [HandRow("tie", t.name, number.get(t.body_a) or 0, -1, _pull(t, r * at), tuple(p.tolist()), r, 0.0,
                        _pull(t, r * at) * r, 0.0) for t, r, p in made]  # fmt: skip

    def joints(self) -> list[tuple[int | None, int | None, Array, Array, float, float, float]]:
        """Return joints that carry force: both sides, point, normal, normal force, friction, cohesion."""
        m = self.m
        if isinstance(m.linkage, Linkage) and any(j.inward is not None for j in m.mechanics.joints):
            force = self._of_linkage(m.linkage)
            return [
                (j.a if j.a >= 0 else None, j.b if j.b >= 0 else None, j.point, j.normal, float(n), j.friction,
                 j.cohesion)
                for j, n in zip(m.mechanics.joints, force, strict=True) if j.kind == "roller" and not j.pulls
            ]  # fmt: skip
        pairs, law, normal = m.assembly.pairs, m.assembly.laws, m.found.normal_force
        real = (pairs.interface >= 0) & (normal > CARRIES * float(normal.max(initial=0.0)))
        sides = ((k, self.of_body.get(int(pairs.body_a[k])), self.of_body.get(int(pairs.body_b[k])))
                 for k in np.flatnonzero(real))  # fmt: skip
        return [(a, b, pairs.point[k], pairs.normal[k], float(normal[k]), float(law.friction[k]),
                 float(law.cohesion[k])) for k, a, b in sides if a != b]  # fmt: skip

    def _of_linkage(self, linkage: Linkage) -> Array:
        """Return the forces of the joints of a linkage at the onset."""
        found = linkage.balance(np.zeros((len(linkage.mechanics.blocks), 3)), plastic=True)
        return np.zeros(len(linkage.mechanics.joints)) if found is None else found.normal_force

    def of_joints(self) -> tuple[list[HandRow], float]:
        """Return the work of friction, and of what crushes or opens, between each two macro-blocks that slide.

        With the most that friction can do where they do not.
        """
        stuck = 0.0
        sums: dict[tuple[int, int], list[tuple[float, Array, float, float]]] = {}
        for a, b, point, normal, N, mu, c in self.joints():
            apart = self.moved(b, point) - self.moved(a, point)
            opens = float(apart @ normal)
            slip = float(np.sqrt(((apart - opens * normal) ** 2).sum()))
            if slip <= self.still(a, b):
                stuck, slip = stuck + (mu * N + c) * slip, 0.0
            work = (mu * N + c) * slip - N * opens
            key = (-1 if a is None else a, -1 if b is None else b)
            sums.setdefault(key, []).append((N, point, slip, work))
        rows = []
        for (a, b), parts in sorted(sums.items()):
            work = sum(w for *_, w in parts)
            N = sum(n for n, *_ in parts)
            if abs(work) <= CARRIES * N:
                continue
            at = np.sum([n * p for n, p, _, _ in parts], axis=0) / N
            slip = sum(n * s for n, _, s, _ in parts) / N
            rows.append(HandRow("joint", f"{self.label(a)} / {self.label(b)}", b, -1, N, tuple(at.tolist()), slip, 0.0,
                                work, 0.0))  # fmt: skip
        return rows, stuck

    def still(self, a: int | None, b: int | None) -> float:
        """Return the slip between two macro-blocks that turn, up to which they stick.

        Drawn points of one joint lie beside each other by up to twice the gap tolerance of the model.
        """
        turn = max((float(np.abs(self.motion[g][1]).max()) for g in (a, b) if g in self.motion), default=0.0)
        return STILL * AGREES[self.dim] + 2.0 * (self.model.gap_tolerance or 0.0) * turn

    def label(self, g: int) -> str:
        """Return the name of a macro-block; "-" of what stands."""
        return "-" if g < 0 else self.m.mechanics.blocks[g].label

    def opening(self) -> float:
        """Return by how much joints that carry force would open beyond what friction makes them, or overlap."""
        worst = 0.0
        capped = bool(np.isfinite(self.m.assembly.laws.cap).any())
        for j in self.m.mechanics.joints:
            if j.kind == "hinge" and j.inward is not None:
                apart = self.moved(j.b, j.point) - self.moved(j.a, j.point)
                worst = max(worst, float(np.abs(apart).max()))
        for a, b, point, normal, _, mu, _ in self.joints():
            apart = self.moved(b, point) - self.moved(a, point)
            opens = float(apart @ normal)
            slip = float(np.sqrt(((apart - opens * normal) ** 2).sum()))
            allowed = mu * slip if self.m.found.flow == "associated" else 0.0
            worst = max(worst, opens - allowed, 0.0 if capped else -opens)
        return worst


def _yields(tie: Tie) -> float | None:
    """Return the elongation at which a tie yields; None where it never does."""
    return None if tie.yield_force is None else (tie.yield_force - tie.prestress) / tie.stiffness


def _pull(tie: Tie, longer: float) -> float:
    """Return what a tie pulls as it has become longer."""
    if tie.break_elongation is not None and longer > tie.break_elongation * (1 + 1e-9):
        return 0.0
    most = np.inf if tie.yield_force is None else tie.yield_force
    return float(min(tie.prestress + tie.stiffness * longer, most))
