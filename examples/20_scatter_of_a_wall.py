"""Friction and the places of head joints scatter, and with them what a wall can carry.

Every run draws a friction coefficient and moves each head joint a little, as masons do. The limit load of the wall
under a horizontal share of its weight scatters; what matters is seen by rank correlation.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

import concio

LENGTH, COURSES, BLOCK = 3.0, 10, (0.50, 0.25)


def wall(row: dict[str, float]) -> concio.Model:
    """Return a dry wall on the ground; ``row["scatter"]`` is the standard deviation of its head joints' places."""
    rng = np.random.default_rng(row["seed"])
    ground = concio.Body("ground", ((-1, -0.3), (LENGTH + 1, -0.3), (LENGTH + 1, 0), (-1, 0)), kind="fixed")
    bodies = [ground]
    for course in range(COURSES):
        inner = np.arange(BLOCK[0] if course % 2 else 0.5 * BLOCK[0], LENGTH - 0.1, BLOCK[0])
        inner = inner + np.clip(rng.normal(0.0, row["scatter"], len(inner)), -0.1, 0.1)
        ends = [0.0, *inner, LENGTH]
        low, high = course * BLOCK[1], (course + 1) * BLOCK[1]
        for k, (a, b) in enumerate(pairwise(ends)):
            outline = ((a, low), (b, low), (b, high), (a, high))
            bodies.append(concio.Body(f"{course}-{k}", outline, material="stone", kind="rigid"))
    return concio.Model(
        bodies=tuple(bodies),
        materials={"stone": concio.Rigid(unit_weight=22.0)},
        laws={"dry": concio.JointLaw(friction=row["mu"])},
        rules=(concio.JointRule("dry"),),
        loads=(concio.Load("weight", (0, -1)), concio.Load("weight", (1, 0), group="live")),
    )


def main(figure: Path | None = None, size: int = 60) -> dict[str, float]:
    """Run the study, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    variables = [
        concio.variable("mu", "normal", mean=0.6, sd=0.06, low=0.3),
        concio.variable("scatter", "uniform", low=0.0, high=0.05),
    ]
    found = concio.study(wall, variables, "associated_multiplier", size=size, seed=1)
    even = concio.limit(wall({"mu": 0.6, "scatter": 0.0, "seed": 0}), path=False, search=False)
    print(f"even bond, mu 0.6: {even.associated.multiplier:.4f} of the weight")
    low, middle, high = np.quantile(found.values("associated_multiplier"), (0.05, 0.5, 0.95))
    print(f"{len(found)} walls: median {middle:.4f}, 5 to 95 % from {low:.4f} to {high:.4f}")
    print(f"less than 0.3: probability {found.probability('associated_multiplier', below=0.3)}")
    matters = found.sensitivity("associated_multiplier")
    for name, share in zip(matters.names, matters.first, strict=True):
        print(f"  rank correlation with {name}: {share:+.2f}")
    if figure:
        found.plot.scatter("mu", "associated_multiplier").figure.savefig(figure)
    return {"even": even.associated.multiplier, "median": middle, "mu": matters.first[0], "failed": len(found.failures)}


if __name__ == "__main__":
    main()
