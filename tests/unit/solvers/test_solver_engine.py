"""The engine of linear systems is chosen in Python, in files and on the command line, and the result names it."""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.limit import limit_stages
from concio.io.result_file import load_result, save_result
from concio.solvers.algebra.sparse_factor import Array, Pattern
from concio.solvers.statics import cone_programme
from seismic_walls import overturning, site

TEXT = """
[column]
width = 0.5
height = 1.0
blocks = 3
friction = 0.6
top_pressure = 10.0
{solver}
"""
PARDISO = '[solver]\nengine = "pardiso"\n'


def test_the_usual_engine_is_named() -> None:
    result = concio.solve(concio.loads(TEXT.format(solver="")))
    assert result.engine == "superlu"
    assert result.solved_by == result.method
    assert result.summary()["engine"] == "superlu"


def test_pardiso_everywhere(tmp_path: Path) -> None:
    pytest.importorskip("pypardiso")
    model = concio.loads(TEXT.format(solver=PARDISO))
    assert concio.loads(concio.dumps(model)).engine == "pardiso"
    result = concio.solve(model)
    assert result.solved_by.endswith(" with pardiso")
    assert "with pardiso" in repr(result)
    save_result(result, tmp_path)
    assert load_result(tmp_path).engine == "pardiso"
    plain = concio.solve(model, engine="superlu")
    assert plain.engine == "superlu"
    np.testing.assert_allclose(result.displacement, plain.displacement, rtol=1e-9, atol=1e-18)
    file = tmp_path / "column.toml"
    file.write_text(TEXT.format(solver=""), encoding="utf-8")
    code, out, _ = run("run", file, "--engine", "pardiso", "--json")
    assert (code, json.loads(out)["engine"]) == (0, "pardiso")


def test_engines_that_are_none(tmp_path: Path) -> None:
    file = tmp_path / "column.toml"
    file.write_text(TEXT.format(solver=PARDISO.replace("pardiso", "pardizo")), encoding="utf-8")
    code, _, told = run("check", file)
    assert (code, "engine" in told) == (2, True)
    file.write_text(TEXT.format(solver=""), encoding="utf-8")
    for arguments in (["--engine", "pardizo"], ["--method", "lemke", "--engine", "pardiso"]):
        code, _, told = run("run", file, *arguments)
        assert (code, "engine" in told) == (2, True)
        assert "Traceback" not in told


def engines_of(function: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the engines asked for wherever a function orders a linear system, which SuperLU then factorises.

    Orders of cone programmes that earlier tests left are put aside: what is taken up again is not ordered.
    """
    seen: set[str] = set()
    order = Pattern.of.__func__

    def watched(
        cls: type[Pattern], row: Array, column: Array, size: int, engine: str = "superlu", group: int = 2
    ) -> Pattern:
        seen.add(engine)
        pattern: Pattern = order(cls, row, column, size, "superlu", group)
        return pattern

    with monkeypatch.context() as patch:
        patch.setattr(Pattern, "of", classmethod(watched))
        patch.setattr(cone_programme, "_RECENT", OrderedDict())
        function()
    return seen


BLOCKS = concio.wall(length=0.8, height=0.4, block_size=(0.4, 0.2), block="rigid", friction=0.6, horizontal=1.0)
WALLS = {"plane": BLOCKS, "space": concio.extrude(BLOCKS, 0.2)}
ASKED = {
    "solve": lambda m: concio.solve(m, factors={"live": 2.0}, on_failure="return"),
    "limit": lambda m: concio.limit(m, path=False, steps=True, search=False),
    "stages": lambda m: list(limit_stages(m, path=False, steps=True, search=False)),
    "margin": lambda m: concio.load_margin(m, tolerance=0.2),
    "friction": lambda m: concio.friction_by_solving(m, factor=0.2, tolerance=0.2),
    "steps": lambda m: concio.run_path(m, [concio.Stage("all", {"dead": 1.0, "live": 0.1}, steps=2)], method="steps"),
}
MOVED = {
    "push": lambda m: concio.push(m, step=0.02, until=0.02),
    "shake": lambda m: concio.dynamics(m, duration=0.01, step=5e-3),
}


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize("kind", WALLS)
def test_all_that_is_solved_on_the_way_is_solved_by_the_engine_of_the_model(
    asked: str, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for engine in ("pardiso", "superlu"):
        model = replace(WALLS[kind], engine=engine)
        assert engines_of(lambda model=model: ASKED[asked](model), monkeypatch) == {engine}


@pytest.mark.parametrize("asked", MOVED)
def test_steps_of_a_motion_are_solved_by_the_engine_of_the_model(asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pillar = concio.column(width=0.2, height=0.8, blocks=2, block="rigid", friction=0.6)
    for engine in ("pardiso", "superlu"):
        model = replace(pillar, engine=engine)
        assert engines_of(lambda model=model: MOVED[asked](model), monkeypatch) == {engine}


@pytest.mark.long
def test_cone_programmes_of_space_are_solved_by_the_engine_of_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    for engine in ("pardiso", "superlu"):
        wall = replace(WALLS["space"], engine=engine)
        assert engines_of(lambda m=wall: concio.friction_margin(m, factor=0.2), monkeypatch) == {engine}
        facade = replace(concio.extrude(overturning(2), 0.5), engine=engine)
        asked = {"site": site(), "direction": "-x", "levels": ["SLV"]}
        assert engines_of(lambda m=facade, a=asked: concio.assess(m, **a), monkeypatch) == {engine}


def test_a_comparison_of_methods_takes_the_engine_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "column.toml"
    file.write_text(TEXT.format(solver=PARDISO), encoding="utf-8")
    assert engines_of(lambda: run("compare", file, "--methods", "alart-curnier"), monkeypatch) == {"pardiso"}


def test_between_two_numbers_of_a_limit_the_engine_is_what_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    stages = limit_stages(replace(BLOCKS, engine="pardiso"), path=False, steps=False, search=False)
    next(stages)
    assert engines_of(lambda: concio.load_margin(BLOCKS, tolerance=0.5), monkeypatch) == {"superlu"}


@pytest.mark.parametrize("command", ["run", "limit", "path", "push", "shake", "cell", "assess", "continuum"])
def test_commands_take_the_engine(command: str, tmp_path: Path) -> None:
    file = tmp_path / "column.toml"
    file.write_text(TEXT.format(solver=""), encoding="utf-8")
    code, _, told = run(command, file, "--engine", "pardizo")
    assert code == 2
    assert "--engine" in told
    assert "pardizo" in told
