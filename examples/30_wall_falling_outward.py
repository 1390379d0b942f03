"""A facade that falls outward and pulls wedges of its side walls along: a mechanism in space proves it.

A facade of 4 m between two side walls, bonded at the corners, dry, friction 0.6, pushed outward by a share of its
weight. As a slab that turns about its foot it would fall at thickness over height, 0.1; the side walls hold it back,
and when it goes at last it tears stepped wedges out of them.
"""

from __future__ import annotations

from pathlib import Path

import concio


def main(figure: Path | None = None) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    model = concio.walls(
        lines=[((0, 0), (0, 4)), ((0, 0), (2.5, 0)), ((0, 4), (2.5, 4))], height=2.5, block_size=(0.5, 0.25, 0.25),
        block="rigid", friction=0.6, horizontal=1.0, towards=(-1, 0),
    )  # fmt: skip
    alone = concio.limit(concio.place(model, without=["w2-*", "w3-*"]), path=False, steps=False, search=False)
    bonded = concio.limit(model, path=False, steps=False, search=False)
    first, second = alone.associated.multiplier, bonded.associated.multiplier
    print(f"multiplier of the facade alone {first:.4f}, bonded {second:.4f}")
    falls = concio.solve(model, factors={"live": 0.4}, on_failure="return")
    print(falls.sentence)
    if figure:
        falls.plot.mechanism().figure.savefig(figure)
    return {
        "alone": first, "bonded": second, "falls": float(falls.status is concio.Status.NO_EQUILIBRIUM)
    }  # fmt: skip


if __name__ == "__main__":
    main()
