"""The verdict of an exception that ends an analysis: its question, its loads, what is suspicious about the model.

Exceptions are raised deep in a solver, where nobody knows the question. On its way out of the analysis each gets the
verdict that a result would have had.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any

from concio.contact.assembly import Assembly, assemble
from concio.errors import ConcioError, NoEquilibriumError, SolverError
from concio.model.model import Model
from concio.verdict.attention import attention, joints_not_made
from concio.verdict.question import Question, question_of
from concio.verdict.verdict import Outcome, Verdict

ASKED = {
    "solve": "equilibrium under the loads that act, in one step from rest",
    "limit": "the largest multiple of the live load that is carried while all other loads act with factor 1",
    "limit_stages": "the largest multiple of the live load that is carried while all other loads act with factor 1",
    "load_margin": "the largest multiple of the live load with an equilibrium in one step from rest",
    "friction_margin": "the least friction with which forces balance the loads",
    "friction_by_solving": "the least friction with which the loads are carried",
    "run_path": "equilibrium along a load path",
    "push": "a capacity curve at large displacements",
    "dynamics": "a motion in time",
    "let_go": "whether a structure that is released at rest comes to rest",
    "homogenise": "the moduli of a periodic cell",
    "strength": "the strength of a periodic cell",
    "strain_path": "a path of strains and stresses of a periodic cell",
    "compare_with_continuum": "a wall of blocks compared with its homogenised continuum",
    "diagnose": "which motions explain what was measured",
    "assess_bridge": "the load factor of a vehicle at every position on a bridge",
    "assess": "an assessment of local mechanisms under an earthquake",
    "prove": "a proof in fractions",
}
"""What each analysis is asked, by the name of its function."""


class Unanswered(Verdict):
    """The verdict of an exception; where one analysis asks another, the question is that of the outer one."""


@contextmanager
def with_a_verdict(about: object, name: str) -> Iterator[None]:
    """Give an exception that says what became of a structure its verdict, where it has none.

    Parameters
    ----------
    about : Model, Assembly or PeriodicCell
        What the analysis is of; of anything else nothing can be said.
    name : str
        Key of :data:`ASKED`.
    """
    try:
        yield
    except (NoEquilibriumError, SolverError) as error:
        inner = error.verdict
        if (inner is None or isinstance(inner, Unanswered)) and (assembly := _assembly(about)) is not None:
            found = unanswered(assembly, ASKED.get(name, name), error)
            within = inner.attention if isinstance(inner, Unanswered) else ()
            error.verdict = replace(found, attention=tuple(dict.fromkeys((*found.attention, *within))))
        raise


def unanswered(assembly: Assembly, asked: str, error: ConcioError) -> Unanswered:
    """Return the verdict of an analysis that ended with an exception.

    Parameters
    ----------
    assembly : Assembly
    asked : str
    error : ConcioError
    """
    fails = isinstance(error, NoEquilibriumError)
    answer = f"{error.what[0].upper()}{error.what[1:].rstrip('.')}."
    return Unanswered(
        outcome=Outcome.FAILS if fails else Outcome.UNDECIDED,
        status="no_equilibrium" if fails else "undecided",
        question=_question(assembly, asked),
        headline="What was asked for does not hold." if fails else "There is no answer.",
        answer=answer,
        proof=answer if fails else "nothing was shown",
        limits=joints_not_made(assembly.detection),
        attention=attention(assembly),
    )


def _question(assembly: Assembly, asked: str) -> Question:
    return Question(asked) if assembly.model.periods is not None else question_of(asked, assembly)


def _assembly(about: Any) -> Assembly | None:
    """Return the assembly of what an analysis is of, None where there is none."""
    found = about if isinstance(about, Assembly | Model) else getattr(about, "assembly", None)
    if isinstance(found, Model):
        with suppress(ConcioError):
            return assemble(found)
        return None
    return found if isinstance(found, Assembly) else None
