"""A wall as a continuum: outline, mesh, where it is held and loaded, read off the model of its blocks.

The outline is that of all blocks and films together. It has to consist of edges along x and y (walls and panels with
openings); mesh lines go through all its corners, through the ends of supports and of loaded edges, and every rectangle
between them is cut into four triangles by its diagonals.

The wall is held where its blocks touch fixed bodies, by the joints they have there. Weight is that of the blocks spread
over the whole area.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.analysis.continuum.outline import (
    boundary_edges,
    corners_of_shape,
    fanned_rectangles,
    mesh_lines,
    wall_shape,
)
from concio.contact.assembly import Assembly
from concio.contact.detection import default_tolerance
from concio.contact.factors import load_factor
from concio.errors import InputError
from concio.kinematics.frames import cross, turned_left, turned_right
from concio.model.generate.spacing import subdivided
from concio.model.interfaces.detect import Interface
from concio.model.materials import JointLaw
from concio.model.model import Load, Model

Array = np.ndarray

LARGEST_MESH = 200_000
"""More triangles than this are refused."""


@dataclass(frozen=True, eq=False)
class Continuum:
    """A meshed wall without blocks.

    Parameters
    ----------
    points : (n, 2) array
        Nodes [m].
    triangles : (e, 3) integer array
        Counter-clockwise.
    thickness : float
        [m].
    edges : (b, 2) integer array
        Boundary edges, the wall to their left.
    element : (b,) integer array
        Triangle of each boundary edge.
    held_by : (b,) integer array
        Number in ``supports`` of the fixed body that holds the edge; -1 where it is free.
    supports : tuple of (str, JointLaw)
        Name of a fixed body, and the law of its joint with the wall.
    motion : mapping of str to (len(supports), 3) arrays
        Imposed motion of the fixed bodies in each load group: displacement of the point (0, 0) [m] and rotation.
    body_force : mapping of str to (2,) arrays
        Of each load group [kN/m3].
    traction : mapping of str to (b, 2) arrays
        On the boundary edges, of each load group [kN/m2].
    """

    points: Array
    triangles: Array
    thickness: float
    edges: Array
    element: Array
    held_by: Array
    supports: tuple[tuple[str, JointLaw], ...]
    motion: Mapping[str, Array]
    body_force: Mapping[str, Array]
    traction: Mapping[str, Array]

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the load groups."""
        return tuple(dict.fromkeys([*self.body_force, *self.traction, *self.motion]))

    @cached_property
    def areas(self) -> Array:
        """Areas of the triangles (e,) [m2]."""
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        found: Array = 0.5 * cross(b - a, c - a)
        return found

    @cached_property
    def centres(self) -> Array:
        """Centroids of the triangles (e, 2) [m]."""
        found: Array = self.points[self.triangles].mean(axis=1)
        return found

    @cached_property
    def lengths(self) -> Array:
        """Lengths of the boundary edges (b,) [m]."""
        found: Array = np.hypot(*(self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]).T)
        return found

    @cached_property
    def outward(self) -> Array:
        """Outward unit normals of the boundary edges (b, 2)."""
        along = (self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]) / self.lengths[:, None]
        return turned_right(along)

    def force(self, factors: Mapping[str, float]) -> Array:
        """Return the body force (2,) under load factors; groups not named have 1 [kN/m3]."""
        return _sum(self.body_force, factors, np.zeros(2))

    def pull(self, factors: Mapping[str, float]) -> Array:
        """Return the tractions (b, 2) on the boundary under load factors; groups not named have 1 [kN/m2]."""
        return _sum(self.traction, factors, np.zeros((len(self.edges), 2)))

    def moved(self, factors: Mapping[str, float]) -> Array:
        """Return the motions (len(supports), 3) of the fixed bodies under load factors."""
        return _sum(self.motion, factors, np.zeros((len(self.supports), 3)))

    def resultant(self, factors: Mapping[str, float]) -> Array:
        """Return the resultant (2,) of the loads [kN]."""
        total: Array = self.force(factors) * self.areas.sum() + (self.pull(factors) * self.lengths[:, None]).sum(0)
        return total * self.thickness


def _sum(groups: Mapping[str, Array], factors: Mapping[str, float], zero: Array) -> Array:
    total = zero.copy()
    for name, value in groups.items():
        total += load_factor(factors, name) * value
    return total


def continuum_of(assembly: Assembly, mesh_size: float, stretch: float = 1.0) -> Continuum:
    """Return the continuum that a wall of blocks is taken for.

    Parameters
    ----------
    assembly : Assembly
    mesh_size : float
        Largest side of the rectangles that are cut into triangles [m].
    stretch : float
        They are about as many times as high as they are long, at the same area.

    Raises
    ------
    InputError
        The outline has edges that run neither along x nor along y, or the model holds what has no counterpart in a
        continuum: ties, supports of blocks, point loads, loads on single blocks, initial gaps.
    """
    model = assembly.model
    _refuse(assembly)
    near = 10 * max(default_tolerance(model), 1e-6 * assembly.disc.size)
    contacts = [f for f in assembly.detection.segments if "fixed" in (_kind(model, f.a), _kind(model, f.b))]
    shape = wall_shape([(b.outline, b.holes) for b in model.outlines if b.kind != "fixed"], near)
    loaded = [np.array(load.edge, dtype=float) for load in model.loads if load.edge is not None]
    ends = np.vstack([_ends(model, contacts, 10 * near), *loaded])
    x_marks, y_marks = mesh_lines(shape, ends, near)
    xs, ys = subdivided(x_marks, mesh_size / np.sqrt(stretch)), subdivided(y_marks, mesh_size * np.sqrt(stretch))
    if 4 * len(xs) * len(ys) > LARGEST_MESH:
        msg = f"the continuum has {4 * len(xs) * len(ys):,} triangles, more than {LARGEST_MESH:,}"
        raise InputError(msg, hint="use a larger mesh")
    points, triangles = fanned_rectangles(xs, ys, shape, np.vstack([corners_of_shape(shape), ends]))
    edges, element = boundary_edges(triangles)
    held_by, supports = _held(model, contacts, points, edges, near)
    if (held_by < 0).all():
        msg = "the wall touches no fixed body: nothing holds its continuum"
        raise InputError(msg, hint="give it a ground, or side walls")
    thickness = {b.thickness for b in model.outlines if b.kind != "fixed"}
    if len(thickness) > 1:
        msg = f"the blocks have {len(thickness)} thicknesses"
        raise InputError(msg, hint="a continuum has one")
    wall = Continuum(
        points, triangles, thickness.pop(), edges, element, held_by, supports, _motions(model, supports), {}, {}
    )  # fmt: skip
    body, pull = _loads(model, wall, float(shape.area), near)
    return Continuum(
        points, triangles, wall.thickness, edges, element, held_by, supports, wall.motion, body, pull
    )  # fmt: skip


def _kind(model: Model, b: int) -> str:
    return model.bodies[b].kind


def _refuse(assembly: Assembly) -> None:
    model = assembly.model
    if model.dim != 2:
        msg = "the model is one in space"
        raise InputError(msg, hint="a continuum without blocks is made of walls in the plane")
    free = {b.name for b in model.free_bodies}
    held = [s.name for s in model.supports if s.body in free]
    for found, what in (
        (model.ties, "ties"),
        (model.temperatures, "changes of temperature"),
        (held, f"a support of a block ('{held[0]}')" if held else ""),
        ([v for v in model.loads if v.kind == "point"], "point loads"),
        ([v for v in model.loads if v.bodies], "loads on single blocks"),
        (np.flatnonzero(assembly.pairs.gap > 0), "joints that are open at first"),
    ):
        if len(found):
            msg = f"the model has {what}, which a continuum without blocks has not"
            raise InputError(msg, hint="compare a wall on fixed bodies, under weight and loads on its edges")


def _support(model: Model, face: Interface) -> tuple[str, JointLaw]:
    """Return the name of the fixed body at a joint, and the joint's law."""
    fixed = face.a if _kind(model, face.a) == "fixed" else face.b
    return model.bodies[fixed].name, model.laws[model.rule_between(model.bodies[face.a], model.bodies[face.b]).law]


def _ends(model: Model, contacts: Sequence[Interface], near: float) -> Array:
    """Return where supports end (k, 2): the ends of joints with fixed bodies at which no other of the same begins."""
    ends: dict[tuple[str, JointLaw], list[Array]] = {}
    for face in contacts:
        ends.setdefault(_support(model, face), []).extend([face.start, face.end])
    found = [p for own in ends.values() for p in own if sum(np.abs(p - q).max() <= near for q in own) == 1]
    return np.array(found).reshape(-1, 2)


def _held(
    model: Model, contacts: Sequence[Interface], points: Array, edges: Array, wide: float
) -> tuple[Array, tuple[tuple[str, JointLaw], ...]]:
    """Return for each boundary edge the number of its support, -1 where there is none, and the supports."""
    middle = points[edges].mean(axis=1)
    held = np.full(len(edges), -1)
    supports: list[tuple[str, JointLaw]] = []
    for face in contacts:
        key = _support(model, face)
        along = (face.end - face.start) / face.length
        s = (middle - face.start) @ along
        off = np.abs((middle - face.start) @ turned_left(along))
        on = (off <= 10 * wide) & (s >= -wide) & (s <= face.length + wide)
        if not on.any():
            continue
        if key not in supports:
            supports.append(key)
        held[on] = supports.index(key)
    return held, tuple(supports)


def _motions(model: Model, supports: Sequence[tuple[str, JointLaw]]) -> dict[str, Array]:
    """Return the imposed motions of fixed bodies, as displacement of the point (0, 0) and rotation."""
    motion: dict[str, Array] = {}
    names = [name for name, _ in supports]
    for support in model.supports:
        for k, name in enumerate(names):
            if name == support.body:
                x, y = model.body(name).centroid
                turn = float(np.asarray(support.rotation))
                at = np.array([support.displacement[0] + turn * y, support.displacement[1] - turn * x, turn])
                motion.setdefault(support.group, np.zeros((len(supports), 3)))[k] += at
    return motion


def _loads(model: Model, wall: Continuum, area: float, wide: float) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return body forces and edge tractions of the load groups."""
    body: dict[str, Array] = {}
    pull: dict[str, Array] = {}
    free = [b for b in model.outlines if b.kind != "fixed"]
    weight = sum(model.materials[b.material].unit_weight * b.area for b in free) / area
    for load in model.loads:
        if load.kind in ("weight", "body"):
            density = weight if load.kind == "weight" else 1.0
            body.setdefault(load.group, np.zeros(2))
            body[load.group] = body[load.group] + density * np.array(load.value, dtype=float)
        else:
            pull.setdefault(load.group, np.zeros((len(wall.edges), 2)))
            pull[load.group] = pull[load.group] + _edge_load(wall, load, wide)
    return body, pull


def _edge_load(wall: Continuum, load: Load, wide: float) -> Array:
    """Return the tractions (b, 2) of a pressure or traction along a line [kN/m2]."""
    assert load.edge is not None
    p, q = (np.array(end, dtype=float) for end in load.edge)
    length = float(np.hypot(*(q - p)))
    along = (q - p) / length
    middle = wall.points[wall.edges].mean(axis=1)
    s, off = (middle - p) @ along, np.abs((middle - p) @ turned_left(along))
    on = (off <= wide) & (s >= -wide) & (s <= length + wide)
    if not on.any():
        msg = f"the {load.kind} from ({p[0]:g}, {p[1]:g}) to ({q[0]:g}, {q[1]:g}) lies within the wall"
        raise InputError(msg, where=f"load group '{load.group}'", hint="a continuum is loaded on its outline")
    if load.kind == "pressure":
        return np.where(on[:, None], -load.value[0] * wall.outward, 0.0)
    return np.where(on[:, None], np.array(load.value, dtype=float), 0.0)
