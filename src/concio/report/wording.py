"""What each outcome means, what to do next, and what the certificate says, in words for an engineer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from concio.display import Units
from concio.model.plausibility import implausible
from concio.problem.solution import Status
from concio.problem.tolerances import CERTIFIED

if TYPE_CHECKING:
    from concio.analysis.result import Result


@dataclass(frozen=True)
class Verdict:
    """An outcome in words.

    Parameters
    ----------
    tone : {"good", "bad", "unsure"}
    headline : str
    meaning : str
    next_steps : tuple of str
    """

    tone: str
    headline: str
    meaning: str
    next_steps: tuple[str, ...]


VERDICTS: dict[Status, Verdict] = {
    Status.SOLVED: Verdict(
        "good",
        "The loads are carried.",
        "A state of equilibrium was found in which every joint obeys its law: nothing pulls on an open joint, nothing "
        "overlaps, and friction is nowhere exceeded. The residuals below were computed from the original equations, "
        "not from what the solver believed.",
        (
            "Look where joints are open or slip: these are the places that give way first.",
            "This says that the structure stands under these loads, not how far it is from collapse; "
            "'concio limit' gives the margin.",
            "With Coulomb friction more than one equilibrium may exist, and the history of loading chooses among them; "
            "'concio path' follows it.",
        ),
    ),
    Status.NO_EQUILIBRIUM: Verdict(
        "bad",
        "The loads cannot be carried.",
        "No set of joint forces whatsoever balances these loads within the strength of the joints. The proof is a "
        "motion of the blocks in which no joint overlaps and the loads do more work than the joints can absorb: the "
        "mechanism drawn below. There are therefore no stresses and no displacements to report.",
        (
            "Look at the mechanism: the blocks that move lack a support, a tie, friction or weight on top. In this "
            "motion a joint that slides also opens a little; it is a proof, not a forecast of the fall.",
            "Check that supports, side walls and joints are where you meant them ('concio check'); a block that "
            "touches nothing falls.",
            "'concio limit' tells what share of the load can be carried.",
        ),
    ),
    Status.COLLAPSES: Verdict(
        "bad",
        "The structure moves away under these loads.",
        "Forces that balance the loads within the strength of the joints exist, but no state was found in which "
        "sliding also obeys Coulomb's law; and released at rest the structure accelerates along the motion drawn "
        "below and does not come to rest. During this motion the forces are constant: closed joints press, sliding "
        "joints are held back by full friction, and what is left of the loads accelerates the masses. There are "
        "therefore no stresses and no displacements to report.",
        (
            "Look at the motion: joints that slide want more friction or more weight on top, blocks that turn want a "
            "support or a tie.",
            "That it moves away from rest does not exclude an equilibrium reached by another history, for example "
            "with wedges driven in or after the joints were pressed together; 'concio path' follows a history.",
            "'concio limit' tells what share of the load can be carried.",
        ),
    ),
    Status.NO_COULOMB_STATE: Verdict(
        "bad",
        "The loads cannot be carried with Coulomb friction.",
        "Forces that balance the loads within the strength of the joints exist, but in every combination of open, "
        "sticking and sliding joints some condition fails: sliding joints would have to be held back by more or less "
        "than friction gives. All combinations were excluded, each by a linear programme whose proof was recomputed "
        "from the original equations. Unlike a mechanism this is no single motion that could be drawn. There are "
        "therefore no stresses and no displacements to report.",
        (
            "Follow the loads from zero with 'concio path': the path shows where equilibrium is lost.",
            "'concio limit' gives the load at which even the balance of forces fails; it lies above these loads.",
        ),
    ),
    Status.UNDECIDED: Verdict(
        "unsure",
        "It is not known whether the loads are carried.",
        "Forces that balance the loads within the strength of the joints exist, so a collapse cannot be proven. But no "
        "state was found in which sliding also obeys Coulomb's law, and none was shown to be impossible. This happens "
        "near collapse, and where blocks jam. Nothing below is an answer.",
        (
            "Do not rely on this structure under these loads: treat it as one that may slide.",
            "'concio limit' bounds them from both sides: what certified load steps carry, and what nothing carries.",
            "Follow the loads from zero with 'concio path': the path shows where equilibrium is lost.",
            "Solve with another method, for example --method lemke, or with a slightly smaller load.",
        ),
    ),
    Status.GAVE_UP: Verdict(
        "unsure",
        "The solver stopped without an answer.",
        "It neither found an equilibrium that passes the check nor a proof that there is none. Nothing below is an "
        "answer, and nothing follows from it about the structure.",
        (
            "Look at what was tried, at the end of this report.",
            "Solve with another method, for example --method lemke or --method interior-point.",
            "Look for stiffnesses or sizes that differ by many powers of ten: a wrong unit is the usual reason.",
        ),
    ),
    Status.CANCELLED: Verdict(
        "unsure",
        "The calculation was stopped on request.",
        "It had not ended. Nothing below is an answer.",
        ("Run it again, and let it end.",),
    ),
}


@dataclass(frozen=True)
class Check:
    """One line of the certificate: what was checked, its residual, and whether it holds."""

    what: str
    value: float
    holds: bool


def verdict(result: Result) -> Verdict:
    """Return the outcome of a result in words; what needs attention comes first of what to do next."""
    words = VERDICTS[result.status]
    odd = implausible(result.model)
    steps = [f"{line[0].upper()}{line[1:]}." for line in odd]
    missed = len(result.assembly.detection.near_misses)
    if missed:
        places = f"At {missed:,} place{'s' if missed > 1 else ''}"
        steps.append(
            f"{places} bodies nearly touch and have no joint: 'concio check' names them. Is that what you meant?"
        )
    moved = result.joint_motion.sentence
    for line in result.attention:
        if line not in odd:
            rest = " Read it as a warning, not as a place of rest." if line == moved else ""
            steps.append(f"{line[0].upper()}{line[1:]}.{rest}")
    meaning = words.meaning
    if result.self_stress is not None:
        meaning = f"{meaning} {result.sentence.removeprefix(result.status.value).strip()}"
    if result.lent_compliance:
        meaning = (
            f"{meaning} Joints between rigid blocks were decided with a vanishing compliance, as the limit of stiff "
            "joints: without it their forces would not be determined."
        )
    return replace(words, meaning=meaning, next_steps=(*steps, *words.next_steps))


def checks(result: Result) -> list[Check]:
    """Return the certificate line by line: relative residuals, 0 is perfect."""
    c = result.certificate
    lines = (
        ("Forces balance on every block (share of the total load)", c.equilibrium),
        ("No two blocks overlap (share of the largest displacement)", c.penetration),
        ("Friction and strength are nowhere exceeded (share of the total load)", c.cone),
        ("Sliding joints are held back by full friction (relative)", c.slip_direction),
        ("Open joints carry no force (relative)", c.complementarity),
    )
    return [Check(what, value, value <= CERTIFIED) for what, value in lines]


def certificate_sentence(result: Result) -> str:
    """Return the certificate in one sentence."""
    worst = result.certificate.worst
    if result.solved:
        return f"Certified: the largest error in any equation is {worst:.1e} (relative; {CERTIFIED:.0e} is allowed)."
    if result.mechanism is not None and result.status is Status.COLLAPSES:
        m = result.mechanism
        return (
            f"Proven: along this motion {power_words(m.power, result.model.report)}, more than friction takes; motion, "
            f"forces and masses satisfy every equation to {m.violation:.1e} (relative)."
        )
    if result.mechanism is not None:
        m = result.mechanism
        return (
            f"Proven: {power_words(m.power, result.model.report)}, less what the joints absorb, and it violates the "
            f"joints by no more than {m.violation:.1e} (relative)."
        )
    if result.status is Status.NO_COULOMB_STATE:
        return "Excluded: no combination of joint states satisfies the equations; every exclusion was recomputed."
    return "Not certified: there is no answer whose equations hold."


def power_words(power: float, units: Units) -> str:
    """Return the work of the loads along a mechanism, scaled to a largest velocity of 1: a force [kN] in words."""
    return f"the loads do {units.text('moment', power, 4)} of work on each metre of it"
