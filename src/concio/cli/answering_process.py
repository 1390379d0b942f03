"""The process behind the window: it answers with the commands themselves, in the words that the terminal prints."""

from __future__ import annotations

import io
import json
import time
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from concio.cli.progress import LISTENER
from concio.verdict.italian import in_italian
from concio.window.worker import Handler, Tell, later, work

if TYPE_CHECKING:
    from concio.verdict.verdict import Verdict

MOST_NUMBERS = 60
LATER = {
    "picture": ("page_picture", "picture"), "drag": ("drag", "dragged"), "layers": ("opened_drawing", "layers"),
    "acts": ("acts", "acts"), "underlay": ("traced_picture", "underlay"), "trace": ("traced_picture", "traced"),
    "wire": ("traced_picture", "wired"),
}  # fmt: skip
"""Handlers by kind of request: module of the window and function. Each is loaded when first asked: a picture first."""


def ask(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Run a command; return exit code, the lines it printed, its message, and its verdict.

    Parameters
    ----------
    request : mapping
        ``argv``, the arguments of the command; ``out``, the directory it writes to; ``file`` and ``name``, the file
        that the command reads and what messages call it.
    tell : callable
        Receives progress, and lines that are known on the way.
    """
    from concio.cli.main import app

    begun, printed, said = time.monotonic(), io.StringIO(), io.StringIO()
    token = LISTENER.set(lambda word, what: tell(*(("early", _early(what)) if word == "verdict" else (word, what))))
    try:
        with redirect_stdout(printed), redirect_stderr(said):
            try:
                code = app(list(request["argv"]), standalone_mode=False) or 0
            except Exception as error:  # what is wrong with an option is told by the command line's own exceptions
                if not hasattr(error, "format_message"):
                    raise
                code = 2
                said.write(f"Error: {error.format_message()}\n")
    finally:
        LISTENER.reset(token)
    out = Path(request["out"])
    lines = [line for line in printed.getvalue().splitlines() if str(out) not in line]
    summary: dict[str, Any] = {}
    with suppress(OSError, ValueError):
        summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    message = _message(said.getvalue()).replace(request["file"], request["name"])
    return {
        "code": code, "lines": lines, "message": message, "verdict": summary.get("verdict"),
        "seconds": time.monotonic() - begun, "numbers": numbers(summary),
        "italian": _italian(out, summary.get("verdict")),
    }  # fmt: skip


def _early(verdict: Verdict) -> dict[str, Any]:
    """Return what an answer says before its report is written."""
    told = verdict.as_dict()
    return {"code": verdict.exit_code, "verdict": told, "italian": _said_in_italian(told)}


def _said_in_italian(verdict: Mapping[str, Any]) -> dict[str, Any]:
    said = {key: in_italian(verdict[key]) for key in ("headline", "sentence")}
    return {**said, "attention": [in_italian(line) for line in verdict["attention"]]}


def _italian(out: Path, verdict: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Return headline, sentence and attention in Italian, in pieces of text and language: as written, or as known."""
    with suppress(OSError, ValueError):
        written = json.loads((out / "verdict.it.json").read_text(encoding="utf-8"))
        said = {key: [[written[key], "it"]] for key in ("headline", "sentence")}
        return {**said, "attention": [in_italian(line) for line in written["attention"]]}
    return None if verdict is None else _said_in_italian(verdict)


def numbers(summary: Mapping[str, Any], at: str = "") -> dict[str, float]:
    """Return the single numbers of a summary by the names of ``--json``, those of tables in it with a point."""
    found: dict[str, float] = {}
    for key, value in summary.items():
        if isinstance(value, Mapping) and not at and key not in ("verdict", "seconds"):
            found |= numbers(value, f"{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            found[f"{at}{key}"] = float(value)
    return dict(list(found.items())[:MOST_NUMBERS])


def _message(text: str) -> str:
    """Return what a command wrote to standard error for a person: notes and its error, nothing of libraries."""
    notes, sign, error = text.partition("Error: ")
    told = [line for line in notes.splitlines() if line.startswith("Note: ")]
    return "\n".join([*told, *([sign + error.strip()] if sign else [])])


def warm(_: Mapping[str, Any], __: Tell) -> bool:
    """Load what every question needs, before one is asked."""
    import concio

    concio.solve(concio.column(width=0.5, height=1.0, blocks=2, block="rigid", unit_weight=20.0))
    return True


def main() -> None:
    """Answer requests of a window until it closes."""
    there: dict[str, Handler] = {"ask": ask, "warm": warm}
    work(there | {kind: later(f"concio.window.{room}", name) for kind, (room, name) in LATER.items()})


if __name__ == "__main__":
    main()
