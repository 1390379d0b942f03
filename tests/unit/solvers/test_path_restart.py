"""Jumps and restarts of load paths: where no rates continue them, and what shows that they are at their end."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import as_file, files
from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.analysis.limit import limit
from concio.problem.solution import Status
from concio.solvers.path import restart
from concio.solvers.path.path_state import LinearPath, PathState, state_of
from concio.solvers.path.record import Outcome
from concio.solvers.path.restart import TENTH, is_jump, load_unit, look_beyond, moves_freely, shrinks, step_between
from concio.verdict.limit_words import limit_lines
from path_helpers import at_rest, energy_error, least_dissipation, weight_then, worst_certificate
from rigid_walls import FERRIS_TIN_LOI, MU, block_on_incline, wall


@pytest.mark.long
def test_jumps_under_growing_load_lead_to_the_peak_that_controlled_displacement_finds():
    """Two ways of control, the second without any jump, meet in the same collapse."""
    a = wall(FERRIS_TIN_LOI["wall 3"])
    push = a.load(1, 0)
    path, grown = weight_then(a, MU, push, compliance=1e-4, until=1e6)
    assert grown.outcome is Outcome.LIMIT
    assert grown.jumps
    assert worst_certificate(path, grown) <= 1e-9
    assert energy_error(path, grown) <= 1e-9
    assert least_dissipation(path, grown) >= -1e-12
    _, driven = weight_then(a, MU, push, compliance=1e-4, until=0.1, control=push / push.sum())
    assert not driven.jumps
    assert grown.peak == pytest.approx(driven.peak, rel=1e-9)
    jump = grown.jumps[0]
    before, after = grown.states[jump.step - 1], grown.states[jump.step]
    moved = float(np.abs(after.displacement - before.displacement).max())
    assert after.parameter - before.parameter <= 1e-4
    assert moved > 1e-3 * float(np.abs(before.displacement).max())
    least = look_beyond(path, before, 1.0).state  # the next load, however near, has its answer as far away
    assert np.abs(least.displacement - before.displacement).max() == pytest.approx(moved, rel=1e-2)
    assert is_jump(path, before, least, None)


def test_between_two_events_a_tenth_of_the_load_moves_a_tenth_of_the_way():
    """Paths are straight between events, so that the answer near the line is known without a solver."""
    a = wall(FERRIS_TIN_LOI["wall 3"])
    path, grown = weight_then(a, MU, a.load(1, 0), compliance=1e-4, until=0.1)
    ways = [(b.parameter - a.parameter, a, b) for a, b in zip(grown.states[:-1], grown.states[1:], strict=True)]
    length, start, end = max(ways, key=lambda way: way[0])
    between = step_between(path, start, end, start.parameter + TENTH * length)
    assert between is not None
    assert between.solved
    way = end.displacement - start.displacement
    assert np.abs(between.displacement - start.displacement - TENTH * way).max() <= 1e-9 * np.abs(way).max()
    assert shrinks(start, end, between)
    assert not is_jump(path, start, end, None)


def test_motions_that_need_no_change_of_forces():
    """A block about to slide slides, along the push only; it neither lifts nor turns."""
    block = block_on_incline(0.4, 1.0, 0.0)
    path, found = weight_then(block, 0.3, block.load(1, 0), compliance=1e-3)
    end = found.end
    assert moves_freely(path, end, np.array([1.0, 0.0, 0.0]))
    for motion in ([-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0], [0, 0, 1.0], [0.5, 0.2, -1.0], [0, 0, 0]):
        assert not moves_freely(path, end, np.array(motion))
    assert not moves_freely(path, found.states[0], np.array([1.0, 0.0, 0.0]))
    nothing = look_beyond(path, end, 1.0)
    assert nothing.state is None
    assert nothing.no_equilibrium


def test_a_lost_path_is_no_collapse_multiplier():
    model = concio.column(width=0.4, height=1.0, blocks=1, friction=0.9, block=concio.Rigid(20.0))
    model = replace(model, loads=(*model.loads, concio.Load("body", (20.0, 0.0), group="live")))
    found = limit(model)
    assert found.collapse_shown
    assert found.coulomb == pytest.approx(0.4, rel=1e-9)
    assert "collapses at 0.4" in "\n".join(limit_lines(found))
    assert "asked for" not in "\n".join(limit_lines(found))
    moves_on = "\n".join(limit_lines(replace(found, path=replace(found.path, outcome=Outcome.LOST))))
    assert "no certified state carries more" in moves_on, "its peak is shown, whatever comes after"
    assert "could not be continued" not in moves_on
    lost = replace(found, collapse_shown=False, path=replace(found.path, outcome=Outcome.LOST))
    assert np.isnan(lost.coulomb)
    assert lost.carried == found.coulomb
    assert lost.summary()["coulomb_path_multiplier"] is None
    text = "\n".join(limit_lines(lost))
    assert "at least 0.4" in text
    assert "collapses at" not in text


@pytest.mark.long
def test_a_wall_over_an_arch_is_let_go_from_where_it_is() -> None:
    """Its blocks have slid by decimetres on joints that give way by nanometres, and a crack closes after metres."""
    with as_file(files("concio.model").joinpath("templates", "arch_on_piers.toml")) as template:
        model = concio.load(template)
    found = limit(model, search=False, friction=False)
    assert found.collapse_shown
    assert 2.1 < found.coulomb < found.associated.multiplier


@pytest.mark.parametrize(("fallen", "order"), [(np.inf, [1e-3, 1e-4, 1e-5, 1e-2]), (2.0005, [1e-4, 1e-5, 1e-3, 1e-2])])
def test_a_load_under_which_the_structure_fell_is_tried_last(monkeypatch, fallen, order):
    """Let go from a later point, it is let go under smaller loads first: the larger ones may well fell it again."""
    asked = []

    def nothing_found(path, point, parameter, progress, how="near"):
        asked.append((how, round(parameter - point.parameter, 9)))
        return SimpleNamespace(status=Status.GAVE_UP, solved=False)

    monkeypatch.setattr(restart, "solve_step", nothing_found)
    monkeypatch.setattr(restart, "load_unit", lambda path, point: 1.0)
    found = look_beyond(None, SimpleNamespace(parameter=2.0), 1.0, least=1e-2, fallen=fallen)
    assert found.state is None
    assert [share for how, share in asked if how == "let go"] == order


def test_what_crushes_sinks_freely_and_moves_no_other_way():
    """A block under four times its weight, which is what its joint crushes at: each point has its cap."""
    column = concio.column(width=0.4, height=1.0, blocks=1, block="rigid", unit_weight=20.0)
    law = concio.JointLaw(0.6, compressive_strength=100.0)
    live = concio.Load("body", (0.0, -20.0), group="live")
    model = replace(column, laws=dict.fromkeys(column.laws, law), loads=(*column.loads, live))
    found = concio.run_path(model, [concio.Stage("dead", {"dead": 1.0}), concio.Stage("live", {"live": 10.0})])
    assert found.steps[-1].factors["live"] == pytest.approx(4.0, rel=1e-9)
    standing = next(step for step in reversed(found.steps) if step.stage == 0)
    for step, crushes in ((found.steps[-1], True), (standing, False)):
        problem = found.assembly.problem(step.factors)
        path, state = LinearPath(problem, np.zeros(problem.unknowns)), replace(step.state, parameter=0.0)
        assert moves_freely(path, state, np.array([0.0, -1.0, 0.0])) is crushes
        for motion in ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]):
            assert not moves_freely(path, state, np.array(motion))


def test_what_has_crushed_before_is_free_to_sink_as_far_as_it_has_come_back() -> None:
    """Joints crushed by 2 mm touch where the block stands 2 mm lower; 1 mm above that it is free to sink, or rise."""
    column = concio.column(width=0.4, height=1.0, blocks=1, block="rigid", unit_weight=20.0)
    problem = concio.assemble(column).problem({"dead": 0.0})
    m, crushed, down = problem.pairs, 2e-3, np.array([0.0, -1.0, 0.0])
    assert (problem.C_n @ down < 0).all()
    path = LinearPath(problem, np.zeros(problem.unknowns))
    for sunk, free in ((0.5 * crushed, True), (crushed, False)):
        point = replace(at_rest(path), displacement=sunk * down, offset=np.full(m, crushed))
        assert moves_freely(path, point, down) is free
        assert moves_freely(path, point, -down)


def standing(law: concio.JointLaw, weight: float, push: float = 0.0) -> tuple[LinearPath, PathState]:
    """A rigid block 0.4 by 1 under so much of its weight, pushed at its middle by a share of all of it."""
    column = concio.column(width=0.4, height=1.0, blocks=1, block="rigid", unit_weight=20.0)
    model = replace(column, laws=dict.fromkeys(column.laws, law),
                    loads=(*column.loads, concio.Load("body", (20.0, 0.0), group="live")))  # fmt: skip
    result = concio.solve(model, factors={"dead": weight, "live": push})
    problem, found = result.assembly.problem(result.factors), result.solution
    path = LinearPath(problem, np.zeros(problem.unknowns))
    return path, state_of(path, 0.0, found.displacement, found.normal_force, found.friction_force, before=at_rest(path))


@pytest.mark.parametrize(
    ("law", "weight", "free"),
    [
        (concio.JointLaw(0.6), 1.0, False),
        (concio.JointLaw(0.6), 0.0, True),
        (concio.JointLaw(0.0), 1.0, True),
        (concio.JointLaw(0.0, cohesion=5.0), 1.0, False),
        (concio.JointLaw(0.6, cohesion=5.0), 0.0, True),  # what nothing presses lifts off and slides without shear
        (concio.JointLaw(0.6, cohesion=5.0, tensile_strength=2.0), 0.0, False),
        (concio.JointLaw(0.6, dilatancy=0.3), 0.0, False),  # to slide it has to lift
    ],
)
def test_a_block_slides_freely_where_no_joint_holds_it(law: concio.JointLaw, weight: float, free: bool) -> None:
    path, point = standing(law, weight)
    for way in (1.0, -1.0):
        assert moves_freely(path, point, np.array([way, 0.0, 0.0])) is free


@pytest.mark.parametrize(("push", "free"), [(0.0, False), (0.3, False), (0.4, True)])
def test_a_block_rocks_freely_where_it_stands_on_one_corner_and_no_other_way(push: float, free: bool) -> None:
    """Rocking leaves the corner where it is: the other one must be without force, and every one that presses counts."""
    path, point = standing(concio.JointLaw(0.9), 1.0, push)
    x, y = path.problem.C_n.toarray(), path.problem.C_t.toarray()
    for k in range(path.problem.pairs):
        turn = np.linalg.solve(np.array([x[k], y[k], [0.0, 0.0, 1.0]]), [0.0, 0.0, 1.0])  # about this point
        lifts = np.sign((x @ turn)[np.abs(x @ turn).argmax()]) * turn
        assert moves_freely(path, point, lifts) == (free and point.normal_force[k] > 1.0), k
        assert free or not moves_freely(path, point, -lifts)


def test_the_unit_of_load_brings_as_much_as_there_is() -> None:
    path, point = standing(concio.JointLaw(0.6), 1.0)
    rate = np.array([2.0, -3.0, 1.0])
    for share, at, wanted in ((3.0, 2.0, 5.0), (3.0, -5.0, 2.0), (3.0, -3.0, 1.0), (0.0, 4.0, 4.0), (0.0, 0.0, 1.0)):
        same = LinearPath(replace(path.problem, f=share * rate), rate)
        assert load_unit(same, replace(point, parameter=at)) == pytest.approx(wanted, rel=1e-14)
    assert load_unit(LinearPath(path.problem, 0 * rate), point) == 1.0
    across = LinearPath(replace(path.problem, f=np.array([4.0, 0.0, 0.0])), np.array([0.0, -2.0, 0.0]))
    for at, wanted in ((1.0, 3.0), (-1.0, 3.0), (5.0, 7.0)):
        assert load_unit(across, replace(point, parameter=at)) == pytest.approx(wanted, rel=1e-14)


@pytest.mark.parametrize("modulus", [1e2, 1e7])
def test_a_motion_that_strains_a_body_needs_forces_at_any_stiffness(modulus: float) -> None:
    """An elastic block on a smooth bed glides as one, at any rate; it stretches, or bends, under forces alone."""
    stone = concio.Elastic(modulus, 0.0)
    result = concio.solve(concio.column(width=0.4, height=1.0, blocks=1, block=stone, friction=0.0, horizontal=0.0))
    problem, found = result.assembly.problem(result.factors), result.solution
    path = LinearPath(problem, np.zeros(problem.unknowns))
    point = state_of(path, 0.0, found.displacement, found.normal_force, found.friction_force, before=at_rest(path))
    glide = np.tile([1.0, 0.0], problem.unknowns // 2)
    bend = np.zeros(problem.unknowns)
    bend[::2] = np.linspace(1.0, 2.0, problem.unknowns // 2)
    for rate in (1e-12, 1.0, 1e6):
        for way in (rate, -rate):
            assert moves_freely(path, point, way * glide)
            assert not moves_freely(path, point, way * bend)
    assert not moves_freely(path, point, np.nan * glide)
    assert not moves_freely(path, point, np.full(problem.unknowns, np.inf))
