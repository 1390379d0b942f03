"""Contact pairs of polyhedra written down once more: what certificates of motions in space are evaluated on.

Nothing here is what a solve kept. Of the search it takes the names of the pairs (a corner and a face, or two edges),
the sense in which two edges touch, and which of the points that coincide stands for the others. Corners, normals, gaps,
rows and laws are worked out again from the model. That bodies do not stand in each other is decided by separating axes
of their convex pieces, without any pair (:meth:`OriginalSolids.deepest`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.contact.reference import Reference
from concio.contact.rows import Rows
from concio.contact.slots import Slots
from concio.contact.solid_search import SolidLayout
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID

Array = np.ndarray

SLACK = 2e-9
"""How far beyond a face or an edge a pair may touch, over the size of the model."""

SAME = 2e-7
"""Distance over the size of the model below which a point stands for another."""

SKEW = 2e-3
"""Sine of the angle between edges that cross."""


@dataclass(frozen=True, eq=False)
class _Named:
    """The pairs of a layout by their names: their two bodies, corners and faces or edges, in numbers of these bodies."""

    slots: Slots
    on_face: Array
    body: Array
    local: Array
    columns: Array
    sound: bool = True


class OriginalSolids:
    """Writes the contact pairs of placed polyhedra.

    Parameters
    ----------
    reference : Reference
    """

    def __init__(self, reference: Reference) -> None:
        self.reference = reference
        disc, bodies = reference.disc, reference.model.polyhedra
        self.bodies = bodies
        self.arms = [b.vertices - disc.centroids[i] for i, b in enumerate(bodies)]
        solids = reference.solids
        self._first_vertex = np.searchsorted(solids.body, np.arange(len(bodies)))
        self._first_face = np.searchsorted(solids.face_body, np.arange(len(bodies)))
        self._named: tuple[SolidLayout, _Named] | None = None
        self._rule: dict[tuple[int, int], tuple[int, float]] = {}
        self._pieces: dict[int, list[tuple[Array, Array, Array]]] = {}

    def law(self, a: int, b: int) -> tuple[int, float]:
        """Return number and opening [m] of the law between two bodies."""
        if (a, b) not in self._rule:
            model = self.reference.model
            rule = model.rule_between(model.bodies[a], model.bodies[b])
            self._rule[a, b] = list(model.laws).index(rule.law), rule.gap
        return self._rule[a, b]

    def named(self, layout: SolidLayout) -> _Named:
        """Return the pairs that a layout names."""
        if self._named is None or self._named[0] is not layout:
            self._named = layout, self._read(layout)
        return self._named[1]

    def _read(self, layout: SolidLayout) -> _Named:
        """Read the names of the pairs of a layout."""
        solids, disc = self.reference.solids, self.reference.disc
        on_face, first, second = solids.features(layout.slots.key)
        m = len(on_face)
        body, local = np.empty((m, 2), dtype=int), np.empty((m, 2, 2), dtype=int)
        f, v = second[on_face], first[on_face]
        body[on_face] = np.column_stack([solids.face_body[f], solids.body[v]])
        local[on_face, 0] = (f - self._first_face[solids.face_body[f]])[:, None]
        local[on_face, 1] = (v - self._first_vertex[solids.body[v]])[:, None]
        for k, edge in enumerate((first[~on_face], second[~on_face])):
            owner = solids.edge_body[edge]
            body[~on_face, k] = owner
            local[~on_face, k] = solids.edge[edge] - self._first_vertex[owner][:, None]
        laws = [self.law(min(a, b), max(a, b)) for a, b in body.tolist()]
        law, opening = np.array([v[0] for v in laws], dtype=int), np.array([v[1] for v in laws], dtype=float)
        n = disc.unknowns
        parts = []
        for k in (0, 1):
            free = disc.shape_of[body[:, k]] == RIGID
            parts.append(np.where(free[:, None], disc.offsets[body[:, k]][:, None] + np.arange(6), n))
        slots = replace(layout.slots, body_a=body[:, 0], body_b=body[:, 1], law=law, opening=opening)
        return _Named(slots, on_face, body, local, np.concatenate(parts, axis=1))

    def at(
        self, layout: SolidLayout, centre: Array, rotation: Array, velocity: Array, spin: Array, strain: Array
    ) -> tuple[Slots, Rows]:
        """Return the pairs and the rows of bodies that stand and move so.

        Parameters
        ----------
        layout : SolidLayout
            Whose pairs.
        centre : (B, 3) array
            [m].
        rotation : (B, 3, 3) array
        velocity : (B, 3) array
            Of the centroids [m/s].
        spin : (B, 3) array
            [rad/s].
        strain : (0, 3) array
            There are no elastic bodies.
        """
        n = self.named(layout)
        place = [c + arm @ R.T for c, R, arm in zip(centre, rotation, self.arms, strict=True)]
        m = len(n.on_face)
        point, frame, gap, beyond = np.zeros((m, 3)), np.zeros((m, 3, 3)), np.zeros(m), np.zeros(m)
        for i in range(m):
            (a, b), (p, q) = n.body[i], n.local[i]
            if n.on_face[i]:
                one = self._corner(place[a], place[b], rotation[a], int(a), int(p[0]), int(q[0]))
            else:
                one = _crossing(place[a][p], place[b][q], layout.toucher.sign[i - int(n.on_face.sum())])
            point[i], frame[i], gap[i], beyond[i] = one
        valid = self._standing(layout, point, beyond)
        values, imposed = self._rows(n, point, frame, centre, rotation, velocity)
        turning = self._turning(n, place, point, frame, centre, velocity, spin, layout.toucher.sign)
        return n.slots, Rows(
            n.columns, values, gap + n.slots.opening, imposed, turning, valid, np.ones(m), point, frame
        )

    def _corner(
        self, of_a: Array, of_b: Array, turn: Array, a: int, face: int, corner: int
    ) -> tuple[Array, Array, float, float]:
        """Return point, frame, gap of a corner over a face, and how far it lies beyond the face."""
        body = self.bodies[a]
        loops = [of_a[list(loop)] for loop in body.loops_of(face)]
        area = sum(np.cross(ring - loops[0][0], np.roll(ring, -1, axis=0) - loops[0][0]).sum(0) for ring in loops)
        normal = area / np.linalg.norm(area)
        along = turn @ _level(body.normals[face])
        frame = np.array([normal, along, np.cross(normal, along)])
        away = of_b[corner] - loops[0][0]
        flat = np.concatenate([_sides((ring - loops[0][0]) @ frame[1:].T) for ring in loops])
        return of_b[corner], frame, float(away @ normal), _beyond(flat, frame[1:] @ away)

    def _standing(self, layout: SolidLayout, point: Array, beyond: Array) -> Array:
        """Return the pairs that touch: those the search chose, if they stand over each other and for all that coincide."""
        size = self.reference.disc.size
        chosen = layout.toucher.chosen & (beyond <= SLACK * size)
        i, j = layout.toucher.near.T
        same = np.linalg.norm(point[i] - point[j], axis=1) <= SAME * size
        stood_for = np.zeros(len(point), dtype=bool)
        for one, other in ((i, j), (j, i)):
            stood_for[other[same & chosen[one]]] = True
        missed = (beyond <= -SLACK * size) & ~chosen & ~stood_for
        return np.asarray(chosen | missed)

    def _rows(
        self, n: _Named, point: Array, frame: Array, centre: Array, rotation: Array, velocity: Array
    ) -> tuple[Array, Array]:
        """Return rows (m, 3, 12) of b minus a, and imposed velocities (m, 3)."""
        disc, axes = self.reference.disc, self.reference.spin_axes.axes
        assert axes is not None, "bodies in space"
        values, imposed = np.zeros((len(point), 3, 12)), np.zeros((len(point), 3))
        for k, sign in ((0, -1.0), (1, 1.0)):
            b = n.body[:, k]
            free = sign * (disc.shape_of[b] == RIGID)[:, None]
            arm, own = point - centre[b], np.matmul(rotation[b], axes[b])
            for way in range(3):
                moment = np.cross(arm, frame[:, way]) / disc.reach[b][:, None]
                values[:, way, 6 * k : 6 * k + 3] = free * frame[:, way]
                values[:, way, 6 * k + 3 : 6 * k + 6] = free * np.einsum("mi,mij->mj", moment, own)
                still = sign * (disc.shape_of[b] == FIXED)
                imposed[:, way] += still * (velocity[b] * frame[:, way]).sum(axis=1)
        return values, imposed

    def _turning(
        self, n: _Named, place: list[Array], point: Array, frame: Array, centre: Array, velocity: Array, spin: Array,
        sign: Array,
    ) -> Array:  # fmt: skip
        """Return what turning adds to the relative velocities of pairs (m, 3), per time [m/s2]."""
        found = np.zeros((len(point), 3))
        if not spin.any():
            return found
        first = int(n.on_face.sum())
        for i, (a, b) in enumerate(n.body.tolist()):
            swung = [np.cross(spin[c], point[i] - centre[c]) for c in (a, b)]
            slip = velocity[b] + swung[1] - velocity[a] - swung[0]
            seen = np.cross(spin[b], swung[1]) - np.cross(spin[a], swung[0])
            if n.on_face[i]:
                seen = seen - 2.0 * np.cross(spin[a], slip)
            else:
                d_a, d_b = (place[c][v[1]] - place[c][v[0]] for c, v in zip((a, b), n.local[i], strict=True))
                rate = np.cross(np.cross(spin[a], d_a), d_b) + np.cross(d_a, np.cross(spin[b], d_b))
                rate = sign[i - first] * rate / np.linalg.norm(np.cross(d_a, d_b))
                normal = frame[i, 0]
                seen = seen + 2.0 * float((rate - (rate @ normal) * normal) @ slip) * normal
            found[i] = frame[i] @ seen
        return found

    # -- what nobody found ---------------------------------------------------------------------------------------------

    def deepest(self, centre: Array, rotation: Array, strain: Array, share: float, more: float = 0.0) -> float:
        """Return how deep a body stands inside another one, over what it may.

        Parameters
        ----------
        centre, rotation, strain : (B, 3), (B, 3, 3) and (0, 3) arrays
        share : float
            What it may over the narrower body's width, beside what the model was drawn with.
        more : float
            What it may beside [m].
        """
        reference = self.reference
        place = [c + arm @ R.T for c, R, arm in zip(centre, rotation, self.arms, strict=True)]
        low, high = np.array([p.min(axis=0) for p in place]), np.array([p.max(axis=0) for p in place])
        fixed = reference.disc.shape_of == FIXED
        worst = 0.0
        for a in range(len(place)):
            near = (low[a + 1 :] < high[a]).all(axis=1) & (high[a + 1 :] > low[a]).all(axis=1)
            near &= ~(fixed[a] & fixed[a + 1 :])
            for b in (a + 1 + np.flatnonzero(near)).tolist():
                _, opening = self.law(a, b)
                width = float(reference.surface.width[[a, b]].min())
                allowed = share * width + 2 * reference.tolerance + abs(opening) + more
                depth = max(
                    _depth([v @ rotation[a].T + centre[a], *(w @ rotation[a].T for w in ways)],
                           [u @ rotation[b].T + centre[b], *(w @ rotation[b].T for w in others)])
                    for v, *ways in self.pieces(a) for u, *others in self.pieces(b)
                )  # fmt: skip
                worst = max(worst, depth / allowed)
        return worst

    def pieces(self, b: int) -> list[tuple[Array, Array, Array]]:
        """Return vertices, normals and directions of edges of the convex pieces of a body, from its centroid."""
        if b not in self._pieces:
            body, centroid = self.bodies[b], self.reference.disc.centroids[b]
            if body.pieces is None:
                msg = f"block '{body.name}' falls into too many convex pieces: its motion cannot be certified"
                raise InputError(msg, hint="divide it into simpler blocks")
            self._pieces[b] = [(p.vertices - centroid, p.normals, p.directions) for p in body.pieces]
        return self._pieces[b]


def _level(normal: Array) -> Array:
    """Return the first tangent of a face as described: horizontal, of a horizontal face along x."""
    level = np.hypot(normal[0], normal[1])
    if level > 1e-6:
        return np.array([-normal[1], normal[0], 0.0]) / level
    along = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    return np.asarray(along / np.linalg.norm(along))


def _sides(ring: Array) -> Array:
    """Return the sides (s, 2, 2) of a polygon (s, 2)."""
    return np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)


def _beyond(sides: Array, at: Array) -> float:
    """Return how far a point (2,) lies outside a polygon with sides (s, 2, 2), negative inside [m]."""
    p, q = sides[:, 0] - at, sides[:, 1] - at
    along = q - p
    share = np.clip(-(p * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    distance = float(np.linalg.norm(p + share[:, None] * along, axis=1).min())
    around = np.arctan2(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0], (p * q).sum(axis=1)).sum()
    return -distance if abs(around) > np.pi else distance


def _crossing(one: Array, other: Array, sign: float) -> tuple[Array, Array, float, float]:
    """Return point, frame, gap of two edges (2, 3) where they come nearest, and how far beyond their ends that is."""
    d_a, d_b = one[1] - one[0], other[1] - other[0]
    both = np.cross(d_a, d_b)
    size, longs = float(np.linalg.norm(both)), (float(np.linalg.norm(d_a)), float(np.linalg.norm(d_b)))
    if size <= SKEW * longs[0] * longs[1]:
        return one[0], np.eye(3), 0.0, np.inf
    normal = sign * both / size
    (s, u, gap), along = np.linalg.solve(np.column_stack([d_a, -d_b, normal]), other[0] - one[0]), d_a / longs[0]
    beyond = max(max(-s, s - 1.0) * longs[0], max(-u, u - 1.0) * longs[1])
    return one[0] + s * d_a + 0.5 * gap * normal, np.array([normal, along, np.cross(normal, along)]), gap, beyond


def _depth(one: list[Array], other: list[Array]) -> float:
    """Return how deep two convex pieces stand in each other: vertices, normals, directions of edges; at least zero [m]."""
    crossed = np.cross(one[2][:, None], other[2][None]).reshape(-1, 3)
    size = np.linalg.norm(crossed, axis=1)
    ways = np.concatenate([one[1], other[1], crossed[size > 1e-6] / size[size > 1e-6, None]])
    p, q = one[0] @ ways.T, other[0] @ ways.T
    overlap = np.minimum(p.max(axis=0) - q.min(axis=0), q.max(axis=0) - p.min(axis=0))
    return max(float(overlap.min()), 0.0)
