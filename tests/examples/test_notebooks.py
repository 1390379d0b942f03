"""Notebooks run from their first cell to their last, and what ends a cell shows itself."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest

import concio

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))
PNG = b"\x89PNG\r\n\x1a\n"


def shown(value: Any) -> str | bytes | None:
    """Return what a notebook shows of a value: its page, else its picture."""
    for name in ("_repr_html_", "_repr_png_"):
        if callable(method := getattr(value, name, None)):
            return method()
    return None


def last_value(source: str, names: dict[str, Any]) -> Any:
    """Run a cell and return the value of the expression that ends it, None where none does."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), "cell", "eval"), names)


@pytest.mark.long
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_notebook_runs_and_every_cell_shows_something(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    notebook = json.loads(path.read_text(encoding="utf-8"))
    names: dict[str, Any] = {"__name__": "__main__"}
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) > 4
    for cell in cells:
        assert shown(last_value(cell, names)), f"nothing is shown of:\n{cell}"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_notebook_is_kept_without_what_it_printed(path: Path) -> None:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in notebook["cells"])


def test_a_plot_is_a_picture_of_its_figure() -> None:
    result = concio.solve(concio.column(width=0.5, height=2.0, blocks=4, block="rigid"))
    axes = result.plot.forces()
    assert axes._repr_png_().startswith(PNG)
    assert axes._repr_png_() == axes.figure._repr_png_()


def test_axes_that_are_given_stay_what_they_are() -> None:
    """Figures of the caller are shown by whoever made them; nothing is shown twice."""
    figure = pytest.importorskip("matplotlib.figure").Figure()
    axes = figure.add_subplot()
    result = concio.solve(concio.column(width=0.5, height=2.0, blocks=4, block="rigid"))
    assert result.plot.forces(ax=axes) is axes
    assert not hasattr(axes, "_repr_png_")


def test_the_viewer_stands_in_a_frame_of_its_own() -> None:
    html = concio.solve(concio.column(width=0.5, height=2.0, blocks=4, block="rigid")).viewer(height=321)._repr_html_()
    assert html.startswith("<iframe srcdoc=")
    assert html.count("<") == 2  # what stands inside is quoted
    assert "height:321px" in html
