"""What each outcome of one load step means and what to do next, in words for an engineer."""

from __future__ import annotations

from dataclasses import dataclass

from concio.problem.solution import Status
from concio.verdict.verdict import Outcome


@dataclass(frozen=True)
class Words:
    """An outcome of a load step in words.

    Parameters
    ----------
    headline, meaning : str
    next_steps : tuple of str
    """

    headline: str
    meaning: str
    next_steps: tuple[str, ...]


OUTCOMES: dict[Status, Outcome] = {
    Status.SOLVED: Outcome.HOLDS,
    Status.NO_EQUILIBRIUM: Outcome.FAILS,
    Status.COLLAPSES: Outcome.FAILS,
    Status.NO_COULOMB_STATE: Outcome.FAILS,
    Status.UNDECIDED: Outcome.UNDECIDED,
    Status.GAVE_UP: Outcome.UNDECIDED,
    Status.CANCELLED: Outcome.INCOMPLETE,
}
"""What a status says of the question whether the loads are carried."""

WORDS: dict[Status, Words] = {
    Status.SOLVED: Words(
        "The loads are carried.",
        "A state of equilibrium was found in which every joint obeys its law: nothing pulls on an open joint, nothing "
        "overlaps, and friction is nowhere exceeded. The residuals below were computed from the original equations, "
        "not from what the solver kept.",
        (
            "Check where joints are open or slip: these places fail first.",
            "This says that the structure stands under these loads, not how far it is from collapse; "
            "'concio limit' gives the margin.",
            "'concio path' follows the history of loading, which selects one of several equilibria.",
        ),
    ),
    Status.NO_EQUILIBRIUM: Words(
        "The loads cannot be carried.",
        "No set of joint forces balances these loads within the strength of the joints. The proof is a "
        "motion of the blocks in which no joint overlaps and the loads do more work than the joints can absorb: the "
        "mechanism drawn below. There are therefore no stresses and no displacements to report.",
        (
            "Look at the mechanism: the blocks that move lack a support, a tie, friction or weight on top. In this "
            "motion a joint that slides also opens a little; it is a proof, not a forecast of the fall.",
            "Check that supports, side walls and joints are where you meant them ('concio check'); a block that "
            "touches nothing falls.",
            "'concio limit' gives the share of the load that can be carried.",
        ),
    ),
    Status.COLLAPSES: Words(
        "The structure moves away under these loads.",
        "Forces that balance the loads within the strength of the joints exist, but no state was found in which "
        "sliding also obeys Coulomb's law; and released at rest the structure accelerates along the motion drawn "
        "below and does not come to rest. During this motion the forces are constant: closed joints press, sliding "
        "joints are resisted by full friction, and what is left of the loads accelerates the masses. There are "
        "therefore no stresses and no displacements to report.",
        (
            "Look at the motion: joints that slide need more friction or more weight on top, blocks that turn need a "
            "support or a tie.",
            "That it moves away from rest does not exclude an equilibrium reached by another history, for example "
            "with wedges driven in or after the joints were pressed together; 'concio path' follows a history.",
            "'concio limit' gives the share of the load that can be carried.",
        ),
    ),
    Status.NO_COULOMB_STATE: Words(
        "The loads cannot be carried with Coulomb friction.",
        "Forces that balance the loads within the strength of the joints exist, but in every combination of open, "
        "sticking and sliding joints some condition fails: sliding joints would have to be resisted by more or less "
        "than friction provides. All combinations were excluded, each by a linear programme whose proof was recomputed "
        "from the original equations. Unlike a mechanism this is not a single motion that could be drawn. There are "
        "therefore no stresses and no displacements to report.",
        (
            "Follow the loads from zero with 'concio path': the path shows where equilibrium is lost.",
            "'concio limit' gives the load at which even the balance of forces fails; it lies above these loads.",
        ),
    ),
    Status.UNDECIDED: Words(
        "It is not known whether the loads are carried.",
        "Forces that balance the loads within the strength of the joints exist, so a collapse cannot be proven. But no "
        "state was found in which sliding also obeys Coulomb's law, and none was shown to be impossible. This happens "
        "near collapse, and where blocks jam. The numbers below are not an answer.",
        (
            "Do not rely on this structure under these loads: treat it as one that may slide.",
            "'concio limit' bounds them from both sides: what certified load steps carry, and what nothing carries.",
            "Follow the loads from zero with 'concio path': the path shows where equilibrium is lost.",
            "Solve with another method, for example --method lemke, or with a slightly smaller load.",
        ),
    ),
    Status.GAVE_UP: Words(
        "The solver stopped without an answer.",
        "It neither found an equilibrium that passes the check nor a proof that there is none. The numbers below are "
        "not an answer, and nothing follows from them about the structure.",
        (
            "Read what was tried, at the end of this report.",
            "Solve with another method, for example --method lemke or --method interior-point.",
            "Look for stiffnesses or sizes that differ by many powers of ten: a wrong unit is the usual reason.",
        ),
    ),
    Status.CANCELLED: Words(
        "The calculation was stopped on request.",
        "It was not complete. Nothing below is an answer.",
        ("Run it again to the end.",),
    ),
}
