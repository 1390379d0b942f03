"""All pairs of a step: contact, points that supports hold, ties; and the step problem they make."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from concio.analysis.motion.joint_step import PairData
from concio.analysis.motion.joints import SAG, Joints
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import Memory, TieMemory
from concio.contact.attachments import Held, Ties
from concio.contact.contact_search import ContactSearch
from concio.contact.edge_search import EdgeSearch
from concio.contact.reference import Reference
from concio.contact.rows import Rows
from concio.contact.slots import Slots
from concio.contact.solid_search import SolidSearch
from concio.kinematics.frames import dot
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions
from concio.kinematics.turns import Turns
from concio.problem.cone import Cone
from concio.solvers.stepping.matrix import StepMatrix
from concio.solvers.stepping.problem import StepProblem

Array = np.ndarray

YIELDING = 1e-3
"""Compliance added to a hard pair of an elastic body, over that of its nodes.

Where blocks meet at corners their contacts hold each other several times over. In small displacements that does no
harm; where they have moved, the gaps agree to second order only, and what is left would become self-stress."""


LINE = {2: 1.0, 3: 2.0}
"""Compliance added to a hard pair by dimension: what is one corner in the plane are two ends of a line in space."""


def search_of(reference: Reference) -> ContactSearch[Any, Any]:
    """Return what looks for the contacts of bodies that move."""
    return EdgeSearch(reference) if reference.disc.dim == 2 else SolidSearch(reference)


class PairMaker:
    """Finds the pairs of moving bodies.

    Parameters
    ----------
    reference : Reference
    scheme : Scheme
    sag : float
        Depth over the median width of the bodies to which a body of mean weight sinks into a hard joint.
    """

    def __init__(self, reference: Reference, scheme: Scheme, sag: float = SAG) -> None:
        self.reference, self.scheme, self.n = reference, scheme, reference.disc.unknowns
        self.search = search_of(reference)
        self.width = float(np.median(reference.surface.width[reference.free]))
        weight = reference.typical_mass * reference.gravity
        lent = sag * self.width / weight if weight > 0 else 0.0
        lent *= LINE[reference.disc.dim]
        self.joints = Joints(
            reference.laws, scheme, reference.disc.size, self.width, self.search.skin, lent, yielding(reference)
        )  # fmt: skip
        self.held, self.ties = Held.of(reference), Ties.of(reference)
        self.nothing = no_pairs(reference.disc.dim)

    @property
    def slots(self) -> Slots:
        """The present layout of contact pairs."""
        assert self.search.layout is not None
        slots: Slots = self.search.layout.slots
        return slots

    def contacts(
        self, memory: Memory, placement: Placement, velocity: Array, spin: Array, strain: Array
    ) -> tuple[Memory, Rows, bool]:
        """Return what pairs remember, their rows, and whether their layout is new, where bodies stand and move so."""
        search = self.search
        new = search.update(placement)
        key = self.slots.key
        if memory.key is not key:
            memory = memory.carried_to(key)
        rows = search.rows(placement, velocity, spin, strain)
        source, target, swapped = search.handed_on(rows, memory.force[:, 0] > 0)
        if len(source):
            memory = memory.handed(source, target, rows.frame, swapped)
        return memory, rows, new

    def supports(self, turn: Turns, shift: Array) -> PairData:
        """Return the pairs of supports; ``shift`` (k, d): how far or fast they are from their places."""
        held, k = self.held, len(self.held)
        if not k:
            return self.nothing
        zero, inf = np.zeros(k), np.full(k, np.inf)
        off = np.stack([dot(shift, way) for way in held.ways], axis=1)
        return PairData(
            held.points.columns, held.values(turn), off, Cone(zero, np.where(held.pinned, np.inf, 0.0), inf, inf), zero,
            zero, zero, np.ones(k, dtype=bool),
        )  # fmt: skip

    def off_support(self, placement: Placement, strain: Array, factors: Mapping[str, float]) -> Array:
        """Return how far held points are from where supports want them (k, d) [m]."""
        return np.asarray(self.held.points.positions(placement, strain) - self.held.target(factors))

    def tie_pairs(self, placement: Placement, strain: Array, tied: TieMemory) -> tuple[PairData, Array, PairData]:
        """Return the pairs of ties in terms of displacements, their gaps (k,) [m], and the pairs of their swinging.

        A tight tie resists being swung by its tension over its length: nothing where the bodies stand, but without it
        iterations to an equilibrium would not converge.
        """
        ties, k = self.ties, len(self.ties)
        if not k:
            return self.nothing, np.zeros(0), self.nothing
        values, across, gap, length = ties.rows(placement, strain)
        gap = gap + tied.plastic
        zero, every, inf = np.zeros(k), np.ones(k, dtype=bool), np.full(k, np.inf)
        data = PairData(
            ties.columns, values, along_normal(gap, values.shape[1]), Cone(zero, zero, zero, ties.most),
            1.0 / ties.stiffness, zero, zero, ~tied.broken,
        )  # fmt: skip
        tension = self._tension(gap, tied)
        swings = (tension > 0) & (length > 0)
        swing = PairData(
            ties.columns, across * swings[:, None, None], np.zeros(across.shape[:2]), Cone(zero, zero, inf, inf),
            np.where(swings, length / np.where(swings, tension, 1.0), 1.0), zero, zero, every,
        )  # fmt: skip
        return data, gap, swing

    def tie_turning(self, placement: Placement, strain: Array, tied: TieMemory, gap: Array, n: int) -> Array:
        """Return the stiffness with which tight ties resist that rigid bodies turn, on the diagonal (n,) [kN/m].

        Nothing where the bodies stand either; without it iterations swing about the equilibrium of a body that hangs.
        """
        tension = self._tension(gap, tied)
        columns, stiffness = self.ties.turning(placement, strain, tension)
        return np.bincount(columns, stiffness, n + 1)[:n]

    def _tension(self, gap: Array, tied: TieMemory) -> Array:
        """Return the tension of ties (k,) of given gaps [kN]."""
        ties = self.ties
        return np.where(tied.broken, 0.0, np.minimum(np.maximum(-gap, 0.0) * ties.stiffness, ties.most))


def yielding(reference: Reference) -> Array:
    """Return the compliance that elastic bodies add to their hard joints (B,) [m/kN]."""
    disc = reference.disc
    found = np.zeros(len(disc.shape_of))
    for b in reference.meshed.tolist():
        own = disc.shapes[disc.shape_of[b]].K.diagonal().reshape(-1, disc.dim).mean(axis=1)  # whatever the axes
        found[b] = YIELDING / float(np.median(own))
    return found


def relative(columns: Array, values: Array, x: Array) -> Array:
    """Return the relative velocities (m, d) of unknowns x (N,)."""
    padded = np.empty(len(x) + 1)
    padded[:-1], padded[-1] = x, 0.0
    return np.asarray(np.einsum("mdw,mw->md", values, padded[columns]))


def along_normal(first: Array, dim: int) -> Array:
    """Return vectors (k, d) with a component (k,) along the normal only."""
    found = np.zeros((len(first), dim))
    found[:, 0] = first
    return found


def no_pairs(dim: int = 2) -> PairData:
    """Return no pairs."""
    none, wide = np.zeros(0), motions(dim)
    return PairData(
        np.zeros((0, wide), dtype=int), np.zeros((0, dim, wide)), np.zeros((0, dim)), Cone(none, none, none, none),
        none, none, none, np.zeros(0, dtype=bool),
    )  # fmt: skip


def assembled(
    matrix: StepMatrix, b: Array, parts: Sequence[PairData], force: float, length: float
) -> StepProblem:
    """Return the step problem of several kinds of pairs, one after the other."""
    parts = [part for part in parts if len(part.columns)] or list(parts[:1])
    if len(parts) == 1:
        p = parts[0]
        return StepProblem(
            matrix, b, p.columns, p.values, p.shift[:, 0], -p.shift[:, 1:], p.cone, p.a_n, p.a_t, p.dilatancy, p.active,
            force, length,
        )  # fmt: skip
    w, m, n = max(p.columns.shape[1] for p in parts), sum(len(p.columns) for p in parts), len(b)
    columns, values, at = np.full((m, w), n), np.zeros((m, parts[0].values.shape[1], w)), 0
    for part in parts:
        k, own = part.columns.shape
        columns[at : at + k, :own], values[at : at + k, :, :own] = part.columns, part.values
        at += k

    def joined(name: str) -> Array:
        return np.concatenate([getattr(part, name) for part in parts])

    def strength(name: str) -> Array:
        return np.concatenate([getattr(part.cone, name) for part in parts])

    shift = joined("shift")
    cone = Cone(strength("friction"), strength("cohesion"), strength("tension"), strength("cap"))
    return StepProblem(
        matrix, b, columns, values, shift[:, 0], -shift[:, 1:], cone, joined("a_n"), joined("a_t"), joined("dilatancy"),
        joined("active"), force, length,
    )  # fmt: skip
