"""Candidates for contact: corners within two skins of an edge, however the edge is turned."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.motion.state import MotionState
from concio.contact.candidates import find_candidates
from concio.contact.reference import Reference
from models import model_of, weight


@pytest.mark.parametrize("turn", [0.0, 30.0, 80.0])
@pytest.mark.parametrize("skin", [0.05, 0.4])
@pytest.mark.parametrize(("skins", "met"), [(0.5, True), (0.95, True), (1.9, None), (2.1, False), (9.0, False)])
def test_a_corner_is_a_candidate_up_to_two_skins(turn: float, skin: float, skins: float, met: bool | None) -> None:
    """Of a block that points at a slope; between one skin and two an edge is looked at where its box is near."""
    c, s = np.cos(np.deg2rad(turn)), np.sin(np.deg2rad(turn))
    turned, d = np.array([[c, s], [-s, c]]), skins * skin
    slope = concio.Body("slope", np.array([[-5, -1], [5, -1], [5, 0], [-5, 0]]) @ turned, kind="fixed")
    points = concio.Body(
        "block", np.array([[0, d], [0.3, d + 0.7], [0, d + 1.4], [-0.3, d + 0.7]]) @ turned, kind="rigid",
        material="stone",
    )  # fmt: skip
    reference = Reference.of(model_of(slope, points, law=0.5, loads=(weight(),)), 9.81)
    placed = reference.edges.placed(MotionState.at_rest(reference).placement)
    found = find_candidates(reference.edges, placed, skin)
    near = [placed.start[k] for k, e in zip(found.corner, found.edge, strict=True) if reference.edges.body[e] == 0]
    assert not len(found.edge_a)
    wanted = met if met is not None else turn != 0.0
    assert len(near) == wanted
    assert all(at == pytest.approx(points.vertices[0], abs=1e-12) for at in near)
