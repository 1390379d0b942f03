"""What ``concio run`` prints: a result in a few lines, every number with its unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.display import counted
from concio.problem.solution import Status
from concio.verdict.step_verdict import power_words

if TYPE_CHECKING:
    from concio.analysis.result import Result

MOST_REACTIONS = 12
"""More supports than this are not listed one by one."""
MOST_FINDINGS = 12
"""More lines of one kind than this are counted; the report holds all."""
MOST_MOVING = 6
SLOW = 0.01
"""Bodies slower than this share of the fastest are not said to move."""


def result_lines(result: Result) -> list[str]:
    """Return the result as lines of text, in the units of the model's report."""
    s, seconds, units = result.solution, result.seconds, result.model.report
    assembly = result.assembly
    lines = [
        result.model.title or "model without a title",
        f"  {counted(len(result.model.free_bodies), 'body', 'bodies')}, "
        f"{counted(len(assembly.detection.interfaces), 'joint')}, "
        f"{counted(len(assembly.pairs), 'contact pair')}, {counted(assembly.disc.unknowns, 'displacement')}",
        result.sentence,
        *result.verdict.lines(units, most=MOST_FINDINGS),
        f"  {result.solved_by}: {s.iterations} iterations, {seconds['solve']:.2f} s; "
        f"assembled in {seconds['assemble']:.2f} s",
    ]
    certificate = result.certificate.as_dict()
    if result.solved:
        parts = ", ".join(f"{k.replace('_', ' ')} {v:.0e}" for k, v in certificate.items() if k != "worst")
        lines += [
            f"  certificate  worst {certificate['worst']:.1e} ({parts})",
            *_existence(result),
            f"  pairs        {_states(result)}",
            f"  settlement   {units.text('motion', result.max_settlement, 4)} at most",
            f"  loads        {units.force_vector(result.total_load)} in all",
        ]
        reactions = list(result.reactions.items())
        largest = max((float(np.linalg.norm(value)) for _, value in reactions), default=0.0)
        shown = reactions[:MOST_REACTIONS]
        width = max((len(name) for name, _ in shown), default=0)
        for k, (name, value) in enumerate(shown):
            told = units.force_vector(value, size=largest)
            lines.append(f"  {'reactions' if k == 0 else '':<12} {name:<{width}}  {told}")
        if len(reactions) > len(shown):
            lines.append(f"  {'':<12} ... and {len(reactions) - len(shown)} more")
        lines += tie_lines(result)
    elif result.mechanism is not None:
        word = "motion" if result.status is Status.COLLAPSES else "mechanism"
        moving = [f"'{name}'" for name, speed in moving_bodies(result) if speed > SLOW]
        more = f" and {len(moving) - MOST_MOVING} more" if len(moving) > MOST_MOVING else ""
        lines += [
            f"  {word:<12} {power_words(result.mechanism.power, units)}",
            f"  moves        {', '.join(moving[:MOST_MOVING])}{more}",
        ]
    else:
        lines += [f"  tried        {line}" for line in s.trace]
        if np.isfinite(certificate["worst"]):
            lines.append(f"  certificate  worst {certificate['worst']:.1e}: not an equilibrium")
    return lines


def _existence(result: Result) -> list[str]:
    """Return the paper's sufficient condition in a line, for problems where its linear programme is quick."""
    from concio.problem.limits_of_work import LARGEST_EXISTENCE

    if not 0 < len(result.assembly.pairs) <= LARGEST_EXISTENCE:
        return []
    condition = result.existence
    if not condition.holds:
        return ["  existence    not guaranteed beforehand: normal forces alone cannot carry the loads"]
    margin = "without limit"
    if np.isfinite(condition.margin):
        margin = f"by {result.model.report.text('force', condition.margin)} at least"
    return [f"  existence    guaranteed: positive normal forces alone balance the loads, {margin}"]


def tie_lines(result: Result) -> list[str]:
    """Return the force in each tie, whether it yields, and how far it is stretched."""
    ties, units = result.ties, result.model.report
    bars = [k for k, tie in enumerate(result.model.ties) if tie.kind == "bar"]
    soil = [k for k, tie in enumerate(result.model.ties) if tie.kind == "soil"]
    pressed = ties.tension[soil]
    told = [
        f"  soil         presses {int((pressed > 0).sum())} of {len(soil)} faces with "
        f"{units.text('force', float(pressed.sum()), 4)} in all, "
        f"{sum(ties.state[k] == 'yields' for k in soil)} with all of its passive pressure"
    ] if soil else []  # fmt: skip
    return [*_bar_lines(result, bars), *told]


def _bar_lines(result: Result, bars: list[int]) -> list[str]:
    ties, units = result.ties, result.model.report
    largest = float(np.abs(ties.tension).max(initial=0.0))
    width = max((len(ties.names[k]) for k in bars), default=0)
    lines = []
    for i, k in enumerate(bars):
        name, tension, far, state = ties.names[k], float(ties.tension[k]), float(ties.elongation[k]), ties.state[k]
        told = f"{units.text('force', tension, 4, size=largest)} of tension"
        stretched = "" if state == "slack" else f", stretched by {units.text('motion', far, 4)}"
        word = {"slack": ", slack", "yields": ", yields"}.get(state, "")
        lines.append(f"  {'ties' if i == 0 else '':<12} {name:<{width}}  {told}{word}{stretched}")
    return lines


def moving_bodies(result: Result) -> list[tuple[str, float]]:
    """Return the names of the bodies with their largest velocities in the mechanism, fastest first and 1."""
    velocity = result.mechanism_velocity
    if velocity is None:
        return []
    speeds = []
    for b, body in enumerate(result.model.bodies):
        if body.kind != "fixed":
            motion = result.node_displacement(b, velocity)
            speeds.append((body.name, float(np.linalg.norm(motion, axis=1).max())))
    fastest = max(speed for _, speed in speeds)
    return sorted(((name, speed / fastest) for name, speed in speeds), key=lambda entry: -entry[1])


def _states(result: Result) -> str:
    words = {"open": "open", "stick": "sticking", "slip": "slipping"}
    return ", ".join(f"{result.contacts.count(name):,} {word}" for name, word in words.items())
