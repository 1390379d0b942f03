"""What a search covered, and what the author decided: two tables of the assessment report."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Any

from concio.analysis.seismic.sections import OutOfPlane

if TYPE_CHECKING:
    from collections.abc import Mapping

    from concio.analysis.seismic.assessment import Assessment
    from concio.report.assessment_texts import Texts


def coverage_html(t: Texts, found: Assessment) -> str:
    """Return the table of what was searched, and of what was met there."""
    rows = []
    for c in found.covered:
        motions = ", ".join(t.words[f"moves_{m}"] for m in c.motions)
        least = t.n(c.multiplier, 5) if math.isfinite(c.multiplier) else "–"
        places = f"{c.sought} / {c.there}"
        rows.append([t.say(f"covers_{c.kind}"), escape(motions) or "–", places, str(c.searches), least])
    ways = ", ".join(t.way(way) for way in found.bounds)
    head = [t.words[k] for k in ("cover_where", "cover_motions", "cover_places", "cover_searches", "cover_least")]
    title = f"<h3>{t.say('cover_title', ways=ways)}</h3>"
    gaps = "; ".join(t.told.unchecked) if hasattr(t, "told") else ""
    note = t.say("cover_gaps", gaps=gaps) if gaps else t.say("cover_no_gaps")
    once = f" {t.say('cover_once')}" if any(c.searches < c.sought for c in found.covered) else ""
    return f"{title}{t.table(head, rows, 2)}<p>{note}{once}</p>"


def decisions_html(t: Texts, found: Assessment, reasons: Mapping[str, str]) -> str:
    """Return the table of what the author decided, with what the code has and the reasons that were given."""
    rows = [[t.say(f"decide_{key}"), escape(value), escape(default), escape(reasons.get(key, "")) or "–"]
            for key, value, default in _decisions(t, found)]  # fmt: skip
    head = [t.words[k] for k in ("decide", "decided", "decide_default", "decide_reason")]
    return f"<div class=half><h3>{t.say('decisions')}</h3>{t.table(head, rows, 4)}</div>"


def _decisions(t: Texts, found: Assessment) -> list[tuple[str, str, str]]:
    """Return for each decision its key, what was decided, and what it is without one."""
    w, asked, rules = t.words, found.arguments, found.site.rules
    every = ", ".join(found.site.asked_by_code)
    factors = {k: float(v) for k, v in rules.tables["knowledge"].items() if k != "clause"}
    q = sorted({float(rules.tables["levels"][v]["q"]) for v in found.levels if "q" in rules.tables["levels"][v]})
    crushing = found.confidence_by == "crushing" or not all(
        found.model.laws[rule.law].compressive_strength is not None for rule in found.model.rules)  # fmt: skip
    rows: list[tuple[str, str, str]] = [
        ("levels", ", ".join(found.levels), every),
        ("direction", ", ".join(t.way(v) for v in found.bounds),
         w["all_ways" if asked.get("direction") else "by_default"]),
        ("knowledge", found.knowledge, "LC1"),
        ("confidence", t.n(found.confidence), t.n(max(factors.values()) if crushing else factors[found.knowledge])),
        ("accept_linear", w["decide_linear" if asked.get("accept_linear") else "decide_both"], w["decide_both"]),
        ("curve", w[f"curve_{found.curve}"], w["curve_followed"]),
        ("participation", _share(t, asked.get("participation")), w["decide_e_star"]),
    ]
    if q:
        own, given = "; ".join(t.n(v) for v in q), asked.get("q")
        rows.append(("q", own if given is None else t.n(given), f"{own} ({rules.name})"))
    rows += [("ties", f"{tie.name}: {w['unlimited'] if tie.yield_force is None else t.n(tie.strength) + ' kN'}", "–")
             for tie in found.model.ties]  # fmt: skip
    limits: Mapping[str, Any] = asked.get("limits") or {}
    rows += [("limits", f"{level}: {t.n(float(d))} m", "–") for level, d in limits.items()]
    if asked.get("control") is not None:
        body, at = asked["control"]
        rows.append(("control", f"{body} {t.pair(at)}", w["decide_fastest"]))
    for name, element in (asked.get("free_standing") or {}).items():
        kind = element["kind"] if isinstance(element, dict) else element.kind
        rows.append(("free_standing", f"{t.named(name)}: {w.get('kind_' + kind, kind)}", "–"))
    if found.strips:
        rows.append(("out_of_plane", _held(t, asked.get("out_of_plane")), w["held_nowhere"]))
    rows += [("elsewhere", w.get(f"elsewhere_{item.replace(' ', '_')}", item), "–")
             for item in asked.get("elsewhere", ())]  # fmt: skip
    return rows


def _share(t: Texts, given: float | None) -> str:
    """Return what share of the mass takes part, as the author decided."""
    return t.words["decide_e_star"] if given is None else t.words["decide_share"].format(share=t.n(given))


def _held(t: Texts, given: OutOfPlane | Mapping[str, Any] | None) -> str:
    """Return how a facade is held out of its plane, as the author decided."""
    held = given if isinstance(given, OutOfPlane) else OutOfPlane(**(given or {}))
    heights = "; ".join(t.n(z) for z in held.held)
    told = [t.words["held_at"].format(heights=heights) if heights else t.words["held_nowhere"]]
    if held.flush != "middle":
        told.append(t.words[f"flush_{held.flush}"])
    if held.bearing is not None:
        told.append(t.words["held_bearing"].format(bearing=t.n(held.bearing)))
    return "; ".join(told)
