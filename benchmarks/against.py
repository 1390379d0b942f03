"""Whether the code has become slower: the same cases with this checkout and with another, by turns, in one run.

    git worktree add --detach /tmp/before 85ddfd2
    python benchmarks/against.py /tmp/before [--only TEXT] [--rounds 3]

Each case runs in processes of its own, by turns with either code; what is compared is the least of the rounds, in CPU
seconds of one thread, of the work alone (imports, the model and its assembly come before). Only names that both have
are used: public ones, and the table of methods. The last number says how far the two answers are apart.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve()

Case = Callable[[], Callable[[], float]]


def panel(courses: int, blocks: int, joint: float, friction: float) -> Case:
    """Return a panel between rigid walls, to be solved; its number is the largest displacement."""

    def prepared() -> Callable[[], float]:
        import concio

        model = concio.running_bond_panel(
            courses=courses, blocks=blocks, joint=joint, friction=friction, base="full", top_pressure=10.0
        )
        return solved(concio.assemble(model).problem())

    return prepared


def wall_of(units: int, courses: int, block: Any, **options: Any) -> Any:
    """Return the model of a wall of blocks 2:1 without side walls."""
    import concio

    size: dict[str, Any] = {"courses": courses, "blocks": units, "block_size": (1.0, 0.5), "thickness": 1.0}
    return concio.running_bond_panel(**size, block=block, friction=0.6, side_walls=False, **options)


def wall(units: int, courses: int, share: float) -> Case:
    """Return a wall under a horizontal share of its weight, to be solved."""

    def prepared() -> Callable[[], float]:
        import concio

        elastic = concio.Elastic(E=1e5, nu=0.15, unit_weight=20.0)
        model = wall_of(units, courses, elastic, horizontal=share, elements_per_block=(2, 2))
        return solved(concio.assemble(model).problem())

    return prepared


def solved(problem: Any) -> Callable[[], float]:
    """Return what solves a problem by the engine; its number is the largest displacement."""
    from concio.solvers.methods import find

    return lambda: float(np.abs(find("interior-point")(problem).displacement).max())


def limited(units: int, courses: int) -> Case:
    """Return a wall of rigid blocks whose limit is sought: the bound alone; its number is the multiplier."""

    def prepared() -> Callable[[], float]:
        import concio

        wall = concio.assemble(wall_of(units, courses, concio.Rigid(unit_weight=20.0), horizontal=0.1))

        def work() -> float:
            found = concio.limit(wall, "live", path=False, steps=False, search=False)
            return float(found.associated.multiplier)

        return work

    return prepared


def whole_limit(courses: int, blocks: int) -> Case:
    """Return a small wall whose limit is sought with all that the command does; its number is the bound."""

    def prepared() -> Callable[[], float]:
        import concio

        wall = concio.assemble(wall_of(blocks, courses, concio.Rigid(unit_weight=20.0), horizontal=0.1))
        return lambda: float(concio.limit(wall, "live").associated.multiplier)

    return prepared


def uncertified() -> None:
    """Leave out the certificate of each step of a motion where the code has one: 85ddfd2 has none."""
    try:
        from concio.analysis.motion.certified import Certificate
    except ImportError:
        return
    Certificate.step = lambda *given: 0.0  # type: ignore[method-assign]


def moved(seconds: float, *, elastic: bool = False, shaken: bool = True, certified: bool = True) -> Case:
    """Return a wall of 427 blocks that is shaken; its number is that of the steps."""

    def prepared() -> Callable[[], float]:
        import concio

        if not certified:
            uncertified()
        soft, options = concio.Elastic(E=1e6, nu=0.15, unit_weight=20.0), {"elements_per_block": (2, 2)}
        model = wall_of(30, 14, soft, **options) if elastic else wall_of(30, 14, concio.Rigid(unit_weight=20.0))
        motion = concio.Pulse("sine", 0.3 * 9.81, 0.5, cycles=20.0) if shaken else None

        follow = concio.dynamics

        def work() -> float:
            found = follow(model, motion=motion, duration=seconds, step=2e-3)
            return float(len(found.steps))

        return work

    return prepared


CASES: dict[str, Case] = {
    "wall 30 x 14, 0.15": wall(30, 14, 0.15),
    "wall 30 x 14, 0.30": wall(30, 14, 0.30),
    "wall 30 x 14, 0.40": wall(30, 14, 0.40),
    "wall 30 x 14, 0.44": wall(30, 14, 0.44),
    "wall 50 x 40, 0.30": wall(50, 40, 0.30),
    "wall 50 x 40, 0.34": wall(50, 40, 0.34),
    "panel 10 x 10 dry": panel(10, 10, 0.0, 1.0),
    "panel 20 x 20 dry": panel(20, 20, 0.0, 1.0),
    "panel 20 x 20 mortar, 0.6": panel(20, 20, 0.02, 0.6),
    "bound, wall 30 x 14": limited(30, 14),
    "bound, wall 50 x 40": limited(50, 40),
    "limit, wall 6 x 7": whole_limit(7, 6),
    "limit, wall 20 x 20": whole_limit(20, 20),
    "427 rigid blocks at rest": moved(1.0, shaken=False),
    "427 rigid blocks shaken": moved(0.5),
    "427 elastic blocks shaken": moved(0.2, elastic=True),
    "427 at rest, uncertified": moved(1.0, shaken=False, certified=False),
    "427 shaken, uncertified": moved(0.5, certified=False),
    "427 elastic, uncertified": moved(0.2, elastic=True, certified=False),
}


def one(name: str) -> None:
    """Run a case twice and print seconds and number of the quicker run."""
    work = CASES[name]()
    spent, number = np.inf, np.nan
    for _ in range(2):
        begun = time.process_time()
        number = work()
        now = time.process_time() - begun
        spent = min(spent, now)
        if now > 2.0:
            break
    print(json.dumps([spent, number]))


def run(name: str, place: Path) -> tuple[float, float]:
    """Return seconds and number of a case with the code of a checkout."""
    environment = os.environ | {"PYTHONPATH": str(place / "src"), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, str(HERE), str(place), "--one", name]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        print(done.stderr[-400:], file=sys.stderr)
        return np.inf, np.nan
    spent, number = json.loads(done.stdout)
    return float(spent), float(number)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, help="another checkout")
    parser.add_argument("--only", default="", help="cases whose name holds a text")
    parser.add_argument("--rounds", type=int, default=3, help="processes for each case and code")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one:
        one(asked.one)
        return
    print(f"{'case':28s}{'before s':>10s}{'now s':>10s}{'ratio':>8s}{'apart':>10s}")
    for name in (name for name in CASES if asked.only in name):
        before, now = (np.inf, np.nan), (np.inf, np.nan)
        for _ in range(asked.rounds):
            before, now = min(before, run(name, asked.other)), min(now, run(name, HERE.parents[1]))
        apart = abs(now[1] - before[1]) / max(abs(before[1]), 1e-300)
        print(f"{name:28s}{before[0]:10.3f}{now[0]:10.3f}{now[0] / before[0]:8.2f}{apart:10.1e}", flush=True)


if __name__ == "__main__":
    main()
