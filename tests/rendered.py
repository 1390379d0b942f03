"""Pictures of walls whose blocks are known: stones and joints of a given contrast, uneven light, grain and noise."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from scipy import ndimage

import concio
from concio.trace import Photo, Tracing, read_photo

Array = np.ndarray
BRICKS = Path(__file__).resolve().parents[1] / "examples" / "bricks.png"
"""A photograph of bricks with light joints, taken askew, its courses upright: 11 of them lie between these corners."""
CORNERS, SIZE = ((70.0, 2.0), (7.0, 508.0), (468.0, 508.0), (395.0, 2.0)), (0.907, 0.825)
"""On two bed joints [pixels], and what is between them with courses of 75 mm [m]."""
BEDS = (0.077, 0.153, 0.230, 0.305, 0.381, 0.455, 0.534, 0.608, 0.681, 0.751)
HEADS = (
    (0.194, 0.398, 0.599, 0.801), (0.142, 0.342, 0.542, 0.642, 0.839), (0.093, 0.295, 0.397, 0.597, 0.797),
    (0.033, 0.235, 0.437, 0.640, 0.845), (0.191, 0.295, 0.497, 0.697), (0.037, 0.139, 0.342, 0.544, 0.744),
    (0.094, 0.296, 0.401, 0.600, 0.798), (0.147, 0.347, 0.547, 0.749, 0.849), (0.094, 0.295, 0.496, 0.701),
    (0.038, 0.242, 0.341, 0.541, 0.742), (0.107, 0.209, 0.408, 0.607, 0.809),
)  # fmt: skip
"""Middles of the light bands, read on the flat picture course by course from below [m], without pieces below 10 mm."""


def rendered(
    model: concio.Model,
    *,
    contrast: float,
    seed: int,
    pixel: float = 1.0 / 300.0,
    joint: float = 0.01,
    light: bool = False,
) -> Photo:
    """Return a picture of a wall: each block keeps half a joint away from its outline.

    Parameters
    ----------
    model : Model
        Its free blocks are drawn.
    contrast : float
        Difference of grey between stones and joints, 0 to 1.
    seed : int
    pixel, joint : float
        Side of a pixel, width of the joints [m].
    light : bool
        Whether the joints are lighter than the stones.
    """
    rng = np.random.default_rng(seed)
    blocks = [b for b in model.bodies if b.kind != "fixed"]
    low = np.min([b.outline.min(0) for b in blocks], axis=0)
    high = np.max([b.outline.max(0) for b in blocks], axis=0)
    columns, rows = np.ceil((high - low) / pixel - 1e-9).astype(int)
    x, y = np.meshgrid(low[0] + (np.arange(columns) + 0.5) * pixel, high[1] - (np.arange(rows) + 0.5) * pixel)
    sign = 1.0 if light else -1.0
    grey = np.full((rows, columns), 0.5 + 0.5 * sign * contrast)
    for block in blocks:
        part = shapely.contains_xy(shapely.Polygon(block.outline).buffer(-0.5 * joint, join_style="mitre"), x, y)
        grey[part] = 0.5 - 0.5 * sign * contrast + 0.02 * rng.standard_normal()
    grey = ndimage.gaussian_filter(grey, 0.6) + 0.1 * (x - x.mean()) / np.ptp(x)
    grain = ndimage.gaussian_filter(rng.standard_normal(grey.shape), 2.0)
    return Photo(np.clip(grey + 0.02 * grain / grain.std() + 0.03 * rng.standard_normal(grey.shape), 0.0, 1.0), pixel)


def found_share(found: Tracing, model: concio.Model, overlap: float = 0.7) -> float:
    """Return the F1 of blocks: twice those found over those there are and those traced, found where they overlap so."""
    traced = [shapely.Polygon(ring) for ring in found.outlines().values()]
    low = np.min([b.outline.min(0) for b in model.bodies if b.kind != "fixed"], axis=0)
    true = [shapely.Polygon(b.outline - low) for b in model.bodies if b.kind != "fixed"]
    tree, hits = shapely.STRtree(traced), 0
    for one in true:
        near = [traced[k] for k in tree.query(one)]
        hits += any(p.intersection(one).area >= overlap * p.union(one).area for p in near)
    return 2.0 * hits / (len(true) + len(traced))


def sideways(model: concio.Model) -> float:
    """Return the share of the weights to the side at which a wall overturns: the associated bound."""
    push = concio.Load("weight", (1.0, 0.0), group="side")
    loaded = concio.Model(bodies=model.bodies, materials=model.materials, laws=model.laws, loads=(*model.loads, push))
    return concio.limit(loaded, "side", path=False, steps=False, search=False).associated.multiplier


def bricks() -> Photo:
    """Return the photograph, flat."""
    return read_photo(BRICKS).rectified(CORNERS, *SIZE)


def read_bricks() -> concio.Model:
    """Return the wall that was read on the photograph: rigid bricks on fixed ground."""
    boxes = {"ground": (0.0, -0.1, SIZE[0], 0.0)}
    levels = (0.0, *BEDS, SIZE[1])
    for c, heads in enumerate(HEADS):
        for k, (a, b) in enumerate(pairwise((0.0, *heads, SIZE[0]))):
            boxes[f"{c}.{k}"] = (a, levels[c], b, levels[c + 1])
    bodies = [
        concio.Body(name, np.array(shapely.box(*box).exterior.coords[:-1]), "stone",
                    kind="fixed" if name == "ground" else "rigid")
        for name, box in boxes.items()
    ]  # fmt: skip
    return concio.Model(
        bodies=tuple(bodies), materials={"stone": concio.Rigid(unit_weight=20.0)},
        laws={"joint": concio.JointLaw(friction=0.6)}, loads=(concio.Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
