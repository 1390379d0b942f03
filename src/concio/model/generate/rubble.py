"""Rubble masonry: stones as the cells of a Voronoi diagram, repeatable by a seed.

Points are scattered in the rectangle and moved to the centroids of their cells a few times (Lloyd 1982), which evens
out the stones. Mirror images of the points in the four sides make the sides of the rectangle edges of the diagram.
Edges shorter than a share of the stone size are then contracted in the whole diagram at once, so that neighbours keep
sharing whole edges: no slivers, no gaps, no overlaps.
"""

from __future__ import annotations

from typing import Unpack

import numpy as np
import shapely

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.generator_arguments import Common, checked, count, finite, positive
from concio.model.generate.masonry import Piece, assemble, numbered, rectangle
from concio.model.limits import LARGEST_SEED, LARGEST_SWEEPS
from concio.model.model import Array, Load, Model

LARGEST_STONES = 200_000


@strict_with(Common.__annotations__)
def rubble(
    *,
    length: float | str,
    height: float | str,
    stone: float | str,
    seed: int = 0,
    aspect: float = 1.5,
    evenness: int = 3,
    shortest_edge: float = 0.2,
    ground: bool = True,
    side_walls: bool = False,
    top_pressure: float | str = 0.0,
    **common: Unpack[Common],
) -> Model:
    """Return a wall of irregular stones without courses.

    Parameters
    ----------
    length, height : float or str
        Of the wall [m].
    stone : float or str
        Mean size of a stone: the root of its area [m].
    seed : int
        Same seed, same wall.
    aspect : float
        Length over height of a mean stone.
    evenness : int
        How often the points move to the centroids of their cells; 0 leaves stones as scattered.
    shortest_edge : float
        Edges shorter than this share of ``stone`` are contracted.
    ground, side_walls, top_pressure, **common
        As in :func:`concio.model.generate.walls.wall`.

    Raises
    ------
    InputError
        An argument is out of range.

    Examples
    --------
    The stones fill the wall:

    >>> import concio
    >>> model = concio.rubble(length=2.0, height=1.5, stone=0.4, seed=1)
    >>> round(sum(stone.area for stone in model.free_bodies), 6)
    3.0
    """
    where = "rubble"
    options = checked(where, common)
    l, h, size = positive(where, "length", length), positive(where, "height", height), positive(where, "stone", stone)
    stretch = positive(where, "aspect", aspect, "number")
    sweeps = count(where, "evenness", evenness, 0, LARGEST_SWEEPS)
    if not 0 <= shortest_edge <= 0.5:
        msg = f"shortest_edge = {shortest_edge:g} must lie between 0 and 0.5"
        raise InputError(msg, where=where, hint="it is a share of the stone size")
    pressure = finite(where, "top_pressure", top_pressure, "stress")
    wanted = (l / size) * (h / size)
    if not wanted <= LARGEST_STONES:
        msg = f"some {wanted:.3g} stones are more than {LARGEST_STONES:,}"
        raise InputError(msg, where=where, hint="stone, length and height are in m")
    number = max(1, round(wanted))
    if not (ground or side_walls):
        msg = "no ground and no side walls: nothing holds the wall"
        raise InputError(msg, where=where, hint="set ground = true")
    rng = np.random.default_rng(count(where, "seed", seed, 0, LARGEST_SEED))
    box = np.array([l / stretch, h])  # in the plane where stones are as high as long
    points = rng.uniform(size=(number, 2)) * box
    for _ in range(sweeps):
        vertices, cells = _diagram(points, box)
        points = np.array([shapely.Polygon(vertices[c]).centroid.coords[0] for c in cells])
    vertices, cells = _diagram(points, box)
    vertices = vertices * [stretch, 1.0]
    outlines = contracted(vertices, cells, shortest_edge * size, np.array([l, h]))
    order = sorted(range(len(outlines)), key=lambda k: tuple(np.round(outlines[k].mean(0)[::-1] / size, 3)))
    pieces = [Piece(numbered("s", i + 1, len(order)), outlines[k], layer="stone") for i, k in enumerate(order)]
    deep = 0.1 * max(l, h)
    obstacles = []
    if ground:
        obstacles.append(Piece("ground", rectangle(0.0, l, -deep, 0.0), "ground"))
    if side_walls:
        obstacles.append(Piece("left wall", rectangle(-deep, 0.0, 0.0, h), "side wall"))
        obstacles.append(Piece("right wall", rectangle(l, l + deep, 0.0, h), "side wall"))
    loads = [Load("pressure", (pressure,), edge=((0.0, h), (l, h)), group="top")] if pressure else []
    title = f"rubble wall of {l:g} x {h:g} m, {len(pieces)} stones, seed {seed}"
    record = {"kind": "rubble", "seed": int(seed), "stones": len(pieces), "length": l, "height": h}
    return assemble(options, pieces, obstacles, loads=loads, title=title, generator=record)


def _diagram(points: Array, box: Array) -> tuple[Array, list[list[int]]]:
    """Return vertices (v, 2) and cells, counter-clockwise, of a Voronoi diagram that ends at the box from 0."""
    mirrored = [points]
    for axis in range(2):
        for side in (0.0, box[axis]):
            image = points.copy()
            image[:, axis] = 2 * side - image[:, axis]
            mirrored.append(image)
    from scipy.spatial import Voronoi  # loaded where it is needed: it takes long

    diagram = Voronoi(np.concatenate(mirrored))
    cells = [list(diagram.regions[diagram.point_region[k]]) for k in range(len(points))]
    used = np.unique(np.concatenate(cells))
    renumber = np.full(len(diagram.vertices), -1)
    renumber[used] = np.arange(len(used))
    vertices = diagram.vertices[used]
    for axis in range(2):
        for side in (0.0, box[axis]):
            vertices[np.abs(vertices[:, axis] - side) < 1e-7 * box.max(), axis] = side
    result = []
    for cell, point in zip(cells, points, strict=True):
        ring = renumber[np.array(cell)]
        angle = np.arctan2(*(vertices[ring] - point).T[::-1])
        result.append(ring[np.argsort(angle)].tolist())
    return vertices, result


def contracted(vertices: Array, cells: list[list[int]], shortest: float, box: Array) -> list[Array]:
    """Return the outlines of the cells with edges shorter than ``shortest`` contracted, the shortest first.

    Vertices on the box from (0, 0) to ``box`` stay on its sides, its corners stay where they are; an edge is left as it
    is where a neighbouring cell would lose its area or turn over. On the sides of the box only edges shorter than a
    quarter of ``shortest`` are contracted: a stone that loses its last edge there would stand on a corner.
    """
    xy = vertices.copy()
    # Voronoi vertices that coincide, as at the corners of the box
    alias = np.arange(len(xy))

    def root(v: int) -> int:
        while alias[v] != v:
            alias[v] = alias[alias[v]]
            v = int(alias[v])
        return v

    cells_at: dict[int, set[int]] = {}
    for c, cell in enumerate(cells):
        for v in cell:
            cells_at.setdefault(v, set()).add(c)

    def ring(c: int) -> list[int]:
        roots = [root(v) for v in cells[c]]
        return [v for k, v in enumerate(roots) if v != roots[k - 1]] if len(set(roots)) > 1 else roots[:1]

    def held(v: int) -> tuple[bool, bool]:
        return bool(xy[v, 0] in (0.0, box[0])), bool(xy[v, 1] in (0.0, box[1]))

    edges = {tuple(sorted((cell[k - 1], cell[k]))) for cell in cells for k in range(len(cell))}
    lengths = [(float(np.hypot(*(xy[a] - xy[b]))), a, b) for a, b in edges]
    for _, a, b in sorted(e for e in lengths if e[0] < shortest):
        p, q = root(a), root(b)
        apart = np.hypot(*(xy[p] - xy[q]))
        if p == q or apart >= shortest:
            continue
        new = 0.5 * (xy[p] + xy[q])
        possible = True
        for axis in range(2):
            on_p, on_q = held(p)[axis], held(q)[axis]
            if on_p and on_q:
                possible &= xy[p, axis] == xy[q, axis] and apart < 0.25 * shortest
            if on_p or on_q:
                new[axis] = xy[p, axis] if on_p else xy[q, axis]
        if not possible:
            continue
        around = cells_at[p] | cells_at[q]
        before = xy[p].copy(), xy[q].copy()
        alias[q] = p
        xy[p] = new
        if all(_proper(xy[ring(c)]) for c in around):
            cells_at[p] = around
        else:
            alias[q] = q
            xy[p], xy[q] = before
    return [xy[ring(c)] for c in range(len(cells))]


def _proper(outline: Array) -> bool:
    """Tell whether an outline is a simple polygon that runs counter-clockwise."""
    if len(outline) < 3:
        return False
    shape = shapely.LinearRing(outline)
    return bool(shape.is_simple and shape.is_ccw)
