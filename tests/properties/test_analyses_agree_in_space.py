"""Load step, limit and path of blocks in space that stand on edges or on feet that tilt say the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid
from concio.model.polyhedron import BOX

FACES = ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0))
TILT = 1e-4
STAGES = [concio.Stage("dead", {"dead": 1.0}), concio.Stage("live", {"live": 1.0})]


def made(*bodies: Polyhedron, push: float) -> Model:
    loads = (Load("weight", (0, 0, -1)), Load("weight", (push, 0, 0), group="live"))
    return Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.6)}, loads=loads)


def knife_edge(push: float) -> Model:
    """A beam on a flat bearing and a knife edge across it."""
    corners = [(3.8, -1, 0.5), (4.2, -1, 0.5), (4, -1, 1), (3.8, 2, 0.5), (4.2, 2, 0.5), (4, 2, 1)]
    prism = Polyhedron("k", np.array(corners, dtype=float), FACES, kind="fixed")
    bearing = Polyhedron.box("s", (-0.5, 0, 0), (0.2, 1, 1), kind="fixed")
    return made(bearing, prism, Polyhedron.box("beam", (0, 0, 1), (4.5, 1, 1.3), kind="rigid"), push=push)


def tilted_cube(push: float) -> Model:
    """A cube of 1 m whose foot tilts by 0.1 mm."""
    foot = Polyhedron.box("b", (0, 0, 0), (1, 1, 1))
    lifted = foot.vertices + np.outer(TILT * foot.vertices[:, 0] * (foot.vertices[:, 2] == 0), [0, 0, 1])
    cube = Polyhedron("b", lifted, BOX, kind="rigid")
    return made(Polyhedron.box("g", (-5, -5, -1), (5, 5, 0), kind="fixed"), cube, push=push)


CASES = {"knife edge": (knife_edge, 0.6), "tilted cube": (tilted_cube, 0.6)}
"""What slides at the friction of its joints, long before it tips."""


@pytest.mark.parametrize("share", [0.97, 1.03])
@pytest.mark.parametrize("name", CASES)
def test_step_and_limit_agree(name: str, share: float) -> None:
    model, critical = CASES[name][0](share * CASES[name][1]), CASES[name][1]
    holds = share < 1
    step = concio.solve(model, on_failure="return")
    assert step.verdict.holds == holds, step.sentence
    bound = concio.limit(model, path=False, steps=False, search=False).associated.multiplier
    assert (bound >= 1) == holds
    steepest = np.tan(np.arctan(critical) + TILT * (name == "tilted cube"))  # of either face, or of a plane between
    assert critical * (1 - 1e-6) <= bound * share * critical <= steepest * (1 + 1e-6)
    alone = replace(model, loads=model.loads[:1])
    assert concio.solve(alone).verdict.holds


PUSHED = [concio.Stage("dead", {"dead": 1.0}, steps=2), concio.Stage("live", {"live": 1.0}, steps=6)]


def test_the_path_of_a_tilted_cube_ends_where_slip_begins_by_less_than_rounding_in_small_steps() -> None:
    """At 0.61 of the load two corners begin to slip by 1e-12 m: steps that are halved do not see it, whole ones do."""
    path = concio.run_path(tilted_cube(0.97 * 0.6), PUSHED, progress=lambda done: done.iteration > 100)
    assert path.verdict.holds, "cancelled: halved again and again for a change that halving does not find"


@pytest.mark.long
def test_the_path_of_a_tilted_cube_ends_where_it_slides() -> None:
    path = concio.run_path(tilted_cube(1.03 * 0.6), STAGES)
    assert path.verdict.outcome.value == "fails"
    steepest = np.tan(np.arctan(0.6) + TILT)
    assert 0.6 * (1 - 1e-4) <= 1.03 * 0.6 * path.steps[-1].factors["live"] <= steepest * (1 + 1e-6)


@pytest.mark.long
def test_a_path_over_a_knife_edge_ends_where_the_load_step_does() -> None:
    assert concio.run_path(knife_edge(0.97 * 0.6), STAGES).verdict.holds
    # what slides has no next state: the path may say that it was lost there, never that it was carried
    assert concio.run_path(knife_edge(1.03 * 0.6), STAGES).verdict.outcome.value in ("fails", "undecided")
