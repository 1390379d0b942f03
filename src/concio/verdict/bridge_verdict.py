"""The verdict of a bridge: whether a vehicle is carried wherever it stands, and what the answer rests on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from concio.display import number
from concio.model.crossing import Vehicle
from concio.model.road.earth import ground_of
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.verdict.attention import attention, joints_not_made
from concio.verdict.bridge_words import Language, Words
from concio.verdict.crushing import crushing
from concio.verdict.question import Question, question_of
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.bridges.bridge_result import BridgeResult, Coulomb
    from concio.analysis.bridges.sweep import Standing

ASKED = "the load factor of a vehicle at every position on a bridge"
DEAD_NOT_STANDING = "the bridge does not stand without the vehicle: a mechanism proves it"
"""What the exception says where no forces balance the loads that are not the vehicle's."""


def bridge_verdict(found: BridgeResult, language: Language = "en") -> Verdict:
    """Return the verdict of a vehicle on a bridge.

    Parameters
    ----------
    found : BridgeResult
    language : {"en", "it"}
        Of its sentences; what every command says of a model is English.
    """
    outcome, w = _outcome(found), Words(language, found.model.report)
    head = {Outcome.HOLDS: "head_holds", Outcome.FAILS: "head_fails"}.get(outcome, "head_open")
    return Verdict(
        outcome=outcome,
        status={Outcome.HOLDS: "solved", Outcome.FAILS: "no_equilibrium"}.get(outcome, outcome.value),
        question=bridge_question(found, language),
        headline=w.say(head),
        answer=_answer(found, outcome, w),
        proof=_proof(found, w),
        meaning=w.say("meaning"),
        limits=_limits(found, w),
        unchecked=_unchecked(found, w),
        attention=(*_rests(found, outcome, w), *attention(found.assembly)),
        language=language,
    )


def bridge_question(found: BridgeResult, language: Language = "en") -> Question:
    """Return what was asked, with what acts."""
    w, vehicle = Words(language, found.model.report), found.vehicle
    asked = w.say("asked", required=w.n(found.required), vehicle=vehicle.name, loads=_loads(vehicle, w))
    reached = found.design if math.isfinite(found.design) else math.nan
    return question_of(asked, found.assembly, multiplied={vehicle.group: reached},
                       wanted={vehicle.group: found.required})  # fmt: skip


def _loads(vehicle: Vehicle, w: Words) -> str:
    """Return the loads of a vehicle in words: its axles, and what is spread along the road."""
    times = vehicle.dynamic * vehicle.factor
    uniform = w.unit("line load", times * max(vehicle.uniform, default=0.0))
    if vehicle.unfavourable:
        return _of_both(vehicle, uniform, w) + w.say("unfavourable")
    return _of_both(vehicle, uniform, w)


def _of_both(vehicle: Vehicle, uniform: str, w: Words) -> str:
    """Return axles and uniform load in words."""
    times = vehicle.dynamic * vehicle.factor
    if not vehicle.points:
        return w.say("loads_uniform", uniform=uniform)
    axle = w.unit("force", times * vehicle.heaviest.load)
    total = w.unit("force", times * sum(a.load for a in vehicle.points))
    return w.say("loads_both" if vehicle.uniform else "loads_axles", axle=axle, total=total, uniform=uniform)


def loaded_words(loaded: Sequence[tuple[float, float]], w: Words) -> str:
    """Return the parts of the road on which uniform load stands."""
    told = [w.say("part", low=w.unit("length", low), high=w.unit("length", high)) for low, high in loaded]
    return ", ".join(told) or w.say("no_part")


def heaviest_words(vehicle: Vehicle, multiplier: float, w: Words) -> tuple[str, str]:
    """Return the heaviest axle, or the largest uniform load, at a multiplier: in a sentence, and the number alone."""
    times = multiplier * vehicle.dynamic * vehicle.factor
    if vehicle.points:
        axle = w.unit("force", times * vehicle.heaviest.load, 4)
        return w.say("an_axle", axle=axle), axle
    uniform = w.unit("line load", times * max(vehicle.uniform), 4)
    return w.say("a_load", uniform=uniform), uniform


def bridge_lines(found: BridgeResult) -> list[str]:
    """Return what was found, as a command prints it."""
    units, verdict = found.model.report, found.verdict
    vehicle, worst = found.vehicle, found.worst
    lines = [found.model.title or "bridge without a title", verdict.sentence, *verdict.lines(units, most=8)]
    lines.append(f"  proof        {verdict.proof}")
    bare = replace(vehicle, dynamic=1.0, factor=1.0)
    if not math.isnan(found.design):
        axle, _ = heaviest_words(bare, found.design / found.required, Words("en", units))
        without = ", without dynamic and partial factors" if vehicle.dynamic * vehicle.factor != 1.0 else ""
        lines.append(f"  permissible  {axle} for the load factor {number(found.required, 4)}{without}")
    for b in found.brackets:
        s = b.standing
        lines.append(
            f"  bracket      x = {units.text('length', s.position, 4)}, to the {s.direction}: "
            f"{number(b.limit.design, 5)} carried, {number(s.multiplier, 5)} not exceeded"
        )
    told = ", ".join(f"{name} {number(v, 4)}" for name, v in found.parts.items())
    lines.append(f"  built up     bound at the worst position: {told}")
    for name, other in found.others.items():
        what = "does not stand" if other is None else (
            f"bound {number(other.multiplier, 4)} times, worst at x = {units.text('length', other.position, 4)}"
        )  # fmt: skip
        lines.append(f"  vehicle      {name}: {what}")
    for d, multiplier in found.apart.items():
        lines.append(f"  apart        {units.text('length', d, 4)}: bound {number(multiplier, 4)} times both vehicles")
    for c in found.changes:
        unit = "" if c.unit == "-" else f" {c.unit}"
        lines.append(
            f"  sensitivity  {c.name} {number(c.low, 4)} to {number(c.high, 4)}{unit}: "
            f"bound {number(c.at_low, 4)} to {number(c.at_high, 4)}"
        )
    lines.append(f"  working      {_service(found)}")
    if found.settled is not None:
        moved = ", ".join(f"{n} {units.text('motion', d, 4)}" for n, d in found.settlements.items())
        lines.append(f"  settled      by {moved}: {_service(found, settled=True)}")
    if found.mexe is not None:
        axle = "does not apply" if math.isnan(found.mexe.axle) else units.text("force", found.mexe.axle, 4) + " an axle"
        lines.append(f"  MEXE         {axle}, for comparison only: {'; '.join(found.mexe.limits)}")
    source = f"; {vehicle.source}" if vehicle.source else ""
    assumed = f"; assumed: {vehicle.assumed}" if vehicle.assumed else ""
    lines.append(f"  vehicle      {vehicle.name}, {len(found.standings)} positions{source}{assumed}")
    lines.append(f"  in short     {verdict.headline} Worst at x = {units.text('length', worst.position, 4)}")
    return lines


def _service(found: BridgeResult, *, settled: bool = False) -> str:
    """Return the working state in words."""
    state = found.settled if settled else found.service
    assert state is not None
    units = found.model.report
    if state.status is not Status.SOLVED:
        return str(state.status.value)
    told = [f"{state.open_joints} joints open, {state.slipping} slip"]
    if _crush(found):
        told.append(f"{state.crushed} contact points crush")
    told.append(
        "a joint compressed at its edge only" if math.isinf(state.largest_pressure)
        else f"pressure up to {units.text('stress', state.largest_pressure, 4)}"
    )  # fmt: skip
    told.append(
        "no deflection: blocks and joints are rigid" if math.isnan(state.deflection)
        else f"the vehicle adds {units.text('motion', state.deflection, 4)} of deflection"
    )  # fmt: skip
    return ", ".join(told)


def _outcome(found: BridgeResult) -> Outcome:
    if found.refuted or any(_refutes(found, s.limit.upper, checked=s.limit.checked) for s in found.standings):
        return Outcome.FAILS
    if not found.coulomb:
        return Outcome.INCOMPLETE
    if found.open or not found.worst.limit.checked:
        return Outcome.UNDECIDED
    return Outcome.HOLDS


def _crush(found: BridgeResult) -> bool:
    """Return whether any joint has a compressive strength."""
    joints = found.assembly.pairs.interface >= 0
    return bool(np.isfinite(found.assembly.laws.cap[joints]).any())


def _refutes(found: BridgeResult, upper: float, *, checked: bool) -> bool:
    return checked and upper < found.required * (1 - 1e-9)


def _answer(found: BridgeResult, outcome: Outcome, w: Words) -> str:
    """Return whether it is carried, the worst position, and what is left without the pressure of the soil."""
    worst, vehicle = found.worst, found.vehicle
    required = w.n(found.required, 4)
    every = len(found.standings)
    if outcome is Outcome.FAILS:
        low = _refutes(found, worst.limit.upper, checked=worst.limit.checked)
        at = worst if low else found.refuted[0]
        upper = w.n(worst.limit.upper, 5)
        told = [w.say("fails" if low else "fails_coulomb", required=required, upper=upper,
                    x=w.unit("length", at.position, 4), way=w.say(at.direction))]  # fmt: skip
    elif outcome is Outcome.HOLDS:
        told = [w.say("holds", required=required, count=len(found.coulomb))]
    elif found.coulomb:
        told = [w.say("open", required=required, count=len(found.open), all=len(found.coulomb))]
    else:
        told = [w.say("unasked", required=required, all=every)]
    known = {
        "x": w.unit("length", worst.position, 4), "way": w.say(worst.direction),
        "bound": w.n(worst.multiplier, 5), "bound_axle": heaviest_words(vehicle, worst.multiplier, w)[1],
    }  # fmt: skip
    at_worst = next((b.limit.design for b in found.brackets if _place(b.standing) == _place(worst)), math.nan)
    if math.isnan(at_worst):
        told.append(w.say("worst_unknown", **known))
    else:
        told.append(w.say("worst", design=w.n(at_worst, 5), axle=heaviest_words(vehicle, at_worst, w)[0], **known))
    if not math.isnan(found.design) and found.design != at_worst:
        told.append(_least(found, w))
    if found.without_soil is None:
        told.append(w.say("no_soil_none"))
    elif any(t.kind == "soil" for t in found.model.ties):
        less = found.without_soil
        told.append(w.say("no_soil", multiplier=w.n(less.multiplier, 5),
                        x=w.unit("length", less.position, 4)))  # fmt: skip
    return " ".join(told)


def _place(at: Standing | Coulomb) -> tuple[float, str]:
    """Return position, without rounding noise, and direction."""
    return round(at.position, 9), at.direction


def _least(found: BridgeResult, w: Words) -> str:
    """Return where Coulomb friction was shown to carry least, where that is not the position of the least bound."""
    b = next(b for b in found.brackets if b.limit.design == found.design)
    return w.say("less", design=w.n(found.design, 5), axle=heaviest_words(found.vehicle, found.design, w)[0],
                 x=w.unit("length", b.standing.position, 4), way=w.say(b.standing.direction))  # fmt: skip


def _rests(found: BridgeResult, outcome: Outcome, w: Words) -> tuple[str, ...]:
    """Return in a sentence that the answer would be another one without the pressure of the soil."""
    if outcome is Outcome.FAILS:
        return ()
    if found.without_soil is None:
        return (w.say("rests_none"),)
    less = found.without_soil.multiplier
    if less >= found.required:
        return ()
    return (w.say("rests", multiplier=w.n(less, 5), required=w.n(found.required, 4)),)


def _proof(found: BridgeResult, w: Words) -> str:
    limit = found.worst.limit
    violation = limit.mechanism.violation if limit.mechanism else math.nan
    certified = sum(c.status is Status.SOLVED for c in found.coulomb)
    return w.say("proof", residual=f"{limit.residual:.0e}", violation=f"{violation:.0e}",
               gap=f"{limit.gap:.0e}", count=certified)  # fmt: skip


def _limits(found: BridgeResult, w: Words) -> tuple[str, ...]:
    width, by = found.width
    x = sorted({round(s.position, 6) for s in found.standings if s.direction == found.worst.direction})
    apart = max(np.diff(x), default=0.0)
    told = [
        w.say("shares", soil=w.n(100 * max(found.owed_to_soil, 0.0), 3),
            spread=w.n(100 * max(found.owed_to_spread, 0.0), 3)),
        w.say("width", width=w.unit("length", width, 4), by=w.width(by)),
        w.say("grid", step=w.unit("length", float(apart), 3), fine=w.unit("length", found.fine, 3)),
        w.say("brackets", count=len(found.brackets)),
    ]  # fmt: skip
    worst = found.worst
    surface, road = ground_of(found.model)
    low, high = road.over(surface)
    times = found.vehicle.dynamic * found.vehicle.factor
    on_road = [load for x, _, load, stretch in found.vehicle.footprints(worst.position, worst.direction)
               if not stretch and low <= x <= high]  # fmt: skip
    beside = worst.elsewhere + times * sum(a.load for a in found.vehicle.points) - sum(on_road)
    if beside > 1e-6 * found.vehicle.total:
        told.append(w.say("elsewhere", load=w.unit("force", beside, 4)))
    if found.vehicle.unfavourable and worst.loaded is not None:
        told.append(w.say("loaded", parts=loaded_words(worst.loaded, w)))
    told.append(w.say("plane"))
    if found.model.fill is not None and found.model.fill.spandrels:
        told.append(w.say("spandrels"))
    if found.apart:
        distances = ", ".join(w.unit("length", d, 4) for d in found.apart)
        told.append(w.say("apart", count=len(found.apart), distances=distances))
    return (*told, w.say("several"), *joints_not_made(found.assembly.detection),
            *crushing(found.assembly))  # fmt: skip


def _unchecked(found: BridgeResult, w: Words) -> tuple[str, ...]:
    told = [] if found.coulomb else [w.say("unchecked_coulomb")]
    known = {_place(c) for c in found.coulomb}
    rest = sum(_place(s) not in known for s in found.standings)
    if found.coulomb and rest:
        told.append(w.say("unchecked_some", rest=rest, all=len(found.standings)))
    if not _crush(found):
        told.append(w.say("unchecked_crushing"))
    told.append(w.say("unchecked_long"))
    one_way = {s.direction for s in found.standings}
    vehicle = replace(found.vehicle, loaded=None)
    there, back = (sorted(vehicle.footprints(0.0, way)) for way in ("right", "left"))
    if len(one_way) == 1 and not np.allclose(there, back):
        told.append(w.say("unchecked_both"))
    if found.service.status is not Status.SOLVED and found.service.status not in PROVEN_FAILURES:
        told.append(w.say("unchecked_state", status=found.service.status.name.lower()))
    return tuple(told)
