"""Derivatives of limit multipliers by duality, beside differences of multipliers that are solved again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis import sensitivity as module
from concio.analysis.parameters import Parameter, parameters_of
from concio.analysis.seismic.assessment_asked import Head
from concio.analysis.sensitivity import _Optimum
from concio.contact.assembly import assemble
from concio.model.model import Model
from concio.report.assessment_page import AssessmentReport
from concio.solvers.statics.associated_limit import associated_limit
from samples import sample
from seismic_walls import overturning, site

FORWARDS = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0
"""Weights of a difference to one side, exact for polynomials of the fourth degree."""


def multiplier(model: Model) -> float:
    assembly = assemble(model)
    dead = assembly.problem({"live": 0.0})
    return associated_limit(dead, assembly.problem({"live": 1.0}).f - dead.f).multiplier


def difference(change: Callable[[float], Model], value: float, sign: float, h: float) -> float:
    """Return the derivative to one side from five multipliers."""
    return sign * float(FORWARDS @ [multiplier(change(value + sign * k * h)) for k in range(5)]) / h


def compare(model: Model, parameters: tuple[Parameter, ...] | None = None) -> None:
    found = concio.limit(model, path=False, search=False).sensitivity()
    for p in parameters or parameters_of(model, ("live",)):
        row, h = found[p.name], 1e-3 * (abs(p.value) or 1.0)
        allowed = 1e-8 * max(abs(row.above), abs(row.below), abs(found.multiplier) / (abs(p.value) or 1.0))
        for sign, told in ((1.0, row.above), (-1.0, row.below)):
            assert told == pytest.approx(difference(p.change, p.value, sign, h), abs=allowed), (p.name, sign)


def laws(model: Model, **more: float) -> Model:
    return replace(model, laws={name: replace(law, **more) for name, law in model.laws.items()})  # type: ignore[arg-type]


@pytest.mark.long
@settings(max_examples=sample(2, 3, 8), deadline=None)
@given(st.floats(0.31, 0.79), st.floats(0.3, 0.6), st.floats(2.0, 9.0), st.floats(0.0, 20.0))
def test_walls_that_slide_and_tip(friction: float, length: float, cohesion: float, load: float) -> None:
    wall = concio.wall(length=3 * length, height=1.0, block_size=(length, 0.25), friction=friction, block="rigid",
                       horizontal=1.0)  # fmt: skip
    top = max(wall.bodies, key=lambda b: (float(b.centroid[1]), float(b.centroid[0])))
    point = concio.Load("point", (0.0, -load - 1.0), bodies=(top.name,), at=tuple(top.centroid.tolist()), group="roof")
    compare(laws(replace(wall, loads=(*wall.loads, point)), cohesion=cohesion, tensile_strength=0.5,
                 compressive_strength=500.0))  # fmt: skip


@pytest.mark.long
def test_an_arch_under_a_load_off_its_crown() -> None:
    arch = concio.arch(span=3.0, ring=0.4, voussoirs=9, friction=0.8, crown_load=2.0, unit_weight=25, block="rigid")
    side = concio.Load("point", (0.0, -3.0), bodies=(arch.free_bodies[2].name,),
                       at=tuple(arch.free_bodies[2].centroid.tolist()), group="live")  # fmt: skip
    loads = (*(v for v in arch.loads if v.group != "live"), side)
    model = replace(arch, loads=loads)
    chosen = [p for p in parameters_of(model, ("live",)) if p.kind in ("length", "unit weight")]
    compare(model, tuple(chosen))


@pytest.mark.long
def test_where_a_block_slides_and_tips_at_once_both_sides_are_told() -> None:
    """lambda = min(mu, b / h): beside the edge it is one of the two."""
    pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=1.0, friction=0.25)
    row = concio.limit(pillar, path=False, search=False).sensitivity()["friction of joint"]
    assert row.one_sided
    assert np.isnan(row.rate)
    assert (row.below, row.above) == pytest.approx((1.0, 0.0), abs=1e-8)
    wide = concio.limit(pillar, path=False, search=False).sensitivity()["length of x"]
    assert (wide.below, wide.above) == pytest.approx((0.25, 0.0), abs=1e-8)


def test_a_number_that_cannot_fall_has_one_side() -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=1.0, friction=0.1)
    found = concio.limit(pillar, path=False, search=False)

    def cohesive(c: float) -> Model:
        return laws(pillar, cohesion=c)

    row = found.sensitivity({"cohesion": cohesive})["own of cohesion"]
    weight = sum(b.volume * pillar.materials[b.material].unit_weight for b in pillar.outlines if b.kind != "fixed")
    assert row.above == pytest.approx(0.5 * pillar.outlines[-1].thickness / weight, rel=1e-8)
    assert np.isnan(row.below)


def test_a_locked_load_depends_on_nothing() -> None:
    model = concio.column(width=0.5, height=1.0, blocks=1, block="rigid")
    down = concio.Load("weight", (0.0, -1.0), group="live")
    with pytest.raises(concio.InputError, match="no limit multiplier"):
        concio.limit(replace(model, loads=(*model.loads, down)), path=False, search=False).sensitivity()


@pytest.mark.long
def test_a_mechanism_of_an_assessment_in_closed_form() -> None:
    """The wall of the worked example: alpha_0 = (W t/2 + 10 x 0.45 + 6 x 0.4) / (W h/2 + 10 x 3 + 6 x 6)."""
    found = concio.assess(overturning(), site=site(), direction="left")
    told = found.sensitivity()
    assert told is not None
    W, top, low = 68.4, 68.4 * 0.3 + 4.5 + 2.4, 68.4 * 3 + 30 + 36
    by_weight = (0.3 * W * low - top * 3 * W) / low**2 / 19.0
    assert told["unit weight of block"].rate == pytest.approx(by_weight, rel=1e-8)
    by_height = (W * 0.3 * low - top * (2 * W * 3 + 66)) / low**2  # the weight of the wall grows with its height
    assert told["length of y"].rate == pytest.approx(by_height, rel=1e-8)
    assert told["friction of joint"].rate == pytest.approx(0.0, abs=1e-10)
    for language, word in (("en", "One per cent more"), ("it", "un per cento in più")):
        text = AssessmentReport(found, head=Head(), sensitivity=told, language=language).html()
        assert word in text
        assert text.count("<figure") == 5


@pytest.mark.long
def test_a_mechanism_that_slides_has_its_derivatives_by_virtual_work() -> None:
    """alpha_0 = mu; an upper bound alone, of dilatant joints, has none."""
    found = concio.assess(overturning(3, friction=0.08), site=site(), direction="left", levels=["SLV"])
    told = found.sensitivity()
    assert told is not None
    assert told["friction of joint"].rate == pytest.approx(1.0, abs=1e-8)
    assert found.worst is not None
    bound = replace(found.worst, found=replace(found.worst.found, flow="associated"))
    assert replace(found, mechanisms=(bound,)).sensitivity() is None


def test_forces_and_motions_beside_the_optimum_are_optima_too() -> None:
    """Where a limit has other forces, they balance the loads at the multiplier, and what slides is at its friction."""
    wall = concio.wall(length=1.0, height=0.5, block_size=(0.25, 0.125), friction=0.4, block="rigid", horizontal=1.0)
    assembly = assemble(wall)
    dead = assembly.problem({"live": 0.0})
    live = assembly.problem({"live": 1.0}).f - dead.f
    best = _Optimum(dead, live, associated_limit(dead, live))
    others, weight = best.others(), float(np.abs(dead.f).sum())
    assert others
    assert any(np.abs(one.t_n - best.t_n).max() > 1e-3 * weight for one in others)
    for one in (best, *others):
        off = dead.R.T @ (dead.f + one.multiplier * live + dead.C_n.T @ one.t_n + dead.C_t.T @ one.t_t.ravel())
        assert np.abs(off).max() < 1e-7 * weight
        slides = best.slip > 1e-3 * best.slip.max()
        assert np.abs(one.t_t[slides, 0]) == pytest.approx(0.4 * np.abs(one.t_n[slides]), abs=1e-7 * weight)


@pytest.mark.parametrize("same", [True, False])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_optima_that_disagree_on_a_slope_give_one_to_each_side(
    same: bool, size: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All optima of one slope: it is the derivative. Else the multiplier is computed beside, on each side."""
    slopes = {"here": 2.0, "other": 2.0 if same else 2.0 + 1e-3}
    monkeypatch.setattr(module, "_slope", lambda optimum, at, value, step, sign: slopes[optimum.name] / size)
    monkeypatch.setattr(module, "_beside", lambda p, at, step: (7.0 if step > 0 else -7.0) / size)
    p = SimpleNamespace(name="n", kind="k", of="", unit="", value=size, change=lambda value: value)
    here, other = (SimpleNamespace(name=n, multiplier=1.0) for n in ("here", "other"))
    row = module._row(p, lambda model: model, here, [other])
    assert row is not None
    wanted = (2.0, 2.0) if same else (-7.0, 7.0)
    assert (row.below * size, row.above * size) == pytest.approx(wanted)


def test_a_sentence_tells_both_sides_where_they_differ():
    """A block that slides and tips at one multiplier: less friction and less width matter, which was not said."""
    block = concio.column(width=0.5, height=1.0, blocks=1, block="rigid", friction=0.5, horizontal=1.0)
    found = concio.limit(block, path=False).sensitivity()
    more, less = found.sentence.split("; one per cent less by: ")
    assert "all lengths along y -1 %" in more
    assert "friction of" in less
    assert "all lengths along x -1 %" in less
    clear = concio.limit(concio.column(width=0.5, height=1.0, blocks=1, block="rigid", friction=0.9, horizontal=1.0))
    assert "less" not in clear.sensitivity().sentence
