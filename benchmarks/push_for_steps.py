"""Mechanisms in space: limit analysis in steps beside a push of the same blocks at large displacements.

    python benchmarks/push_for_steps.py [NAME ...]

Of each wall the weakest mechanism is followed in steps, as assessments do, and the blocks that move in it are pushed,
all others held, by the displacement of the same control point. Times are CPU times of this process.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import concio
from concio.analysis.seismic.directions import pushes
from concio.analysis.seismic.examine import Prepared, prepared
from concio.analysis.seismic.sequence import follow_in_steps
from concio.analysis.seismic.weakest_mechanism import Mechanisms
from concio.contact.assembly import assemble

WALLS = {
    "low corner": ([((0, 0), (0, 1.0)), ((0, 0), (1.0, 0))], 0.5, "-x"),
    "tall corner": ([((0, 0), (0, 1.5)), ((0, 0), (1.5, 0))], 1.5, "-x"),
    "tall corner, diagonal": ([((0, 0), (0, 1.5)), ((0, 0), (1.5, 0))], 1.5, "-x-y"),
    "wall in its plane": ([((0, 0), (1.5, 0))], 2.0, "+x"),
    "wall with two returns": ([((0, 1.0), (0, 0)), ((0, 0), (2.0, 0)), ((2.0, 0), (2.0, 1.0))], 1.5, "-y"),
}
"""Lines of the walls, height, and direction of the push."""


def main() -> None:
    """Compare both for all walls, or for those named."""
    for name in sys.argv[1:] or WALLS:
        lines, height, way = WALLS[name]
        model = concio.walls(
            lines=lines, height=height, block_size=(0.5, 0.25, 0.25), block="rigid", friction=0.6
        )
        (push,) = pushes(model, way, ())
        assembly = assemble(push.model)
        found = Mechanisms(assembly, push.groups, push.sign).find()
        ready = prepared(assembly, found, push, name, None)
        begun = time.process_time()
        steps = follow_in_steps(ready.sequence, ready.multiplier)
        spent = time.process_time() - begun
        print(f"{name}: {len(model.bodies)} bodies, {found.flow}, alpha_0 {ready.multiplier:.4f}", flush=True)
        print(f"  steps: {len(steps.displacement)} points to {steps.end:.4f} m ({steps.reason}), {spent:.0f} s")
        pushed(ready)


def pushed(ready: Prepared) -> None:
    """Push the blocks of a mechanism and print how far that goes."""
    model, mechanics = ready.push.model, ready.found.mechanics
    assert mechanics is not None
    bodies = tuple(b if i in mechanics.of_body else replace(b, kind="fixed") for i, b in enumerate(model.bodies))
    body, at = ready.control
    along = tuple(ready.sequence.control[2].tolist())
    begun = time.process_time()
    found = concio.push(
        replace(model, bodies=bodies), control=concio.ControlPoint(body, at, along), live=ready.push.groups
    )
    spent = time.process_time() - begun
    print(
        f"  push: {len(mechanics.of_body)} blocks, {len(found)} points to {found.displacement[-1]:.2g} m "
        f"({found.ending.name.lower()}), peak {found.peak:.4f}, {spent:.0f} s", flush=True,
    )  # fmt: skip


if __name__ == "__main__":
    main()
