"""What acts on a strip of a facade and where its faces lie, from rectangles and loads that are known."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import shapely

from concio.analysis.seismic.sections import _Facade


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
