"""Lines of thrust, hinges and course resultants against statics by hand."""

from __future__ import annotations

import numpy as np
import pytest

from concio.analysis.step import solve
from concio.analysis.thrust import course_resultants, hinges, thrust_line
from concio.errors import InputError
from concio.model.generate.arches import arch
from concio.model.generate.walls import wall


@pytest.fixture(scope="module")
def ring():
    return solve(arch(span=4.0, ring=0.45, voussoirs=15, friction=0.8))


def test_thrust_line_of_an_arch(ring):
    line = thrust_line(ring)
    assert len(line.joint) == 16
    assert (np.diff(line.point[:, 0]) > 0).all()
    assert np.abs(line.eccentricity).max() < 0.5
    assert line.eccentricity == pytest.approx(line.eccentricity[::-1], abs=1e-6)  # the arch is symmetric
    # the horizontal thrust is the same everywhere; the vertical one falls by the weight of each voussoir
    assert line.force[:, 0] == pytest.approx(line.force[0, 0], rel=1e-9)
    weights = [b.area * b.thickness * 20.0 for b in ring.model.free_bodies]
    assert -np.diff(line.force[:, 1]) == pytest.approx(weights, rel=1e-6)
    assert line.force[0] == pytest.approx(
        ring.reactions[ring.model.bodies[int(ring.joints.body_a[line.joint[0]])].name]
    )


def test_thrust_polygon_closes(ring):
    """Each voussoir is in moment equilibrium: resultants of its joints and its weight meet in a point."""
    line = thrust_line(ring)
    centroids = sorted((b.centroid for b in ring.model.free_bodies), key=lambda c: c[0])

    def cross(a, b):
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]

    arm_in, arm_out = line.point[:-1] - centroids, line.point[1:] - centroids
    moment = cross(arm_in, line.force[:-1]) - cross(arm_out, line.force[1:])
    assert np.abs(moment).max() <= 1e-6 * np.abs(line.force).max()


def test_hinges_of_a_thin_arch():
    """A little above the least thickness (t / R = 0.1075) the thrust runs close to the edges, at the crown too."""
    assert hinges(solve(arch(span=4.0, ring=0.8, voussoirs=15, friction=0.8))) == []
    thin = solve(arch(span=2.0 * (1 - 0.056), ring=0.112, voussoirs=30, friction=3.0))
    found = hinges(thin, tolerance=0.1)
    assert len(found) >= 3
    assert "hinge between" in str(found[0])
    assert any(abs(h.at[0]) < 0.05 for h in found)
    for h in found:
        assert abs(h.eccentricity) <= 0.5 + 1e-9
        assert h.normal_force > 0


def test_course_resultants_of_a_pushed_wall():
    """Above each joint a block of masonry of weight w (h - y), pushed by a fifth of it at mid-height."""
    result = solve(wall(length=2.0, height=1.0, block_size=(0.4, 0.2), horizontal=0.2, friction=0.65, mesh_size=0.2))
    found = course_resultants(result)
    assert found.level == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8], abs=1e-12)
    above = 2.0 * (1.0 - found.level) * 20.0
    assert found.force[:, 1] == pytest.approx(above, rel=1e-9)
    assert found.force[:, 0] == pytest.approx(-0.2 * above, rel=1e-9)
    assert found.position == pytest.approx(1.0 + 0.2 * (1.0 - found.level) / 2, rel=1e-9)
    assert found.extent == pytest.approx(np.tile([0.0, 2.0], (5, 1)), abs=1e-12)


def test_a_wall_has_no_line_of_thrust():
    result = solve(wall(length=1.0, height=0.5, mesh_size=0.25))
    with pytest.raises(InputError, match="do not form a chain"):
        thrust_line(result)
