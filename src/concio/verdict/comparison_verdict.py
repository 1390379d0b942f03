"""The verdict of a comparison of methods: that of the structure, and which methods meet the equations it is about."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from concio.problem.solution import Status
from concio.verdict.question import Question
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.studies.compare import ComparisonRow, ComparisonTable

MEETS = "solved"
"""Word of a row whose certificate holds, where nothing says that the structure fails."""
BALANCED_ONLY = "balanced only"
"""Word of such a row of a structure that is proven to fail: its forces balance, and nothing puts them there."""
WORDS = {
    Status.SOLVED: MEETS,
    Status.NO_EQUILIBRIUM: "no equilibrium",
    Status.COLLAPSES: "collapses",
    Status.NO_COULOMB_STATE: "no Coulomb state",
    Status.UNDECIDED: "undecided",
    Status.GAVE_UP: "gave up",
    Status.CANCELLED: "cancelled",
}
"""Words of the rows."""
FAR = 1e-6
"""Certified displacements that differ by more, relative to their size, are those of another equilibrium."""


def word_of(status: Status, decided: Verdict | None) -> str:
    """Return the word of a row, which never calls solved what the structure's verdict says to fail."""
    word = WORDS[status]
    return BALANCED_ONLY if word == MEETS and decided is not None and decided.outcome is Outcome.FAILS else word


def comparison_verdict(table: ComparisonTable) -> Verdict:
    """Return the verdict of a comparison.

    Parameters
    ----------
    table : ComparisonTable
        With the verdict of the structure in ``decided`` where a model was compared; of a bare problem the rows alone
        say something, of its equations only.
    """
    met = [row for row in table.rows if row.outcome in (MEETS, BALANCED_ONLY)]
    answer = _rows_words(table, met)
    limits = _several(met)
    open_rows = [row.method for row in table.rows if row.outcome in ("gave up", "too slow", "cancelled")]
    if open_rows:
        limits = (*limits, f"{', '.join(open_rows)} gave no answer, which says nothing about the structure")
    if table.decided is None:
        return Verdict(
            outcome=Outcome.HOLDS if met else Outcome.UNDECIDED,
            status=MEETS if met else "undecided",
            question=Question("which methods meet the equations of one contact problem"),
            headline=f"{len(met)} of {_methods(table)} {_meets(met)} the equations.",
            answer=answer,
            proof="one certificate for all methods, computed from the matrices of the problem",
            limits=(*limits, "of a structure this says something only with the verdict of its model: 'concio run'"),
        )
    decided = table.decided
    return replace(
        decided,
        question=replace(decided.question, asked=f"{decided.question.asked}, by {_methods(table)}"),
        answer=f"{decided.answer} {answer}",
        limits=(*decided.limits, *limits),
    )


def _methods(table: ComparisonTable) -> str:
    return f"{len(table.rows)} method" + "s" * (len(table.rows) != 1)


def _meets(met: list[ComparisonRow]) -> str:
    return "meets" if len(met) == 1 else "meet"


def _rows_words(table: ComparisonTable, met: list[ComparisonRow]) -> str:
    names = ", ".join(row.method for row in met) or "none"
    text = f"Of {_methods(table)} {len(met)} {_meets(met)} the equations with the certificate of all: {names}."
    if any(row.outcome == BALANCED_ONLY for row in met):
        text += (
            " Their forces balance within friction as self-stress alone: the verdict above is that of the structure, "
            "and they do not contradict it."
        )
    return text


def _several(met: list[ComparisonRow]) -> tuple[str, ...]:
    other = [row.method for row in met if row.difference > FAR]
    if not other:
        return ()
    return (
        f"{', '.join(other)} found another state than {met[0].method}: where friction allows several, each certificate "
        "holds for its own",
    )
