"""From files of solids to a :class:`concio.Model`: surfaces welded, parted and turned outwards, then judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import chain
from pathlib import Path
from typing import Any, Literal, Unpack

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.arguments import closest, strict_with
from concio.errors import GeometryError, InputError
from concio.model.generate.generator_arguments import not_negative
from concio.model.generate.solid_masonry import CommonSpace, SolidPiece, assemble_space, box_piece, checked_space
from concio.model.limits import LARGEST_COORDINATE
from concio.model.materials import Elastic, Rigid
from concio.model.model import CONTROL, Model
from concio.model.polyhedron_check import MOST_VERTICES, SolidFault, polyhedron_faults
from concio.model.solids.compas import read_compas
from concio.model.solids.dxf3d import read_dxf_solids
from concio.model.solids.flatten import snapped
from concio.model.solids.flatten import split_warped as triangulated
from concio.model.solids.ifc import read_ifc
from concio.model.solids.obj import read_obj
from concio.model.solids.off import read_off
from concio.model.solids.ply import read_ply
from concio.model.solids.rhino import read_rhino
from concio.model.solids.shapes import FIXED, Scene, Shape
from concio.model.solids.stl import read_stl
from concio.model.surfaces import merged_faces, welded
from concio.model.topology import Loop, topology
from concio.units import quantity

Array = np.ndarray

READERS: Mapping[str, Callable[[Path], Scene]] = {
    ".obj": read_obj, ".stl": read_stl, ".ply": read_ply, ".off": read_off, ".json": read_compas,
    ".dxf": read_dxf_solids, ".3dm": read_rhino, ".ifc": read_ifc,
}  # fmt: skip
"""Formats by the end of a name."""
IN_FOLDERS = (".stl", ".obj", ".ply", ".off")
"""A folder is read as one block, or more, for each of its files of these formats."""
Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns y into z."""
LARGE, SMALL = 50.0, 1e-3
"""Blocks larger or smaller than this are in another unit than the one assumed [m]."""
SHOWN = 5
"""So many faults are written out."""


@strict_with(CommonSpace.__annotations__)
def model_from_solids(
    path: str | Path,
    *,
    materials: Mapping[str, Elastic | Rigid] | None = None,
    layers: Mapping[str, str] | None = None,
    unit: str | None = None,
    up: Literal["y", "z"] = "z",
    mend: float | str = 0.0,
    on_fault: Literal["raise", "skip"] = "raise",
    ground: bool = False,
    gap_tolerance: float | str | None = None,
    split_warped: bool = False,
    **common: Unpack[CommonSpace],
) -> Model:
    """Return the model of the blocks in a file of solids.

    Parameters
    ----------
    path : str or Path
        ``.obj``, ``.stl``, ``.ply``, ``.off``, ``.ifc``, ``.3dm``, ``.dxf``, COMPAS ``.json``, or a folder of files of
        the first four.
    materials : mapping of name to material, optional
        A block takes the one that ``layers`` gives, else the one of its layer's own name, else ``block``.
    layers : mapping of str to str, optional
        What layers, or blocks by name or pattern (``"pier-*"``), are: "fixed", "ignore", or a material. Layers called
        "fixed", "ground", "support", "abutment" or "obstacle" are fixed without being named.
    unit : str, optional
        Unit of length; None takes that of the file, metres where it has none.
    up : {"z", "y"}
        Axis of the file that points upwards. "y", as many programs write OBJ, turns all a quarter round x.
    mend : float or str
        Vertices closer than this are put together, and faces that look inwards are turned outwards [m]. 0 mends
        nothing.
    on_fault : {"raise", "skip"}
        Skip leaves out the blocks that cannot be used.
    ground : bool
        Put a fixed slab below the lowest point.
    gap_tolerance : float or str, optional
        Accuracy of the coordinates: faces nearer than this touch, and vertices are moved by up to this to make faces
        plane, of which near-coplanar ones are put together [m]. ``model.generator["moved"]`` tells of each block how
        far. By default faces touch as the model has it, and nothing is moved.
    split_warped : bool
        Split faces that are not plane, and cannot be made so, into triangles; a face that two blocks share is split
        alike in both.
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Raises
    ------
    InputError
        The file or an option is not usable, or the unit of length cannot be right.
    GeometryError
        Blocks have faults; the message tells block, face, place and deviation of each.

    Notes
    -----
    A surface that falls into several closed parts gives a block for each. Triangles in one plane become one face.
    ``model.generator`` keeps the ``faults`` that were skipped, what was ``left_out`` and ``moved``.

    Examples
    --------
    Two drums are written and read again:

    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> pillar = concio.drums(diameter=1.0, height=2.0, drums=2, sides=8)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     concio.write_solids(Path(folder) / "pillar.obj", pillar)
    ...     model = concio.model_from_solids(Path(folder) / "pillar.obj", layers={"ground": "fixed"})
    >>> [(body.name, round(body.volume, 6)) for body in model.free_bodies]
    [('d01', 0.707107), ('d02', 0.707107)]
    """
    path = Path(path)
    where = str(path)
    options = checked_space(where, common)
    within = not_negative(where, "mend", mend)
    accuracy = None if gap_tolerance is None else quantity(gap_tolerance, "length", where="gap_tolerance")
    if accuracy is not None and not 0 < accuracy < np.inf:
        msg = f"gap_tolerance = {accuracy:g} must be positive"
        raise InputError(msg, where=where, hint="give the accuracy of the coordinates, in m")
    if on_fault not in ("raise", "skip"):
        msg = f"on_fault = {on_fault!r} is not 'raise' or 'skip'"
        raise InputError(msg, where=where)
    if up not in ("y", "z"):
        msg = f"up = {up!r} is not 'y' or 'z'"
        raise InputError(msg, where=where)
    scene = read_scene(path)
    if up == "y":
        scene = replace(scene, shapes=tuple(replace(s, points=s.points @ Y_UP.T) for s in scene.shapes))
    metres = scene.metres or 1.0 if unit is None else quantity(f"1 {unit}", "length", where=f"{where}, unit")
    meanings, table = dict(layers or {}), {"block": options.base.block, **(materials or {})}
    if not scene.shapes and not scene.left_out:
        msg = "the file holds no blocks"
        raise InputError(msg, where=where, hint="export solids or meshes: lines and points are not blocks")
    for word, meaning in meanings.items():
        if not any(s.answers(word) for s in scene.shapes):
            msg = f"there is no layer or block '{word}'"
            known = dict.fromkeys(w for s in scene.shapes for w in s.words)
            raise InputError(msg, where=where, hint=closest(word, known))
        if meaning not in ("fixed", "ignore") and meaning not in table:
            msg = f"layer '{word}' is to be '{meaning}', which is not a material"
            raise InputError(msg, where=where, hint=closest(meaning, ("fixed", "ignore", *table)))
    pieces, obstacles, faults, notes, ignored = [], [], [], [], list(scene.left_out)
    names: dict[str, int] = {}
    parts = [part for shape in scene.shapes for part in _parted(shape, metres, within)]
    _check_unit([p for _, p, _ in parts], scene, unit, metres, where)
    for shape, points, faces in parts:
        name = _unique(CONTROL.sub("_", shape.name or shape.layer or "b"), names)
        meaning = _meaning(shape, meanings, table)
        if meaning == "ignore":
            ignored.append(f"'{name}' was left out")
            continue
        label = f"block '{name}'" + (f" ({shape.source})" if shape.source else "")
        if shape.unreadable:
            faults.append((f"{label}: {shape.unreadable[0]}", shape.unreadable[1]))
            continue
        points, faces, turned = _outward(points, faces) if within else (points, faces, False)
        notes += [f"'{name}': its faces were turned outwards"] * turned
        sound = len(points) <= MOST_VERTICES and _usable(points) and len(faces) > 3
        surface = merged_faces(points, faces) if sound else (points, faces, ())
        if sound and accuracy:
            surface, far = snapped((points, faces, ()), accuracy)
            if far > 0:
                notes.append(f"'{name}': its corners were moved by up to {1e3 * far:.3g} mm to make its faces plane")
        found = polyhedron_faults(*surface)
        if split_warped and found and all(fault.kind == "out of plane" for fault in found):
            surface, count = triangulated(surface)
            notes.append(f"'{name}': {count} faces that are not plane were split into triangles")
            found = polyhedron_faults(*surface)
        faults += [(f"{label}: {fault.sentence}", _hint(fault)) for fault in found]
        if found:
            continue
        piece = SolidPiece(name, surface, layer=shape.layer, material=meaning)
        if meaning == "fixed":
            obstacles.append(replace(piece, role="ground", material="block"))
        else:
            pieces.append(piece)
    if faults and on_fault == "raise":
        more = f"; {len(faults) - SHOWN} more" if len(faults) > SHOWN else ""
        raise GeometryError("; ".join(text for text, _ in faults[:SHOWN]) + more, where=where, hint=faults[0][1])
    if not pieces:
        msg = "the file holds no blocks" + (": all of them are fixed" if obstacles else "")
        hint = "look at 'layers', and at layers and names such as 'ground'" if obstacles else ""
        raise InputError(msg, where=where, hint=hint or "surfaces must be closed, one for each block")
    if ground:
        obstacles.append(_slab(pieces, names))
    record = {
        "kind": "solids", "metres": metres, "faults": tuple(text for text, _ in faults), "left_out": tuple(ignored),
        "moved": tuple(notes),
    }  # fmt: skip
    others = {name: material for name, material in table.items() if name != "block"}
    model = assemble_space(options, pieces, obstacles, materials=others, title=path.stem, generator=record)
    return model if accuracy is None else replace(model, gap_tolerance=accuracy)


def _hint(fault: SolidFault) -> str:
    """Return what to do about a fault of an imported block."""
    if fault.kind != "out of plane":
        return fault.hint
    return (
        f"gap_tolerance = {2e3 * fault.deviation:.2g} mm moves its corners into planes, split_warped = true splits "
        "such faces into triangles"
    )


def read_scene(path: Path) -> Scene:
    """Return what a file, or a folder of files, holds.

    Raises
    ------
    InputError
        It cannot be read, or its format is not known.
    """
    if path.is_dir():
        files = sorted(p for p in path.iterdir() if p.suffix.lower() in IN_FOLDERS)
        if not files:
            msg = "the folder holds no file that ends in " + ", ".join(IN_FOLDERS)
            raise InputError(msg, where=str(path), hint="give the folder of the files, one for each block")
        scenes = [(p, READERS[p.suffix.lower()](p)) for p in files]
        return Scene(tuple(
            replace(s, name=p.stem if len(scene.shapes) == 1 else f"{p.stem}-{s.name}") for p, scene in scenes
            for s in scene.shapes
        ))  # fmt: skip
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        msg = f"'{path.suffix}' is not a format of solids that is read"
        packed = path.suffix.lower() in (".ifczip", ".ifcxml", ".ifcjson")
        hint = "save it as .ifc (STEP physical file)" if packed else "one of " + ", ".join(READERS) + ", or a folder"
        raise InputError(msg, where=str(path), hint=hint)
    return reader(path)


def _parted(shape: Shape, metres: float, within: float) -> list[tuple[Shape, Array, tuple[Loop, ...]]]:
    """Return the connected parts of a surface, welded, in metres."""
    points = metres * shape.points
    if not len(points) or not _usable(points):
        return [(shape, points, tuple(map(tuple, shape.faces)))]
    own = tuple(map(tuple, shape.faces))
    if own and len(points) > MOST_VERTICES and np.bincount(_labels(own)).max() > MOST_VERTICES:
        return [(shape, points, own)]  # refused at sight: no block, however it is parted
    parts = _connected(points, own)
    if not within and all(len(faces) > 3 and topology(faces, ()).fault is None for _, faces in parts):
        return [(shape, *part) for part in parts]
    size = float(np.ptp(points, axis=0).max())
    return [(shape, *part) for part in _connected(*welded(points, own, max(within, 1e-9 * size)))]


def _usable(points: Array) -> bool:
    """Return whether coordinates are numbers whose products are numbers."""
    return bool((np.abs(points) < LARGEST_COORDINATE).all())


def _connected(points: Array, faces: tuple[Loop, ...]) -> list[tuple[Array, tuple[Loop, ...]]]:
    """Return the parts of a surface that share no vertex."""
    return [(points[list(used)], own) for used, own in _parts_of(faces)] if faces else [(points, faces)]


def _labels(faces: tuple[Loop, ...]) -> Array:
    """Return the number of the part to which each vertex belongs; one that no face uses is a part of its own."""
    sides = np.fromiter(chain.from_iterable(faces), dtype=int)
    first = np.repeat([f[0] for f in faces], [len(f) for f in faces])
    count = int(sides.max()) + 1
    meets = sp.coo_array((np.ones(len(sides)), (first, sides)), shape=(count, count))
    return np.asarray(connected_components(meets, directed=False)[1])


@lru_cache(maxsize=256)
def _parts_of(faces: tuple[Loop, ...]) -> list[tuple[tuple[int, ...], tuple[Loop, ...]]]:
    """Return the vertices of each part, and its faces numbered by them: once for all blocks of one sort."""
    part = _labels(faces)
    own: dict[int, list[Loop]] = {}
    for face in faces:
        own.setdefault(int(part[face[0]]), []).append(face)
    found = []
    for loops in own.values():
        used = sorted({v for loop in loops for v in loop})
        number = {v: k for k, v in enumerate(used)}
        found.append((tuple(used), tuple(tuple(number[v] for v in loop) for loop in loops)))
    return found


def _outward(points: Array, faces: tuple[Loop, ...]) -> tuple[Array, tuple[Loop, ...], bool]:
    """Return a closed surface with all faces turned outwards, and whether any was turned."""
    beside: dict[tuple[int, int], list[tuple[int, bool]]] = {}
    for k, loop in enumerate(faces):
        for p, q in zip(loop, (*loop[1:], loop[0]), strict=True):
            beside.setdefault((min(p, q), max(p, q)), []).append((k, p < q))
    if any(len(own) != 2 for own in beside.values()):
        return points, faces, False  # not closed: told by the check
    across: list[list[tuple[int, bool]]] = [[] for _ in faces]
    for (a, way_a), (b, way_b) in beside.values():
        across[a].append((b, way_a == way_b))
        across[b].append((a, way_a == way_b))
    flip: dict[int, bool] = {0: False}
    waiting = [0]
    while waiting:
        at = waiting.pop()
        for other, against in across[at]:
            if other not in flip:
                flip[other] = flip[at] ^ against
                waiting.append(other)
    turned = tuple(f[::-1] if flip.get(k, False) else f for k, f in enumerate(faces))
    top = topology(turned, ())
    if top.fault is None and float(((points[top.corners[0]] - points.mean(0)) * top.spanned(points)).sum()) < 0:
        turned = tuple(f[::-1] for f in turned)
    return points, turned, turned != faces


def _check_unit(blocks: Sequence[Array], scene: Scene, unit: str | None, metres: float, where: str) -> None:
    """Refuse blocks that are not blocks in the unit assumed, where nobody stated it."""
    sizes = [float(np.ptp(p, axis=0).max()) for p in blocks if len(p) and _usable(p)]
    if not sizes or unit is not None:
        return
    usual = float(np.median(sizes))
    if SMALL <= usual <= LARGE:
        return
    stated = "the file says so" if scene.metres else "the file does not say its unit, metres were assumed"
    guess = next((name for name, m in (("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("m", 1.0))
                  if 0.05 <= usual / metres * m <= 5), None)  # fmt: skip
    msg = f"half of the blocks are {'longer' if usual > LARGE else 'shorter'} than {usual:,.4g} m ({stated})"
    asked = f"unit = '{guess}'?" if guess else "unit = 'mm', or whatever it is, 'm' if it is right"
    raise InputError(msg, where=where, hint=f"give the unit of length: {asked}")


def _meaning(shape: Shape, meanings: Mapping[str, str], table: Mapping[str, Any]) -> str:
    own = [meaning for word, meaning in meanings.items() if shape.answers(word)]
    if own:
        return own[-1]
    if shape.fixed or any(w.lower().rsplit("::", 1)[-1] in FIXED for w in (shape.layer, shape.name)):
        return "fixed"
    return shape.layer if shape.layer in table else "block"


def _unique(name: str, names: dict[str, int]) -> str:
    names[name] = names.get(name, 0) + 1
    return name if names[name] == 1 else _unique(f"{name}-{names[name]}", names)


def _slab(pieces: Sequence[SolidPiece], names: dict[str, int]) -> SolidPiece:
    every = np.concatenate([p.surface[0] for p in pieces])
    low, high = every.min(0), every.max(0)
    size = float((high - low).max())
    margin = np.array([0.1, 0.1, 0.0]) * size
    return box_piece(
        _unique("ground", names), (low - margin - [0, 0, 0.05 * size]).tolist(),
        [*(high + margin)[:2].tolist(), float(low[2])], role="ground",
    )  # fmt: skip
