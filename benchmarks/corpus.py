"""A corpus of random problems: every verdict must be a proof, and almost every problem must get one.

    python benchmarks/corpus.py [--count 504] [--seed 0] [--first 0] [--list]

Walls and panels of random bond, shape, friction, load share (0 to 1.3 times the associated limit), gaps, materials,
supports; rigid blocks are given the compliance that ``concio.solve`` lends them. For each: the verdict of ``auto``, its
proof recomputed here from the original arrays, and the reason where there is none. Prints a table by family, one by
strategy (how often it was tried and decided, its processor time) and the undecided problems with what was tried.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import replace

import numpy as np

import concio
from concio.analysis.lent_compliance import lend
from concio.contact.assembly import Assembly
from concio.problem.certificate import certify
from concio.problem.solution import Solution, Status
from concio.solvers.auto.chain import STRATEGIES
from concio.solvers.methods import find
from concio.solvers.relaxation.unbounded_motion import verify_motion
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.mechanism import verify_mechanism

FAMILIES = ("dry wall", "dry panel", "mortar panel", "no base", "gaps", "loose blocks", "rigid wall", "mixed materials")

DECIDED = ("SOLVED", "NO_EQUILIBRIUM", "COLLAPSES", "NO_COULOMB_STATE")
"""Verdicts that are proofs."""


def draw(rng: np.random.Generator, family: str) -> tuple[Assembly, np.ndarray, dict[str, object]]:
    """Return an assembly, the loads of one step (free unknowns), and what was drawn."""
    mu = float(rng.uniform(0.2, 1.2))
    courses, blocks = int(rng.integers(2, 9)), int(rng.integers(2, 9))
    size = (0.2 * float(rng.uniform(0.5, 2.0)), 0.1 * float(rng.uniform(0.5, 2.0)))
    elements = (int(rng.choice([2, 4])), int(rng.choice([1, 2])))
    nu = float(rng.uniform(0.0, 0.3))
    block: concio.Elastic | concio.Rigid = concio.Elastic(E=10 ** rng.uniform(4, 7), nu=nu, unit_weight=20.0)
    options: dict[str, object] = {"base": "full", "side_walls": bool(rng.integers(2)), "elements_per_block": elements}
    if family == "dry wall":
        options["side_walls"] = False
    elif family == "mortar panel":
        options["joint"] = 0.1 * size[1]
        courses, blocks = min(courses, 5), min(blocks, 5)
        soft = 10 ** rng.uniform(-4, 0)
        options["mortar"] = concio.Elastic(E=block.E * soft, nu=nu, unit_weight=18.0)
    elif family == "no base":
        options["base"] = str(rng.choice(["none", "bearings"]))
        options["side_walls"] = True
        options["top_pressure"] = 10.0
        block = replace(block, unit_weight=float(rng.choice([0.0, 20.0])))
    elif family == "gaps":
        options["side_walls"] = True
        options["side_gap"] = 10 ** rng.uniform(-7, -3)
        options["top_pressure"] = float(rng.uniform(0, 50))
    elif family == "loose blocks":
        block = replace(block, unit_weight=0.0)
    elif family == "rigid wall":
        block = concio.Rigid(unit_weight=20.0)
        options["side_walls"] = False
    model = concio.running_bond_panel(
        courses=courses, blocks=blocks, block_size=size, block=block, friction=mu, **options  # type: ignore[arg-type]
    )
    if family == "mixed materials":
        stiff = {f"m{k}": concio.Elastic(E=10 ** rng.uniform(4, 8), nu=nu, unit_weight=20.0) for k in range(4)}
        bodies = tuple(b if b.kind == "fixed" else replace(b, material=f"m{rng.integers(4)}") for b in model.bodies)
        model = replace(model, bodies=bodies, materials=stiff)
    assembly = concio.assemble(model)
    disc = assembly.disc
    pull = assembly.supported.T.T
    weights = np.zeros(disc.unknowns)
    for b, s in enumerate(disc.shape_of):
        at = disc.offsets[b]
        if s >= 0:
            weights[at : disc.offsets[b + 1] : 2] = disc.shapes[s].volume_weights
        elif s == -1:
            weights[at] = model.bodies[b].area * model.bodies[b].thickness
    dead = pull @ assembly.load()
    live = pull @ (20.0 * weights)
    note: dict[str, object] = {"mu": round(mu, 3), "courses": courses, "blocks": blocks, "family": family}
    if family == "loose blocks":  # one or two forces on a few blocks, the others carry nothing
        dead = np.zeros_like(dead)
        for b in rng.choice(np.flatnonzero(disc.shape_of >= 0), size=2, replace=False):
            at = slice(disc.offsets[b], disc.offsets[b + 1])
            share = np.zeros(disc.unknowns)
            share[at] = weights[at]
            angle = rng.uniform(-0.5, 0.5)
            dead += pull @ (20.0 * (np.sin(angle) * share - np.cos(angle) * np.roll(share, 1)))
        return assembly, dead, note
    share = 0.0
    if family != "no base":
        limit = associated_limit(assembly.problem().with_loads(dead), live).multiplier
        share = float(rng.uniform(0.0, 1.3)) * (limit if np.isfinite(limit) and limit < 10 else 1.0)
        note["alpha / alpha*"] = round(share / limit, 4) if np.isfinite(limit) and limit else None
    return assembly, dead + share * live, note


def proven(problem: concio.problem.contact_problem.ContactProblem, solution: Solution) -> bool:
    """Return whether the verdict's proof holds, recomputed from the arrays of the problem."""
    if solution.status is Status.SOLVED:
        s = solution
        return certify(problem, s.displacement, s.normal_force, s.friction_force).worst <= 1e-9
    if solution.status is Status.NO_EQUILIBRIUM and solution.mechanism is not None:
        again = verify_mechanism(problem, solution.mechanism.velocity)
        return again.violation <= 1e-9 and again.power > 0
    if solution.status is Status.COLLAPSES and solution.departure is not None:
        d = solution.departure
        return verify_motion(problem, d.acceleration, d.displacement, d.normal_force, d.friction_force).certified
    return solution.status is Status.NO_COULOMB_STATE  # its exclusions were recomputed as they were made


def main() -> None:
    """Run the corpus and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=504)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--list", action="store_true", help="print every problem")
    arguments = parser.parse_args()
    table: dict[str, Counter[str]] = {family: Counter() for family in FAMILIES}
    left, seconds, wrong = [], 0.0, 0
    tried: Counter[str] = Counter()
    decided_by: dict[str, Counter[str]] = {}
    spent_by: Counter[str] = Counter()
    for k in range(arguments.first, arguments.first + arguments.count):
        family = FAMILIES[k % len(FAMILIES)]
        assembly, f, note = draw(np.random.default_rng([arguments.seed, k]), family)
        problem = lend(assembly).problem().with_loads(f)
        begin = time.process_time()
        solution = find("auto")(problem)
        spent = time.process_time() - begin
        seconds += spent
        verdict = solution.status.name
        for name, cost in solution.info.get("cost", ()):
            tried[name] += 1
            spent_by[name] += cost
        decided_by.setdefault(str(solution.info.get("strategy", "at rest")), Counter())[verdict] += 1
        if verdict in DECIDED and not proven(problem, solution):
            verdict, wrong = "WRONG", wrong + 1
        table[family][verdict] += 1
        if arguments.list or verdict not in DECIDED:
            line = f"#{k} {note} pairs {problem.pairs} {verdict} {spent:.2f} s by {solution.info.get('strategy')}"
            print(line, flush=True)
            if verdict not in DECIDED:
                left.append((line, solution.trace))
    names = (*DECIDED, "UNDECIDED", "GAVE_UP", "WRONG")
    print(f"\n{'family':18s}" + "".join(f"{n:>18s}" for n in names))
    total: Counter[str] = Counter()
    for family, counts in table.items():
        total += counts
        print(f"{family:18s}" + "".join(f"{counts[n]:18d}" for n in names))
    count = sum(total.values())
    decided = sum(total[n] for n in DECIDED)
    print(f"{'all':18s}" + "".join(f"{total[n]:18d}" for n in names))
    print(f"\n{decided} of {count} decided ({100 * decided / count:.2f} %), {wrong} wrong, {seconds:.0f} s in all")
    print(f"\n{'strategy':30s}{'tried':>8s}{'decided':>9s}{'CPU s':>9s}   verdicts")
    for name in dict.fromkeys((*(s.name for s in STRATEGIES if 2 in s.dimensions), *decided_by)):
        verdicts = decided_by.get(name, Counter())
        words = ", ".join(f"{n} {v.lower()}" for v, n in verdicts.most_common())
        print(f"{name:30s}{tried[name]:8d}{sum(verdicts.values()):9d}{spent_by[name]:9.1f}   {words}")
    for line, trace in left:
        print(line + "\n    " + "\n    ".join(trace))


if __name__ == "__main__":
    main()
