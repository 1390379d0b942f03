"""What pages of the documentation say of the program in passing is what the program has."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import typer

from concio.cli.main import app
from concio.contact.patch_points import CRUSHING

DOCS = Path(__file__).parents[3] / "docs"


@pytest.mark.parametrize("page", ["howto/space.md", "howto/assessment.md", "howto/limits.md"])
def test_contact_points_of_joints_that_crush_in_space(page):
    text = (DOCS / page).read_text(encoding="utf-8")
    told = re.findall(r"crush(?:es at its contact points,)? (\d+) x \d+|In space it has (\d+) x", text)
    assert [int(a or b) for a, b in told] == [CRUSHING]


def test_commands_that_take_an_engine():
    text = (DOCS / "engine.md").read_text(encoding="utf-8")
    told = re.search(r"`--engine pardiso` with ([^)]*)\)", text)
    commands = typer.main.get_command(app).commands
    takes = {name for name, command in commands.items() if any("--engine" in p.opts for p in command.params)}
    assert set(re.findall(r"`(\w+)`", told.group(1))) == takes
