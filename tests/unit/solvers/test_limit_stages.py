"""``limit`` number by number: the quick ones first, the answer printed before them, the slow ones on request."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

import concio
from concio.analysis import limit as limits
from concio.analysis import load_steps as stepping
from concio.analysis.limit import dead_and_live, limit_stages
from concio.analysis.load_steps import load_steps
from concio.cli.main import app
from concio.errors import InputError
from concio.problem.certificate import certify
from concio.problem.solution import Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.path.event_path import follow
from concio.solvers.path.path_state import LinearPath, at_rest, step_problem
from concio.solvers.path.ray import homogeneous, ray
from concio.solvers.path.record import Outcome
from concio.solvers.states import settle
from concio.solvers.states.settle import Settler
from concio.verdict.limit_words import as_given, limit_lines


@pytest.fixture(scope="module")
def wall() -> concio.Model:
    """Dry, elastic, low: part of it slides before it topples."""
    return concio.wall(length=1.0, height=0.5, block_size=(0.25, 0.125), friction=0.5, horizontal=0.2, mesh_size=0.125)


def test_numbers_come_one_by_one_and_each_keeps_those_before(wall: concio.Model, monkeypatch) -> None:
    monkeypatch.setattr(limits, "LARGEST_PATH", 10)
    found = list(limit_stages(wall, friction=True))
    assert [name for name, _ in found] == ["bound", "friction", "steps", "collapse state", "path"]
    first, last = found[0][1], found[-1][1]
    assert first.steps is None
    assert first.friction is None
    assert last.associated is first.associated
    assert last.friction is not None
    assert last.path is None
    assert "not followed by default" in last.path_note
    low, high = last.bracket
    assert 0 < low <= high
    assert last.carried == last.steps.carried
    text = "\n".join(limit_lines(last))
    assert "--path follows it" in text
    assert f"carried up to {last.carried:.6g} at least" in text


def test_large_models_in_space_are_searched_on_request_only(monkeypatch) -> None:
    monkeypatch.setattr(limits, "UNASKED_IN_SPACE", 0)
    plane = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", friction=0.6, horizontal=0.1)
    model = concio.extrude(plane, 0.4)
    assert "not tried by default" in limits.limit(model, steps=False).search
    asked = limits.limit(model, steps=False, search=True)
    assert "not tried" not in asked.search
    assert asked.collapse_state is not None


def test_small_models_have_their_path_followed_unasked(wall: concio.Model) -> None:
    slender = concio.wall(length=0.5, height=1.0, block_size=(0.5, 1.0), friction=0.9, horizontal=0.3, block="rigid")
    assert limits.limit(slender).coulomb == pytest.approx(0.5 / 0.3, rel=1e-6)
    assert limits.limit(slender, path=False).path is None
    assert limits.limit(slender, path=False).steps is None


def test_a_collapse_state_is_not_told_as_what_is_carried() -> None:
    """A block that topples at its load; beside it the words for one that would move at half of that."""
    slender = concio.wall(length=0.5, height=1.0, block_size=(0.5, 1.0), friction=0.9, horizontal=0.5, block="rigid")
    found = limits.limit(slender)
    text = "\n".join(limit_lines(found))
    assert "Design with 1 times 'live' (5 kN) at most: as the load grows it is carried up to there" in text
    assert "No equilibrium exists beyond it" in text
    state = found.collapse_state
    assert state is not None
    lower = replace(found, collapse_state=replace(state, multiplier=0.5)).verdict.sentence
    assert "Design with 0.5 times" in lower
    assert "lets the structure begin to move, though 1 is carried where the load grows from rest" in lower
    assert "1 times is an upper bound only: no equilibrium exists beyond it" in lower
    unknown = replace(found, collapse_state=None).verdict.sentence
    assert "Design with 1 times" in unknown
    assert "there it collapses" in unknown


@pytest.mark.parametrize(("friction", "expected"), [(0.9, 0.5), (0.3, 0.3)])
def test_load_steps_come_close_to_what_a_block_carries_and_not_beyond(friction: float, expected: float) -> None:
    """A block of 0.5 x 1 m topples at half its weight, or slides at its friction, whichever is less."""
    size = {"length": 0.5, "height": 1.0, "block_size": (0.5, 1.0), "mesh_size": 0.25}
    model = concio.wall(friction=friction, horizontal=1.0, **size)
    dead, live = dead_and_live(concio.assemble(model), "live")
    steps = load_steps(dead, live, expected)
    assert 0.97 * expected < steps.carried < expected
    assert steps.failed <= expected
    assert list(steps.multipliers) == sorted(steps.multipliers)


@pytest.mark.parametrize("block", [(0.5, 0.25), pytest.param((0.25, 0.125), marks=pytest.mark.long)])
def test_every_load_step_is_certified_by_the_original_problem(block: tuple[float, float]) -> None:
    size = {"length": 1.0, "height": 0.5, "block_size": block, "mesh_size": block[1]}
    dead, live = dead_and_live(concio.assemble(concio.wall(friction=0.5, horizontal=0.2, **size)), "live")
    told: list[float] = []
    steps = load_steps(dead, live, 3.0, found=told.append)
    assert steps.worst <= 1e-9
    assert told == list(steps.multipliers[1:])
    state = steps.state
    at = step_problem(LinearPath(dead, live), state, steps.carried)  # repeated at its own load it does not move
    again = certify(at, state.displacement, state.normal_force, state.friction_force)
    assert again.equilibrium <= 1e-9
    assert again.cone <= 1e-9
    assert again.penetration <= 1e-9


def test_a_dead_load_that_is_not_carried_has_no_steps() -> None:
    model = concio.wall(length=0.5, height=1.0, block_size=(0.5, 1.0), friction=0.9, horizontal=1.0, block="rigid")
    dead, live = dead_and_live(concio.assemble(model), "live")
    pushed = dead.with_loads(dead.f + 3 * live)
    steps = load_steps(pushed, live, 1.0)
    assert steps.multipliers == ()
    assert np.isnan(steps.carried)


def test_from_rest_the_path_is_a_ray(wall: concio.Model) -> None:
    """One load step gives what the exact path reaches event by event; every point between is an equilibrium too."""
    problem = concio.assemble(wall).problem({"live": 0.0})
    path = LinearPath(problem.with_loads(0.0 * problem.f), problem.f)
    assert homogeneous(path)
    end = ray(path, at_rest(path.problem))
    walked = follow(path, at_rest(path.problem), until=1.0)
    assert walked.outcome is Outcome.REACHED
    scale = np.abs(end.displacement).max()
    np.testing.assert_allclose(walked.end.displacement, end.displacement, atol=1e-9 * scale)
    half = certify(path.at(0.5), 0.5 * end.displacement, 0.5 * end.normal_force, 0.5 * end.friction_force)
    assert half.certified
    assert end.work == pytest.approx(walked.end.work, rel=1e-9)
    assert end.dissipation == pytest.approx(walked.end.dissipation, rel=1e-6, abs=1e-12 * end.work)


def test_what_has_a_size_of_its_own_is_no_ray(wall: concio.Model) -> None:
    law = concio.JointLaw(0.5, cohesion=10.0)
    glued = concio.wall(length=0.5, height=0.25, friction=law)
    problem = concio.assemble(glued).problem()
    assert not homogeneous(LinearPath(problem.with_loads(0.0 * problem.f), problem.f))
    assert not homogeneous(LinearPath(problem, problem.f)), "a load is there at the beginning"


@pytest.mark.parametrize(
    ("multiplier", "said"),
    [
        (4.77, "21 % of that bound: it could grow 4.77 times at most"),
        (1 / 1.648, "1.65 times that bound: only 60.7 % of it can be carried at most"),
        (0.0, "not carried, nor is any fraction of it"),
    ],
)
def test_what_the_load_as_given_is_beside_the_bound(multiplier: float, said: str) -> None:
    assert as_given(multiplier) == said


def test_what_was_known_before_an_interruption_is_printed(wall: concio.Model, tmp_path: Path, monkeypatch) -> None:
    file = tmp_path / "wall.toml"
    concio.save(wall, file)
    whole = limits.limit_stages

    def interrupted(*args: object, **options: object) -> Iterator[object]:
        stages = whole(*args, **options)
        yield next(stages)
        raise KeyboardInterrupt

    monkeypatch.setattr(limits, "limit_stages", interrupted)
    done = CliRunner().invoke(app, ["limit", str(file)])
    assert done.exit_code == 130
    assert "associated bound" in done.output
    assert "stopped on request" in done.output


def test_the_answer_stands_before_the_numbers(wall: concio.Model, tmp_path: Path) -> None:
    """As of every command: the title, the sentence of the verdict, and only then what was found on the way."""
    file = tmp_path / "wall.toml"
    concio.save(wall, file)
    done = CliRunner().invoke(app, ["limit", str(file), "--no-path", "--no-search"])
    lines = done.stdout.splitlines()
    assert lines[1] == concio.limit(wall, path=False, search=False, friction=True).verdict.sentence
    assert sum(lines[1] in line for line in lines) == 1
    assert any("associated bound" in line for line in lines[2:])


def test_load_steps_halve_towards_a_multiplier_that_failed(monkeypatch) -> None:
    """Far steps fail from half of the bound on, near ones from 0.8 on: found to 1/64 of the bound, few that fail."""
    size = {"length": 0.5, "height": 1.0, "block_size": (0.5, 1.0), "mesh_size": 0.5}
    dead, live = dead_and_live(concio.assemble(concio.wall(friction=0.9, horizontal=1.0, **size)), "live")
    bound, step, tried, again = 0.5, stepping._step, [], []
    lost = replace(step(dead, at_rest(dead), set(), None), status=Status.GAVE_UP)

    def fails(problem, state, curved, progress, starts=None):
        at = float((problem.f - dead.f) @ live / (live @ live)) / bound
        (tried if starts is None else again).append((round(64 * state.parameter / bound), round(64 * at)))
        far = at - state.parameter / bound > 0.2 and at > 0.45
        return lost if far or at > 0.8 else step(problem, state, curved, progress)

    monkeypatch.setattr(stepping, "_step", fails)
    steps = load_steps(dead, live, bound)
    assert round(64 * steps.carried / bound) == 51
    assert round(64 * steps.failed / bound) == 52
    assert len(set(tried)) == len(tried) <= 11
    assert again == [(51, 52)], "more starts are for the step that is halved no more"


def test_newtons_method_is_left_out_of_steps_in_space_once_it_does_not_arrive(monkeypatch) -> None:
    """Whether it is tried, step by step: up to the first step that takes an iteration, and not from there on."""
    size = {"width": 1.8, "depth": 1.5, "height": 0.6, "block_size": (0.6, 0.3, 0.3)}
    tower = concio.tower(**size, friction=0.3, horizontal=0.1, towards=(1, 0), block="rigid", unit_weight=20.0)
    solve, seen = stepping.engine.solve, []

    def watched(problem, **options):
        found = solve(problem, **options)
        if "newton" in options:
            seen.append((options["newton"], found.solved and found.iterations > 0))
        return found

    monkeypatch.setattr(stepping.engine, "solve", watched)
    found = concio.limit(tower, search=False)
    assert found.steps.worst <= 1e-9
    assert 2.9 < found.steps.carried < 3.0, "a tenth of the weight slides at 3 times"
    first = [iterated for _, iterated in seen].index(True)
    assert 0 < first < len(seen) - 1
    assert [newton for newton, _ in seen] == [k <= first for k in range(len(seen))]


def test_parts_that_take_iterations_are_known_by_their_first_unknowns(monkeypatch) -> None:
    """Of three parts the last two take them: Newton's method is left out of their next steps, and not of the first."""
    tried = []

    def solve(problem, **options):
        tried.append(options["newton"])
        return SimpleNamespace(solved=True, iterations=problem.iterations)

    monkeypatch.setattr(stepping, "needed", lambda problem: False)
    monkeypatch.setattr(stepping, "own", lambda part, *state: state)
    monkeypatch.setattr(stepping.engine, "solve", solve)
    parts = [
        SimpleNamespace(problem=SimpleNamespace(dim=3, iterations=k, unknowns=6), unknowns=np.arange(6 * k, 6 * k + 6))
        for k in range(3)
    ]
    state, curved = SimpleNamespace(displacement=0, normal_force=0, friction_force=0), set()
    for part in (*parts, *parts):
        stepping._part_step(part, state, curved, None, 0)
    assert curved == {6, 12}
    assert tried == [True, True, True, True, False, False]


def test_settling_stops_where_every_round_contradicts_more_pairs(monkeypatch) -> None:
    """From points that are none, on a wall of hundreds of pairs: fewer linear systems than with endless patience."""
    wide = concio.wall(length=3.0, height=1.5, block_size=(0.25, 0.125), friction=0.5, horizontal=0.5, mesh_size=0.125)
    s = scale(concio.assemble(wide).problem())
    points = [np.random.default_rng(k).normal(size=(2, len(s.f) + 2 * s.pairs)) * 1e3 for k in range(3)]

    def solves() -> int:
        found = [Settler(s).settle(s, p[0, : len(s.f)], p[1, len(s.f) :].reshape(-1, 2)) for p in points]
        assert not any(f.settled for f in found)
        return sum(f.solves for f in found)

    quick = solves()
    monkeypatch.setattr(settle, "PATIENCE", 10**6)
    assert quick < solves()


def test_a_live_group_that_moves_supports_is_refused():
    """A multiplier multiplies loads; what the group moves would be left out of the bound without a word."""
    model = concio.wall(length=0.8, height=0.4, block_size=(0.4, 0.2), friction=0.6, horizontal=1.0, block="rigid")
    moved = concio.Support("sinks", "ground", displacement=(0.0, -1e-3), group="live")
    with pytest.raises(InputError, match="moves supports"):
        concio.limit(replace(model, supports=(moved,)))
