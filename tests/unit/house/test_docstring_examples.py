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
    "Assembly", "Assessment", "BlockHalving", "Bracket", "BridgeResult", "Cause", "CellPath", "Change", "Check",
    "ContinuumComparison", "Coulomb", "Diagnosis", "DynamicsResult", "EnergyBalance", "Future", "LocalMechanism",
    "Mexe", "Moduli", "MotionState", "NoMechanism", "PathResult", "PeriodicCell", "Place", "PushResult",
    "Reliability", "Result", "RockingResult", "ServiceState", "Standing", "StateSensitivity", "StrengthDomain",
    "StudyResult", "TieForce", "Unseen", "Verdict",
}  # fmt: skip
"""Public classes that functions return: the examples of these functions show them."""
SPACES = [concio, *(getattr(concio, space) for space in concio._NAMESPACES)]
PUBLIC = {f"{place.__name__}.{name}": getattr(place, name) for place in SPACES for name in place.__all__}
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
    made = PUBLIC[name]
    if inspect.isclass(made):
        return made.__name__ not in RETURNED and not issubclass(made, Exception | Enum | dict)
    return callable(made)


@pytest.mark.parametrize("name", [name for name in PUBLIC if needs_example(name)])
def test_what_users_call_has_an_example_that_prints(name: str) -> None:
    text = inspect.getdoc(PUBLIC[name]) or ""
    assert SECTIONS.findall(text)[-1:] == ["Examples"], "the section 'Examples' is the last one"
    shown = doctest.DocTestParser().get_examples(text.rsplit("Examples\n--------\n", 1)[1])
    assert any(one.want for one in shown), "an example that prints nothing shows nothing"
    called = re.compile(rf"\b{name.rsplit('.', 1)[1]}\(")
    assert any(called.search(one.source) for one in shown), "it does not call what it is of"


def test_what_is_said_to_be_returned_is_public() -> None:
    assert {made.__name__ for made in PUBLIC.values() if inspect.isclass(made)} >= RETURNED
