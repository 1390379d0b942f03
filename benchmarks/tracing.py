"""Walls drawn as pictures, traced back and solved: how many blocks are found again, and how far the multiplier is off.

    python benchmarks/tracing.py [SEED]

Twenty walls in running bond, Flemish bond, a lap of a third and with long units, at contrasts of joints from 0.25 to
0.03 (grey values 0 to 1; noise of pixels 0.03, grain 0.02, stones among each other 0.02), traced by courses with a unit
that is 10 % too long and 10 % too low. F1 counts blocks that overlap by 70 %. The multiplier is the associated bound of
a horizontal share of the weights, of the wall and of what was traced. The same walls from seeds at the contrasts at
which joints are clear. Then eight pictures of walls with which nothing was tuned. Rubble by eight clicks on the outline
of each stone, up to three pixels beside it: the share of the area that stone and outline have in common. Last the
photograph of bricks in `examples`, taken askew: its joints were read by hand.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import numpy as np
import shapely

import concio
from concio.trace import trace_courses, trace_outlines, trace_regions
from rendered import bricks, found_share, read_bricks, rendered, sideways

CONTRASTS = (0.25, 0.12, 0.08, 0.05, 0.03)
WALLS = {
    "running": {"block_size": (0.25, 0.125), "length": 2.0, "height": 1.25},
    "flemish": {"block_size": (0.24, 0.12), "length": 1.92, "height": 1.2, "bond": "flemish"},
    "third": {"block_size": (0.30, 0.15), "length": 2.4, "height": 1.2, "lap": 1 / 3},
    "long": {"block_size": (0.40, 0.20), "length": 2.4, "height": 1.4},
}


OTHERS = {
    "roman": ({"block_size": (0.30, 0.075), "length": 1.8, "height": 0.9}, (0.33, 0.068),
              {"contrast": 0.10, "joint": 0.015, "pixel": 1 / 220, "light": True}),
    "ashlar": ({"block_size": (0.60, 0.30), "length": 3.6, "height": 2.4}, (0.55, 0.33),
               {"contrast": 0.06, "joint": 0.008, "pixel": 1 / 180}),
    "small": ({"block_size": (0.22, 0.11), "length": 1.54, "height": 1.1}, (0.24, 0.10),
              {"contrast": 0.15, "joint": 0.012, "pixel": 1 / 400, "light": True}),
    "wide": ({"block_size": (0.28, 0.14), "length": 2.24, "height": 1.4, "bond": "flemish"}, (0.25, 0.15),
             {"contrast": 0.05, "joint": 0.02, "pixel": 1 / 250}),
}  # fmt: skip
"""Walls that no setting was chosen with: units, guesses of them, joints and pixels are others."""


def main(seed: int) -> None:
    """Print a line for each wall and contrast."""
    print("wall      contrast     F1  multiplier     true     off  joint mm      s  seeds F1")
    for k, contrast in enumerate(CONTRASTS):
        for j, (name, given) in enumerate(WALLS.items()):
            model = wall(given)
            photo = rendered(model, contrast=contrast, seed=seed + 10 * k + j, light=j % 2 == 1)
            length, height = given["block_size"]
            begun = time.perf_counter()
            found = trace_courses(photo, (1.1 * length, 0.9 * height))
            seconds = time.perf_counter() - begun
            true, own = sideways(model), sideways(found.model())
            size = (length * height) ** 0.5
            clear = f"{found_share(trace_regions(photo, size, joint=0.01), model):>14.3f}" if k < 2 else ""
            told = f"{name:<9}{contrast:>9.2f}{found_share(found, model):>7.3f}{own:>12.5f}{true:>9.5f}"
            print(f"{told}{own / true - 1:>8.1%}{1e3 * found.joint_width:>10.1f}{seconds:>7.2f}{clear}", flush=True)
    for name, (given, unit, seen) in OTHERS.items():
        for more in (40401, 50507):
            model = wall(given)
            found = trace_courses(rendered(model, seed=seed + more, **seen), unit)
            off = sideways(found.model()) / sideways(model) - 1
            count = f"{len(found.outlines())} of {len(model.free_bodies)} blocks"
            print(f"not used for tuning, {name}: {count}, F1 {found_share(found, model):.3f}, multiplier {off:.1%} off")
    for contrast in CONTRASTS:
        print(f"rubble, eight clicks a stone, contrast {contrast:.2f}: median IoU {rubble(contrast, seed):.3f}")
    true, found = read_bricks(), trace_courses(bricks(), (0.22, 0.07))
    own, read = sideways(found.model()), sideways(true)
    count, traced, share = len(true.free_bodies), len(found.outlines()), found_share(found, true)
    told = f"multiplier {own:.5f}, {own / read - 1:.1%} off, joints of {1e3 * found.joint_width:.0f} mm"
    print(f"photograph of {count} bricks: {traced} traced, F1 {share:.3f}, {told}")


def rubble(contrast: float, seed: int) -> float:
    """Return the median share of area that stones of a rubble wall and their outlines have in common."""
    model = concio.rubble(length=1.5, height=1.0, stone=0.25, seed=3, block="rigid")
    photo = rendered(model, contrast=contrast, seed=seed)
    rng = np.random.default_rng(seed)
    low = np.min([b.outline.min(0) for b in model.free_bodies], axis=0)
    stones = [shapely.Polygon(b.outline - low) for b in model.free_bodies]
    clicks = []
    for stone in stones:
        on = [stone.exterior.interpolate(k / 8, normalized=True).coords[0] for k in range(8)]
        clicks.append((np.array(on) + 3.0 * photo.pixel * rng.uniform(-1.0, 1.0, (8, 2))).tolist())
    found = trace_outlines(photo, clicks, joint=0.01).outlines()
    shares = []
    for k, stone in enumerate(stones, 1):
        own = shapely.make_valid(shapely.Polygon(found[k])) if k in found else shapely.Polygon()
        shares.append(own.intersection(stone).area / own.union(stone).area)
    return float(np.median(shares))


def wall(given: dict) -> concio.Model:
    """Return a wall of rigid blocks."""
    return concio.wall(**given, block="rigid", unit_weight=20.0, friction=0.6)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 0)
