"""Limit loads and proofs of collapse on the walls of ``wall_family.py``: seconds, and what the checks leave.

    python benchmarks/limit_family.py [--large] [--highs] [--search]

For each wall: the associated multiplier with its gap, imbalance of forces and violation of the motion, and the
mechanism at a tenth more load. With ``--highs`` the same by HiGHS alone; with ``--search`` the Coulomb collapse state.
"""

from __future__ import annotations

import argparse
import time

from wall_family import wall

from concio.analysis.limit import search_collapse
from concio.solvers.statics import programme as statics
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.existence import find_mechanism

WALLS = ((30, 14), (50, 40))
LARGE = ((100, 100),)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="also 10,050 blocks")
    parser.add_argument("--highs", action="store_true", help="HiGHS alone instead of the interior point")
    parser.add_argument("--search", action="store_true", help="also search Coulomb collapse states")
    arguments = parser.parse_args()
    if arguments.highs:
        statics.LARGE = 10**9
    print("wall          pairs  multiplier        gap    forces    motion      s  mechanism    power      s")
    for units, courses in WALLS + (LARGE if arguments.large else ()):
        dead = wall(units, courses, 0.0)
        live = wall(units, courses, 1.0).f - dead.f
        begin = time.process_time()
        found = associated_limit(dead, live)
        seconds = time.process_time() - begin
        violation = found.mechanism.violation if found.mechanism else float("nan")
        above = dead.with_loads(dead.f + 1.1 * found.multiplier * live)
        begin = time.process_time()
        mechanism = find_mechanism(above)
        proof = f"{mechanism.violation:9.0e}{mechanism.power:9.3g}" if mechanism else "      none"
        print(
            f"{units:3d} x {courses:3d} {dead.pairs:8d}  {found.multiplier:.9f} {found.gap:7.0e}  {found.residual:7.0e}"
            f"   {violation:7.0e} {seconds:6.2f}  {proof} {time.process_time() - begin:6.2f}",
            flush=True,
        )
        if arguments.search:
            begin = time.process_time()
            state, said = search_collapse(dead, live)
            number = "none" if state is None else f"{state.multiplier:.9f}"
            print(f"    collapse state {number}, {said}: {time.process_time() - begin:.1f} s", flush=True)


if __name__ == "__main__":
    main()
