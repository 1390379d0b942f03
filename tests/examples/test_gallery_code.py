"""The gallery shows the code of its examples as one would type it, and as it is now."""

from __future__ import annotations

import ast
import builtins
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))
GALLERY = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")


def names_without_a_value(code: str) -> set[str]:
    """Return the names that a script reads and nowhere gives a value."""
    nodes = list(ast.walk(ast.parse(code)))
    names = [node for node in nodes if isinstance(node, ast.Name)]
    given = {n.id for n in names if isinstance(n.ctx, ast.Store)} | {n.arg for n in nodes if isinstance(n, ast.arg)}
    given |= {n.name for n in nodes if isinstance(n, ast.FunctionDef)}
    given |= {(a.asname or a.name).partition(".")[0] for n in nodes
              if isinstance(n, ast.Import | ast.ImportFrom) for a in n.names}  # fmt: skip
    return {n.id for n in names} - given - set(dir(builtins))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_the_code_shown_is_that_of_the_example(path: Path) -> None:
    code = runpy.run_path(str(ROOT / "docs" / "make_gallery.py"))["as_typed"](path)
    compile(code, path.name, "exec")
    assert "def main" not in code
    assert "return {" not in code
    assert not names_without_a_value(code)
    assert f"```py\n{code}\n```" in GALLERY, "run docs/make_gallery.py"
