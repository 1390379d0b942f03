"""Contact problems in space built without the model, fem and contact assembly: independent of what they test.

Blocks are grids of hexahedra; contact points are nodes of two blocks (or of a block and the ground) that coincide on a
common plane face. Units: a full block weighs 1, lengths in block lengths, E = 1. Rigid blocks use the same points with
six unknowns, rotations times the root mean square distance of the nodes.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.spatial import ConvexHull

from concio.problem.contact_problem import ContactProblem, Laws

Array = np.ndarray
Side = tuple[float, float]
Mesh = tuple[int, int, int]
CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])


@dataclass(frozen=True, eq=False)
class Built:
    """A problem under dead load, and a horizontal load in proportion to the weights (N,)."""

    problem: ContactProblem
    live: Array
    centres: Array
    grids: tuple[Array, ...] = ()
    """Nodes of the blocks, where nothing is turned."""

    def at(self, factor: float) -> ContactProblem:
        """The problem under dead load and ``factor`` times the live load."""
        return self.problem.with_loads(self.problem.f + factor * self.live)

    def pushed(self, direction: Array) -> Array:
        """Loads in proportion to the weights in another direction (N,), for blocks whose unknowns are rigid motions."""
        f = np.zeros(self.problem.unknowns)
        weight = -self.problem.f[2::6]
        for e in range(3):
            f[e::6] = direction[e] * weight
        return f


def strain(gradient: Array) -> Array:
    """B (6, 24) of shape function gradients (8, 3)."""
    b = np.zeros((6, 3 * len(gradient)))
    b[0, 0::3], b[1, 1::3], b[2, 2::3] = gradient.T
    b[3, 0::3], b[3, 1::3] = gradient[:, 1], gradient[:, 0]
    b[4, 1::3], b[4, 2::3] = gradient[:, 2], gradient[:, 1]
    b[5, 0::3], b[5, 2::3] = gradient[:, 2], gradient[:, 0]
    return b


def hexahedron(x: Array, nu: float = 0.2) -> tuple[Array, Array]:
    """Stiffness (24, 24) of an eight-node brick, E = 1, and the shares of its volume (8,)."""
    lame, shear = nu / (1 + nu) / (1 - 2 * nu), 0.5 / (1 + nu)
    elastic = np.diag([2 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    stiffness, share = np.zeros((24, 24)), np.zeros(8)
    for point in itertools.product((-(3**-0.5), 3**-0.5), repeat=3):
        p = 1 + np.array(point) * CORNERS
        gradient = np.column_stack([CORNERS[:, a] * np.prod(np.delete(p, a, axis=1), axis=1) for a in range(3)]) / 8
        jacobian = gradient.T @ x
        volume = np.linalg.det(jacobian)
        b = strain(np.linalg.solve(jacobian, gradient.T).T)
        stiffness += b.T @ elastic @ b * volume
        share += np.prod(p, axis=1) / 8 * volume
    return stiffness, share


def build(
    grids: list[Array],
    ground: Callable[[Array], bool],
    mu: float,
    *,
    kn: float = 0.0,
    elastic: bool = False,
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0),
    turned: Array | None = None,
) -> Built:
    """Assemble grids of nodes (nx+1, ny+1, nz+1, 3); ``ground(x)`` says which nodes stand on the fixed ground.

    ``kn`` > 0 gives joints a normal stiffness over their area, 0.4 of it tangentially. ``turned`` is a rotation of
    the whole structure with its loads.
    """
    Q = np.eye(3) if turned is None else turned
    bodies, nodes = [], dict[tuple[float, ...], list[tuple[int, int]]]()
    cache: dict[bytes, tuple[Array, Array]] = {}
    for k, grid in enumerate(grids):
        x = grid.reshape(-1, 3)
        key = np.round(x - x[0], 9).tobytes() + np.array(grid.shape).tobytes()
        if key not in cache:
            cache[key] = _body(x, grid.shape[:3], elastic)
        stiffness, weight = cache[key]
        bodies.append((x, stiffness, weight))
        inner = np.ones(grid.shape[:3], dtype=bool)
        inner[1:-1, 1:-1, 1:-1] = False
        for i in np.flatnonzero(inner.ravel()):
            nodes.setdefault(tuple(np.round(x[i], 6) + 0.0), []).append((k, int(i)))
    unit = float(np.median([w.sum() for _, _, w in bodies]))
    centres = np.array([w @ x / w.sum() for x, _, w in bodies])
    faces: dict[tuple[int, int], list[tuple[int, int, Array]]] = {}
    for point, here in nodes.items():
        for (a, i), (b, j) in itertools.combinations(here, 2):
            faces.setdefault((a, b), []).append((i, j, np.array(point)))
        if ground(np.array(point)):
            for b, j in here:
                faces.setdefault((-1, b), []).append((-1, j, np.array(point)))
    offsets = np.concatenate([[0], np.cumsum([3 * len(x) for x, _, _ in bodies])])
    row, column, value, area = [], [], [], []
    m = 0
    for (a, b), points in faces.items():
        p = np.array([q for _, _, q in points])
        singular, axes = np.linalg.svd(p - p.mean(axis=0), full_matrices=False)[1:]
        if len(p) < 3 or singular[1] < 1e-3 * singular[0]:
            continue  # blocks that share an edge only
        normal = axes[2] * np.sign(axes[2] @ (centres[b] - (p.mean(axis=0) if a < 0 else centres[a])))
        first = np.eye(3)[np.argmin(np.abs(normal))]
        first -= (first @ normal) * normal
        first /= np.linalg.norm(first)
        frame = np.array([normal, first, np.cross(normal, first)]) @ Q.T
        whole = ConvexHull((p - p.mean(axis=0)) @ axes[:2].T).volume
        for i, j, _ in points:
            for body, node, sign in ((a, i, -1.0), (b, j, 1.0)):
                if body >= 0:
                    for r in range(3):
                        row += [3 * m + r] * 3
                        column += [offsets[body] + 3 * node + e for e in range(3)]
                        value += list(sign * frame[r])
            area.append(whole / len(points))
            m += 1
    C = sp.csr_array((value, (row, column)), shape=(3 * m, int(offsets[-1])))
    normal_rows, friction_rows = np.arange(0, 3 * m, 3), np.delete(np.arange(3 * m), np.arange(0, 3 * m, 3))
    weight = np.concatenate([w for _, _, w in bodies]) / unit
    dead, live = np.outer(weight, Q @ [0, 0, -1.0]).ravel(), np.outer(weight, Q @ direction).ravel()
    turn = sp.block_array([[sp.csr_array(Q)]]) if turned is not None else None
    K = sp.csr_array(sp.block_diag([_turned(k, Q) if turn is not None else k for _, k, _ in bodies]))
    motions = [_motions(x @ Q.T, c @ Q.T) for (x, _, _), c in zip(bodies, centres, strict=True)]
    R = sp.csr_array(sp.block_diag(motions))
    areas = np.array(area)
    laws = Laws.coulomb(mu, m)
    if kn:
        laws = replace(laws, normal_compliance=1 / (kn * areas), tangential_compliance=1 / (0.4 * kn * areas))
    mass = np.repeat(weight, 3)
    if not elastic:
        problem = ContactProblem(
            K=sp.csr_array((R.shape[1], R.shape[1])), f=R.T @ dead, C_n=sp.csr_array((C @ R)[normal_rows]),
            C_t=sp.csr_array((C @ R)[friction_rows]), gap=np.zeros(m), laws=laws,
            R=sp.csc_array(sp.eye_array(R.shape[1])), bodies=np.arange(0, R.shape[1] + 1, 6), area=areas,
            inertia=(R.multiply(R)).T @ mass,
        )  # fmt: skip
        return Built(problem, R.T @ live, centres, tuple(grids))
    R = sp.csr_array(sp.block_diag([np.linalg.qr(g)[0] for g in motions]))
    problem = ContactProblem(
        K=K, f=dead, C_n=sp.csr_array(C[normal_rows]), C_t=sp.csr_array(C[friction_rows]), gap=np.zeros(m), laws=laws,
        R=sp.csc_array(R), bodies=offsets, area=areas, inertia=mass,
    )  # fmt: skip
    return Built(problem, live, centres, tuple(grids))


def _body(x: Array, shape: tuple[int, ...], elastic: bool) -> tuple[Array, Array]:
    stiffness, weight = np.zeros((3 * len(x),) * 2 if elastic else (0, 0)), np.zeros(len(x))
    number = np.arange(len(x)).reshape(shape)
    for i, j, k in itertools.product(*(range(n - 1) for n in shape)):
        n = np.array([number[i + (c[0] > 0), j + (c[1] > 0), k + (c[2] > 0)] for c in CORNERS])
        element, share = hexahedron(x[n])
        assert share.min() > 0, "left-handed grid"
        if elastic:
            d = (3 * n[:, None] + np.arange(3)).ravel()
            stiffness[np.ix_(d, d)] += element
        weight[n] += share
    return stiffness, weight


def _motions(x: Array, centre: Array) -> Array:
    size = np.sqrt(((x - centre) ** 2).sum(axis=1).mean())
    motions = np.zeros((3 * len(x), 6))
    for k, r in enumerate((x - centre) / size):
        motions[3 * k : 3 * k + 3, :3] = np.eye(3)
        motions[3 * k : 3 * k + 3, 3:] = [[0, r[2], -r[1]], [-r[2], 0, r[0]], [r[1], -r[0], 0]]
    return motions


def _turned(stiffness: Array, Q: Array) -> Array:
    turn = np.kron(np.eye(len(stiffness) // 3), Q)
    product: Array = turn @ stiffness @ turn.T
    return product


def box(x: Side, y: Side, z: Side, mesh: Mesh = (1, 1, 1)) -> Array:
    """Grid of a box between the ends of three sides."""
    lines = [np.linspace(*side, n + 1) for side, n in zip((x, y, z), mesh, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)


def on_floor(p: Array) -> bool:
    """Whether a node stands on the plane z = 0."""
    return bool(abs(p[2]) < 1e-9)


def stretchers(start: int, count: int) -> list[tuple[float, float]]:
    """Beginnings and lengths of the blocks of a course, whole ones or with a half at both ends (odd ``start``)."""
    if start % 2 == 0:
        return [(float(i), 1.0) for i in range(count)]
    return [(0.0, 0.5), *((i + 0.5, 1.0) for i in range(count - 1)), (count - 0.5, 0.5)]


def headers(leaves: int) -> list[tuple[float, float]]:
    """Beginnings and lengths of blocks laid across so many leaves of half a block."""
    if leaves % 2:
        return [(0.0, 0.5), *((0.5 + j, 1.0) for j in range((leaves - 1) // 2))]
    return [(float(j), 1.0) for j in range(leaves // 2)]


def wall(
    blocks: int,
    courses: int,
    *,
    mu: float = 0.6,
    sides: bool = False,
    mesh: Mesh = (2, 1, 1),
    leaves: int = 1,
    **options: Any,
) -> Built:
    """Running-bond wall of blocks 1 x 1/2 x 1/2 on the ground, or wedged between fixed ``sides`` without a base.

    With ``leaves`` > 1 every other course is of headers that cross them.
    """
    nx, ny, nz = mesh
    grids = []
    for c in range(courses):
        if leaves > 1 and c % 2:
            items = [(i * 0.5, 0.5, y, dy) for y, dy in headers(leaves) for i in range(2 * blocks)]
        else:
            items = [(x, dx, 0.5 * j, 0.5) for j in range(leaves) for x, dx in stretchers(c, blocks)]
        for x, dx, y, dy in items:
            cells = (nx if dx == 1 else max(nx // 2, 1), ny if dy == 0.5 else 2 * ny, nz)
            grids.append(box((x, x + dx), (y, y + dy), (0.5 * c, 0.5 * c + 0.5), cells))

    def at_a_side(p: Array) -> bool:
        return bool(min(p[0], blocks - p[0]) < 1e-9)

    return build(grids, at_a_side if sides else on_floor, mu, **options)


def corner_bricks(courses: int, facade: int, returns: int, *, legs: int = 2) -> list[tuple[Side, Side, Side]]:
    """Sides of bricks 2 x 1 x 1 of a facade along y with one or two returns along x, bonded round the corners."""
    bricks = []
    for c in range(courses):
        even = c % 2 == 0
        ends = (0 if even else 1, facade - (0 if even or legs < 2 else 1))
        runs = [(ends, 1, 0)] + [((1 if even else 0, returns), 0, y) for y in (0, facade - 1)[:legs]]
        for (start, end), axis, across in runs:
            for at in range(start, end, 2):
                along, width = (float(at), float(min(at + 2, end))), (float(across), across + 1.0)
                x, y = (width, along) if axis else (along, width)
                bricks.append((x, y, (float(c), c + 1.0)))
    return bricks


def corner_wall(
    courses: int, facade: int, returns: int, *, legs: int = 2, mu: float = 0.6, mesh: int = 1, **options: Any
) -> Built:
    """Wall with corners on the ground, of :func:`corner_bricks`; ``mesh`` cells for each unit of length."""
    grids = []
    for x, y, z in corner_bricks(courses, facade, returns, legs=legs):
        cells = (int(x[1] - x[0]) * mesh, int(y[1] - y[0]) * mesh, mesh)
        grids.append(box(x, y, z, cells))
    return build(grids, on_floor, mu, **options)


def barrel(
    voussoirs: int,
    rings: int,
    *,
    radius: float = 5.0,
    thickness: float = 0.8,
    mu: float = 0.6,
    mesh: Mesh = (1, 2, 1),
    **options: Any,
) -> Built:
    """Semicircular barrel of bonded rings of width 1 along y."""
    grids = []
    nr, ny, na = mesh
    depth = np.linspace(radius, radius + thickness, nr + 1)
    for i in range(voussoirs):
        angle = np.linspace(i, i + 1, na + 1)[::-1] * np.pi / voussoirs
        for y, dy in stretchers(i, rings):
            cells = ny if dy == 1 else max(ny // 2, 1)
            r, along, a = np.meshgrid(depth, np.linspace(y, y + dy, cells + 1), angle, indexing="ij")
            grids.append(np.stack([-r * np.cos(a), along, r * np.sin(a)], axis=-1))
    return build(grids, on_floor, mu, **options)


def dome(
    courses: int,
    around: int,
    *,
    radius: float = 5.0,
    thickness: float = 0.5,
    mu: float = 0.6,
    oculus: float = 0.2,
    mesh: Mesh = (1, 2, 1),
    **options: Any,
) -> Built:
    """Hemispherical dome of ring courses, each turned by half a voussoir, open at the top."""
    grids = []
    nr, na, nh = mesh
    depth = np.linspace(radius, radius + thickness, nr + 1)
    for i in range(courses):
        latitude = np.linspace(i, i + 1, nh + 1) * (np.pi / 2 - oculus) / courses
        for j in range(around):
            longitude = (np.linspace(0, 1, na + 1) + j + 0.5 * (i % 2)) * 2 * np.pi / around
            r, lo, la = np.meshgrid(depth, longitude, latitude, indexing="ij")
            grids.append(np.stack([r * np.cos(la) * np.cos(lo), r * np.cos(la) * np.sin(lo), r * np.sin(la)], axis=-1))
    return build(grids, on_floor, mu, **options)
