"""A verdict: the answer to a question, together with the question, its proof and what it leaves out.

Sentence, exit code, ``--json``, exception, report and notebook of every result are written from its verdict alone, so
that no two of them can say different things, and no answer can be read without its question.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal

from concio.display import DEFAULT, Units
from concio.verdict.question import Question

Tone = Literal["good", "bad", "unsure"]

WIDTH = 13
"""Width of the first column of lines of text."""
NOT_CHECKED = {"en": "Not checked", "it": "Non controllato"}
"""Begins what was not checked, in the language of a verdict."""


class Outcome(Enum):
    """What a verdict says of its question; the value is the word of ``--json``."""

    HOLDS = "holds"
    """What was asked for is shown, to its end."""
    FAILS = "fails"
    """What was asked for is shown not to hold."""
    INCOMPLETE = "incomplete"
    """Something that was asked for was not reached or not checked; nothing says that it fails."""
    UNDECIDED = "undecided"
    """Neither was shown."""
    MOVING = "moving"
    """The structure still moves where the calculation ended."""

    @property
    def exit_code(self) -> int:
        """Exit code of the command line: 0 holds, 3 fails, 4 anything that is left open."""
        return {Outcome.HOLDS: 0, Outcome.FAILS: 3}.get(self, 4)

    @property
    def tone(self) -> Tone:
        """How a report colours it."""
        tones: dict[Outcome, Tone] = {Outcome.HOLDS: "good", Outcome.FAILS: "bad"}
        return tones.get(self, "unsure")


@dataclass(frozen=True)
class Verdict:
    """An answer with its question.

    Parameters
    ----------
    outcome : Outcome
    status : str
        The word under ``status`` in ``--json``, such as ``"solved"`` or ``"no_equilibrium"``.
    question : Question
        What was asked, under which loads.
    headline : str
        The answer in a few words, the heading of a report.
    answer : str
        The answer in sentences, with the numbers that were reached.
    proof : str
        What proves it: which original equations were evaluated, with the residual.
    meaning : str
        What the outcome means and does not mean, for a report.
    limits : tuple of str
        What limits the answer: joints that were not made, a regularisation, several equilibria.
    unchecked : tuple of str
        What was asked for, or would be expected, and was not checked.
    attention : tuple of str
        What is suspicious about the model or the numbers: :func:`concio.verdict.attention.attention` and what the
        result adds.
    next_steps : tuple of str
        What to do next, for a report.
    language : {"en", "it"}
        In which the sentences are written.
    """

    outcome: Outcome
    status: str
    question: Question
    headline: str
    answer: str
    proof: str = ""
    meaning: str = ""
    limits: tuple[str, ...] = ()
    unchecked: tuple[str, ...] = ()
    attention: tuple[str, ...] = ()
    next_steps: tuple[str, ...] = ()
    language: str = "en"

    @property
    def holds(self) -> bool:
        """Whether what was asked for is shown, to its end."""
        return self.outcome is Outcome.HOLDS

    @property
    def exit_code(self) -> int:
        """Exit code of a command that ends with this verdict."""
        return self.outcome.exit_code

    @property
    def tone(self) -> Tone:
        """How a report colours it: "good", "bad" or "unsure"."""
        return self.outcome.tone

    @property
    def sentence(self) -> str:
        """The answer, followed by what was asked for and not checked."""
        if not self.unchecked:
            return self.answer
        return f"{self.answer} {NOT_CHECKED[self.language]}: {'; '.join(line.rstrip('.') for line in self.unchecked)}."

    def __str__(self) -> str:
        return self.sentence

    def lines(self, units: Units = DEFAULT, *, indent: str = "  ", most: int | None = None) -> list[str]:
        """Return question, loads, limits, what was not checked, and attention as lines of text.

        The sentence and the proof are not among them: a command prints its sentence first.

        Parameters
        ----------
        units : Units
            Units of forces.
        indent : str
            Begins each line.
        most : int, optional
            Largest number of lines of one kind; more are counted.

        Examples
        --------
        >>> import concio
        >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", unit_weight=20.0)
        >>> verdict = concio.solve(pillar).verdict
        >>> verdict.lines(indent="")[1]
        'acts         dead: constant; self-weight, -20 kN along y'
        """
        parts: list[tuple[str, Sequence[str]]] = [
            ("asked", (self.question.asked,)),
            ("acts", self.question.loads(units)),
            ("assumed", self.question.assumptions),
            ("limits", self.limits),
            ("not checked", self.unchecked),
            ("attention", self.attention),
        ]
        lines = []
        for head, entries in parts:
            shown = list(entries) if most is None else list(entries[:most])
            if len(entries) > len(shown):
                shown.append(f"... and {len(entries) - len(shown)} more of this kind")
            lines += [f"{indent}{head:<{WIDTH}}{entry}" for entry in shown]
        return lines

    def as_dict(self) -> dict[str, Any]:
        """Return the verdict as plain types, in kN and m: the entry ``verdict`` of ``--json`` and of summaries."""
        return {
            "outcome": self.outcome.value,
            "exit_code": self.exit_code,
            "headline": self.headline,
            "sentence": self.sentence,
            "proof": self.proof,
            "question": self.question.as_dict(),
            "limits": list(self.limits),
            "unchecked": list(self.unchecked),
            "attention": list(self.attention),
        }
