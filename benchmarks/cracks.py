"""Random synthetic cracks: how often the cause is found, whether intervals hold, what is reported as ambiguous.

    python benchmarks/cracks.py [--cases 200] [--seed 0] [--first 0] [--wrong] [--minutes 60] [--each 120]
                                [--family "flat arch"] [--family portal]

Every case draws a structure (flat arch, round arch, portal of three piers with lintels and courses), one or two of its
candidate motions with random sizes, and up to eight measurements: openings at joints that are open, two joints that are
closed, a level. The readings come from a path of 64 steps, the diagnosis takes its own; Gaussian errors of 0.5 mm
are added. With ``--wrong`` one opening is made wrong (its unit or its place) or a level (its sign), and the share
named is reported. One line a case, the table at the end, or after so many minutes; processor seconds. A case that
takes more than ``--each`` processor seconds is stopped between two choices of motions, and counted as such.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import concio
from concio import Candidate, Measurement
from concio.analysis.cracks.diagnosis import Diagnosis
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.moved import moved_model
from concio.analysis.cracks.observed import Reading, readings
from concio.analysis.cracks.places import all_places
from concio.problem.solution import Progress

ERROR = 0.5e-3
TRUE_STEPS = 64
FAMILIES = ("flat arch", "round arch", "portal")
Array = np.ndarray


@dataclass(frozen=True)
class Case:
    """A structure with its true cause and its measurements.

    Parameters
    ----------
    family : str
    model : concio.Model
    candidates : list of Candidate
    truth : (k,) array
    measurements : list of Measurement
    wrong : str
        Name of the measurement that was made wrong; empty for none.
    """

    family: str
    model: concio.Model
    candidates: list[Candidate]
    truth: Array
    measurements: list[Measurement]
    wrong: str = ""


def portal(rng: np.random.Generator) -> concio.Model:
    """Return three piers on grounds of their own under two lintels and four courses, with joints of mortar."""
    span, height = rng.choice([1.0, 1.5]), rng.choice([1.0, 1.5])
    length = 3.0 + 2 * span
    doors = [{"x": 1.0 + k * (1.0 + span), "y": 0.0, "width": span, "height": height, "lintel": 0.5} for k in range(2)]
    wall = concio.wall(
        length=length, height=height + 1.5, block_size=(1.0, 0.5), friction=rng.uniform(0.5, 0.8), block="rigid",
        unit_weight=20.0, thickness=0.5, openings=doors,
    )  # fmt: skip
    square = np.array([[0.0, -0.5], [1.0, -0.5], [1.0, 0.0], [0.0, 0.0]])
    ground = [
        concio.Body(f"ground {k + 1}", square + np.array([k * (1.0 + span), 0.0]), kind="fixed", role="ground")
        for k in range(3)
    ]
    laws = {k: replace(v, normal_stiffness=1e6, tangential_stiffness=4e5) for k, v in wall.laws.items()}
    return replace(wall, bodies=(*(b for b in wall.bodies if b.kind != "fixed"), *ground), laws=laws)


def structure(family: str, rng: np.random.Generator) -> tuple[concio.Model, list[Candidate]]:
    """Return a random structure of a family with its candidates."""
    if family == "portal":
        sinks = [Candidate(f"pier {k} sinks", body=f"ground {k}", direction=(0, -1), low=0.0) for k in (1, 2, 3)]
        return portal(rng), [
            *sinks, Candidate("pier 2 turns", body="ground 2", rotation=1),
            Candidate("pier 3 gives way", body="ground 3", direction=(1, 0), low=0.0),
            Candidate("pier 3 turns", body="ground 3", rotation=1),
        ]  # fmt: skip
    if family == "flat arch":
        model = concio.arch(
            shape="flat", span=rng.uniform(1.0, 2.0), ring=rng.uniform(0.3, 0.5), voussoirs=int(rng.integers(3, 6)) * 2,
            skew=rng.uniform(65, 75), block="rigid", friction=2.0, unit_weight=22.0,
        )  # fmt: skip
    else:
        model = concio.arch(
            span=rng.uniform(2.0, 4.0), ring=rng.uniform(0.45, 0.7), voussoirs=int(rng.integers(4, 8)) * 2 + 1,
            block="rigid", friction=rng.uniform(0.7, 1.0), unit_weight=22.0,
        )  # fmt: skip
    bodies = [b.name for b in model.bodies if b.kind == "fixed"]
    return model, [
        Candidate("left gives way", body=bodies[0], direction=(-1, 0), low=0.0),
        Candidate("left sinks", body=bodies[0], direction=(0, -1), low=0.0),
        Candidate("right sinks", body=bodies[1], direction=(0, -1), low=0.0),
        Candidate("left turns", body=bodies[0], rotation=1),
        Candidate("right turns", body=bodies[1], rotation=1),
    ]


def draw(number: int, seed: int, wrong: bool) -> Case | None:
    """Return a random case; None where its motions are not reached, or open fewer than three joints."""
    rng = np.random.default_rng([seed, number])
    family = FAMILIES[number % len(FAMILIES)]
    model, candidates = structure(family, rng)
    truth = np.zeros(len(candidates))
    for c in rng.choice(len(candidates), size=int(rng.integers(1, 3)), replace=False).tolist():
        one = candidates[c]
        size = rng.uniform(8e-3, 30e-3) if one.direction else rng.uniform(4e-3, 15e-3)
        truth[c] = size * (1 if one.low == 0 else rng.choice([-1, 1]))
    scale = np.array([0.02 if c.direction else 0.01 for c in candidates])
    moved = moved_model(model, candidates, scale)
    forward = Forward.of(concio.assemble(moved.model), moved, (), "steps", TRUE_STEPS)
    state = forward.predict(truth)
    if not state.reached:
        return None
    places = [r for kind, r in all_places(forward) if kind == "opening"]
    values = forward.read(places, state.displacement, state.factors)
    wide = np.flatnonzero(values > 4 * ERROR)
    shut = np.flatnonzero(np.abs(values) < 0.2 * ERROR)
    if len(wide) < 3 or len(shut) < 2:
        return None
    names = [b.name for b in model.bodies]
    joints = [(names[r.bodies[0]], names[r.bodies[1]]) for r in places]
    measured = [
        Measurement(
            f"K{k}", "opening", ERROR, max(0.0, float(values[i] + rng.normal(0, ERROR))), joints[i], at=at_of(places[i])
        )
        for k, i in enumerate(rng.choice(wide, size=min(5, len(wide)), replace=False).tolist(), 1)
    ]  # fmt: skip
    measured += [
        Measurement(f"C{k}", "closed", ERROR, joint=joints[i], at=at_of(places[i]))
        for k, i in enumerate(rng.choice(shut, size=2, replace=False).tolist(), 1)
    ]
    free = [b for b in model.bodies if b.kind != "fixed"]
    body = free[int(rng.integers(len(free)))]
    at = tuple(np.asarray(body.centroid).tolist())
    level = Measurement("L", "level", ERROR, body=body.name, at=at)
    reading = readings(forward.assembly, [level])
    drop = float(forward.read(reading, state.displacement, state.factors)[0] + rng.normal(0, ERROR))
    measured.append(replace(level, value=drop))
    spoiled = ""
    if wrong:
        which = -1 if rng.integers(3) == 0 and abs(measured[-1].value) > 6 * ERROR else 0
        spoiled = measured[which].name
        if which:
            measured[which] = replace(measured[which], value=-measured[which].value)
        else:
            measured[which] = spoil(measured[which], rng, places, values, joints)
    return Case(family, model, candidates, truth, measured, spoiled)


def at_of(reading: Reading) -> tuple[float, ...]:
    """Return the place of a reading."""
    return tuple(reading.at.tolist())


def spoil(
    m: Measurement, rng: np.random.Generator, places: list[Reading], values: Array, joints: list[tuple[str, str]]
) -> Measurement:
    """Return an opening in a wrong unit, or at a wrong place."""
    if rng.integers(2):
        return replace(m, value=float(m.value * rng.choice([10.0, 0.1])))
    other = [i for i in range(len(places)) if joints[i] != m.joint and abs(values[i] - m.value) > 6 * ERROR]
    i = int(rng.choice(other)) if other else 0
    return replace(m, joint=joints[i], at=at_of(places[i]))


def kind_of(case: Case, found: Diagnosis) -> str:
    """Return what a diagnosis comes to beside the truth."""
    true = set(np.flatnonzero(case.truth).tolist())
    sets = [set(c.chosen) for c in found.causes]
    if not sets:
        return "found, a measurement doubted" if true in [set(d.cause.chosen) for d in found.doubts] else "none"
    if true in sets:
        return "found" if len(sets) == 1 else "ambiguous"
    if any(s < true for s in sets):
        better = [set(a.cause.chosen) for a in found.additions if a.cause is not None]
        word = "simpler, the true one clearly better" if true in better else "simpler"
        return word if len(sets) == 1 else f"ambiguous, {word}"
    return "missed"


def until(moment: float) -> Callable[[Progress], None]:
    """Return what stops a diagnosis once the processor time of this process has come to a moment [s]."""

    def stop(_: Progress) -> None:
        if time.process_time() > moment:
            raise TimeoutError

    return stop


def main() -> None:
    """Print a line a case, and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--wrong", action="store_true")
    parser.add_argument("--minutes", type=float, default=np.inf)
    parser.add_argument("--each", type=float, default=np.inf)
    parser.add_argument("--family", action="append", choices=FAMILIES)
    arguments = parser.parse_args()
    kinds: Counter[tuple[str, str]] = Counter()
    seconds, named, asked, done, drawn, number = [], [], [], 0, 0, arguments.first
    within = np.zeros(2, dtype=int)
    started = time.monotonic()
    while done < arguments.cases and time.monotonic() - started < 60 * arguments.minutes:
        number += 1
        if FAMILIES[(number - 1) % len(FAMILIES)] not in (arguments.family or FAMILIES):
            continue
        drawn += 1
        case = draw(number - 1, arguments.seed, arguments.wrong)
        if case is None:
            continue
        done += 1
        begin = time.process_time()
        stop = until(begin + arguments.each)
        try:
            found = concio.diagnose(case.model, case.measurements, case.candidates, most=2, large=False, progress=stop)
        except TimeoutError:
            kinds[case.family, "stopped"] += 1
            print(f"{number - 1} {case.family}: stopped after {time.process_time() - begin:.0f} s", flush=True)
            continue
        finally:
            seconds.append(time.process_time() - begin)
        kind = kind_of(case, found)
        kinds[case.family, kind] += 1
        true = set(np.flatnonzero(case.truth).tolist())
        added = [a.cause for a in found.additions if a.cause is not None]
        causes = [*found.causes, *(d.cause for d in found.doubts), *added]
        doubts = [f"{d.measurement} {d.mistake}" for d in found.doubts]
        if case.wrong:
            named.append(case.wrong in [d.measurement for d in found.doubts])
            asked.append(named[-1] or found.verdict.exit_code != 0)
            kind += f" ({case.wrong} wrong: {'named' if named[-1] else 'not named'})"
        told = ", ".join(f"{c.names} {c.misfit:.1f}" for c in causes)
        right = [c for c in causes if set(c.chosen) == true]
        ends = [e for c in right for e in zip(c.chosen, c.low.tolist(), c.high.tolist(), strict=True)]
        inside = [sum(bool(a <= case.truth[k] <= b) for k, a, b in ends), len(ends)]
        within += np.array(inside)
        worst = f"order {found.orders:.1f}, finer {found.refinement:.2f}; inside {inside}"
        line = f"{number - 1} {case.family}: {kind} {sorted(true)} {found.verdict.status} {doubts} {told}; {worst}"
        print(f"{line}; {found.forward.steps} steps, {seconds[-1]:.1f} s", flush=True)
    print("\n| family | " + " | ".join(sorted({k for _, k in kinds})) + " |")
    for family in FAMILIES:
        print(f"| {family} | " + " | ".join(str(kinds[family, k]) for k in sorted({k for _, k in kinds})) + " |")
    print(f"{done} cases of {drawn} drawn; {np.mean(seconds):.1f} s a case, {np.max(seconds):.1f} s "
          f"at most\nintervals hold {within[0]} of {within[1]} ({100 * within[0] / within[1]:.1f} %)")  # fmt: skip
    if named:
        print(f"wrong measurements named: {sum(named)} of {len(named)}; not passed in silence: {sum(asked)}")


if __name__ == "__main__":
    main()
