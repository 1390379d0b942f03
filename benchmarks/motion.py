"""What steps of motion cost: a rocking block, a wall at rest, shaken walls; the search against the solving.

    python benchmarks/motion.py [--fast]

Times are CPU times of this process. Each line has the steps, the time a step, the shares of steps by what solved them,
factorisations a step and the error of the energy balance.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

import concio
from concio.contact.moving.search import ContactSearch
from concio.solvers.stepping.solver import StepSolver

WALL = {"courses": 14, "blocks": 30, "block_size": (1.0, 0.5), "thickness": 1.0, "friction": 0.6, "side_walls": False}
RIGID, SOFT = concio.Rigid(unit_weight=20.0), concio.Elastic(E=1e6, nu=0.15, unit_weight=20.0)


def block() -> concio.Model:
    """Return a block turned by half its critical angle."""
    tilt = 0.5 * float(np.arctan(1 / 3))
    c, s = np.cos(tilt), np.sin(tilt)
    outline = np.array([(-0.4, 0.0), (0.0, 0.0), (0.0, 1.2), (-0.4, 1.2)]) @ np.array([[c, -s], [s, c]])
    floor = np.array([(-5.0, -1.0), (5.0, -1.0), (5.0, 0.0), (-5.0, 0.0)])
    bodies = (concio.Body("floor", floor, kind="fixed"), concio.Body("block", outline, kind="rigid"))
    loads = (concio.Load("weight", (0.0, -1.0)),)
    return concio.Model(bodies, {"block": RIGID}, {"joint": concio.JointLaw(1.0)}, loads=loads)


def report(name: str, model: concio.Model, **options: Any) -> None:
    """Run a motion and print what it cost."""
    begun = time.process_time()
    found = concio.dynamics(model, **options)
    spent = time.process_time() - begun
    steps = len(found.steps)
    shares = ", ".join(f"{word} {100 * share:.1f} %" for word, share in found.steps.shares().items())
    factors = float(found.steps.factorisations.mean())
    print(
        f"{name}: {steps:,} steps, {spent:.1f} s, {1e3 * spent / steps:.2f} ms a step; {shares}; "
        f"{factors:.2f} factorisations a step; energy {found.energy.error:.1e}; {found.ending.name.lower()}"
    )


def search_share(duration: float) -> None:
    """Shake 1,000 blocks hard and print what looking for contacts costs beside solving the steps."""
    spent = {"search": 0.0, "solve": 0.0}

    def timed(kind: str, function: Any) -> Any:
        def call(*arguments: Any) -> Any:
            begun = time.process_time()
            answer = function(*arguments)
            spent[kind] += time.process_time() - begun
            return answer

        return call

    update, solve = ContactSearch.update, StepSolver.solve
    setattr(ContactSearch, "update", timed("search", update))  # noqa: B010
    setattr(StepSolver, "solve", timed("solve", solve))  # noqa: B010
    wall = concio.running_bond_panel(**{**WALL, "courses": 25, "blocks": 39}, block=RIGID)
    options = {"motion": concio.Pulse("sine", 1.0 * 9.81, 0.3, cycles=20.0), "start": "as described"}
    found = concio.dynamics(wall, duration=duration, step=2e-3, **options)
    print(
        f"{len(wall.free_bodies):,} moving blocks, {len(found.steps)} steps: search {spent['search']:.1f} s, "
        f"solving {spent['solve']:.1f} s"
    )


def main() -> None:
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fast", action="store_true", help="a twentieth of the steps")
    share = 0.05 if parser.parse_args().fast else 1.0
    report("rocking block", block(), duration=60.0 * share, step=1e-3, start="as described", adaptive=False)
    search_share(0.4 * share)
    sine = concio.Pulse("sine", 0.3 * 9.81, 0.5, cycles=20.0)
    still = concio.running_bond_panel(**WALL, block=RIGID)
    report("427 rigid blocks at rest", still, duration=10.0 * share, step=2e-3)
    report("427 rigid blocks, 0.3 g at 2 Hz", still, motion=sine, duration=10.0 * share, step=2e-3)
    law = concio.JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=4e5)
    soft = concio.running_bond_panel(**{**WALL, "friction": law}, block=RIGID)
    report("427 rigid blocks, joints with stiffness", soft, motion=sine, duration=10.0 * share, step=2e-3)
    elastic = concio.running_bond_panel(**WALL, block=SOFT, elements_per_block=(2, 2))
    report("427 elastic blocks, hard joints", elastic, motion=sine, duration=10.0 * share, step=2e-3)


if __name__ == "__main__":
    main()
