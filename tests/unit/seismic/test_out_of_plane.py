"""A facade drawn in elevation leaves its plane: strips from its drawing and thickness, against closed forms."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import concio
from concio import Assessment, Body, JointLaw, Load, Model, Rigid
from concio.analysis.seismic.open_items import facades_of
from concio.analysis.seismic.out_of_plane import EITHER
from concio.analysis.seismic.sections import OutOfPlane, Strip, strips_of
from concio.errors import InputError
from concio.report.assessment_page import AssessmentReport
from samples import sample
from seismic_walls import ground, overturning, site

ONE = {"direction": "right", "levels": ["SLV"]}


def stones(spans: list[tuple[float, float, float, float]], thickness: float = 0.5) -> list[Body]:
    """Return blocks from (x0, x1, z0, z1)."""
    return [Body(f"s{k}", np.array([[a, low], [b, low], [b, high], [a, high]]), kind="rigid", thickness=thickness)
            for k, (a, b, low, high) in enumerate(spans)]  # fmt: skip


def facade(thickness: float = 0.5, *, window: bool = True, rows: int = 0, friction: float = 0.8, roof: float = 0.0,
           **more: Any) -> Model:
    """Return a wall of 6 x 4 m with a window from x = 2 to 3 and z = 1.5 to 2.5.

    Its courses have equal heights, ``rows`` of them; by default there are three, parted at the window.
    """
    spans = []
    levels = np.linspace(0.0, 4.0, rows + 1).tolist() if rows else [0.0, 1.5, 2.5, 4.0]
    for low, high in itertools.pairwise(levels):
        through = window and low >= 1.5 - 1e-9 and high <= 2.5 + 1e-9
        spans += [(0.0, 2.0, low, high), (3.0, 6.0, low, high)] if through else [(0.0, 6.0, low, high)]
    base = ground(-1, 7)
    loads = [Load("weight", (0.0, -1.0))]
    if roof:
        loads.append(Load("traction", (0.0, -roof / thickness), edge=((0.0, 4.0), (6.0, 4.0)), group="roof"))
    return Model((base, *stones(spans, thickness)), {"block": Rigid(19.0)}, {"joint": JointLaw(friction)},
                 loads=tuple(loads), **more)  # fmt: skip


def drawn(model: Model, held: OutOfPlane | None = None) -> tuple[Strip, ...]:
    """Return the strips of the facades of a model."""
    return strips_of(model, held or OutOfPlane(), facades_of(concio.assemble(model)))


def assessed(model: Model, **more: Any) -> Assessment:
    return concio.assess(model, **{"site": site(), **ONE, **more})


# -- strips -----------------------------------------------------------------------------------------------------------


def test_strips_of_a_facade_with_a_window() -> None:
    found = drawn(facade(rows=8))
    assert [s.name for s in found] == [s.name for s in drawn(facade())]
    told = {s.name: (s.sides, s.base) for s in found}
    assert told == {
        "facade": ((0.0, 6.0), 0.0),
        "pier, x = 0 to 2 m": ((0.0, 2.0), 0.0),
        "pier with openings, x = 0 to 2.5 m": ((0.0, 2.5), 0.0),
        "over opening, x = 2 to 3 m": ((2.0, 3.0), 2.5),
        "pier, x = 3 to 6 m": ((3.0, 6.0), 0.0),
        "pier with openings, x = 2.5 to 6 m": ((2.5, 6.0), 0.0),
    }


@settings(max_examples=sample(3, 8, 25), deadline=None)
@given(st.floats(0.0, 40.0), st.floats(0.2, 1.0), st.booleans(), st.floats(0.5, 3.0))
def test_weights_and_loads_of_strips_are_those_of_the_drawing(
    roof: float, thickness: float, window: bool, gravity: float
) -> None:
    """Two halves hold what the whole holds, and the whole holds what the drawing holds."""
    model = facade(thickness, window=window, roof=roof, rows=8)
    model = replace(model, loads=(Load("weight", (0.0, -gravity)), *model.loads[1:]))

    def total(section: Model) -> float:
        own = sum(section.materials[b.material].unit_weight * b.volume for b in section.free_bodies)
        return own - sum(q.value[1] for q in section.loads if q.at is not None)

    area = 24.0 - (1.0 if window else 0.0)
    strips = {s.name: total(s.section) for s in drawn(model)}
    assert strips["facade"] == pytest.approx(19.0 * gravity * area * thickness + 6.0 * roof, rel=1e-12)
    if window:
        halves = strips["pier with openings, x = 0 to 2.5 m"] + strips["pier with openings, x = 2.5 to 6 m"]
        assert halves == pytest.approx(strips["facade"], rel=1e-12)
        assert strips["pier, x = 0 to 2 m"] == pytest.approx(19 * gravity * 8 * thickness + 2 * roof, rel=1e-12)


def test_stones_that_reach_across_a_cut_are_cut_and_thin_ones_set_the_thickness() -> None:
    model = facade(window=False, rows=8)
    thin = tuple(replace(b, thickness=0.3) if b.name == "s4" else b for b in model.bodies)
    (whole,) = drawn(replace(model, bodies=thin), OutOfPlane(flush="outer"))
    widths = [float(np.ptp(b.vertices[:, 0])) for b in whole.section.free_bodies]
    assert widths == pytest.approx([0.5] * 4 + [0.3] + [0.5] * 3)
    assert len({round(float(b.vertices[:, 0].min()), 12) for b in whole.section.free_bodies}) == 1
    assert not whole.symmetric
    assert drawn(model)[0].symmetric


# -- mechanisms -------------------------------------------------------------------------------------------------------


@pytest.mark.long
@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.floats(0.15, 0.9), st.floats(0.0, 20.0))
@example(0.5, 5e-255)
def test_a_wall_overturns_at_its_thickness_over_its_height(thickness: float, roof: float) -> None:
    """Free at its top: alpha_0 = (W + N) t/2 / (W h/2 + N h), of the whole as of each strip of the full height."""
    found = assessed(facade(thickness, window=False, roof=roof))
    W, N = 19.0 * 4.0 * thickness, roof
    exact = (W + N) * thickness / 2 / (W * 2.0 + N * 4.0)
    (strip,) = found.strips
    assert strip.multiplier == pytest.approx(exact, rel=1e-9)
    assert strip.worst is not None
    assert strip.worst.direction == EITHER
    assert found.zeta <= strip.zeta
    assert all(c.agrees for c in found.hand_checks)


@pytest.mark.long
def test_a_wall_held_at_its_top_bends_between_foot_and_top() -> None:
    """alpha_0(h1) = 2 [(W + N) t / h1 + N t/2 / (h - h1)] / W, at the best of the joints."""
    N, t, h, rows = 20.0, 0.5, 4.0, sample(6, 8, 16)
    found = assessed(facade(t, window=False, roof=N, rows=rows), out_of_plane={"held": [4.0]})
    W = 19.0 * h * t
    exact = min(2 * ((W + N) * t / h1 + N * t / 2 / (h - h1)) / W for h1 in np.arange(1, rows) * h / rows)
    (strip,) = found.strips
    assert strip.multiplier == pytest.approx(exact, rel=1e-9)
    assert strip.motions[0] == "bending"
    assert any("held in both senses at 4 m" in line for line in found.verdict.limits)


@pytest.mark.long
def test_the_section_gives_what_the_same_wall_gives_when_drawn_as_a_section() -> None:
    """The worked example of an overturning wall, drawn in elevation: the same alpha_0 and zeta_E."""
    plain = overturning(4)
    wall = concio.assess(replace(plain, loads=plain.loads[:1]), site=site(), direction="left", levels=["SLV"])
    spans = [(0.0, 3.0, 1.5 * k, 1.5 * (k + 1)) for k in range(4)]
    drawn = Model((ground(-1, 4), *stones(spans, 0.6)), {"block": Rigid(19.0)}, {"joint": JointLaw(0.8)},
                  loads=(Load("weight", (0.0, -1.0)),))  # fmt: skip
    strip = assessed(drawn).strips[0]
    assert strip.worst is not None
    assert wall.worst is not None
    assert strip.worst.multiplier == pytest.approx(wall.worst.multiplier, rel=1e-9)
    assert strip.zeta == pytest.approx(wall.zeta, rel=1e-6)


@pytest.mark.long
def test_a_bearing_near_the_inner_face_tells_the_senses_apart() -> None:
    found = assessed(facade(0.5, window=False, roof=30.0), out_of_plane=OutOfPlane(bearing=0.1))
    own = {m.direction: m.multiplier for m in found.strips[0].mechanisms if ";" not in m.name}
    W, N = 19.0 * 4.0 * 0.5, 30.0
    push = W * 2.0 + N * 4.0
    assert own["inward"] == pytest.approx((W * 0.25 + N * 0.1) / push, rel=1e-9)
    assert own.get("outward", math.inf) == pytest.approx((W * 0.25 + N * 0.4) / push, rel=1e-9)


# -- what is told -----------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_the_least_of_plane_and_strips_decides_and_each_is_reported() -> None:
    found = assessed(facade(0.25))
    assert not any("out of its plane" in line for line in found.verdict.unchecked)
    assert found.worst is not None
    assert found.worst.section is not None
    assert found.zeta == min(s.zeta for s in found.strips)
    zetas = [s.zeta for s in found.strips]
    assert zetas == sorted(zetas)
    row = next(c for c in found.covered if c.kind == "strips")
    assert row.there == row.sought == 6
    like = {s.strip.name: s.like for s in found.strips if s.like}
    assert set(like.values()) <= {s.strip.name for s in found.strips}
    assert set(like) == {"pier, x = 3 to 6 m"} or set(like) == {"pier, x = 0 to 2 m"}
    assert found.summary()["strips"][0]["zeta_E"] == found.strips[0].zeta
    for language, word in (("en", "Out of the plane"), ("it", "Fuori dal piano")):
        page = AssessmentReport(found, language=language).html()
        assert word in page
        assert ("out of plane" in page.lower()) == (language == "en")
        aside = {"en": "out of plane", "it": "fuori dal piano"}[language]
        assert not any(aside in title for title in re.findall(r"class=brief[^>]*><h3>([^<]*)", page))
        start = page.index("<section id=search>")
        assert page.count(f">{aside}:", start, page.index("</section>", start)) <= 2  # those that decide
    assert sum("ratio of accelerations" in line for line in found.verdict.limits) <= 1


@pytest.mark.long
def test_left_to_the_author_or_pushed_by_a_group_it_is_not_searched() -> None:
    plain = facade(window=False, rows=2)
    assert not assessed(plain, elsewhere=["out of plane"]).strips
    pushed = replace(plain, loads=(Load("weight", (0, -1.0)), Load("weight", (1.0, 0), group="live")))
    found = assessed(pushed, live="live")
    assert not found.strips
    assert any("out of its plane" in line for line in found.verdict.unchecked)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"held": [9.0]}, "held at 9 m"),
        ({"flush": "left"}, "no face 'left'"),
        ({"bearing": 0.7}, "bear 0.7 m from the inner face"),
        ({"bearing": -1.0}, "must lie inside the wall"),
        ({"hold": [1.0]}, "key of out_of_plane 'hold'"),
    ],
)
def test_what_is_refused(given: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        assessed(facade(roof=5.0), out_of_plane=given)


def test_a_section_has_nothing_out_of_its_plane() -> None:
    with pytest.raises(InputError, match="facade drawn in elevation"):
        concio.assess(overturning(), site=site(), out_of_plane={"held": [3.0]}, levels=["SLV"])
