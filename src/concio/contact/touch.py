r"""Where candidates touch: point, normal, gap of every end of a common length and of every corner, for any placement.

A contact is a corner P of one body (the *slave*) on an edge of another (the *master*); its gap is the distance of P
from the line of the edge, :math:`g = n \cdot (P - x)`. With both bodies moving rigidly

.. math:: \dot g = n \cdot (v_s(P) - v_m(P)), \qquad
          \ddot g = n \cdot (-\omega_s^2 r_s - 2 \omega_m J \dot u - \omega_m^2 u) \quad \text{at constant velocities},

with r_s and u the arms of P from the two centroids and :math:`\dot u = v_s(P) - v_m`. The second is what the turning of
the bodies adds to the rate of a gap within a step, along the tangent likewise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.candidates import Candidates
from concio.contact.edges import MovingEdges, PlacedEdges
from concio.kinematics.frames import dot, norm, turned_left, turned_right
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import swept

Array = np.ndarray

SAME = 1e-6
"""Corners closer than this share of an edge, along it, coincide."""



@dataclass(frozen=True, eq=False)
class Touch:
    """Contact points: the lower ends of common lengths, their upper ends, and single corners.

    Parameters
    ----------
    point : (2 f + q, d) array
        The corner.
    normal : (2 f + q, d) array
        Unit normal from body a to body b.
    gap : (2 f + q,) array
        [m].
    on_a : (2 f + q,) boolean array
        Whether the edge belongs to body a (the corner to b).
    length : (f,) array
        Common length of the edges that face each other; not positive where there is none [m].
    valid : (2 f + q,) boolean array
        Whether the corner stands over the edge.
    frame : (2 f + q, d, d) array or None
        Normal and tangents, where tangents follow a body: in space.
    """

    point: Array
    normal: Array
    gap: Array
    on_a: Array
    length: Array
    valid: Array
    frame: Array | None = None


@dataclass(frozen=True, eq=False)
class Toucher:
    """What is needed of the candidates in every step, gathered once.

    Parameters
    ----------
    a, b : (f,) integer arrays
        Edges that face each other.
    corner, edge : (q,) integer arrays
    body_a, body_b : (2 f + q,) integer arrays
        Bodies of the contact points.
    length_a : (f,) array
    length_edge : (q,) array
    shortest : (f,) array
        Common lengths shorter than this are none [m].
    slack : float
        How far beyond the end of an edge a single corner still stands over it [m].
    inner : (2, f) boolean array
        Whether lower and upper ends were corners of b when last examined: where corners of both bodies nearly coincide
        the choice stays what it was, for the two contact points differ by what the edges have sunk in.
    """

    a: Array
    b: Array
    corner: Array
    edge: Array
    body_a: Array
    body_b: Array
    length_a: Array
    length_edge: Array
    shortest: Array
    slack: float
    inner: Array

    @classmethod
    def of(cls, edges: MovingEdges, found: Candidates, sliver: float, slack: float) -> Toucher:
        """Gather the data of candidates; ``sliver`` is the shortest common length over the narrower body's width."""
        a, b, corner, edge = found.edge_a, found.edge_b, found.corner, found.edge
        body_a, body_b = edges.body[a], edges.body[b]
        shortest = sliver * np.minimum(edges.width[body_a], edges.width[body_b])
        inner = np.zeros((2, len(a)), dtype=bool)
        return cls(
            a, b, corner, edge,
            np.concatenate([body_a, body_a, edges.body[edge]]), np.concatenate([body_b, body_b, edges.body[corner]]),
            edges.length[a], edges.length[edge], shortest, slack, inner,
        )  # fmt: skip

    def touch(self, placed: PlacedEdges) -> Touch:
        """Return the contact points of placed edges."""
        faces = self._faces(placed)
        if not len(self.corner):
            return faces
        x, t = placed.start[self.edge], placed.tangent[self.edge]
        point, normal = placed.start[self.corner], turned_right(t)
        away = point - x
        gap, along = dot(normal, away), dot(t, away)
        valid = (along >= -self.slack) & (along <= self.length_edge + self.slack)
        ends = (faces.point, faces.normal, faces.gap, faces.on_a, faces.valid)
        corners = (point, normal, gap, np.ones(len(valid), dtype=bool), valid)
        point, normal, gap, on_a, valid = (np.concatenate(pair) for pair in zip(ends, corners, strict=True))
        return Touch(point, normal, gap, on_a, faces.length, valid)

    def _faces(self, placed: PlacedEdges) -> Touch:
        """Return the contact points of edges that face each other, lower ends before upper ones."""
        t_a, t_b = placed.tangent[self.a], placed.tangent[self.b]
        p, q_far = placed.start[self.a], placed.start[self.b]
        t = t_a - t_b
        t /= norm(t)[:, None]
        corner_a = np.array([p, placed.end[self.a]])
        corner_b = np.array([placed.end[self.b], q_far])
        away = corner_b - p
        end = self.length_a * dot(t, t_a)
        inside = dot(t, away)  # how far inside edge a the corners of b are, from either end
        inside[1] = end - inside[1]
        inner = np.where(np.abs(inside) > SAME * self.length_a, inside > 0.0, self.inner)  # ends that are corners of b
        self.inner[:] = inner
        normal_a, normal_b = turned_right(t_a), turned_left(t_b)  # both from a to b
        gap = np.where(inner, dot(normal_a, away), dot(normal_b, q_far - corner_a))
        length = end - np.where(inner, inside, 0.0).sum(axis=0)
        valid, pick = np.tile(length > self.shortest, 2), inner[:, :, None]
        return Touch(
            np.where(pick, corner_b, corner_a).reshape(-1, 2), np.where(pick, normal_a, normal_b).reshape(-1, 2),
            gap.ravel(), inner.ravel(), length, valid,
        )  # fmt: skip

    def turning(self, touch: Touch, placement: Placement, velocity: Array, spin: Array) -> Array:
        """Return the relative accelerations (2 f + q, d) that turning adds, b seen from a [m/s2].

        Parameters
        ----------
        touch : Touch
        placement : Placement
        velocity : (B, d) array
            Of the centroids.
        spin : (B,) array in the plane, (B, 3) in space
            [rad/s].
        """
        centre = placement.centre
        master = np.where(touch.on_a, self.body_a, self.body_b)
        slave = np.where(touch.on_a, self.body_b, self.body_a)
        u, r = touch.point - centre[master], touch.point - centre[slave]
        w_m, w_s = spin[master], spin[slave]
        swung = swept(w_s, r)
        moved = velocity[slave] + swung - velocity[master]
        seen = swept(w_s, swung) + swept(w_m, swept(w_m, u) - 2.0 * moved)
        return np.asarray(np.where(touch.on_a, 1.0, -1.0)[:, None] * seen)
