"""Motions for ParaView: one VTU file a frame with the bodies where they stand, and a PVD file with their times."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.arguments import strict
from concio.io.paraview import outline_cells
from concio.io.vtu import POLYGON, QUAD, TRIANGLE, Grid, write_pvd, write_vtu
from concio.post.motion_frames import positions

Array = np.ndarray

KINDS = {"elastic": 0, "rigid": 1, "fixed": 2}


@strict
def write_motion_series(result: PushResult | DynamicsResult, directory: Path | str, *, most: int = 500) -> list[Path]:
    """Write ``motion.pvd`` with a VTU file for each frame.

    Parameters
    ----------
    result : PushResult or DynamicsResult
    directory : Path or str
        Made where it is missing.
    most : int
        Frames at most, evenly chosen.

    Returns
    -------
    list of Path
        The PVD file first. Times are seconds, or controlled displacements of a push.
    """
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    at, _ = positions(result)
    chosen = np.unique(np.linspace(0, len(at) - 1, min(most, len(at))).round().astype(int)).tolist()
    written = [write_vtu(moved_grid(result, k), directory / f"motion_{i:04d}.vtu") for i, k in enumerate(chosen)]
    return [write_pvd(written, at[chosen].tolist(), directory / "motion.pvd"), *written]


def moved_grid(result: PushResult | DynamicsResult, number: int) -> Grid:
    """Return all bodies where they stand in a frame: elements of elastic ones, polygons or triangles of the others.

    Point data: ``displacement`` [m]. Cell data: ``body`` (number), ``kind`` (0 elastic, 1 rigid, 2 fixed).
    """
    reference, standing = result.reference, result.configuration(number)
    model, disc = reference.model, reference.disc
    places, moved, cells, sizes, types, owner = [], [], [], [], [], []
    total = 0
    for b, s in enumerate(disc.shape_of.tolist()):
        if s >= 0:
            here, rest = standing.nodes(b), disc.nodes(b)
            own = disc.shapes[s].elements.cells
            kind = QUAD if own.shape[1] == 4 else TRIANGLE
        elif model.dim == 3:
            here, rest, own = standing.vertices(b), model.polyhedra[b].vertices, model.polyhedra[b].triangles[0]
            kind = TRIANGLE
        else:
            here, rest = np.concatenate(standing.rings(b)), np.concatenate(model.outlines[b].rings)
            own = outline_cells(model.outlines[b].rings)
            kind = TRIANGLE if model.outlines[b].holes else POLYGON
        places.append(here)
        moved.append(here - rest)
        cells.append((own + total).ravel())
        sizes.append(np.full(len(own), own.shape[1]))
        types.append(np.full(len(own), kind))
        owner.append(np.full(len(own), b))
        total += len(here)
    body = np.concatenate(owner)
    kinds = np.array([KINDS[b.kind] for b in model.bodies])
    return Grid(
        np.concatenate(places), np.concatenate(cells), np.cumsum(np.concatenate(sizes)), np.concatenate(types),
        {"displacement": np.concatenate(moved)}, {"body": body.astype(np.int32), "kind": kinds[body].astype(np.int32)},
    )  # fmt: skip
