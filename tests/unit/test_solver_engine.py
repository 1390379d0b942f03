"""The engine of linear systems is chosen in Python, in files and on the command line, and the result names it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.io.result_file import load_result, save_result

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
