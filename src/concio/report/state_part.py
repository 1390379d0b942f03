"""What a certified state depends on, for the report of a load step: the number read first, a chart, a sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from concio.analysis.state_numbers import leading_number
from concio.analysis.state_sensitivity import state_sensitivity
from concio.errors import ConcioError
from concio.report.assessment_texts import Texts
from concio.report.sensitivity_part import sensitivity_html

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.report.italian_page import Language

MOST_PAIRS = 1000
"""Models with more contact pairs get no derivatives in their report; the result gives them when asked."""


def state_depends_html(result: Result, language: Language = "en") -> str:
    """Return what the leading number of a state depends on; nothing where it has no derivatives or is large.

    Parameters
    ----------
    result : Result
    language : {"en", "it"}
    """
    if not result.solved or len(result.assembly.pairs) > MOST_PAIRS:
        return ""
    try:
        found = leading_number(result, state_sensitivity(result))
    except ConcioError:  # nothing determines how it changes: the other parts stand
        return ""
    if found is None:
        return ""
    t = Texts(language)
    factor, symbol = result.model.report.factor("motion" if found.kind == "settlement" else "force", found.value)
    value = f"{t.n(factor * found.value)} {symbol}"
    told = sensitivity_html(t, found.sensitivity, of=found.kind, named=found.of, value=value)
    return f"<h2>What this state depends on</h2><section translate=no>{told}</section>"
