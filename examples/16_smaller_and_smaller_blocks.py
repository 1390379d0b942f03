"""A wall of fixed outline with smaller and smaller blocks: its limit load approaches that of the continuum.

A dry wall of 3.2 x 2.1 m, friction 0.65, pushed by a share of its weight. Large blocks interlock better than the
material they stand for: taken for a homogenised continuum the wall would carry between 0.39 (a field of stresses
proves it) and 0.42 (a mechanism), with blocks of 0.8 x 0.35 m it carries 0.65. What is left halves with the blocks.
"""

from __future__ import annotations

from pathlib import Path

import concio


def wall(times: int) -> concio.Model:
    """Return the wall with blocks so many times smaller."""
    return concio.wall(
        length=3.2, height=2.1, block_size=(0.8 / times, 0.35 / times), friction=0.65, block="rigid", horizontal=1.0
    )


def main(figure: Path | None = None, sizes: tuple[int, ...] = (1, 2, 4, 8)) -> dict[str, float]:
    """Solve, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    found = concio.halve_blocks(wall, sizes=sizes, elastic=False)
    low, high = found.bracket
    for times, load in zip(found.sizes, found.associated, strict=True):
        print(f"blocks of {0.8 / times:.2f} x {0.35 / times:.4f} m: {load:.4f}")
    print(f"continuum: between {low:.4f} and {high:.4f}")
    if figure:
        found.plot.limit().figure.savefig(figure)
    return {"low": low, "high": high, **{str(n): load for n, load in zip(found.sizes, found.associated, strict=True)}}


if __name__ == "__main__":
    main()
