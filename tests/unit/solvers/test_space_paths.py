"""Limit loads, load paths, settlements and margins in space: an extruded plane model gives the plane answer."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import concio
from concio.cli.path_lines import path_facts, path_lines
from concio.post.path_curve import most_moving
from concio.problem.solution import Solution, Status
from concio.solvers.path.near_forces import Nearby
from concio.solvers.path.path_state import LinearPath, at_rest, energy_of_step, state_of
from concio.solvers.path.step_path import extrapolated
from concio.verdict.limit_words import limit_lines
from space_problems import wall as blocks

THICK = 0.3
WALL = concio.wall(length=1.5, height=0.75, block="rigid", friction=0.6, horizontal=0.2)
ARCH = concio.arch(span=4.0, ring=0.6, voussoirs=9, block="rigid", friction=0.6)
STAGES = (concio.Stage("weight", {"dead": 1.0}, steps=1), concio.Stage("push", {"live": 2.0}, steps=4))


def test_limit_of_an_extruded_wall_is_that_of_the_plane() -> None:
    plane = concio.limit(WALL, path=False, steps=True, search=False)
    space = concio.limit(concio.extrude(WALL, THICK), search=False)
    assert space.associated.checked
    assert space.associated.multiplier == pytest.approx(plane.associated.multiplier, rel=1e-9)
    assert space.associated.upper == pytest.approx(plane.associated.upper, rel=1e-9)
    assert space.steps is not None
    assert plane.steps is not None
    assert space.steps.multipliers == pytest.approx(plane.steps.multipliers, rel=1e-9)
    assert space.steps.worst < 1e-9
    assert space.bracket[0] <= space.bracket[1]
    assert any("Coulomb load steps" in line for line in limit_lines(space))
    with pytest.raises(concio.InputError, match="exact paths are for models in the plane"):
        concio.limit(concio.extrude(WALL, THICK), path=True)


@pytest.mark.long
def test_what_lies_between_the_steps_and_the_bound_is_put_on_in_one_step() -> None:
    model = concio.extrude(concio.wall(length=2.0, height=1.0, block="rigid", horizontal=0.2), THICK)
    found = concio.limit(model, search=False)
    assert found.steps is not None
    assert found.steps.failed < found.associated.multiplier * (1 - 1e-6)
    assert found.steps.outcome is Status.COLLAPSES
    assert found.summary()["coulomb_steps_outcome"] == "collapses"
    assert any("is not carried: collapses" in line for line in limit_lines(found))


def test_load_path_in_steps() -> None:
    plane = concio.run_path(WALL, STAGES, method="steps")
    space = concio.run_path(concio.extrude(WALL, THICK), STAGES)
    assert space.complete
    assert space.certificate < 1e-9
    assert abs(space.energy_error) < 1e-9
    for a, b in zip(plane.steps, space.steps, strict=True):
        forces = [s.state.normal_force.sum() * t for s, t in ((a, THICK), (b, 1.0))]
        assert forces[1] == pytest.approx(forces[0], rel=1e-9)
    with pytest.raises(concio.InputError, match="paths event by event are for models in the plane"):
        concio.run_path(concio.extrude(WALL, THICK), STAGES, method="events")


def test_a_path_in_space_in_words() -> None:
    found = concio.run_path(concio.extrude(WALL, THICK), (*STAGES[:1], concio.Stage("push", {"live": 2.5}, steps=2)))
    point = most_moving(found)
    assert len(point.at) == 3
    assert any("moving along" in line for line in path_lines(found, point, every=True))
    assert path_facts(found, point)["point"]["at"] == list(point.at)


@pytest.mark.long
def test_settlement_of_an_extruded_arch() -> None:
    moving = concio.Support("spread", "right abutment", displacement=(0.01, -0.004))
    model = replace(ARCH, supports=(moving,))
    plane, space = concio.settle(model, method="steps"), concio.settle(concio.extrude(model, 0.7))
    assert space.reached
    assert space.path.certificate < 1e-9
    for name, reaction in plane.reactions.items():
        there = space.reactions[name]
        size = np.abs(reaction).max()
        assert there[-1, [0, 2]] == pytest.approx(0.7 * reaction[-1], abs=1e-9 * size)
        assert np.abs(there[:, 1]).max() < 1e-9 * size


def test_settlement_out_of_the_plane_breaks_the_symmetry(monkeypatch: pytest.MonkeyPatch) -> None:
    """A support that turns about the span lifts the arch off one edge; forces stay certified and balance the weight.

    Its blocks then move on in proportion at constant forces, so that all but a few steps, those of another direction,
    are found from where the last two lead; from the last state itself two of three are not.
    """
    tried: list[bool] = []
    solve = Nearby.answer

    def counted(self: Nearby, *args: Any) -> Solution | None:
        found = solve(self, *args)
        tried.append(found is not None)
        return found

    monkeypatch.setattr(Nearby, "answer", counted)
    turning = concio.Support("turns", "right abutment", rotation=(0.02, 0.0, 0.0))
    model = replace(concio.extrude(ARCH, 0.7), supports=(turning,))
    found = concio.settle(model)
    assert found.reached
    assert found.path.certificate < 1e-9
    assert tried.count(False) <= 6 < 40 <= len(tried)
    last = found.path.result()
    up = sum(reaction[-1] for reaction in found.reactions.values())
    assert up[:2] == pytest.approx([0.0, 0.0], abs=1e-8)
    pairs, n = last.assembly.pairs, last.contacts.normal_force
    to_one_side = np.bincount(pairs.interface, n * np.sign(pairs.point[:, 1]))
    assert np.abs(to_one_side).max() > 0.3 * np.bincount(pairs.interface, n).max(), "thrust has moved to the edges"


def test_where_the_last_two_states_lead() -> None:
    problem = blocks(1, 1, kn=1e4, mu=0.5).problem
    path = LinearPath(problem.with_loads(0.0 * problem.f), problem.f)
    rest = at_rest(path.problem)
    n, pairs = np.ones(problem.pairs), (problem.pairs, 1)
    first = state_of(path, 0.5, np.full(problem.unknowns, 1e-3), n, np.tile((0.1, -0.2), pairs), before=rest)
    second = state_of(path, 0.6, np.full(problem.unknowns, 2e-3), 3 * n, np.tile((0.3, -0.1), pairs), before=first)
    assert extrapolated([first], 0.6)[0] is first.displacement
    u, t_n, t_t = extrapolated([rest, first, second], 0.65)
    assert u == pytest.approx(2.5e-3)
    assert t_n == pytest.approx(4.0)
    assert t_t == pytest.approx(np.tile((0.4, -0.05), pairs))
    repeated = extrapolated([first, replace(second, parameter=0.5)], 0.7)
    assert repeated[1] is second.normal_force  # a step at the same load leads nowhere


def test_margins() -> None:
    plane, space = (concio.load_margin(m, tolerance=0.04) for m in (WALL, concio.extrude(WALL, THICK)))
    assert space.holds == pytest.approx(plane.holds, rel=1e-9)
    assert space.outcome is plane.outcome


def test_energy_of_a_slip_in_two_directions() -> None:
    """One block pushed round a corner: friction dissipates mu N times the way, whichever way it turns."""
    problem = blocks(1, 1, kn=1e4, mu=0.5).problem
    weight = float(-problem.f[2::6].sum())
    path = LinearPath(problem.with_loads(0.0 * problem.f), problem.f)
    state = at_rest(path.problem)
    assert state.friction_force.shape == (problem.pairs, 2)
    u, t = np.zeros(problem.unknowns), np.zeros((problem.pairs, 2))
    n = np.full(problem.pairs, weight / problem.pairs)
    moved = 0.0
    for k, step in enumerate(((0.01, 0.0), (0.01, 0.02), (0.0, 0.02))):
        new = np.zeros_like(u)
        new[0::6], new[1::6] = step
        way = new - u
        direction = (problem.C_t @ way).reshape(-1, 2)
        t = -0.5 * n[:, None] * direction / np.linalg.norm(direction, axis=1)[:, None]
        before = state_of(path, 1.0, u, n, t)
        after = state_of(path, 1.0, new, n, t, before=before)
        _, dissipation = energy_of_step(path, before, after)
        length = float(np.linalg.norm(way[:2]))
        assert dissipation == pytest.approx(0.5 * weight * length, rel=1e-9), k
        moved += length
        u = new
    assert moved == pytest.approx(0.04)
