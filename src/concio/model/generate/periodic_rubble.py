"""Rubble that repeats itself: the cells of a Voronoi diagram on a torus.

As in :mod:`concio.model.generate.rubble`, points are scattered, evened out and their cells rid of short edges; here all
of it wraps round both periods. A vertex of the diagram is known by its place in one period and stands, in the outline
of a stone, at a whole number of periods from it; contracting an edge moves one vertex onto another with all the
outlines that hold it, on whichever side of the cell they are.
"""

from __future__ import annotations

import numpy as np
import shapely

from concio.errors import InputError
from concio.model.generate.generator_arguments import count, positive
from concio.model.limits import LARGEST_SEED, LARGEST_SWEEPS
from concio.model.linked import linked, pairs_within
from concio.model.model import Array, Periods

LARGEST_STONES = 20_000

Ring = list[tuple[int, int, int]]
"""Outline of a stone: number of a vertex, and by how many periods it stands away along x and y."""


def rubble_cell(
    *,
    length: float | str,
    height: float | str,
    stone: float | str,
    seed: int,
    aspect: float,
    evenness: int,
    shortest_edge: float,
    repeat: tuple[int, int],
) -> tuple[list[Array], Periods, str, dict[str, object]]:
    """Return outlines, periods, a title and the record of a rubble cell; arguments as in :func:`concio.cell`.

    Raises
    ------
    InputError
        An argument is out of range.
    """
    where = "cell"
    l, h, size = positive(where, "length", length), positive(where, "height", height), positive(where, "stone", stone)
    stretch = positive(where, "aspect", aspect, "number")
    sweeps = count(where, "evenness", evenness, 0, LARGEST_SWEEPS)
    if not 0 <= shortest_edge <= 0.5:
        msg = f"shortest_edge = {shortest_edge:g} must lie between 0 and 0.5"
        raise InputError(msg, where=where, hint="it is a share of the stone size")
    number = round(l * h / size**2)
    if not 1 <= number <= LARGEST_STONES:
        msg = f"a cell of {l:g} x {h:g} m holds {number:,} stones of {size:g} m"
        raise InputError(msg, where=where, hint=f"between 1 and {LARGEST_STONES:,}; stone, length and height are in m")
    rng = np.random.default_rng(count(where, "seed", seed, 0, LARGEST_SEED))
    box = np.array([l / stretch, h])  # in the plane where stones are as high as long
    points = rng.uniform(size=(number, 2)) * box
    for _ in range(sweeps):
        vertices, rings = _diagram(points, box)
        centres = [shapely.Polygon(_outline(vertices, ring, box)).centroid for ring in rings]
        points = np.array([(c.x, c.y) for c in centres]) % box
    vertices, rings = _diagram(points, box)
    period = np.array([l, h])
    vertices = vertices * [stretch, 1.0]
    outlines = _contracted(vertices, rings, shortest_edge * size, period)
    outlines.sort(key=lambda o: tuple(np.round(o.mean(0)[::-1] / size, 3)))
    nx, ny = repeat
    outlines = [o + np.array([i, j]) * period for j in range(ny) for i in range(nx) for o in outlines]
    title = f"cell of rubble, {l:g} x {h:g} m, {number} stones, seed {seed}"
    record: dict[str, object] = {
        "kind": "cell", "bond": "rubble", "length": l, "height": h, "stone": size, "seed": int(seed),
        "aspect": stretch, "evenness": sweeps, "shortest_edge": float(shortest_edge), "repeat": [nx, ny],
    }  # fmt: skip
    return outlines, ((nx * l, 0.0), (0.0, ny * h)), title, record


def _diagram(points: Array, box: Array) -> tuple[Array, list[Ring]]:
    """Return vertices (v, 2) within one period and the rings, counter-clockwise, of a periodic Voronoi diagram."""
    shifts = np.array([(i, j) for j in range(-2, 3) for i in range(-2, 3)])
    shifts = shifts[np.argsort(np.abs(shifts).sum(1), kind="stable")]  # the cell itself comes first
    from scipy.spatial import Voronoi  # loaded where it is needed: it takes long

    diagram = Voronoi((points[None] + shifts[:, None] * box).reshape(-1, 2))
    number = len(points)
    regions = [diagram.regions[diagram.point_region[k]] for k in range(number)]
    used: Array = np.unique(np.concatenate(regions))
    places = diagram.vertices[used]
    away = np.floor(places / box + 1e-9).astype(int)
    home = places - away * box
    # the same vertex, seen from several cells, differs by rounding
    inside = np.where(home % box >= box, 0.0, home % box)
    group = linked(pairs_within(inside, 1e-7 * float(box.max()), box), len(home))
    alias = np.unique(group, return_index=True)[1][group]
    offset = np.round((home - home[alias]) / box).astype(int)
    rings = []
    index = {int(v): k for k, v in enumerate(used)}
    for region, point in zip(regions, points, strict=True):
        around = diagram.vertices[region] - point
        order = np.argsort(np.arctan2(around[:, 1], around[:, 0]))
        local = [index[region[k]] for k in order]
        beyond = away + offset
        rings.append([(int(alias[k]), int(beyond[k, 0]), int(beyond[k, 1])) for k in local])
    return home, [_without_repetition(ring) for ring in rings]


def _without_repetition(ring: Ring) -> Ring:
    return [v for k, v in enumerate(ring) if v != ring[k - 1]]


def _outline(vertices: Array, ring: Ring, period: Array) -> Array:
    """Return the outline (n, 2) of a ring."""
    return np.array([vertices[v] + np.array([i, j]) * period for v, i, j in ring])


def _contracted(vertices: Array, rings: list[Ring], shortest: float, period: Array) -> list[Array]:
    """Return the outlines of the rings with edges shorter than ``shortest`` contracted, the shortest first.

    An edge is left as it is where a stone would lose its area or turn over.
    """
    xy = vertices.copy()
    rings = list(rings)
    holders: dict[int, set[int]] = {}
    for c, ring in enumerate(rings):
        for v, _, _ in ring:
            holders.setdefault(v, set()).add(c)
    edges = {}
    for ring in rings:
        for (v, i, j), (w, k, l) in zip(ring, ring[1:] + ring[:1], strict=True):
            key = (v, w, k - i, l - j) if v < w else (w, v, i - k, j - l)
            edges[key] = float(np.hypot(*(xy[key[1]] + np.array(key[2:]) * period - xy[key[0]])))
    moved: dict[int, tuple[int, int, int]] = {}  # a vertex that is gone: where it went, by how many periods

    def now(v: int) -> tuple[int, int, int]:
        i = j = 0
        while v in moved:
            v, di, dj = moved[v]
            i, j = i + di, j + dj
        return v, i, j

    for (v, w, i, j), _ in sorted((e for e in edges.items() if e[1] < shortest), key=lambda e: (e[1], e[0])):
        (p, pi, pj), (q, qi, qj) = now(v), now(w)
        di, dj = i + qi - pi, j + qj - pj  # q as seen from p
        apart = xy[q] + np.array([di, dj]) * period - xy[p]
        if p == q or float(np.hypot(*apart)) >= shortest:
            continue
        around = holders[p] | holders[q]
        before = {c: rings[c] for c in around}
        place = xy[p].copy()
        xy[p] = place + 0.5 * apart
        for c in around:  # q + (a, b) is p + (a - di, b - dj)
            ring = [(p, a - di, b - dj) if u == q else (u, a, b) for u, a, b in rings[c]]
            rings[c] = _without_repetition(ring)
        if all(_proper(_outline(xy, rings[c], period)) for c in around):
            holders[p] = around
            moved[q] = (p, -di, -dj)
        else:
            xy[p] = place
            rings = [before.get(c, ring) for c, ring in enumerate(rings)]
    return [_outline(xy, ring, period) for ring in rings]


def _proper(outline: Array) -> bool:
    """Tell whether an outline is a simple polygon that runs counter-clockwise."""
    if len(outline) < 3:
        return False
    shape = shapely.LinearRing(outline)
    return bool(shape.is_simple and shape.is_ccw)
