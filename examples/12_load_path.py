"""A block pushed and released: friction depends on the load history. Exact load path, event by event."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import concio
from concio.analysis.path import ControlPoint, Stage, run_path


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    block = concio.column(width=0.4, height=0.2, blocks=1, friction=0.5, unit_weight=20, mesh_size=0.1)
    push = concio.Load("traction", (5.0, 0.0), edge=((-0.2, 0.0), (-0.2, 0.2)), group="push")
    model = replace(block, loads=(*block.loads, push))
    path = run_path(
        model,
        [Stage("weight", {"dead": 1.0}), Stage("push", {"push": 0.7}), Stage("released", {"push": 0.0})],
    )
    top = ControlPoint("b01", (0.2, 0.2))
    shift, _ = path.curve(top)
    print(
        f"{len(path.events)} events; the top stays {1e6 * (shift[-1] - shift[0]):.4f} micrometres from where it began"
    )
    if figure:
        import matplotlib.pyplot as plt

        _, axes = plt.subplots()
        axes.plot(1e6 * shift, [step.factors["push"] for step in path.steps], "o-", ms=3)
        axes.set(xlabel="displacement of the top [micrometres]", ylabel="factor of the push")
        axes.figure.savefig(figure)
    return {
        "certificate": path.certificate,
        "energy": path.energy_error,
        "complete": float(path.complete),
        "events": len(path.events),
        "left": float(shift[-1] - shift[0]),
    }


if __name__ == "__main__":
    main()
