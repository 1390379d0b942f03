"""Examples in docstrings run and print what they say."""

from __future__ import annotations

import ast
import doctest
import io
from collections.abc import Iterator
from pathlib import Path

import pytest

import concio

ROOT = Path(concio.__file__).parent


def docstrings(node: ast.AST, name: str) -> Iterator[tuple[str, int, str]]:
    """Return name, line and text of the docstrings of a module, its classes and its functions."""
    if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
        text = ast.get_docstring(node)
        if text:
            yield name, node.body[0].lineno, text
        for child in node.body:
            yield from docstrings(child, f"{name}.{getattr(child, 'name', '')}")


def examples() -> Iterator[object]:
    for path in sorted(ROOT.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        if ">>> " in source:
            own = path.relative_to(ROOT).with_suffix("").as_posix()
            for name, line, text in docstrings(ast.parse(source), own):
                if ">>> " in text:
                    yield pytest.param(text, str(path), line, id=name)


@pytest.mark.parametrize(("text", "path", "line"), list(examples()))
def test_an_example_prints_what_it_says(text: str, path: str, line: int) -> None:
    """It starts with nothing defined, as a reader who copies it does."""
    found = doctest.DocTestParser().get_doctest(text, {}, "example", path, line)
    told = io.StringIO()
    result = doctest.DocTestRunner(verbose=False).run(found, out=told.write)
    assert result.attempted > 0
    assert not result.failed, told.getvalue()
