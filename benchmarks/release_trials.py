"""What letting go finds on two mortar panels near their limit, in several units and with several beginnings.

    python benchmarks/release_trials.py [--panels 0:322 404:234] [--units 0.8 1 1.1 1.3] [--failures 12 30]
                                        [--first 0.01 0.03]

Panels are named SEED:NUMBER of ``benchmarks/corpus.py``. Slow motion alone (``concio.solvers.relaxation.slow_motion``)
is asked where each ends, when the units of force and length are multiplied by the same factor, which changes nothing
but rounding and where iterations begin; ``--failures`` is how many steps may fail, ``--first`` the resistance of the
first step. CPU seconds. A panel takes some minutes.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from unittest.mock import patch

import numpy as np
from corpus import FAMILIES, draw

from concio.analysis.lent_compliance import lend
from concio.problem.contact_problem import ContactProblem
from concio.solvers.algebra.scaled import Scaled, _in_units, scale
from concio.solvers.interior.run import Run
from concio.solvers.relaxation import slow_motion


def in_units(problem: ContactProblem, factor: float) -> Scaled:
    """Return the scaled problem in units of force and length that are ``factor`` times as large."""
    s = scale(problem)
    force, length = factor * s.force, factor * s.length
    return replace(s, force=force, length=length, glued=s.glued / factor, **_in_units(problem, s.C, force, length))


def trial(problem: ContactProblem, factor: float, failures: int, first: float) -> tuple[str, float]:
    """Return how slow motion ends, in words, and its CPU seconds."""
    run = Run(in_units(problem, factor))
    begin = time.process_time()
    with patch.dict(slow_motion.FAILURES, {2: failures}), patch.dict(slow_motion.FIRST, {2: first}):
        slow_motion.relax(run)
    return run.trace[-1].removeprefix("release: "), time.process_time() - begin


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--panels", nargs="+", default=["0:322", "404:234"], metavar="SEED:NUMBER")
    parser.add_argument("--units", nargs="+", type=float, default=[0.8, 1.0, 1.1, 1.3])
    parser.add_argument("--failures", nargs="+", type=int, default=[12, 30])
    parser.add_argument("--first", nargs="+", type=float, default=[0.01, 0.03])
    arguments = parser.parse_args()
    print("| panel | pairs | failures allowed | first resistance | units | ends | CPU s |\n" + 7 * "|---" + "|")
    for panel in arguments.panels:
        seed, number = map(int, panel.split(":"))
        assembly, f, _ = draw(np.random.default_rng([seed, number]), FAMILIES[number % len(FAMILIES)])
        problem = lend(assembly).problem().with_loads(f)
        for failures in arguments.failures:
            for first in arguments.first:
                for factor in arguments.units:
                    words, seconds = trial(problem, factor, failures, first)
                    head = f"| {number} of seed {seed} | {problem.pairs} | {failures} | {first:g} | {factor:g} |"
                    print(f"{head} {words} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
