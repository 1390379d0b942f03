"""Pictures and films of motions in space, in a fixed view."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.plot.space_figures import block_colours, directions, draw_solids
from concio.post.solid_frames import SolidFrames, solid_frames

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

VIEW: Literal["axonometry"] = "axonometry"
"""From where motions are examined."""

POINTS = 800
"""Points along the longer side of a frame."""


def draw_frame(result: PushResult | DynamicsResult, seen: SolidFrames, k: int, ax: Axes, box: Array) -> Axes:
    """Draw a frame within a box of the view ((x0, y0), (x1, y1)) [m]."""
    title = result.model.title or "Motion"
    moved = seen.moved(k)
    colours = block_colours(result.model)
    ax, _ = draw_solids(moved, colours, VIEW, ax, 1.0, title, note=seen.words[k], box=box, longer=POINTS)
    return ax


def seen_box(result: PushResult | DynamicsResult, seen: SolidFrames) -> Array:
    """Return the box of the view (2, 2) around what moves in all frames [m]."""
    moving = np.array([body.kind != "fixed" for body in result.model.bodies])
    low, high = seen.box(moving)
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    right, up, _ = directions(VIEW)
    flat = corners @ np.column_stack([right, up])
    return np.array([flat.min(axis=0), flat.max(axis=0)])


def painter(result: PushResult | DynamicsResult, most: int) -> tuple[int, Array, Callable[[Axes, int], Axes]]:
    """Return how many frames a motion has, the box of its pictures (2, 2), and what draws one into axes."""
    seen = solid_frames(result, most)
    box = seen_box(result, seen)
    return len(seen.at), box, lambda ax, k: draw_frame(result, seen, k, ax, box)
