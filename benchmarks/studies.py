"""Studies: overhead of a row, and what a second worker is worth.

python benchmarks/studies.py [--rows 10000]

Prints, measured in one run: milliseconds a row that does nothing costs beside its own work, for each executor; and how
many times the rows of one worker two workers make, on rows that take some tens of milliseconds of one thread.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import concio

VARIABLES = (
    concio.variable("mu", low=0.3, high=0.7),
    concio.variable("s", low=0.2, high=0.6),
)


def nothing(row: dict[str, Any]) -> dict[str, float]:
    """Return the formula of the pushed block: no work to speak of."""
    return {"multiplier": min(row["mu"], row["s"])}


def wall(row: dict[str, Any]) -> concio.Model:
    """Return a small dry wall."""
    return concio.wall(
        length=1.0, height=0.5, block_size=(0.25, 0.125), friction=row["mu"], block=concio.Rigid(unit_weight=20.0),
        horizontal=0.1,
    )  # fmt: skip


def seconds(function: Any, outputs: Any, rows: int, **options: Any) -> float:
    """Return the wall-clock seconds of a study whose rows are written to a directory."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        found = concio.study(
            function, VARIABLES, outputs, "monte-carlo", size=rows, directory=Path(folder) / "study", **options
        )
        end = time.perf_counter() - start
    assert len(found) == rows
    assert not found.failures, found.failures[0].message
    return end


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=10_000)
    rows = parser.parse_args().rows
    few = max(rows // 10, 100)
    print(f"overhead of a row that does nothing, {rows} rows written one by one")
    for executor, workers in (("serial", None), ("processes", 1), ("processes", 2), ("dask", 2)):
        start = seconds(nothing, "multiplier", 2, executor=executor, workers=workers)
        whole = seconds(nothing, "multiplier", rows, executor=executor, workers=workers)
        name = f"{executor}, {workers}" if workers else executor
        print(f"  {name:14s} {1e3 * (whole - start) / rows:7.3f} ms a row, {start:5.2f} s to start")
    ratios = []
    for _ in range(3):
        one = seconds(wall, "stands", few, executor="processes", workers=1)
        two = seconds(wall, "stands", few, executor="processes", workers=2)
        ratios.append(one / two)
    print(f"rows of two workers over those of one, {few} walls, three times: {np.round(ratios, 2)}")


if __name__ == "__main__":
    main()
