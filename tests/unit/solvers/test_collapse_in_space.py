"""Coulomb collapse states in space: blocks known by hand, the plane extruded, a corner that slides apart."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid
from concio.contact.assembly import assemble
from concio.problem.tolerances import CONE_TARGET
from concio.solvers.statics import collapse_search, cone_statics
from concio.solvers.statics.collapse_cones import forces_in_space
from concio.solvers.statics.collapse_search import CollapseSearch, find_collapse_state
from concio.solvers.statics.collapse_state import certify_collapse
from concio.solvers.statics.cone_interior import ConeAnswer
from concio.solvers.statics.cone_statics import ConeStatics


def search(model: Model, **options: Any) -> CollapseSearch:
    assembly = assemble(model)
    dead = assembly.problem({"live": 0.0})
    return find_collapse_state(dead, assembly.problem({"live": 1.0}).f - dead.f, **options)


def block(law: JointLaw, push: tuple[float, float]) -> Model:
    """Return a block of 0.4 x 0.6 x 1.0 m and 4.8 kN on a plane."""
    ground = Polyhedron.box("ground", (-1, -1, -0.2), (2, 2, 0), kind="fixed")
    body = Polyhedron.box("body", (0, 0, 0), (0.4, 0.6, 1.0), kind="rigid")
    loads = (Load("weight", (0, 0, -1)), Load("weight", (*push, 0), group="live"))
    return Model((ground, body), {"block": Rigid(20.0)}, {"joint": law}, loads=loads, contact_points="corners")


@pytest.mark.parametrize(
    ("law", "push", "wanted"),
    [
        (JointLaw(0.3), (1.0, 0.0), 0.3),  # slides
        (JointLaw(0.3), (0.6, 0.8), 0.3),  # slides askew: the cone is round
        (JointLaw(0.9), (1.0, 0.0), 0.4),  # topples over its long edge
        (JointLaw(0.9), (0.0, 1.0), 0.6),  # over its short one
        (JointLaw(0.9), (0.6, 0.8), 0.4 / 0.6),  # over the long one again: 0.2 W = 0.5 (0.6 alpha W)
        (JointLaw(0.3, cohesion=2.0), (0.6, 0.8), 0.3 + 2.0 * 0.24 / 4.8),  # slides
        (JointLaw(0.9, cohesion=5.0, tensile_strength=2.0), (1.0, 0.0), 0.4 + 2 * 0.12 * 0.4 / (4.8 * 0.5)),  # two tear
        (JointLaw(0.9, compressive_strength=60.0), (1.0, 0.0), (7.2 * 0.4 - 4.8 * 0.2) / (4.8 * 0.5) - 0.4),
    ],
)
def test_one_block(law: JointLaw, push: tuple[float, float], wanted: float) -> None:
    """With a cap of 3.6 kN at each corner the toe carries 7.2 at most, more than the weight: the last is 0.4 too."""
    found = search(block(law, push), starts=1, iterations=4).state
    assert found is not None
    assert found.certified
    assert found.multiplier == pytest.approx(wanted, rel=1e-7)


def test_a_toe_that_crushes() -> None:
    """The corners carry 1.8 kN: two at the toe 3.6, the heel 1.2; (3.6 - 1.2) 0.2 = 4.8 alpha 0.5."""
    found = search(block(JointLaw(0.9, compressive_strength=30.0), (1.0, 0.0)), starts=1, iterations=6).state
    assert found is not None
    assert found.multiplier == pytest.approx((3.6 - 1.2) * 0.2 / (4.8 * 0.5), rel=1e-7)
    assert found.velocity[2] < 0


@pytest.mark.long
def test_pressure_over_many_points_is_spread_in_load_steps_and_free_in_bounds() -> None:
    """Torsion of a square joint, side a: 0.382598 mu N a under uniform pressure, mu N a / sqrt(2) at its corners."""
    ground = Polyhedron.box("ground", (-5, -5, -1), (5, 5, 0), kind="fixed")
    body = Polyhedron.box("body", (0, 0, 0), (1, 1, 0.5), kind="rigid")
    couple = [Load("point", (0, s, 0), ("body",), at=(x, 0.5, 0), group="live") for x, s in ((1.0, 1.0), (0.0, -1.0))]
    loads = (Load("weight", (0, 0, -1)), *couple)
    laws = {"joint": JointLaw(0.5)}
    model = Model((ground, body), {"block": Rigid(20.0)}, laws, loads=loads, contact_points=6)
    found = concio.limit(model, steps=True, search=False)
    assert found.associated.multiplier == pytest.approx(0.5 * 10 / np.sqrt(2), rel=1e-8)
    assert found.carried == pytest.approx(0.382598 * 0.5 * 10, rel=0.05)
    state = search(model, starts=1, iterations=2).state  # its programme meets a border without any part in the motion
    assert state is not None
    assert 0 < state.multiplier < found.carried


def test_a_motion_that_is_no_collapse_is_not_certified() -> None:
    assembly = assemble(block(JointLaw(0.9), (1.0, 0.0)))
    dead = assembly.problem({"live": 0.0})
    live = assembly.problem({"live": 1.0}).f - dead.f
    slides = np.array([1.0, 0, 0, 0, 0, 0])
    assert certify_collapse(dead, live, slides, 0) is None  # slides at 0.9, topples at 0.4
    assert certify_collapse(dead, live, np.roll(-slides, 2), 0) is None  # sinks


def test_the_plane_extruded_has_its_states() -> None:
    plane = concio.wall(length=1.2, height=0.6, block_size=(0.4, 0.2), friction=0.35, block="rigid", horizontal=1.0)
    flat = search(plane, starts=1)
    solid = search(concio.extrude(plane, 0.3), starts=1, iterations=8)
    assert flat.state is not None
    assert solid.state is not None
    assert solid.state.multiplier == pytest.approx(flat.state.multiplier, rel=1e-6)


def test_a_corner_slides_apart_before_its_associated_bound() -> None:
    """Two walls bonded at a corner, pushed across: friction without dilatancy holds less than the bound."""
    model = concio.walls(
        lines=[((0, 0), (0, 2)), ((0, 0), (1.5, 0))], height=0.75, block_size=(0.5, 0.25, 0.25), block="rigid",
        friction=0.6, horizontal=1.0, towards=(-1, 0),
    )  # fmt: skip
    found = concio.limit(model, path=False, steps=False, search=False)
    state = search(model, starts=1, iterations=8).state
    assert state is not None
    assert state.certified
    assert state.multiplier < 0.97 * found.associated.multiplier
    assembly = assemble(model)
    stands = concio.solve(assembly, factors={"live": 0.9 * state.multiplier}, on_failure="return")
    assert stands.solved  # another engine, another method


def test_limit_draws_its_motions_in_space() -> None:
    found = concio.limit(block(JointLaw(0.9), (1.0, 0.0)), path=False, steps=False, search=True)
    assert found.collapse_state is not None
    assert found.plot.collapse_state().figure is not None


@pytest.mark.parametrize("push", [(1.0, 0.0), (0.6, 0.8)])
def test_a_mechanism_of_a_programme_has_the_largest_entry_one(push: tuple[float, float]) -> None:
    assembly = assemble(block(JointLaw(0.9), push))
    dead = assembly.problem({"live": 0.0})
    found = ConeStatics(dead).largest(assembly.problem({"live": 1.0}).f - dead.f)
    assert np.abs(found.velocity).max() == pytest.approx(1.0, abs=1e-15)


@pytest.mark.long  # the corner below slides by them
def test_programmes_with_frozen_strength_end_where_their_digits_are_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same state of a dry corner as from programmes solved to their last digits, with fewer steps of them."""
    model = concio.walls(
        lines=[((0, 0), (0, 1.5)), ((0, 0), (1.5, 0))], height=1.5, block_size=(0.75, 0.25, 0.5), block="rigid",
        friction=0.5, horizontal=1.0, towards=(-1, 0),
    )  # fmt: skip
    steps, found = list[int](), list[CollapseSearch]()
    whole = cone_statics.maximise
    for target in (collapse_search.FROZEN_TARGET, CONE_TARGET):
        answers = list[ConeAnswer]()
        monkeypatch.setattr(collapse_search, "FROZEN_TARGET", target)
        monkeypatch.setattr(cone_statics, "maximise", lambda *a, **k: answers.append(whole(*a, **k)) or answers[-1])  # noqa: B023
        found.append(search(model, starts=1))
        steps.append(sum(one.iterations for one in answers))
    early, late = (one.state for one in found)
    assert early is not None
    assert late is not None
    assert early.certified
    assert early.multiplier == pytest.approx(late.multiplier, rel=1e-8)
    assert steps[0] < steps[1]


def test_what_is_pulled_open_and_does_not_slip_holds_sideways_by_what_is_left_of_its_strength() -> None:
    """Pulled by its tensile strength T on 0.8 m2, a glued joint still holds (c - mu T) A to the side, either way."""
    ground = Polyhedron.box("ground", (-1, -1, -0.5), (2, 2, 0), kind="fixed")
    body = Polyhedron.box("body", (0, 0, 0), (1.0, 0.8, 1.0), kind="rigid")
    pulled = Load("body", (0, 0, 20.0))
    side = Load("point", (1.0, 0, 0), group="live", bodies=("body",), at=(0.5, 0.4, 0))
    law = JointLaw(0.5, cohesion=50.0, tensile_strength=20.0)
    assembly = assemble(Model((ground, body), {"block": Rigid(20.0)}, {"joint": law}, loads=(pulled, side)))
    problem = assembly.problem({"live": 0.0})
    none = np.zeros(problem.pairs, dtype=bool)
    motion = SimpleNamespace(opens=~none, crushes=none, slips=none, direction=np.zeros((problem.pairs, 2)))
    found = forces_in_space(problem, motion, assembly.loads["live"])
    assert found is not None
    least, normal, friction = found
    assert least == pytest.approx(-(50.0 - 0.5 * 20.0) * 0.8, rel=1e-9)
    assert normal.sum() == pytest.approx(-20.0 * 0.8, rel=1e-9)
    assert friction.sum(axis=0) == pytest.approx([32.0, 0.0], abs=1e-8)
