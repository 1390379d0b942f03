"""The interactive report of a result in a cell of a notebook: turned, zoomed, played as in a browser."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from concio.report.page import report_html
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

HEIGHT = 640
"""Height of the frame [pixel]."""


@short_repr
@dataclass(frozen=True)
class InlinePage:
    """A page that a notebook shows in a frame; it needs neither a server nor the network.

    Parameters
    ----------
    html : str
        The whole page.
    height : int
        Of the frame [pixel].
    """

    html: str
    height: int = HEIGHT

    def _repr_html_(self) -> str:
        style = f"width:100%;height:{self.height}px;border:1px solid #D8D2C6"
        return f'<iframe srcdoc="{escape(self.html)}" style="{style}" title="concio report"></iframe>'


def inline_report(result: Result, height: int = HEIGHT) -> InlinePage:
    """Return the report of a result without its still figures, for a notebook."""
    return InlinePage(report_html(result, figures=False), height)
