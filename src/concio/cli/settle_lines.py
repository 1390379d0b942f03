"""What ``concio settle`` prints and writes: the path of loads and movement, and the reactions along it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from concio.cli.path_lines import path_facts, path_lines, write_path
from concio.io.csv_table import write_csv
from concio.post.path_curve import most_moving
from concio.report.settlement_part import end_words, reaction_rows, settlement_html

if TYPE_CHECKING:
    from concio.analysis.settlement import SettlementResult


def settle_lines(found: SettlementResult, *, every: bool) -> list[str]:
    """Return a settlement as lines of text: what moves, its path, and the reactions before it and at its end."""
    title, *rest = path_lines(found.path, most_moving(found.path), every=every)
    return [title, *rest, *(f"  movement     {line}" for line in found.movement), *_reactions(found)]


def _reactions(found: SettlementResult) -> Iterator[str]:
    yield f"  reactions    before the movement | {end_words(found)}"
    for name, first, last in reaction_rows(found):
        yield f"  {name:<12} ({first}) | ({last})"


def settle_facts(found: SettlementResult) -> dict[str, Any]:
    """Return a settlement as plain types: its path, the movement, and the reactions [kN] at each share of it."""
    return {
        **path_facts(found.path, most_moving(found.path)),
        "movement": {"group": found.group, "amount": found.amount, "reached": float(found.share[-1]),
                     "supports": list(found.movement)},
        "share": found.share.tolist(),
        "reactions": {name: force.tolist() for name, force in found.reactions.items()},
    }  # fmt: skip


def write_settlement(found: SettlementResult, place: Path, language: Literal["en", "it"]) -> list[str]:
    """Write what a path writes, the summary with the movement, and the reactions at each share of it."""
    write_path(found.path, most_moving(found.path), place, language, first=settlement_html(found))
    text = json.dumps(settle_facts(found), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    write_csv(found.table(), place / "reactions.csv")
    return ["summary.json", "reactions.csv", "path.csv", "events.csv", "path.png", "path.svg", "report.html", "end/"]
