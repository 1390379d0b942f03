"""A column of three drums under two pulses: one rocks it and lets its drums twist, the stronger one throws it down.

Drums of twelve sides, 0.8 m wide and 3.2 m high together, on dry joints. A pulse of the ground in two directions lifts
them off at their rims: they rock, wobble from corner to corner of their feet and twist on each other. A pulse of twice
the size and twice the length turns them over.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import concio
from concio.plot.motion_figure import plot_frame


def main(figure: Path | None = None) -> dict[str, float]:
    """Shake, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    column = concio.drums(diameter=0.8, height=3.2, drums=3, sides=12, block="rigid", unit_weight=25.0, friction=0.7)
    runs = []
    for size, length in ((0.35, 0.4), (0.7, 0.8)):
        along = concio.Pulse("half sine", size * 9.81, length)
        ground = {"x": along, "y": concio.Pulse("sine", 0.5 * size * 9.81, length)}
        runs.append(concio.dynamics(column, ground, duration=2.5, step=5e-3))
        print(f"{size:g} g: {runs[-1].verdict.sentence}")
    if figure:
        from matplotlib.figure import Figure

        sheet = Figure(figsize=(9.0, 5.0), layout="constrained")
        for run, axes in zip(runs, sheet.subplots(1, 2), strict=True):
            plot_frame(run, -1, axes)
        sheet.savefig(figure)
    return {
        "stands": float(not runs[0].fallen), "falls": float(bool(runs[1].fallen)),
        "energy": max(run.energy.error for run in runs), "worst": max(run.certificate for run in runs),
        "turned": float(np.rad2deg(runs[0].turned.max())),
    }  # fmt: skip


if __name__ == "__main__":
    main()
