"""Exact certificates of random models: share proved, refusals by name, cost over the solve; walls and arches.

    python benchmarks/proofs.py [--count 1000] [--seed 0] [--walls] [--out docs/exact_proofs_table.md]

For each model a load step is solved, or a limit multiplier, and ``proof()`` asked of what came out. What is made is
recomputed by the checking program. Prints a table by family, the refusals with their sentences, names left out, and
(``--walls``) the multipliers of walls and arches as fractions. Costs are ratios of times measured in one run.
"""

from __future__ import annotations

import argparse
import re
import time
from collections import Counter, defaultdict
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

import concio
from concio.errors import ConcioError
from concio.proof.programs import recompute

COURSES = {"half ends": [0.5, 1, 1, 1, 1, 0.5], "full": [1.0] * 5, "doors": [1, -1, 1, -1, 1], "low": [1.0] * 4,
           "doors shifted": [0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5], "low shifted": [0.5, 1, 1, 1, 0.5],
           "door": [0.5, 1, -1, 1, 0.5], "door shifted": [1, 0.5, -1, 0.5, 1], "narrow": [0.5, 1, 1, 0.5],
           "narrow shifted": [1.0] * 3, "window": [1, -1, 1], "window shifted": [0.5, 0.5, -1, 0.5, 0.5],
           "wide ends": [0.5, 1, 1, 1, 1, 1, 1, 0.5], "wide": [1.0] * 7, "pair": [0.5, 1, -1, 1, 1, -1, 1, 0.5],
           "pair shifted": [1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1]}  # fmt: skip
STOREY, OPENING = ["narrow", "narrow shifted", "narrow"], ["window", "window shifted"] * 2 + ["window"]
DOORS = ["doors", "doors shifted"] * 2 + ["doors"]
PAIRS = ["pair", "pair shifted"] * 2 + ["pair"]
WALLS = {
    "1": ["half ends", "full"] * 3,
    "2": ["half ends", "full"] * 5,
    "3": ["low", "low shifted", "low", *["door", "door shifted"] * 2, "door", "low", "low shifted", "low"],
    "4": ["half ends", "full", "half ends", *DOORS, "half ends", "full", "half ends"],
    "5": [*STOREY, *OPENING, *STOREY, *OPENING, *STOREY],
    "6": [*["wide ends", "wide"] * 2, *PAIRS, "wide", "wide ends", "wide", *PAIRS, *["wide", "wide ends"] * 2],
}
"""Courses of walls 1 to 6 of Ferris and Tin-Loi, Int. J. Mech. Sci. 43 (2001), from below; those of wall 6 are from an
open example of HybriDFEM."""


def drawn_wall(rng: np.random.Generator, **more: Any) -> concio.Model:
    """Return a wall of random courses, friction and weight, pushed to a random side."""
    size = (float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.15, 0.3)))
    n, m = int(rng.integers(2, 5)), int(rng.integers(2, 6))
    return concio.wall(
        length=n * size[0], height=m * size[1], block_size=size, unit_weight=float(rng.uniform(15, 28)),
        friction=float(rng.uniform(0.2, 0.9)), horizontal=float(rng.choice([-1.0, 1.0])), **more,
    )  # fmt: skip


def drawn_arch(rng: np.random.Generator, **more: Any) -> concio.Model:
    """Return an arch of random shape under a load at its crown."""
    return concio.arch(
        span=float(rng.uniform(2, 5)), ring=float(rng.uniform(0.25, 0.6)), voussoirs=int(rng.integers(5, 20)),
        friction=float(rng.uniform(0.4, 0.9)), crown_load=2.0, unit_weight=25.0, **more,
    )  # fmt: skip


def with_law(model: concio.Model, **changes: Any) -> concio.Model:
    """Return a model with other joint laws."""
    return replace(model, laws={name: replace(law, **changes) for name, law in model.laws.items()})


def with_tie(model: concio.Model, rng: np.random.Generator) -> concio.Model:
    """Return a model with a tie from its last block to a fixed point."""
    body = model.free_bodies[-1]
    at = tuple(float(x) for x in body.centroid)
    end = (at[0] - 3.0, at[1])
    tie = concio.Tie("tie", body.name, at, "", end, 1e4, prestress=1.0, yield_force=float(rng.uniform(2, 9)))
    return replace(model, ties=(tie,))


def drawn(rng: np.random.Generator, family: str) -> concio.Model:
    """Return a random model of a family."""
    if family == "limit, arch":
        return drawn_arch(rng, block="rigid")
    if family == "limit, space":
        ground = concio.Polyhedron.box("ground", (-9, -9, -1), (9, 9, 0), kind="fixed")
        phi, up = float(rng.uniform(0, 6.28)), float(rng.uniform(0.2, 1.0))
        size = [float(x) for x in rng.uniform(0.3, 1.5, 2)]
        boxes = [
            concio.Polyhedron.box(f"b{k}", (0, 0, k * up), (*size, (k + 1) * up), kind="rigid")
            for k in range(int(rng.integers(1, 4)))
        ]
        push = (float(np.cos(phi)), float(np.sin(phi)), 0.0)
        loads = (concio.Load("weight", (0, 0, -1)), concio.Load("weight", push, group="live"))
        law = {"joint": concio.JointLaw(float(rng.uniform(0.2, 0.9)))}
        return concio.Model((ground, *boxes), {"block": concio.Rigid(20.0)}, law, loads=loads)
    if family == "step, elastic":
        return drawn_wall(rng, mesh_size=0.4)
    if family == "step, elastic on springs":
        return with_law(drawn_arch(rng, mesh_size=0.5), normal_stiffness=1e6, tangential_stiffness=5e5)
    wall = drawn_wall(rng, block="rigid")
    if family == "limit, cohesion and ties":
        wall = with_law(with_tie(wall, rng), cohesion=float(rng.uniform(1, 9)), tensile_strength=1.0)
    if family == "step, rigid on springs":
        wall = with_law(with_tie(wall, rng), normal_stiffness=1e6, tangential_stiffness=5e5)
    return wall


SHARES = {
    "limit, wall": 0.2, "limit, arch": 0.1, "limit, cohesion and ties": 0.15, "limit, space": 0.1, "step, rigid": 0.2,
    "step, rigid on springs": 0.1, "step, elastic": 0.075, "step, elastic on springs": 0.075,
}  # fmt: skip
"""Families, and the share of models of each."""


def asked(family: str, model: concio.Model, rng: np.random.Generator) -> tuple[str, str, float, int]:
    """Return what became of a model, what was proved or why not, the cost over the solve, and the number of blocks."""
    start = time.perf_counter()
    assembly = concio.assemble(model)
    if family.startswith("limit"):
        result: Any = concio.limit(assembly, path=False, steps=False, search=False)
        outcome = "limit"
    else:
        result = concio.solve(assembly, factors={"live": float(rng.uniform(0.0, 0.6))}, on_failure="return")
        outcome = result.status.name.lower()
    solved = time.perf_counter()
    try:
        made = result.proof()
        end = time.perf_counter()
        sentence = recompute(made)
    except ConcioError as error:
        words = str(error).removesuffix(f" ({error.hint})")
        return outcome, "refused: " + re.sub(r"'[^']*'|\([^)]*\)|-?\d[\d.e,+-]*", "…", words), 0.0, 0
    both = {"lower", "upper"} <= set(made)
    exact = made.get("lower") == made.get("upper")
    how = "proved exactly" if sentence.endswith("proved exactly") else "enclosed"
    if made["claim"] == "limit" and not (both and exact):
        how = "bounds that differ" if both else "one bound"
    return outcome, how, (end - solved) / (solved - start), len(model.free_bodies)


TITLE = """# Exact certificates of random models, walls and arches

Written by `benchmarks/proofs.py --count 1000 --walls`. For each random model a load step is solved or a limit
multiplier found, and an [exact certificate](howto/exact_proofs.md) asked for; what was made was recomputed by the
checking programs. The cost is the time of making the certificate over that of the solve, in the same run.

"Bounds that differ" are those of round cones in space, or of a corner of a linear programme with several bases.

"""

HEAD = ("| family | models | proved exactly | enclosed | bounds that differ | one bound | not proved "
        "| blocks, most | cost over the solve, median | 9 in 10 below |")  # fmt: skip


def corpus(count: int, seed: int) -> list[str]:
    """Return the tables of random models, in lines of Markdown."""
    found: dict[str, list[tuple[str, str, float, int]]] = defaultdict(list)
    for family, share in SHARES.items():
        for k in range(round(count * share)):
            rng = np.random.default_rng([seed, k, *family.encode()])
            try:
                found[family].append(asked(family, drawn(rng, family), rng))
            except ConcioError as error:
                found[family].append(("not solved", f"no answer: {type(error).__name__}", 0.0, 0))
    lines = [HEAD, "|---" * 10 + "|"]
    refused: Counter[tuple[str, str]] = Counter()
    for family, rows in found.items():
        how = Counter(row[1] for row in rows)
        kinds = ("proved exactly", "enclosed", "bounds that differ", "one bound")
        cost = [row[2] for row in rows if row[1] in kinds] or [float("nan")]
        cells = [family, len(rows), *(how[x] for x in kinds), sum(n for x, n in how.items() if x not in kinds),
                 max(row[3] for row in rows), f"{np.median(cost):.2g}", f"{np.quantile(cost, 0.9):.2g}"]  # fmt: skip
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
        refused.update((row[0], row[1]) for row in rows if row[1] not in kinds)
    total = sum(len(rows) for rows in found.values())
    lines += ["", f"{total - refused.total()} of {total} were proved. What was not, by the outcome of the solve:", ""]
    lines += ["| outcome | why not | models |", "|---|---|---|"]
    lines += [f"| {outcome} | {words} | {n} |" for (outcome, words), n in refused.most_common()]
    return lines


def fractions() -> list[str]:
    """Return the multipliers of walls and arches as fractions, in lines of Markdown."""
    models = {
        f"wall {name}": concio.wall_of_courses(
            [COURSES[c] for c in courses], block_size=(0.4, 0.175), friction=0.65,
            block=concio.Rigid(unit_weight=1.0), horizontal=1.0,
        )
        for name, courses in WALLS.items()
    }  # fmt: skip
    models |= {
        f"arch of {n} voussoirs": concio.arch(
            span=4.0, ring=0.5, voussoirs=n, friction=0.7, crown_load=2.0, unit_weight=25.0, block="rigid"
        )
        for n in (9, 27, 100)
    }
    lines = ["| structure | blocks | joint points | multiplier | digits of the fraction | both sides equal | cost |",
             "|---|---|---|---|---|---|---|"]  # fmt: skip
    for name, model in models.items():
        start = time.perf_counter()
        assembly = concio.assemble(model)
        result = concio.limit(assembly, path=False, steps=False, search=False)
        solved = time.perf_counter()
        made = result.proof(numbers="decimal")
        cost = (time.perf_counter() - solved) / (solved - start)
        recompute(made)
        low, high = (Fraction(made[side]) if side in made else None for side in ("lower", "upper"))
        value = high if low is None else low
        assert value is not None
        digits = f"{len(str(abs(value.numerator)))} over {len(str(value.denominator))}"
        same = "yes" if low == high else "no"
        cells = (name, len(model.free_bodies), len(assembly.pairs), f"{float(value):.12g}", digits, same, f"{cost:.2g}")
        lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    return lines


def main() -> None:
    """Print the tables, and write them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--walls", action="store_true")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    asked("limit, wall", drawn(np.random.default_rng(0), "limit, wall"), np.random.default_rng(0))  # loads what is lazy
    lines = corpus(given.count, given.seed) if given.count else []
    if given.walls:
        lines += ["", *fractions()]
    print("\n".join(lines))
    if given.out:
        given.out.write_text(TITLE + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
