"""The part of a report on a settlement: what moves, and the reactions before the movement and at its end."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from concio.display import number

if TYPE_CHECKING:
    from concio.analysis.settlement import SettlementResult


def settlement_html(found: SettlementResult) -> str:
    """Return the movement and the reactions before and after it, in English; names are marked as kept."""
    moved = "".join(f"<p>{escape(line[0].upper() + line[1:])}.</p>" for line in found.movement)
    head = "".join(f"<th>{escape(word)}</th>" for word in ("support", "before the movement", end_words(found)))
    cells = "".join(
        f"<tr><td translate=no>{escape(name)}</td><td>{escape(first)}</td><td>{escape(last)}</td></tr>"
        for name, first, last in reaction_rows(found)
    )
    table = f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{cells}</tbody></table></div>"
    return f"<h2>Movement and reactions</h2>{moved}{table}<p class=note>Forces on the structure.</p>"


def end_words(found: SettlementResult) -> str:
    """Return where the last reactions belong to, such as ``"at its end"`` or ``"at 35 % of it"``."""
    share = float(found.share[-1])
    return "at its end" if found.reached else f"at {number(100 * share, 4)} % of it"


def reaction_rows(found: SettlementResult) -> list[tuple[str, str, str]]:
    """Return the name of each support that carries something, and its forces before the movement and at its end."""
    units = found.path.assembly.model.report
    rows = []
    for name, force in found.reactions.items():
        size = float(np.abs(force).max(initial=0.0))
        if size:
            first, last = (units.force_vector(force[k], size=size) for k in (0, -1))
            rows.append((name, first, last))
    return rows
