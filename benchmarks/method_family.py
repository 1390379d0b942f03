"""All methods on five standard problems, under one certificate.

    python benchmarks/method_family.py [problem ...] [--methods a,b,c] [--limit SECONDS] [--figures DIR]

Times are ratios to the engine (``interior-point``) measured in the same run. A method that is asked to stop after
``--limit`` seconds is "too slow"; one that reaches only an accuracy of its own has "gave up" in the table, with the
accuracy in its certificate column and its note.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import concio
from concio.problem.contact_problem import ContactProblem
from concio.studies.compare import compare, format_table

DENSE = ("lemke", "klarbring", "ercolano", "lee", "del-piero")
"""Methods that form dense matrices: left out of the large wall."""


def small_panel() -> ContactProblem:
    """Three courses of three blocks with mortar on a full base between side walls (the paper's constants)."""
    return concio.assemble(
        concio.running_bond_panel(courses=3, blocks=3, joint=0.02, friction=0.6, top_pressure=10.0)
    ).problem()


def large_wall() -> ContactProblem:
    """Thirty units by fourteen courses, dry, self-weight and 0.3 of it sideways (427 blocks)."""
    return _leaning(14, 30, 0.30)


def near_collapse() -> ContactProblem:
    """Return the same bond, ten units by six courses, with 96 % of the associated limit sideways."""
    from concio.solvers.statics.associated_limit import associated_limit

    still, leaning = _leaning(6, 10, 0.0), _leaning(6, 10, 1.0)
    limit = associated_limit(still, leaning.f - still.f).multiplier
    return still.with_loads(still.f + 0.96 * limit * (leaning.f - still.f))


def jammed_arch() -> ContactProblem:
    """Three dry courses of six blocks between walls with nothing below, friction 1: held by the arch alone."""
    return concio.assemble(
        concio.running_bond_panel(courses=3, blocks=6, friction=1.0, base="none", top_pressure=10.0)
    ).problem()


def rigid_blocks() -> ContactProblem:
    """Six courses of eight rigid blocks in hard dry joints, 0.2 of their weight sideways."""
    return concio.assemble(
        concio.running_bond_panel(
            courses=6, blocks=8, block=concio.Rigid(), friction=0.6, side_walls=False, unit_weight=20.0, horizontal=0.2
        )
    ).problem()


def _leaning(courses: int, blocks: int, share: float) -> ContactProblem:
    model = concio.running_bond_panel(
        courses=courses, blocks=blocks, friction=0.6, side_walls=False, unit_weight=20.0, horizontal=share,
        elements_per_block=(2, 2),
    )  # fmt: skip
    return concio.assemble(model).problem()


PROBLEMS: dict[str, Callable[[], ContactProblem]] = {
    "small-panel": small_panel,
    "large-wall": large_wall,
    "jammed-arch": jammed_arch,
    "near-collapse": near_collapse,
    "rigid-blocks": rigid_blocks,
}


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("problems", nargs="*", metavar="problem", help="default all: " + ", ".join(PROBLEMS))
    parser.add_argument("--methods", help="comma-separated; default all")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds allowed to each method")
    parser.add_argument("--figures", type=Path, help="directory for figures of residual against work")
    wanted = parser.parse_args()
    for name in wanted.problems or PROBLEMS:
        if name not in PROBLEMS:
            parser.error(f"there is no problem {name}")
        problem = PROBLEMS[name]()
        methods = wanted.methods.split(",") if wanted.methods else _suitable(problem)
        table = compare(problem, methods, time_limit=wanted.limit, title=name)
        print(format_table(table), end="\n\n", flush=True)
        if wanted.figures:
            import matplotlib as mpl

            mpl.use("Agg")
            from concio.plot.convergence import plot_convergence

            wanted.figures.mkdir(parents=True, exist_ok=True)
            plot_convergence(table).figure.savefig(wanted.figures / f"{name}.svg")


def _suitable(problem: ContactProblem) -> list[str]:
    from concio.solvers.methods import METHODS

    dense = problem.pairs > 1000
    return [name for name in METHODS if name != "auto" and not (dense and name in DENSE)]


if __name__ == "__main__":
    main()
