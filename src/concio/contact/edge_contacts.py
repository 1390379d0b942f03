"""Contacts without a face: two edges that cross or lie along each other, a corner on an edge, a corner on a corner.

Where two edges cross, the normal is square to both. Everywhere else many directions keep the two pieces apart. Where
they stand apart, the normal is the direction of least distance. Where they touch, it is the sum of those separating
axes along which they touch: the middle of all directions in which they can part, whatever the numbering.
"""

from __future__ import annotations

import numpy as np

from concio.contact.clipping import nearest
from concio.contact.convex_bodies import ConvexBodies
from concio.contact.meeting_features import CORNER, EDGE, Found
from concio.contact.separating_axes import Sides, every_axis
from concio.kinematics.frames import cross, dot, norm

Array = np.ndarray

ALONG = 1e-6
"""Edges turned against each other by less lie along each other [rad]."""
LIKE = 1e-13
"""One minus the cosine between an edge and the edge that stands for its direction."""
SAME = 1e-12
"""Directions whose scalar product is nearer to one are the same."""


def crossing_edges(
    pieces: ConvexBodies, row: Array, pair: tuple[Array, Array], axes: tuple[Array, Array], normal: Array,
    slack: Array,
) -> tuple[Found, Array]:  # fmt: skip
    """Return where edges cross inside of both, and the pairs whose edges do not.

    Parameters
    ----------
    pieces : ConvexBodies
    row : (m,) integer array
        Numbers of the pairs.
    pair : two (m,) integer arrays
        The pieces.
    axes : two (m,) integer arrays
        Edges that have the directions of the edges that cross.
    normal : (m, d) array
        Square to both, from the first piece to the second.
    slack : (m,) array
        Lengths that count as none [m].
    """
    edge, outermost = zip(
        *(
            _outermost(pieces, piece, axis, sign * normal, slack)
            for piece, axis, sign in zip(pair, axes, (1.0, -1.0), strict=True)
        ),
        strict=True,
    )
    (p, u), (q, v) = (_lines(pieces, e) for e in edge)
    r = p - q
    uu, vv, uv, ur, vr = (dot(x, y) for x, y in ((u, u), (v, v), (u, v), (u, r), (v, r)))
    apart = uu * vv - uv * uv
    s, t = (uv * vr - vv * ur) / apart, (uu * vr - uv * ur) / apart
    inside = [np.minimum(x, 1 - x) * norm(w) > slack for x, w in ((s, u), (t, v))]
    proper = inside[0] & inside[1] & outermost[0] & outermost[1]
    k = np.flatnonzero(proper)
    on_a, on_b = (p + s[:, None] * u)[k], (q + t[:, None] * v)[k]
    points = (on_a[:, None], on_b[:, None], normal[k, None], np.zeros((len(k), 1)))
    found = Found.of(
        row[k], (EDGE, EDGE), (edge[0][k], edge[1][k]), normal[k], points, np.ones((len(k), 1), dtype=bool)
    )
    return found, row[~proper]


def _lines(pieces: ConvexBodies, edge: Array) -> tuple[Array, Array]:
    start = pieces.points[pieces.edges[edge, 0]]
    return start, pieces.points[pieces.edges[edge, 1]] - start


def _outermost(
    pieces: ConvexBodies, piece: Array, axis: Array, normal: Array, slack: Array
) -> tuple[Array, Array]:
    """Return the edge (m,) of each piece with the direction of an edge that lies furthest out along a normal.

    And whether no corner of the piece lies further out.
    """
    edge, _ = pieces.edges_of.padded(piece)
    height = dot(pieces.points[pieces.edges[edge]], normal[:, None, None])
    top, height = height.max((1, 2)), height.min(2)
    turned = 1.0 - np.abs(dot(pieces.along[edge], pieces.along[axis][:, None]))
    deep = (top[:, None] - height) / slack[:, None]
    deep = np.where(turned <= LIKE, deep, np.inf)
    rows, best = np.arange(len(piece)), deep.argmin(1)
    return edge[rows, best], deep[rows, best] <= 1.0


def without_face(
    pieces: ConvexBodies, row: Array, pair: tuple[Array, Array], reach: Array, slack: Array
) -> list[Found]:
    """Return the contacts of pairs that touch with edges and corners only, as segments or points.

    Parameters
    ----------
    pieces : ConvexBodies
    row : (m,) integer array
        Numbers of the pairs.
    pair : two (m,) integer arrays
        The pieces.
    reach : (m,) array
        Pairs further apart are left out [m].
    slack : (m,) array
        Lengths that count as none [m].
    """
    a, b = (Sides.of(pieces, piece) for piece in pair)
    direction, separation = every_axis(a, b)
    touch = separation.max(1) <= slack
    middle = _middle(direction, separation, slack)
    found = []
    on_a = _support(a, middle, slack)
    on_b = _support(b, -middle, slack)
    plain = touch & (on_a[1] <= 2) & (on_b[1] <= 2)
    if plain.any():
        ends = [ends[plain] for ends in (on_a[0], on_b[0])]
        found.append(_of_ends(pieces, row[plain], ends, pair, plain, middle[plain], slack[plain]))
    rest = ~plain
    if rest.any():
        ends = _nearest_edges(pieces, pair[0][rest], pair[1][rest], slack[rest])
        found.append(_of_ends(pieces, row[rest], ends, pair, rest, middle[rest], slack[rest], reach[rest]))
    return found


def _middle(direction: Array, separation: Array, slack: Array) -> Array:
    """Return the unit sums (m, d) of the different directions along which pairs touch."""
    touching = separation >= separation.max(1)[:, None] - slack[:, None]
    most = int(touching.sum(1).max())
    order = np.argsort(~touching, axis=1, kind="stable")[:, :most]
    rows = np.arange(len(separation))[:, None]
    chosen, direction = touching[rows, order], direction[rows, order]
    same = np.matmul(direction, direction.swapaxes(1, 2)) >= 1 - SAME
    weight = chosen / np.maximum((same & chosen[:, None]).sum(2), 1)
    total = (weight[:, :, None] * direction).sum(1)
    length = norm(total)
    best = direction[:, 0]
    clear = length > 1e-6
    return np.asarray(np.where(clear[:, None], total / np.where(clear, length, 1.0)[:, None], best))


def _support(side: Sides, normal: Array, slack: Array) -> tuple[Array, Array]:
    """Return the first and the last corner (m, 2) that lie furthest out along normals, and how many do (m,)."""
    height = np.where(side.real, dot(side.points, normal[:, None]), -np.inf)
    on = height >= height.max(1)[:, None] - 2 * slack[:, None]
    rows = np.arange(len(on))
    first, last = on.argmax(1), on.shape[1] - 1 - on[:, ::-1].argmax(1)
    return np.stack([side.corner[rows, first], side.corner[rows, last]], 1), on.sum(1)


def _nearest_edges(pieces: ConvexBodies, first: Array, second: Array, slack: Array) -> list[Array]:
    """Return the ends (m, 2) of two edges of pieces that come nearest to each other, parallel ones first."""
    edge_a, edge_b = pieces.edges_of.padded(first)[0], pieces.edges_of.padded(second)[0]
    ends: list[list[Array]] = [[], []]
    step = max(1, 400_000 // max(1, edge_a.shape[1] * edge_b.shape[1]))
    for k in range(0, len(first), step):
        own = slice(k, k + step)
        (p, u), (q, v) = (_lines(pieces, edge[own]) for edge in (edge_a, edge_b))
        p, u, q, v = p[:, :, None], u[:, :, None], q[:, None], v[:, None]
        s, t = nearest(p, u, q, v)
        away = norm(q + t[..., None] * v - p - s[..., None] * u)
        along = dot(u, v) ** 2 >= (1 - SAME) * dot(u, u) * dot(v, v)
        away = (away - np.where(along, slack[own, None, None], 0.0)).reshape(len(p), -1)
        i, j = np.divmod(away.argmin(1), edge_b.shape[1])
        rows = np.arange(len(p))
        ends[0].append(pieces.edges[edge_a[own][rows, i]])
        ends[1].append(pieces.edges[edge_b[own][rows, j]])
    return [np.concatenate(part) for part in ends]


def _of_ends(
    pieces: ConvexBodies, row: Array, ends: list[Array], pair: tuple[Array, Array], which: Array, middle: Array,
    slack: Array, reach: Array | None = None,
) -> Found:  # fmt: skip
    """Return the contacts of two segments given by their end corners (m, 2), which may be one."""
    p, q = (pieces.points[e[:, 0]] for e in ends)
    u, v = (pieces.points[e[:, 1]] - pieces.points[e[:, 0]] for e in ends)
    s, t = nearest(p, u, q, v)
    lu, lv = norm(u), norm(v)
    on_a, on_b = p + s[:, None] * u, q + t[:, None] * v
    way = on_b - on_a
    far = norm(way)
    apart = far > slack
    normal = np.where(apart[:, None] & (reach is not None), way / np.where(apart, far, 1.0)[:, None], middle)
    both, low, high = _shared(p, u, q, v, slack)
    unit = u / np.where(lu > 0, lu, 1.0)[:, None]
    start = p + low[:, None] * unit
    stop = p + high[:, None] * unit
    across = (way - dot(way, unit)[:, None] * unit)[:, None]
    pad = both[:, None, None]
    at_a = np.where(pad, np.stack([start, stop], 1), on_a[:, None])
    at_b = np.where(pad, at_a + across, on_b[:, None])
    share = np.where(both, 0.5 * (high - low), 0.0)
    real = np.stack([np.ones(len(row), dtype=bool), both], 1)
    dims, feature = zip(
        *(
            _named(pieces, ends[k], piece[which], along, length, both, slack)
            for k, (piece, along, length) in enumerate(zip(pair, (s, t), (lu, lv), strict=True))
        ),
        strict=True,
    )
    points = (at_a, at_b, np.repeat(normal[:, None], 2, axis=1), np.repeat(share[:, None], 2, axis=1))
    if reach is not None:
        k = np.flatnonzero(far <= reach)
        row, normal, real = row[k], normal[k], real[k]
        dims, feature = tuple(x[k] for x in dims), tuple(x[k] for x in feature)
        points = (points[0][k], points[1][k], points[2][k], points[3][k])
    return Found.of(row, (dims[0], dims[1]), (feature[0], feature[1]), normal, points, real)


def _shared(p: Array, u: Array, q: Array, v: Array, slack: Array) -> tuple[Array, Array, Array]:
    """Return which segments run along each other, and from where to where on the first [m]."""
    lu, lv = norm(u), norm(v)
    safe = np.where(lu > 0, lu, 1.0)
    unit = u / safe[:, None]
    turn = cross(u, v)
    turn = np.abs(turn) if turn.ndim == 1 else norm(turn)
    along = (turn <= ALONG * lu * lv) & (lu > slack) & (lv > slack)
    ends = np.sort(np.stack([dot(unit, q - p), dot(unit, q + v - p)], 1), axis=1)
    low, high = np.maximum(ends[:, 0], 0.0), np.minimum(ends[:, 1], lu)
    return along & (high - low > slack), low, high


def _named(
    pieces: ConvexBodies, ends: Array, piece: Array, along: Array, length: Array, both: Array, slack: Array
) -> tuple[Array, Array]:
    """Return the dimension and the number of the feature that touches: an edge, or the corner at one of its ends."""
    at_end = np.minimum(along, 1 - along) * length <= slack
    corner = ~both & at_end
    tip = np.where(along * length <= slack, ends[:, 0], ends[:, 1])
    edge, _ = pieces.edges_of.padded(piece)
    same = (np.sort(pieces.edges[edge], axis=2) == np.sort(ends, axis=1)[:, None]).all(2)
    number = edge[np.arange(len(piece)), same.argmax(1)]
    return np.where(corner, CORNER, EDGE), np.where(corner, tip, number)
