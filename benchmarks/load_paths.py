"""Load paths in steps: each step from the states of the last, against each from nothing, in one run.

    python benchmarks/load_paths.py [--only NAME]

prints factorisations and CPU seconds of both ways and how far their last states are apart, relative to the largest
displacement and force; then, for one wall, how far both are from the exact path. ``--only`` takes the paths whose name
holds a text, ``exact`` that last comparison. ``--tries`` and ``--beginnings`` print instead what a try from nearby may
cost in the plane, and where it best begins in space.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from wall_family import wall_model

import concio
from concio.solvers.algebra.sparse_factor import OrderedFactor
from concio.solvers.interior.run import Run
from concio.solvers.path import near_forces, step_path
from concio.solvers.path.near_forces import Nearby

EXACT = "the exact path"
"""Name of the comparison with the exact path."""

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


def turning_arch() -> concio.Model:
    """Return an extruded arch of 9 voussoirs on an abutment that turns about the span."""
    plane = concio.arch(span=4.0, ring=0.6, voussoirs=9, block="rigid", friction=0.6)
    turns = concio.Support("turns", "right abutment", rotation=(0.02, 0.0, 0.0))
    return replace(concio.extrude(plane, 0.7), supports=(turns,))


def corner(block: Any) -> concio.Model:
    """Return two bonded walls that meet at a corner, pushed outward."""
    return concio.walls(
        lines=[[[0, 0], [1.5, 0]], [[0, 0], [0, 1.0]]],
        height=0.75,
        block_size=(0.5, 0.25, 0.25),
        block=block,
        friction=0.6,
        horizontal=0.2,
        towards=(-1, 0.5),
    )


def settled() -> tuple[concio.Stage, ...]:
    """Return the weight in one step and a movement of supports in twenty."""
    return concio.Stage("weight", {"dead": 1.0}, steps=1), concio.Stage("movement", {"settlement": 1.0})


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
    yield "in space, rigid wall, 39 blocks", small_wall(1.5), pushed(10, 2.0)
    yield "in space, rigid wall, 264 blocks", small_wall(4.0), pushed(10, 1.2)
    elastic = concio.Elastic(E=3e6, nu=0.2, unit_weight=20.0)
    yield "in space, arch on a turning abutment", turning_arch(), settled()
    dome = concio.dome(span=8.0, ring=0.5, courses=4, blocks=8, oculus=1.5, spread=0.02)
    yield "in space, elastic dome that spreads, 32 blocks", dome, settled()
    yield "in space, rigid corner, 18 blocks", corner("rigid"), pushed(6, 1.5)
    yield "in space, elastic corner, 18 blocks", corner(elastic), pushed(6, 1.5)
    yield "in space, elastic wall, 18 blocks", small_wall(1.0, elastic), pushed(6, 1.2)


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
    return mock.patch.object(Nearby, "answer", return_value=None)


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


def beginnings(only: str) -> None:
    """Print the factorisations of paths in space by where Newton's method begins and how long it goes on."""
    settle, extrapolated = Run.settle, step_path.extrapolated

    def from_the_last(states: Any, parameter: float) -> near_forces.State:
        return extrapolated(states[-1:], parameter)

    def six_steps(self: Run, *args: Any, patience: int | None = None) -> Any:
        return settle(self, *args) if patience is None else settle(self, *args, 6)

    print("| path | from the last state, six steps | while the residual falls ", end="")
    print("| from where the last two lead, six steps | while the residual falls |")
    print("|---" * 5 + "|")
    for name, model, stages in cases():
        if model.dim == 3 and only in name:
            found = []
            for begin, go in product((from_the_last, extrapolated), (six_steps, settle)):
                with mock.patch.object(step_path, "extrapolated", begin), mock.patch.object(Run, "settle", go):
                    found.append(followed(model, stages)[1])
            print(f"| {name} | " + " | ".join(map(str, found)) + " |", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="paths whose name holds this text")
    parser.add_argument("--tries", action="store_true", help="instead: what a try from the last states may cost")
    parser.add_argument("--beginnings", action="store_true", help="instead: where a try best begins in space")
    chosen = parser.parse_args()
    if chosen.tries:
        tries()
        return
    if chosen.beginnings:
        beginnings(chosen.only)
        return
    print(
        "| path | steps | factorisations from nothing | from the last step | CPU s from nothing | from the last step "
        "| displacements apart | forces apart | certificate |"
    )
    print("|---" * 9 + "|")
    for name, model, stages in cases():
        if chosen.only not in name:
            continue
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
    if chosen.only in EXACT:
        against_the_exact_path()


if __name__ == "__main__":
    main()
