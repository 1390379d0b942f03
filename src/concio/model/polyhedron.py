"""Blocks in space: closed polyhedra with planar faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from concio.arguments import strict_class
from concio.errors import GeometryError
from concio.kinematics.mass import Moments, polyhedron_moments
from concio.model.body import Kind, check_kind_and_mesh
from concio.model.convex_pieces import ConvexPiece, convex_pieces
from concio.model.polyhedron_check import require_sound
from concio.model.topology import Loop, Topology, face_triangles, topology

Array = np.ndarray

CONVEX = 1e-6
"""Share of a block's size by which a vertex may stand out of a face's plane and the block still count as convex."""
BOX: tuple[Loop, ...] = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Faces of a block whose vertices are numbered x + 2 y + 4 z: below, above, front, back, left, right."""


@strict_class
@dataclass(frozen=True, eq=False, repr=False)
class Polyhedron:
    """A block, a mortar film or an obstacle in space: a closed polyhedron with planar faces, convex or not.

    Parameters
    ----------
    name : str
        Unique in the model.
    vertices : (n, 3) array
        [m].
    faces : sequence of sequences of int
        Vertices of each face, counter-clockwise seen from outside; a face need not be convex.
    material : str
        Key of ``Model.materials``; ignored for fixed bodies.
    kind : {"elastic", "rigid", "fixed"}
        A fixed body has no unknowns: it is an obstacle (ground, wall, bearing).
    role : str
        "block", "mortar", "obstacle"...: chooses joint laws and colours.
    layer : str
        Free label, for instance the layer of a drawing.
    holes : sequence of (face, loop)
        Interior boundaries of faces: the number of the face and the vertices of the hole, clockwise seen from outside.
    grid : (nx + 1, ny + 1, nz + 1, 3) array or None
        Corners of hexahedra that fill the block, from which its mesh is made [m]; None lets concio mesh.
    mesh_size : float or None
        Target element size [m]; None takes the model's.

    Raises
    ------
    GeometryError
        The faces do not close, point inwards, cross themselves or are not planar: see
        :mod:`concio.model.polyhedron_check`.

    Examples
    --------
    A pyramid over a square of 1 m2, 0.6 m high:

    >>> import concio
    >>> corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0), (0.5, 0.5, 0.6)]
    >>> faces = [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    >>> block = concio.Polyhedron("apex", corners, faces)
    >>> round(block.volume, 6)
    0.2
    """

    name: str
    vertices: Array
    faces: tuple[Loop, ...]
    material: str = "block"
    kind: Kind = "elastic"
    role: str = "block"
    layer: str = ""
    holes: tuple[tuple[int, Loop], ...] = ()
    grid: Array | None = None
    mesh_size: float | None = None

    dim: ClassVar[int] = 3
    thickness: ClassVar[float] = 1.0

    def __post_init__(self) -> None:
        check_kind_and_mesh(self.kind, self.mesh_size, f"block '{self.name}'")
        points = np.array(self.vertices, dtype=float)
        faces = _loops(self.faces, self.name)
        holes = tuple((int(face), loop) for (face, _), loop in
                      zip(self.holes, _loops([h for _, h in self.holes], self.name), strict=True))  # fmt: skip
        normals = require_sound(points, faces, holes, self.name)
        points, faces, holes = _without_unused(points, faces, holes)
        points.setflags(write=False)
        normals.setflags(write=False)
        object.__setattr__(self, "vertices", points)
        object.__setattr__(self, "faces", faces)
        object.__setattr__(self, "holes", holes)
        self.__dict__["normals"] = normals  # the check has just computed what the property would
        if self.grid is not None:
            grid = np.array(self.grid, dtype=float)
            if grid.ndim != 4 or grid.shape[3] != 3 or min(grid.shape[:3]) < 2 or not np.isfinite(grid).all():
                msg = f"grid has shape {grid.shape}, expected (nx + 1, ny + 1, nz + 1, 3) finite numbers"
                raise GeometryError(msg, where=f"block '{self.name}'")
            grid.setflags(write=False)
            object.__setattr__(self, "grid", grid)

    def __repr__(self) -> str:
        words = f"{len(self.vertices)} vertices, {len(self.faces)} faces, volume {self.volume:.4g} m3, {self.kind}"
        return f"Polyhedron('{self.name}', {words})"

    @classmethod
    def box(cls, name: str, low: Sequence[float], high: Sequence[float], **fields: Any) -> Polyhedron:
        """Return a block with faces along the axes, between two opposite corners [m].

        Parameters
        ----------
        name : str
        low, high : (x, y, z)
        **fields
            Further fields of :class:`Polyhedron`.

        Examples
        --------
        >>> import concio
        >>> block = concio.Polyhedron.box("b01", (0.0, 0.0, 0.0), (0.6, 0.3, 0.2))
        >>> round(block.volume, 6), len(block.faces)
        (0.036, 6)
        """
        p, q = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
        if p.shape != (3,) or q.shape != (3,) or not (p < q).all():
            msg = f"the corners {list(low)} and {list(high)} are not the lower and the upper corner of a box"
            raise GeometryError(msg, where=f"block '{name}'", hint="give x, y, z of each, all larger in the second")
        z, y, x = np.meshgrid(*np.stack([p, q])[:, ::-1].T, indexing="ij")
        return cls(name, np.column_stack([x.ravel(), y.ravel(), z.ravel()]), BOX, **fields)

    @property
    def topology(self) -> Topology:
        """How the faces are connected; shared by all blocks with the same faces."""
        return topology(self.faces, self.holes)

    @cached_property
    def normals(self) -> Array:
        """Unit outward normals of the faces (f, 3)."""
        area = self.topology.area_vectors(self.vertices)
        return np.asarray(area / np.linalg.norm(area, axis=1)[:, None])

    @cached_property
    def moments(self) -> Moments:
        """Volume, centroid and second moments."""
        return polyhedron_moments(self.vertices, [*self.faces, *(loop for _, loop in self.holes)])

    @property
    def volume(self) -> float:
        """Volume [m3]."""
        return self.moments.measure

    @property
    def centroid(self) -> Array:
        """Centroid (3,) [m]."""
        return self.moments.centroid

    @property
    def size(self) -> float:
        """Side of a cube of the same volume [m]."""
        return float(np.cbrt(self.volume))

    @cached_property
    def length(self) -> float:
        """Greatest extent along any of its edges, that of a box its longest side; it turns with the body [m]."""
        edges = self.vertices[self.topology.edges[:, 1]] - self.vertices[self.topology.edges[:, 0]]
        along = edges / np.linalg.norm(edges, axis=1)[:, None]
        parts = np.array_split(along, len(along) // 99 + 1)
        return max(float(np.ptp(self.vertices @ part.T, axis=0).max()) for part in parts)

    @cached_property
    def face_areas(self) -> Array:
        """Areas of the faces (f,) [m2]."""
        areas: Array = np.linalg.norm(self.topology.area_vectors(self.vertices), axis=1)
        return areas

    @cached_property
    def offsets(self) -> Array:
        """Distances (f,) of the planes of the faces from the origin along their normals [m]."""
        top = self.topology
        middle = top.by_face(self.vertices[top.start]) / top.sides_of_face[:, None]
        return np.asarray((middle * self.normals).sum(1))

    @cached_property
    def convex(self) -> bool:
        """Whether no vertex stands out of the plane of any face."""
        out = self.vertices @ self.normals.T - self.offsets
        return bool(out.max() <= CONVEX * np.ptp(self.vertices, axis=0).max())

    @cached_property
    def pieces(self) -> tuple[ConvexPiece, ...] | None:
        """Convex pieces of the block, itself where it is convex; None where it falls into too many."""
        return convex_pieces(self)

    def loops_of(self, face: int) -> list[Loop]:
        """Return the boundary of a face and those of its holes."""
        return [self.faces[face], *(loop for number, loop in self.holes if number == face)]

    @cached_property
    def triangles(self) -> tuple[Array, Array]:
        """Triangles (k, 3) of the surface, counter-clockwise seen from outside, and the face (k,) each belongs to."""
        found = [face_triangles(self.vertices, self.loops_of(f), n) for f, n in enumerate(self.normals)]
        return np.concatenate(found), np.repeat(np.arange(len(found)), [len(cells) for cells in found])


def _loops(loops: Sequence[Sequence[int]], name: str) -> tuple[Loop, ...]:
    try:
        return tuple(tuple(map(int, loop)) for loop in loops)
    except (TypeError, ValueError):
        msg = "faces are not lists of vertex numbers"
        raise GeometryError(msg, where=f"block '{name}'", hint="write ((0, 2, 3, 1), (4, 5, 7, 6), ...)") from None


def _without_unused(
    points: Array, faces: tuple[Loop, ...], holes: tuple[tuple[int, Loop], ...]
) -> tuple[Array, tuple[Loop, ...], tuple[tuple[int, Loop], ...]]:
    """Return vertices and faces without the vertices that no face uses."""
    used = np.zeros(len(points), dtype=bool)
    used[topology(faces, holes).start] = True
    if used.all():
        return points, faces, holes
    new = (np.cumsum(used) - 1).tolist()
    renamed = tuple(tuple(new[v] for v in loop) for loop in faces)
    return points[used], renamed, tuple((face, tuple(new[v] for v in loop)) for face, loop in holes)

