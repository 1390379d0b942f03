"""Assemblies of rigid blocks as contact problems, built without any other part of the package.

Each block has three unknowns (ux, uy of its reference point, rotation); K is zero. An interface is a segment with a
contact point at each of its ends; n points from block a to block b and t = (-n_y, n_x).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import ContactProblem, Laws

GROUND = -1

Courses = list[list[float]]

HALF_ENDS, FULL = [0.5, 1, 1, 1, 1, 0.5], [1.0] * 5
LOW, LOW_SHIFTED = [1.0] * 4, [0.5, 1, 1, 1, 0.5]
DOOR, DOOR_SHIFTED = [0.5, 1, -1, 1, 0.5], [1, 0.5, -1, 0.5, 1]
DOORS, DOORS_SHIFTED = [1, -1, 1, -1, 1], [0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5]
NARROW, NARROW_SHIFTED = [0.5, 1, 1, 0.5], [1.0] * 3
WINDOW, WINDOW_SHIFTED = [1, -1, 1], [0.5, 0.5, -1, 0.5, 0.5]
STOREY = [NARROW, NARROW_SHIFTED, NARROW]
OPENING = [WINDOW, WINDOW_SHIFTED, WINDOW, WINDOW_SHIFTED, WINDOW]
WIDE_ENDS, WIDE = [0.5, 1, 1, 1, 1, 1, 1, 0.5], [1.0] * 7
PAIR, PAIR_SHIFTED = [0.5, 1, -1, 1, 1, -1, 1, 0.5], [1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1]
WINDOWS = [PAIR, PAIR_SHIFTED, PAIR, PAIR_SHIFTED, PAIR]

FERRIS_TIN_LOI: dict[str, Courses] = {
    "wall 1": [HALF_ENDS, FULL] * 3,
    "wall 2": [HALF_ENDS, FULL] * 5,
    "wall 3": [
        LOW, LOW_SHIFTED, LOW, DOOR, DOOR_SHIFTED, DOOR, DOOR_SHIFTED, DOOR, LOW, LOW_SHIFTED, LOW,
    ],
}  # fmt: skip
"""Courses from the base, in block lengths, negative: opening (Ferris and Tin-Loi 2001, Int. J. Mech. Sci. 43)."""

TALLER: dict[str, Courses] = {
    "wall 4": [
        HALF_ENDS, FULL, HALF_ENDS, DOORS, DOORS_SHIFTED, DOORS, DOORS_SHIFTED, DOORS, HALF_ENDS, FULL, HALF_ENDS,
    ],
    "wall 5": [*STOREY, *OPENING, *STOREY, *OPENING, *STOREY],
    "wall 6": [
        *[WIDE_ENDS, WIDE] * 2, *WINDOWS, WIDE, WIDE_ENDS, WIDE, *WINDOWS, WIDE, WIDE_ENDS, WIDE, WIDE_ENDS,
    ],
}  # fmt: skip
"""Their walls 4 to 6: two openings side by side, one above the other, and both. The courses of wall 6 are those of an
open example of HybriDFEM, not read from the paper."""

BLOCK, MU = (0.4, 0.175), 0.65


@dataclass
class Assembly:
    """Rigid blocks and the contact points between them."""

    centres: np.ndarray  # (B, 2) reference points
    weights: np.ndarray  # (B,)
    points: np.ndarray  # (m, 2)
    normals: np.ndarray  # (m, 2) from a to b
    sides: np.ndarray  # (m, 2) block a, block b; GROUND has no unknowns

    @property
    def blocks(self) -> int:
        return len(self.centres)

    def load(self, x: float, y: float) -> np.ndarray:
        """(N,) loads: weight of each block times the vector (x, y)."""
        f = np.zeros((self.blocks, 3))
        f[:, 0], f[:, 1] = x * self.weights, y * self.weights
        return f.ravel()

    def problem(self, mu: float | np.ndarray, f: np.ndarray, laws: Laws | None = None, **changes) -> ContactProblem:
        m, n_unknowns = len(self.points), 3 * self.blocks
        tangents = np.column_stack([-self.normals[:, 1], self.normals[:, 0]])
        C_n, C_t = (self._relative(frame, m, n_unknowns) for frame in (self.normals, tangents))
        laws = laws or Laws.coulomb(mu, m)
        if changes:
            fields = {name: getattr(laws, name) for name in laws.__dataclass_fields__}
            fields.update({name: np.broadcast_to(np.asarray(v, float), (m,)).copy() for name, v in changes.items()})
            laws = Laws(**fields)
        return ContactProblem(
            K=sp.csr_array((n_unknowns, n_unknowns)),
            f=np.asarray(f, float),
            C_n=C_n,
            C_t=C_t,
            gap=np.zeros(m),
            laws=laws,
            R=sp.csc_array(sp.eye_array(n_unknowns)),
            bodies=3 * np.arange(self.blocks + 1),
        )

    def _relative(self, frame: np.ndarray, m: int, n_unknowns: int) -> sp.csr_array:
        rows, cols, data = [], [], []
        for side, sign in ((0, -1.0), (1, 1.0)):
            k = np.flatnonzero(self.sides[:, side] != GROUND)
            b = self.sides[k, side]
            arm = self.points[k] - self.centres[b]
            turn = frame[k, 1] * arm[:, 0] - frame[k, 0] * arm[:, 1]
            for j, value in enumerate((frame[k, 0], frame[k, 1], turn)):
                rows.append(k)
                cols.append(3 * b + j)
                data.append(sign * value)
        parts = (np.concatenate(data), (np.concatenate(rows), np.concatenate(cols)))
        return sp.csr_array(parts, shape=(m, n_unknowns))


def wall(courses: Courses, size: tuple[float, float] = BLOCK, unit_weight: float = 1.0) -> Assembly:
    """Wall of rectangles on a fixed base; bed joints where courses overlap, head joints where blocks are neighbours."""
    length, height = size
    rows: list[list[tuple[float, float, int]]] = []
    boxes = []
    for c, course in enumerate(courses):
        x, row = 0.0, []
        for part in course:
            if part > 0:
                row.append((x, x + part * length, len(boxes)))
                boxes.append((x, c * height, x + part * length, (c + 1) * height))
            x += abs(part) * length
        rows.append(row)
    box = np.array(boxes)
    points, normals, sides = [], [], []

    def joint(p, q, n, a, b):
        points.extend([p, q])
        normals.extend([n, n])
        sides.extend([(a, b), (a, b)])

    for c, row in enumerate(rows):
        y0, y1 = c * height, (c + 1) * height
        for x0, x1, b in row:
            if c == 0:
                joint((x0, 0.0), (x1, 0.0), (0.0, 1.0), GROUND, b)
            else:
                for z0, z1, a in rows[c - 1]:
                    lo, hi = max(x0, z0), min(x1, z1)
                    if hi - lo > 1e-9:
                        joint((lo, y0), (hi, y0), (0.0, 1.0), a, b)
        for (_, xa, a), (xb, _, b) in itertools.pairwise(row):
            if abs(xa - xb) < 1e-9:
                joint((xa, y0), (xa, y1), (1.0, 0.0), a, b)
    centres = 0.5 * (box[:, :2] + box[:, 2:])
    weights = unit_weight * (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])
    return Assembly(centres, weights, np.array(points), np.array(normals, float), np.array(sides))


def running_bond(length: int, courses: int, size: tuple[float, float] = (1.0, 0.5)) -> Assembly:
    """Running bond: even courses of ``length`` whole blocks, odd ones with half blocks at the ends."""
    shifted = [0.5, *[1.0] * (length - 1), 0.5]
    return wall([[1.0] * length if c % 2 == 0 else shifted for c in range(courses)], size)


def block_on_incline(width: float, height: float, angle: float) -> Assembly:
    """One block of weight 1 on a plane that rises by ``angle`` towards +x."""
    along, up = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    points = np.array([-0.5 * width * along, 0.5 * width * along])
    centre = 0.5 * height * up
    return Assembly(centre[None], np.ones(1), points, np.array([up, up]), np.array([[GROUND, 0], [GROUND, 0]]))


def semicircular_arch(voussoirs: int, thickness: float, radius: float = 1.0) -> Assembly:
    """Semicircular arch of exact ring sectors, unit weight 1, centreline ``radius``, springing on fixed abutments."""
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    edge = np.pi * np.arange(voussoirs + 1) / voussoirs
    middle = 0.5 * (edge[1:] + edge[:-1])
    half = 0.5 * np.pi / voussoirs
    arm = 2.0 / 3.0 * np.sin(half) / half * (outer**3 - inner**3) / (outer**2 - inner**2)
    area = half * (outer**2 - inner**2)
    points, normals, sides = [], [], []
    for k, phi in enumerate(edge):
        radial, forward = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
        a, b = (k - 1, k) if k < voussoirs else (k - 1, GROUND)
        points += [inner * radial, outer * radial]
        normals += [forward, forward]
        sides += [(a if k else GROUND, b)] * 2
    centres = arm * np.column_stack([np.cos(middle), np.sin(middle)])
    return Assembly(centres, np.full(voussoirs, area), np.array(points), np.array(normals), np.array(sides))
