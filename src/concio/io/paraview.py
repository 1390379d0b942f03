"""Results for ParaView: the bodies with displacements and stresses, the contact pairs with forces, gaps and states.

Stresses are tension positive, normal forces and pressures compression positive, all in kN and m. Displacements of the
bodies are point data, so that "Warp By Vector" shows the deformed shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.fem.constitutive import principal
from concio.fem.triangulate import bare_triangles
from concio.io.volume_grid import KINDS, element_means, volume_grid
from concio.io.vtu import POLYGON, QUAD, TRIANGLE, VERTEX, Grid, write_pvd, write_vtu

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

VECTORS = {"friction_force": "friction_vector", "shear": "shear_stress_vector", "slip": "slip_vector"}
"""Names of vectors in the axes of the model, by that of their components along tangents."""


def bodies_grid(result: Result) -> Grid:
    """Return all bodies as elements; rigid and fixed ones are one polygon each. In space see :func:`volume_grid`.

    Point data: ``displacement`` [m], ``stress`` (s_x, s_y, t_xy) at nodes [kN/m2], ``velocity`` of a mechanism. Cell
    data: ``body`` (number), ``kind`` (0 elastic, 1 rigid, 2 fixed), mean ``element_stress``, ``s_1``, ``s_2`` of each
    element, ``body_s_1``, ``body_s_2`` of each body; nan where a body has no stress.
    """
    if result.model.dim == 3:
        return volume_grid(result)
    disc, model = result.assembly.disc, result.model
    solved, velocity = result.solved, result.mechanism_velocity
    points, moved, stress, speed = [], [], [], []
    cells, sizes, types, owner, means = [], [], [], [], []
    total = 0
    for b, s in enumerate(disc.shape_of):
        nodes = disc.nodes(b)
        points.append(nodes)
        moved.append(result.node_displacement(b) if solved else np.zeros_like(nodes))
        if velocity is not None:
            still = model.bodies[b].kind == "fixed"
            speed.append(np.zeros_like(nodes) if still else result.node_displacement(b, velocity))
        if s >= 0:
            el = disc.shapes[s].elements
            k = el.cells.shape[1]
            cells.append((el.cells + total).ravel())
            sizes.append(np.full(len(el.cells), k))
            types.append(np.full(len(el.cells), QUAD if k == 4 else TRIANGLE))
            nodal, mean = np.full((len(nodes), 3), np.nan), np.full((len(el.cells), 3), np.nan)
            if solved:
                nodal, mean = result.stress.at_nodes(b), element_means(result, b)
            stress.append(nodal)
            means.append(mean)
        else:
            own = outline_cells(model.outlines[b].rings)
            cells.append((own + total).ravel())
            sizes.append(np.full(len(own), own.shape[1]))
            types.append(np.full(len(own), TRIANGLE if model.outlines[b].holes else POLYGON))
            stress.append(np.full((len(nodes), 3), np.nan))
            means.append(np.full((len(own), 3), np.nan))
        owner.append(np.full(len(types[-1]), b))
        total += len(nodes)
    body = np.concatenate(owner)
    element = np.vstack(means)
    s1, s2, _ = principal(element)
    kind = np.array([KINDS[b.kind] for b in model.bodies], dtype=np.int32)
    cell_data: dict[str, Array] = {
        "body": body.astype(np.int32), "kind": kind[body], "element_stress": element, "s_1": s1, "s_2": s2
    }  # fmt: skip
    if solved:
        mean1, mean2, _ = result.stress.principal
        cell_data |= {"body_s_1": mean1[body], "body_s_2": mean2[body]}
    point_data: dict[str, Array] = {"displacement": np.vstack(moved), "stress": np.vstack(stress)}
    if velocity is not None:
        point_data["velocity"] = np.vstack(speed)
    return Grid(
        np.vstack(points), np.concatenate(cells), np.cumsum(np.concatenate(sizes)), np.concatenate(types), point_data,
        cell_data,
    )  # fmt: skip


def outline_cells(rings: Sequence[Array]) -> Array:
    """Return the cells (k, n) that draw a body without elements: one polygon, or triangles where it has holes."""
    return np.arange(len(rings[0]))[None] if len(rings) == 1 else bare_triangles(rings)


def contacts_grid(result: Result) -> Grid:
    """Return the contact pairs as points with all their numbers.

    Point data: ``state`` (0 open, 1 stick, 2 slip, 3 crushed), ``normal_force`` and the vector ``force`` on side b
    [kN], ``pressure`` [kN/m2], ``gap`` [m], ``normal``, ``area`` [m2; nan of ties], ``body_a``, ``body_b``,
    ``interface`` (-1 of ties).
    Of friction on side b [kN], shear stress [kN/m2] and slip [m] the vectors ``friction_vector``,
    ``shear_stress_vector``, ``slip_vector`` in the axes of the model, and the components along tangents:
    in the plane ``friction_force``, ``shear``, ``slip`` along ``tangent``; in space
    ``friction_force_1`` along ``tangent_1``, ``friction_force_2`` along ``tangent_2``, and so on.
    Without a solution the geometry alone.
    """
    pairs = result.assembly.pairs
    m = len(pairs)
    data: dict[str, Array] = {
        "normal": pairs.normal, "area": result.contacts.area,
        "interface": pairs.interface.astype(np.int32),
        "body_a": pairs.body_a.astype(np.int32), "body_b": pairs.body_b.astype(np.int32),
    }  # fmt: skip
    tails = [""] if pairs.tangents.shape[1] == 1 else ["_1", "_2"]
    data |= {f"tangent{tail}": pairs.tangents[:, k] for k, tail in enumerate(tails)}
    if result.solved:
        c = result.contacts
        data |= {
            "state": c.state.astype(np.int32), "normal_force": c.normal_force, "force": c.force_on_b,
            "pressure": c.pressure, "gap": c.gap,
        }  # fmt: skip
        for name, along in (("friction_force", c.friction_force), ("shear", c.shear), ("slip", c.slip)):
            data |= {f"{name}{tail}": along[:, k] for k, tail in enumerate(tails)}
            data[VECTORS[name]] = np.einsum("mt,mtd->md", along, pairs.tangents)
    return Grid(pairs.point, np.arange(m), np.arange(1, m + 1), np.full(m, VERTEX), data)


@strict
def write_paraview(
    results: Result | Sequence[Result], directory: Path | str, *, times: Sequence[float] | None = None
) -> list[Path]:
    """Write ``bodies.pvd`` and ``contacts.pvd`` with a pair of VTU files for each step.

    Parameters
    ----------
    results : Result or sequence of Result
    directory : Path or str
        Made where it is missing.
    times : sequence of float, optional
        Time of each step, growing; default 0, 1, 2... Load parameters do where they grow.

    Returns
    -------
    list of Path
        The two PVD files first.

    Raises
    ------
    InputError
        The number of times is not that of the steps.
    """
    steps = list(results) if isinstance(results, Sequence) else [results]
    stamps = [float(k) for k in range(len(steps))] if times is None else [float(t) for t in times]
    if len(stamps) != len(steps):
        msg = f"{len(stamps)} times were given for {len(steps)} steps"
        raise InputError(msg, hint="give one time for each step")
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    bodies = [write_vtu(bodies_grid(r), directory / f"bodies_{k:04d}.vtu") for k, r in enumerate(steps)]
    contacts = [write_vtu(contacts_grid(r), directory / f"contacts_{k:04d}.vtu") for k, r in enumerate(steps)]
    series = [
        write_pvd(bodies, stamps, directory / "bodies.pvd"),
        write_pvd(contacts, stamps, directory / "contacts.pvd"),
    ]
    return [*series, *bodies, *contacts]
