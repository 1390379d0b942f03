"""The verdict of a load path: which stages were asked for, what was reached of each, and what that shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.display import Units, counted, number
from concio.model.self_weight import weight_groups, weightless
from concio.problem.tolerances import CERTIFIED
from concio.solvers.path.record import Outcome as Ended
from concio.verdict.attention import SO_WITH, attention, joints_not_made
from concio.verdict.forced import forced_on_path
from concio.verdict.odd_weights import odd_weights
from concio.verdict.question import Question, question_of
from concio.verdict.unseen import unseen
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.path_loads import GroupLoad
    from concio.analysis.path_result import PathResult
    from concio.model.stages import Stage

MOST_STAGES = 8
"""More stages than this are counted in a short text."""

HEADLINES: dict[Outcome, str] = {
    Outcome.HOLDS: "The loads are carried to the end of the path.",
    Outcome.FAILS: "The structure collapses on this path.",
    Outcome.INCOMPLETE: "Part of the requested path was not reached.",
    Outcome.UNDECIDED: "The path could not be continued to its end.",
}
"""The answer in a few words."""
NO_LOAD = "No load acts: what is imposed is followed to the end of the path."
"""The answer where no stage applies a force: nothing is carried."""

HISTORY = "with Coulomb friction the order of the stages matters: another load history may end in another state"
SUDDEN = "a tie that breaks loses its force at once: the dynamic effect is not computed"
QUASI_STATIC = "inertia is neglected: the effects of sudden loads, falls and impacts are not computed"


def path_verdict(found: PathResult) -> Verdict:
    """Return the verdict of a load path.

    Parameters
    ----------
    found : PathResult
    """
    outcome = _outcome(found)
    odd = (*attention(found.assembly), *forced_on_path(found))
    first = tuple(f"{_capital(line)}." for line in odd)
    return Verdict(
        outcome=outcome,
        status=_status(found, outcome),
        question=_question(found),
        headline=_headline(found, outcome),
        answer=_answer(found, outcome),
        proof=path_proof(found),
        meaning=_meaning(found, outcome),
        limits=_limits(found),
        unchecked=_unchecked(found),
        attention=odd,
        next_steps=(*first, *_next_steps(found, outcome)),
    )


def _headline(found: PathResult, outcome: Outcome) -> str:
    if not found.certified:
        return "The states that were found do not pass their check."
    return NO_LOAD if outcome is Outcome.HOLDS and _no_load(found) else HEADLINES[outcome]


def _no_load(found: PathResult) -> bool:
    """Return whether no group that a stage applies has a force, and no tie is prestressed: the path carries nothing."""
    applied = {g for step in found.steps for g, v in step.factors.items() if v}
    prestressed = any(tie.prestress for tie in found.assembly.model.ties)
    return not prestressed and not any(np.abs(found.assembly.loads[g]).any() for g in applied & {*found.assembly.loads})


def _outcome(found: PathResult) -> Outcome:
    """Return what the path shows: a collapse only where one was shown, a success only where nothing is left out."""
    if not found.certified:
        return Outcome.UNDECIDED
    if found.collapsed:
        return Outcome.FAILS
    if found.outcomes[-1] is Ended.LOST:
        return Outcome.UNDECIDED
    return Outcome.HOLDS if found.complete and not _unchecked(found) else Outcome.INCOMPLETE


def _status(found: PathResult, outcome: Outcome) -> str:
    if outcome is Outcome.HOLDS:
        return "solved"
    if not found.certified:
        return "not_certified"
    return outcome.value if found.outcomes[-1] is Ended.REACHED else found.outcomes[-1].name.lower()


def _question(found: PathResult) -> Question:
    """Return the stages that were asked for, and what acts where the path ended."""
    units = found.assembly.model.report
    stages = "; ".join(stage_words(stage, units) for stage in found.stages[:MOST_STAGES])
    more = f"; and {len(found.stages) - MOST_STAGES} more" if len(found.stages) > MOST_STAGES else ""
    factors = found.steps[-1].factors if found.steps else {}
    last = {load.group: load for load in found.group_loads()} | {
        load.group: load for k in found.short for load in found.group_loads(k)
    }
    applied = {g for step in found.steps for g, v in step.factors.items() if v} | set(last)
    start = "from rest" if not any(found.steps[0].factors.values()) else "from a state of an earlier path"
    return question_of(
        f"a history {start}, in {counted(len(found.stages), 'stage')}: {stages}{more}",
        found.assembly,
        factors,
        multiplied={g: load.end for g, load in last.items()} | {g: v for g, v in factors.items() if g in last},
        wanted={g: load.asked for g, load in last.items()},
        applied=applied,
        stages=found.stages,
    )


def stage_words(stage: Stage, units: Units) -> str:
    """Return what a stage asks for, such as ``'push' (live = 1, and 'b1' moved by 20 mm)``.

    Parameters
    ----------
    stage : Stage
    units : Units
    """
    factors = ", ".join(f"{g} = {number(v, 6)}" for g, v in stage.factors.items()) or "no change of load"
    if stage.control is None:
        return f"'{stage.name}' ({factors})"
    moved = f"'{stage.control.body}' moved by {units.text('motion', stage.until, 6)}"
    return f"'{stage.name}' ({factors}, and {moved})"


def stage_sentence(found: PathResult, k: int) -> str:
    """Return how a stage that was begun ended, in one sentence."""
    if k not in found.short:
        return found.outcomes[k].value
    stage = found.stages[k]
    reached = found.assembly.model.report.text("motion", stage.until, 6)
    missing = [load for load in found.group_loads(k) if not load.applied]
    return f"Reached {reached}; {' and '.join(_reached(load) for load in missing)}."


def _reached(load: GroupLoad) -> str:
    """Return what was reached of a load group that was not applied in full."""
    asked = f"{number(load.asked, 6)} asked for"
    if load.away:
        return f"{load.group} went to {number(load.end, 6)}, away from the {asked}"
    size = abs(load.asked - load.begin)
    most, last = (number(value, 6, size=size) for value in (load.most, load.end))
    end = "" if last == most else f", and was {last} at the end"
    return f"{load.group} reached {most} of the {asked}{end}"


def _answer(found: PathResult, outcome: Outcome) -> str:
    """Return how the path ended, and at which load."""
    parts = [_ending(found, outcome)]
    parts += [_short(found, k) for k in found.short]
    if outcome is Outcome.HOLDS and (never := _idle(found)):
        parts.append(f"Never applied: {', '.join(never)}.")
    gone = _broken(found)[:-1] if found.outcomes[-1] is Ended.BROKEN else _broken(found)
    parts += [f"{_capital(line)}." for line in gone]
    missing = joints_not_made(found.assembly.detection)
    parts += [SO_WITH] if missing and outcome is Outcome.FAILS else []
    parts += [f"{_capital(line)}." for line in (*missing, *odd_weights(found.assembly.model))]
    return " ".join(filter(None, parts))


def _ending(found: PathResult, outcome: Outcome) -> str:
    """Return the end of the path in one sentence; nothing where the stages that fell short are all there is to say."""
    if not found.certified:
        return (
            f"The states of the path leave an error of {found.certificate:.1e} in the model's own equations "
            f"({CERTIFIED:.0e} is allowed): nothing follows from them about the structure."
        )
    if len(found.outcomes) == len(found.stages) and found.outcomes[-1] is Ended.REACHED:
        if found.short:
            return ""
        whole = "The stage is" if len(found.stages) == 1 else f"All {len(found.stages)} stages are"
        if _no_load(found):
            return f"{whole} followed to the end, and no load acts in any."
        light = ", without self-weight" if found.steps and len(found.stages) - 1 in found.weightless_stages else ""
        return f"{whole} carried to the end{light}."
    stage, most = found.stages[len(found.outcomes) - 1].name, _most(found)
    if outcome is Outcome.FAILS:
        light = ", without self-weight" if len(found.outcomes) - 1 in found.weightless_stages else ""
        if _loads_reached(found):
            return f"Collapses in stage '{stage}' at {most} asked for{light}, short of the displacement asked for."
        return f"Collapses in stage '{stage}': it carries no more than {most}{light}."
    if found.outcomes[-1] is Ended.LOST:
        return f"Lost in stage '{stage}': at least {most} is carried, and what follows is not known."
    broken = "".join(f" {_capital(line)}." for line in _broken(found)[-1:])
    return f"Stopped in stage '{stage}', which was carried up to {most}.{broken}"


def _broken(found: PathResult) -> tuple[str, ...]:
    """Return a sentence on each tie that breaks: those that the path goes on without, and the one where it ends."""
    units, ties = found.assembly.model.report, found.broken_ties
    last = len(ties) - 1 if found.outcomes[-1] is Ended.BROKEN else len(ties)
    ends = "there, stretched by {}; without it no equilibrium was found nearby"
    on = "on the way, stretched by {}; the path goes on without it"
    return tuple(
        f"tie '{name}' breaks {(ends if k == last else on).format(units.text('motion', far, 4))}"
        for k, (name, far) in enumerate(ties)
    )


def _short(found: PathResult, k: int) -> str:
    told = stage_sentence(found, k)
    what = "that load is not shown to be carried"
    return f"Stage '{found.stages[k].name}': {told[0].lower()}{told[1:].rstrip('.')}: {what}."


def _most(found: PathResult) -> str:
    """Return the largest load of the last stage, with what was asked for."""
    name, values = found.load()
    told = f"{name} = {float(values.max()):.6g}"
    loads = found.group_loads()
    if loads and all((v.begin, v.asked) == (loads[0].begin, loads[0].asked) for v in loads):
        reached = loads[0].most if loads[0].most != loads[0].begin else loads[0].end
        told = f"{name} = {number(reached, 6, size=abs(loads[0].asked))} of {number(loads[0].asked, 6)}"
    return told


def _loads_reached(found: PathResult) -> bool:
    """Return whether the loads of the last stage reached what was asked for: its displacement alone is missing."""
    loads = found.group_loads()
    return bool(loads) and all(abs(v.most - v.begin) >= abs(v.asked - v.begin) > 0 for v in loads)


def _idle(found: PathResult) -> tuple[str, ...]:
    """Return the load groups without self-weight that act in no stage."""
    weights = weight_groups(found.assembly.model)
    return tuple(f"load group '{group}'" for group in found.never_applied if group not in weights)


def _unchecked(found: PathResult) -> tuple[str, ...]:
    """Return what was asked for, or has to be expected, and is not shown."""
    lines = [f"'{stage.name}', which was not begun" for stage in found.stages[len(found.outcomes) :]]
    if found.collapsed or not found.steps:
        return tuple(lines)
    ends = {step.stage: step.factors for step in found.steps}
    lines += unseen(found.assembly, *ends.values())
    missing = weightless(found.assembly.model, found.steps[-1].factors)
    if missing and len(found.outcomes) == len(found.stages):
        named = " and ".join(f"'{group}'" for group in missing)
        lines.append(
            f"the structure with its own weight, which does not act at the end of the path (load group {named})"
        )
    return tuple(lines)


def _limits(found: PathResult) -> tuple[str, ...]:
    """Return what limits the answer."""
    lines = list(joints_not_made(found.assembly.detection))
    if alone := found.weightless_stages:
        names = " and ".join(f"'{found.stages[k].name}'" for k in alone)
        groups = ", ".join(f"'{g}'" for g in weight_groups(found.assembly.model))
        lines.append(f"without self-weight (load group {groups}) the structure was followed in {names}")
    for k, ended in enumerate(found.outcomes):
        for load in found.group_loads(k):
            if (
                ended is Ended.REACHED
                and load.applied
                and load.end != load.asked
                and found.stages[k].control is not None
            ):
                lines.append(f"stage '{found.stages[k].name}': {_beyond(load)}")
    lines += story(found)
    if found.broken_ties:
        lines.append(SUDDEN)
    lines += _far(found)
    if bool((found.assembly.laws.friction > 0).any()):
        lines.append(HISTORY)
    return (*lines, QUASI_STATIC)


def _far(found: PathResult) -> tuple[str, ...]:
    """Return a sentence on the joint that moved most at the ends of stages, where that is too far."""
    ends = {step.stage: k for k, step in enumerate(found.steps)}
    moved = max((found.result(k).joint_motion for k in ends.values()), key=lambda m: m.share, default=None)
    if moved is None or not moved.large:
        return ()
    return (f"{moved.sentence}; 'push' and 'shake' follow structures that have moved that far",)


def _beyond(load: GroupLoad) -> str:
    most = "" if load.most == load.end else f"{load.group} reached {number(load.most, 6)} and "
    verb = "was" if most else f"{load.group} was"
    return f"{most}{verb} {number(load.end, 6)} where the motion ended, with {number(load.asked, 6)} asked for"


def story(found: PathResult) -> tuple[str, ...]:
    """Return the notes of a path without those that its sentence tells already."""
    return tuple(note for note in found.notes if "ended at" not in note)


def _meaning(found: PathResult, outcome: Outcome) -> str:
    """Return what the outcome means and does not mean."""
    if outcome is Outcome.HOLDS:
        return "Every state from rest to the end of the last stage is in equilibrium and obeys the law of every joint."
    if outcome is Outcome.INCOMPLETE and found.short:
        return (
            "The motion asked for was reached, and under it the load fell short of its factor. Every state shown is in "
            "equilibrium under the loads that it is drawn with; that the structure carries the factor asked for does "
            "not follow, nor that it does not: other histories may carry more."
        )
    ended = found.outcomes[-1]
    return "" if ended is Ended.REACHED else ended.value


def _next_steps(found: PathResult, outcome: Outcome) -> tuple[str, ...]:
    if outcome is Outcome.FAILS:
        return (
            "Look at the last step in the view: it is the state in which the structure begins to move.",
            "'concio limit' puts the load beside the associated bound, which no history exceeds.",
        )
    if found.short:
        return (
            "Without a control point the path ends where the load itself is not reached: run it that way to see.",
            "'concio limit' gives a bound that needs no path.",
        )
    if found.outcomes[-1] is Ended.BROKEN:
        return (
            "Apply the load under displacement control ('--point', '--until'): the load may fall as the tie breaks.",
            "Delete the tie from the model and follow the path again: what remains has to carry the loads alone.",
            "'concio push' follows the motion past the break.",
        )
    if outcome is not Outcome.HOLDS and found.complete and found.certified:
        return (
            "Apply the self-weight in the first stage: --stage dead=1, or [[stages]] with factors = { dead = 1.0 }.",
        )
    if outcome is not Outcome.HOLDS:
        return (
            "Follow it again in steps ('--method steps'), or under displacement control ('--point', '--until').",
            "'concio limit' gives a bound that needs no path.",
        )
    return (
        "This says that the structure stands throughout this load history, not how far it is from collapse: add a "
        "stage of growing load, or use 'concio limit'.",
    )


def path_lines(found: PathResult) -> list[str]:
    """Return a load path in a few lines: outcome, sizes, and how far each stage went."""
    size = f"{len(found.steps):,} states, {len(found.events):,} events"
    lines = [
        f"PathResult: {found.sentence}",
        f"  {found.assembly.model.title or 'model without a title'}: {size}, certified to {found.certificate:.1e}",
    ]
    for k, ended in enumerate(found.outcomes[:MOST_STAGES]):
        lines.append(f"  stage '{found.stages[k].name}': {ended.name}, {stage_loads(found, k)}")
    if len(found.outcomes) > MOST_STAGES:
        lines.append(f"  ... and {len(found.outcomes) - MOST_STAGES} more stages")
    return lines


def stage_loads(found: PathResult, k: int) -> str:
    """Return what was reached of the loads of a stage that was begun, such as ``live = 0.25 of 1``."""
    loads = found.group_loads(k)
    if not loads:
        return "no load changes"
    return ", ".join(_load_words(load) for load in loads)


def _load_words(load: GroupLoad) -> str:
    size = max(abs(load.asked), abs(load.begin))
    reached = load.end if load.away else load.most
    most, last = (number(value, 6, size=size) for value in (reached, load.end))
    told = f"{load.group} = {most}"
    if load.away or not load.applied:
        told += f" of {number(load.asked, 6)}"
    return told if last == most else f"{told}, {last} at the end"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def path_proof(found: PathResult) -> str:
    """Return what was checked, in one sentence."""
    worst, count = found.certificate, counted(len(found.steps), "state")
    kept = f"the balance of work, stored energy and dissipation closes to {found.energy_error:.1e}"
    where = f"of {count}, each put into the model's equations at its own load factors and support positions, is"
    if found.certified:
        passed = f"the largest error in any equation {where} {worst:.1e} ({CERTIFIED:.0e} is allowed)"
        return f"Certified: {passed}; {kept}."
    return f"Not certified: the largest error in any equation {where} {worst:.1e}; {kept}."
