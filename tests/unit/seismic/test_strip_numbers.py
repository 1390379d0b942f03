"""What acts on a strip of a facade and where its faces lie, from rectangles and loads that are known."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import shapely

from concio import JointLaw, Load, Rigid
from concio.analysis.seismic.sections import Strip, _Facade
from models import box, model_of


def facade(**known: object) -> SimpleNamespace:
    return SimpleNamespace(size=10.0, high=(8.0, 6.0), **known)


@pytest.mark.parametrize(("flush", "faces"), [("outer", (-0.3, 0.1)), ("inner", (-0.1, 0.3)), ("middle", (-0.2, 0.2))])
def test_a_thinner_course_is_flush_with_the_face_asked_for(flush: str, faces: tuple[float, float]) -> None:
    """0.4 m thick in a wall of 0.6 m, about its middle plane."""
    assert _Facade._faces(SimpleNamespace(held=SimpleNamespace(flush=flush)), 0.4, 0.6) == pytest.approx(faces)


def test_loads_on_a_strip_are_its_share_of_their_length() -> None:
    """Lines of 4 m over the strip from 2 to 5 m, points at its edges, and what lies above or below it."""
    loads = [
        (0, 3.0, 7.0, 4.0, 12.0),  # half of it
        (0, 0.0, 2.0, 4.0, 50.0),  # none of it
        (0, 1.0, 5.0, 4.0, 8.0),  # three quarters
        (0, 3.0, 4.0, 6.0000001, 5.0),  # at the top, but for rounding
        (0, 3.0, 4.0, 6.1, 99.0), (0, 3.0, 4.0, 0.9, 99.0),
        (0, 2.0, 2.0, 2.0, 1.0), (0, 5.0, 5.0, 2.0, 30.0), (0, 4.9, 4.9, 2.0, 2.0),
    ]  # fmt: skip
    found = _Facade._down(facade(loads=loads), 2.0, 5.0, 1.0, 6.0)
    assert [z for z, _ in found] == pytest.approx([2.0, 4.0, 6.0])
    assert [force for _, force in found] == pytest.approx([3.0, 12.0, 5.0])
    last = _Facade._down(facade(loads=[(0, 8.0, 8.0, 2.0, 7.0), (0, 8.1, 8.1, 2.0, 9.0)]), 5.0, 8.0, 1.0, 6.0)
    assert last == [(2.0, 7.0)], "the end of a wall belongs to its last strip"


def test_a_course_has_the_area_and_weight_of_its_bodies_and_the_least_thickness_of_its_main_ones() -> None:
    """Over 2 x 1 m: 1.2 m2 of 0.5 m and 20 kN/m3, 0.6 m2 of 0.3 m and 18 kN/m3, 0.02 m2 of a sliver of 0.1 m."""
    shapes = {
        0: shapely.box(0.0, 0.0, 1.2, 1.0), 1: shapely.box(1.2, 0.0, 1.8, 1.0), 2: shapely.box(1.8, 0.0, 1.82, 1.0),
        3: shapely.box(0.0, 1.0, 9.0, 2.0),
    }  # fmt: skip
    outlines = [SimpleNamespace(thickness=t) for t in (0.5, 0.3, 0.1, 0.05)]
    own = facade(shapes=shapes, model=SimpleNamespace(outlines=outlines), weights={0: 20.0, 1: 18.0, 2: 22.0, 3: 99.0})
    thick, area, weight = _Facade._course(own, 0.0, 2.0, 0.0, 1.0)
    assert area == pytest.approx(1.82)
    assert weight == pytest.approx(1.2 * 0.5 * 20.0 + 0.6 * 0.3 * 18.0 + 0.02 * 0.1 * 22.0)
    assert thick == 0.3
    assert _Facade._course(own, 3.0, 4.0, 0.0, 1.0) is None


def strip(width: float, *, upper: float = 1.0, unit_weight: float = 20.0, load: float = 3.0, at: float = 0.0,
          cap: float | None = None, shift: float = 0.0) -> Strip:  # fmt: skip
    """Two courses 0.5 m thick and a load per metre of the strip's width."""
    low = box("low", -0.25, 0.25, 0.0, 1.0, kind="rigid", material="stone", thickness=width)
    high = box("high", -0.25 + shift, 0.25 + shift, 1.0, 1.0 + upper, kind="rigid", material="heavy", thickness=width)
    ground = box("ground", -1.0, 1.0, -0.5, 0.0, kind="fixed", thickness=width)
    section = model_of(
        ground, low, high, law=JointLaw(0.6, compressive_strength=cap),
        materials={"heavy": Rigid(unit_weight)},
        loads=(Load("point", (0.0, -load * width), bodies=("high",), at=(at, 1.5)),),
    )  # fmt: skip
    return Strip("pier", (2.0, 2.0 + width), 0.0, section)


def test_strips_that_differ_in_width_alone_are_alike_unless_their_joints_crush() -> None:
    one = strip(1.0).likeness
    assert strip(2.5).likeness == one
    for other in ({"upper": 1.2}, {"unit_weight": 21.0}, {"load": 3.1}, {"at": 0.1}, {"shift": 0.01}):
        assert strip(1.0, **other).likeness != one, other
        assert strip(2.5, **other).likeness == strip(1.0, **other).likeness
    assert strip(1.0, cap=500.0).likeness != strip(2.5, cap=500.0).likeness
    weights = strip(1.0, upper=1.5, unit_weight=30.0).likeness[8:10]  # 10 kN and 22.5 kN
    assert weights == pytest.approx((10.0 / 32.5, 22.5 / 32.5))


def test_a_section_is_its_own_mirror_image_where_nothing_lies_aside() -> None:
    assert strip(1.0).symmetric
    assert not strip(1.0, at=1e-3).symmetric
    assert not strip(1.0, at=-1e-3).symmetric
    assert not strip(1.0, shift=1e-3).symmetric
    assert strip(1.0).name == "pier, x = 2 to 3 m"
    assert Strip("facade", (0.0, 3.0), 0.0, strip(1.0).section, of="c1").name == "facade of 'c1'"
