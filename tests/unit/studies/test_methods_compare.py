"""The comparison table and its figure."""

from __future__ import annotations

import json

import matplotlib as mpl
import numpy as np
import pytest

from concio.errors import MethodError
from concio.plot.convergence import plot_convergence
from concio.studies.compare import ComparisonTable, compare, format_table
from contact_problems import wall

mpl.use("Agg")


@pytest.fixture(scope="module")
def table() -> ComparisonTable:
    methods = ["penalty", "lagrange", "gauss-seidel", "alart-curnier"]
    options = {"gauss-seidel": {"inertia": 0.0}}  # does not apply to floating blocks
    return compare(wall(2, 2, alpha=0.2), methods, engine="alart-curnier", options=options, title="two courses")


def test_rows(table: ComparisonTable) -> None:
    rows = {row.method: row for row in table.rows}
    assert table.rows[0].method == "alart-curnier"
    assert rows["alart-curnier"].ratio == 1.0
    assert rows["alart-curnier"].outcome == rows["lagrange"].outcome == "solved"
    assert rows["penalty"].outcome == "gave up"
    assert 1e-6 < rows["penalty"].worst < 1e-2
    assert rows["lagrange"].difference < 1e-8
    assert np.isnan(rows["penalty"].difference)
    assert rows["gauss-seidel"].outcome == "not applicable"
    assert "rigid motions" in rows["gauss-seidel"].note


def test_text_and_json(table: ComparisonTable) -> None:
    text = format_table(table)
    for row in table.rows:
        assert row.method in text
        assert row.note in text
    again = json.loads(json.dumps(table.as_dict(), allow_nan=False))
    assert [r["method"] for r in again["rows"]] == [r.method for r in table.rows]


def test_time_limit_is_said() -> None:
    table = compare(wall(2, 2, alpha=1.2), ["uzawa"], engine="lagrange", time_limit=1e-9)
    assert {row.outcome for row in table.rows} == {"too slow"}


def test_unknown_method() -> None:
    with pytest.raises(MethodError, match="no-such"):
        compare(wall(1, 1), ["no-such"])


def test_figure(table: ComparisonTable) -> None:
    ax = plot_convergence(table)
    drawn = {line.get_label(): line for line in ax.get_lines() if not str(line.get_label()).startswith("_")}
    assert set(drawn) == {"alart-curnier", "penalty", "lagrange"}
    residual = np.asarray(drawn["lagrange"].get_ydata())
    assert (np.diff(residual) <= 0).all()
    assert residual[-1] == min(next(r for r in table.rows if r.method == "lagrange").history)
    assert plot_convergence(table, ax=ax) is ax
