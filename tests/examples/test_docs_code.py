"""Every block of Python and every command in the documentation runs, page by page, in an empty directory."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import matplotlib as mpl
import pytest
from typer.testing import CliRunner

from concio.cli.main import app

DOCS = Path(__file__).resolve().parents[2] / "docs"
SKIPPED = {"decisions", "research", "validation", "_build"}
"""Records and generated pages, which hold no code of their own."""

DOWNLOAD = re.compile(r"\{download\}`[^`<]*<([^>]+)>`")
"""A file that a page offers, which lies in the directory of the reader then."""

FENCE = re.compile(r"^```(python|console)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def pages() -> list[Path]:
    found = [p for p in sorted(DOCS.rglob("*.md")) if not SKIPPED & set(p.relative_to(DOCS).parts)]
    return [p for p in found if FENCE.search(p.read_text(encoding="utf-8"))]


LONG = {
    "start.md", "methods.md", "howto/space.md", "howto/assessment.md", "howto/cells.md", "howto/studies.md",
    "howto/no_equilibrium.md", "howto/facade_tutorial.md",
}  # fmt: skip
"""Pages of more than a second, whose commands and functions have quick tests of their own."""


def named(page: Path) -> object:
    """Return a page as a case of a test."""
    name = page.relative_to(DOCS).as_posix()
    return pytest.param(page, id=name, marks=[pytest.mark.long] * (name in LONG))


@pytest.mark.parametrize("page", list(map(named, pages())))
def test_page(page, tmp_path, monkeypatch):
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    text = page.read_text(encoding="utf-8")
    for offered in DOWNLOAD.findall(text):
        shutil.copy(page.parent / offered, tmp_path)
    names: dict[str, object] = {"__name__": "docs"}
    for match in FENCE.finditer(text):
        kind, code = match.groups()
        line = text[: match.start()].count("\n") + 1
        if kind == "python":
            exec(compile("\n" * line + code, str(page), "exec"), names)
            continue
        for command in re.findall(r"^\$ concio (.*)$", code, re.MULTILINE):
            result = CliRunner().invoke(app, shlex.split(command))
            assert result.exit_code == 0, f"concio {command}: {result.output}"


def test_there_are_pages():
    assert len(pages()) >= 10
