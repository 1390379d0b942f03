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
from concio.studies.functions import function_text
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


def test_a_study_is_resumed_through_a_link_to_its_folder(tmp_path: Path) -> None:
    real = tmp_path / "a" / "real"
    real.mkdir(parents=True)
    (real / "pier.toml").write_text(PIER)
    (real / "parts.toml").write_text(PARTS)
    (tmp_path / "link").symlink_to(real, target_is_directory=True)
    concio.study(real / "parts.toml", directory=tmp_path / "s")
    assert len(concio.study(tmp_path / "link" / "parts.toml", directory=tmp_path / "s", resume=True)) == 4


def test_a_file_on_another_drive_keeps_its_place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def apart(path: str, start: object) -> str:
        msg = "path is on mount 'D:', start on mount 'C:'"
        raise ValueError(msg)

    monkeypatch.setattr(store.os.path, "relpath", apart)
    assert store._beside(tmp_path, "D:/pier.toml") == "D:/pier.toml"


def test_a_drawing_that_a_model_was_made_from_is_not_read(tmp_path: Path) -> None:
    """It was refused to resume where the drawing changed that [record] names, in the model or in a part of it."""
    record = '[record]\nfile = "wall.dxf"\n[record.of]\nsolids_file = "wall.dxf"\n'
    (tmp_path / "wall.dxf").write_text("a")
    (tmp_path / "pier.toml").write_text(PIER + record)
    file = tmp_path / "parts.toml"
    file.write_text(PARTS + record)
    concio.study(file, directory=tmp_path / "s")
    (tmp_path / "wall.dxf").write_text("b")
    assert len(concio.study(file, directory=tmp_path / "s", resume=True)) == 4


def test_outputs_are_told_by_their_code_and_not_by_their_place_in_memory() -> None:
    for output in (find_output("max_settlement").read, find_output("joint_motion").read, Computed("m", max)):
        assert " at 0x" not in function_text(output)
    assert function_text(find_output("max_settlement").read) != function_text(find_output("joint_motion").read)


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


def test_a_reaction_that_is_zero_but_for_rounding_has_no_sensitivity() -> None:
    """A wall under its weight pushes nothing: what was 1e-27 of 16 kN had a rank correlation of -0.6."""
    pier = {"column": {"width": 0.5, "height": 2.0, "blocks": 4, "block": {"kind": "rigid", "unit_weight": 20}}}
    variables = {"width": {"keys": "column.width", "low": 0.4, "high": 0.8},
                 "height": {"keys": "column.height", "low": 1.0, "high": 2.0}}  # fmt: skip
    names = ("reaction.ground.x", "reaction.ground.y")
    found = concio.study(pier, variables, names, size=8)
    assert not found.values(names[0]).any()
    assert not found.sensitivity(names[0]).first.any()
    assert found.sensitivity(names[1]).first.min() > 0
    pushed = {"column": {**pier["column"], "horizontal": 1e-6}}
    found = concio.study(pushed, variables, names, size=8)
    assert np.allclose(found.values(names[0]) / found.values(names[1]), -1e-6, rtol=1e-6, atol=0)


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
