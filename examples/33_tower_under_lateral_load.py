"""A tower pushed sideways: it turns about its far edge and leaves a stepped part of the side it is pushed from behind.

A tower of 2.4 x 2.4 x 6 m with walls of 0.3 m, dry, friction 0.6. As one rigid body it would overturn at width over
height, 0.4; made of blocks it comes apart before: what is not lifted does not hold.
"""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    model = concio.tower(
        width=2.4, depth=2.4, height=6, block_size=(0.6, 0.3, 0.3), block="rigid", friction=0.6, horizontal=1.0
    )
    limit = concio.limit(model, path=False, steps=False, search=False)
    stands = concio.solve(model, factors={"live": 0.22})
    falls = concio.solve(model, factors={"live": 0.4}, on_failure="return")
    print(f"overturning as one body 0.4000, as blocks at most {limit.associated.multiplier:.4f}")
    print(f"0.22: {stands.sentence}")
    print(f"0.40: {falls.sentence}")
    if figure:
        falls.plot.mechanism().figure.savefig(figure)
    return {
        "worst": stands.certificate.worst, "bound": limit.associated.multiplier,
        "falls": float(falls.status is concio.Status.NO_EQUILIBRIUM),
    }  # fmt: skip


if __name__ == "__main__":
    main()
