"""What a multiplier or a number of a state depends on, in reports: a sentence and a chart of bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from concio.plot.sensitivity_figure import sensitivity_figure

if TYPE_CHECKING:
    from concio.analysis.sensitivity import Sensitivity, SensitivityRow
    from concio.report.assessment_texts import Texts

Of = Literal["sens", "limit", "settlement", "force", "collapse"]

OF_STRIPS = {
    ("thickness", ""): "width", ("length", "x"): "through", ("length", "y"): "up", ("load", "loads"): "loads",
}  # fmt: skip
"""Words for numbers of the section of a strip: its x runs through the wall, its thickness along the facade."""

TOLD, SHOWS = 3, 5e-4
"""Numbers in the sentence at most, and the least change in per cent that is stated."""


def sensitivity_html(
    t: Texts, found: Sensitivity, *, strip: bool = False, of: Of = "sens", named: str = "", value: str = "",
    slides: bool = False,
) -> str:  # fmt: skip
    """Return the part of a report on what a number depends on; of a ``strip`` the plane thickness is its width.

    Parameters
    ----------
    t : Texts
    found : Sensitivity
    strip : bool
    of : {"sens", "limit", "settlement", "force", "collapse"}
        Whether it is alpha_0 of an assessment, the associated bound of a limit load, a number of a certified
        state, or the load factor at which a path collapses.
    named, value : str
        Block or joint of a number of a state, and the number with its unit.
    slides : bool
        Whether joints slide in the mechanism of an assessment, so that its derivatives are those of virtual work.
    """

    def name(row: SensitivityRow) -> str:
        own = OF_STRIPS.get((row.kind, row.of)) if strip else None
        kind = own or row.kind.replace(" ", "_")
        return t.words[f"par_{kind}"].format(of=row.of)

    told = []
    for row in found.rows[:TOLD]:
        less, more = row.per_percent
        change = more if math.isfinite(more) else -less
        if abs(change) > SHOWS:
            told.append(t.words["sens_part"].format(name=name(row), change=f"{'+' * (change > 0)}{t.n(change, 2)}"))
    sides = " " + t.say(f"{of}_sides") if any(row.one_sided for row in found.rows) else ""
    text = t.say("sens_sentence", parts="; ".join(told) or t.words["sens_none"])
    if found.without:
        text += " " + t.say("sens_without", parts="; ".join(map(name, found.without)))
    drawn = t.figure(sensitivity_figure(found, t.words[f"{of}_axis"], name), f"figure_{of}", "bars")
    told_of = t.say("sens_text_slides" if slides else f"{of}_text", of=named, value=value)
    return f"<div class=keep><p>{told_of}{sides}</p>{drawn}<p>{text}</p></div>"
