"""Contact pairs written down once more, from outlines and where bodies stand: what certificates are evaluated on.

Nothing here is what a solve kept. Of the search it takes the names of the pairs (their two edges), and where corners
coincide which of them touches; of elastic sides the nodes and weights of the coupling, which are checked. Placed
outlines, normals, gaps, areas, rows and laws are worked out again, from the model. What the search did not find shows
where a corner stands inside another body (:meth:`OriginalContacts.deepest`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from concio.contact.edge_search import EdgeLayout
from concio.contact.joint_points import joint_rule
from concio.contact.reference import Configuration, Reference
from concio.contact.rows import Rows
from concio.contact.slots import KINDS, LONE, Slots
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.frames import dot, turned, turned_left
from concio.kinematics.placement import Placement
from concio.model.interfaces.detect import SLIVER_SHARE

Array = np.ndarray

COINCIDE = 2e-6
"""Corners closer than this share of an edge, along it, coincide: either of them may be the one that touches."""

WEIGHTS = 1e-9
"""Error of the sum of the weights of nodes of an elastic side that is rounding."""


@dataclass(frozen=True, eq=False)
class _Named:
    """The pairs of a layout by their names; what does not depend on where the bodies stand.

    Parameters
    ----------
    slots : Slots
        With laws, openings and shares as the model has them.
    edge_a, edge_b : (f,) integer arrays
        Of the faces.
    shortest : (f,) array
        Least common length [m].
    claimed : (2, f) boolean array
        View of what touches, by the search: the corners of b.
    corner, edge : (q,) integer arrays
    columns : (m, w) integer array
    sound : bool
        Whether the weights of elastic sides sum to one on nodes of the bodies named.
    """

    slots: Slots
    edge_a: Array
    edge_b: Array
    shortest: Array
    claimed: Array
    corner: Array
    edge: Array
    columns: Array
    sound: bool


class OriginalContacts:
    """Writes the contact pairs of placed bodies.

    Parameters
    ----------
    reference : Reference
    """

    def __init__(self, reference: Reference) -> None:
        self.reference, model, disc = reference, reference.model, reference.disc
        edges = reference.edges
        self.body = edges.body
        vertices = [b.vertices - disc.centroids[i] for i, b in enumerate(model.outlines)]
        number = edges.number.tolist()
        self.start = np.array([vertices[b][k] for b, k in zip(self.body.tolist(), number, strict=True)])
        self.end = np.array(
            [vertices[b][model.outlines[b].following[k]] for b, k in zip(self.body.tolist(), number, strict=True)]
        )
        self.length = np.hypot(*(self.end - self.start).T)
        self.before = {(int(b), *p): e for e, (b, p) in enumerate(zip(self.body, self.end.tolist(), strict=True))}
        self.rigid = disc.shape_of == RIGID
        self._named: tuple[EdgeLayout, _Named] | None = None
        self._rule: dict[tuple[int, int], tuple[int, float]] = {}

    # -- what the names say --------------------------------------------------------------------------------------------

    def named(self, layout: EdgeLayout) -> _Named:
        """Return the pairs that a layout names."""
        if self._named is None or self._named[0] is not layout:
            self._named = layout, self._read(layout)
        return self._named[1]

    def law(self, a: int, b: int) -> tuple[int, float]:
        """Return number and opening [m] of the law between two bodies."""
        if (a, b) not in self._rule:
            model = self.reference.model
            rule = model.rule_between(model.bodies[a], model.bodies[b])
            self._rule[a, b] = list(model.laws).index(rule.law), rule.gap
        return self._rule[a, b]

    def _read(self, layout: EdgeLayout) -> _Named:
        """Read the names of the pairs of a layout."""
        key, count = layout.slots.key, len(self.body)
        name, number = np.divmod(key, KINDS)
        first, second = np.divmod(name, count)
        lone = number == KINDS - 1
        faces, face = np.unique(name[~lone], return_inverse=True)
        edge_a, edge_b = np.divmod(faces, count)
        corner, edge = first[lone], second[lone]
        f, m = len(faces), len(key)
        of = np.full(m, -1)
        of[~lone] = face
        body_a, body_b = np.empty(m, dtype=int), np.empty(m, dtype=int)
        body_a[~lone], body_b[~lone] = self.body[first[~lone]], self.body[second[~lone]]
        body_a[lone], body_b[lone] = self.body[edge], self.body[corner]
        laws = [self.law(a, b) for a, b in zip(body_a.tolist(), body_b.tolist(), strict=True)]
        law, opening = np.array([v[0] for v in laws], dtype=int), np.array([v[1] for v in laws], dtype=float)
        fraction, share = self._places(layout.slots, law, number, lone)
        drawn = self.reference.drawn
        known = [drawn.get(pair) for pair in zip(edge_a.tolist(), edge_b.tolist(), strict=True)]
        ends = np.array([d or (0.0, 0.0) for d in known]).reshape(-1, 2)
        s = fraction[~lone]
        opening[~lone] -= (1 - s) * ends[face, 0] + s * ends[face, 1]
        share[lone] = LONE * np.maximum(self.length[corner], self.length[[self._into(c) for c in corner.tolist()]])
        bonded = np.zeros(m, dtype=bool)
        bonded[~lone] = np.array([d is not None for d in known], dtype=bool)[face]
        low, high = np.where(lone, 0, of), np.where(lone, 0, of + f)
        low[lone] = high[lone] = 2 * f + np.arange(lone.sum())
        thickness = np.array([b.thickness for b in self.reference.model.outlines])
        old = layout.slots
        slots = Slots(
            low, high, fraction, share, of, key, body_a, body_b, law, opening,
            np.minimum(thickness[body_a], thickness[body_b]), bonded, old.side_a, old.side_b,
        )  # fmt: skip
        narrow = self.reference.edges.width[np.stack([self.body[edge_a], self.body[edge_b]])].min(axis=0)
        at = {(int(a), int(b)): i for i, (a, b) in enumerate(zip(layout.toucher.a, layout.toucher.b, strict=True))}
        pick = [at[a, b] for a, b in zip(edge_a.tolist(), edge_b.tolist(), strict=True)]
        return _Named(
            slots, edge_a, edge_b, SLIVER_SHARE * narrow, np.array(pick, dtype=int), corner, edge,
            self._columns(slots), self._weighted(slots),
        )  # fmt: skip

    def _into(self, corner: int) -> int:
        """Return the edge that ends where another starts."""
        return self.before[int(self.body[corner]), *self.start[corner].tolist()]

    def _places(self, slots: Slots, law: Array, number: Array, lone: Array) -> tuple[Array, Array]:
        """Return where pairs (m,) stand along their joints and their shares: by the rule of their law if rigid."""
        fraction, share = slots.fraction.copy(), slots.share.copy()
        meshed = np.zeros(len(law), dtype=bool)
        for side in (slots.side_a, slots.side_b):
            meshed |= False if side is None else side.meshed
        for i in np.flatnonzero(~lone & ~meshed).tolist():
            places, shares = joint_rule(int(self.reference.laws.points[law[i]]))
            fraction[i], share[i] = places[number[i]], shares[number[i]]
        return fraction, share

    def _columns(self, slots: Slots) -> Array:
        """Return the unknowns (m, w) of the rows: rigid motions of both bodies, then nodes."""
        disc, n = self.reference.disc, self.reference.disc.unknowns
        parts = []
        for body, side in ((slots.body_a, slots.side_a), (slots.body_b, slots.side_b)):
            free = self.rigid[body] & (True if side is None else ~side.meshed)
            parts.append(np.where(free[:, None], disc.offsets[body][:, None] + np.arange(3), n))
        for side in (slots.side_a, slots.side_b):
            if side is not None:
                parts.append(self.reference.node_column[side.node].reshape(len(slots), 2 * side.node.shape[1]))
        return np.concatenate(parts, axis=1)

    def _weighted(self, slots: Slots) -> bool:
        """Return whether elastic sides are means over nodes of the bodies that the pairs name."""
        sound = True
        owner = np.append(self.reference.body_of_node, -1)
        for body, side in ((slots.body_a, slots.side_a), (slots.body_b, slots.side_b)):
            elastic = self.reference.disc.shape_of[body] >= 0
            if side is None:
                sound &= not elastic.any()
                continue
            own = owner[side.node] == body[:, None]
            right = np.abs(side.weight.sum(axis=1) - 1.0) < WEIGHTS
            sound &= bool((side.meshed == elastic).all() and right[elastic].all())
            sound &= bool((own | (side.weight == 0))[elastic].all() and not side.weight[~elastic].any())
        return sound

    # -- where the bodies stand ----------------------------------------------------------------------------------------

    def at(
        self, layout: EdgeLayout, centre: Array, rotation: Array, velocity: Array, spin: Array, strain: Array
    ) -> tuple[Slots, Rows]:
        """Return the pairs and the rows of bodies that stand and move so.

        Parameters
        ----------
        layout : EdgeLayout
            Whose pairs.
        centre : (B, 2) array
            [m].
        rotation : (B,) array
            [rad].
        velocity : (B, 2) array
            Of the centroids [m/s].
        spin : (B,) array
            [rad/s].
        strain : (nodes, 2) array
            Displacements of nodes in the frames of their bodies [m].
        """
        n = self.named(layout)
        slots, body = n.slots, self.body
        p0, p1 = (centre[body] + turned(arm, rotation[body]) for arm in (self.start, self.end))
        tangent = (p1 - p0) / self.length[:, None]
        point, normal, gap, on_a, length, valid = self._ends(n, layout, p0, p1, tangent)
        s, low, high = slots.fraction[:, None], slots.low, slots.high
        place, direction = (1 - s) * point[low] + s * point[high], (1 - s) * normal[low] + s * normal[high]
        direction = direction / np.hypot(*direction.T)[:, None]
        distance = (1 - s[:, 0]) * gap[low] + s[:, 0] * gap[high] + slots.opening
        values, strained, imposed = self._rows(
            slots, n.columns, place, direction, centre, rotation, velocity, spin, strain
        )
        master = np.where(on_a, self._of_point(slots.body_a, n), self._of_point(slots.body_b, n))
        slave = np.where(on_a, self._of_point(slots.body_b, n), self._of_point(slots.body_a, n))
        extra = _turning(point, normal, np.where(on_a, 1.0, -1.0), master, slave, centre, velocity, spin)
        along = np.where(slots.face >= 0, length[slots.face], 1.0) if len(length) else np.ones(len(slots))
        frame = np.stack([direction, turned_left(direction)], axis=1)
        return slots, Rows(
            n.columns, values, distance + strained, imposed, (1 - s) * extra[low] + s * extra[high],
            valid[low] & valid[high], slots.share * along * slots.thickness, place, frame,
        )  # fmt: skip

    def _of_point(self, of_slot: Array, n: _Named) -> Array:
        """Return what slots (m,) say of the points (2 f + q,) between which they stand."""
        found = np.zeros(2 * len(n.edge_a) + len(n.corner), dtype=int)
        found[n.slots.low] = of_slot
        found[n.slots.high] = of_slot
        return found

    def _ends(
        self, n: _Named, layout: EdgeLayout, p0: Array, p1: Array, tangent: Array
    ) -> tuple[Array, Array, Array, Array, Array, Array]:
        """Return points, normals, gaps of the ends of faces and of single corners, whose edge, lengths, validity."""
        a, b = n.edge_a, n.edge_b
        t_a, t_b = tangent[a], tangent[b]
        mean = t_a - t_b
        mean = mean / np.hypot(*mean.T)[:, None]
        whole = self.length[a] * dot(mean, t_a)
        corners_a, corners_b = np.stack([p0[a], p1[a]]), np.stack([p1[b], p0[b]])
        inside = dot(corners_b - p0[a], mean)
        inside[1] = whole - inside[1]
        near = np.abs(inside) <= COINCIDE * self.length[a]
        of_b = np.where(near, layout.toucher.inner[:, n.claimed], inside > 0.0)
        out_a, out_b = -turned_left(t_a), -turned_left(t_b)  # out of either body
        gap_b = dot(corners_b - p0[a], out_a)
        gap_a = dot(corners_a - p0[b], out_b)
        pick = of_b[:, :, None]
        point = np.where(pick, corners_b, corners_a).reshape(-1, 2)
        normal = np.where(pick, out_a, -out_b).reshape(-1, 2)
        gap = np.where(of_b, gap_b, gap_a).ravel()
        length = whole - np.where(of_b, inside, 0.0).sum(axis=0)
        valid = np.tile(length > n.shortest, 2)
        lone, out = p0[n.corner], -turned_left(tangent[n.edge])
        away = lone - p0[n.edge]
        along = dot(away, tangent[n.edge])
        slack = 1e-9 * self.reference.disc.size
        over = (along >= -slack) & (along <= self.length[n.edge] + slack)
        return (
            np.concatenate([point, lone]), np.concatenate([normal, out]),
            np.concatenate([gap, dot(away, out)]), np.concatenate([of_b.ravel(), np.ones(len(lone), bool)]),
            length, np.concatenate([valid, over]),
        )  # fmt: skip

    def _rows(
        self, slots: Slots, columns: Array, place: Array, normal: Array, centre: Array, rotation: Array,
        velocity: Array, spin: Array, strain: Array,
    ) -> tuple[Array, Array, Array]:  # fmt: skip
        """Return rows (m, 2, w) of b minus a, what strains add to the gaps (m,) [m], and imposed velocities (m, 2)."""
        m, disc = len(slots), self.reference.disc
        values, strained, imposed = np.zeros((m, 2, columns.shape[1])), np.zeros(m), np.zeros((m, 2))
        still = ~self.rigid & (disc.shape_of < 0)
        sides = ((-1.0, slots.body_a, slots.side_a, 0), (1.0, slots.body_b, slots.side_b, 3))
        nodes = 6
        ways = normal, turned_left(normal)
        for sign, body, side, first in sides:
            arm, moves = place - centre[body], sign * self.rigid[body]
            still_moved = still[body] & (velocity[body].any(axis=1) | (spin[body] != 0.0))
            v = velocity[body] + spin[body][:, None] * turned_left(arm) if still_moved.any() else None
            for k, way in enumerate(ways):
                moment = (arm[:, 0] * way[:, 1] - arm[:, 1] * way[:, 0]) / disc.reach[body]
                values[:, k, first : first + 2] = moves[:, None] * way
                values[:, k, first + 2] = moves * moment
                if v is not None:
                    imposed[:, k] += sign * still_moved * dot(v, way)
                if side is not None:
                    local = turned(way, -rotation[body])
                    entries = sign * side.weight[:, :, None] * local[:, None, :]
                    values[:, k, nodes : nodes + 2 * side.node.shape[1]] = entries.reshape(m, -1)
                    if k == 0:
                        strained += (entries * np.vstack([strain, np.zeros((1, 2))])[side.node]).sum(axis=(1, 2))
            if side is not None:
                nodes += 2 * side.node.shape[1]
        return values, strained, imposed

    # -- what nobody found ---------------------------------------------------------------------------------------------

    def deepest(self, centre: Array, rotation: Array, strain: Array, share: float, more: float = 0.0) -> float:
        """Return how deep a corner stands inside another body, over what it may, where their joint is hard.

        Parameters
        ----------
        centre, rotation, strain : (B, 2), (B,) and (nodes, 2) arrays
        share : float
            What it may over the narrower body's width, beside what the model was drawn with.
        more : float
            What it may beside [m].
        """
        reference = self.reference
        here = Configuration(reference, Placement(centre, rotation), strain)
        rings = [here.rings(b) for b in range(len(reference.model.bodies))]
        shapes = np.array([shapely.Polygon(r[0], r[1:]) for r in rings])
        corners = np.concatenate([r for ring in rings for r in ring])
        owner = np.repeat(np.arange(len(rings)), [sum(len(r) for r in ring) for ring in rings])
        corner, body = shapely.STRtree(shapes).query(shapely.points(corners), predicate="within")
        both_fixed = (reference.disc.shape_of[body] == FIXED) & (reference.disc.shape_of[owner[corner]] == FIXED)
        other = (owner[corner] != body) & ~both_fixed
        worst = 0.0
        for c, b in zip(corner[other].tolist(), body[other].tolist(), strict=True):
            a = int(owner[c])
            law, opening = self.law(min(a, b), max(a, b))
            laws = reference.laws
            if laws.normal[law] > 0 or np.isfinite(laws.cap[law]):
                continue
            allowed = share * float(reference.edges.width[[a, b]].min()) + 2 * reference.tolerance + abs(opening) + more
            depth = float(shapely.distance(shapely.points(corners[c]), shapely.boundary(shapes[b])))
            worst = max(worst, depth / allowed)
        return worst


def _turning(
    point: Array, normal: Array, sign: Array, master: Array, slave: Array, centre: Array, velocity: Array, spin: Array
) -> Array:
    """Return normal and tangential accelerations (k, 2) of points of slaves seen from masters that turn [m/s2]."""
    if not spin.any():
        return np.zeros((len(point), 2))
    w = spin[master][:, None]
    from_slave = point - centre[slave]
    seen = velocity[slave] + spin[slave][:, None] * turned_left(from_slave) - velocity[master]
    pulled = -(spin[slave] ** 2)[:, None] * from_slave
    seen = pulled - 2.0 * w * turned_left(seen) - w**2 * (point - centre[master])
    ways = np.stack([normal, turned_left(normal)], axis=1)
    found: Array = sign[:, None] * np.einsum("ki,kji->kj", seen, ways)
    return found
