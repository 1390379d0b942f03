"""The verdict of a load step after which the structure was let go: it comes to rest, or moves away, or is not known."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from concio.display import number
from concio.problem.tolerances import CERTIFIED
from concio.verdict.step_words import OUTCOMES
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.motion.let_go import LetGo
    from concio.verdict.question import Question

NEAR = 0.1
"""Share of the width of a body by which it may have moved where what is at rest is still the structure described."""

ASKED = "; released at rest with its masses, does it come to rest?"
HEADLINES = {
    Outcome.HOLDS: "Released at rest, it comes to rest close to where it was described.",
    Outcome.INCOMPLETE: "Released at rest, it comes to rest elsewhere.",
    Outcome.FAILS: "Released at rest, it falls.",
    Outcome.MOVING: "Released at rest, it still moves where the calculation ends.",
    Outcome.UNDECIDED: "It is not known whether the loads are carried.",
}
FALLS_THOUGH_SOLVED = "In equilibrium at small displacements, but released at rest it falls."
MEANINGS = {
    Outcome.HOLDS: (
        "No equilibrium in one step from rest was found, and none was shown to be impossible. So the structure was "
        "released at rest and followed at large displacements, with its masses, impacts and friction. It came to rest, "
        "and an equilibrium was certified where its bodies then stand."
    ),
    Outcome.INCOMPLETE: (
        "The structure was released at rest and followed at large displacements. It came to rest, but bodies have "
        "moved so far that what stands there is no longer the structure that was described."
    ),
    Outcome.FAILS: (
        "The structure was released at rest and followed at large displacements. It falls in the calculation. That is "
        "one motion, computed in steps: it does not exclude an equilibrium that another history reaches."
    ),
    Outcome.MOVING: (
        "The structure was released at rest and followed at large displacements for the work allowed. It "
        "neither came to rest nor fell."
    ),
    Outcome.UNDECIDED: (
        "The structure was released at rest, but its motion could not be followed to an end that shows anything."
    ),
}
STATUSES = {
    Outcome.HOLDS: "comes_to_rest",
    Outcome.INCOMPLETE: "rests_elsewhere",
    Outcome.FAILS: "seen_to_fall",
    Outcome.MOVING: "still_moves",
    Outcome.UNDECIDED: "undecided",
}
ONE_MOTION = "what was seen is one motion, with this step and without anything that disturbs it; it proves nothing more"
FADING = "vibrations of elastic blocks, joints and ties fade in the motion faster than they may in the structure"
NEXT = (
    "Let it go again with half the step: near the limit a motion is sensitive to details.",
    "'concio limit' bounds the loads from both sides: what certified load steps carry, and what nothing carries.",
)


def let_go_verdict(found: LetGo) -> Verdict:
    """Return the verdict of a load step and of the motion after it.

    A load step that is decided keeps its outcome: what was seen is stated beside it. Only an equilibrium at small
    displacements of what falls is left open: the structure holds by a motion too large for it, or by its history.

    Parameters
    ----------
    found : LetGo
    """
    step, motion = found.step.verdict, found.motion.verdict
    question = replace(step.question, asked=step.question.asked + ASKED)
    decided = OUTCOMES[found.step.status]
    if decided is Outcome.HOLDS and found.motion.fallen:
        return _falls(found, question)
    if decided is not Outcome.UNDECIDED:
        return replace(step, question=question, answer=f"{step.answer} {_seen(found)}")
    outcome = _outcome(found)
    limits = [*step.limits, *(line for line in motion.limits if line not in step.limits), ONE_MOTION]
    if found.fades:
        limits.append(FADING)
    return Verdict(
        outcome=outcome,
        status=STATUSES[outcome],
        question=question,
        headline=HEADLINES[outcome],
        answer=f"{step.answer} {_seen(found)}",
        proof=_proof(found, outcome),
        meaning=MEANINGS[outcome],
        limits=tuple(limits),
        unchecked=motion.unchecked if outcome is Outcome.INCOMPLETE and not found.motion.rests else (),
        attention=tuple(dict.fromkeys((*step.attention, *motion.attention))),
        next_steps=NEXT,
    )


def _falls(found: LetGo, question: Question) -> Verdict:
    """Return the verdict of a structure with an equilibrium at small displacements that falls when it is released."""
    step, motion = found.step.verdict, found.motion.verdict
    return replace(
        step,
        outcome=Outcome.INCOMPLETE,
        status=STATUSES[Outcome.FAILS],
        question=question,
        headline=FALLS_THOUGH_SOLVED,
        answer=f"{step.answer} {_seen(found)}",
        meaning=f"{step.meaning} {MEANINGS[Outcome.FAILS]}",
        limits=tuple(dict.fromkeys((*step.limits, *motion.limits, ONE_MOTION))),
        attention=tuple(dict.fromkeys((*step.attention, *motion.attention))),
    )


def _outcome(found: LetGo) -> Outcome:
    """Return what the motion shows."""
    told = found.motion.verdict.outcome
    if told is Outcome.HOLDS:
        _, far, width = found.moved
        return Outcome.HOLDS if far <= NEAR * width else Outcome.INCOMPLETE
    if told in (Outcome.FAILS, Outcome.UNDECIDED):
        return told
    if told is Outcome.INCOMPLETE and not found.worked:
        return Outcome.UNDECIDED
    return Outcome.MOVING


def _seen(found: LetGo) -> str:
    """Return what was seen of the motion, in sentences with numbers."""
    motion, units = found.motion, found.motion.model.report
    time = f"{number(float(motion.end.time), 4)} s"
    name, far, width = found.moved
    most = f"'{name}' has moved by up to {units.text('motion', far, 3)}, {number(100 * far / width, 3)} % of its width"
    if motion.fallen:
        said = motion.fallen[0] + (f", and {len(motion.fallen) - 1} more" if len(motion.fallen) > 1 else "")
        return f"Released at rest it falls: after {time} {said}."
    if motion.rests:
        give = ""
        if motion.lent_compliance and found.hard:
            sunk = units.text("motion", found.sunk, 2)
            give = f" That is shown for joints between rigid blocks that give way by up to {sunk}, not for hard ones."
        rests = f"Released at rest it comes to rest after {time}, in an equilibrium that was certified there"
        return f"{rests}: {most}.{give}"
    if motion.ending.name == "UNSOLVED":
        return f"Released at rest it was followed for {time} only: no step, however small, satisfies its equations."
    turned = float(np.rad2deg(motion.largest_rotation[1]))
    return (
        f"Released at rest it still moves after {time}, at up to {number(found.speed, 3)} m/s: {most}, and "
        f"'{motion.largest_rotation[0]}' has turned by up to {number(turned, 3)} degrees. Whether it comes to rest or "
        "falls is not known."
    )


def _proof(found: LetGo, outcome: Outcome) -> str:
    """Return what shows the outcome."""
    steps = found.motion.verdict.proof
    if outcome in (Outcome.HOLDS, Outcome.INCOMPLETE) and found.motion.rests:
        return f"An equilibrium where the bodies stand satisfies every equation to {CERTIFIED:.0e} (relative). {steps}"
    return f"Nothing is proven of the structure; of the motion that was seen: {steps}"
