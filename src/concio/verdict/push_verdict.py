"""The verdict of a push: what a structure carries at large displacements, as far as the curve was followed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.applied import resultants, sideways
from concio.contact.factors import load_factor
from concio.contact.reference import Reference
from concio.display import number
from concio.fem.discretisation import Discretisation
from concio.model.interfaces.detect import Detection
from concio.model.materials import Elastic
from concio.model.model import Model
from concio.problem.tolerances import CERTIFIED
from concio.verdict.attention import attention_of, joints_not_made
from concio.verdict.capped_corners import capped_corners, without_capped
from concio.verdict.question import Acting, Question, question_of
from concio.verdict.unseen import unseen
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.motion.push_result import PushResult

WEIGHTS = "weights"
"""What stands for a load group where a share of the weights is multiplied."""

SEVERAL = "Coulomb friction can have several equilibria: the curve is the one that follows from rest as the load grows"
LENT = "hard joints of rigid blocks give way by a millionth of a width: the peak falls short by some ten thousandths"
ADDS_UP = (
    "hard joints of rigid blocks give way by a millionth of a width, which adds up where they are many: extended back "
    "to zero displacement, the falling part of the curve begins {share} % above the peak"
)
NONE_LEFT = 1e-4
"""Share of the peak below which the strength is lost where a curve has ended."""
SMALL = 0.005
"""Share of the peak by which the falling part of a curve begins above it, below which the sentence is the usual one."""
HEADLINES = {
    Outcome.HOLDS: "The curve was followed to where it was to end.",
    Outcome.INCOMPLETE: "The curve ends before the strength is lost.",
    Outcome.UNDECIDED: "The points of the curve do not pass their check.",
}
FELL_SHORT = "The multiplier asked for was not reached."


def push_verdict(found: PushResult) -> Verdict:
    """Return the verdict of a push.

    Parameters
    ----------
    found : PushResult
    """
    outcome = _outcome(found)
    reference = found.reference
    seen = without_capped(found.model, reference.detection)
    open_ = (*_unchecked(found), *capped_corners(found.model, reference.detection), *_unseen(found))
    if outcome is Outcome.HOLDS and open_:
        outcome = Outcome.INCOMPLETE
    return Verdict(
        outcome=outcome,
        status=found.ending.name.lower() if found.certified else "not_certified",
        question=_question(found),
        headline=FELL_SHORT if _fell_short(found) and found.certified else HEADLINES[_outcome(found)],
        answer=_answer(found),
        proof=_proof(found),
        meaning=_meaning(found),
        limits=(
            *joints_not_made(seen),
            *((_lent(found),) if found.lent_compliance else ()),
            SEVERAL,
            *found.notes,
        ),
        unchecked=open_,
        attention=attention_of(found.model, seen),
        next_steps=(
            "Look at the events: where joints open, slip or close, and where ties yield or break.",
            "'concio shake' computes the response to a ground motion; a push is not a motion in time.",
        ),
    )


@dataclass(frozen=True)
class Described:
    """The loads of a model as described, for structures whose blocks may touch nothing.

    Parameters
    ----------
    reference : Reference
    """

    reference: Reference

    @property
    def model(self) -> Model:
        """The model."""
        return self.reference.model

    @property
    def detection(self) -> Detection:
        """Its interfaces as described."""
        return self.reference.detection

    @property
    def disc(self) -> Discretisation:
        """Its bodies."""
        return self.reference.disc

    @property
    def groups(self) -> tuple[str, ...]:
        """The load groups."""
        return tuple(self.reference.model.load_groups)

    @property
    def loads(self) -> dict[str, np.ndarray]:
        """The forces of each load group (N,) [kN]."""
        return self.reference.described_loads


def _outcome(found: PushResult) -> Outcome:
    """Return what the curve shows: to its end, or not as far as was asked."""
    if not found.certified:
        return Outcome.UNDECIDED
    return Outcome.HOLDS if found.ending.name in ("LOST", "REACHED", "NO_LARGER_LOAD", "LOCKED") else Outcome.INCOMPLETE


def _fell_short(found: PushResult) -> bool:
    """Return whether a growing load ended below the multiplier that was asked for."""
    return found.by_load and found.until is not None and found.ending.name == "NO_LARGER_LOAD"


def _question(found: PushResult) -> Question:
    until = "" if found.until is None else f", to {_control(found, found.until)}"
    to_side = f"the side ({', '.join(f'{v + 0.0:.4g}' for v in found.direction)})"
    grows = ", ".join(found.live) if found.live else f"a share of the weights to {to_side}"
    asked = f"the multiplier of {grows} over a growing displacement, from equilibrium{until}, where the bodies stand"
    if found.by_load:
        asked = f"equilibria under a growing multiplier of {grows}{until}, where the bodies stand"
    sign = -1.0 if found.reversed else 1.0
    question = question_of(
        asked, Described(found.reference), found.factors, multiplied=dict.fromkeys(found.live, sign * found.peak)
    )
    if found.live:
        scaled = [_times(one, load_factor(found.factors, one.group)) if one.group in found.live else one
                  for one in question.acting]  # fmt: skip
        return replace(question, acting=tuple(scaled))
    force = tuple(found.force.tolist())
    own = Acting(WEIGHTS, _turned(found), force, float(np.linalg.norm(force)), found.peak, "multiplied")
    return Question(question.asked, (*question.acting, own), question.assumptions)


def _times(one: Acting, factor: float) -> Acting:
    """Return a multiplied group with its forces at a multiplier of 1: those of its own factor."""
    return replace(one, force=tuple(factor * v for v in one.force), size=abs(factor) * one.size)


def _control(found: PushResult, value: float) -> str:
    return f"a multiplier of {number(value, 6)}" if found.by_load else found.model.report.text("motion", value, 6)


def _answer(found: PushResult) -> str:
    """Return what was reached, in sentences with numbers."""
    units, last = found.model.report, len(found) - 1
    at = units.text("motion", float(found.displacement[found.peak_step]), 4)
    end = units.text("motion", float(found.displacement[last]), 4)
    now = number(float(found.multiplier[last]), 4, size=found.peak)
    if found.peak_passed or found.ending.name == "NO_LARGER_LOAD":
        told = f"The largest multiplier is {number(found.peak, 6)}, at {at}."
    else:
        told = f"The multiplier still grows where the curve ends, {number(found.peak, 6)} at {at}: no peak was reached."
    endings = {
        "LOST": f"The multiplier falls to {now} at {end}." if abs(found.multiplier[last]) > NONE_LEFT * found.peak
        else f"The strength is lost at {end}.",
        "REACHED": f"The requested end was reached, {end}; the multiplier is {now} there.",
        "NO_EQUILIBRIUM": f"No equilibrium beyond {end} could be followed, where the multiplier is {now}: there may be "
        "another one there, or none.",
        "NO_LARGER_LOAD": "No equilibrium nearby carries more: a growing load ends at the peak.",
        "LOCKED": "The structure locks: the multiplier grows without bound.",
        "STOPPED": f"It was stopped on request at {end}, where the multiplier is {now}.",
    }
    return f"{told} {endings[found.ending.name]}"


def _turned(found: PushResult) -> str:
    """Return which weights are multiplied, with their kN by the load group they come from: those of an assessment."""
    model = found.model
    made, numbers = sideways(model, found.direction.tolist(), WEIGHTS)
    forces = resultants(replace(model, loads=tuple(made)), range(len(made)), [model.loads[k].group for k in numbers])
    words = ", ".join(
        f"{group} {number(load_factor(found.factors, group) * size, 4)} kN" for group, (_, size) in forces.items()
    )
    return f"weights and what loads bodies from above, applied horizontally: {words}"


def _proof(found: PushResult) -> str:
    return (
        f"Certified where the bodies stand in each of {len(found)} states: balance of forces at the load factors and "
        f"support positions of that state, gaps, cone and slip direction of the contact pairs found there, to "
        f"{found.certificate:.1e} (relative; {CERTIFIED:.0e} is allowed)."
    )


def _meaning(found: PushResult) -> str:
    return (
        "Every state of the curve is in equilibrium where the bodies stand, under the loads that act as they are and "
        "the multiplied one. Between two states nothing was checked, but for ties: where they yield and break is "
        "located. Beyond the last state nothing is said."
    )


def _lent(found: PushResult) -> str:
    """Return how far the peak falls short because hard joints of rigid blocks give way, as far as the curve tells it.

    Joints that give way delay the peak, and a structure that has moved carries less. The chord of the falling part is
    taken to a point at least twice as far as the peak, or to the end. Where ties, blocks or other joints give way too,
    or a tie breaks, the curve does not show what the hard joints take.
    """
    top = found.peak_step
    d, m = np.abs(found.displacement), found.multiplier
    if _gives_way(found.model) or found.by_load or not found.peak_passed or d[top] <= 0 or m[top] <= 0:
        return LENT
    k = top + 1 + min(int(np.searchsorted(d[top + 1 :], 2 * d[top])), len(d) - top - 2)
    share = float((m[top] - m[k]) / (d[k] - d[top]) * d[top] / m[top]) if d[k] > d[top] else 0.0
    return ADDS_UP.format(share=number(100 * share, 2)) if share > SMALL else LENT


def _gives_way(model: Model) -> bool:
    """Return whether anything but hard joints and soil gives way: bars, elastic blocks, joints with a stiffness."""
    soft = any(law.normal_stiffness is not None for law in model.laws.values())
    pulls = any(tie.kind == "bar" for tie in model.ties)
    return pulls or soft or any(isinstance(material, Elastic) for material in model.materials.values())


def _unchecked(found: PushResult) -> tuple[str, ...]:
    """Return what was asked for or would be expected, and was not reached."""
    name = found.ending.name
    if name in ("NO_EQUILIBRIUM", "STOPPED"):
        where = found.model.report.text("motion", float(found.displacement[-1]), 4)
        return (f"the curve beyond {where}",)
    if _fell_short(found) and found.until is not None:
        return (f"whether an equilibrium far from there carries the multiplier of {number(found.until, 6)} asked for",)
    return ()


def _unseen(found: PushResult) -> tuple[str, ...]:
    """Return a sentence on bodies that no certificate can see at the beginning or at the peak."""
    sign = -1.0 if found.reversed else 1.0
    ends = [dict.fromkeys(found.live, m) for m in (0.0, sign * found.peak)]
    return unseen(
        Described(found.reference), *({**found.factors, **end} for end in ends), groups=found.structures
    )  # fmt: skip
