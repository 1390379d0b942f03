"""Derivatives of collapse loads with Coulomb friction, beside paths that are followed again."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.parameters import parameters_of
from concio.report.path_page import path_html
from samples import first, sample

STAGES = [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 50.0})]


def followed(model: concio.Model) -> concio.PathResult:
    return concio.run_path(model, STAGES)


def pushed_arch(friction: float, voussoirs: int) -> concio.Model:
    """Return a rigid arch with a horizontal share of its weight, and some weight at the crown that stays."""
    arch = concio.arch(span=3.0, ring=0.4, voussoirs=voussoirs, friction=friction, unit_weight=25, block="rigid",
                       crown_load=3.0)  # fmt: skip
    own = tuple(replace(load, group="dead") for load in arch.loads)
    return replace(arch, loads=(*own, concio.Load("weight", (1.0, 0.0), group="live")))


def compare(model: concio.Model, names: tuple[str, ...] = ()) -> int:
    found = followed(model).sensitivity()
    if found is None:
        return 0
    for p in (p for p in parameters_of(model, ["live"]) if p.name in names or not names):
        h = 1e-3 * p.value
        beside = [followed(p.change(p.value + k * h)).load()[1][-1] for k in (-2, -1, 1, 2)]
        rate = (beside[0] - 8 * beside[1] + 8 * beside[2] - beside[3]) / (12 * h)
        assert found[p.name].rate == pytest.approx(rate, abs=1e-8 * found.multiplier / p.value), p.name
    return len(found.rows)


@pytest.mark.long
@settings(max_examples=sample(1, 1, 2), deadline=None)
@given(st.floats(0.36, 0.8), st.integers(6, 8))
def test_arches_that_slip_and_turn(friction: float, voussoirs: int) -> None:
    compare(pushed_arch(friction, voussoirs))


@pytest.mark.long
def test_an_arch_that_slips_depends_on_its_friction() -> None:
    arch = pushed_arch(0.42, 7)
    found = followed(arch).sensitivity()
    assert found is not None
    assert found["friction of joint"].rate > 0.1
    assert compare(arch, ("friction of joint", "load of dead", "length of y"))


@pytest.mark.long
def test_derivatives_are_those_of_coulomb_friction_below_the_associated_bound() -> None:
    """The bound grows with friction, and the collapse that follows its flow rule does not."""
    wall = concio.wall(length=1.0, height=1.25, block_size=(0.5, 0.25), friction=0.65, horizontal=1.0, block="rigid")
    found = followed(wall).sensitivity()
    bound = concio.limit(wall, path=False, steps=False, search=False, friction=False)
    assert found is not None
    assert found.multiplier < 0.99 * bound.associated.multiplier
    assert bound.sensitivity()["friction of joint"].above > 0.1
    assert found["friction of joint"].rate == pytest.approx(0.0, abs=1e-9)
    assert compare(wall, ("friction of joint", "length of x"))


def test_a_pillar_tips_at_width_over_height() -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=1.0)
    found = followed(pillar).sensitivity()
    assert found is not None
    assert found["length of x"].per_percent[1] == pytest.approx(1.0, abs=1e-9)
    assert found["length of y"].per_percent[1] == pytest.approx(-1.0, abs=1e-9)
    assert found["friction of joint"].rate == pytest.approx(0.0, abs=1e-12)


def test_two_mechanisms_at_once_have_no_derivative() -> None:
    """Two equal pillars beside each other tip at the same load: more of one width changes nothing, less does."""
    ground = concio.Body("ground", ((0, -1), (3, -1), (3, 0), (0, 0)), kind="fixed")
    pillars = [concio.Body(f"p{k}", ((k, 0), (k + 0.5, 0), (k + 0.5, 2), (k, 2)), kind="rigid", material="stone")
               for k in (0, 2)]  # fmt: skip
    loads = (concio.Load("weight", (0, -1)), concio.Load("weight", (1, 0), group="live"))
    both = concio.Model((ground, *pillars), {"stone": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.7)}, loads=loads)
    path = followed(both)
    assert path.collapsed
    assert path.sensitivity() is None


def test_a_path_that_carries_its_loads_has_none() -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=1.0)
    assert concio.run_path(pillar, [STAGES[0], concio.Stage("push", {"live": 0.1})]).sensitivity() is None


@pytest.mark.long
@pytest.mark.parametrize(("language", "words"), first(1, [
        ("it", "termina con un collasso al moltiplicatore 0,25"),
        ("en", "ends in a collapse at the load factor 0.25"),
    ]))  # fmt: skip
def test_the_report_of_a_path_shows_bars(language: str, words: str) -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=1.0)
    assert words in path_html(followed(pillar), language=language)  # type: ignore[arg-type]
