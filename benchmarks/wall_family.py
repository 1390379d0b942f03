"""The engine on walls and panels of growing size, against one sparse factorisation and against Lemke, in one run.

    python benchmarks/wall_family.py [--large] [--fast] [--lemke] [--close]
    python benchmarks/wall_family.py --huge [--fast]
    python benchmarks/wall_family.py --wall UNITS COURSES SHARE [--fast]

Walls: running bond of dry elastic blocks 2:1, 2 x 2 elements, friction 0.6, self-weight and a horizontal share alpha of
it. Head joints are coupled at the inner nodes of a block's end, bed joints at every node. Panels: 0.2 x 0.1 m blocks,
4 x 2 elements, between rigid walls on a full base, 10 kN/m2 on top.

Times are CPU times. The yardstick is one SuperLU factorisation of K + C'C of the same problem with SciPy's best
built-in ordering (``mmd``) and with nested dissection (``nd``): ratios to it do not depend on the machine. ``GB`` is
the largest resident set of the process when that answer was found; so ``--huge`` solves every wall in a process of its
own, as ``--wall`` does one. With ``--fast`` these take PARDISO alone, beside the same yardsticks.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

import concio
from concio.model.generate.panel import Base
from concio.problem.contact_problem import ContactProblem
from concio.solvers.algebra.scaled import scale
from concio.solvers.methods import find
from concio.solvers.path.near_forces import Nearby
from concio.solvers.states.settle import Settler

Methods = list[tuple[str, dict[str, Any]]]

WALLS = ((30, 14, 0.30), (30, 14, 0.40), (30, 14, 0.43), (30, 14, 0.44), (50, 40, 0.30), (50, 40, 0.34))
PANELS = ((10, 10, 0.0, 1.0), (20, 20, 0.0, 1.0), (10, 10, 0.02, 1.0), (20, 20, 0.02, 0.6))

HUGE = ((100, 100, 0.15), (317, 315, 0.15), (100, 100, 0.20), (500, 200, 0.20))
"""Walls of 10,000 and of 100,000 blocks under the same share of their weight: how the time grows."""

SMALL = ((3, 3), (5, 5), (4, 8))

CLOSE = (0.36, 0.37, 0.38, 0.39, 0.40)
"""Shares of the weight that the wall of 2,020 blocks does not reach by loading (decision 0006)."""


def wall_model(units: int, courses: int, alpha: float, elements: tuple[int, int] = (2, 2)) -> concio.Model:
    """Return the model of a wall of the family: ``units`` blocks long, horizontal share ``alpha``."""
    return concio.running_bond_panel(
        courses=courses,
        blocks=units,
        block_size=(1.0, 0.5),
        thickness=1.0,
        block=concio.Elastic(E=1e5, nu=0.15, unit_weight=20.0),
        friction=0.6,
        side_walls=False,
        horizontal=alpha,
        elements_per_block=elements,
    )


def wall(units: int, courses: int, alpha: float) -> ContactProblem:
    """Return the arrays of :func:`wall_model`, without the redundant corner pairs of head joints."""
    assembly = concio.assemble(wall_model(units, courses, alpha))
    problem = assembly.problem()
    pairs = assembly.pairs
    level = pairs.point[:, 1] / 0.5
    corner = (np.abs(pairs.normal[:, 0]) > 0.5) & (np.abs(level - np.round(level)) < 1e-6)
    keep = ~corner
    return replace(
        problem,
        C_n=problem.C_n[keep],
        C_t=problem.C_t[keep],
        gap=problem.gap[keep],
        laws=problem.laws[keep],
        slip_origin=problem.slip_origin[keep],
        area=problem.area[keep],
    )


def panel(courses: int, blocks: int, joint: float, friction: float, base: Base = "full") -> ContactProblem:
    """Return a panel between rigid walls."""
    model = concio.running_bond_panel(
        courses=courses, blocks=blocks, joint=joint, friction=friction, base=base, top_pressure=10.0
    )
    return concio.assemble(model).problem()


def timed(work: Callable[[], object]) -> float:
    """Return the CPU seconds of one call."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def yardsticks(problem: ContactProblem) -> tuple[float, float]:
    """Return the seconds of one factorisation of K + C'C: SciPy's minimum degree, and nested dissection."""
    scaled = scale(problem)
    matrix = sp.csc_matrix(scaled.K + problem.C.T @ problem.C)
    options = {"SymmetricMode": True}
    mmd = timed(lambda: sla.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=options))
    blocks = np.tile(np.eye(2), (problem.pairs, 1, 1))
    nd = timed(lambda: scaled.factor.factorise(blocks))
    return mmd, nd


def report(name: str, problem: ContactProblem, methods: Methods, motion: bool = False) -> tuple[float, float]:
    """Solve by each method and print a row; return the seconds of the last and of one factorisation (``nd``).

    ``motion`` adds the largest displacement to the row.
    """
    rows = []
    for method, options in methods:
        begin = time.process_time()
        solution = find(method)(problem, **options)
        seconds = time.process_time() - begin
        rows.append((method, options, solution, seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20))
    mmd, nd = yardsticks(problem)
    for method, options, solution, seconds, memory in rows:
        label = method + "".join(f" {v}" for v in options.values())
        print(
            f"{name:28s}{problem.pairs:8d}{problem.unknowns:9d}  {label:24s}{solution.status.name:15s}"
            f"{solution.certificate.worst:9.1e}{solution.iterations:6d}{solution.factorisations:6d}"
            f"{seconds:9.2f}{mmd:8.3f}{nd:8.3f}{seconds / mmd:8.1f}{seconds / nd:8.1f}{memory:7.2f}"
            + (f"  moves {np.abs(solution.displacement).max():.4g} m" if motion else ""),
            flush=True,
        )
    return rows[-1][3], nd


def second_solve() -> None:
    """Print what the second solve of small panels takes (everything imported, nothing kept), and what of it is where.

    Beside it: settling the states of the pairs at once, from pairs that stick, instead of iterating; and the next load
    step (two per cent more load), which begins where the last one ended, with its factors.
    """
    for courses, blocks in SMALL:
        problem = panel(courses, blocks, 0.0, 0.6)
        solution = find("interior-point")(problem)
        s = scale(problem)
        u, sticking = np.zeros(len(s.f)), np.tile((1.0, 0.0), (s.pairs, 1))
        whole = [lambda p=problem: find("interior-point")(p), lambda p=problem: scale(p)]
        settler = [lambda s=s, u=u, t=sticking: Settler(s).settle(s, u, t)]
        last = solution.displacement, solution.normal_force, solution.friction_force
        nearby, more = Nearby(), problem.with_loads(1.02 * problem.f)
        if nearby.answer(problem, last) is None or nearby.solve(more, last) is None:
            raise AssertionError("the next load step is not found from the last")
        step = [lambda n=nearby, p=more, t=last: n.answer(p, t)]
        best, scaling, settling, next_step = (
            1e3 * min(timed(work) for _ in range(20)) for work in whole + settler + step
        )
        one = 1e3 * min(yardsticks(problem)[1] for _ in range(20))
        found = "" if settler[0]().settled else ", without an answer"
        print(
            f"panel {courses} x {blocks}, second solve: {best:.1f} ms, {solution.factorisations} factorisations of "
            f"{one:.2f} ms, scaling and ordering {scaling:.1f} ms; settled from sticking pairs: {settling:.1f} ms"
            + f"{found}; next load step: {next_step:.1f} ms"
        )


def alone(units: int, courses: int, alpha: float, engine: Methods) -> tuple[int, float, float]:
    """Print the row of one wall; return its pairs, the seconds to solve it and those of one factorisation."""
    problem = wall(units, courses, alpha)
    seconds, one = report(f"wall {units} x {courses}, {alpha:.2f}", problem, engine)
    return problem.pairs, seconds, one


def huge(engine: Methods) -> None:
    """Print large walls, each in a process of its own, and how their times grow with the number of pairs."""
    found: dict[float, tuple[int, float, float]] = {}
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as one_by_one:
        for units, courses, alpha in HUGE:
            now = one_by_one.apply(alone, (units, courses, alpha, engine))
            if alpha in found:
                larger, *powers = np.log(np.array(now) / np.array(found[alpha]))
                solve, factorise = np.array(powers) / larger
                print(f"share {alpha:.2f}: solve grows with pairs^{solve:.2f}, a factorisation with ^{factorise:.2f}")
            found[alpha] = now


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="also 10,050 blocks and the 40 x 40 panels")
    parser.add_argument("--huge", action="store_true", help="only 10,000 and 100,000 blocks (half an hour, 7 GB)")
    parser.add_argument("--wall", nargs=3, metavar=("UNITS", "COURSES", "SHARE"), help="one wall alone")
    parser.add_argument("--fast", action="store_true", help="also, of large walls only, with 'pardiso' (extra: fast)")
    parser.add_argument("--lemke", action="store_true", help="also the pivoting methods on the small walls")
    parser.add_argument("--close", action="store_true", help="also what loading does not reach, and a jammed panel")
    arguments = parser.parse_args()
    engine: Methods = [("interior-point", {})]
    if arguments.fast:
        engine.append(("interior-point", {"engine": "pardiso"}))
    heads = ("pairs", "unknowns", "method", "outcome", "worst", "iter", "fact", "CPU s", "mmd s", "nd s", "/mmd", "/nd")
    heads += ("GB",)
    widths = (8, 9, -26, -15, 9, 6, 6, 9, 8, 8, 8, 8, 7)
    titles = zip(heads, widths, strict=True)
    print(f"{'problem':28s}" + "".join(f"{h:>{w}s}" if w > 0 else f"  {h:{-w - 2}s}" for h, w in titles), flush=True)
    if arguments.wall:
        alone(int(arguments.wall[0]), int(arguments.wall[1]), float(arguments.wall[2]), engine[-1:])
        return
    if arguments.huge:
        huge(engine[-1:])
        return
    for units, courses, alpha in ((6, 7, 0.15), (10, 10, 0.15)) if arguments.lemke else ():
        pivoting: Methods = [("sparse-lemke", {})]
        report(f"wall {units} x {courses}, {alpha}", wall(units, courses, alpha), engine + pivoting)
    for units, courses, alpha in WALLS:
        report(f"wall {units} x {courses}, {alpha:.2f}", wall(units, courses, alpha), engine)
    for courses, blocks, joint, mu in PANELS:
        report(f"panel {courses} x {blocks}, {joint:g}, {mu:g}", panel(courses, blocks, joint, mu), engine)
    second_solve()
    if arguments.large:
        report("wall 100 x 100, 0.30", wall(100, 100, 0.30), engine)
        report("panel 40 x 40 dry, 0.6", panel(40, 40, 0.0, 0.6), engine)
        report("panel 40 x 40 mortar, 0.6", panel(40, 40, 0.02, 0.6), engine)
    if arguments.close:
        report("panel 10 x 20 hung, 1", panel(10, 20, 0.02, 1.0, base="none"), [("auto", {})], motion=True)
        for alpha in CLOSE:
            report(f"wall 50 x 40, {alpha:.2f}", wall(50, 40, alpha), [("auto", {})], motion=True)


if __name__ == "__main__":
    main()
