"""Places for contact pairs: a fixed layout between two searches, so that states and matrices carry over.

A joint of two rigid sides has a slot at each end of its common length and, where its law needs the pressure resolved,
between; a joint of a meshed side has one for each node of the finer side; a corner on an edge has one. A slot that
touches nothing at the moment stays in the layout and carries no force.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.contact.candidates import Candidates
from concio.contact.coupling import Coupling, Line, Side, couple
from concio.contact.edges import MovingEdges, PlacedEdges
from concio.contact.joint_points import joint_rule
from concio.contact.laws import LawTable, RuleBook
from concio.contact.pairs import line_of
from concio.contact.touch import Touch, Toucher
from concio.fem.discretisation import Discretisation
from concio.kinematics.frames import dot, norm

Array = np.ndarray

KINDS = 64
"""Slots of one joint that keys can tell apart."""

LONE = 1.0 / 12.0
"""Share of a corner's longer edge that counts as its tributary length: that of the end point of five."""


@dataclass(frozen=True, eq=False)
class MeshedSide:
    """How the nodes of meshed bodies enter the slots of one side.

    Parameters
    ----------
    meshed : (m,) boolean array
        Slots whose side is meshed; the others move rigidly.
    node : (m, k) integer array
        Nodes, numbered through all meshed bodies; one past the last where there is none.
    weight : (m, k) array
    """

    meshed: Array
    node: Array
    weight: Array


@dataclass(frozen=True, eq=False)
class Slots:
    """The layout of m slots.

    Parameters
    ----------
    low, high : (m,) integer arrays
        Contact points (of :class:`concio.contact.touch.Touch`) between which a slot stands.
    fraction : (m,) array
        Where between them, 0 at ``low``.
    share : (m,) array
        Share of the common length that is tributary to the slot; for a single corner a length [m].
    face : (m,) integer array
        Number of the joint; -1 for single corners.
    key : (m,) integer array
        Names a slot across searches.
    body_a, body_b : (m,) integer arrays
    law : (m,) integer array
    opening : (m,) array
        What is added to the gap that the outlines show [m].
    thickness : (m,) array
        [m].
    bonded : (m,) boolean array
        Slots of joints that were there in the beginning, which may have cohesion and tensile strength.
    side_a, side_b : MeshedSide or None
        None where no side is meshed.
    """

    low: Array
    high: Array
    fraction: Array
    share: Array
    face: Array
    key: Array
    body_a: Array
    body_b: Array
    law: Array
    opening: Array
    thickness: Array
    bonded: Array
    side_a: MeshedSide | None
    side_b: MeshedSide | None

    def __len__(self) -> int:
        return len(self.low)


class SlotMaker:
    """Makes the slots of candidates.

    Parameters
    ----------
    disc : Discretisation
    edges : MovingEdges
    laws : LawTable
    rules : RuleBook
    drawn : mapping of (edge a, edge b) to (gap at start, gap at end)
        Joints that were there in the beginning, with the distances as drawn that count as none [m].
    first_node : (B,) integer array
        Number of the first node of each meshed body.
    nodes : int
        Nodes of all meshed bodies.
    """

    def __init__(
        self,
        disc: Discretisation,
        edges: MovingEdges,
        laws: LawTable,
        rules: RuleBook,
        drawn: dict[tuple[int, int], tuple[float, float]],
        first_node: Array,
        nodes: int,
    ) -> None:
        self.disc, self.edges, self.laws, self.rules, self.drawn = disc, edges, laws, rules, drawn
        self.first_node, self.nodes = first_node, nodes
        self.thickness = np.array([b.thickness for b in disc.model.bodies])
        self.meshed = disc.shape_of >= 0

    def make(self, found: Candidates, toucher: Toucher, touch: Touch, placed: PlacedEdges) -> Slots:
        """Return the slots of candidates where they are now."""
        f, q = len(found.edge_a), len(found.corner)
        edges = self.edges
        law_f, open_f = self.rules.find(toucher.body_a[:f], toucher.body_b[:f])
        law_q, open_q = self.rules.find(toucher.body_a[2 * f :], toucher.body_b[2 * f :])
        meshed = self.meshed[toucher.body_a[:f]] | self.meshed[toucher.body_b[:f]]
        points = np.where(meshed, 0, self.laws.points[law_f])
        face, number, fraction, share = [], [], [], []
        for count in np.unique(points[points > 0]).tolist():
            own = np.flatnonzero(points == count)
            face.append(np.repeat(own, count))
            number.append(np.tile(np.arange(count), len(own)))
            places, shares = joint_rule(count)
            fraction.append(np.tile(places, len(own)))
            share.append(np.tile(shares, len(own)))
        sides = self._meshed_faces(np.flatnonzero(meshed), found, touch, placed)
        face += sides.face
        number += sides.number
        fraction += sides.fraction
        share += sides.share
        lone = 2 * f + np.arange(q)
        of = np.concatenate([*face, np.zeros(0, dtype=int)]).astype(int)
        rigid_count = len(of) - sides.count
        before, longer = edges.before[found.corner], edges.length[found.corner]
        key_f = (found.edge_a[of] * len(edges.body) + found.edge_b[of]) * KINDS + np.concatenate([*number, [0]])[:-1]
        key_q = (found.corner * len(edges.body) + found.edge) * KINDS + KINDS - 1
        at = np.concatenate([*fraction, [0.0]])[:-1]
        drawn = [self.drawn.get(pair) for pair in zip(found.edge_a.tolist(), found.edge_b.tolist(), strict=True)]
        known = np.array([d is not None for d in drawn], dtype=bool)
        ends = np.array([d or (0.0, 0.0) for d in drawn]).reshape(-1, 2)
        a, b = toucher.body_a, toucher.body_b
        body_a, body_b = np.concatenate([a[:f][of], a[lone]]), np.concatenate([b[:f][of], b[lone]])
        opening = open_f[of] - ((1 - at) * ends[of, 0] + at * ends[of, 1])
        return Slots(
            low=np.concatenate([of, lone]),
            high=np.concatenate([of + f, lone]),
            fraction=np.concatenate([at, np.zeros(q)]),
            share=np.concatenate([*share, LONE * np.maximum(longer, edges.length[before])]),
            face=np.concatenate([of, np.full(q, -1)]),
            key=np.concatenate([key_f.astype(np.int64), key_q]),
            body_a=body_a,
            body_b=body_b,
            law=np.concatenate([law_f[of], law_q]),
            opening=np.concatenate([opening, open_q]),
            thickness=np.minimum(self.thickness[body_a], self.thickness[body_b]),
            bonded=np.concatenate([known[of], np.zeros(q, dtype=bool)]),
            side_a=sides.side(0, rigid_count, self.nodes),
            side_b=sides.side(1, rigid_count, self.nodes),
        )

    def _meshed_faces(self, faces: Array, found: Candidates, touch: Touch, placed: PlacedEdges) -> _MeshedSlots:
        """Return the slots of joints with a meshed side, and of corners of meshed bodies."""
        result, own, number = _MeshedSlots(), self.edges.body, self.edges.number
        for i in faces.tolist():
            a, b = int(found.edge_a[i]), int(found.edge_b[i])
            t = placed.tangent[a] - placed.tangent[b]
            t /= norm(t)
            start, length = touch.point[i], float(touch.length[i])
            least = 1e-9 * float(self.edges.length[a])  # two edges that only meet may have rounding in common
            past = length <= least
            if past:
                length = least
            lines = [
                line_of(
                    self.disc, int(own[e]), int(number[e]), float(dot(t, placed.start[e] - start)), forwards,
                    abs(float(dot(t, placed.tangent[e]))),
                )
                for e, forwards in ((a, True), (b, False))
            ]  # fmt: skip
            if past:
                lines = [None if line is None else _reaching(line, length) for line in lines]
            result.add(i, couple(lines[0], lines[1], length), length, self.edges.body[[a, b]], self.first_node)
        for corner, edge in zip(found.corner.tolist(), found.edge.tolist(), strict=True):
            result.add_corner(self._on_edge(edge, placed.start[corner], placed), self._at_corner(corner))
        return result

    def _at_corner(self, corner: int) -> tuple[Array, Array] | None:
        """Return node and weight of the corner where an edge starts; None where its body is not meshed."""
        b = int(self.edges.body[corner])
        if not self.meshed[b]:
            return None
        nodes = self.disc.shapes[self.disc.shape_of[b]].edges[int(self.edges.number[corner])]
        return self.first_node[b] + nodes.nodes[:1], np.ones(1)

    def _on_edge(self, edge: int, point: Array, placed: PlacedEdges) -> tuple[Array, Array] | None:
        """Return nodes and linear weights of a point on an edge; None where its body is not meshed."""
        b = int(self.edges.body[edge])
        if not self.meshed[b]:
            return None
        nodes = self.disc.shapes[self.disc.shape_of[b]].edges[int(self.edges.number[edge])]
        t, away = placed.tangent[edge], point - placed.start[edge]
        along = float(np.clip(dot(t, away), nodes.at[0], nodes.at[-1]))
        k = int(np.clip(np.searchsorted(nodes.at, along) - 1, 0, len(nodes.at) - 2))
        share = (along - nodes.at[k]) / (nodes.at[k + 1] - nodes.at[k])
        return self.first_node[b] + nodes.nodes[k : k + 2], np.array([1.0 - share, share])


class _MeshedSlots:
    """Slots of joints with a meshed side, as they are collected."""

    def __init__(self) -> None:
        self.face: list[Array] = []
        self.number: list[Array] = []
        self.fraction: list[Array] = []
        self.share: list[Array] = []
        self.count = self.corners = 0
        self.entries: tuple[list[tuple[Array, Array, Array]], ...] = ([], [])
        self.meshed: tuple[list[Array], ...] = ([], [])

    def add(self, face: int, coupling: Coupling, length: float, bodies: Array, first_node: Array) -> None:
        """Add the slots of a joint."""
        p = len(coupling.at)
        self.face.append(np.full(p, face))
        self.number.append(np.arange(p))
        self.fraction.append(coupling.at / length)
        self.share.append(coupling.length / length)
        for k, side in enumerate((coupling.a, coupling.b)):
            self.meshed[k].append(np.full(p, side is not None))
            if isinstance(side, Side):
                self.entries[k].append((self.count + side.pair, first_node[bodies[k]] + side.node, side.weight))
        self.count += p

    def add_corner(self, on_edge: tuple[Array, Array] | None, at_corner: tuple[Array, Array] | None) -> None:
        """Add the slot of a corner of body b on an edge of body a; slots of corners come last."""
        for k, entry in enumerate((on_edge, at_corner)):
            self.meshed[k].append(np.array([entry is not None]))
            if entry is not None:
                node, weight = entry
                self.entries[k].append((np.full(len(node), self.count + self.corners), node, weight))
        self.corners += 1

    def side(self, k: int, before: int, nodes: int) -> MeshedSide | None:
        """Return one side of all slots, of which ``before`` between rigid sides come first."""
        if not self.entries[0] and not self.entries[1]:
            return None
        total = before + self.count + self.corners
        meshed = np.concatenate([np.zeros(before, dtype=bool), *self.meshed[k]])
        if not self.entries[k]:
            return MeshedSide(meshed, np.full((total, 1), nodes), np.zeros((total, 1)))
        pair, node, weight = (np.concatenate(v) for v in zip(*self.entries[k], strict=True))
        order = np.argsort(pair, kind="stable")
        pair, node, weight = pair[order], node[order], weight[order]
        place = np.arange(len(pair)) - np.searchsorted(pair, pair)
        wide = int(place.max()) + 1
        nodes_of, weights = np.full((total, wide), nodes), np.zeros((total, wide))
        nodes_of[before + pair, place], weights[before + pair, place] = node, weight
        return MeshedSide(meshed, nodes_of, weights)


def _reaching(line: Line, length: float) -> Line:
    """Return a line moved along itself until it meets a segment: faces that slid past each other share no length."""
    before, behind = max(0.5 * length - float(line.at[-1]), 0.0), max(float(line.at[0]) - 0.5 * length, 0.0)
    return line if before == behind == 0.0 else replace(line, at=line.at + (before - behind))
