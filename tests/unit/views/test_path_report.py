"""How a load path is reported: report, exit code and terminal say the same, with the multiplier on the axis."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import concio
from commands import run
from concio.plot.path_accessor import PathPlots
from concio.post.path_curve import most_moving
from concio.report.path_page import event_load, path_html, step_words

TOPPLES = """
[column]
width = 0.3
height = 1.2
blocks = 3
block = {{ kind = "{kind}"{modulus}, unit_weight = 20 }}
friction = 0.9
horizontal = 1.0
{mesh}
"""
"""Tips about the corner of its base at a horizontal load of width / height = 0.25 of its weight."""


def column(kind: str) -> str:
    elastic = kind == "elastic"
    return TOPPLES.format(
        kind=kind, modulus=', E = "20 GPa"' if elastic else "", mesh="mesh_size = 0.2" if elastic else ""
    )


@pytest.mark.long
@pytest.mark.parametrize("kind", ["rigid", pytest.param("elastic", marks=pytest.mark.long)])
def test_a_path_that_ends_in_collapse_says_so_everywhere(tmp_path: Path, kind: str) -> None:
    file, out = tmp_path / "column.toml", tmp_path / "out"
    file.write_text(column(kind), encoding="utf-8")
    code, told, _ = run("path", file, "--stage", "dead=1", "--stage", "live=1", "--out", out)
    assert code == 3
    facts = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert facts["stages"][1]["load"] == "live"
    most = facts["stages"][1]["most"]
    assert most <= 0.25 * (1 + 1e-6)
    assert most == pytest.approx(0.25, rel=1e-6 if kind == "rigid" else 0.01)
    assert facts["status"] in ("limit", "mechanism")
    report = (out / "report.html").read_text(encoding="utf-8")
    for text in (told, report):
        assert "The structure collapses on this path." in text
        assert facts["sentence"].replace("'", "&#x27;" if text is report else "'") in text
        assert "The loads are carried" not in text
        assert ("were given a compliance" in text) == (kind == "rigid")
    assert "Collapses in stage '2: live = 1': it carries no more than live = " in facts["sentence"]
    assert not (out / "end" / "report.html").exists()  # a report of the last state alone would say that it is carried


def test_a_path_that_is_carried_says_that(tmp_path: Path) -> None:
    file = tmp_path / "column.toml"
    file.write_text(column("rigid"), encoding="utf-8")
    code, told, _ = run("path", file, "--stage", "dead=1", "--stage", "live=0.2")
    assert code == 0
    assert "The loads are carried to the end of the path." in told
    assert "All 2 stages are carried to the end." in told


def test_the_load_of_a_stage_is_that_of_the_groups_that_change() -> None:
    model = concio.loads(column("rigid"))
    stages = [
        concio.Stage("weight", {"dead": 1.0}),
        concio.Stage("push", {"live": 0.2}),
        concio.Stage("both", {"live": 0.1, "dead": 2.0}),
    ]
    found = concio.run_path(model, stages)
    assert found.complete
    for k, (name, ends) in enumerate([("dead", (0, 1)), ("live", (0, 0.2)), ("share of 'both'", (0, 1))]):
        word, values = found.load(k)
        assert (word, values[0], values[-1]) == (name, pytest.approx(ends[0]), pytest.approx(ends[1]))
        assert len(values) == len(found.curve(most_moving(found), k)[0])
    labels = [axes.get_ylabel() for axes in PathPlots(found).stages()]
    assert labels == ["multiplier of dead [-]", "multiplier of live [-]", "share of 'both'"]
    assert found.plot.curve(stage=1).get_title(loc="left") == "push"
    last = max(i for i, step in enumerate(found.steps) if step.stage == 1)
    assert step_words(found, last) == "push: live at 0.2"


def test_events_lie_at_the_load_at_which_they_happen() -> None:
    found = concio.run_path(
        concio.loads(column("elastic")), [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 0.2})]
    )
    opened = [event for event in found.events if event.kind == "opens"]
    assert opened
    for event in opened:
        assert event_load(found, event) == pytest.approx(0.2 * event.parameter, abs=1e-12)
    assert "Events" in path_html(found)
