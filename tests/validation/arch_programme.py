"""A linear programme of its own for one arch with fill under an axle, written from the statement alone.

N equal rigid voussoirs of a segmental arch between radial joints; at each joint a force at the intrados and one at
the extrados, pressing along the arch and free or within friction across it. Weights of exact sectors; fill as
vertical strips between extrados and a level road; the axle a strip of length b, uniform over b + z at the depth z;
against each voussoir soil presses horizontally, at the middle of its extrados, between nothing and k gamma z dy.
Abutments are as high as the extrados at the springings and carry what reaches them. The largest axle that forces in
equilibrium carry. Nothing of concio is used.

Joints that crush carry a rectangular block of stress at one edge: abs(M) <= N t / 2 - N^2 / (2 f b). That set is
convex; the programme has it as tangents, which lie closest together where N is small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, lil_matrix

Array = np.ndarray
FINE = 400
"""Strips of each voussoir in which weights and spread are integrated."""
TANGENTS = 200
"""Tangents of the set of forces that a crushing joint carries."""


@dataclass(frozen=True)
class Arch:
    """A segmental arch with fill; lengths in m, weights in kN/m3.

    ``friction`` is None where nothing slides, ``strength`` [kN/m2] where nothing crushes.
    """

    span: float
    rise: float
    ring: float
    voussoirs: int
    masonry: float
    fill: float
    cover: float
    footprint: float
    width: float
    passive: float
    friction: float | None = None
    strength: float | None = None

    def axle(self, x: float) -> float:
        """Return the largest axle load at x from the left springing [kN]."""
        n = self.voussoirs
        radius = (self.span**2 / 4 + self.rise**2) / (2 * self.rise)
        half = np.arcsin(self.span / 2 / radius)
        centre = np.array([self.span / 2, self.rise - radius])
        angle = np.linspace(-half, half, n + 1)  # from the vertical, to the right
        outer = radius + self.ring
        road = centre[1] + outer + self.cover
        middle = 0.5 * (angle[1:] + angle[:-1])
        step = angle[1] - angle[0]
        area = 0.5 * (outer**2 - radius**2) * step
        arm = (2.0 / 3.0) * (outer**3 - radius**3) / (outer**2 - radius**2) * np.sin(step / 2) / (step / 2)
        own = self.masonry * area * self.width
        cut = np.linspace(angle[:-1], angle[1:], FINE + 1, axis=1)  # (n, FINE + 1)
        edge = centre[0] + outer * np.sin(cut)
        at = 0.5 * (edge[:, 1:] + edge[:, :-1])
        depth = road - (centre[1] + np.sqrt(outer**2 - (at - centre[0]) ** 2))
        strips = np.diff(edge, axis=1)
        soil = self.fill * depth * strips * self.width
        covered = self.footprint + depth
        overlap = np.minimum(edge[:, 1:], x + covered / 2) - np.maximum(edge[:, :-1], x - covered / 2)
        live = np.maximum(overlap, 0.0) / covered
        deep = self.footprint + road - (centre[1] + outer * np.cos(half))  # covered at the level of the abutments
        beside = max(x + deep / 2 - edge[-1, -1], 0.0) + max(edge[0, 0] - (x - deep / 2), 0.0)
        live /= live.sum() + beside / deep
        # unknowns: forces (4 at each joint: thrust and shear at intrados and extrados), n pressures, the axle
        joints, size = 4 * (n + 1), 4 * (n + 1) + n + 1
        balance, right = lil_matrix((3 * n, size)), np.zeros(3 * n)
        pressing = np.column_stack([np.cos(angle), -np.sin(angle)])  # along the arch to the right
        across = np.column_stack([np.sin(angle), np.cos(angle)])  # outwards
        for i in range(n):
            pole = centre + 0.5 * (radius + outer) * np.array([np.sin(middle[i]), np.cos(middle[i])])
            for j, sign in ((i, 1.0), (i + 1, -1.0)):  # the joint on the left presses to the right, the other back
                for c, r in enumerate((radius, outer)):
                    place = centre + r * across[j] - pole
                    for d, way in enumerate((pressing[j], across[j])):
                        force = sign * way
                        turn = place[0] * force[1] - place[1] * force[0]
                        for row, value in enumerate((*force, turn)):
                            balance[3 * i + row, 4 * j + 2 * c + d] = value
            top = centre + outer * np.array([np.sin(middle[i]), np.cos(middle[i])])
            rise = outer * abs(np.cos(angle[i]) - np.cos(angle[i + 1]))
            most = self.passive * self.fill * (road - top[1]) * rise * self.width
            way = -np.sign(middle[i]) if abs(middle[i]) > 1e-12 else 0.0
            balance[3 * i, joints + i] = way * most
            balance[3 * i + 2, joints + i] = -(top - pole)[1] * way * most
            share = live[i].sum()
            place = (live[i] * at[i]).sum() / share if share > 0 else pole[0]
            balance[3 * i + 1, -1] = -share
            balance[3 * i + 2, -1] = -(place - pole[0]) * share
            weight = soil[i].sum()
            right[3 * i + 1] = own + weight
            centroid = centre[0] + arm * np.sin(middle[i])
            right[3 * i + 2] = (centroid - pole[0]) * own + ((soil[i] * at[i]).sum() - pole[0] * weight)
        bounds = [(0.0, None), (None, None)] * (joints // 2) + [(0.0, 1.0)] * n + [(0.0, None)]
        limits, most_allowed = self._limits(joints, size)
        cost = np.zeros(size)
        cost[-1] = -1.0
        found = linprog(cost, limits, most_allowed, balance.tocsr(), right, bounds, method="highs")
        assert found.status == 0, found.message
        return float(found.x[-1])

    def _limits(self, joints: int, size: int) -> tuple[csr_matrix | None, Array | None]:
        """Return what bounds the forces of joints that slide or crush, as rows and the most that each is."""
        rows: list[dict[int, float]] = []
        most: list[float] = []
        if self.friction is not None:
            for k in range(joints // 2):
                for sign in (1.0, -1.0):
                    rows.append({2 * k + 1: sign, 2 * k: -self.friction})
                    most.append(0.0)
        if self.strength is not None:
            full = self.strength * self.ring * self.width
            for joint in range(0, joints, 4):
                for at in np.linspace(0.0, 1.0, TANGENTS) ** 2:
                    for inner, outer in ((joint, joint + 2), (joint + 2, joint)):
                        # (outer - inner) t / 2 <= N t / 2 - (2 N0 N - N0^2) / (2 f b), over t / 2 and N0 = at f b t
                        rows.append({outer: 2 * at, inner: -2.0 + 2 * at})
                        most.append(at**2 * full)
        if not rows:
            return None, None
        found = lil_matrix((len(rows), size))
        for k, row in enumerate(rows):
            for column, value in row.items():
                found[k, column] = value
        return found.tocsr(), np.array(most)
