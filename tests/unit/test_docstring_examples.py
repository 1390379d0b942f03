"""Examples in docstrings run and print what they say; every public function and every class that users make has one."""

from __future__ import annotations

import ast
import doctest
import inspect
import io
import re
from collections.abc import Iterator
from enum import Enum
from pathlib import Path

import pytest

import concio

ROOT = Path(concio.__file__).parent
RETURNED = {
    "Assembly", "Assessment", "BridgeResult", "Diagnosis", "DynamicsResult", "PathResult", "PushResult", "Result",
    "StudyResult", "Verdict",
}  # fmt: skip
"""Public classes that functions return: the examples of these functions show them."""
SECTIONS = re.compile(r"^(\w[\w ]*)\n-{3,}$", re.MULTILINE)


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


def needs_example(name: str) -> bool:
    made = getattr(concio, name)
    if inspect.isclass(made):
        return name not in RETURNED and not issubclass(made, Exception | Enum)
    return callable(made)


@pytest.mark.parametrize("name", [name for name in concio.__all__ if needs_example(name)])
def test_what_users_call_has_an_example_that_prints(name: str) -> None:
    text = inspect.getdoc(getattr(concio, name)) or ""
    assert SECTIONS.findall(text)[-1:] == ["Examples"], "the section 'Examples' is the last one"
    shown = doctest.DocTestParser().get_examples(text.rsplit("Examples\n--------\n", 1)[1])
    assert any(one.want for one in shown), "an example that prints nothing shows nothing"
    assert any(re.search(rf"\bconcio\.{name}\(", one.source) for one in shown), "it does not call what it is of"
