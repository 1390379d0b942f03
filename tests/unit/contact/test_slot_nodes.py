"""Nodes and weights of places on meshed edges, and of corners, gathered for slots of joints."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.contact.coupling import Line
from concio.contact.slots import SlotMaker, _MeshedSlots, _reaching

AT, NODES = np.array([0.0, 0.4, 1.0, 1.5]), np.array([7, 3, 9, 2])


def finder(*, meshed: bool = True) -> SimpleNamespace:
    """Two bodies; the second has an edge, its number 1, of four nodes that are not evenly spaced."""
    shape = SimpleNamespace(edges=[None, SimpleNamespace(at=AT, nodes=NODES)])
    return SimpleNamespace(
        edges=SimpleNamespace(body=np.array([0, 1]), number=np.array([0, 1])), meshed=np.array([False, meshed]),
        disc=SimpleNamespace(shapes=[None, None, shape], shape_of=np.array([-1, 2])), first_node=np.array([0, 100]),
    )  # fmt: skip


PLACED = SimpleNamespace(start=np.array([[0.0, 0.0], [2.0, 1.0]]), tangent=np.array([[1.0, 0.0], [0.6, 0.8]]))


@pytest.mark.parametrize(
    ("along", "nodes", "weights"),
    [
        (-0.3, [107, 103], [1.0, 0.0]), (0.0, [107, 103], [1.0, 0.0]), (0.1, [107, 103], [0.75, 0.25]),
        (0.3, [107, 103], [0.25, 0.75]), (0.85, [103, 109], [0.25, 0.75]), (1.4, [109, 102], [0.2, 0.8]),
        (1.5, [109, 102], [0.0, 1.0]), (9.0, [109, 102], [0.0, 1.0]),
    ],
)  # fmt: skip
def test_a_place_on_an_edge_lies_between_its_two_nodes(along: float, nodes: list[int], weights: list[float]) -> None:
    point = PLACED.start[1] + along * PLACED.tangent[1] + 0.3 * np.array([0.8, -0.6])
    found = SlotMaker._on_edge(finder(), 1, point, PLACED)
    assert found is not None
    assert found[0].tolist() == nodes
    assert found[1] == pytest.approx(weights)
    assert SlotMaker._on_edge(finder(meshed=False), 1, point, PLACED) is None


def test_a_corner_is_the_first_node_of_the_edge_that_starts_there() -> None:
    found = SlotMaker._at_corner(finder(), 1)
    assert found is not None
    assert (found[0].tolist(), found[1].tolist()) == ([107], [1.0])
    assert SlotMaker._at_corner(finder(), 0) is None


def test_sides_of_slots_come_after_those_of_rigid_bodies_and_are_filled_up() -> None:
    """Two corners, of which one lies on an edge of a rigid body; the number of nodes stands for none."""
    slots = _MeshedSlots()
    slots.add_corner((np.array([4, 5]), np.array([0.25, 0.75])), (np.array([8]), np.ones(1)))
    slots.add_corner(None, (np.array([6]), np.ones(1)))
    on_edge, corner = (slots.side(k, 3, 50) for k in (0, 1))
    assert on_edge is not None
    assert corner is not None
    assert on_edge.meshed.tolist() == [False, False, False, True, False]
    assert on_edge.node.tolist() == [[50, 50]] * 3 + [[4, 5], [50, 50]]
    assert on_edge.weight.tolist() == [[0.0, 0.0]] * 3 + [[0.25, 0.75], [0.0, 0.0]]
    assert corner.meshed.tolist() == [False, False, False, True, True]
    assert corner.node.tolist() == [[50]] * 3 + [[8], [6]]
    assert corner.weight.tolist() == [[0.0]] * 3 + [[1.0], [1.0]]
    assert _MeshedSlots().side(0, 3, 50) is None


@pytest.mark.parametrize("first", [-5.0, -1.501, -0.3, 0.0, 0.4, 0.501, 7.0])
def test_a_line_that_slid_past_a_segment_is_moved_onto_its_middle_and_one_that_covers_it_stays(first: float) -> None:
    """A line of 1.5 beside a segment of 1: whichever side it slid past, its end nearest to the middle comes there."""
    line = Line(NODES, first + AT, 1)
    found = _reaching(line, 1.0)
    assert np.diff(found.at) == pytest.approx(np.diff(AT))
    wanted = np.clip(0.5, first, first + 1.5)  # the place of the line that is nearest to the middle
    assert found.at == pytest.approx(line.at + 0.5 - wanted)
