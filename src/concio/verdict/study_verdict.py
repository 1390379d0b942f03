"""The verdict of a study: what was asked of every run, how the answers are spread, and which runs have none."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Literal

import numpy as np

from concio.contact.factors import load_factor
from concio.display import number
from concio.errors import InputError
from concio.verdict.attention import ALMOST, SO_WITH
from concio.verdict.question import Acting, Question, Role
from concio.verdict.unseen import unseen_words
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.studies.outputs import Output
    from concio.studies.study_result import StudyResult

RANDOM = ("monte-carlo", "latin-hypercube", "sobol", "given")
"""Samples whose shares of runs are probabilities."""
MOST_ODD = 12
"""More findings than this are counted."""
WORDS = {
    "solved": "in equilibrium",
    "no_equilibrium": "without equilibrium",
    "collapses": "move away",
    "no_coulomb_state": "without a Coulomb state",
}
"""Verdicts of single runs in words."""
DOES_NOT_STAND = ("no_equilibrium", "collapses")


def study_verdict(study: StudyResult) -> Verdict:
    """Return the verdict of a study.

    Parameters
    ----------
    study : StudyResult
    """
    open_outputs = _unanswered(study)
    missing = 0 if study.stopped else len(study.sample) - len(study)
    unchecked = list(open_outputs)
    if missing:
        unchecked.insert(0, f"{missing} of the {len(study.sample)} runs that were planned: the study did not end")
    answered = not unchecked
    unchecked += _unseen(study)
    done = not unchecked
    runs = f"{len(study)} of {len(study.sample)} runs" if len(study) < len(study.sample) else f"{len(study)} runs"
    answers = " ".join(f"{o.name}: {output_words(study, o)}." for o in study.outputs)
    early = " It stopped early: the stopping criterion was met." if study.stopped else ""
    return Verdict(
        outcome=Outcome.HOLDS if done else Outcome.INCOMPLETE,
        status="done" if done else "incomplete",
        question=_question(study),
        headline=f"{runs}, each with an answer." if answered else f"{runs}, not all of which have an answer.",
        answer=" ".join(filter(None, (f"{runs}: {verdict_counts(study)}.{early} {answers}", required_words(study),
                                      *_not_made(study)))),
        proof="each row has the verdict of its own analyses; nothing is added to it",
        meaning="Every run is a row, whatever its outcome. A structure that is proven not to stand counts as worse "
        "than any "
        "number; a run without an answer widens the interval on both sides.",
        limits=(*_bounds(study), *_without_indices(study), *(line for line in _odd(study) if ALMOST in line)),
        unchecked=tuple(unchecked),
        attention=(*_mixed(study), *_odd(study)),
    )


def verdict_counts(study: StudyResult) -> str:
    """Return how many runs ended how, in words."""
    return ", ".join(f"{count} {WORDS.get(word, word.replace('_', ' '))}" for word, count in study.verdicts.items())


def output_words(study: StudyResult, output: Output) -> str:
    """Return what all runs say of an output: a probability, or quantiles, and what they count."""
    spread = study.spread(output.name)
    n = len(spread.values)
    if not n:
        return "no run has ended"
    if output.event and study.sample.design in RANDOM:
        yes, no = int((spread.values > 0).sum()), int((spread.values == 0).sum())
        return f"yes in {yes}, no in {no} of {n} runs: probability {study.probability(output.name)}"
    if spread.unanswered == n:
        return "no run has an answer"
    if not spread.counted or (not len(spread.known) and spread.fails + spread.unanswered == n):
        return f"no number: the structure does not stand in {spread.fails} of {n} runs" + _left(spread.unanswered, n)
    unit = "" if output.unit == "-" else f" {output.unit}"
    low, middle, high = (_between(spread.quantile(q), output, unit) for q in (0.05, 0.5, 0.95))
    yes_no = bool(np.isin(spread.known, (0.0, 1.0)).all()) and len(np.unique(spread.known)) == 2
    text = f"median {middle}, 5 to 95 % of runs from {low} to {high}"
    if yes_no:
        text = f"1 in {int((spread.known == 1).sum())}, 0 in {int((spread.known == 0).sum())} of {n} runs"
    of = "" if spread.counted == n else f"of the {spread.counted} runs that stand: "
    return of + text + _counted(study, output)


def _between(ends: tuple[float, float], output: Output, unit: str) -> str:
    low, high = (_one(x, output, unit) for x in ends)
    return low if low == high else f"between {low} and {high}"


def _one(value: float, output: Output, unit: str) -> str:
    """Return a quantile in words; infinite ones are what they stand for."""
    if math.isfinite(value):
        return f"{number(value)}{unit}"
    if value < 0:
        return "not standing" if output.end == "low" else "-infinite"
    if output.name == "friction_factor":
        return "no friction enough"
    return {"low": "no limit", "high": "not standing"}.get(output.end, "infinite")


def _counted(study: StudyResult, output: Output) -> str:
    """Return which runs without a finite number the quantiles count, and where."""
    spread = study.spread(output.name)
    n, place = len(spread.values), {"low": "less", "high": "more"}.get(output.end, "")
    found = ""
    if spread.fails and place:
        found += f"; {spread.fails} of {n} do not stand and count as {place} than any number"
    if spread.endless:
        kind = {"low": "have no limit", "high": "have no finite number"}.get(output.end, "are infinite")
        found += f"; {spread.endless} of {n} {kind} and count as more than any number"
    return found + _left(spread.unanswered, n)


def _left(unanswered: int, n: int) -> str:
    return f"; {unanswered} of {n} have no answer and widen the interval on both sides" if unanswered else ""


def _unanswered(study: StudyResult) -> list[str]:
    """Return a sentence for each output that some runs have no answer to."""
    found = []
    for o in study.outputs:
        count = study.spread(o.name).unanswered
        if count:
            why = Counter(_why(study, o.name))
            such = ", such as" if len(why) > 1 else ""
            reason = f"{such}: {why.most_common(1)[0][0]}" if why else ""
            found.append(f"{o.name} in {count} of {len(study)} runs{reason}")
    asked = study.required
    if asked is not None and asked.index is None:
        groups = ", ".join(asked.groups)
        found.append(f"reliability index of a multiplier of {number(asked.required)} of {groups}: {asked.why}")
    return found


def _not_made(study: StudyResult) -> list[str]:
    """Return that runs do not stand with the joints that were made, and which were not made in the first of them."""
    for row in study.rows:
        missing = [line for line in row.attention if ALMOST in line]
        if missing and (row.fails or row.verdict in DOES_NOT_STAND):
            return [SO_WITH, *(f"{line}." for line in missing)]
    return []


def required_words(study: StudyResult) -> str:
    """Return the reliability index of the multiplier that is required; nothing where there is none."""
    asked = study.required
    if asked is None or asked.index is None:
        return ""
    groups = ", ".join(asked.groups)
    return f"A multiplier of {number(asked.required)} of {groups} is required. {asked.index.sentence}."


def _unseen(study: StudyResult) -> list[str]:
    """Return a sentence for the bodies that certificates do not see, with how many runs it is said of."""
    said = Counter(row.unseen for row in study.rows if row.unseen)
    return [f"in {count} of {len(study)} runs: {line}" for names, count in said.items() for line in unseen_words(names)]


def _why(study: StudyResult, name: str) -> list[str]:
    rows = [row for row in study.rows if math.isnan(row.outputs.get(name, math.nan)) and name not in row.fails]
    told = [row.errors.get(name) or row.message or row.verdict.replace("_", " ") for row in rows]
    return ["its analysis gave no number" if text in ("done", "solved") else text for text in told]


def _bounds(study: StudyResult) -> tuple[str, ...]:
    """Return which outputs are bounds rather than the thing itself."""
    found = [f"{o.name} is the {o.meaning}" for o in study.outputs if "bound" in o.meaning]
    if study.required is not None and study.required.index is not None:
        found.append("the reliability index is that of the associated multiplier, an upper bound where joints slide")
    names = [o.name for o in study.outputs if o.multiplies]
    if study.settings is not None and (names or study.required is not None):
        own = {g: load_factor(study.settings.factors, g) for g in study.settings.live}
        told = ", ".join([*names, *(["the required multiplier"] if study.required is not None else [])])
        found += [f"the factor {number(f)} of '{g}' does not act on {told}: the loads of the file are multiplied"
                  for g, f in own.items() if f != 1.0]  # fmt: skip
    return tuple(found)


def _question(study: StudyResult) -> Question:
    names = ", ".join(o.name for o in study.outputs)
    asked = (
        f"{names} in {len(study.sample)} runs that differ in {', '.join(v.name for v in study.sample.variables)} "
        f"({study.sample.design} sample, seed {study.sample.seed})"
    )
    return Question(asked, _acting(study), _said_of_runs(study, "assumed"))


def _acting(study: StudyResult) -> tuple[Acting, ...]:
    """Return the load groups of all runs, with the range of their sizes where they differ."""
    sizes: dict[str, list[float]] = {}
    first: dict[str, tuple[str, tuple[float, ...]]] = {}
    for row in study.rows:
        for group, told in row.acting.items():
            sizes.setdefault(group, []).append(float(told["size"]))
            first.setdefault(group, (str(told["what"]), tuple(told["force"])))
    factors = study.settings.factors if study.settings else {}
    live = set(study.settings.live) if study.settings else set()
    only = all(o.multiplies for o in study.outputs)
    found = []
    for group, (what, force) in first.items():
        low, high = min(sizes[group]), max(sizes[group])
        if high - low > 1e-9 * high:
            what += f", from {number(low)} to {number(high)} kN over the runs, in the first of them"
        factor = load_factor(factors, group)
        if only and group in live:
            found.append(Acting(group, what, force, sizes[group][0], math.nan, "multiplied"))
        else:
            role: Role = "constant" if factor else "not applied"
            found.append(Acting(group, what, force, sizes[group][0], factor, role))
    return tuple(found)


def _without_indices(study: StudyResult) -> tuple[str, ...]:
    """Return why outputs of a sample that is made for Sobol indices have none."""
    found = []
    for o in study.outputs if study.sample.design == "saltelli" and len(study) else ():
        try:
            study.sensitivity(o.name)
        except InputError as error:
            found.append(f"there are no Sobol indices of {o.name}: {error.what}")
    return tuple(found)


def _mixed(study: StudyResult) -> tuple[str, ...]:
    """Return a sentence where some outputs multiply a group that acts with a factor in others."""
    if study.settings is None:
        return ()
    acting = {group for row in study.rows[:1] for group in row.acting}
    live = [g for g in study.settings.live if g in acting]
    multiplying = [o.name for o in study.outputs if o.multiplies]
    fixed = [o.name for o in study.outputs if not o.multiplies]
    if not (live and multiplying and fixed):
        return ()
    group = live[0]
    factor = load_factor(study.settings.factors, group)
    hint = (
        f"; the study does not state this: factors = {{ {group} = 0 }} asks without it"
        if group not in study.settings.factors
        else ""
    )
    return (
        f"load group '{group}' acts with factor {number(factor)} in {', '.join(fixed)}, and is multiplied "
        f"from 0 in {', '.join(multiplying)}{hint}",
    )


def _odd(study: StudyResult) -> tuple[str, ...]:
    """Return what is suspicious about the models of the runs, with how many of them it is said of."""
    return _said_of_runs(study, "attention")


def _said_of_runs(study: StudyResult, what: Literal["attention", "assumed"]) -> tuple[str, ...]:
    said = Counter(line for row in study.rows for line in getattr(row, what))
    runs = len(study)
    found = [
        line if count == runs else f"in {count} of {runs} runs: {line}" for line, count in said.most_common(MOST_ODD)
    ]
    if len(said) > MOST_ODD:
        found.append(f"{len(said) - MOST_ODD} more findings, which are in the rows")
    return tuple(found)
