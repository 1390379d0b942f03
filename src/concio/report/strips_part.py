"""The strips of a facade out of its plane, in the assessment report: one table, the weakest first."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment
    from concio.report.assessment_texts import Texts


def strips_html(t: Texts, found: Assessment) -> str:
    """Return the table of strips; empty where the model has none."""
    if not found.strips:
        return ""
    rows = []
    for s in found.strips:
        name, m = escape(t.strip(s.strip.name)), s.worst
        if m is None:
            rows.append([name, "&ndash;", t.n(s.multiplier, 5), *["&ndash;"] * 3, t.say("strip_none")])
            continue
        motion = s.motion_of_worst
        how = t.words[f"moves_{motion}"] if motion else "&ndash;"
        said = t.say("strip_like", name=t.strip(s.like)) if s.like else t.outcome_of(m, found)
        rows.append([name, f"{escape(how)}, {escape(t.way(m.direction))}", t.n(m.multiplier, 5), t.n(m.level),
                     t.n(m.d0), t.n(m.zeta if m.decisive else math.nan), said])  # fmt: skip
    head = [t.words[k] for k in ("strip", "strip_motion", "alpha0", "strip_level", "d0", "zeta", "outcome")]
    table = f"<div class=strips>{t.table(head, rows, 2)}</div>"
    return f"<h3>{t.say('strips')}</h3><p>{t.say('strips_text')}</p>{table}{_ties_html(t, found)}"


def _ties_html(t: Texts, found: Assessment) -> str:
    """Return the least tie forces of strips; empty where none needs a tie."""
    rows = []
    for tie in found.strip_ties:
        name = escape(t.strip(tie.strip.name))
        if not math.isfinite(tie.force):
            rows.append([name, t.n(tie.before, 5), t.n(tie.target, 5), *["&ndash;"] * 3, t.say("strip_tie_none")])
            continue
        said = t.say("strip_tie_proved" if tie.holds else "strip_tie_slides", reached=t.n(tie.reached, 5))
        rows.append([name, t.n(tie.before, 5), t.n(tie.target, 5), t.n(tie.height), t.n(tie.force), t.n(tie.per_metre),
                     said])  # fmt: skip
    if not rows:
        return ""
    head = [t.words[k] for k in ("strip", "strip_tie_before", "strip_tie_target", "strip_tie_height", "strip_tie_force",
                                 "strip_tie_per_metre", "outcome")]  # fmt: skip
    return f"<p>{t.say('strip_tie_text')}</p><div class=strips>{t.table(head, rows, 1)}</div>"
