"""Small contact problems built without the model, fem and contact assembly: independent of what they test.

Running-bond walls of rectangular Q4 blocks that float freely, node-to-node contact, a rigid base and rigid side walls.
Units: block weight 1, block length 1, E t = 1000.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import ContactProblem, Laws

MODULUS = 1000.0


def q4(a: float, b: float, nu: float = 0.15) -> np.ndarray:
    """Stiffness of an a x b plane-stress rectangle of E t = MODULUS, two by two Gauss points."""
    elastic = MODULUS / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    stiffness = np.zeros((8, 8))
    for xi in (-(3**-0.5), 3**-0.5):
        for eta in (-(3**-0.5), 3**-0.5):
            dx = np.array([-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)]) / (2 * a)
            dy = np.array([-(1 - xi), -(1 + xi), 1 + xi, 1 - xi]) / (2 * b)
            strain = np.zeros((3, 8))
            strain[0, ::2], strain[1, 1::2], strain[2, ::2], strain[2, 1::2] = dx, dy, dy, dx
            stiffness += strain.T @ elastic @ strain * a * b / 4
    return stiffness


class Block:
    """A rectangle meshed by the given grid lines."""

    def __init__(self, xs: np.ndarray, ys: np.ndarray) -> None:
        self.xs, self.ys = xs, ys
        gx, gy = np.meshgrid(xs, ys)
        self.nodes = np.column_stack([gx.ravel(), gy.ravel()])
        n, across = 2 * len(self.nodes), len(xs)
        self.K, self.area = np.zeros((n, n)), np.zeros(len(self.nodes))
        for j in range(len(ys) - 1):
            for i in range(across - 1):
                e = np.array([j * across + i, j * across + i + 1, (j + 1) * across + i + 1, (j + 1) * across + i])
                dofs = np.column_stack([2 * e, 2 * e + 1]).ravel()
                self.K[np.ix_(dofs, dofs)] += q4(xs[i + 1] - xs[i], ys[j + 1] - ys[j])
                self.area[e] += (xs[i + 1] - xs[i]) * (ys[j + 1] - ys[j]) / 4

    @property
    def motions(self) -> np.ndarray:
        """Orthonormal rigid motions."""
        arm = self.nodes - self.nodes.mean(axis=0)
        motions = np.zeros((2 * len(self.nodes), 3))
        motions[::2, 0] = motions[1::2, 1] = 1.0
        motions[::2, 2], motions[1::2, 2] = -arm[:, 1], arm[:, 0]
        return motions / np.linalg.norm(motions, axis=0)


def wall(
    courses: int = 2,
    blocks: int = 2,
    *,
    mu: float | np.ndarray = 0.6,
    alpha: float = 0.0,
    top: float = 0.0,
    base: bool = True,
    sides: bool = False,
    height: float = 0.5,
    gap: float = 0.0,
    soil: float = 0.0,
    fine: int = 1,
) -> ContactProblem:
    """Running-bond wall under self-weight (1 a block), ``alpha`` of it sideways and ``top`` a unit length.

    ``soil`` > 0 adds soft springs to every unknown: no body floats.
    """
    bodies: list[tuple[int, Block]] = []
    for c in range(courses):
        edges = np.arange(blocks + 1.0) if c % 2 == 0 else np.r_[0.0, np.arange(blocks) + 0.5, blocks]
        ys = np.linspace(c * height, (c + 1) * height, fine + 1)
        for left, right in pairwise(edges):
            bodies.append((c, Block(np.linspace(left, right, 1 + round((right - left) * 2 * fine)), ys)))
    offsets = np.cumsum([0] + [2 * len(b.nodes) for _, b in bodies])
    where: dict[tuple[float, float], list[tuple[int, int]]] = {}
    for k, (_, b) in enumerate(bodies):
        for i, p in enumerate(b.nodes):
            where.setdefault((round(p[0], 6), round(p[1], 6)), []).append((k, offsets[k] + 2 * i))
    pairs: list[tuple[int, int, tuple[float, float], float]] = []
    for (x, y), here in sorted(where.items()):
        if y == 0.0 and base:
            pairs += [(-1, dof, (0.0, 1.0), 0.0) for _, dof in here]
        if sides and x in (0.0, float(blocks)):
            pairs += [(-1, dof, (1.0 if x == 0.0 else -1.0, 0.0), gap) for _, dof in here]
        for a, dof_a in here:
            for b, dof_b in here:
                ca, cb = bodies[a][0], bodies[b][0]
                if cb == ca + 1:
                    pairs.append((dof_a, dof_b, (0.0, 1.0), 0.0))
                elif cb == ca and b == a + 1:
                    pairs.append((dof_a, dof_b, (1.0, 0.0), 0.0))
    n, m = int(offsets[-1]), len(pairs)
    c_n, c_t = sp.lil_array((m, n)), sp.lil_array((m, n))
    for k, (a, b, normal, _) in enumerate(pairs):
        for dof, sign in ((a, -1.0), (b, 1.0)):
            if dof >= 0:
                c_n[k, dof], c_n[k, dof + 1] = sign * normal[0], sign * normal[1]
                c_t[k, dof], c_t[k, dof + 1] = -sign * normal[1], sign * normal[0]
    f = np.zeros(n)
    for k, (c, b) in enumerate(bodies):
        part = f[offsets[k] : offsets[k + 1]]
        part[1::2] -= b.area / height
        part[::2] += alpha * b.area / height
        if c == courses - 1 and top:
            row = np.flatnonzero(b.nodes[:, 1] == b.ys[-1])
            length = np.gradient(b.xs)
            length[[0, -1]] /= 2
            part[2 * row + 1] -= top * length
    stiffness = sp.csr_array(sp.block_diag([b.K for _, b in bodies])) + soil * sp.eye_array(n)
    motions = sp.csc_array((n, 0)) if soil else sp.csc_array(sp.block_diag([b.motions for _, b in bodies]))
    return ContactProblem(
        sp.csr_array(stiffness), f, sp.csr_array(c_n), sp.csr_array(c_t), np.array([p[3] for p in pairs]),
        Laws.coulomb(mu, m), motions, offsets,
    )  # fmt: skip


def rigid(problem: ContactProblem) -> ContactProblem:
    """The same bodies made rigid: their unknowns are their rigid motions."""
    r = sp.csr_array(problem.R)
    count = problem.R.shape[1]
    return ContactProblem(
        sp.csr_array((count, count)), r.T @ problem.f, sp.csr_array(problem.C_n @ r), sp.csr_array(problem.C_t @ r),
        problem.gap, problem.laws, sp.csc_array(sp.eye_array(count)), np.arange(0, count + 1, 3),
    )  # fmt: skip
