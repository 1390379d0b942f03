"""The page on verdicts has a row for every command and every function whose answer has a verdict."""

from __future__ import annotations

import re
from pathlib import Path

import typer.main

import concio
from concio.cli.main import app
from concio.verdict.unanswered import ASKED

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "verdicts.md"


def rows() -> list[list[str]]:
    """Return the cells of the table of kinds."""
    text = PAGE.read_text(encoding="utf-8").partition("<!-- kinds:")[2].partition("<!-- end of kinds -->")[0]
    lines = [line for line in text.splitlines() if line.startswith("| `")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_every_command_and_function_has_its_row() -> None:
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    asking = {name for name, c in commands.items() if any("--json" in p.opts for p in c.params)} - {"check"}
    named = " ".join(row[0] for row in rows())
    assert set(re.findall(r"`concio (\w+)`", named)) == asking
    functions = set(re.findall(r"`(\w+)`", named))
    assert functions <= set(dir(concio)) | {"compare"}
    assert set(ASKED) - {"prove", "limit_stages"} <= functions


def test_every_row_says_what_it_claims_by_which_equations_and_what_not() -> None:
    for row in rows():
        assert len(row) == 4, row[0]
        assert all(row)
