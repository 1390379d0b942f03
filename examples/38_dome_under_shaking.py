"""A dome with an oculus shaken in two directions: its head joints open and close, its rings stay together, it rests.

A hemisphere of 4 m and 0.25 m of rigid blocks on dry joints, under one period of a sine in two directions, 0.3 s long.
In every step each block obeys its equations of motion with contact and friction. When the ground has stopped and
nothing moves, forces within friction that balance every block where it stands are found and certified.
"""

from __future__ import annotations

from pathlib import Path

import concio
from concio.plot.motion_figure import plot_frame


def main(figure: Path | None = None) -> dict[str, float]:
    """Shake, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    dome = concio.dome(
        span=4, ring=0.25, courses=3, blocks=8, oculus=1.0, block="rigid", unit_weight=20.0, friction=0.7
    )
    ground = {"x": concio.Pulse("sine", 1.0 * 9.81, 0.3, cycles=1.0), "y": concio.Pulse("sine", 0.5 * 9.81, 0.3)}
    run = concio.dynamics(dome, ground, step=5e-3)
    print(run.verdict.sentence)
    print(f"joints open by up to {1e3 * run.shots.opening.max():.2f} mm and slide by up to "
          f"{1e3 * abs(run.shots.slip).max():.2f} mm")  # fmt: skip
    if figure:
        from matplotlib.figure import Figure

        sheet = Figure(figsize=(11.0, 4.4), layout="constrained")
        left, right = sheet.subplots(1, 2)
        plot_frame(run, -1, left)
        right.plot(run.shots.time, 1e3 * run.shots.opening.max(axis=1), label="widest opening")
        right.plot(run.shots.time, 1e3 * abs(run.shots.slip).max(axis=1), label="largest slip")
        right.set(xlabel="time [s]", ylabel="[mm]", title="Joints")
        right.legend()
        sheet.savefig(figure)
    return {
        "rests": float(run.rests), "energy": run.energy.error, "worst": run.certificate,
        "opening": float(run.shots.opening.max()),
    }  # fmt: skip


if __name__ == "__main__":
    main()
