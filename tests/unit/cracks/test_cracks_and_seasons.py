"""Cracks that breathe beside those of a settlement: temperatures as candidates, once and as cycles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import Candidate, Measurement, Temperature
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.moved import moved_model
from concio.analysis.cracks.observed import readings
from models import box, model_of, weight
from samples import sample

ALPHA, COLDER = 8e-6, -20.0
ERROR = 0.1e-3
GIVES = Candidate("left gives way", body="left abutment", direction=(-1, 0), low=0.0)
COLD = Candidate("colder", group="temperature", low=-40.0, high=0.0)


def arch():
    """A flat arch of voussoirs that shrink by 1 K at load factor 1."""
    stone = concio.Rigid(22.0, ALPHA)
    made = concio.arch(shape="flat", span=6.0, ring=0.6, voussoirs=6, skew=70, block=stone, friction=2.0)
    return replace(made, temperatures=(Temperature(1.0),))


def cracks(model):
    """Two openings, a joint that is closed and a level, as they are where it is cold."""
    top = (-3.0 - 0.6 / np.tan(np.deg2rad(70)), 0.6)
    asked = [
        Measurement("crown", "opening", ERROR, joint=("v03", "v04"), at=(0.0, 0.0)),
        Measurement("springer", "opening", ERROR, joint=("left abutment", "v01"), at=top),
        Measurement("between", "closed", ERROR, joint=("v02", "v03"), at=(-1.0, 0.0)),
        Measurement("sinks", "level", ERROR, body="v03", at=(0.0, 0.6)),
    ]
    moved = moved_model(model, [COLD], np.ones(1))
    assembly = concio.assemble(moved.model)
    forward = Forward.of(assembly, moved, readings(assembly, asked), None, 4)
    values = forward.predict(np.array([COLDER])).values
    return [replace(m, value=float(v)) if m.kind != "closed" else m for m, v in zip(asked, values, strict=True)]


def causes(found):
    return {c.names for c in found.causes}


def test_a_cold_arch_is_not_taken_for_one_whose_abutment_gave_way() -> None:
    model = arch()
    measured = cracks(model)
    assert measured[0].value == pytest.approx(-ALPHA * COLDER * 6.0, rel=1e-3)  # as if its span were wider
    alone = concio.diagnose(model, measured, [GIVES], large=False)
    assert causes(alone) == {("left gives way",)}  # what is not a candidate is not examined
    both = concio.diagnose(model, measured, [GIVES, COLD], large=False)
    assert causes(both) == {("left gives way",), ("colder",)}
    assert both.verdict.status == "several_causes"
    width = Measurement("span", "distance", ERROR, body="left abutment", at=(-3.0, 0.0), other="right abutment",
                        to=(3.0, 0.0))  # fmt: skip
    told = concio.diagnose(model, [*measured, width], [GIVES, COLD], large=False)
    assert causes(told) == {("colder",)}
    assert told.causes[0].motion[0] == pytest.approx(COLDER, abs=0.5)
    assert told.causes[0].low[0] < COLDER < told.causes[0].high[0]
    assert "temperature" in " ".join(a.what for a in told.verdict.question.acting)


def tile():
    """A stone that lies on a slope of 10 degrees, warmed by 1 K at load factor 1."""
    level = model_of(
        box("roof", -1, 2, -1, 0, kind="fixed"), box("tile", 0, 1, 0, 0.1, kind="rigid", material="stone"), law=0.6,
        materials={"stone": concio.Rigid(20.0, ALPHA)}, loads=(weight(),), temperatures=(Temperature(1.0),),
    )  # fmt: skip
    return concio.place(level, turn=10.0, loads="world")


@pytest.mark.parametrize("summers", sample([1], [1, 4]))
def test_what_friction_kept_of_summers_tells_how_warm_they_were(summers) -> None:
    down = summers * 30.0 * ALPHA
    slope = np.deg2rad(10.0)
    way = (-float(np.cos(slope)), -float(np.sin(slope)))
    at = tuple(0.5 * np.array([np.cos(slope), np.sin(slope)]))
    measured = [
        Measurement("slip", "level", 1e-5, down, body="tile", at=at, direction=way),
        Measurement("closed", "closed", 1e-5, joint=("roof", "tile")),
    ]
    warm = Candidate("summers", group="temperature", times=summers, low=0.0, high=100.0)
    found = concio.diagnose(tile(), measured, [warm], large=False)
    assert causes(found) == {("summers",)}
    assert found.best.motion[0] == pytest.approx(30.0, rel=1e-2)
    once = concio.diagnose(tile(), measured, [replace(warm, times=0)], large=False)
    assert once.causes == () if summers == 4 else once.best.motion[0] != pytest.approx(30.0, abs=1.0)


def test_only_a_group_can_come_and_go() -> None:
    with pytest.raises(concio.InputError, match="applied and removed"):
        Candidate("sinks", body="ground", direction=(0, -1), times=2)
