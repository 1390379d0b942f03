"""What a limit load is reported as: each number with what it is and how it was checked."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from concio.display import number
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.verdict.limit_verdict import limit_question, limit_verdict
from concio.verdict.verdict import Verdict

if TYPE_CHECKING:
    from concio.analysis.limit_result import LimitResult
    from concio.analysis.margins import Margin
    from concio.solvers.statics.friction import FrictionBounds

NOT_ASKED = "not asked for"
NO_LOAD = 1e-9
"""A collapse state at a multiplier below this is that without any load, where nothing else acts."""

REST = " " * 23
"""Where a number is reported on."""


def question_lines(found: LimitResult) -> list[str]:
    """Return which group is multiplied, by how many kN, and which groups act constantly."""
    question, units = limit_question(found), found.assembly.model.report
    lines = [f"  asked                {question.asked}"]
    acting = [replace(a, factor=math.nan) if a.role == "multiplied" else a for a in question.acting]
    return [*lines, *(f"  acts                 {a.sentence(units)}" for a in acting)]


def limit_lines(found: LimitResult) -> list[str]:
    """Return all that is known in words: the answer first, the question, then every number with what it is."""
    verdict = limit_verdict(found)
    head = [found.assembly.model.title or "model without a title", verdict.sentence, *question_lines(found)]
    return [*head, *number_lines(found), *rest_lines(verdict)]


def number_lines(found: LimitResult) -> list[str]:
    """Return every number with what it is."""
    lines = [*bound_lines(found), *stage_lines("friction", found)]
    lines += step_lines(found) if found.steps is not None else []
    lines += collapse_lines(found) if found.search != NOT_ASKED else []
    return [*lines, *one_step_lines(found), *spread_lines(found), *path_lines(found)]


def rest_lines(verdict: Verdict) -> list[str]:
    """Return what proves, limits and surrounds an answer."""
    parts = (
        ("proof", (verdict.proof,) if verdict.proof else ()),
        ("assumed", verdict.question.assumptions),
        ("limits", verdict.limits),
        ("attention", verdict.attention),
    )
    return [f"  {head:<21}{line}" for head, lines in parts for line in lines]


def stage_lines(name: str, found: LimitResult) -> list[str]:
    """Return the number that was found last in words."""
    if name == "bound":
        return bound_lines(found)
    if name == "friction":
        return [] if found.friction is None else [margin_line(found.friction)]
    if name == "steps":
        return step_lines(found)
    if name == "collapse state":
        return collapse_lines(found)
    if name == "in one step":
        return one_step_lines(found)
    if name == "spread":
        return spread_lines(found)
    return path_lines(found)


def named(found: LimitResult) -> str:
    """Return the live groups in words."""
    return "' and '".join(found.groups)


def bound_lines(found: LimitResult) -> list[str]:
    """Return the associated bound, and what the load as given is beside it."""
    bound = found.associated
    if math.isinf(bound.multiplier):
        return ["  associated bound     locked, so that it bounds nothing: Coulomb friction does not wedge in that way"]
    if math.isnan(bound.multiplier):
        return ["  associated bound     none: no multiple of the load was found to be in balance"]
    violation = bound.mechanism.violation if bound.mechanism else math.nan
    residuals = f"forces {bound.residual:.0e}, mechanism {violation:.0e}, gap {bound.gap:.0e}"
    if bound.checked or not bound.bounds_hold:
        state = "checked from both sides" if bound.checked else "NOT checked"
        lines = [
            f"  associated bound     {bound.multiplier:.6g} times '{named(found)}': no equilibrium beyond it",
            f"{REST}{state}: {residuals}",
        ]
    else:
        lines = [
            f"  associated bound     between {bound.multiplier:.9g}, carried, and {bound.upper:.9g}, not exceeded",
            f"{REST}each is checked, but they do not meet: {residuals}",
        ]
    return [*lines, *([f"  load as given        {as_given(bound.multiplier)}"] if beyond(bound.multiplier) else [])]


def beyond(multiplier: float) -> bool:
    """Whether the load as given is a share of its bound that says something: a unit load beyond it is none."""
    return multiplier >= 1


def as_given(multiplier: float) -> str:
    """Return what a bound on the multiplier says of the load as given."""
    if multiplier > 1:
        return f"{number(100 / multiplier)} % of that bound: it could grow {number(multiplier)} times at most"
    if multiplier == 1:
        return "equal to that bound"
    if multiplier > 0:
        return (
            f"{number(1 / multiplier)} times that bound: only {number(100 * multiplier)} % of it can be carried "
            f"at most"
        )
    return "not carried, nor is any fraction of it"


def margin_line(margin: FrictionBounds) -> str:
    """Return the friction margin in words: it is that of admissible forces, hence a bound."""
    head = "  friction             "
    if margin.factor == 0:
        return f"{head}the load as given can be carried without any"
    if margin.factor == float("inf"):
        shown = margin.below > 0
        return f"{head}no friction carries the load as given" if shown else f"{head}undecided: no factor could be shown"
    if not margin.settled:
        low = f"{margin.below:.6g} is shown to be too little" if margin.below > 0 else "none is shown to be too little"
        return f"{head}forces balance the load as given within {margin.factor:.6g} times the coefficients given; {low}"
    return f"{head}the load as given needs at least {margin.factor:.6g} times the coefficients given"


def solving_line(name: str, margin: Margin) -> str:
    """Return what bisection with solved load steps found, in words."""
    head = f"  {name + ', by solving':21s}"
    if margin.holds != margin.holds:
        given = "friction" if name == "friction" else "the constant loads"
        return f"{head}no equilibrium was found with {given} as given"
    if margin.holds == float("inf"):
        return f"{head}no load bounds it"
    found = f"{head}a certified Coulomb equilibrium at {margin.holds:.6g} times what is given"
    return found if margin.fails != margin.fails else f"{found}, none found at {margin.fails:.6g}"


def step_lines(found: LimitResult) -> list[str]:
    """Return what the load steps show: what is carried at least, by certified states."""
    steps = found.steps
    assert steps is not None
    head = "  Coulomb load steps   "
    if not steps.multipliers:
        alone = found.dead or steps.dead
        said = "is not carried" if alone in PROVEN_FAILURES else "reached no certified state"
        return [f"{head}none: under the constant loads alone it {said} ({alone.name.lower()})"]
    if found.associated.locked and steps.state is None:
        said = (
            "is carried, and so is every other" if found.endless else "is not carried "
            f"({one_word(steps.outcome)}), nor is any other"
        )
        return [f"{head}1 times it {said}: nothing else acts, and all multiples are equal"]
    tried = "" if math.isnan(steps.failed) else f"; none found at {steps.failed:.6g}"
    count = f"{len(steps.multipliers)} certified states from the constant loads on"
    return [f"{head}carried up to {steps.carried:.6g} at least: {count}{tried}"]


def one_word(outcome: Status | None) -> str:
    """Return an outcome as the word of ``--json``."""
    return "unknown" if outcome is None else outcome.name.lower()


def one_step_lines(found: LimitResult) -> list[str]:
    """Return what comes in space of the least load that the steps did not reach, applied in one step."""
    steps = found.steps
    if steps is None or found.assembly.model.dim == 2 or not steps.failed < found.associated.multiplier:
        return []
    head = f"  in one step          {steps.failed:.6g} "
    if steps.outcome is None:
        known = found.collapse_state is not None and found.collapse_state.multiplier <= steps.carried
        why = "by default, since a collapse state below it is known" if known else "by default"
        return [f"{head}was not tried {why} (--steps tries it)"]
    if steps.outcome is Status.SOLVED:
        return [f"{head}also has an equilibrium, which the growing load did not reach"]
    said = steps.outcome.value[0].lower() + steps.outcome.value[1:]
    proven = steps.outcome in PROVEN_FAILURES
    return [f"{head}is not carried: {said}" if proven else f"{head}is left open: {said}"]


def spread_lines(found: LimitResult) -> list[str]:
    """Return what load steps carry with the pressure of joints that twist spread over them."""
    if found.spread is None:
        return []
    n, steps = found.spread.points, found.spread.steps
    above = "" if math.isnan(steps.failed) else f", {found.spread.not_reached:.6g} not reached"
    said = (
        "carried up to "
        f"{found.spread.carried:.6g}{above}" if steps.multipliers else "none: no certified state of the constant loads"
    )
    if not n:
        return [f"  pressure spread      {said}, in finer steps, less the overestimate in joints that twist"]
    return [
        f"  pressure spread      {said}, with {n} x {n} points in each joint: some twist, and contact at corners "
        "overestimates their strength"
    ]


def collapse_lines(found: LimitResult) -> list[str]:
    """Return the collapse state in words, or why there is none."""
    head = "  collapse state       "
    if found.collapse_state is None:
        return [f"{head}{found.search}"]
    value = found.collapse_state.multiplier
    if found.endless and abs(value) < NO_LOAD:
        return [f"{head}none counts: the one found is that without any load"]
    if not found.state_counts:
        return [
            f"{head}{value:.6g} is not counted: it depends on where the pressure acts in a joint that twists "
            f"({found.search})"
        ]
    return [f"{head}{value:.6g}: there Coulomb friction lets it begin to move ({found.search})"]


def path_lines(found: LimitResult) -> list[str]:
    """Return the Coulomb path in words: a collapse multiplier where one is shown, else what is carried at least."""
    path, head = found.path, "  Coulomb load path    "
    if path is None:
        ask = " (--path follows it)" if "by default" in found.path_note else ""
        return [] if found.path_note == NOT_ASKED else [f"{head}{found.path_note}{ask}"]
    most = "no certified state carries more, and the structure can move at that load or provably not carry it"
    end = {
        "REACHED": "continued under constant load until it had moved far" if found.collapse_shown
        else "followed no further",
        "MECHANISM": "a mechanism has formed that moves without change of load",
        "LIMIT": most,
        "CANCELLED": "stopped on request",
        "TOO_MANY": "stopped after more events than allowed",
    }.get(path.outcome.name, "could not be continued: no certified state was found further on")
    if found.collapse_shown and path.outcome.name in ("LOST", "BROKEN"):
        end = f"{most}; how it moves on was not followed to an end"
    if found.collapse_shown:
        lines = [f"{head}collapses at {found.coulomb:.6g}, {len(path.events):,} events"]
    else:
        known = f"carries at least {path.peak:.6g}, {len(path.events):,} events; its collapse was not met"
        lines = [f"{head}{known}"]
    lines.append(f"{REST}{end}")
    if path.jumps:
        first = path.jumps[0].parameter
        lines.append(f"{REST}parts of the structure snap {len(path.jumps)} times, first at {first:.6g}")
    return lines


def margin_words(margin: Margin) -> str:
    """Return what bisection with solved load steps found, in words."""
    if margin.locked:
        return "any multiple of the load is carried: certified up to a million times the other loads"
    if margin.holds != margin.holds:
        return "no certified equilibrium was found"
    found = f"a certified equilibrium at {margin.holds:.6g}"
    return found if margin.fails != margin.fails else f"{found}, none found at {margin.fails:.6g}"
