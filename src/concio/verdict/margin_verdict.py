"""The verdicts of margins: how far the load may grow and how far the friction may fall, with what shows either end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from concio.display import number
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.verdict.attention import attention, joints_not_made
from concio.verdict.question import Question, question_of
from concio.verdict.step_verdict import REGULARISED, SEVERAL
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.friction_margin import FrictionMargin
    from concio.analysis.margin_of import MarginOf
    from concio.analysis.margins import Margin

LOAD, FRICTION = "load", "friction"
SINGLE_STEPS = (
    "each factor was solved in one step from rest, without the history of loading; between the factors that were "
    "tried nothing is said, and beyond the one at which no equilibrium was found there may be others"
)
NO_BOUND = "no mechanism of associated friction bounds the load, which says nothing of Coulomb friction"
BOUND_ONLY = (
    "forces in balance within friction are necessary and not sufficient: Coulomb friction may need more than this "
    "bound ('concio.friction_by_solving')"
)
MEANING = (
    "The load was multiplied, or the friction reduced, in single steps. A margin says nothing of a load that moves, "
    "of settlements or of time."
)


def margin_verdict(margin: Margin) -> Verdict:
    """Return the verdict of a margin by solving.

    Parameters
    ----------
    margin : Margin
    """
    outcome = _outcome(margin)
    of = margin.of
    return _verdict(
        of,
        outcome,
        _status(margin, outcome),
        _question(of, margin.holds),
        _answer(margin, outcome),
        _proof(margin),
        (SINGLE_STEPS, *_without_bound(margin), *((REGULARISED, SEVERAL) if outcome is Outcome.HOLDS else ())),
    )


def friction_verdict(margin: FrictionMargin) -> Verdict:
    """Return the verdict of the least friction with which forces in balance exist.

    Parameters
    ----------
    margin : FrictionMargin
    """
    factor, below = margin.factor, margin.below
    if below >= 1.0:
        outcome = Outcome.FAILS
    elif not factor <= 1.0:
        outcome = Outcome.UNDECIDED
    else:
        outcome = Outcome.HOLDS if margin.settled else Outcome.INCOMPLETE
    shown = [
        f"forces in balance within the cones of {number(factor, 6)} times the friction"
        if math.isfinite(factor)
        else "",
        f"a mechanism at {number(below, 6)} times the friction" if math.isfinite(below) else "",
    ]
    status = {Outcome.HOLDS: "solved", Outcome.FAILS: "no_equilibrium"}.get(outcome, outcome.value)
    proof = " and ".join(line for line in shown if line) or "nothing was shown"
    told = _friction_answer(factor, below, settled=margin.settled)
    return _verdict(margin.of, outcome, status, _question(margin.of, factor), told, proof, (BOUND_ONLY,))


def _verdict(
    of: MarginOf | None, outcome: Outcome, status: str, question: Question, answer: str, proof: str,
    limits: tuple[str, ...],
) -> Verdict:  # fmt: skip
    """Return the verdict of either margin, with what is suspicious about its model."""
    odd = attention(of.assembly) if of is not None else ()
    not_made = joints_not_made(of.assembly.detection) if of is not None else ()
    left_out = [f"{line[0].upper()}{line[1:]}." for line in not_made]
    headlines = {
        Outcome.HOLDS: "The margin was found.",
        Outcome.FAILS: "There is no margin: the loads are not carried as given.",
        Outcome.INCOMPLETE: "Only an upper end of the margin was shown.",
    }
    return Verdict(
        outcome=outcome,
        status=status,
        question=question,
        headline=headlines.get(outcome, "No margin was found."),
        answer=" ".join((answer, *left_out)),
        proof=proof,
        meaning=MEANING,
        limits=(*not_made, *limits),
        attention=odd,
    )


def _question(of: MarginOf | None, reached: float) -> Question:
    if of is None:
        return Question("the margin of one contact problem")
    groups = "'" + "' and '".join(of.live) + "'"
    if of.what == LOAD:
        known = reached if math.isfinite(reached) else math.nan
        asked = f"the largest multiple of {groups} with an equilibrium in one step from rest, all others at factor 1"
        return question_of(asked, of.assembly, multiplied=dict.fromkeys(of.live, known))
    asked = "the smallest common factor of all friction coefficients with which the loads that act are carried"
    return question_of(asked, of.assembly, dict.fromkeys(of.live, of.factor))


def _outcome(margin: Margin) -> Outcome:
    if not math.isnan(margin.holds):
        return Outcome.HOLDS
    proven = math.isnan(margin.proven) or margin.outcome in PROVEN_FAILURES
    return Outcome.FAILS if proven else Outcome.UNDECIDED


def _status(margin: Margin, outcome: Outcome) -> str:
    if outcome is Outcome.HOLDS:
        return "solved"
    if margin.outcome is None:
        return "no_equilibrium" if outcome is Outcome.FAILS else outcome.value
    return margin.outcome.name.lower()


def _answer(margin: Margin, outcome: Outcome) -> str:
    """Return the margin in sentences."""
    friction = margin.of is not None and margin.of.what == FRICTION
    unit = "times the friction given" if friction else "times the load given"
    if outcome is not Outcome.HOLDS:
        what = "With the friction given" if friction else "With the loads that stay constant alone"
        said = (Status.NO_EQUILIBRIUM if margin.outcome is None else margin.outcome).value.rstrip(".")
        return f"{what} there is nothing to spare: {said[0].lower()}{said[1:]}."
    if margin.locked:
        return "Any multiple of the load is carried: certified up to a million times the other loads."
    text = f"A certified equilibrium at {number(margin.holds, 6)} {unit}"
    if margin.outcome is not None:
        return f"{text}, none at {number(margin.fails, 6)} ({margin.outcome.name.lower().replace('_', ' ')})."
    side = "below" if friction else "beyond"
    return f"{text}; {side} {number(margin.proven, 6)} there is none."


def _proof(margin: Margin) -> str:
    """Return what shows either end."""
    shown = []
    if not math.isnan(margin.holds):
        shown.append("the certificate of a load step at the factor that holds")
    if math.isnan(margin.proven):
        shown.append("a mechanism under the constant loads")
    elif math.isfinite(margin.proven):
        shown.append(f"a mechanism of associated friction at {number(margin.proven, 6)}")
    return "; ".join(shown) or "nothing was shown"


def _without_bound(margin: Margin) -> tuple[str, ...]:
    return (NO_BOUND,) if margin.proven == math.inf and not math.isnan(margin.holds) else ()


def _friction_answer(factor: float, below: float, *, settled: bool) -> str:
    if factor == 0.0:
        return "Forces balance the loads without any friction."
    if math.isinf(factor):
        said = "No friction balances the loads" if settled else "No factor could be shown to balance the loads"
        return f"{said}." if not math.isfinite(below) else f"{said}; {number(below, 6)} times what is given does not."
    text = f"Forces balance the loads with {number(factor, 6)} times the friction given"
    if settled:
        return f"{text}, and with none less."
    return f"{text}; {number(below, 6)} times is too little." if math.isfinite(below) else f"{text}; less may do."
