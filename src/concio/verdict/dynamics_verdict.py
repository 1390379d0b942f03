"""The verdict of a motion: whether the structure stands it, moves on, or has fallen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.contact.applied import resultants
from concio.contact.factors import load_factor
from concio.display import number
from concio.problem.tolerances import CERTIFIED, ENERGY_ROUNDING
from concio.units import GRAVITY
from concio.verdict.attention import attention_of, joints_not_made
from concio.verdict.capped_corners import capped_corners, without_capped
from concio.verdict.push_verdict import Described
from concio.verdict.question import question_of
from concio.verdict.unseen import unseen
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.motion.dynamics_result import DynamicsResult

MOST_FALLEN = 3
"""More blocks than this are counted."""

CLOSES = 1e-3
"""Error of the energy balance, over what was turned over, beyond which it is pointed out."""

LEAST_GRAVITY, MOST_GRAVITY = 1.0, 30.0
"""Accelerations of gravity [m/s2] outside of which another unit was meant."""

OUTRAN = "too fast for the shortest step"
HEADLINES = {
    Outcome.HOLDS: "The structure withstands the motion and comes to rest.",
    Outcome.FAILS: "The structure falls.",
    Outcome.MOVING: "The structure still moves where the calculation ends.",
    Outcome.UNDECIDED: "The motion could not be continued to its end.",
    Outcome.INCOMPLETE: "The motion was not followed to its end.",
}
NO_START = "Whether it stands before the ground moves was not shown."
NOTHING_LEFT = "The structure comes to rest; nothing of the motion of the ground was left to act."
CAPPED = "Whether contacts at corners and edges crush was not checked."
SHORT = "no equilibrium was found from where its supports have moved"
"""Begins the note of a motion whose supports did not get to where they were asked to be."""
SENSITIVE = (
    "rocking is sensitive to details: near the limit another step, restitution or record may give another outcome"
)


def dynamics_verdict(found: DynamicsResult) -> Verdict:
    """Return the verdict of a motion.

    Parameters
    ----------
    found : DynamicsResult
    """
    outcome = shown = _outcome(found)
    reference = found.reference
    seen = without_capped(found.model, reference.detection)
    small = unseen(Described(reference), found.factors, groups=found.structures)
    capped = capped_corners(found.model, reference.detection)
    if capped and outcome in (Outcome.HOLDS, Outcome.FAILS):
        outcome = Outcome.INCOMPLETE
    if small and not found.fallen and outcome in (Outcome.HOLDS, Outcome.FAILS):
        outcome = Outcome.INCOMPLETE  # neither that it rests nor that it does not stand is shown of such bodies
    return Verdict(
        outcome=outcome,
        status=_status(found, outcome),
        question=question_of(_asked(found), Described(reference), found.factors),
        headline=CAPPED if capped and outcome is not shown else _headline(found, outcome),
        answer=_answer(found, outcome),
        proof=_proof(found),
        meaning=(
            "Every step satisfies the equations of motion with contact and friction. A slightly different earthquake "
            "may give another outcome."
        ),
        limits=(*joints_not_made(seen), *_without_mass(found), SENSITIVE),
        unchecked=(*_unchecked(found, shown), *capped, *small),
        attention=(*attention_of(found.model, seen), *_noticed(found)),
        next_steps=("Repeat it with half the step, and with the record scaled by 0.9 and 1.1.",),
    )


def _without_mass(found: DynamicsResult) -> tuple[str, ...]:
    """Return which loads from above act as forces alone: what they stand for has no inertia in the motion."""
    loads = [k for k, load in enumerate(found.model.loads) if load.kind != "weight"]
    told = []
    for group, (force, _) in resultants(found.model, loads).items():
        down = -float(force[-1]) * load_factor(found.factors, group)
        if down > 0:
            told.append(f"{found.model.report.text('force', down, 4)} of '{group}'")
    if not told:
        return ()
    return (f"loads from above act as forces and have no mass: the inertia of {', '.join(told)} is not in the motion",)


def _headline(found: DynamicsResult, outcome: Outcome) -> str:
    if outcome is Outcome.INCOMPLETE and found.ending.name != "STOPPED" and not _begins_nowhere(found):
        return "What happens to some bodies could not be resolved."
    if found.stands is False and not _begins_nowhere(found):
        return "The structure does not stand at the start."
    if outcome is Outcome.HOLDS and _nothing_left(found):
        return NOTHING_LEFT
    return NO_START if _begins_nowhere(found) and outcome is Outcome.INCOMPLETE else HEADLINES[outcome]


def _nothing_left(found: DynamicsResult) -> bool:
    """Return whether the ground had come to rest before this motion, which goes on from another one, began."""
    return bool(found.asked) and found.begun > 0 and found.begun >= found.ground_ends * (1 - 1e-9)


def _begins_nowhere(found: DynamicsResult) -> bool:
    """Return whether no equilibrium was found at the start, while nothing shows that there is none."""
    short = any(note.startswith(SHORT) for note in found.notes)
    return found.stands is False and not found.refuted and not short


def _outcome(found: DynamicsResult) -> Outcome:
    """Return what the motion shows."""
    ending = found.ending.name
    if not found.certified:
        return Outcome.UNDECIDED
    open_ = _begins_nowhere(found)
    if found.fallen or (found.stands is False and not open_ and ending != "UNSOLVED"):
        return Outcome.FAILS
    if ending == "UNSOLVED":
        return Outcome.UNDECIDED
    if ending == "STOPPED":
        return Outcome.INCOMPLETE
    if not found.rests or found.end.time < found.ground_ends * (1 - 1e-9):
        return Outcome.MOVING
    return Outcome.INCOMPLETE if open_ else Outcome.HOLDS


def _status(found: DynamicsResult, outcome: Outcome) -> str:
    if not found.certified:
        return "not_certified"
    if outcome is Outcome.FAILS and found.stands is False and not _begins_nowhere(found):
        return "does_not_stand"
    names = {Outcome.HOLDS: "at_rest", Outcome.FAILS: "fallen", Outcome.MOVING: "moving"}
    if found.ending.name == "OVERTURNED":
        return "overturned"
    return names.get(outcome, found.ending.name.lower())


def _asked(found: DynamicsResult) -> str:
    ground = found.asked or "no motion of the ground"
    peak = f", largest acceleration {number(found.ground_peak / GRAVITY, 4)} g" if found.asked else ""
    time = "until rest or a fall" if found.stated is None else f"for {number(found.stated, 6)} s"
    start = "from equilibrium"
    if found.begun > 0:
        start = f"from where an earlier motion ended, at {number(found.begun, 6)} s of the motion of the ground,"
        start = start if found.asked else "from where an earlier motion ended"
    if found.stands is None and not found.begun > 0:
        start = "from the bodies as described"
    return f"the motion {start} {time} under {ground}{peak}"


def supports_short(share: float) -> str:
    """Return the note of a motion that begins where its supports are short of what was asked, at a share of it."""
    return f"{SHORT} by {share:.3g} of what was asked: the motion begins there"


def outran(name: str, moves: str, least: float) -> str:
    """Return the note of a motion that ends where a body is too fast for its shortest steps [s]."""
    return f"'{name}' {moves}, {OUTRAN} of {number(least, 2)} s: ask for a smaller step"


def _answer(found: DynamicsResult, outcome: Outcome) -> str:
    """Return what became of the structure, in sentences with numbers."""
    time = f"{number(float(found.end.time), 5)} s"
    told = []
    if found.refuted:
        told.append(f"The structure does not stand before the ground moves. {found.refuted}")
    elif _begins_nowhere(found):
        told.append(
            "No equilibrium under its loads was found before the ground moves, and nothing shows that there is none: "
            "the motion begins with the bodies at rest as described."
        )
    elif found.stands is False:
        told.append("The structure does not stand before the ground moves: no equilibrium under its loads was found.")
    if found.fallen:
        more = f", and {len(found.fallen) - MOST_FALLEN} more" if len(found.fallen) > MOST_FALLEN else ""
        told.append(f"At {time} it has fallen: {'; '.join(found.fallen[:MOST_FALLEN])}{more}.")
        if found.ending.name == "UNSOLVED":
            told.append("It was not followed further: after that no step, however small, satisfies its equations.")
    elif outcome is Outcome.UNDECIDED:
        fast = next((note for note in found.notes if OUTRAN in note), None)
        told.append(f"After {time} {fast or 'no step, however small, satisfies its equations'}.")
    elif found.ending.name == "STOPPED":
        told.append(f"It was stopped on request at {time}.")
    elif found.stands is False and any(note.startswith(SHORT) for note in found.notes):
        told.append(
            "Its supports stopped short of the positions asked for, because no equilibrium was found further on: what "
            f"it does from there until {time} is not the motion that was asked for."
        )
    elif found.rests:
        told.append(f"It has come to rest at {time}, in an equilibrium that was found where it stands.")
    else:
        told.append(f"It still moves at {time}: whether it comes to rest or falls is not known.")
    name, turned = found.largest_rotation
    told.append(f"'{name}' turned most, by {number(float(np.rad2deg(turned)), 4)} degrees from where it was described.")
    return " ".join(told)


def _proof(found: DynamicsResult) -> str:
    return (
        f"Certified in each of {len(found.steps):,} steps: momentum of every body, contact, cone and slip, to "
        f"{found.certificate:.1e} (relative; {CERTIFIED:.0e} is allowed). The total energy, from positions "
        f"and velocities, is constant to {_of_what(found)}."
    )


def _of_what(found: DynamicsResult) -> str:
    """Return the error of the energy balance, with what it is a share of."""
    energy = found.energy
    if not energy.still:
        return f"{energy.error:.1e} of the energy exchanged"
    least = f"{number(energy.rounding, 2)} kN m, which lifts it by {ENERGY_ROUNDING:.0e} of its size"
    return f"{energy.error:.1e} of {least}: less was exchanged"


def _unchecked(found: DynamicsResult, outcome: Outcome) -> tuple[str, ...]:
    """Return what would be expected and was not seen."""
    if _begins_nowhere(found) and found.rests:
        return ("the motion from an equilibrium under the loads: none was found at the start",)
    if outcome not in (Outcome.MOVING, Outcome.INCOMPLETE):
        return ()
    end = float(found.end.time)
    if end < found.ground_ends * (1 - 1e-9):
        return (f"the motion of the ground from {number(end, 5)} s to {number(found.ground_ends, 5)} s",)
    return (f"what happens after {number(end, 5)} s: leave the duration out to follow it until rest or a fall",)


def _noticed(found: DynamicsResult) -> tuple[str, ...]:
    """Return what asks for attention in the motion itself."""
    late = (
        "the motion of the ground is over before this one begins: its time is that of the earlier motion; put zeros "
        "before a record that is to begin later",
    )
    odd = (f"the energy balance is off by {_of_what(found)}: take a smaller step",)
    more = (*(late if _nothing_left(found) else ()), *(odd if found.energy.error > CLOSES else ()))
    return (*found.notes, *_idle_damping(found), *_own_gravity(found), *more)


def _own_gravity(found: DynamicsResult) -> tuple[str, ...]:
    """Return a sentence on a gravity that is none of a planet's."""
    if LEAST_GRAVITY <= found.gravity <= MOST_GRAVITY:
        return ()
    return (f"masses are weights over a gravity of {number(found.gravity, 4)} m/s2; on Earth it is 9.81 m/s2",)


def _idle_damping(found: DynamicsResult) -> tuple[str, ...]:
    """Return in a sentence each damping that was stated and damps nothing: blocks are rigid, joints hard."""
    reference, scheme = found.reference, found.scheme
    elastic = bool(reference.meshed.size)
    sprung = bool(reference.laws.normal.any() or reference.laws.tangential.any() or found.model.ties)
    told = []
    if scheme.mass_damping and not elastic:
        told.append("mass damping acts in elastic blocks, and all blocks are rigid: nothing is damped by it")
    if scheme.stiffness_damping and not (elastic or sprung):
        told.append("stiffness damping acts in elastic blocks, joints with a stiffness and ties, and there are none: "
                    "nothing is damped by it")  # fmt: skip
    return tuple(told)
