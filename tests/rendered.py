"""Pictures of walls whose blocks are known: stones and joints of a given contrast, uneven light, grain and noise."""

from __future__ import annotations

import numpy as np
import shapely
from scipy import ndimage

import concio
from concio.trace import Photo, Tracing

Array = np.ndarray


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
