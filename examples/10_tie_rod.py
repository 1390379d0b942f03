"""Two stones lean on each other on smooth ground: they slide apart unless a tie rod holds their feet."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    left = np.array([[-1.0, 0.0], [-0.7, 0.0], [0.0, 1.0], [0.0, 1.3]])
    stones = (
        concio.Body("left", left, kind="rigid"),
        concio.Body("right", left[::-1] * [-1, 1], kind="rigid"),
    )
    ground = concio.Body("ground", np.array([[-1.2, -0.2], [1.2, -0.2], [1.2, 0.0], [-1.2, 0.0]]), kind="fixed")
    model = concio.Model(
        bodies=(ground, *stones),
        materials={"block": concio.Rigid(unit_weight=20)},
        laws={"joint": concio.JointLaw(friction=0.1)},
        loads=(concio.Load("weight", (0.0, -1.0)),),
    )
    tie = concio.Tie("tie", "left", (-0.8, 0.05), "right", (0.8, 0.05), stiffness=1e5)
    loose = concio.solve(model, on_failure="return")
    tied = concio.solve(replace(model, ties=(tie,)))
    stretched = tied.node_displacement("right")[0, 0] - tied.node_displacement("left")[0, 0]
    tension = float(tied.contacts.normal_force[tied.contacts.pairs.interface == -1][0])
    arm = -float(stones[0].centroid[0])
    weight = 20 * stones[0].area
    by_hand = weight * (0.7 - 0.1 * 1.3 - arm) / 1.25  # moments of the left stone about the crown (0, 1.3)
    print(f"without the tie: {loose.status.name}; with it: {tied.status.name}")
    print(f"tension {tension:.4f} kN, by hand {by_hand:.4f} kN")
    if figure:
        tied.plot.deformed().figure.savefig(figure)
    return {
        "loose falls": float(loose.status is concio.Status.NO_EQUILIBRIUM),
        "worst": tied.certificate.worst,
        "stretched": float(stretched),
        "tension": tension,
        "by hand": by_hand,
    }


if __name__ == "__main__":
    main()
