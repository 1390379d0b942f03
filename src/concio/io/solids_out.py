"""Blocks in space to OBJ, STL, COMPAS JSON, glTF, DXF and 3dm: as they are described, displaced, or as they move."""

from __future__ import annotations

import importlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.arguments import strict
from concio.errors import InputError
from concio.files import whole_file
from concio.io.compas_json import block_model
from concio.io.gltf import Moving, glb_bytes
from concio.kinematics.frames import cross
from concio.model.model import Model
from concio.post.solids import solids

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

FILM = 10.0
"""Duration of the animation of a push [s]."""
SINGLE = 1e-5
"""What single precision may move a corner by, as a share of the size of its block."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A block as it is written: ``faces`` of ``points`` (n, 3) [m], counter-clockwise from outside, and triangles."""

    name: str
    layer: str
    fixed: bool
    points: Array
    faces: Sequence[Sequence[int]]
    cells: Array

    @property
    def triangles(self) -> Array:
        """Corners (t, 3, 3) of the triangles [m]."""
        return np.asarray(self.points[self.cells])


@strict
def write_solids(
    path: str | Path, what: Model | Result | DynamicsResult | PushResult, *, scale: float = 1.0
) -> None:
    """Write the blocks of a model in space, or those of a result displaced, for another program.

    A motion or a push is written as animation, in glTF alone: its shots are the key times, from zero on; the points of
    a push follow each other evenly within :data:`FILM` seconds.

    Parameters
    ----------
    path : str or Path
        Its end gives the format: ``.obj`` (an object for each block), ``.stl`` (a named solid for each), ``.json``
        (a COMPAS BlockModel), ``.glb`` (glTF, a node for each), ``.dxf`` (a MESH for each, ``dxf`` extra) or ``.3dm``
        (a mesh for each, ``rhino`` extra). An existing file is replaced only when the new one is complete.
    what : Model, Result, DynamicsResult or PushResult
    scale : float
        By which displacements of a result, or the velocities of its mechanism, are multiplied; those of a motion are
        true to scale.

    Raises
    ------
    InputError
        The model is in the plane, the format is not known or has no animation, the scale is not finite, or a package is
        missing.

    Examples
    --------
    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> pillar = concio.drums(diameter=1.0, height=2.0, drums=2, sides=8)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     concio.write_solids(Path(folder) / "pillar.obj", pillar)
    ...     lines = (Path(folder) / "pillar.obj").read_text().splitlines()
    >>> [line for line in lines if line.startswith("o ")]
    ['o ground', 'o d01', 'o d02']
    """
    path = Path(path)
    if not np.isfinite(scale):
        msg = f"scale = {scale:g} is not a finite number"
        raise InputError(msg, where=str(path), hint="give what displacements are multiplied by")
    writer = WRITERS.get(path.suffix.lower())
    if writer is None:
        msg = f"'{path.suffix}' is not a format of solids"
        raise InputError(msg, where=str(path), hint="one of " + ", ".join(WRITERS))
    if isinstance(what, DynamicsResult | PushResult):
        _animated(path, what, scale)
        return
    blocks = _blocks(what) if isinstance(what, Model) else _displaced(what, scale)
    with whole_file(path) as fresh:
        writer(fresh, blocks)


def _animated(path: Path, result: DynamicsResult | PushResult, scale: float) -> None:
    """Write a motion as animation."""
    if path.suffix.lower() != ".glb":
        msg = f"'{path.suffix}' has no animation"
        raise InputError(msg, where=str(path), hint="write a motion as .glb")
    if scale != 1.0:
        msg = f"scale = {scale:g}: a motion is written true to scale"
        raise InputError(msg, where=str(path), hint="leave the scale out")
    drawn = [(b.name, b.triangles, b.fixed) for b in _blocks(result.model)]
    if isinstance(result, PushResult):
        time, centre, rotation = np.linspace(0.0, FILM, len(result)), result.centre, result.rotation
    else:
        shots = result.shots
        time, centre, rotation = shots.time - shots.time[0], shots.centre, shots.rotation
    centroid = np.array([body.centroid for body in result.model.polyhedra])
    with whole_file(path) as fresh:
        fresh.write_bytes(glb_bytes(drawn, Moving(time, centroid, centre, rotation)))


def _blocks(model: Model) -> list[Drawn]:
    found = []
    for body in model.polyhedra:
        plain = not body.holes and body.convex
        cells = body.triangles[0]
        faces = body.faces if plain else tuple(map(tuple, cells.tolist()))
        found.append(Drawn(body.name, body.layer or body.material, body.kind == "fixed", body.vertices, faces, cells))
    return found


def _displaced(result: Result, scale: float) -> list[Drawn]:
    shown = solids(result, None if result.solved else result.mechanism_velocity)
    points = shown.moved(scale)
    found = []
    for b, body in enumerate(result.model.polyhedra):
        first, last = shown.starts[b : b + 2].tolist()
        cells, layer = shown.triangles[shown.body == b] - first, body.layer or body.material
        found.append(Drawn(body.name, layer, body.kind == "fixed", points[first:last], cells.tolist(), cells))
    return found


def _obj(path: Path, blocks: Sequence[Drawn]) -> None:
    lines, start = ["# concio, metres"], 1
    for block in blocks:
        lines += [f"o {block.name}", f"usemtl {'fixed' if block.fixed else block.layer or 'block'}"]
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in block.points.tolist()]
        lines += ["f " + " ".join(str(start + v) for v in face) for face in block.faces]
        start += len(block.points)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _stl(path: Path, blocks: Sequence[Drawn]) -> None:
    lines = []
    for block in blocks:
        lines.append(f"solid {block.name}")
        for triangle in block.triangles:
            normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
            x, y, z = (normal / max(float(np.linalg.norm(normal)), 1e-300)).tolist()
            lines += [f"facet normal {x:.9g} {y:.9g} {z:.9g}", "outer loop"]
            lines += [f"vertex {a!r} {b!r} {c!r}" for a, b, c in triangle.tolist()]
            lines += ["endloop", "endfacet"]
        lines.append(f"endsolid {block.name}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _compas(path: Path, blocks: Sequence[Drawn]) -> None:
    shapes = [(b.name, b.fixed, b.points, b.faces) for b in blocks]
    path.write_text(json.dumps(block_model(shapes, path.stem)), encoding="utf-8")


def _glb(path: Path, blocks: Sequence[Drawn]) -> None:
    path.write_bytes(glb_bytes([(b.name, b.triangles, b.fixed) for b in blocks]))


def _dxf(path: Path, blocks: Sequence[Drawn]) -> None:
    try:
        import ezdxf
        from ezdxf.render import MeshBuilder
    except ImportError:
        msg = "writing DXF needs the package ezdxf, which is not installed"
        raise InputError(msg, where=str(path), hint="pip install ezdxf") from None
    from concio.io.dxf_out import FORBIDDEN
    from concio.model.solids.dxf3d import NAMES

    document = ezdxf.new("R2010", units=6)
    document.appids.add(NAMES)
    for block in blocks:
        mesh = MeshBuilder()
        mesh.add_mesh(vertices=block.points.tolist(), faces=[list(map(int, f)) for f in block.faces])
        layer = "CONCIO_FIXED" if block.fixed else FORBIDDEN.sub("_", block.layer) or "BLOCKS"
        entity = mesh.render_mesh(document.modelspace(), dxfattribs={"layer": layer})
        entity.set_xdata(NAMES, [(1000, block.name)])
    document.saveas(path)


def _rhino(path: Path, blocks: Sequence[Drawn]) -> None:
    try:
        rhino3dm: Any = importlib.import_module("rhino3dm")
    except ImportError:
        msg = "writing 3dm needs the package rhino3dm, which is not installed"
        raise InputError(msg, where=str(path), hint="pip install rhino3dm") from None
    document = rhino3dm.File3dm()
    document.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    numbers: dict[str, int] = {}
    for block in blocks:
        layer = "fixed" if block.fixed else block.layer or "blocks"
        if layer not in numbers:
            numbers[layer] = document.Layers.AddLayer(layer, (150, 140, 120, 255))
        mesh = rhino3dm.Mesh()
        _add_vertices(path, mesh.Vertices, block)
        for triangle in block.cells.tolist():
            mesh.Faces.AddFace(*triangle)
        about = rhino3dm.ObjectAttributes()
        about.Name, about.LayerIndex = block.name, numbers[layer]
        document.Objects.AddMesh(mesh, about)
    document.Write(str(path), 7)


def _add_vertices(path: Path, vertices: Any, block: Drawn) -> None:
    """Add the corners of a block in double precision; refuse what a package without it would distort."""
    vertices.UseDoublePrecisionVertices = True
    add = getattr(vertices, "AddPoint3d", None)
    size = float(np.ptp(block.points, axis=0).max())
    if add is None and np.abs(block.points - block.points.astype(np.float32)).max() > SINGLE * size:
        msg = f"'{block.name}' lies so far from the origin that this version of rhino3dm would distort it"
        raise InputError(msg, where=str(path), hint="pip install --upgrade rhino3dm")
    for x, y, z in block.points.tolist():
        (add or vertices.Add)(x, y, z)


WRITERS: dict[str, Callable[[Path, Sequence[Drawn]], None]] = {
    ".obj": _obj, ".stl": _stl, ".json": _compas, ".glb": _glb, ".dxf": _dxf, ".3dm": _rhino,
}  # fmt: skip
"""Writers by the end of the name."""
