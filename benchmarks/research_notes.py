"""Figures of research notes and decisions that no other benchmark prints.

    python benchmarks/research_notes.py [TOPIC ...] [--list]

A topic each, named after its page in ``docs/research`` or its decision; without names all are printed, in some minutes.
CPU seconds of one run on one core.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from corpus import FAMILIES, draw
from wall_family import panel, wall, wall_model

import concio
from concio.analysis.bridges.sweep import Sweep
from concio.analysis.lent_compliance import lend
from concio.contact.detection import detect
from concio.io.result_file import load_result, save_result
from concio.solvers.algebra.scaled import scale
from concio.solvers.interior.run import Run, Start
from concio.solvers.methods import find


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Return what a call returns, and its CPU seconds."""
    begin = time.process_time()
    found = work()
    return found, time.process_time() - begin


def rounding_of_displacements() -> None:
    """Solve blocks much stiffer than their joints: 6 x 6 blocks under their weight, by the interior point alone."""
    side = 0.25
    for ratio in (1e5, 1e6, 1e7, 1e8, 1e9):
        cells = []
        for joint in (1e2, 1e4, 1e6):
            model = concio.wall(
                length=6 * side, height=6 * side, block_size=(side, side),
                block=concio.Elastic(E=ratio * joint * side, nu=0.2, unit_weight=20.0),
                friction=concio.JointLaw(0.6, normal_stiffness=joint, tangential_stiffness=0.4 * joint),
            )  # fmt: skip
            problem = concio.assemble(model).problem()
            found, seconds = timed(lambda p=problem: find("interior-point")(p, homotopy=False))
            cells.append(f"{joint:.0e}: {found.status.name}, {found.certificate.worst:.0e}, {seconds:.2f} s")
        print(f"E/(k h) = {ratio:.0e}, joints of k [kN/m3]  " + "; ".join(cells), flush=True)


def pushes_through_sliding_courses() -> None:
    """Push a wall of five rigid blocks whose courses all slide at the same multiplier, until a block goes."""
    blocks = concio.wall(length=0.5, height=0.25, block="rigid", friction=0.6)
    found, seconds = timed(lambda: concio.push(blocks, until=0.05))
    print(f"{len(blocks.free_bodies)} blocks: peak {found.peak:.4f}, ends at {1e3 * found.capacity:.2f} mm")
    print(f"{len(found.multiplier)} points in {seconds:.0f} s; {found.ending.value}")


def margins_twice() -> None:
    """Find the least common factor of the coefficients of friction, by proof."""
    for units, courses in ((30, 14), (50, 40)):
        model = wall_model(units, courses, 0.2)
        margin, seconds = timed(lambda m=model: concio.friction_margin(m))
        print(f"wall {units} x {courses}: least factor {margin.factor:.9f} in {seconds:.1f} s", flush=True)


def rubble_by_contracting_a_voronoi_diagram() -> None:
    """Generate a wall of some 5,000 stones."""
    stones, seconds = timed(lambda: concio.rubble(length=10.0, height=5.0, stone=0.1))
    print(f"{len(stones.free_bodies)} stones in {seconds:.1f} s")


def large_files_and_figures() -> None:
    """Store and draw a wall of some 5,000 blocks (0020, 0060, one look for all figures)."""
    model = concio.wall(length=35.0, height=17.5, block_size=(0.5, 0.25), block="rigid", horizontal=0.05)
    found, seconds = timed(lambda: detect(model))
    print(f"{len(model.bodies)} bodies, {len(found.interfaces)} interfaces found in {seconds:.2f} s")
    result, seconds = timed(lambda: concio.solve(model))
    print(f"solved in {seconds:.1f} s: {result.status.name}, {len(result.contacts.normal_force)} pairs")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        files, seconds = timed(lambda: save_result(result, place))
        size = sum(file.stat().st_size for file in files) / 1e6
        print(
            f"result of {size:.1f} MB written in {seconds:.1f} s, read in {timed(lambda: load_result(place))[1]:.1f} s"
        )
    for name in ("model", "deformed", "forces", "slip"):
        print(f"figure '{name}' in {timed(getattr(result.plot, name))[1]:.1f} s", flush=True)


def start_far_outside() -> None:
    """Count iterations of the interior point from starts of three sizes, on jammed panels and walls near collapse."""
    cases = {
        f"panel {c} x {b} hung, {'mortar' if joint else 'dry'}, friction {mu:g}": panel(c, b, joint, mu, base="none")
        for c, b in ((3, 5), (5, 10))
        for joint in (0.0, 0.02)
        for mu in (0.6, 1.0)
    }
    cases |= {f"wall 30 x 14 at {share:.2f}": wall(30, 14, share) for share in (0.43, 0.44)}
    for name, problem in cases.items():
        cells = []
        for start in (1.0, 10.0, 100.0):
            run = Run(scale(problem))
            found = run.from_start(Start(start, start))
            cells.append(f"{start:g}: " + ("none" if found is None else f"{run.iterations} iterations"))
        print(f"{name}: " + "; ".join(cells), flush=True)


def exhaustive_search_learns_clauses() -> None:
    """Search exhaustively on problems of the corpus (seed 0) that the interior point leaves open."""
    for number in (91, 64, 11, 40):
        assembly, f, note = draw(np.random.default_rng([0, number]), FAMILIES[number % len(FAMILIES)])
        problem = lend(assembly).problem().with_loads(f)
        found, seconds = timed(lambda p=problem: find("exhaustive")(p))
        print(
            f"{number} ({note['family']}, {problem.pairs} pairs): {found.status.name}, {found.iterations} nodes,"
            f" {seconds:.1f} s",
            flush=True,
        )


def bridge_of(ring: float | list[float], voussoirs: int, cover: float, passive: float, **data: Any) -> concio.Model:
    """Return an arch with fill under an axle of 10 kN, for the two topics below."""
    footprint = data.pop("footprint", 0.3)
    fill = concio.Fill(cover=cover, unit_weight=data.pop("soil"), passive=passive)
    bare = concio.bridge(ring=ring, voussoirs=voussoirs, block="rigid", **data)
    axle = concio.Vehicle("axle", (concio.Axle(0.0, 10.0),), footprint=footprint, position=0.225 * data["span"])
    return concio.with_vehicle(concio.with_fill(bare, fill), axle)


def pushes_of_several_rings() -> None:
    """Push arches of two rings past their peak, beside the associated bound and Coulomb load steps."""
    drawn = (12, None, 0.0), (8, 0.6, 0.0), (8, 0.6, 1.0), (12, 0.6, 0.0), (12, 0.6, 1.0), (20, 0.5, 0.0)
    for voussoirs, mu, passive in drawn:
        data = {"span": 3.0, "rise": 0.75, "friction": 0.6, "unit_weight": 22.0, "soil": 20.0, "width": 2.0}
        model = bridge_of(0.215 if mu is None else [0.1075, 0.1075], voussoirs, 0.3, passive, ring_friction=mu, **data)
        steps = concio.limit(model, "live", path=False, steps=True, search=False)
        found, seconds = timed(lambda m=model: concio.push(m, until=0.003))
        print(
            f"{voussoirs} voussoirs, mu {mu}, k {passive:g}: peak {found.peak:.3f} at "
            f"{1e3 * found.displacement[found.peak_step]:.2f} mm, steps {steps.design:.3f}, bound "
            f"{steps.associated.multiplier:.3f}; {len(found)} points, {found.ending.value}, certificate "
            f"{found.certificate:.0e}, {seconds:.0f} s\n"
            f"    {found.verdict.limits[0]}",
            flush=True,
        )


def an_arch_without_its_data() -> None:
    """Compare 254.25 kN/m of a published arch whose data are incomplete with sets of data that it may have had."""
    found = {}
    for voussoirs, stone, cover, footprint in product(
        (12, 20, 40), (20.0, 22.0, 24.0, 25.0), (0.2, 0.25, 0.3, 0.35, 0.4), (0.1, 0.2, 0.3)
    ):
        data = {"span": 6.0, "rise": 1.5, "friction": 1e3, "unit_weight": stone, "soil": 18.0, "width": 1.0}
        sweep = Sweep(bridge_of(0.5, voussoirs, cover, 0.0, footprint=footprint, **data))
        loads = [10.0 * sweep.at(6.0 * x).multiplier for x in (0.2, 0.225, 0.25)]
        found[voussoirs, stone, cover, footprint] = loads
    near = {k: v for k, v in found.items() if abs(v[1] / 254.25 - 1) < 1e-2}
    every = [v[1] for v in found.values()]
    print(f"{len(found)} sets: {min(every):.1f} to {max(every):.1f} kN/m at 0.225 L; within 1 %: {len(near)}")
    for key, loads in near.items():
        print(f"    {key}: " + ", ".join(f"{v:.2f}" for v in loads) + " kN/m at 0.2, 0.225, 0.25 L")


TOPICS: dict[str, Callable[[], None]] = {
    work.__name__.replace("_", "-"): work
    for work in (
        rounding_of_displacements, pushes_through_sliding_courses, margins_twice,
        rubble_by_contracting_a_voronoi_diagram, large_files_and_figures, start_far_outside,
        exhaustive_search_learns_clauses, pushes_of_several_rings, an_arch_without_its_data,
    )
}  # fmt: skip
"""What is measured, by name."""


def main() -> None:
    """Print the topics asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("topics", nargs="*", metavar="TOPIC", help="names as --list prints them")
    parser.add_argument("--list", action="store_true", help="names of the topics, with what each is")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.topics if name not in TOPICS]:
        parser.error(f"no topic '{unknown[0]}': there are {', '.join(TOPICS)}")
    for name, work in TOPICS.items():
        if arguments.list:
            print(f"{name}: {(work.__doc__ or '').splitlines()[0]}")
        elif not arguments.topics or name in arguments.topics:
            print(f"{name}")
            work()


if __name__ == "__main__":
    main()
