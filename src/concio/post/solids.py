"""Blocks in space as they are drawn: surfaces as triangles, edges as lines, with the displacement of every point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from concio.fem.solid import SolidShape
from concio.kinematics.rigid import swept
from concio.post.body_motion import body_motions
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.model import Model
    from concio.model.polyhedron import Polyhedron

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class Solids:
    """Surfaces of all bodies, P points, T triangles, E edges.

    Parameters
    ----------
    points, displacement : (P, 3) arrays
        [m].
    starts : (B+1,) integer array
        Points of body b are ``starts[b]:starts[b+1]``.
    triangles : (T, 3) integer array
        Points, counter-clockwise seen from outside.
    body, face : (T,) integer arrays
        Body of each triangle, and the face of the body it lies on.
    edges : (E, 2) integer array
        Points of the edges between faces.
    edge_body : (E,) integer array
    """

    points: Array
    displacement: Array
    starts: Array
    triangles: Array
    body: Array
    face: Array
    edges: Array
    edge_body: Array

    @cached_property
    def size(self) -> float:
        """Longest side of the box around everything [m]."""
        return float(np.ptp(self.points, axis=0).max())

    def moved(self, scale: float = 1.0) -> Array:
        """Return the points (P, 3) with displacements times ``scale`` [m]."""
        moved: Array = self.points + scale * self.displacement
        return moved


def model_solids(model: Model) -> Solids:
    """Return the surfaces of a model's blocks, none of them displaced."""
    blocks = [_of_block(b) for b in model.polyhedra]
    return _joined(blocks, [np.zeros_like(b[0]) for b in blocks])


def solids(result: Result, u: Array | None = None) -> Solids:
    """Return the surfaces of all bodies with their displacements.

    Parameters
    ----------
    result : Result
    u : (N_all,) array, optional
        Displacements to show in place of the result's, such as a mechanism; fixed bodies then stay.
    """
    disc = result.assembly.disc
    own = result.displacement if u is None else u
    motion = body_motions(result, u)
    surfaces = {s: _of_mesh(shape) for s, shape in enumerate(disc.shapes) if isinstance(shape, SolidShape)}
    blocks, moves = [], []
    for b, s in enumerate(disc.shape_of.tolist()):
        if s in surfaces:
            nodes, triangles, face, edges, used = surfaces[s]
            blocks.append((nodes + disc.origins[b], triangles, face, edges))
            moves.append(own[disc.offsets[b] : disc.offsets[b + 1]].reshape(-1, 3)[used])
        else:
            block = _of_block(result.model.polyhedra[b])
            blocks.append(block)
            moves.append(motion[b, :3] + swept(motion[b, 3:], block[0] - disc.centroids[b]))
    return _joined(blocks, moves)


def tie_ends(model: Model) -> Array:
    """Return the two ends of each tie (t, 2, 3) [m]."""
    return np.array([[tie.at_a, tie.at_b] for tie in model.ties], dtype=float).reshape(-1, 2, 3)


def tie_bodies(model: Model) -> Array:
    """Return the numbers of the bodies that the ends of each tie are fixed to (t, 2), -1 for a point that stands."""
    number = {body.name: k for k, body in enumerate(model.bodies)}
    ends = [[number.get(name, -1) for name in (t.body_a, t.body_b)] for t in model.ties]
    return np.array(ends, dtype=int).reshape(-1, 2)


def moved_ties(result: Result, u: Array | None, scale: float) -> Array:
    """Return the ends of each tie (t, 2, 3) carried along by their bodies, so many times as far as they move [m]."""
    ends, bodies = tie_ends(result.model), tie_bodies(result.model)
    motion = np.vstack([body_motions(result, u), np.zeros(6)])[bodies]
    arm = ends - np.vstack([result.assembly.disc.centroids, np.zeros(3)])[bodies]
    return np.asarray(ends + scale * (motion[..., :3] + swept(motion[..., 3:], arm)))


Piece = tuple[Array, Array, Array, Array]
"""Points (n, 3), triangles (t, 3), face of each triangle (t,), edges (e, 2)."""


def _of_block(block: Polyhedron) -> Piece:
    triangles, face = block.triangles
    return block.vertices, triangles, face, _sharp(triangles, face)


def _of_mesh(shape: SolidShape) -> tuple[Array, Array, Array, Array, Array]:
    """Return the surface of a meshed body, and which of its nodes it uses."""
    found, faces = [], []
    for k, facets in enumerate(shape.facets):
        parts = facets.parts
        cells = parts if parts.shape[1] == 3 else np.vstack([parts[:, [0, 1, 2]], parts[:, [0, 2, 3]]])
        found.append(cells)
        faces.append(np.full(len(cells), k))
    triangles, face = np.vstack(found), np.concatenate(faces)
    used, local = np.unique(triangles, return_inverse=True)
    triangles = local.reshape(triangles.shape)
    return shape.elements.nodes[used], triangles, face, _sharp(triangles, face), used


def _sharp(triangles: Array, face: Array) -> Array:
    """Return the sides (e, 2) of triangles that lie between two faces."""
    sides = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    of = np.tile(face, 3)
    ordered = np.sort(sides, axis=1)
    _, which = np.unique(ordered, axis=0, return_inverse=True)
    first = np.full(which.max() + 1, -1)
    first[which] = of
    mixed = np.zeros(len(first), dtype=bool)
    np.logical_or.at(mixed, which, of != first[which])
    pick = mixed[which] & (sides[:, 0] < sides[:, 1])
    edges: Array = sides[pick]
    return edges


def _joined(blocks: list[Piece], moves: list[Array]) -> Solids:
    starts = np.concatenate([[0], np.cumsum([len(points) for points, *_ in blocks])])
    count = [len(t) for _, t, _, _ in blocks]
    return Solids(
        np.vstack([points for points, *_ in blocks]),
        np.vstack(moves),
        starts,
        np.vstack([t + s for (_, t, _, _), s in zip(blocks, starts[:-1], strict=True)]),
        np.repeat(np.arange(len(blocks)), count),
        np.concatenate([f for _, _, f, _ in blocks]),
        np.vstack([e + s for (*_, e), s in zip(blocks, starts[:-1], strict=True)]),
        np.repeat(np.arange(len(blocks)), [len(e) for *_, e in blocks]),
    )
