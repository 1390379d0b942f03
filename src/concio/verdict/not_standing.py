"""The verdict of an analysis that ends before it begins: what is there from the start does not stand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from concio.contact.assembly import Assembly
from concio.model.interfaces.detect import Detection
from concio.verdict.attention import attention, joints_not_made
from concio.verdict.question import question_of
from concio.verdict.unseen import listed, unseen_bodies, unseen_words
from concio.verdict.verdict import Outcome, Verdict

BY_A_MECHANISM = "a mechanism proves it"
"""What shows that no joint forces balance the constant loads, in exceptions of analyses that begin with them."""

FOLLOWED_AWAY = (
    "The bodies were followed from their last position against a vanishing viscous resistance: they moved by more than "
    "half the width of a body and reached no equilibrium. That there is none elsewhere was not shown."
)
"""What shows that a structure moves away where the search for its first equilibrium ends far from where it began."""


def of_the_joints(sentence: str, detection: Detection) -> str:
    """Return what does not stand as a mechanism proves it: with the joints that were made, where others were not.

    Parameters
    ----------
    sentence : str
        Ends with :data:`BY_A_MECHANISM`; anything else is returned as it is.
    detection : Detection
    """
    missing = joints_not_made(detection)
    if not missing or not sentence.endswith(f": {BY_A_MECHANISM}"):
        return sentence
    what = sentence.removesuffix(f": {BY_A_MECHANISM}")
    return f"{what} with the joints that were made: {BY_A_MECHANISM}. {missing[0]}"


def not_standing(
    assembly: Assembly, asked: str, answer: str, *, factors: Mapping[str, float] | None = None,
    multiplied: Iterable[str] = (), proof: str = "", moving: Iterable[str] = (), shown: bool = True,
) -> Verdict:  # fmt: skip
    """Return the verdict that an exception carries where the constant loads alone are not carried.

    Parameters
    ----------
    assembly : Assembly
    asked : str
        What was asked for.
    answer : str
        What was found instead, a sentence.
    factors : mapping of str to float, optional
        Of the constant groups.
    multiplied : names
        Groups that would have been multiplied.
    proof : str
    moving : names
        Bodies that move away. Where no certificate can see any of them, nothing is shown of the others.
    shown : bool
        Whether anything shows that it is not carried; otherwise an equilibrium was merely not found.
    """
    multiplied = tuple(multiplied)
    constant = dict(factors or {}) | dict.fromkeys(multiplied, 0.0)
    if moving and set(moving) <= set(small := unseen_bodies(assembly, (constant,))):
        return Verdict(
            outcome=Outcome.INCOMPLETE,
            status="not_checked",
            question=question_of(asked, assembly, factors, multiplied=multiplied),
            headline="Whether it stands before the load that was asked about acts was not shown.",
            answer=f"No equilibrium was found from which to begin: {listed(tuple(moving))} moved away.",
            proof="Nothing is certified.",
            limits=joints_not_made(assembly.detection),
            unchecked=unseen_words(small),
            attention=attention(assembly),
        )
    if not shown:
        return Verdict(
            outcome=Outcome.UNDECIDED,
            status="undecided",
            question=question_of(asked, assembly, factors, multiplied=multiplied),
            headline="Whether it stands before the load that was asked about acts was not shown.",
            answer="No equilibrium was found from which to begin, and nothing shows that there is none.",
            proof="Nothing is certified.",
            limits=joints_not_made(assembly.detection),
            attention=attention(assembly),
        )
    answer = of_the_joints(answer, assembly.detection)
    sentence = f"{answer[0].upper()}{answer[1:].rstrip('.')}."
    return Verdict(
        outcome=Outcome.FAILS,
        status="no_equilibrium",
        question=question_of(asked, assembly, factors, multiplied=multiplied),
        headline="It does not stand before the load that was asked about acts.",
        answer=sentence,
        proof=proof or sentence,
        limits=joints_not_made(assembly.detection),
        attention=attention(assembly),
    )
