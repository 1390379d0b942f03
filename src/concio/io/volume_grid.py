"""Bodies in space for ParaView: elastic ones as volume elements with stresses, the others by the triangles they show.

Quadratic elements keep all their nodes: T10 as VTK's quadratic tetrahedra, H27 as its triquadratic hexahedra.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.fem.constitutive import principal_in_space
from concio.fem.elements import Elements
from concio.io.vtu import HEXAHEDRON, QUADRATIC_TETRAHEDRON, TETRAHEDRON, TRIANGLE, TRIQUADRATIC_HEXAHEDRON, Grid
from concio.post.solids import solids

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
HEXAHEDRON_EDGES = (
    (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7),
)  # fmt: skip
HEXAHEDRON_SIDES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7), tuple(range(8)))
"""Corners in the middle of which VTK's quadratic cells have their further nodes, in VTK's order."""

KINDS = {"elastic": 0, "rigid": 1, "fixed": 2}
"""Numbers of the kinds of bodies."""


def volume_grid(result: Result) -> Grid:
    """Return all bodies of a result in space, body by body.

    Point data: ``displacement`` [m], ``stress`` (s_x, s_y, s_z, t_xy, t_yz, t_xz) at nodes [kN/m2], ``velocity`` of a
    mechanism. Cell data: ``body`` (number), ``face`` (of a triangle; -1 for an element), ``kind`` (0 elastic, 1 rigid,
    2 fixed), mean ``element_stress`` of each element with its principal values ``s_1 >= s_2 >= s_3`` and the directions
    of the first and the last, and ``body_s_1`` to ``body_s_3`` of each body; nan where a body has no stress.
    """
    disc, solved = result.assembly.disc, result.solved
    shown = solids(result)
    velocity = result.mechanism_velocity
    speeds = None if velocity is None else solids(result, velocity).displacement
    points, moved, speed, nodal = [], [], [], []
    cells, sizes, types, owner, faces, means = [], [], [], [], [], []
    total = 0
    for b, s in enumerate(disc.shape_of.tolist()):
        first, last = shown.starts[b : b + 2].tolist()
        if s >= 0:
            elements = disc.shapes[s].elements
            own, kind = vtk_cells(elements)
            points.append(disc.nodes(b))
            moved.append(result.node_displacement(b) if solved else np.zeros_like(points[-1]))
            if velocity is not None:
                speed.append(result.node_displacement(b, velocity))
            nodal.append(result.stress.at_nodes(b) if solved else np.full((len(points[-1]), 6), np.nan))
            means.append(element_means(result, b) if solved else np.full((len(own), 6), np.nan))
            faces.append(np.full(len(own), -1))
        else:
            mine = shown.body == b
            own, kind = shown.triangles[mine] - first, TRIANGLE
            points.append(shown.points[first:last])
            moved.append(shown.displacement[first:last])
            if speeds is not None:
                speed.append(speeds[first:last])
            nodal.append(np.full((last - first, 6), np.nan))
            means.append(np.full((len(own), 6), np.nan))
            faces.append(shown.face[mine])
        cells.append((own + total).ravel())
        sizes.append(np.full(len(own), own.shape[1]))
        types.append(np.full(len(own), kind))
        owner.append(np.full(len(own), b))
        total += len(points[-1])
    body, element = np.concatenate(owner), np.vstack(means)
    values, directions = principal_in_space(element)
    numbers = np.array([KINDS[b.kind] for b in result.model.bodies], dtype=np.int32)
    point_data: dict[str, Array] = {"displacement": np.vstack(moved), "stress": np.vstack(nodal)}
    if speed:
        point_data["velocity"] = np.vstack(speed)
    cell_data: dict[str, Array] = {
        "body": body.astype(np.int32), "face": np.concatenate(faces).astype(np.int32), "kind": numbers[body],
        "element_stress": element, "s_1": values[:, 0], "s_2": values[:, 1], "s_3": values[:, 2],
        "s_1_direction": directions[:, 0], "s_3_direction": directions[:, 2],
    }  # fmt: skip
    if solved:
        whole, _ = result.stress.principal_in_space
        cell_data |= {f"body_s_{k + 1}": whole[body, k] for k in range(3)}
    return Grid(
        np.vstack(points), np.concatenate(cells), np.cumsum(np.concatenate(sizes)), np.concatenate(types), point_data,
        cell_data,
    )  # fmt: skip


def vtk_cells(elements: Elements) -> tuple[Array, int]:
    """Return the nodes (e, k) of elements in the order of VTK's cells, and their type."""
    corners, quadratic = elements.cells, elements.edge_order == 2
    if corners.shape[1] == 4:
        between: tuple[tuple[int, ...], ...] = TETRAHEDRON_EDGES
        kind = QUADRATIC_TETRAHEDRON if quadratic else TETRAHEDRON
    else:
        between = (*HEXAHEDRON_EDGES, *HEXAHEDRON_SIDES)
        kind = TRIQUADRATIC_HEXAHEDRON if quadratic else HEXAHEDRON
    if not quadratic:
        return corners, kind
    own = elements.connectivity
    at = elements.nodes[own]
    found = [corners]
    for group in between:
        place = elements.nodes[corners[:, list(group)]].mean(1)
        nearest = np.argmin(np.linalg.norm(at - place[:, None], axis=2), axis=1)
        found.append(own[np.arange(len(own)), nearest][:, None])
    return np.concatenate(found, axis=1), kind


def element_means(result: Result, b: int) -> Array:
    """Return the mean stress of each element of an elastic body (e, s) [kN/m2]."""
    elements = result.assembly.disc.shapes[result.assembly.disc.shape_of[b]].elements
    _, values = result.stress.at_points(b)
    count = len(elements.cells)
    volume = np.bincount(elements.cell_of_point, elements.weights, count)
    weighted = elements.weights[:, None] * values
    columns = [np.bincount(elements.cell_of_point, weighted[:, k], count) / volume for k in range(values.shape[1])]
    return np.column_stack(columns)
