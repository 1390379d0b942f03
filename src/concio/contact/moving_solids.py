"""The surfaces of all polyhedra as flat arrays that move with them: vertices, faces and edges.

What is evaluated in every step of a motion is a handful of array operations, as with the edges of the plane
(:mod:`concio.contact.edges`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.contact.face_joints import FaceJoints
from concio.contact.solid_sides import SurfaceNodes
from concio.kinematics.frames import cross, dot, norm, tangents
from concio.kinematics.placement import Placement
from concio.model.polyhedron import Polyhedron

Array = np.ndarray

FLAT = 1e-6
"""Sine of the angle between two faces below which their common edge does not stand out."""

POINTS = 65536
"""Points of the joints of two faces that names can tell apart."""

BESIDE = 0.02
"""Distance over the spacing of nodes by which one within a face or an edge may stand beside the face that it meets.

Where two faces have a side in common, the nodes on it would else come and go by rounding, with nothing instead."""

ON_FACE, ON_EDGES, IN_JOINT = 0, 1, 2
"""Sorts of pairs: a corner on a face, two edges, a point of a joint of two faces."""


@dataclass(frozen=True, eq=False)
class PlacedSolids:
    """Surfaces where they are: vertices ``start`` (v, 3), normals (f, 3) and first tangents (f, 3) of faces."""

    start: Array
    normal: Array
    tangent: Array


@dataclass(frozen=True, eq=False)
class MovingSolids:
    """Surfaces of all bodies in the frames of their bodies, relative to the centroids.

    Parameters
    ----------
    body : (v,) integer array
        Body of each vertex. Nodes on the surface of elastic bodies are vertices, behind those of the polyhedron.
    start : (v, 3) array
        Vertices [m].
    around : (v, k) integer array
        Vertices at the other ends of the edges of each vertex, of a node those of its faces; itself where there are
        fewer than k.
    face_body, face_start : (f,) integer arrays
        Body of each face, and one of its vertices.
    normal, tangent : (f, 3) arrays
    sides : (f, s, 2, 2) array
        Ends of the sides of each face, along its two tangents from ``face_start`` [m]; repeated where there are fewer.
    edge_body : (e,) integer array
    edge : (e, 2) integer array
        Vertices at both ends of edges that stand out.
    edge_faces : (e, 2) integer array
        Faces that meet there.
    fixed : (v,) boolean array
        Vertices of bodies that do not move freely.
    width : (B,) array
        Mean width of each body, three times its volume over its surface [m].
    rings : sequence of f integer arrays
        Vertices of each face.
    node : (v,) integer array
        Node of an elastic body at a vertex, counted in the body; -1 where there is none.
    beside : (v,) array
        How far beside a face a vertex still stands over it [m].
    spacing : (B,) array
        Between nodes on the surface of elastic bodies, infinite for others [m].
    joints : FaceJoints or None
        Joints of faces as described whose laws need areas.
    """

    body: Array
    start: Array
    around: Array
    face_body: Array
    face_start: Array
    normal: Array
    tangent: Array
    sides: Array
    edge_body: Array
    edge: Array
    edge_faces: Array
    fixed: Array
    width: Array
    rings: Sequence[Array]
    node: Array
    beside: Array
    spacing: Array
    joints: FaceJoints | None = None

    @classmethod
    def of(cls, bodies: Sequence[Polyhedron], meshes: Sequence[SurfaceNodes | None] = ()) -> MovingSolids:
        """Return the surfaces of bodies, with the nodes on those of elastic ones."""
        tops = [b.topology for b in bodies]
        meshes = meshes or [None] * len(bodies)
        corners = np.array([len(b.vertices) for b in bodies])
        vertices = corners + [0 if mesh is None else len(mesh.node) for mesh in meshes]
        faces = np.array([len(b.faces) for b in bodies])
        first_v, first_f = np.cumsum(vertices) - vertices, np.cumsum(faces) - faces
        start = np.concatenate(
            [part for b, mesh in zip(bodies, meshes, strict=True)
             for part in (b.vertices - b.centroid, np.zeros((0, 3)) if mesh is None else mesh.place)]
        )  # fmt: skip
        normal = np.concatenate([b.normals for b in bodies])
        face_body = np.repeat(np.arange(len(bodies)), faces)
        edge = np.concatenate([top.edges + first_v[i] for i, top in enumerate(tops)])
        edge_faces = np.concatenate([top.edge_faces + first_f[i] for i, top in enumerate(tops)])
        side = np.concatenate(
            [np.column_stack([top.face + first_f[i], top.start + first_v[i], top.end + first_v[i]])
             for i, top in enumerate(tops)]
        )  # fmt: skip
        side = side[np.argsort(side[:, 0], kind="stable")]
        face_start = side[np.searchsorted(side[:, 0], np.arange(len(normal))), 1]
        ways = tangents(normal)
        flat = np.einsum("sekc,sdc->sekd", (start[side[:, 1:]] - start[face_start[side[:, 0]]][:, None])[:, None],
                         ways[side[:, 0]])[:, 0]  # fmt: skip
        out = cross(normal[edge_faces[:, 0]], normal[edge_faces[:, 1]])
        stands = dot(out, start[edge[:, 1]] - start[edge[:, 0]]) > FLAT * norm(start[edge[:, 1]] - start[edge[:, 0]])
        rings = np.split(side[:, 1], np.searchsorted(side[:, 0], np.arange(1, len(normal))))
        own, near = _ring_vertices(meshes, rings, first_v + corners, first_f)
        around = _padded(
            np.concatenate([edge[:, 0], edge[:, 1], own]), np.concatenate([edge[:, 1], edge[:, 0], near]), len(start)
        )
        body = np.repeat(np.arange(len(bodies)), vertices)
        area = np.array([b.face_areas.sum() for b in bodies])
        spacing = np.array([np.inf if mesh is None else mesh.spacing for mesh in meshes])
        inner = np.arange(len(start)) - first_v[body] >= corners[body]
        node = [np.full(len(b.vertices), -1) if mesh is None else np.concatenate([mesh.corner, mesh.node])
                for b, mesh in zip(bodies, meshes, strict=True)]  # fmt: skip
        return cls(
            body, start, around, face_body, face_start, normal, ways[:, 0], _gathered(side[:, 0], flat, len(normal)),
            body[edge[stands, 0]], edge[stands], edge_faces[stands],
            np.array([bodies[b].kind == "fixed" for b in body.tolist()]),
            3.0 * np.array([b.volume for b in bodies]) / area, rings, np.concatenate(node),
            np.where(inner, BESIDE, 0.0) * np.where(inner, spacing[body], 0.0), spacing,
        )  # fmt: skip

    def placed(self, placement: Placement) -> PlacedSolids:
        """Return the surfaces of bodies that stand elsewhere."""
        turn = placement.turns[self.face_body]
        return PlacedSolids(placement.points(self.body, self.start), turn.apply(self.normal), turn.apply(self.tangent))

    # -- names of pairs of features ------------------------------------------------------------------------------------

    @cached_property
    def face_edges(self) -> list[Array]:
        """Edges of each face that stand out."""
        own = self.edge_faces.ravel()
        order = np.argsort(own, kind="stable")
        return np.split(order // 2, np.searchsorted(own[order], np.arange(1, len(self.normal))))

    def key(self, corner: Array, face: Array, edges: Array) -> Array:
        """Return names of corners on faces (q,), then of pairs of edges (r, 2): (q + r,) integers."""
        on_faces = corner.astype(np.int64) * len(self.normal) + face
        on_edges = edges[:, 0].astype(np.int64) * len(self.edge) + edges[:, 1]
        return np.concatenate([on_faces, self._begins[ON_EDGES] + on_edges])

    def joint_key(self, face: Array, number: Array) -> Array:
        """Return names (p,) of points of joints of faces (p, 2) by their numbers (p,)."""
        both = face[:, 0].astype(np.int64) * len(self.normal) + face[:, 1]
        return np.asarray(self._begins[IN_JOINT] + both * POINTS + number)

    @property
    def _begins(self) -> tuple[int, int, int]:
        """First name of each sort."""
        on_edges = len(self.start) * len(self.normal)
        return 0, on_edges, on_edges + len(self.edge) ** 2

    def features(self, key: Array) -> tuple[Array, Array, Array]:
        """Return the sorts of names (m,), and the numbers of their two features (m,) each: faces for joints."""
        _, edges, joints = self._begins
        sort = np.where(key < edges, ON_FACE, np.where(key < joints, ON_EDGES, IN_JOINT))
        from_begin = np.where(sort == IN_JOINT, (key - joints) // POINTS, key - np.take(self._begins, sort))
        first, second = np.divmod(from_begin, np.where(sort == ON_EDGES, len(self.edge), len(self.normal)))
        return sort, first, second

    def point_number(self, key: Array) -> Array:
        """Return the numbers (p,) of points of joints of given names (p,)."""
        return np.asarray((key - self._begins[IN_JOINT]) % POINTS)

    def sides_of(self, key: Array) -> Array:
        """Return the bodies (2, m) of the features of names (m,): of a corner on a face that of the corner first."""
        sort, *features = self.features(key)
        found = np.empty((2, len(key)), dtype=int)
        for k, owners in enumerate(((self.body, self.edge_body, self.face_body),
                                    (self.face_body, self.edge_body, self.face_body))):  # fmt: skip
            for which, owner in enumerate(owners):
                own = sort == which
                found[k, own] = owner[features[k][own]]
        return found

    @property
    def counts(self) -> tuple[int, int, int]:
        """Numbers of vertices, faces and edges."""
        return len(self.start), len(self.normal), len(self.edge)

    def numbers(self, bodies: Array) -> tuple[Array, Array, Array]:
        """Return the numbers of the vertices, faces and edges of some bodies, in order."""
        vertex, face, edge = (np.flatnonzero(np.isin(of, bodies)) for of in (self.body, self.face_body, self.edge_body))
        return vertex, face, edge


def renamed(key: Array, old: MovingSolids, new: MovingSolids, numbers: Sequence[Array]) -> tuple[Array, Array]:
    """Return names (m,) of pairs whose features have other ``numbers``, and which of them (m,) have both.

    ``numbers`` are those of vertices, faces and edges, negative where a feature is missing.
    """
    sort, first, second = old.features(key)
    vertex, face, edge = numbers
    found, kept = np.zeros(len(key), dtype=np.int64), np.zeros(len(key), dtype=bool)
    for which, (one, other) in enumerate(((vertex, face), (edge, edge), (face, face))):
        own = np.flatnonzero(sort == which)
        pair = np.column_stack([one[first[own]], other[second[own]]])
        own, pair = own[has := (pair >= 0).all(axis=1)], pair[has]
        none = np.zeros((0, 2), dtype=int)
        if which == ON_FACE:
            found[own] = new.key(pair[:, 0], pair[:, 1], none)
        elif which == ON_EDGES:
            found[own] = new.key(none[:, 0], none[:, 1], pair)
        else:
            found[own] = new.joint_key(pair, old.point_number(key[own]))
        kept[own] = True
    return found, kept


def _ring_vertices(
    meshes: Sequence[SurfaceNodes | None], rings: Sequence[Array], first: Array, first_face: Array
) -> tuple[Array, Array]:
    """Return nodes that are no corners, numbered from ``first`` (B,), and the vertices of their faces, pair by pair."""
    own, near = [np.zeros(0, dtype=int)], [np.zeros(0, dtype=int)]
    for mesh, at, face in zip(meshes, first.tolist(), first_face.tolist(), strict=True):
        for k, faces in enumerate(() if mesh is None else mesh.faces):
            ring = np.unique(np.concatenate([rings[face + f] for f in faces.tolist()]))
            own.append(np.full(len(ring), at + k))
            near.append(ring)
    return np.concatenate(own), np.concatenate(near)


def _padded(of: Array, value: Array, count: int) -> Array:
    """Return the values of each of ``count`` owners side by side (count, k), its own number where there are fewer."""
    order = np.argsort(of, kind="stable")
    of, value = of[order], value[order]
    place = np.arange(len(of)) - np.searchsorted(of, of)
    found = np.tile(np.arange(count)[:, None], (1, int(place.max(initial=0)) + 1))
    found[of, place] = value
    return found


def _gathered(of: Array, value: Array, count: int) -> Array:
    """Return the sides (n, 2, 2) of ``count`` owners, sorted by them, beside each other, filled up with a corner."""
    first = np.searchsorted(of, np.arange(count))
    place = np.arange(len(of)) - first[of]
    found = np.repeat(np.repeat(value[first][:, None, :1], 2, axis=2), int(place.max()) + 1, axis=1)
    found[of, place] = value
    return found
