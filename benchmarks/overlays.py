"""How often overlays of polygons in floating point fail, what that does to an answer, and what the check costs.

    python benchmarks/overlays.py [--pairs 100000] [--only count|turned|cost]

Random triangles in pairs, displaced against each other by 1e-16: two that share a side, which have no area in common,
and equal ones, which have all of it. An overlay has failed where its area is wrong by more than 1e-6; counted for
GEOS in floating point, for GEOS on a grid, and for ``concio.model.overlay``. Then a barrel of blocks of six-node
triangles on their faces (T10), turned in space, and the assembly of a dome of 2,160 blocks, each with the check and
without it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from unittest.mock import patch

import numpy as np
import shapely
from space_exactness import ELEMENTS, differences, structures

import concio
from concio.model import overlay

WRONG = 1e-6
"""Error of an area, over the right one if there is any, from which on an overlay has failed."""

DISPLACED = 1e-16


def triangles(pairs: int, rng: np.random.Generator) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return pairs of triangles by name: such as share a side, and equal ones of at least 1e-3 in area."""
    a, b = rng.normal(size=(2, pairs, 2))
    along = b - a
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)

    def apex(side: float) -> np.ndarray:
        at: np.ndarray = (a + b) / 2 + side * normal * rng.uniform(0.3, 1, (pairs, 1))
        return at + along * rng.uniform(-0.4, 0.4, (pairs, 1))

    def moved(x: np.ndarray) -> np.ndarray:
        return x + rng.normal(size=x.shape) * DISPLACED

    c, d = apex(1.0), apex(-1.0)
    equal = rng.normal(size=(pairs, 3, 2))
    first = shapely.polygons(equal)
    large = shapely.area(first) > 1e-3
    beside = (np.stack([a, b, c], axis=1), np.stack([moved(b), moved(a), d], axis=1))
    return {
        "share a side": (shapely.polygons(beside[0]), shapely.polygons(beside[1])),
        "equal": (first[large], shapely.polygons(moved(equal))[large]),
    }


def count(pairs: int) -> None:
    """Print how many overlays fail, and their time."""
    print(f"shapely {shapely.__version__}, GEOS {shapely.geos_version_string}")
    print("| pairs of triangles | number | overlay | failed | largest error of the others | s |\n" + 6 * "|---" + "|")
    ways: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
        "floating point": shapely.intersection,
        "on a grid": lambda p, q: shapely.intersection(p, q, grid_size=1e-13),
        "checked": overlay.common,
    }
    for name, (p, q) in triangles(pairs, np.random.default_rng(0)).items():
        right = np.zeros(len(p)) if name == "share a side" else shapely.area(p)
        for way, cut in ways.items():
            begin = time.process_time()
            found = cut(p, q)
            seconds = time.process_time() - begin
            error = np.abs(shapely.area(found) - right) / np.where(right > 0, right, 1.0)
            failed = error > WRONG
            rest = float(error[~failed].max())
            print(f"| {name} | {len(p):,} | {way} | {failed.sum():,} | {rest:.0e} | {seconds:.2f} |", flush=True)


@contextmanager
def unchecked() -> Iterator[None]:
    """Make overlays in floating point alone."""
    with patch.object(overlay, "_checked", lambda cut, first, second: np.asarray(cut(first, second))):
        yield


def turned() -> None:
    """Print what turning changes in a barrel."""
    build = structures(element="T10", mesh_size=ELEMENTS["T10"])["barrel"]
    for word, around in (("unchecked", unchecked), ("checked", nullcontext)):
        with around():
            outcome, pairs, moved, normal, friction = differences(build())
        print(
            f"barrel of T10 turned, overlays {word}: {outcome}, {pairs} pairs, displacements differ by {moved:.0e},"
            f" normal forces by {normal:.0e}, friction by {friction:.0e}",
            flush=True,
        )


def cost(runs: int = 3) -> None:
    """Print the seconds to assemble a dome, the least of some runs taken by turns."""
    model = concio.dome(span=10, ring=0.4, courses=30, blocks=72, block="rigid", horizontal=0.1)
    spent: dict[str, list[float]] = {"checked": [], "unchecked": []}
    for _ in range(runs):
        for word, seconds in spent.items():
            begin = time.process_time()
            if word == "checked":
                concio.assemble(model)
            else:
                with unchecked():
                    concio.assemble(model)
            seconds.append(time.process_time() - begin)
    best = {word: min(seconds) for word, seconds in spent.items()}
    print(
        f"dome of {sum(b.kind != 'fixed' for b in model.bodies)} blocks assembled: checked {best['checked']:.2f} s,"
        f" unchecked {best['unchecked']:.2f} s, ratio {best['checked'] / best['unchecked']:.2f}"
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=100_000)
    parser.add_argument("--only", choices=("count", "turned", "cost"))
    arguments = parser.parse_args()
    parts = {"count": lambda: count(arguments.pairs), "turned": turned, "cost": cost}
    for name, part in parts.items():
        if arguments.only in (None, name):
            part()


if __name__ == "__main__":
    main()
