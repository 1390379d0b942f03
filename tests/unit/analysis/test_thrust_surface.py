"""Where forces pass through joints in space: statics of one block, the line of thrust of an extruded arch."""

from __future__ import annotations

import numpy as np
import pytest

import concio

STONE = {"stone": concio.Rigid(unit_weight=2.0)}


def pushed(along: float, across: float) -> concio.Result:
    """A block 2 x 1 x 1 on the ground, pushed in both directions by shares of its weight."""
    bodies = (
        concio.Polyhedron.box("ground", (-3.0, -3.0, -1.0), (3.0, 3.0, 0.0), kind="fixed"),
        concio.Polyhedron.box("block", (-1.0, -0.5, 0.0), (1.0, 0.5, 1.0), kind="rigid", material="stone"),
    )
    load = concio.Load("weight", (along, across, -1.0))
    return concio.solve(concio.Model(bodies, STONE, {"joint": concio.JointLaw(1.2)}, loads=(load,)))


@pytest.mark.parametrize(("along", "across"), [(0.0, 0.0), (0.3, 0.2), (-0.1, 0.4)])
def test_force_of_one_joint_by_statics(along: float, across: float) -> None:
    """The resultant of weight and push from the centroid, half a block up, meets the ground at half their shares."""
    found = concio.thrust_surface(pushed(along, across))
    assert found.bodies == (("ground", "block"),)
    assert found.point[0] == pytest.approx([0.5 * along, 0.5 * across, 0.0], abs=1e-9)
    assert found.force[0] == pytest.approx([-4.0 * along, -4.0 * across, 4.0], abs=1e-9)
    edge = min(1.0 - 0.5 * abs(along), 0.5 - 0.5 * abs(across))
    assert found.to_edge[0] == pytest.approx(edge, abs=1e-9)
    assert found.depth[0] == pytest.approx(edge / 0.5, abs=1e-9)
    assert found.obliquity[0] == pytest.approx(np.hypot(along, across), abs=1e-9)
    assert not found.hinges.size


def test_about_to_turn_over_an_edge() -> None:
    found = concio.thrust_surface(pushed(0.1, 0.985))
    assert found.hinges.tolist() == [0]


def test_an_extruded_arch_has_its_line_of_thrust() -> None:
    arch = concio.arch(span=4.0, ring=0.6, voussoirs=9, block="rigid", friction=0.6)
    line = concio.thrust_line(concio.solve(arch))
    surface = concio.thrust_surface(concio.solve(concio.extrude(arch, 0.7)))
    assert len(surface.joint) == len(line.joint)
    for point in surface.point:
        assert np.abs(line.point - point[[0, 2]]).max(axis=1).min() < 1e-9
    assert np.abs(surface.point[:, 1] - surface.point[0, 1]).max() < 1e-9
    with pytest.raises(concio.InputError, match="thrust surface is for models in space"):
        concio.thrust_surface(concio.solve(arch))
