"""Assessments: processor seconds of whole sweeps, and what derivatives cost beside the solve they belong to.

python benchmarks/assessments.py [--sweeps] [--derivatives]

Prints, measured in one run, processor seconds: an assessment of the facade of ``examples/facade.toml`` (182 stones,
both senses, in its plane and out of it) and of a corner of 27 blocks in space; then, for states, limits and paths, the
seconds of the answer, of its derivatives with respect to every number of the model, their number, and the share.
Run it with OMP_NUM_THREADS=1.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import concio

EXAMPLES = Path(__file__).parent.parent / "examples"
HAZARD = {
    "SLD": {"a_g": 0.077, "F0": 2.41, "Tc": 0.28},
    "SLV": {"a_g": 0.205, "F0": 2.45, "Tc": 0.32},
    "SLC": {"a_g": 0.262, "F0": 2.47, "Tc": 0.33},
}


def seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the processor seconds of a call, and what it returns."""
    start = time.process_time()
    found = work()
    return time.process_time() - start, found


def facade() -> concio.Model:
    """Return the facade of the examples without its earthquake, which an assessment brings."""
    model = concio.load(EXAMPLES / "facade.toml")
    loads = tuple(load for load in model.loads if load.group != "live")
    return concio.Model(**{**{f: getattr(model, f) for f in model.__dataclass_fields__}, "loads": loads})


def corner() -> concio.Model:
    """Return a facade bonded to a return, six courses, 27 blocks."""
    return concio.walls(
        lines=[((0, 0), (0, 2.0)), ((0, 0), (1.5, 0))], height=3.0, block_size=(1.0, 0.25, 0.5), block="rigid",
        unit_weight=18.0, friction=0.6,
    )  # fmt: skip


def sweeps() -> None:
    """Assess and print."""
    site = concio.Site(HAZARD, soil="B", building={"height": 6.0, "storeys": 2})
    for name, model, more in (
        ("facade of 182 stones", facade(), {}),
        ("corner of 27 blocks, outwards", corner(), {"direction": "-x", "mechanisms": {"upper half": {"above": 1.5}}}),
    ):
        spent, found = seconds(lambda model=model, more=more: concio.assess(model, site=site, **more))
        followed = len(found.mechanisms) + len(found.others)
        print(f"{name}: {spent:.0f} s, {found.sought} searches in its own plane, {followed} mechanisms followed")
        print(f"    zeta_E {found.zeta:.4f} ({found.worst.name}, push {found.worst.direction})")


def derivatives() -> None:
    """Solve, differentiate and print."""
    rigid = {"block": "rigid", "friction": 0.6}
    brick = concio.wall(length=6.0, height=3.0, horizontal=0.1, **rigid)
    elastic = concio.wall(length=3.0, height=2.0, horizontal=0.1, friction=0.6)
    space = concio.walls(lines=[((0, 0), (0, 2)), ((0, 0), (2, 0))], height=1.5, block="rigid", friction=0.6)
    print(f"{'':34s} answer [s]  derivatives [s]  numbers  share")
    for name, solve, differentiate in (
        ("state, rigid wall", lambda: concio.solve(brick), concio.state_sensitivity),
        ("state, elastic wall", lambda: concio.solve(elastic), concio.state_sensitivity),
        ("state, facade of 182 stones", lambda: concio.solve(facade()), concio.state_sensitivity),
        ("state, corner in space", lambda: concio.solve(space), concio.state_sensitivity),
        ("associated limit, rigid wall", lambda: concio.limit(brick, path=False), lambda r: r.sensitivity()),
        ("limit with its path, rigid wall", lambda: concio.limit(brick), lambda r: r.sensitivity()),
    ):
        spent, result = seconds(solve)
        more, found = seconds(lambda differentiate=differentiate, result=result: differentiate(result))
        print(f"{name:34s} {spent:10.2f} {more:16.2f} {len(found.rows):8d} {100 * more / spent:5.0f} %")


def main() -> None:
    """Measure what is asked for; all by default."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sweeps", action="store_true")
    parser.add_argument("--derivatives", action="store_true")
    asked = parser.parse_args()
    if asked.derivatives or not asked.sweeps:
        derivatives()
    if asked.sweeps or not asked.derivatives:
        sweeps()


if __name__ == "__main__":
    main()
