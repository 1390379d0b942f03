"""Contacts at corners and along edges of a model as described: what interface detection can only report.

Where two bodies touch without faces that face each other, interface detection names the place
(:class:`concio.model.interfaces.near.NearMiss`, kinds "corner" and "edge"). The narrow phase finds the contact there
(:mod:`concio.contact.narrow_phase`), and the place is no longer a near miss. A place stays one, with the reason, where
the joint law has constants per area without which it means nothing: a corner has no area.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from concio.contact.convex_bodies import ConvexBodies, pairs_of
from concio.contact.narrow_phase import SLACK, Contacts, find_contacts
from concio.model.body import Body
from concio.model.interfaces.detect import Detection, touching
from concio.model.interfaces.near import NearMiss, size_of_bodies
from concio.model.interfaces.patches import sizes
from concio.model.interfaces.point_contact import PointContact
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

Array = np.ndarray

TOLD = frozenset({"corner", "edge"})
"""Kinds of near misses that are contacts without area."""
SHORT = 1e-3
"""A contact may be shorter than the edge that was reported by this share of it."""
SAME = 1e-6
"""Normals of two pieces of one body that differ by less are one."""

Refusal = Callable[[int, int], str]
"""Why two bodies, by their numbers, can have no contact without area; an empty text where they can."""


def with_point_contacts(
    model: Model, detection: Detection, tolerance: float, refused: Refusal
) -> Detection:
    """Return a detection with contacts at corners and along edges in place of the near misses that reported them.

    Parameters
    ----------
    model : Model
    detection : Detection
        Of its bodies as they were described.
    tolerance : float
        Within which bodies touch [m].
    refused : callable of two body numbers
        Why there can be no contact without area between them; an empty text where there can.
    """
    told = [m for m in detection.near_misses if m.kind in TOLD]
    if not told:
        return detection
    asked = {m.bodies for m in told}
    reasons = {pair: refused(*pair) for pair in asked}
    free = {pair for pair in asked if not reasons[pair]}
    bodies: Sequence[Body] | Sequence[Polyhedron] = model.outlines if model.dim == 2 else model.polyhedra
    size = size_of_bodies(model.outlines) if model.dim == 2 else sizes(model.polyhedra)
    reach = touching(size, tolerance, model.gap_reach)
    made = _Made(_contacts(bodies, free, reach, tolerance), reach) if free else None
    misses = []
    for miss in detection.near_misses:
        if miss.kind not in TOLD:
            misses.append(miss)
        elif reasons[miss.bodies]:
            misses.append(_refused(miss, reasons[miss.bodies]))
        elif made is None or not made.covers(miss):
            misses.append(miss)
    points = [] if made is None else [_point_contact(made.found, k, tolerance, size) for k in made.chosen()]
    points.sort(key=lambda c: (c.a, c.b, tuple(c.points[0]), tuple(c.normal)))
    return replace(detection, interfaces=(*detection.interfaces, *points), near_misses=tuple(misses))


def law_refusal(model: Model, group: Array) -> Refusal:
    """Return what says why the law between two bodies of a group can hold at no contact without area."""

    def refused(a: int, b: int) -> str:
        rule = model.rule_between(model.bodies[group[a]], model.bodies[group[b]])
        law = model.laws[rule.law]
        if law.compressive_strength is not None:
            return f"its law '{rule.law}' has a compressive strength, and a corner or an edge has no area"
        if law.changes:
            return f"its law '{rule.law}' changes with pressures and stresses, and a corner or an edge has no area"
        return ""

    return refused


def _refused(miss: NearMiss, reason: str) -> NearMiss:
    head = miss.sentence.split("; no joint was made")[0]
    return replace(miss, sentence=f"{head}; no joint was made ({reason}: give it a length, or another law)")


def _contacts(
    bodies: Sequence[Body] | Sequence[Polyhedron], asked: set[tuple[int, int]], reach: Array, tolerance: float
) -> Contacts:
    """Return the contacts without area of pairs of bodies, numbered as the bodies are; at least one pair."""
    own = np.array(sorted({k for pair in asked for k in pair}), dtype=int)
    some = [bodies[k] for k in own.tolist()]
    pieces = ConvexBodies.of(some)
    pieces = replace(pieces, body=own[pieces.body])
    still = np.zeros(len(bodies), dtype=bool)
    i, j = pairs_of(pieces, float(2 * reach[own].max(initial=0.0)), still)
    wanted = np.array([(a, b) in asked for a, b in zip(pieces.body[i], pieces.body[j], strict=True)], dtype=bool)
    i, j = i[wanted], j[wanted]
    near = np.minimum(reach[pieces.body[i]], reach[pieces.body[j]])
    slack = np.maximum(SLACK * np.minimum(pieces.size[i], pieces.size[j]), tolerance)
    found = find_contacts(pieces, (i, j), near, slack=slack)
    top = pieces.dim - 1
    return found.chosen(~(found.dims == top).all(1) & (found.gap[found.first[:-1]] <= near.max(initial=0.0)))


class _Made:
    """Which contacts near misses tell of.

    Parameters
    ----------
    found : Contacts
    reach : (B,) array
        How far from each body another still touches it [m].
    """

    def __init__(self, found: Contacts, reach: Array) -> None:
        self.found, self.reach = found, reach
        self.ends = [found.on_a[p:q] for p, q in zip(found.first[:-1], found.first[1:], strict=True)]
        self.of_pair: dict[tuple[int, int], list[int]] = {}
        for k, pair in enumerate(zip(found.body_a.tolist(), found.body_b.tolist(), strict=True)):
            if not any(self._repeats(k, other) for other in self.of_pair.get(pair, [])):
                self.of_pair.setdefault(pair, []).append(k)
        self.used: set[int] = set()

    def covers(self, miss: NearMiss) -> bool:
        """Return whether contacts stand where a near miss is, over all of its length; they are made then."""
        near = 4 * min(self.reach[b] for b in miss.bodies)
        at = [k for k in self.of_pair.get(miss.bodies, []) if self._away(k, miss.at) <= near + 0.5 * miss.length]
        length = sum(float(np.linalg.norm(self.ends[k][-1] - self.ends[k][0])) for k in at)
        if not at or length < (1 - SHORT) * miss.length - 2 * near:
            return False
        self.used |= set(at)
        return True

    def chosen(self) -> list[int]:
        """Return the contacts that near misses reported."""
        return sorted(self.used)

    def _repeats(self, k: int, other: int) -> bool:
        """Return whether two pieces of one body have the same contact."""
        near = 2 * min(self.reach[self.found.body_a[k]], self.reach[self.found.body_b[k]])
        same = float(self.found.normal[k] @ self.found.normal[other]) > 1 - SAME
        return same and all(self._away(other, x) <= near for x in self.ends[k])

    def _away(self, k: int, at: Array) -> float:
        p, q = self.ends[k][0], self.ends[k][-1]
        along = q - p
        share = float(np.clip((at - p) @ along / max(float(along @ along), 1e-300), 0.0, 1.0))
        return float(np.linalg.norm(at - p - share * along))


def _point_contact(found: Contacts, k: int, tolerance: float, size: Array) -> PointContact:
    own = slice(found.first[k], found.first[k + 1])
    a, b = int(found.body_a[k]), int(found.body_b[k])
    signed = (found.on_b[own] - found.on_a[own]) @ found.normal[k]
    gap = np.where(signed <= tolerance, 0.0, signed)
    points = found.on_a[own]
    for array in (points, gap, signed):
        array.setflags(write=False)
    return PointContact(a, b, found.kinds[k], points, found.normal[k] + 0.0, gap, signed, float(min(size[a], size[b])))
