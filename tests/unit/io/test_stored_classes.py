"""What a result may consist of can be written and read: every class, parts that stand apart, fill, vehicle, warmth."""

from __future__ import annotations

import dataclasses
import enum
import typing
from dataclasses import replace
from pathlib import Path

import pytest

import concio
from commands import run
from concio import Body, JointLaw, Load, Model, Rigid
from concio.io.result_file import CLASSES, load_result, save_result


def classes_in(hint: object) -> set[type]:
    own = {hint} if isinstance(hint, type) else set()
    return own.union(*(classes_in(inner) for inner in typing.get_args(hint)))


def test_every_class_that_a_result_may_hold_has_a_name_in_the_file() -> None:
    """Results of structures in parts, of bridges and of warm walls could not be written: a bug was reported."""
    waiting: list[type] = [concio.Result]
    seen = set(waiting)
    while waiting:
        at = waiting.pop()
        if not dataclasses.is_dataclass(at):
            continue
        hints = typing.get_type_hints(at, localns=CLASSES)
        held = set[type]().union(*(classes_in(hints[f.name]) for f in dataclasses.fields(at)))
        new = {t for t in held - seen if dataclasses.is_dataclass(t) or issubclass(t, enum.Enum)}
        seen |= new
        waiting += new
    assert seen == set(CLASSES.values())


def box(name: str, low: tuple[float, float], high: tuple[float, float], kind: str = "rigid") -> Body:
    return Body(name, [low, (high[0], low[1]), high, (low[0], high[1])], kind=kind)  # type: ignore[arg-type]


@pytest.mark.parametrize("falls", [False, True])
def test_parts_that_stand_apart_are_written_and_read(falls: bool, tmp_path: Path) -> None:
    bodies = [box("g", (-1, -1), (9, 0), "fixed"), box("a", (0, 0), (1, 1)), box("b", (3, 0), (4, 1))]
    bodies += [box("c", (3.8, 1), (5, 2))] * falls
    model = Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.5)}, loads=(Load("weight", (0, -1)),))
    result = concio.solve(model, on_failure="return")
    assert len(result.solution.parts) == 2
    save_result(result, tmp_path)
    again = load_result(tmp_path)
    assert [p.status for p in again.solution.parts] == [p.status for p in result.solution.parts]
    assert again.sentence == result.sentence


def test_a_warm_wall_is_written_and_read(tmp_path: Path) -> None:
    stone = concio.Elastic(5e6, 0.2, unit_weight=20.0, expansion=1e-5)
    wall = concio.wall(length=1.0, height=0.5, block=stone, friction=0.6, mesh_size=0.25)
    warm = replace(wall, temperatures=(concio.Temperature(20.0),))
    result = concio.solve(warm)
    save_result(result, tmp_path)
    assert load_result(tmp_path).model.temperatures == warm.temperatures


def test_a_loaded_bridge_is_written_and_read(tmp_path: Path) -> None:
    assert run("new", "bridge", tmp_path / "b.toml")[0] == 0
    code, _, err = run("run", tmp_path / "b.toml", "--out", tmp_path / "r", "--no-figures", "-q")
    assert (code, err) == (0, "")
    model = load_result(tmp_path / "r").model
    assert model.vehicle == concio.load(tmp_path / "b.toml").vehicle
    assert model.fill is not None
