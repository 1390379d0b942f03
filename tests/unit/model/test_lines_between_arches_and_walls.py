"""Lines beside others: extrados of arches, nearest lines of meshes, faces that see each other or do not."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from concio.analysis.continuum.outline import _nearest
from concio.model.generate.arch_on_piers import _extrados
from concio.model.interfaces.detect import detect_interfaces
from concio.model.model import Body


@pytest.mark.parametrize("half", [30.0, 45.0, 60.0, 80.0, 90.0])
@pytest.mark.parametrize("begin", [0, 5, 11])
def test_the_extrados_of_an_arch_is_its_outer_arc_alone(half: float, begin: int) -> None:
    """A ring of 2 m and 2.3 m radius, told from any of its corners, either way round."""
    angle = np.radians(np.linspace(90.0 + half, 90.0 - half, 9))
    arc = np.column_stack([np.cos(angle), np.sin(angle)])
    corners = np.roll(np.vstack([2.3 * arc, 2.0 * arc[::-1]]), begin, axis=0)
    for ring in (corners, corners[::-1]):
        line = shapely.get_coordinates(_extrados(shapely.Polygon(ring)))
        assert np.hypot(*line.T) == pytest.approx(2.3)
        assert len(line) == 9


def test_the_nearest_of_some_lines_is_the_nearest() -> None:
    rng = np.random.default_rng(3)
    known = np.sort(rng.uniform(-1.0, 1.0, 7))
    values = np.concatenate([rng.uniform(-2.0, 2.0, 200), known, [-50.0, 50.0]])
    wanted = known[np.abs(values[:, None] - known).argmin(axis=1)]
    np.testing.assert_array_equal(_nearest(known, values), wanted)


@pytest.mark.parametrize("scale", [2.0**-10, 1.0, 2.0**10])
@pytest.mark.parametrize(("between", "joined"), [(0.0, True), (0.6, False)])
def test_what_stands_between_two_faces_hides_them_at_any_size(scale: float, between: float, joined: bool) -> None:
    """Two blocks 0.008 apart: a plate as high as they are hides one from the other, one beside them does not."""

    def box(name: str, x0: float, x1: float, y0: float, y1: float) -> Body:
        return Body(name, scale * np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), kind="rigid")

    low, high = (-0.1, 1.1) if between else (2.0, 3.0)
    bodies = (box("a", 0, 1, 0, 1), box("b", 1.008, 2, 0, 1), box("plate", 1.002, 1.006, low, high))
    found = detect_interfaces(bodies, tolerance=1e-4 * scale, reach=0.01 * scale)
    pairs = {frozenset((bodies[f.a].name, bodies[f.b].name)) for f in found.interfaces}
    assert (frozenset("ab") in pairs) == joined
