"""Joints that bend without a normal force, and ties among the contact pairs: what tables say closes every block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from models import box, mapped

MORTAR = concio.JointLaw(0.6, cohesion=500.0, tensile_strength=400.0)


def bracket(kind):
    """A block of 6 kN that is glued to the side of a wall, its centroid 0.5 m beside it."""
    wall = box("wall", -1, 0, 0, 1, kind="fixed", thickness=0.5)
    block = box("block", 0, 1, 0.2, 0.8, kind=kind, thickness=0.5)
    material = concio.Rigid(20.0) if kind == "rigid" else concio.Elastic(1e6, 0.2, 20.0)
    return concio.Model((wall, block), {"block": material}, {"joint": MORTAR}, loads=(concio.Load("weight", (0, -1)),))


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("side", [1, -1])
def test_a_bracket_bends_its_joint(kind, side):
    model = mapped(bracket(kind), lambda x: x * [side, 1], lambda v: v * [side, 1], side)
    table = concio.solve(model).tables.joints()
    on_block = 1 if table["body_b"][0] == "block" else -1
    assert on_block * table["shear_y"][0] == pytest.approx(6.0)
    assert on_block * table["moment"][0] == pytest.approx(side * 3.0)
    assert table["area"][0] == pytest.approx(0.3)
    assert np.isnan(table["eccentricity"][0])
    assert (table["at_x"][0], table["at_y"][0]) == (table["x"][0], table["y"][0])


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_so_it_does_in_space(kind):
    model = concio.extrude(replace(bracket(kind), element=""), 0.5)
    joints = concio.solve(model).joints_in_space
    np.testing.assert_allclose(joints.M[0], [0, -3.0, 0], atol=1e-9)
    np.testing.assert_array_equal(joints.point, joints.middle)


def closed(result, block):
    """Resultant of joints, ties and weight on a block, and its moment about the origin, from the tables alone."""
    tables, total = result.tables.all(), np.zeros(3)

    def add(force, at, moment=0.0):
        total[:] += [*force, at[0] * force[1] - at[1] * force[0] + moment]

    joints = tables["joints"]
    for values in zip(*joints.values(), strict=True):
        row = dict(zip(joints, values, strict=True))
        for name, sign in ((row["body_b"], 1), (row["body_a"], -1)):
            if name == block:
                force = [row["normal_force"] * row[f"n_{k}"] + row[f"shear_{k}"] for k in "xy"]
                add(sign * np.array(force), (row["x"], row["y"]), sign * row["moment"])
    for tie, fx, fy in zip(result.model.ties, *(tables["ties"][f"force_{k}"] for k in "xy"), strict=True):
        if tie.body_a == block:
            add((fx, fy), tie.at_a)
    k = list(tables["bodies"]["body"]).index(block)
    add((0, -20.0 * tables["bodies"]["volume"][k]), (tables["bodies"]["x"][k], tables["bodies"]["y"][k]))
    return total


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_tables_close_a_block_that_a_tie_holds(kind):
    tie = concio.Tie("rod", "block", (0.7, 0.6), "", (-1.0, 2.0), 2e3, 1.0)
    result = concio.solve(replace(bracket(kind), ties=(tie,)))
    np.testing.assert_allclose(closed(result, "block"), 0.0, atol=1e-9)
    contacts = result.tables.contacts()
    row = contacts["law"] == "tie"
    assert contacts["interface"][row].tolist() == [-1]
    assert contacts["normal_force"][row] == result.ties.tension
    for column in ("area", "pressure", "shear"):
        assert np.isnan(contacts[column][row]).all()
        assert np.isfinite(contacts[column][~row]).all()
