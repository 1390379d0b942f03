"""Studies that are resumed are of the same files and asked the same; columns, reasons and reactions of their rows."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.io.csv_table import write_csv
from concio.studies import store
from concio.studies.outputs import Computed, find_output
from concio.studies.statistics import rank_correlations, sobol_indices
from concio.verdict.italian import italian

PIER = """
[column]
width = 0.5
height = 2.0
blocks = 2
block = { kind = "rigid", unit_weight = 20 }
"""
PARTS = """
[[parts]]
file = "pier.toml"
[study]
size = 4
outputs = ["stands", "max_settlement", "reaction.ground.y"]
[[study.variables]]
name = "angle"
keys = "parts[1].turn"
low = 0
high = 0.5
"""


@pytest.fixture
def parts(tmp_path: Path) -> Path:
    """Return a model file that names another one, with a study of it that was stopped after two runs."""
    (tmp_path / "pier.toml").write_text(PIER)
    file = tmp_path / "parts.toml"
    file.write_text(PARTS)
    seen: list[object] = []
    concio.study(file, directory=tmp_path / "s", progress=lambda state: seen.append(state) or len(seen) == 2)
    return file


def test_a_file_that_the_model_names_belongs_to_the_study(parts: Path) -> None:
    (parts.parent / "pier.toml").write_text(PIER.replace("0.5", "0.8"))
    with pytest.raises(concio.InputError, match=r"another study: 'pier\.toml' differs"):
        concio.study(parts, directory=parts.parent / "s", resume=True)
    (parts.parent / "pier.toml").write_text(PIER)
    assert len(concio.study(parts, directory=parts.parent / "s", resume=True)) == 4


def test_a_file_that_a_choice_names_belongs_to_the_study(tmp_path: Path) -> None:
    for width in ("0.5", "0.6"):
        (tmp_path / f"pier {width}.toml").write_text(PIER.replace("0.5", width))
    file = tmp_path / "parts.toml"
    choice = 'keys = "parts[1].file"\ndistribution = "choice"\nvalues = ["pier 0.5.toml", "pier 0.6.toml"]\n'
    file.write_text(PARTS.split("keys")[0] + choice)
    concio.study(file, directory=tmp_path / "s")
    (tmp_path / "pier 0.6.toml").write_text(PIER.replace("0.5", "0.7"))
    with pytest.raises(concio.InputError, match=r"'pier 0\.6\.toml' differs"):
        concio.study(file, directory=tmp_path / "s", resume=True)


def test_outputs_are_told_by_their_code_and_not_by_their_place_in_memory() -> None:
    for output in (find_output("max_settlement").read, find_output("joint_motion").read, Computed("m", max)):
        assert " at 0x" not in store._function(output)
    assert store._function(find_output("max_settlement").read) != store._function(find_output("joint_motion").read)


def test_columns_of_a_study_have_no_units_but_their_own(parts: Path) -> None:
    code, _, error = run("study", parts, "--out", parts.parent / "s", "--resume")
    assert code == 0, error
    head = (parts.parent / "s" / "table.csv").read_text().splitlines()[0]
    assert head.startswith("run,angle,stands,max_settlement [m],reaction.ground.y [kN],")
    table = write_csv({"angle": np.zeros(1)}, parts.parent / "t.csv")
    assert table.read_text().startswith("angle [rad]")


def test_an_output_that_differs_by_rounding_alone_has_no_sensitivity(parts: Path) -> None:
    found = concio.study(parts, directory=parts.parent / "s", resume=True)
    weights = found.values("reaction.ground.y")
    assert np.allclose(weights, 20.0, rtol=1e-12, atol=0)
    found.plot.histogram("reaction.ground.y")  # ended in an error
    column = {"a": np.arange(5.0)}
    noise = 20.0 + 4e-15 * np.array([0, 1, 0, 2, 1])
    assert rank_correlations(column, noise).first[0] == 0
    placed = np.array([-np.inf, 1.0, 1.0 + 1e-15, 2.0, np.inf])
    assert abs(rank_correlations(column, placed).first[0] - 9.5 / np.sqrt(95)) < 1e-12
    with pytest.raises(concio.InputError, match="all runs give the same value"):
        sobol_indices(["a"], noise)


def test_reasons_that_differ_from_run_to_run_are_told_as_examples() -> None:
    pier = {"column": {"width": 0.5, "height": 2.0, "blocks": 1, "block": {"kind": "rigid", "unit_weight": 20}}}
    width = concio.variable("w", keys="column.width", low=-1, high=1)
    found = concio.study(pier, [width], "stands", [[-1.0], [-0.5], [0.5]])
    assert found.verdict.unchecked[0].startswith("stands in 2 of 3 runs, such as: model, [column]: width = -1")
    alike = concio.study(pier, [width], "stands", [[-1.0], [-1.0], [0.5]])
    assert alike.verdict.unchecked[0].startswith("stands in 2 of 3 runs: model, [column]: width = -1")


def test_runs_are_counted_from_zero_everywhere() -> None:
    with pytest.raises(concio.InputError, match=r"^run 3 has no value \("):
        sobol_indices(["a"], np.array([1.0, 2.0, 3.0, np.nan]))
    with pytest.raises(concio.InputError, match="2 runs have no value, the first of them run 1 "):
        sobol_indices(["a"], np.array([1.0, np.nan, 3.0, np.nan]))


def test_why_there_are_no_sobol_indices_is_said_in_italian(monkeypatch: pytest.MonkeyPatch) -> None:
    """Names of reactions have full stops, and stayed in English sentences."""
    told = []
    monkeypatch.setitem(sys.modules, "SALib.analyze", None)
    for values in ([1.0, 2.0, 3.0, np.nan], [1.0, np.inf, np.nan, 2.0], [1.0, 1.0, 1.0, 1.0], [1.0, 2.0, 3.0, 4.0]):
        with pytest.raises(concio.InputError) as caught:
            sobol_indices(["a"], np.array(values))
        told.append(caught.value.what)
    assert [what.count(":") for what in told] == [0, 0, 0, 0]
    for what in (*told, "only 3 of 8 runs have ended"):
        line = f"there are no Sobol indices of reaction.ground.x: {what}"
        for sentence in (line, f"T{line[1:]}."):
            said = italian(sentence)
            assert [piece.language for piece in said] == ["it"], sentence
            assert "indici di Sobol di reaction.ground.x: " in said[0].text


def test_reactions_of_a_structure_in_space_have_a_vertical_part() -> None:
    plane = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", unit_weight=20.0, friction=0.5)
    for model, name in ((concio.extrude(plane), "reaction.ground.z"), (plane, "reaction.ground.y")):
        found = concio.study(lambda values, model=model: model, {"a": {"low": 0.0, "high": 1.0}}, name, size=2)
        assert found.values(name) == pytest.approx([20.0, 20.0])
    found = concio.study(lambda values: plane, {"a": {"low": 0.0, "high": 1.0}}, "reaction.ground.z", size=1)
    assert "a plane model has no reaction along z" in found.failures[0].message


def test_sobol_indices_that_there_are_not_are_told() -> None:
    pillar = {"column": {"width": 0.5, "height": 2.0, "blocks": 1, "block": {"kind": "rigid", "unit_weight": 20}}}
    variables = {"width": {"keys": "column.width", "low": -0.1, "high": 1.0},
                 "height": {"keys": "column.height", "low": 1.0, "high": 3.0}}  # fmt: skip
    found = concio.study(pillar, variables, "max_settlement", "saltelli", size=4)
    assert any(line.startswith("there are no Sobol indices of max_settlement: ") for line in found.verdict.limits)
    again = concio.study(pillar, {**variables, "width": {**variables["width"], "low": 0.1}}, "reaction.ground.y",
                         "saltelli", size=4)  # fmt: skip
    assert not any("Sobol" in line for line in again.verdict.limits)
