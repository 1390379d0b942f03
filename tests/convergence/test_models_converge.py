"""Settlement of whole models under refinement: a loaded block, a column on its base, a panel with joints.

The work of the loads on the exact displacement (which settlement measures) converges at twice the order of the energy
norm where the solution is smooth; at ends of a strip load and of stuck joints it is limited by the singularity there.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import concio
from concio.model.materials import Elastic
from concio.model.model import Load
from models import box, on_ground

MATERIAL = {"block": Elastic(1e5, 0.25)}


def work(model):
    """Load times displacement, the compliance of the structure [kN m]."""
    result = concio.solve(model)
    return float(result.assembly.load() @ result.displacement)


def orders(values, exact):
    errors = np.abs(np.array(values) - exact)
    return np.log2(errors[:-1] / errors[1:])


def block(element, size):
    """A block on a smooth base under pressure on the middle half of its top."""
    load = Load("pressure", (40.0,), edge=((0.25, 1), (0.75, 1)))
    body = box("b", 0, 1, 0, 1, mesh_size=size)
    return on_ground(body, materials=MATERIAL, law=0.0, loads=(load,), element=element)


@cache
def fine_block():
    return work(block("Q9", 1 / 64))


@pytest.mark.long
@pytest.mark.parametrize("element", ["Q4", "Q4I", "Q9", "T3", "T6"])
def test_block_under_a_strip_load(element):
    """At the ends of the strip the shear strain has a logarithm: the error of the work is of order h^2 log(1/h)."""
    exact = fine_block()
    sizes = np.array([1 / 8, 1 / 16])
    order = orders([work(block(element, h)) for h in sizes], exact)[0]
    law = np.log2(np.divide(*(sizes**2 * np.log(1 / sizes))))
    assert order > law - 0.1


def column(element, size):
    """A column that cannot slide on its base, pressed on top: singular at the two lower corners."""
    load = Load("pressure", (40.0,), edge=((0, 2), (1, 2)))
    body = box("b", 0, 1, 0, 2, mesh_size=size)
    return on_ground(body, materials=MATERIAL, law=5.0, loads=(load,), element=element)


def test_column_on_a_rough_base():
    exact = work(column("Q9", 1 / 24))
    for element in ("Q4", "Q4I"):
        values = [work(column(element, h)) for h in (1 / 2, 1 / 4, 1 / 8)]
        found = orders(values, exact)
        assert found.min() > 1.2
        assert (np.diff(values) > 0).all()  # displacement methods are too stiff, less and less


@pytest.mark.parametrize("joint", [0.0, 0.02])
def test_panel_settlement_converges(joint):
    def settlement(refinement):
        panel = concio.running_bond_panel(
            courses=2, blocks=2, joint=joint, friction=0.6, top_pressure=10.0, refinement=refinement
        )
        return work(panel)

    values = np.array([settlement(k) for k in (1, 2, 4)])
    steps = np.abs(np.diff(values))
    assert steps[1] < 0.6 * steps[0]
    assert steps[0] < 0.02 * values[-1]


def test_non_matching_joints_converge_to_the_same_answer_as_matching_ones():
    """Two blocks, strip load: meshes that do not match against one block of both, glued by high friction and weight."""

    def stack(upper, lower):
        load = Load("pressure", (40.0,), edge=((0.25, 2), (0.75, 2)))
        bodies = (box("a", 0, 1, 0, 1, mesh_size=lower), box("b", 0, 1, 1, 2, mesh_size=upper))
        return work(on_ground(*bodies, materials=MATERIAL, law=3.0, loads=(load,)))

    exact = stack(1 / 32, 1 / 32)
    mixed = [abs(stack(h, 0.7 * h) - exact) for h in (1 / 4, 1 / 8, 1 / 16)]
    assert mixed[1] < 0.45 * mixed[0]
    assert mixed[2] < 0.45 * mixed[1]
