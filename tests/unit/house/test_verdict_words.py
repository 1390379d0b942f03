"""Words that claim an outcome stand in the room of verdicts and nowhere else."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import concio

ROOT = Path(concio.__file__).parent
CLAIM = re.compile(r"\b(solved|carried|carries|verified|proved|proven|proves|collapses|to its end|to the end)\b", re.I)
ROOMS = ("verdict/", "proof/", "solvers/")
"""The rooms of verdicts and of exact proofs; and solvers, whose traces say what was tried and stand under that head."""
KEPT = {
    ("problem/solution.py", "In equilibrium: the certificate proves it."): "an outcome, with its sentence",
    ("problem/solution.py", "No equilibrium is possible with the joints"): "the same",
    ("problem/solution.py", "Collapses with the joints that were made"): "the same",
    ("model/solids/ifc_geometry.py", "carried out"): "an operation of a drawing program",
    ("cli/limit_command.py", "Also bisect load and friction with solved load steps"): "help of an option",
    ("report/page.py", "solved by"): "heads the name of the method",
    ("plot/convergence.py", "o solved, x not"): "the legend of a figure of methods",
}
"""Texts with such a word that claim nothing of a structure, and why."""


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the string literals of a file that are not docstrings and no single words, which are keys."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        text = node.value if isinstance(node, ast.Constant) else None
        if isinstance(text, str) and id(node) not in bare and " " in text.strip():
            yield node.lineno, text


def claims(path: Path) -> list[tuple[int, str]]:
    return [(line, text) for line, text in texts(path) if CLAIM.search(text)]


def test_the_scan_sees_a_claim(tmp_path: Path) -> None:
    file = tmp_path / "new.py"
    file.write_text('"""The load is carried."""\nKEY = "solved"\nTEXT = "the load is carried to its end"\n')
    assert claims(file) == [(3, "the load is carried to its end")]


@pytest.mark.parametrize("path", [p for p in sorted(ROOT.rglob("*.py"))], ids=lambda p: str(p.relative_to(ROOT)))
def test_only_verdicts_claim(path: Path) -> None:
    place = str(path.relative_to(ROOT))
    if place.startswith(ROOMS):
        return
    kept = [text for file, text in KEPT if file == place]
    assert [f"{line}: {text}" for line, text in claims(path) if not any(k in text for k in kept)] == []


def test_what_is_kept_is_there() -> None:
    for file, words in KEPT:
        assert any(words in text for _, text in claims(ROOT / file)), f"{file}: '{words}' is gone: take it out of KEPT"
