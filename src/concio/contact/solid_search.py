"""The contact search of polyhedra that move: candidates within a skin, looked for again when it is half used up.

Bodies are near where their boxes, grown by the skin, meet. Of two bodies that are near, corners are candidates for
faces that they may come to stand on, and edges for edges that they may come to cross: those whose surroundings turn
away from each other along the normal.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.candidates import THROUGH
from concio.contact.contact_search import ContactSearch, Layout
from concio.contact.face_joints import FaceJoints
from concio.contact.laws import RuleBook
from concio.contact.moving_solids import MovingSolids, PlacedSolids
from concio.contact.polygon_points import outside
from concio.contact.rows import Rows
from concio.contact.slots import Slots
from concio.contact.solid_sides import FacetSides
from concio.contact.solid_touch import SAME, Crossing, SolidToucher
from concio.kinematics.boxes import meeting_boxes
from concio.kinematics.frames import cross, dot, norm
from concio.model.linked import pairs_within

if TYPE_CHECKING:
    from concio.contact.reference import Reference

Array = np.ndarray

SHIFT = 2e-3
"""Share of the spacing of nodes by which a point may slide over an elastic face before its weights are looked up."""

AWAY = 0.1
"""Sine of the angle by which what surrounds a corner or an edge may turn towards the other body."""

EQUAL = 1e-6
"""Relative difference up to which two bodies have nodes equally close."""

ALIKE = 0.9
"""Cosine of the angle between the normals of two points that may stand for each other."""


@dataclass(frozen=True, eq=False)
class SolidLayout(Layout):
    """Slots of polyhedra.

    Parameters
    ----------
    toucher : SolidToucher
    joint : (m,) integer array
        Number of the joint as described that a slot belongs to; -1 where there was none.
    faces, feet : (m, 2) integer array, (m, 2, 2) array
        Faces of elastic bodies on either side, and where on them slots stood when the layout was made [m].
    """

    toucher: SolidToucher
    joint: Array
    faces: Array
    feet: Array


class SolidSearch(ContactSearch[PlacedSolids, SolidLayout]):
    """Finds the contact pairs of polyhedra that move.

    Parameters
    ----------
    reference : Reference
    """

    def __init__(self, reference: Reference) -> None:
        super().__init__(reference, reference.solids)
        self.solids, self.same = reference.solids, SAME * reference.disc.size
        self.fixed = np.array([b.kind == "fixed" for b in reference.model.bodies])
        self.facets = None
        if len(reference.meshed):
            nodes = len(reference.body_of_node)
            self.facets = FacetSides(reference.disc, self.solids, reference.first_node, nodes)

    def found(self, placed: PlacedSolids, old: SolidLayout | None) -> tuple[SolidLayout, bool]:
        """Return the layout where bodies stand; with the pairs of the old one only what is elastic differs."""
        toucher = find_solid_candidates(
            self.solids, placed, self.fixed, self.skin, self.slack, self.same, self.reference.rules
        )
        slots = self._slots(toucher)
        if old is not None:  # what stood for others goes on doing so
            toucher.chosen[:] = np.isin(slots.key, old.slots.key[old.toucher.chosen])
            if np.array_equal(slots.key, old.slots.key):  # what names the pairs has not changed, nor what solves them
                laid = self._laid(replace(slots, key=old.slots.key), toucher, placed, old.joint)
                return laid, self.facets is not None
        joints = self.reference.joint_numbers
        pairs = zip(slots.body_a.tolist(), slots.body_b.tolist(), strict=True)
        joint = np.array([joints.get((min(p), max(p)), -1) for p in pairs], dtype=int)
        return self._laid(slots, toucher, placed, joint), True

    def shifted(self, layout: SolidLayout, placed: PlacedSolids) -> bool:
        """Return whether points have slid over faces of elastic bodies."""
        if self.facets is None:
            return False
        touch = layout.toucher.touch(placed)
        moved = norm(self.facets.feet(layout.faces, touch, placed) - layout.feet)
        bodies = np.column_stack([layout.slots.body_a, layout.slots.body_b])
        far = moved > SHIFT * self.solids.spacing[bodies]
        return bool((far & (layout.faces >= 0) & touch.valid[:, None]).any())

    def _laid(self, slots: Slots, toucher: SolidToucher, placed: PlacedSolids, joint: Array) -> SolidLayout:
        """Return slots as a layout, with the nodes of elastic bodies that enter them."""
        m = len(slots)
        faces, feet = np.full((m, 2), -1), np.zeros((m, 2, 2))
        if self.facets is not None:
            faces = self.facets.faces(toucher)
            feet = self.facets.feet(faces, toucher.touch(placed), placed)
            side_a, side_b = self.facets.sides(toucher, faces, feet)
            slots = replace(slots, side_a=side_a, side_b=side_b)
        return SolidLayout(slots, toucher, self.row_maker(slots, toucher), placed.start, joint, faces, feet)

    def _slots(self, toucher: SolidToucher) -> Slots:
        """Return the slots of contact points: one each. Corners and edges have no area, and friction alone."""
        a, b = toucher.body_a, toucher.body_b
        law, opening = self.reference.rules.find(a, b)
        m, joints, lone = len(a), toucher.joints, len(toucher.joint)
        face, share, bonded = np.full(m, -1), np.ones(m), np.zeros(m, dtype=bool)
        law[:lone] += len(self.reference.laws.names)
        key = self.solids.key(toucher.corner, toucher.face, toucher.edges)
        if joints is not None:
            face[lone:], share[lone:], bonded[lone:] = joints.of, joints.share, joints.bonded
            opening[lone:] -= joints.drawn
            key = np.concatenate([key, self.solids.joint_key(joints.face[joints.of], joints.number)])
        number = np.arange(m)
        return Slots(
            number, number, np.zeros(m), share, face, key, a, b, law, opening, np.ones(m), bonded, None, None
        )

    def handed_on(self, rows: Rows, carried: Array) -> tuple[Array, Array, Array]:
        """Return which pairs stop to stand for a point, which ones go on, and whether sides are swapped."""
        assert self.layout is not None
        slots, near = self.layout.slots, self.layout.toucher.near
        source, target = np.concatenate([near, near[:, ::-1]]).T
        pick = (carried & ~rows.valid)[source] & (rows.valid & ~carried)[target]
        source, target = source[pick], target[pick]
        away = norm(rows.point[source] - rows.point[target])
        order = np.argsort(away, kind="stable")
        order = order[away[order] <= 0.5 * self.skin]
        source, target = source[order], target[order]
        _, first = np.unique(source, return_index=True)
        source, target = source[np.sort(first)], target[np.sort(first)]
        _, first = np.unique(target, return_index=True)
        source, target = source[first], target[first]
        return source, target, slots.body_a[source] != slots.body_a[target]


def find_solid_candidates(
    solids: MovingSolids, placed: PlacedSolids, fixed: Array, skin: float, slack: float, same: float, rules: RuleBook
) -> SolidToucher:
    """Return the candidates of placed surfaces.

    Parameters
    ----------
    solids : MovingSolids
    placed : PlacedSolids
    fixed : (B,) boolean array
        Bodies that do not move freely: two of them are no candidates.
    skin : float
        Distance within which features are candidates [m].
    slack, same : float
        See :class:`concio.contact.solid_touch.SolidToucher` [m].
    rules : RuleBook
        Say by which initial openings features may stand deeper.
    """
    a, b = near_bodies(solids, placed, fixed, skin)
    one, other = np.concatenate([a, b]), np.concatenate([b, a])
    corner, face = _products(solids.body, other, solids.face_body, one)
    corner, face = _on_faces(solids, placed, *_of_finer(solids, corner, face), skin, rules)
    first, second = _products(solids.edge_body, a, solids.edge_body, b)
    edges, sign = _across(solids, placed, np.column_stack([first, second]), skin, rules)
    body_a = np.concatenate([solids.face_body[face], solids.edge_body[edges[:, 0]]])
    body_b = np.concatenate([solids.body[corner], solids.edge_body[edges[:, 1]]])
    joints, joint = _near_joints(solids, a, b), np.full(len(body_a), -1)
    if joints is not None:
        joint = joints.covers(solids, corner, face, edges)
    toucher = SolidToucher(
        solids, corner, face, edges, sign, body_a, body_b, slack, same, np.zeros((0, 2), dtype=int),
        np.zeros(len(body_a), dtype=bool), None, joint,
    )  # fmt: skip
    found = toucher.touch(placed)
    near = pairs_within(found.point, 2.0 * skin) if len(found.point) else toucher.near
    i, j = near.T
    pair = np.sort(np.column_stack([body_a, body_b]), axis=1)
    turn = np.where(body_a < body_b, 1.0, -1.0)
    alike = dot(found.normal[i], found.normal[j]) * turn[i] * turn[j] > ALIKE
    near = near[(pair[i] == pair[j]).all(axis=1) & alike]
    if joints is not None:
        body_a, body_b = (np.concatenate([own, joints.body[joints.of, k]]) for k, own in enumerate((body_a, body_b)))
    return replace(
        toucher, body_a=body_a, body_b=body_b, near=near, chosen=np.zeros(len(body_a), dtype=bool), joints=joints
    )


def _near_joints(solids: MovingSolids, a: Array, b: Array) -> FaceJoints | None:
    """Return the joints of faces of pairs of bodies (n,) that are near; None where there are none."""
    if solids.joints is None:
        return None
    count = len(solids.width)
    picked = solids.joints.picked(np.isin(solids.joints.body @ [count, 1], a * count + b))
    return picked if len(picked) else None


def near_bodies(solids: MovingSolids, placed: PlacedSolids, fixed: Array, skin: float) -> tuple[Array, Array]:
    """Return pairs of bodies (n,), the first number lower, whose boxes grown by a skin meet."""
    count = len(solids.width)
    low, high = np.full((2, count, 3), np.inf) * [[[1.0]], [[-1.0]]]
    np.minimum.at(low, solids.body, placed.start)
    np.maximum.at(high, solids.body, placed.start)
    i, j = meeting_boxes(low - skin, high + skin)
    free = ~(fixed[i] & fixed[j])
    return i[free], j[free]


def _products(of: Array, body: Array, of_other: Array, other: Array) -> tuple[Array, Array]:
    """Return all pairs of features, those of the bodies ``body`` (n,) with those of ``other`` (n,)."""
    start, end = np.searchsorted(of, body), np.searchsorted(of, body, side="right")
    begin, stop = np.searchsorted(of_other, other), np.searchsorted(of_other, other, side="right")
    size, wide = (end - start) * (stop - begin), stop - begin
    pair = np.repeat(np.arange(len(body)), size)
    place = np.arange(len(pair)) - np.repeat(np.cumsum(size) - size, size)
    return start[pair] + place // wide[pair], begin[pair] + place % wide[pair]


def _of_finer(solids: MovingSolids, corner: Array, face: Array) -> tuple[Array, Array]:
    """Return pairs (n,) without those of nodes on elastic faces whose own nodes are closer: one side's are enough."""
    inner, own, other = solids.beside[corner] > 0, solids.body[corner], solids.face_body[face]
    here, there = solids.spacing[own], solids.spacing[other]
    alike = (here <= (1 + EQUAL) * there) & (there <= (1 + EQUAL) * here) & np.isfinite(there)
    keep = ~inner | np.where(alike, own < other, here < there)
    return corner[keep], face[keep]


def _on_faces(
    solids: MovingSolids, placed: PlacedSolids, corner: Array, face: Array, skin: float, rules: RuleBook
) -> tuple[Array, Array]:
    """Return corners that may come to stand on faces, of all pairs (n,)."""
    normal, start = placed.normal[face], placed.start[corner]
    away = start - placed.start[solids.face_start[face]]
    gap = dot(normal, away)
    one, other = solids.face_body[face], solids.body[corner]
    deep = THROUGH * np.minimum(solids.width[one], solids.width[other]) + rules.openings(one, other)
    keep = (gap <= 2 * skin) & (gap >= -deep)
    corner, face, normal, away, start = corner[keep], face[keep], normal[keep], away[keep], start[keep]
    around = placed.start[solids.around[corner]] - start[:, None]
    length = np.linalg.norm(around, axis=2)
    lifts = np.einsum("nkc,nc->nk", around, normal) >= -AWAY * length
    tangent = placed.tangent[face]
    x, y = dot(away, tangent), dot(away, cross(normal, tangent))
    keep = lifts.all(axis=1)
    keep[keep] = outside(solids.sides[face[keep]], x[keep], y[keep]) <= 2 * skin
    return corner[keep], face[keep]


def _across(
    solids: MovingSolids, placed: PlacedSolids, edges: Array, skin: float, rules: RuleBook
) -> tuple[Array, Array]:
    """Return edges that may come to cross, of all pairs (n, 2), and the signs of their normals (k,)."""
    ends = placed.start[solids.edge]
    low, high = ends.min(axis=1), ends.max(axis=1)
    i, j = edges.T
    edges = edges[((low[i] - 2 * skin <= high[j]) & (low[j] - 2 * skin <= high[i])).all(axis=1)]
    d = ends[:, 1] - ends[:, 0]
    d = d / norm(d)[:, None]
    before, behind = (placed.normal[solids.edge_faces[:, k]] for k in (0, 1))
    into = np.stack([cross(before, d), cross(d, behind)], axis=1)
    normal = cross(d[edges[:, 0]], d[edges[:, 1]])
    size = norm(normal)
    normal = normal / np.where(size > 0, size, 1.0)[:, None]
    a, b = (np.einsum("nkc,nc->nk", into[edges[:, k]], normal) for k in (0, 1))
    found, signs = [], []
    for sign in (1.0, -1.0):
        keep = (sign * a <= AWAY).all(axis=1) & (sign * b >= -AWAY).all(axis=1)
        kept = edges[keep]
        way = np.full(len(kept), sign)
        crossing = Crossing.of(ends[kept], way)
        bodies = solids.edge_body[kept]
        deep = THROUGH * solids.width[bodies].min(axis=1) + rules.openings(*bodies.T)
        close = (crossing.beyond <= 2 * skin) & (crossing.gap <= 2 * skin) & (crossing.gap >= -deep)
        found.append(kept[close])
        signs.append(way[close])
    return np.concatenate(found), np.concatenate(signs)
