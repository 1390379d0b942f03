"""How likely a free-standing pillar is to overturn, by the peak acceleration of the ground.

Pulses of half a sine scatter in their length, as earthquakes do; a study shakes the pillar, 0.3 x 1.8 m, with each,
and a lognormal fragility curve is fitted to what overturned. Short pulses need many times the acceleration that long
ones need: no single acceleration says whether a pillar stands.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import concio

WIDTH, HEIGHT, G = 0.3, 1.8, 9.81
ALPHA = float(np.arctan(WIDTH / HEIGHT))


def shaken(row: dict[str, float]) -> dict[str, float]:
    """Return the largest rotation over alpha under a half sine of ``peak`` g that lasts ``length`` seconds."""
    floor = concio.Body("floor", ((-4, -0.3), (4, -0.3), (4, 0), (-4, 0)), kind="fixed")
    pillar = concio.Body("pillar", ((0, 0), (WIDTH, 0), (WIDTH, HEIGHT), (0, HEIGHT)), material="stone", kind="rigid")
    model = concio.Model(
        bodies=(floor, pillar),
        materials={"stone": concio.Rigid(unit_weight=22.0)},
        laws={"dry": concio.JointLaw(friction=0.7)},
        rules=(concio.JointRule("dry"),),
        loads=(concio.Load("weight", (0, -1)),),
    )
    pulse = concio.Pulse("half sine", row["peak"] * G, row["length"])
    found = concio.dynamics(model, pulse, row["length"] + 1.5, row["length"] / 40, gravity=G, every=0.01)
    return dict(rotation=found.largest_rotation[1] / ALPHA)


def main(figure: Path | None = None, size: int = 60) -> dict[str, float]:
    """Run the study, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    variables = [
        concio.variable("peak", "uniform", low=0.17, high=0.6, unit="g"),
        concio.variable("length", "uniform", low=0.2, high=1.0, unit="s"),
    ]
    found = concio.study(shaken, variables, "rotation", "latin-hypercube", size=size, seed=2)
    curve = found.fragility("peak", "rotation", above=1.0)
    print(f"{len(found)} pulses: half of them overturn the pillar at {curve.median:.2f} g, beta {curve.beta:.2f}")
    print(f"it begins to rock at {np.tan(ALPHA):.3f} g")
    if figure:
        found.plot.fragility("peak", "rotation", above=1.0).figure.savefig(figure)
    share = found.probability("rotation", above=1.0).estimate
    return {"median": curve.median, "beta": curve.beta, "begins": float(np.tan(ALPHA)), "share": share}


if __name__ == "__main__":
    main()
