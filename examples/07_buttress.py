"""How much thrust a buttress takes: bracket of the associated bound and of what one step still carries."""

from __future__ import annotations

from pathlib import Path

import concio
from concio.analysis.limit import limit


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    model = concio.buttress(base=1.2, top=0.6, height=3.0, courses=8, thrust=1.0, block="rigid", friction=0.6)
    found = limit(model, path=False)
    bound = found.associated.multiplier
    held = concio.solve(model, factors={"live": 0.9 * bound})
    fallen = concio.solve(model, factors={"live": 1.01 * bound}, on_failure="return")
    print(f"associated bound {bound:.3f} kN; at 0.9 of it: {held.status.name}; at 1.01 of it: {fallen.status.name}")
    if figure:
        fallen.plot.mechanism().figure.savefig(figure)
    return {
        "bound": bound,
        "gap": found.associated.gap,
        "held": float(held.solved),
        "falls": float(fallen.status is concio.Status.NO_EQUILIBRIUM),
    }


if __name__ == "__main__":
    main()
