"""The verdict of a limit load: the design value and why, what is an upper bound only, and what stays open."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.assembly import Assembly
from concio.display import Units, counted
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.verdict.attention import attention, joints_not_made
from concio.verdict.crushing import crushing
from concio.verdict.no_limit import SAME, without_limit
from concio.verdict.question import Acting, Question, question_of
from concio.verdict.step_verdict import REGULARISED, SEVERAL, loads_in_short
from concio.verdict.torsion_of_limits import torsion_open, torsion_words, twisting_joints, unless_torsion
from concio.verdict.unseen import unseen
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.limit_result import LimitResult

DEAD_NOT_CARRIED = "the constant loads alone cannot be carried: a mechanism proves it"
"""What the exception of a limit load says where no forces balance the loads that are not multiplied."""

MOST_TIES = 5
"""More ties than this are not named."""

LOCKED = (
    "the bound of associated friction is locked, which says nothing about Coulomb friction: there sliding joints "
    "do not wedge"
)


def limit_verdict(found: LimitResult) -> Verdict:
    """Return the verdict of a limit load.

    Parameters
    ----------
    found : LimitResult
    """
    question = limit_question(found)
    outcome, headline = _outcome(found)
    open_ = _unchecked(found, outcome)
    if outcome is Outcome.HOLDS and _unseen(found):
        outcome = Outcome.INCOMPLETE
    return Verdict(
        outcome=outcome,
        status=_status(found, outcome),
        question=question,
        headline=headline,
        answer=_answer(found, question),
        proof=_proof(found),
        meaning="The design value is the least of the multipliers found with Coulomb friction: along the load history, "
        "at a "
        "certified state in which the structure can begin to move, or with the pressure spread over joints in torsion. "
        "The associated bound is larger than all of them and is never the design value.",
        limits=_limits(found),
        unchecked=open_,
        attention=attention(found.assembly),
    )


def limit_question(found: LimitResult) -> Question:
    """Return what is multiplied, by how many kN at 1, and what acts constantly."""
    reached = found.design if math.isfinite(found.design) else math.nan
    return question_of(
        f"the largest multiple of {named(found)} that is carried while all other loads act with factor 1",
        found.assembly,
        multiplied=dict.fromkeys(found.groups, reached),
    )


def named(found: LimitResult) -> str:
    """Return the groups that are multiplied, in quotes."""
    return "'" + "' and '".join(found.groups) + "'"


def _outcome(found: LimitResult) -> tuple[Outcome, str]:
    """Return the outcome, and the answer in a few words."""
    if found.dead in PROVEN_FAILURES:
        return Outcome.FAILS, "The loads that stay constant are not carried alone."
    if not (found.associated.checked or found.associated.bounds_hold):
        return Outcome.UNDECIDED, "The upper bound could not be checked."
    if found.dead is not None and found.dead is not Status.SOLVED:
        return Outcome.UNDECIDED, "It is not known whether the loads that stay constant are carried alone."
    if found.endless:
        return Outcome.HOLDS, "The load can grow without bound."
    if found.none_of_it:
        return Outcome.FAILS, f"No multiple of {named(found)} is carried."
    if without_limit(found):
        return Outcome.INCOMPLETE, f"No limit of {named(found)} was found."
    if not math.isnan(found.design):
        least = f"{max(found.design, 0.0):.6g} times {named(found)}"
        return Outcome.HOLDS, f"Design with {least} at most{unless_torsion(found)}."
    if found.associated.locked:
        return Outcome.INCOMPLETE, "Neither an upper bound nor a carried load was found."
    if found.steps is None and found.path is None and found.path_note.startswith("not asked"):
        top = f"{found.associated.multiplier:.6g} times {named(found)}"
        return Outcome.HOLDS, f"No equilibrium exists beyond {top}."
    return Outcome.INCOMPLETE, "Only an upper bound was found."


def _status(found: LimitResult, outcome: Outcome) -> str:
    if outcome is Outcome.FAILS and found.dead in PROVEN_FAILURES:
        assert found.dead is not None
        return found.dead.name.lower()
    if outcome is Outcome.FAILS and found.steps is not None and found.steps.outcome is not None:
        return found.steps.outcome.name.lower()
    if outcome is Outcome.HOLDS:
        return "solved"
    return outcome.value if found.associated.checked else "gave_up"


def _answer(found: LimitResult, question: Question) -> str:
    """Return the design value and why, then what is an upper bound only."""
    if found.dead in PROVEN_FAILURES:
        assert found.dead is not None
        said = found.dead.value.rstrip(".")
        alone = replace(question, acting=tuple(a for a in question.acting if a.role == "constant"))
        text = (
            f"Nothing can be added: under {loads_in_short(alone, found.assembly.model.report)} alone, without "
            f"{named(found)}: {said[0].lower()}{said[1:]}."
        )
        return f"{text} {LOCKED[0].upper()}{LOCKED[1:]}." if found.associated.locked else text
    told = [_design(found, question), _upper(found)]
    return " ".join((*[line for line in told if line], *_not_made(found.assembly)))


def _design(found: LimitResult, question: Question) -> str:
    """Return the design value, and why, in one sentence."""
    low, groups = found.design, named(found)
    if found.dead is not None and found.dead is not Status.SOLVED:
        return (
            f"No design value: under the constant loads alone no certified state was found "
            f"({found.dead.name.lower()})."
        )
    steps = found.steps
    if steps is not None and found.none_of_it and steps.outcome is not None:
        said = steps.outcome.value.rstrip(".")
        return (
            f"No multiple of {groups} is carried: with it as given, {said[0].lower()}{said[1:]}; nothing else "
            f"acts, and all "
            "multiples are equal."
        )
    if found.none_of_it:
        return f"No multiple of {groups} is carried: a mechanism proves that none is in equilibrium."
    if steps is not None and found.endless and steps.state is None:
        return (
            f"{groups} can grow without bound: it is carried as given, nothing else acts, and all multiples "
            "are equal."
        )
    if found.endless:
        assert found.steps is not None
        return (
            f"{groups} can grow without bound: certified Coulomb states carry {found.steps.carried:.3g} times it, "
            f"and one "
            "further step in the same direction is certified at any length, since no joint changes its state any "
            "longer."
        )
    if math.isnan(low):
        return f"What Coulomb friction carries of {groups} is not known: no design value was found."
    if not low > 0 and not (found.collapse_state is not None and found.state_counts):
        return f"The design value of {groups} is zero: without what can break no multiple was shown to be carried."
    if not low > 0:
        text = f"The design value of {groups} is zero: a certified state lets the structure begin to move without it"
        if math.isnan(found.carried):
            return f"{text}."
        return f"{text}, though {found.carried:.6g} is carried where the load grows from rest."
    kN = _forces(question, low, found.assembly.model.report)
    if share := without_limit(found):
        return (
            f"No limit of {groups} was found: certified Coulomb states carry {low:.6g} times it ({kN}, {share:.3g} "
            "times all constant loads of their part) as the load grows from rest. Only joints that never crush carry "
            "as much: give them a compressive strength before a design value is taken."
        )
    return f"Design with {low:.6g} times {groups} ({kN}) at most{unless_torsion(found)}: {_why(found)}."


def _why(found: LimitResult) -> str:
    """Return what makes the design value."""
    low, carried = found.design, found.coulomb if found.collapse_shown else found.carried
    state = found.collapse_state
    spread = found.spread is not None and found.spread.steps.multipliers and found.spread.carried <= low
    if spread and not (math.isfinite(carried) and low * (1 - SAME) <= carried <= low * (1 + SAME)):
        assert found.spread is not None
        n, too = found.spread.points, f"{100 * abs(found.spread.error):.2g} %"
        if not n and found.spread.error < 0:
            return (
                f"certified load steps carry it with contact points that resist torsion {too} less than a uniform "
                "pressure does in joints that twist; an even number of them along each side resists it about as much"
                f"{_spread_next(found)}"
            )
        if not n:
            return (
                f"certified load steps carry {found.spread.steps.carried:.6g}, less {too} by which the contact points "
                f"of joints that twist resist torsion better than a uniform pressure{_spread_next(found)}"
            )
        return (
            f"certified load steps carry it with the pressure of each joint spread over {n} x {n} points; at the "
            f"corners "
            f"of the joints alone, {' of which '.join(twisting_joints(found).rsplit(' ', 1))}, they "
            f"would seem to carry {carried:.6g} ({too} are subtracted: these points overestimate torsion by as much"
            f"{_spread_next(found)})"
        )
    if state is not None and found.state_counts and state.multiplier <= low:
        if math.isclose(carried, low, rel_tol=SAME):
            return "as the load grows it is carried up to there, and there the structure begins to move"
        if math.isnan(carried):
            return (
                "from there on a certified state lets the structure begin to move; that less is carried was "
                "not shown"
            )
        return (
            f"from there on a certified state of the joints lets the structure begin to move, though {carried:.6g} is "
            "carried where the load grows from rest; which of them occurs depends on settlements and on earlier loads"
        )
    if found.ties_whole <= low:
        return "as the load grows it is carried up to there with all ties intact; then one breaks"
    if found.collapse_shown:
        return "as the load grows it is carried up to there, and there it collapses"
    return f"certified Coulomb states carry it as the load grows from rest{_next(found)}"


def _spread_next(found: LimitResult) -> str:
    """Return the least multiplier that steps with spread pressure did not reach."""
    assert found.spread is not None
    above = found.spread.not_reached
    return "" if math.isnan(above) else f"; {above:.6g} was tried and not reached"


def _next(found: LimitResult) -> str:
    """Return what came of the least multiplier that load steps did not reach."""
    steps = found.steps
    if steps is None or math.isnan(steps.failed) or steps.failed <= found.design:
        return ""
    if steps.outcome in PROVEN_FAILURES:
        return f"; {steps.failed:.6g} is not carried, applied in one step"
    if steps.outcome is Status.SOLVED:
        return (
            f"; {steps.failed:.6g} also has an equilibrium if applied in one step, but the growing load "
            f"did not reach it"
        )
    return f"; {steps.failed:.6g} was tried and not reached"


def _upper(found: LimitResult) -> str:
    """Return what is an upper bound only, in one sentence."""
    bound, low = found.associated, found.design
    if found.endless:
        return "The bound of associated friction is locked, and the load is in fact unbounded."
    if found.none_of_it and not bound.locked:
        return ""
    if bound.locked:
        return f"There is no upper bound: {LOCKED}."
    if math.isnan(bound.multiplier):
        return "No upper bound was found: no multiple of the load was found to be in balance."
    top = bound.multiplier if bound.checked else bound.upper
    if math.isclose(top, low, rel_tol=SAME):
        return "No equilibrium exists beyond it: a mechanism proves that."
    why = "a mechanism proves that" if bound.checked or bound.bounds_hold else "that is not checked"
    between = ", and the range in between is open" if not math.isnan(low) else ""
    return f"{top:.6g} times is an upper bound only: no equilibrium exists beyond it ({why}){between}."


def _forces(question: Question, factor: float, units: Units) -> str:
    """Return the multiplied groups at a factor, in kN."""
    multiplied: list[Acting] = [a for a in question.acting if a.role == "multiplied"]
    told = [units.text("force", abs(factor) * (float(np.linalg.norm(a.force)) or a.size), 4) for a in multiplied]
    return " and ".join(told)


def _not_made(assembly: Assembly) -> tuple[str, ...]:
    return tuple(f"{line[0].upper()}{line[1:]}." for line in joints_not_made(assembly.detection))


def _proof(found: LimitResult) -> str:
    """Return which of the model's own equations were evaluated, with their residuals."""
    bound = found.associated
    told = []
    if math.isfinite(bound.multiplier):
        violation = bound.mechanism.violation if bound.mechanism else math.nan
        told.append(
            f"the bound: forces in balance with the loads to {bound.residual:.0e}, a mechanism without overlap to "
            f"{violation:.0e}, a difference of their multipliers of {bound.gap:.0e}"
        )
    if found.steps is not None and found.steps.multipliers and found.steps.worst > 0:
        told.append(
            f"{counted(len(found.steps.multipliers), 'load step')}, each certified by the equations of the model "
            f"at its "
            f"own load, the worst to {found.steps.worst:.0e}"
        )
    if found.endless and found.steps is not None and found.steps.state is not None:
        told.append(f"steps a million times as long, certified to {found.steps.endless:.0e}")
    if found.collapse_state is not None:
        state = found.collapse_state
        told.append(f"the collapse state: forces to {state.statics:.0e}, motion to {state.flow:.0e}")
    if not told:
        return ""
    return f"Certified (relative residuals): {'; '.join(told)}."


def _limits(found: LimitResult) -> tuple[str, ...]:
    """Return what limits the answer."""
    assembly = found.assembly
    told = list(joints_not_made(assembly.detection))
    if found.twisting and not torsion_open(found):
        told.append(torsion_words(found))
    if found.collapse_state is not None and not found.state_counts:
        told.append(
            f"the collapse state at {found.collapse_state.multiplier:.6g} twists joints about the points nearest "
            f"to their "
            "middle: it falls as contact points are added, and is not counted"
        )
    if found.endless or without_limit(found):
        told.append("no joint crushes in this model: a compressive strength would bound the load")
    told += (*_breakable(found), *crushing(assembly))
    sought = found.steps is not None or found.path is not None or found.collapse_state is not None
    if sought and found.lent_compliance:
        told.append(REGULARISED)
    if sought and bool(np.any(assembly.laws.friction > 0)):
        told.append(SEVERAL)
    return tuple(told)


def _breakable(found: LimitResult) -> tuple[str, ...]:
    """Return a sentence on ties that can break, with the bound with them and without."""
    if found.untied is None:
        return ()
    ties = [t for t in found.assembly.model.ties if t.break_elongation is not None]
    names = ", ".join(f"'{t.name}'" for t in ties[:MOST_TIES]) + (" ..." if len(ties) > MOST_TIES else "")
    yields = ""
    if found.path is None:
        yields = (
            "; no path was followed to see how far they stretch, and the design value is at most the bound without them"
        )
    elif not math.isnan(found.ties_whole):
        yields = f"; on the path the first breaks at {found.ties_whole:.6g} or beyond that"
    less = found.untied.multiplier
    alone = "no bound was found" if math.isnan(less) else f"the bound is {less:.6g} times {named(found)}"
    top = found.associated.multiplier
    whole = "" if math.isnan(top) else f", with them {top:.6g}"
    return (
        f"{counted(len(ties), 'tie')} that can break ({names}): their force at break is counted{yields}; "
        f"once they are broken, {alone}{whole}",
    )


def _unchecked(found: LimitResult, outcome: Outcome) -> tuple[str, ...]:
    """Return what would be expected of a limit load and was not checked."""
    told = []
    if found.steps is None and found.path is None and not found.none_of_it:
        told.append(
            f"what Coulomb friction carries as the load grows (neither a path nor load steps: "
            f"{found.path_note})"
        )
    if found.dead is None:
        told.append("whether the loads that stay constant are carried alone with Coulomb friction")
    if outcome is Outcome.FAILS:
        return tuple(told)
    if torsion_open(found):
        told.append(torsion_words(found))
    return (*told, *_unseen(found))


def _unseen(found: LimitResult) -> tuple[str, ...]:
    """Return a sentence on bodies that no certificate can see without the load or with what is designed with."""
    most = found.design if math.isfinite(found.design) else 1.0
    return unseen(found.assembly, dict.fromkeys(found.groups, 0.0), dict.fromkeys(found.groups, most))
