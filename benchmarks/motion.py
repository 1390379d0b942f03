"""What steps of motion cost: a rocking block, a wall at rest, shaken walls; the search against the solving.

    python benchmarks/motion.py [--fast] [--only block|search|rest|rigid|springs|elastic]

Times are CPU times of this process. Each line has the steps, the time a step, the shares of steps by what solved them,
factorisations a step and the error of the energy balance.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import concio
from concio.contact.contact_search import ContactSearch
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

    update, solve = ContactSearch.update, StepSolver.step
    setattr(ContactSearch, "update", timed("search", update))  # noqa: B010
    setattr(StepSolver, "step", timed("solve", solve))  # noqa: B010
    wall = concio.running_bond_panel(**{**WALL, "courses": 25, "blocks": 39}, block=RIGID)
    options = {"motion": concio.Pulse("sine", 1.0 * 9.81, 0.3, cycles=20.0), "start": "as described"}
    found = concio.dynamics(wall, duration=duration, step=2e-3, **options)
    print(
        f"{len(wall.free_bodies):,} moving blocks, {len(found.steps)} steps: search {spent['search']:.1f} s, "
        f"solving {spent['solve']:.1f} s"
    )


def main() -> None:
    """Run all cases, or one."""
    sine = concio.Pulse("sine", 0.3 * 9.81, 0.5, cycles=20.0)
    law = concio.JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=4e5)

    def wall(material: concio.Rigid | concio.Elastic = RIGID, **options: Any) -> concio.Model:
        return concio.running_bond_panel(**{**WALL, **options}, block=material)

    def rocking(share: float) -> None:
        report("rocking block", block(), duration=60.0 * share, step=1e-3, start="as described", adaptive=False)

    def shaken(name: str, model: concio.Model, motion: concio.Pulse | None = sine) -> Callable[[float], None]:
        return lambda share: report(name, model, motion=motion, duration=10.0 * share, step=2e-3)

    cases: dict[str, Callable[[float], None]] = {
        "block": rocking,
        "search": lambda share: search_share(0.4 * share),
        "rest": shaken("427 rigid blocks at rest", wall(), None),
        "rigid": shaken("427 rigid blocks, 0.3 g at 2 Hz", wall()),
        "springs": shaken("427 rigid blocks, joints with stiffness", wall(friction=law)),
        "elastic": shaken("427 elastic blocks, hard joints", wall(SOFT, elements_per_block=(2, 2))),
    }
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fast", action="store_true", help="a twentieth of the steps")
    parser.add_argument("--only", choices=cases, help="one case")
    chosen = parser.parse_args()
    for name, case in cases.items():
        if chosen.only in (None, name):
            case(0.05 if chosen.fast else 1.0)


if __name__ == "__main__":
    main()
