"""What a strengthening does, in the assessment report: the amount that is needed, and before and after side by side."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

from concio.plot.assessment_figures import mechanism_figure

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.seismic.strengthening import Strengthened
    from concio.report.assessment_texts import Texts


def strengthening_html(t: Texts, found: Strengthened) -> str:
    """Return the section on a strengthening: sentence, before and after, picture of what is weakest then."""
    measure = found.measure
    what = t.words[f"measure_{measure.kind}"].format(of=", ".join(measure.of))
    facts = {"what": what, "unit": measure.unit, "wanted": t.n(found.wanted), "reached": t.n(found.reached)}
    if found.amount == 0:
        text = t.say("strengthen_none", **facts)
    elif math.isinf(found.amount):
        text = t.say("strengthen_never", largest=t.n(found.largest), **facts)
    else:
        text = t.say("strengthen_found", amount=t.n(found.amount, 5), below=t.n(found.fails_at, 5), **facts)
    if found.by_height:
        text += " " + t.say("strengthen_height", z=t.n(found.height))
    parts = [f"<p>{text}</p>", f"<p>{t.say('strengthen_how', n=str(len(found.trials)))}</p>"]
    if found.by_height:
        rows = [[t.n(z), t.n(force, 5) if math.isfinite(force) else t.say("strengthen_more")]
                for z, force in found.by_height.items()]  # fmt: skip
        parts.append(t.table([t.words["strengthen_at"], t.words["strengthen_force"]], rows, 0))
    if found.amount != 0:
        parts.append(before_after(t, found.before, found.after))
        if found.after.worst is not None and math.isfinite(found.amount):
            kind = "figure_after_3d" if found.after.model.dim == 3 else "figure_after"
            parts.append(t.figure(mechanism_figure(found.after.worst), kind, "half"))
    return f"<section id=strengthening><h2>{t.say('strengthen')}</h2>{''.join(parts)}</section>"


def before_after(t: Texts, before: Assessment | None, after: Assessment) -> str:
    """Return the table of the weakest mechanism and of zeta_E at every limit state, before and after."""
    rows = []
    for key, one in (("before", before), ("after", after)):
        if one is None:
            rows.append([t.say(key), t.say("does_not_stand"), *["&ndash;"] * (4 + len(after.levels))])
            continue
        seen = {o.level for m in one.mechanisms for o in m.outcomes} if one.mechanisms else set(after.levels)
        levels = [min((m.zeta_at(v) for m in one.mechanisms), default=math.inf) if v in seen else math.nan
                  for v in after.levels]  # fmt: skip
        worst = one.worst
        name, way = ("&ndash;", "&ndash;") if worst is None else (t.name(worst), t.way(worst.direction))
        numbers = [math.inf, math.nan] if worst is None else [worst.multiplier, worst.e_star]
        rows.append([t.say(key), escape(name), escape(way), t.n(numbers[0], 5), t.n(numbers[1]),
                     *(t.n(v) for v in levels), t.verdict(one.least, one.least >= 1.0)])  # fmt: skip
    head = ["", t.words["name"], t.words["direction"], t.words["alpha0"], t.words["e_star"],
            *(f"zeta_E, {v}" for v in after.levels), t.words["outcome"]]  # fmt: skip
    return t.table(head, rows, 3)
