"""Verdicts of comparisons, cells and continua: the same in words, JSON and exit code, and those of ``concio run``."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.studies.compare import compare
from concio.verdict.cell_verdict import cell_verdict
from concio.verdict.comparison_verdict import BALANCED_ONLY, MEETS
from concio.verdict.verdict import Outcome
from samples import sample

SLOT = """
title = "two blocks in a slot, nothing below"
[materials.stone]
kind = "rigid"
unit_weight = {weight}
[joints.dry]
friction = {friction}
[[blocks]]
name = "left"
rectangle = [[{x0}, {low}], [{x1}, {high}]]
kind = "fixed"
[[blocks]]
name = "right"
rectangle = [[{x3}, {low}], [{x4}, {high}]]
kind = "fixed"
[[blocks]]
name = "b1"
rectangle = [[{x1}, 0.0], [{x2}, {height}]]
material = "stone"
[[blocks]]
name = "b2"
rectangle = [[{x2}, 0.0], [{x3}, {height}]]
material = "stone"
[[loads]]
kind = "weight"
value = [0.0, -1.0]

"""
WALL = """
[panel]
courses = 2
blocks = 2
block_size = [0.4, 0.2]
base = "full"
"""


def slot(rng: np.random.Generator) -> str:
    """Return two blocks between two walls, of any size and weight: nothing but friction could hold them."""
    size, weight = 10.0 ** rng.uniform(-1, 1), 10.0 ** rng.uniform(-1, 3)
    width, height = size * rng.uniform(0.3, 0.8), size * rng.uniform(0.5, 1.5)
    at = {"x0": -size, "x1": 0.0, "x2": width, "x3": 2 * width, "x4": 2 * width + size}
    return SLOT.format(**at, low=-size, high=2 * size, height=height, weight=weight,
                       friction=rng.uniform(0.3, 0.9))  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 8, 30)))
def test_compare_says_what_run_says(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "slot.toml"
    path.write_text(slot(np.random.default_rng(seed)))
    code, out, _ = run("run", path, "--json")
    own = json.loads(out)
    both, out, _ = run("compare", path, "--methods", "interior-point,exhaustive,admm", "--json")
    told = json.loads(out)
    assert (code, both) == (3, 3)
    assert told["status"] == own["status"] == "collapses"
    assert told["verdict"]["outcome"] == own["verdict"]["outcome"] == "fails"
    assert told["verdict"]["attention"] == own["verdict"]["attention"]
    assert MEETS not in [row["outcome"] for row in told["rows"]]


def test_a_row_is_never_called_solved_where_the_structure_fails() -> None:
    model = concio.loads(slot(np.random.default_rng(7)))
    result = concio.solve(model, on_failure="return")
    assert result.verdict.outcome is Outcome.FAILS
    from concio.contact.assembly import assemble

    problem = assemble(model).problem()  # without the vanishing compliance forces squeezed in at will balance
    bare = compare(problem, ["exhaustive"])
    assert MEETS in [row.outcome for row in bare.rows]
    assert any("only with the verdict of its model" in line for line in bare.verdict.limits)
    table = compare(problem, ["exhaustive"], decided=result.verdict)
    words = [row.outcome for row in table.rows]
    assert MEETS not in words
    assert BALANCED_ONLY in words
    assert table.verdict.exit_code == 3
    assert "self-stress alone" in table.verdict.sentence


def test_compare_of_what_stands_holds(tmp_path: Path) -> None:
    path = tmp_path / "wall.toml"
    path.write_text(WALL + "top_pressure = 10\nelements_per_block = [2, 1]\n")
    code, out, _ = run("compare", path, "--methods", "lemke,admm")
    assert code == 0
    assert out.startswith("In equilibrium")
    assert "acts" in out
    assert "Of 3 methods 3 meet the equations" in out


@pytest.mark.long  # the next one looks at a direction alone
def test_a_cell_carries_its_verdict(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    assert run("new", "cell", path)[0] == 0
    code, out, _ = run("cell", path, "--no-strength", "--stage", "stress yy=-100", "--json")
    told = json.loads(out)
    assert code == told["verdict"]["exit_code"] == 0
    assert told["status"] == "solved"
    ended, out, _ = run(
        "cell", path, "--no-strength", "--stage", "stress yy=-100", "--stage", "stress xy=1e6", "--json"
    )
    told = json.loads(out)
    assert ended == told["verdict"]["exit_code"] != 0
    assert told["status"] == "incomplete"
    assert told["verdict"]["outcome"] == {3: "fails", 4: "incomplete"}[ended]


def test_a_cell_says_that_its_bound_is_one_and_what_is_not_checked() -> None:
    cell = PeriodicCell.of(concio.cell(bond="running", friction=0.6))
    found = concio.strength(cell, [(0.0, 0.0, 1.0)], stress=(0.0, -100.0, 0.0), faces=False, coulomb=False)
    verdict = cell_verdict(cell, None, found, None, none="rigid blocks")
    assert verdict.outcome is Outcome.HOLDS
    assert any("upper bound" in line for line in verdict.limits)
    assert "No moduli: rigid blocks." in verdict.sentence
    assert "moduli" not in found.verdict.question.asked
    assert found.verdict.answer in verdict.answer


def test_a_continuum_carries_its_verdict(tmp_path: Path) -> None:
    path = tmp_path / "wall.toml"
    path.write_text("[wall]\nlength = 1.6\nheight = 0.8\nblock_size = [0.4, 0.2]\nhorizontal = 1.0\n")
    code, out, _ = run("continuum", path, "--no-elastic", "--mesh-size", "0.4 m", "--json")
    told = json.loads(out)
    assert code == told["verdict"]["exit_code"]
    assert (told["status"] == "solved") == (code == 0)
    roles = {a["group"]: a["role"] for a in told["verdict"]["question"]["acting"]}
    assert roles == {"dead": "constant", "live": "multiplied"}
    assert any("upper bounds" in line for line in told["verdict"]["limits"])
