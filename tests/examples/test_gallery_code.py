"""The gallery shows the code of its examples as one would type it, and as it is now."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))
GALLERY = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_the_code_shown_is_that_of_the_example(path: Path) -> None:
    code = runpy.run_path(str(ROOT / "docs" / "make_gallery.py"))["as_typed"](path)
    compile(code, path.name, "exec")
    assert "def main" not in code
    assert "return {" not in code
    assert f"```py\n{code}\n```" in GALLERY, "run docs/make_gallery.py"
