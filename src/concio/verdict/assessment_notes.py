"""What asks for attention in the site of an assessment, and in decisions of its author that are not the code's."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from concio.display import number
from concio.verdict.assessment_words import WORDS

if TYPE_CHECKING:
    from concio.analysis.seismic.assessment import Assessment

STRONG = 0.5
"""Acceleration on rock beyond that of any site in Italy [g]."""

ROUNDED = 0.01
"""Share by which a return period may be rounded: 475 years stand for 474.6."""

TALLEST = 100.0
"""Height of a building of masonry beyond which its unit is in doubt [m]."""

NEAR = 1e-9
"""Relative difference below which two shares of the mass are one."""


def assessment_notes(
    found: Assessment, language: str = "en", write: Callable[[float, int], str] = number
) -> tuple[str, ...]:
    """Return what asks for attention, in a language.

    Parameters
    ----------
    found : Assessment
    language : {"en", "it"}
    write : callable, optional
        Writes a number with some digits.
    """
    words, rules, asked = WORDS[language], found.site.rules, found.arguments

    def say(key: str, **values: float | str) -> str:
        return words[key].format(**{k: write(v, 4) if isinstance(v, float) else v for k, v in values.items()})

    lines = [say("note_strong", a_g=found.site.at(level).a_g, level=level) for level in found.levels
             if found.site.at(level).a_g > STRONG]  # fmt: skip
    for level in found.levels:
        given, period = found.site.at(level).T_R, found.site.period(level)
        if abs(given - period) > ROUNDED * period:
            lines.append(say("note_period", level=level, given=given, own=period))
    idle = {level: ", ".join(found.site.idle(level)) for level in found.levels}
    lines += [say("note_idle", what=what, level=level, code=rules.name) for level, what in idle.items() if what]
    of_level = float(rules.tables["knowledge"][found.knowledge])
    if found.confidence_by == "given" and found.confidence < of_level:
        lines.append(say("note_confidence", given=found.confidence, level=found.knowledge, own=of_level))
    own = min((float(rules.tables["levels"][level].get("q", math.inf)) for level in found.levels), default=math.inf)
    q, share = asked.get("q"), asked.get("participation")
    if q is not None and q > own:
        lines.append(say("note_q", given=float(q), own=own))
    largest = max((m.chain.e_star for m in found.mechanisms), default=0.0)
    if share is not None and share < largest * (1 - NEAR):
        lines.append(say("note_participation", given=float(share), own=largest))
    return (*lines, *(say(key, **values) for key, values in _buildings(found)))


def _buildings(found: Assessment) -> list[tuple[str, dict[str, float]]]:
    """Return what is implausible about the height of a regular building, with the numbers of each sentence."""
    told: list[tuple[str, dict[str, float]]] = []
    highest = max((float(m.level) for m in (*found.mechanisms, *found.others)), default=-math.inf)
    for one in found.site.building:
        height = float(getattr(one, "height", 0.0))
        top = height + float(getattr(one, "base", 0.0))
        told += [("building_tall", {"height": height})] if height > TALLEST else []
        told += [("building_low", {"top": top, "z": highest})] if height and highest > top * (1 + NEAR) else []
    return told
