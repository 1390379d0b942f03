"""No text of the project holds an expression that the style page refuses: pages, messages, help, docstrings."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
STYLE = ROOT / "docs" / "contributing" / "style.md"
ROW = re.compile(r"^\| `(.+)` \| (.+) \|$", re.MULTILINE)
LINK = re.compile(r"``[^`]*``|\]\([^)]*\)|`[^`\n]*`|\b\d{4}-[a-z0-9-]+|research/[a-z0-9-]+")
CODE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
NOTES = ("docs/decisions/", "docs/research/", "docs/_build/")
"""Dated records of what was decided and measured: outside the menu and the search of the documentation."""


@cache
def refused() -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return the expressions of the style page, each with what to write instead."""
    return tuple((pattern, instead) for _, pattern, instead in scanned())


@cache
def scanned() -> tuple[tuple[re.Pattern[str], re.Pattern[str], str], ...]:
    """Return expressions with a faster form of each, which is met in small letters wherever the expression is."""
    rows = ROW.findall(STYLE.read_text(encoding="utf-8").split("## Words that are refused")[1])
    forms = [(form.replace(r"\|", "|").replace(" ", r"\s+"), instead) for form, instead in rows]
    assert all(not re.search("[A-Z]", form) for form, _ in forms)
    whole = [re.compile(rf"(?<![\w-])(?:{form})(?![\w-])", re.IGNORECASE) for form, _ in forms]
    return tuple((re.compile(form), exact, instead) for (form, instead), exact in zip(forms, whole, strict=True))


def blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", "\0", match.group())


def in_python(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of every string of a program that is a docstring or holds more than a word."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value.strip():
            yield node.lineno, LINK.sub(blank, node.value)


def in_page(text: str) -> Iterator[tuple[int, str]]:
    yield 1, LINK.sub(blank, CODE.sub(blank, text))


def findings(path: Path, text: str) -> Iterator[str]:
    """Yield file, line, expression and what to write instead, of each expression that is refused."""
    pieces = list((in_python if path.suffix == ".py" else in_page)(text))
    small = "\0".join(piece for _, piece in pieces).lower()
    met = [(pattern, instead) for form, pattern, instead in scanned() if form.search(small)]
    for first, piece in pieces:
        for pattern, instead in met:
            for match in pattern.finditer(piece):
                line = first + piece.count("\n", 0, match.start())
                said = " ".join(match.group().split())
                yield f"{path.as_posix()}:{line}: '{said}': write {instead}"


def texts() -> list[Path]:
    first = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md")
    pages = [*(ROOT / name for name in first), *(ROOT / "docs").rglob("*.md")]
    named = [p for p in pages if p != STYLE and not p.relative_to(ROOT).as_posix().startswith(NOTES)]
    source = [p for form in ("*.py", "*.toml", "*.html") for p in (ROOT / "src" / "concio").rglob(form)]
    examples = [p for form in ("*.py", "*.toml") for p in (ROOT / "examples").rglob(form)]
    return sorted([*named, *source, *examples])


def rooms() -> dict[str, list[Path]]:
    found: dict[str, list[Path]] = {}
    for path in texts():
        parts = path.relative_to(ROOT).parts
        found.setdefault("/".join(parts[: 3 if parts[0] == "src" else 1]), []).append(path)
    return found


@pytest.mark.parametrize("room", sorted(rooms()))
def test_no_text_holds_an_expression_that_is_refused(room: str) -> None:
    found = [line for path in rooms()[room] for line in findings(path.relative_to(ROOT), path.read_text("utf-8"))]
    assert not found, "\n".join(["", *found])


def test_the_scan_names_file_line_and_what_to_write() -> None:
    page = "Limit states are\nreported.\n\nOthers are told as\nnot checked. `told` and [one](told.md) are names.\n"
    assert list(findings(Path("a.md"), page)) == ["a.md:4: 'told': write reported, stated, given"]
    code = 'told = 1\n\n\ndef f():\n    """Return a motion.\n\n    It goes on without\n    end.\n    """\n'
    assert list(findings(Path("a.py"), code)) == ["a.py:7: 'without end': write unbounded, without bound"]
    help_text = 'OPTION = "Share of a velocity that comes back from an impact."\nKEY = "lent"\n'
    assert list(findings(Path("b.py"), help_text)) == [
        "b.py:1: 'comes back from an impact': write coefficient of restitution"
    ]


def test_there_are_thirty_pairs_and_every_before_differs_from_its_after() -> None:
    pairs = STYLE.read_text(encoding="utf-8").split("## Before and after")[1].split("## ")[0]
    rows = [line.strip("|").split("|") for line in pairs.splitlines() if line.startswith("| ")][1:]
    assert len(rows) >= 30
    assert all(len(row) == 2 and row[0].strip() != row[1].strip() for row in rows)


def test_what_is_to_be_written_is_not_refused_itself() -> None:
    for pattern, instead in refused():
        assert not any(other.search(instead) for other, _ in refused()), (pattern.pattern, instead)
