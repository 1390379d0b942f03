"""Load paths in steps: each step from the states of the last, against each from nothing, in one run.

    python benchmarks/load_paths.py

prints factorisations and CPU seconds of both ways and how far their last states are apart, relative to the largest
displacement and force; then, for one wall, how far both are from the exact path.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from wall_family import wall_model

import concio
from concio.solvers.algebra.sparse_factor import OrderedFactor
from concio.solvers.path import near_forces
from concio.solvers.path.near_forces import Nearby

EXAMPLE = Path(__file__).parents[1] / "examples" / "load_stages.toml"


def hung() -> concio.Model:
    """Return a weightless panel with mortar between two walls, pressed on top, that falls out of them."""
    return concio.running_bond_panel(
        courses=6, blocks=5, thickness=1.0, friction=1.0, joint=0.01, base="none", top_pressure=10.0
    )


def small_wall(length: float, block: Any = "rigid") -> concio.Model:
    """Return a wall twice as long as high, extruded to 0.3 m."""
    plane = concio.wall(length=length, height=length / 2, block=block, friction=0.6, horizontal=0.2)
    return concio.extrude(plane, 0.3)


def pushed(steps: int, live: float = 1.0) -> tuple[concio.Stage, ...]:
    """Return the weight in one step and a push in several."""
    return concio.Stage("weight", {"dead": 1.0}, steps=1), concio.Stage("push", {"live": live}, steps=steps)


def cases() -> Iterator[tuple[str, concio.Model, tuple[concio.Stage, ...]]]:
    """Yield name, model and stages."""
    yield "examples/load_stages.toml", concio.load(EXAMPLE), ()
    yield "wall 10 x 8, 20 steps", wall_model(8, 10, 0.5), pushed(20)
    yield "wall 10 x 8, 5 steps", wall_model(8, 10, 0.5), pushed(5)
    yield "wall 22 x 20, 10 steps", wall_model(20, 22, 0.3), pushed(10)
    yield "panel that is not carried", hung(), (concio.Stage("top", {"top": 1.0}, steps=10),)
    yield "in space, rigid, 15 blocks", small_wall(1.5), pushed(10, 2.0)
    yield "in space, rigid, 100 blocks", small_wall(4.0), pushed(10, 1.2)
    elastic = concio.Elastic(E=3e6, nu=0.2, unit_weight=20.0)
    yield "in space, elastic, 15 blocks", small_wall(1.5, elastic), pushed(6, 1.2)


@contextmanager
def counted() -> Iterator[Callable[[], int]]:
    """Give the number of factorisations made within."""
    whole = OrderedFactor.factorise
    made = [0]

    def factorise(self: OrderedFactor, *args: Any) -> None:
        made[0] += 1
        whole(self, *args)

    with mock.patch.object(OrderedFactor, "factorise", factorise):
        yield lambda: made[0]


def followed(model: concio.Model, stages: tuple[concio.Stage, ...]) -> tuple[concio.PathResult, int, float]:
    """Return a path in steps, its factorisations and its CPU seconds."""
    with counted() as made:
        begin = time.process_time()
        found = concio.run_path(model, stages, method="steps")
        return found, made(), time.process_time() - begin


def apart(a: Any, b: Any) -> float:
    """Return the largest difference of two arrays over the largest entry."""
    return float(np.abs(a - b).max(initial=0.0) / (np.abs(b).max(initial=0.0) or 1.0))


def from_nothing() -> Any:
    """Let each step be solved from nothing."""
    return mock.patch.object(Nearby, "solve", return_value=None)


def against_the_exact_path() -> None:
    """Print how far the steps of a wall near its limit, where stones come loose, end from the exact path."""
    model = wall_model(8, 10, 0.5)
    exact = concio.run_path(model, pushed(1), method="events").steps[-1].state
    print("\n| steps | each from | displacements apart from the exact path | forces |\n|---|---|---|---|")
    for steps in (20, 160):
        with from_nothing():
            before = concio.run_path(model, pushed(steps), method="steps")
        after = concio.run_path(model, pushed(steps), method="steps")
        for name, found in (("nothing", before), ("the last", after)):
            end = found.steps[-1].state
            far = apart(end.displacement, exact.displacement), apart(end.normal_force, exact.normal_force)
            print(f"| {steps} | {name} | {far[0]:.1e} | {far[1]:.1e} |", flush=True)


def tries() -> None:
    """Print the factorisations of plane paths by how many a try from the last states may cost."""
    allowed = (0, 1, 2, 3, 5)
    print("| path | " + " | ".join(str(k) for k in allowed) + " |\n|---" + "|---" * len(allowed) + "|")
    for name, model, stages in cases():
        if model.dim == 2:
            found = []
            for flips in allowed:
                with mock.patch.object(near_forces, "FLIPS", flips):
                    found.append(followed(model, stages)[1])
            print(f"| {name} | " + " | ".join(map(str, found)) + " |", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tries", action="store_true", help="instead: what a try from the last states may cost")
    if parser.parse_args().tries:
        tries()
        return
    print(
        "| path | steps | factorisations from nothing | from the last step | CPU s from nothing | from the last step "
        "| displacements apart | forces apart | certificate |"
    )
    print("|---" * 9 + "|")
    for name, model, stages in cases():
        with from_nothing():
            before, many, slow = followed(model, stages)
        after, few, fast = followed(model, stages)
        a, b = after.steps[-1].state, before.steps[-1].state
        print(
            f"| {name} | {len(after.steps)} | {many} | {few} | {slow:.1f} | {fast:.1f} "
            f"| {apart(a.displacement, b.displacement):.0e} | {apart(a.normal_force, b.normal_force):.0e} "
            f"| {after.certificate:.0e} |",
            flush=True,
        )
    against_the_exact_path()


if __name__ == "__main__":
    main()
