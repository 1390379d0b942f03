"""The corner of two walls falls out under a pulse along its diagonal: the bond tears in steps along both walls.

Two walls of dry blocks, 0.25 m thick and 2 m high, meet in a corner and are bonded there. The ground moves inwards
along the diagonal with 0.6 g in each direction, so that the walls are thrown outwards. A wedge of both walls parts
along the joints in steps, and what lies beyond turns after it. After 0.6 s no block stands where it stood.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import concio
from concio.plot.motion_figure import plot_frame


def main(figure: Path | None = None) -> dict[str, float]:
    """Shake, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    corner = concio.walls(
        lines=[{"start": (0, 0), "end": (2, 0)}, {"start": (0, 0), "end": (0, 2)}],
        height=2.0, block_size=(0.5, 0.25, 0.5), block="rigid", unit_weight=20.0, friction=0.9,
    )  # fmt: skip
    push = concio.Pulse("rectangular", 0.6 * 9.81, 0.4)
    run = concio.dynamics(corner, {"x": push, "y": push}, duration=0.6, step=6e-3, stop_overturned=False)
    print(run.verdict.sentence)
    moved = np.linalg.norm(run.end.centre - run.reference.disc.centroids, axis=1)
    free = run.reference.free
    print(f"{(moved[free] > 0.1).sum()} of {len(free)} blocks have moved by more than 0.1 m")
    if figure:
        from matplotlib.figure import Figure

        sheet = Figure(figsize=(11.0, 4.6), layout="constrained")
        left, right = sheet.subplots(1, 2)
        plot_frame(run, 0, left)
        plot_frame(run, -1, right)
        sheet.savefig(figure)
    return {
        "gone": float((moved[free] > 0.1).sum()), "of": float(len(free)), "energy": run.energy.error,
        "worst": run.certificate, "falls": run.ending.name == "COMPLETE" and bool(run.fallen),
    }  # fmt: skip


if __name__ == "__main__":
    main()
