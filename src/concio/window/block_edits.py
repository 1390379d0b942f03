"""Blocks of a plane model corrected in its text: added at once, merged, split, corners moved where they are shared."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import shapely
from shapely.ops import split as cut

from concio.errors import InputError
from concio.window.own_units import points_in_file, units_of_text
from concio.window.toml_edits import Patch, add_table, difference, literal, remove, set_value

NEAR = 1e-7
"""Corners as near as this are one [m]."""
TRACED = "traced"
"""Layer of blocks that were traced in a picture."""
MOST = 5000


def many_blocks(text: str, command: Mapping[str, Any]) -> tuple[Patch, str]:
    """Return the patch that puts traced stones in the place of those traced before, on fixed ground.

    Raises
    ------
    InputError
        There are none, or an outline is not a list of points.
    """
    stones = [_ring(points_in_file(s, text)) for s in command.get("stones", [])]
    if not 0 < len(stones) <= MOST:
        msg = f"{len(stones)} stones"
        raise InputError(msg, hint="trace the picture first")
    data, new = tomllib.loads(text), text
    blocks = data.get("blocks", [])
    for k in reversed(range(len(blocks))):
        if blocks[k].get("layer") == TRACED:
            new = remove(new, ("blocks", k)).applied(new)
    width = len(str(len(stones)))
    tables = [{"name": f"s{k:0{width}d}", "layer": TRACED, "outline": ring} for k, ring in enumerate(stones, 1)]
    if not any(b.get("kind") == "fixed" and b.get("layer") != TRACED for b in blocks):
        xs, ys = ([p[c] for ring in stones for p in ring] for c in (0, 1))
        low = [min(xs), min(ys) - 0.1 * max(max(xs) - min(xs), max(ys) - min(ys))]
        tables.append({"name": "ground", "kind": "fixed", "layer": TRACED, "rectangle": [low, [max(xs), min(ys)]]})
    lines = "".join("\n[[blocks]]\n" + "".join(f"{k} = {literal(v)}\n" for k, v in one.items()) for one in tables)
    new = new.rstrip("\n") + "\n" + lines
    kept = [b for b in blocks if b.get("layer") != TRACED]
    if tomllib.loads(new) != {**data, "blocks": [*kept, *tables]}:
        msg = "the blocks cannot be added to this text"
        raise InputError(msg, hint="remove the key 'blocks' from the text, or write the blocks there")
    return difference(text, new), f"{len(stones)} stones"


def merged(text: str, command: Mapping[str, Any]) -> tuple[Patch, str]:
    """Return the patch that makes neighbours one block, which has the name of the first."""
    names = [str(n) for n in command.get("names", [])]
    numbers, blocks = _numbers(text, names), tomllib.loads(text)["blocks"]
    if len(names) < 2:
        msg = "one block alone cannot be merged"
        raise InputError(msg, hint="select two blocks or more")
    near = NEAR / units_of_text(text).length
    whole = shapely.union_all([shapely.Polygon(_outline(blocks[k])) for k in numbers], grid_size=near)
    if not isinstance(whole, shapely.Polygon) or whole.interiors:
        msg = "these blocks do not touch along a side, or have a hole between them"
        raise InputError(msg, where=", ".join(names), hint="merge neighbours")
    ring = _counter_clockwise(shapely.remove_repeated_points(whole, near))
    new = _with_outline(text, numbers[0], blocks[numbers[0]], ring)
    for k in sorted(numbers[1:], reverse=True):
        new = remove(new, ("blocks", k)).applied(new)
    return difference(text, new), f"merge {len(names)} blocks"


def split(text: str, command: Mapping[str, Any]) -> tuple[Patch, str]:
    """Return the patch that cuts a block along a line of points; neighbours get the new corners."""
    name = str(command.get("name"))
    (number,), blocks = _numbers(text, [name]), tomllib.loads(text)["blocks"]
    line = shapely.LineString(_points(points_in_file(command.get("line"), text), 2))
    parts = [p for p in cut(shapely.Polygon(_outline(blocks[number])), line).geoms if p.area > NEAR]
    if len(parts) != 2:
        msg = f"the line does not cut block '{name}' in two"
        raise InputError(msg, hint="draw it from outside to outside of the block")
    rings = sorted((_counter_clockwise(p) for p in parts), key=lambda r: -abs(shapely.Polygon(r).area))
    known = {b.get("name") for b in blocks}
    fresh = next(f"{name}{c}" for c in ("b", *map(str, range(2, MOST))) if f"{name}{c}" not in known)
    new = _with_outline(text, number, blocks[number], rings[0])
    entry = {**{k: v for k, v in blocks[number].items() if k != "rectangle"}, "name": fresh, "outline": rings[1]}
    return difference(text, add_table(new, "blocks", entry).applied(new)), f"split {name}"


def corner(text: str, command: Mapping[str, Any]) -> tuple[Patch, str]:
    """Return the patch that moves a corner in every outline that has it."""
    (start,), (end,) = (_points(points_in_file([command.get(key)], text), 1) for key in ("from", "to"))
    new, moved, near = text, 0, NEAR / units_of_text(text).length
    for k, block in enumerate(tomllib.loads(text).get("blocks", [])):
        try:
            ring = _outline(block)
        except InputError:
            continue
        if any(_near(p, start, near) for p in ring):
            ring = [list(end) if _near(p, start, near) else p for p in ring]
            if not shapely.Polygon(ring).is_valid:
                msg = f"block '{block.get('name')}' would cross itself"
                raise InputError(msg, hint="move the corner less far")
            new, moved = _with_outline(new, k, block, ring), moved + 1
    if not moved:
        msg = "no block of the text has a corner there"
        raise InputError(msg, hint="corners of blocks that a generator or a drawing makes are moved there")
    return difference(text, new), "move a corner"


def _near(p: Sequence[float], q: Sequence[float], near: float) -> bool:
    return max(abs(p[0] - q[0]), abs(p[1] - q[1])) <= near


def _numbers(text: str, names: Sequence[str]) -> list[int]:
    own = {b.get("name"): k for k, b in enumerate(tomllib.loads(text).get("blocks", []))}
    for name in names:
        if name not in own:
            msg = f"block '{name}' does not stand in the text under [[blocks]]"
            raise InputError(msg, hint="blocks of a generator or a drawing are changed there")
    return [own[name] for name in names]


def _outline(block: Mapping[str, Any]) -> list[list[float]]:
    """Return the outline of a block in numbers."""
    if "rectangle" in block:
        (x0, y0), (x1, y1) = _points(block["rectangle"], 2)
        return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    return _ring(block.get("outline"))


def _ring(value: Any) -> list[list[float]]:
    ring = [list(p) for p in _points(value, 3)]
    if not shapely.Polygon(ring).is_valid:
        msg = "an outline crosses itself"
        raise InputError(msg, hint="correct it in the text")
    return ring


def _points(value: Any, least: int) -> list[tuple[float, float]]:
    plain = isinstance(value, list) and len(value) >= least
    if not plain or not all(isinstance(p, list) and len(p) == 2 and all(_number(v) for v in p) for p in value):
        msg = "points are not pairs of numbers"
        raise InputError(msg, hint="change blocks with units or in space in the text")
    return [(float(x), float(y)) for x, y in value]


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e9


def _counter_clockwise(polygon: shapely.Polygon) -> list[list[float]]:
    ring = shapely.geometry.polygon.orient(polygon).exterior.coords[:-1]
    return [[round(x, 9), round(y, 9)] for x, y in ring]


def _with_outline(text: str, number: int, block: Mapping[str, Any], ring: list[list[float]]) -> str:
    if "rectangle" in block:
        text = remove(text, ("blocks", number, "rectangle")).applied(text)
    return set_value(text, ("blocks", number, "outline"), ring).applied(text)


BLOCK_COMMANDS: dict[str, Callable[[str, Mapping[str, Any]], tuple[Patch, str]]] = {
    "stones": many_blocks, "merge": merged, "split": split, "corner": corner,
}  # fmt: skip
"""Commands of the page on blocks of the text."""
