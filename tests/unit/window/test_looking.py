"""What answers are viewed with: motions, numbers, and the list of those that are kept."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.cli.answering_process import numbers
from concio.cli.limit_files import write_limit
from concio.report.page import write_report
from concio.report.view_data import unpack
from concio.window.results import Results


@pytest.fixture
def pillar() -> concio.Model:
    model = concio.column(width=0.5, height=2.0, blocks=2, block="rigid", unit_weight=20.0)
    push = concio.Load("point", (1.0, 0.0), bodies=("b02",), at=(-0.25, 2.0), group="live")
    return concio.Model(bodies=model.bodies, materials=model.materials, laws=model.laws, loads=(*model.loads, push))


def test_the_motions_of_a_limit_load_are_those_of_its_figures(pillar: concio.Model, tmp_path: Path) -> None:
    found = concio.limit(pillar, path=False)
    place = tmp_path / ("0" * 32)
    place.mkdir()
    assert "motions.json" in write_limit(found, {}, place)
    shown = Results(tmp_path).film(place.name)
    assert shown["alternatives"]
    assert len(shown["steps"]) == 1 + (found.collapse_state is not None)
    velocity = found.mechanism
    assert velocity is not None
    move = unpack(shown["steps"][-1]["move"]).reshape(-1, 2)
    assert np.hypot(*move.T).max() > 0.0
    assert shown["bodies"]["name"] == [b.name for b in pillar.bodies]


def test_lines_of_force_carry_what_stands_above_every_cut(pillar: concio.Model, tmp_path: Path) -> None:
    place = tmp_path / ("2" * 32)
    place.mkdir()
    write_report(concio.solve(pillar), place / "report.html")
    data = Results(tmp_path).film(place.name)
    (step,) = data["steps"]
    lines = unpack(step["chain"]).reshape(-1, 2, 2) + np.array(data["origin"])
    force = unpack(step["carried"])
    for y, weight in ((0.02, 20.0), (1.02, 10.0)):  # 0.5 x 1.0 m of 20 kN/m3 each, pushed by 1 kN at the top
        cut = (lines[:, :, 1].min(1) < y) & (lines[:, :, 1].max(1) > y)
        way = lines[cut, 1] - lines[cut, 0]
        way *= np.sign(way[:, 1:]) / np.hypot(*way.T)[:, None]
        assert force[cut] @ way == pytest.approx([-1.0, weight], abs=1e-4)


def test_a_report_gives_its_own_data_and_other_files_none(pillar: concio.Model, tmp_path: Path) -> None:
    place = tmp_path / ("1" * 32)
    place.mkdir()
    results = Results(tmp_path)
    assert results.film(place.name) is None
    write_report(concio.solve(pillar), place / "report.html")
    assert results.film(place.name)["bodies"]["name"] == [b.name for b in pillar.bodies]
    (place / "report.html").write_text("<html>no data</html>", encoding="utf-8")
    assert results.film(place.name) is None


def test_answers_that_are_kept_are_listed_the_newest_first(tmp_path: Path) -> None:
    results = Results(tmp_path)
    for age, key in ((3, "a" * 32), (1, "b" * 32), (2, "c" * 32)):
        results.keep(key, {"key": key})
        os.utime(tmp_path / key, (1e9 - age, 1e9 - age))
    assert [one["key"][0] for one in results.known()] == ["b", "c", "a"]


def test_a_door_opens_the_files_of_its_answer_and_no_others(tmp_path: Path) -> None:
    results = Results(tmp_path)
    for key in ("a" * 32, "b" * 32):
        results.keep(key, {"key": key})
        (tmp_path / key / f"{key[0]}.svg").write_text("<svg/>", encoding="utf-8")
    (tmp_path / "secret.svg").write_text("<svg/>", encoding="utf-8")
    word = results.door("a" * 32)
    assert results.door("a" * 32) == word != results.door("b" * 32)
    assert results.behind(word, "a.svg") == tmp_path / ("a" * 32) / "a.svg"
    for name in ("b.svg", "../secret.svg", ".answer.json", "none.svg", ""):
        assert results.behind(word, name) is None
    assert results.behind("a" * 32, "a.svg") is None


def test_numbers_of_a_summary_are_named_as_in_json() -> None:
    told = {"status": "solved", "bodies": 3, "ok": True, "certificate": {"worst": 1e-9, "deep": {"x": 1}},
            "verdict": {"exit_code": 0}, "seconds": {"total": 1.0}}  # fmt: skip
    assert numbers(told) == {"bodies": 3.0, "certificate.worst": 1e-9}
