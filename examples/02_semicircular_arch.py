"""A semicircular arch under its own weight: thrust, hinges, and how thin it may be.

Milankovitch: without sliding the ring must be at least 0.1075 of the centreline radius thick. Below that a mechanism of
five hinges proves that no equilibrium exists.
"""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""

    def arch(ratio: float) -> concio.Model:
        return concio.arch(span=2 - ratio, ring=ratio, voussoirs=21, block="rigid", friction=1.0)

    thick = concio.solve(arch(0.15))
    thin = concio.solve(arch(0.09), on_failure="return")
    print(f"t/R = 0.15: {thick.status.value}")
    print(f"t/R = 0.09: {thin.status.value}")
    if figure:
        thin.plot.mechanism().figure.savefig(figure)
    return {
        "thick": float(thick.solved),
        "thin falls": float(thin.status is concio.Status.NO_EQUILIBRIUM),
        "power": thin.mechanism.power if thin.mechanism else 0.0,
        "weight": -thick.total_load[1],
        "reaction": thick.reactions["left abutment"][1],
    }


if __name__ == "__main__":
    main()
