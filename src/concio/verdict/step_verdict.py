"""The verdict of one load step: whether the loads that act are carried, with residuals of the original equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.factors import load_factor
from concio.display import Units, number
from concio.problem.limits_of_work import LARGEST_HOLDING
from concio.problem.solution import Status
from concio.problem.tolerances import CERTIFIED
from concio.solvers.statics.self_stress import SelfStress, least_compression, least_compression_of
from concio.verdict.attention import attention, joints_not_made, torsion
from concio.verdict.crushing import crushing
from concio.verdict.forced import FORCED, forced_together
from concio.verdict.odd_weights import odd_weights
from concio.verdict.part_words import parts_told, regularised
from concio.verdict.question import GIVEN, Question, question_of
from concio.verdict.step_words import OUTCOMES, WORDS
from concio.verdict.unseen import unseen
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.result import Result

MUCH = 1000.0
"""Forces of a joint this many times all loads are pointed out."""

ON_PATH = "path"
"""Method of a result that is a state of a load path."""
MOST_REACTIONS = 4
"""More reactions than this are counted in a short text."""

SEVERAL = (
    "Coulomb friction can have several equilibria under the same loads: this is one of them, and the load history "
    "decides which one is reached"
)
REGULARISED = (
    "contact states between rigid blocks were found with a vanishing compliance, as the limit of stiff joints: without "
    "it "
    "their forces would not be determined"
)


def step_verdict(result: Result) -> Verdict:
    """Return the verdict of one load step.

    Parameters
    ----------
    result : Result
    """
    words, status = WORDS[result.status], result.status
    on_path = result.method == ON_PATH
    question = question_of(
        f"equilibrium under the loads that act, {'at a state of a load path' if on_path else 'in one step from rest'}",
        result.assembly, result.factors, stages=result.model.stages if on_path else (),
    )  # fmt: skip
    odd = (*attention(result.assembly), *_noticed(result), *broken_words(result))
    first = [f"{line[0].upper()}{line[1:]}." for line in odd]
    open_ = unseen(result.assembly, result.factors) if result.solved else ()
    return Verdict(
        outcome=Outcome.INCOMPLETE if open_ else OUTCOMES[status],
        status=status.name.lower(),
        question=question,
        headline=words.headline,
        answer=_answer(result, question),
        proof=proof(result),
        meaning=words.meaning,
        limits=_limits(result),
        unchecked=open_,
        attention=odd,
        next_steps=(*first, *words.next_steps),
    )


def _answer(result: Result, question: Question) -> str:
    """Return the outcome in words, with the loads it is about and what it leaves out."""
    text = result.status.value
    if result.solved:
        text = text.replace("In equilibrium:", f"In equilibrium under {loads_in_short(question, result.model.report)}:")
    if of := regularised(result):
        text = f"{text.rstrip('.')}, {of}."
    found = result.self_stress
    if found is not None:
        text += (
            f" Forces in balance within friction exist (with {found.compression:.4g} kN of "
            f"compression in the joints at least, {found.compression / found.load:.3g} times the loads), but only as "
            "self-stress that no load, prestress or settlement puts there."
        )
    left_out = (
        *joints_not_made(result.assembly.detection), *odd_weights(result.model), *broken_words(result)
    )  # fmt: skip
    return " ".join((text, *parts_told(result), *(_sentence(line) for line in left_out)))


def _sentence(line: str) -> str:
    """Return a finding with a capital and a stop; a question keeps its mark."""
    return f"{line[0].upper()}{line[1:]}{'' if line.endswith('?') else '.'}"


def broken_words(result: Result) -> tuple[str, ...]:
    """Return a sentence for each tie that was stretched to where it breaks."""
    units = result.model.report
    return tuple(
        f"tie '{name}' breaks: with it, it would be stretched by {units.text('motion', far, 4)}, and the answer is "
        "without it; the dynamic effect of its break is not computed"
        for name, far in result.broken_ties
    )


def loads_in_short(question: Question, units: Units) -> str:
    """Return the groups that act with their factors and kN, in a few words."""
    acting = [a for a in question.acting if a.role != "not applied"]
    if question.nothing_acts or not acting:
        return "no load at all"
    told = []
    for a in acting:
        factor = "" if a.factor == 1.0 else f" x {number(a.factor, GIVEN)}"
        told.append(f"{a.group}{factor} ({units.text('force', abs(a.factor) * a.size, 4) if a.size else a.what})")
    return " and ".join(told) if len(told) < 3 else ", ".join(told[:-1]) + f" and {told[-1]}"


def _limits(result: Result) -> tuple[str, ...]:
    """Return what limits the answer."""
    found = list(joints_not_made(result.assembly.detection))
    if result.model.dim == 3:
        found += torsion(result.model, result.assembly.detection, result.assembly.pairs.contact_model)
    found += crushing(result.assembly)
    if result.lent_compliance:
        found.append(REGULARISED)
    if result.solved and bool(np.any(result.assembly.laws.friction > 0)):
        found.append(SEVERAL)
    return tuple(found)


def self_stress(result: Result) -> SelfStress | None:
    """Return forces that would hold a structure which collapses as it is loaded; None where there are none."""
    if result.status not in (Status.COLLAPSES, Status.NO_COULOMB_STATE) or len(result.assembly.pairs) > LARGEST_HOLDING:
        return None
    problem = result.assembly.problem(result.factors)
    failing = [part.pairs for part in result.solution.parts if part.status is result.status]
    return least_compression_of(problem, failing) if failing else least_compression(problem)


def _noticed(result: Result) -> tuple[str, ...]:
    """Return what asks for attention in a certified step: large motions, a compliance that stayed, huge forces."""
    if not result.solved:
        return ()
    moved = result.joint_motion
    found = [f"{moved.sentence}; treat it as a warning, not as a state of rest"] if moved.large else []
    return (*found, *_not_rigid(result), *_heavy(result))


def _not_rigid(result: Result) -> tuple[str, ...]:
    """Return a sentence on an answer that still has the compliance added to joints of rigid blocks, else none."""
    if not (result.lent_compliance and result.assembly.lent_compliance):
        return ()
    answer, size = result.solution, f"{result.lent_compliance:.3g} m/kN"
    closing = float((result.assembly.laws.normal_compliance * answer.normal_force).max(initial=0.0))
    if closing > FORCED * float(np.abs(answer.displacement).max(initial=0.0)):
        return (forced_together(result.lent_compliance),)
    return (
        f"joints between rigid blocks keep the compliance of {size} that was added to them: no answer without it was "
        "certified, since which way they slip depends on it a little",
    )


def _heavy(result: Result) -> tuple[str, ...]:
    """Return a sentence on the pair with the largest force where that is a thousand times the loads, else none."""
    load = result.assembly.problem(result.factors).total_load
    t_n, t_t = result.solution.normal_force, result.solution.friction_force
    size = np.hypot(t_n, np.linalg.norm(t_t, axis=1))
    if not size.size or not load > 0 or not size.max() > MUCH * load:
        return ()
    k = int(np.argmax(size))
    pairs, bodies = result.assembly.pairs, result.model.bodies
    a, b = ("" if i < 0 else bodies[i].name for i in (int(pairs.body_a[k]), int(pairs.body_b[k])))
    at = ", ".join(f"{v:.4g}" for v in pairs.point[k])
    return (
        f"joint {a}|{b} carries {size[k]:.4g} kN at ({at}), {size[k] / load:.3g} times all loads: forces this large "
        "balance themselves, and how large they are rests on details such as corners and the mesh",
    )


def result_lines(result: Result) -> list[str]:
    """Return a result in some ten lines: outcome, certificate, sizes, loads; of a solved one motions and forces."""
    model, units, assembly = result.model, result.model.report, result.assembly
    size = f"{len(model.free_bodies):,} bodies, {len(assembly.pairs):,} contact pairs"
    factors = ", ".join(f"{g} = {number(load_factor(result.factors, g))}" for g in assembly.groups) or "none"
    lines = [
        f"Result: {result.status.name}. {result.sentence}",
        f"  {model.title or 'model without a title'}: {size}",
        f"  by {result.solved_by}, worst error of the certificate {result.certificate.worst:.1e}",
        f"  load factors {factors}; loads {units.force_vector(result.total_load)}",
    ]
    if result.solved:
        settlement = units.text("motion", result.max_settlement)
        lines.append(f"  pairs {result.contacts.counted}; largest settlement {settlement}")
        reactions = list(result.reactions.items())
        largest = max((float(np.linalg.norm(force)) for _, force in reactions), default=0.0)
        for name, force in reactions[:MOST_REACTIONS]:
            lines.append(f"  reaction of {name}: {units.force_vector(force, size=largest)}")
        if len(reactions) > MOST_REACTIONS:
            lines.append(f"  ... and {len(reactions) - MOST_REACTIONS} more reactions")
    elif result.mechanism is not None:
        lines.append("  its motion: result.mechanism_velocity, result.plot.mechanism()")
    return lines


@dataclass(frozen=True)
class Check:
    """One line of the certificate: what was checked, its residual, and whether it holds."""

    what: str
    value: float
    holds: bool


def checks(result: Result) -> list[Check]:
    """Return the certificate line by line: relative residuals, 0 is perfect."""
    c = result.certificate
    lines = (
        ("Forces are in equilibrium on every block (relative to the total load)", c.equilibrium),
        ("No two blocks overlap (relative to the largest displacement)", c.penetration),
        ("Friction and strength are nowhere exceeded (relative to the total load)", c.cone),
        ("Sliding joints are resisted by full friction (relative)", c.slip_direction),
        ("Open joints carry no force (relative)", c.complementarity),
    )
    return [Check(what, value, value <= CERTIFIED) for what, value in lines]


def proof(result: Result) -> str:
    """Return what proves the outcome, in one sentence."""
    worst = result.certificate.worst
    if result.solved:
        return f"Certified: the largest error in any equation is {worst:.1e} (relative; {CERTIFIED:.0e} is allowed)."
    if result.mechanism is not None and result.status is Status.COLLAPSES:
        m = result.mechanism
        return (
            f"Proven: along this motion {power_words(m.power, result.model.report)}, more than friction dissipates; "
            "motion, "
            f"forces and masses satisfy every equation to {m.violation:.1e} (relative)."
        )
    if result.mechanism is not None:
        m = result.mechanism
        return (
            f"Proven: {power_words(m.power, result.model.report)}, less what the joints absorb; the motion violates "
            "the "
            f"joints by no more than {m.violation:.1e} (relative)."
        )
    if result.status is Status.NO_COULOMB_STATE:
        of = regularised(result)
        return (
            f"Excluded: no combination of joint states satisfies the equations{of and ' ' + of}; every exclusion was "
            "recomputed."
        )
    return "Not certified: there is no answer whose equations hold."


def power_words(power: float, units: Units) -> str:
    """Return the work of the loads along a mechanism, scaled to a largest velocity of 1: a force [kN] in words."""
    return f"the loads do {units.text('moment', power, 4)} of work per metre of the largest displacement"
