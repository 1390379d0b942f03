"""A corpus of random problems in space: every verdict must be a proof, and almost every problem must get one.

    python benchmarks/corpus_space.py [--count 300] [--seed 0 7 ...] [--first 0] [--list] [--markdown]

Walls in running and in header bond, walls with corners, barrels, domes; rigid blocks with stiff joints and elastic
blocks; tilted, on supports that have moved, with blocks that nothing loads, squeezed between fixed sides without a
base. Friction, size, direction and share of the associated limit (0 to 1.3) are drawn. For each: the verdict of
``auto``, its proof recomputed here from the original arrays, and the strategy that found it. Prints a table by family,
one by strategy (verdicts, most factorisations of one problem, CPU seconds), and the undecided ones with what was tried.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "tests")]

from corpus import DECIDED, proven  # noqa: E402

from concio.problem.contact_problem import ContactProblem  # noqa: E402
from concio.problem.solution import Solution  # noqa: E402
from concio.solvers.methods import find  # noqa: E402
from concio.solvers.statics.associated_limit import associated_limit  # noqa: E402
from space_problems import Built, barrel, corner_wall, dome, wall  # noqa: E402

FAMILIES = ("running bond", "header bond", "corners", "barrel", "dome", "tilted", "settled", "loose", "squeezed")

BUILDERS = ("running bond", "header bond", "corners", "barrel", "dome")
"""Families that stand for themselves; the others are one of these with something more."""


def built(rng: np.random.Generator, kind: str) -> Built:
    """Return a structure of a kind, with joints or blocks that give way."""
    options: dict[str, object] = {"mu": float(rng.uniform(0.25, 1.1))}
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    options["direction"] = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
    options |= {"elastic": True} if rng.integers(2) else {"kn": float(10 ** rng.uniform(1, 4))}
    if kind == "header bond":
        return wall(int(rng.integers(2, 5)), int(rng.integers(2, 6)), leaves=int(rng.integers(2, 4)), **options)
    if kind == "corners":
        return corner_wall(
            int(rng.integers(2, 6)), int(rng.integers(4, 8)), int(rng.integers(2, 5)), legs=int(rng.integers(1, 3)),
            **options,
        )  # fmt: skip
    if kind == "barrel":
        thickness = float(rng.uniform(0.6, 1.2))
        return barrel(int(rng.integers(5, 12)), int(rng.integers(1, 4)), thickness=thickness, **options)
    if kind == "dome":
        thickness = float(rng.uniform(0.3, 0.8))
        return dome(int(rng.integers(2, 5)), int(rng.integers(5, 10)), thickness=thickness, **options)
    return wall(int(rng.integers(2, 6)), int(rng.integers(2, 7)), **options)


def draw(rng: np.random.Generator, family: str) -> tuple[ContactProblem, dict[str, object]]:
    """Return a problem of a family and what was drawn."""
    if family == "squeezed":
        options = {"elastic": True} if rng.integers(2) else {"kn": float(10 ** rng.uniform(1, 4))}
        mu = float(rng.uniform(0.3, 1.2))
        case = wall(int(rng.integers(2, 5)), int(rng.integers(2, 5)), sides=True, mu=mu, **options)
        pressed = replace(case.problem, gap=case.problem.gap - 1e-4 * float(rng.uniform(0, 3)))
        share = float(rng.uniform(0, 0.5))
        return pressed.with_loads(case.problem.f + share * case.live), {"mu": round(mu, 3), "share": round(share, 3)}
    kind = family if family in BUILDERS else str(rng.choice(BUILDERS))
    case = built(rng, kind)
    problem = case.problem
    note: dict[str, object] = {"kind": kind}
    if family == "tilted":
        angle = float(rng.uniform(0.0, 0.4))
        problem = problem.with_loads(np.cos(angle) * problem.f + np.sin(angle) * case.live)
        note["tilt"] = round(angle, 3)
        return problem, note
    limit = associated_limit(problem, case.live).multiplier
    share = float(rng.uniform(0.0, 1.3))
    load = problem.f + share * (limit if np.isfinite(limit) and limit < 10 else 1.0) * case.live
    note["share"] = round(share, 4)
    if family == "settled":
        note["share"] = share = share / 2
        load = problem.f + share * (limit if np.isfinite(limit) and limit < 10 else 1.0) * case.live
        moved = np.zeros(problem.pairs)
        ground = np.diff(problem.C_n.indptr) <= 6 if not problem.K.nnz else np.diff(problem.C_n.indptr) <= 3
        moved[ground] = 1e-3 * rng.normal(size=int(ground.sum()))
        return replace(problem, f=load, gap=moved), note
    if family == "loose":
        bodies = np.diff(problem.bodies).size
        keep = np.repeat(rng.random(bodies) < 0.3, np.diff(problem.bodies))
        return problem.with_loads(np.where(keep, load, 0.0)), note
    return problem.with_loads(load), note


@dataclass
class Count:
    """What was counted of the problems of one seed."""

    seed: int
    families: dict[str, Counter[str]] = field(default_factory=lambda: {f: Counter() for f in FAMILIES})
    strategies: dict[str, Counter[str]] = field(default_factory=dict)
    work: Counter[str] = field(default_factory=Counter)
    spent: Counter[str] = field(default_factory=Counter)
    left: list[str] = field(default_factory=list)

    @property
    def verdicts(self) -> Counter[str]:
        """Return how often each verdict was given."""
        total: Counter[str] = Counter()
        for counts in self.families.values():
            total += counts
        return total

    def add(self, family: str, verdict: str, solution: Solution, seconds: float) -> None:
        """Count one answer."""
        by = str(solution.info.get("strategy", "at rest"))
        self.families[family][verdict] += 1
        self.strategies.setdefault(by, Counter())[verdict] += 1
        self.work[by] = max(self.work[by], solution.factorisations)
        self.spent[by] += seconds


def table(rows: list[list[str]], *, markdown: bool) -> str:
    """Return a table whose first row is its heads; columns after the first are set right where it is not Markdown."""
    if markdown:
        return "\n".join("| " + " | ".join(row) + " |" for row in [rows[0], ["---"] * len(rows[0]), *rows[1:]])
    widths = [max(len(row[c]) for row in rows) + 2 for c in range(len(rows[0]))]
    return "\n".join(
        row[0].ljust(widths[0]) + "".join(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True)) for row in rows
    )


def tables(count: Count, *, markdown: bool) -> str:
    """Return the tables of one seed: by family, by strategy, and what is undecided."""
    names = (*DECIDED[:3], "UNDECIDED", "GAVE_UP", "WRONG")
    heads = [n.lower().replace("_", " ") for n in names]
    families = [["family", *heads]]
    families += [[family, *(str(counts[n]) for n in names)] for family, counts in count.families.items()]
    families += [["all", *(str(count.verdicts[n]) for n in names)]]
    strategies = [["strategy", *heads, "most factorisations", "CPU s"]]
    for by, counts in sorted(count.strategies.items(), key=lambda item: -item[1].total()):
        mine = [str(counts[n]) for n in names]
        strategies.append([by, *mine, str(count.work[by]), f"{count.spent[by]:.1f}"])
    total, wrong = count.verdicts.total(), count.verdicts["WRONG"]
    decided = sum(count.verdicts[n] for n in DECIDED)
    share = f"{decided} of {total} decided ({100 * decided / total:.2f} %), {wrong} wrong"
    last = f"seed {count.seed}: {share}, {count.spent.total():.0f} CPU s in all"
    both = (table(families, markdown=markdown), table(strategies, markdown=markdown), last)
    return "\n\n".join(both) + "\n" + "\n".join(count.left)


def main() -> None:
    """Run the corpus and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, nargs="+", default=[0], help="one or more, each drawn again")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--list", action="store_true", help="print every problem")
    parser.add_argument("--markdown", action="store_true", help="the tables for the documentation")
    arguments = parser.parse_args()
    for seed in arguments.seed:
        count = Count(seed)
        for k in range(arguments.first, arguments.first + arguments.count):
            family = FAMILIES[k % len(FAMILIES)]
            problem, note = draw(np.random.default_rng([seed, k]), family)
            begin = time.process_time()
            solution = find("auto")(problem)
            spent = time.process_time() - begin
            verdict = solution.status.name
            if verdict in DECIDED and not proven(problem, solution):
                verdict = "WRONG"
            count.add(family, verdict, solution, spent)
            if arguments.list or verdict not in DECIDED:
                by = solution.info.get("strategy")
                said = f"#{k} {family} {note} pairs {problem.pairs} {verdict} {spent:.2f} s by {by}"
                print(said, flush=True)
                if verdict not in DECIDED:
                    count.left.append("\n    ".join([said, *solution.trace]))
        print("\n" + tables(count, markdown=arguments.markdown) + "\n", flush=True)


if __name__ == "__main__":
    main()
