"""Four bonds under the same horizontal share of their weight: how much each can carry (associated bound)."""

from __future__ import annotations

from pathlib import Path

import concio
from concio.analysis.limit import limit


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    found = {}
    for bond in ("stack", "running", "english", "flemish"):
        model = concio.wall(length=1.5, height=1.0, bond=bond, block="rigid", friction=0.65, horizontal=1.0)
        found[bond] = limit(model, path=False).associated.multiplier
        print(f"{bond:8s} {found[bond]:.4f}")
    if figure:
        model = concio.wall(length=1.5, height=1.0, bond="flemish", block="rigid", friction=0.65, horizontal=1.0)
        fallen = concio.solve(model, factors={"live": 1.05 * found["flemish"]}, on_failure="return")
        fallen.plot.mechanism().figure.savefig(figure)
    return found


if __name__ == "__main__":
    main()
