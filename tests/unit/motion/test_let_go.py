"""Where one load step stays undecided the structure is let go: it rests, falls or moves on, and the verdict says so."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.motion import let_go as module
from concio.analysis.step import solve
from concio.errors import InputError
from concio.problem.solution import Status
from concio.verdict.italian import italian
from concio.verdict.verdict import Outcome
from models import box
from models import model_of as plane_model
from space_models import UNIT, model_of
from space_motions import blocks
from space_problems import dome, wall

SLENDER = ((0.0, 0.0, 0.0), (0.3, 0.8, 1.2))


def leaning(share, **changes):
    """A block of 0.3 x 0.8 x 1.2 m under a share of the horizontal load that turns it over."""
    model = blocks(SLENDER, friction=0.9)
    return replace(model, loads=(concio.Load("weight", (share * 0.25, 0.0, -1.0)),), **changes)


def undecided(model):
    """The load step of a model as if nothing had decided it: what is tested is what comes after."""
    found = solve(model, on_failure="return")
    return replace(found, solution=replace(found.solution, status=Status.UNDECIDED))


@pytest.mark.long
def test_a_block_below_its_limit_comes_to_rest_and_one_above_is_seen_to_fall():
    """Statics of a block: it turns over at a load of width over height, here 0.25 of its weight."""
    rests = concio.let_go(undecided(leaning(0.97)))
    assert (rests.verdict.outcome, rests.verdict.status) == (Outcome.HOLDS, "comes_to_rest")
    assert rests.motion.rests
    assert rests.moved[1] < 1e-3
    assert "An equilibrium where the bodies stand satisfies every equation" in rests.verdict.proof
    falls = concio.let_go(undecided(leaning(1.03)))
    assert (falls.verdict.outcome, falls.verdict.status) == (Outcome.FAILS, "seen_to_fall")
    assert "it falls: after" in falls.verdict.sentence
    assert falls.verdict.proof.startswith("Nothing is proven of the structure")
    assert any("proves nothing more" in line for line in falls.verdict.limits)
    assert "does it come to rest?" in falls.verdict.question.asked


@pytest.mark.long
def test_what_is_decided_stays_decided():
    """The proof stays the answer, and what was seen is told beside it."""
    for share, status, outcome in ((0.9, Status.SOLVED, Outcome.HOLDS), (1.1, Status.NO_EQUILIBRIUM, Outcome.FAILS)):
        step = concio.solve(leaning(share), on_failure="return")
        assert step.status is status
        found = concio.let_go(step)
        assert found.verdict.outcome is outcome
        assert found.verdict.proof == step.verdict.proof
        assert found.verdict.answer.startswith(step.verdict.answer)
        assert "Released at rest" in found.verdict.answer


def test_work_is_bounded_and_what_still_moves_is_told_to_move(monkeypatch):
    for name in ("LEAST_LET_GO", "MOST_LET_GO"):
        monkeypatch.setattr(module, name, 20)
    found = concio.let_go(undecided(leaning(1.03)))
    assert found.worked
    assert len(found.motion.steps) == 20
    assert (found.verdict.outcome, found.verdict.status) == (Outcome.MOVING, "still_moves")
    assert "still moves after" in found.verdict.sentence
    assert found.speed == pytest.approx(np.linalg.norm(found.motion.end.velocity[1]))  # the floor stands still
    assert found.speed > 0
    stopped = concio.let_go(undecided(leaning(1.03)), progress=lambda state: state.iteration >= 5)
    assert stopped.verdict.outcome is Outcome.UNDECIDED


@pytest.mark.parametrize(("work", "most", "steps"), [(7.5, 100, 7), (2.0, 100, 4), (50.0, 9, 9)])
def test_steps_are_bounded_by_unknowns_and_pairs_within_a_least_and_a_most(monkeypatch, work, most, steps):
    """Six unknowns of one block in space, and the pairs of its joint."""
    result = undecided(leaning(1.03))
    monkeypatch.setattr(module, "LET_GO_WORK", int(work * (6 + len(result.assembly.pairs))))
    monkeypatch.setattr(module, "LEAST_LET_GO", 4)
    monkeypatch.setattr(module, "MOST_LET_GO", most)
    found = concio.let_go(result)
    assert found.worked
    assert len(found.motion.steps) == steps


@pytest.mark.long
def test_what_comes_to_rest_elsewhere_is_another_structure():
    """One of two blocks is described 0.1 m above the floor: it lands and stands there."""
    two = blocks(((0.0, 0.0, 0.0), (0.5, 0.5, 0.5)), ((2.0, 0.0, 0.1), (2.5, 0.5, 0.5)))
    found = concio.let_go(undecided(two))
    assert found.motion.rests
    assert found.moved[1] == pytest.approx(0.1, rel=1e-3)
    assert (found.verdict.outcome, found.verdict.status) == (Outcome.INCOMPLETE, "rests_elsewhere")


@pytest.mark.parametrize(("stiffness", "status"), [(10.0, "seen_to_fall"), (1e3, "solved")])
def test_what_falls_is_not_carried_though_it_rests_at_small_displacements(stiffness, status):
    """A tie that pulls 4 kN at the head of a column of 10 kN: its toe carries 2.5 kN m, and a soft tie lets it lean."""
    model = plane_model(
        box("ground", -3.0, 3.0, -1.0, 0.0, kind="fixed"),
        box("column", -0.25, 0.25, 0.0, 1.0, kind="rigid"),
        law=0.5,
        materials={"block": concio.Rigid(20.0)},
        loads=(concio.Load("weight", (0.0, -1.0)),),
    )
    tie = concio.Tie(
        "tie", body_a="column", at_a=(0.25, 1.0), body_b="", at_b=(3.0, 1.0), stiffness=stiffness, prestress=4.0
    )
    step = concio.solve(replace(model, ties=(tie,)), on_failure="return")
    assert step.solved
    found = concio.let_go(step)
    assert found.verdict.status == status
    assert bool(found.motion.fallen) == (status == "seen_to_fall")
    if found.motion.fallen:
        assert found.verdict.outcome is Outcome.INCOMPLETE
        assert found.verdict.headline == "In equilibrium at small displacements, but released at rest it falls."
        assert {piece.language for piece in italian(found.verdict.headline)} == {"it"}
    else:
        assert found.verdict.outcome is Outcome.HOLDS


def test_supports_that_move_leave_no_place_to_let_go_from():
    moved = replace(leaning(0.5), supports=(concio.Support("sinking", "floor", displacement=(0.0, 0.0, -0.01)),))
    with pytest.raises(InputError, match="no place at rest to let the bodies go"):
        concio.let_go(concio.solve(moved, on_failure="return"))


@pytest.mark.long
def test_a_dome_rests_on_forces_within_friction_that_are_certified():
    """Iterations to its equilibrium never end: points on edges that lie along each other take turns."""
    case = dome(3, 8, thickness=0.6)
    found = concio.let_go(undecided(model_of(case, mu=0.6, push=(0.1, 0.0, 0.0))))
    assert found.verdict.status == "comes_to_rest"
    assert found.moved[1] < 1e-4
    weight = UNIT * sum(body.volume for body in found.motion.model.bodies[1:])
    reaction = found.motion.steps.reaction[-1][found.motion.reactions_of.index("floor")]
    assert np.allclose(np.abs(reaction), (0.1 * weight, 0.0, weight), atol=1e-3 * weight)


@pytest.mark.long
def test_a_dome_that_no_method_decides_is_seen_to_fall():
    """Problem 157 of the corpus in space with the seed 1127: a dome at 0.872 of its associated limit."""
    turn, mu, share = np.array([-0.1214555735251432, 0.9925968686529686, 0.0]), 0.8739561017003059, 0.69251
    model = model_of(dome(3, 9, thickness=0.35416134822805895, mu=mu), mu=mu, push=share * turn)
    step = concio.solve(model, on_failure="return")
    assert step.status is Status.UNDECIDED
    found = concio.let_go(step)
    assert found.verdict.status == "seen_to_fall"
    assert found.motion.certified
    assert found.motion.energy.error < 1e-9
    assert found.verdict.sentence.startswith("Undecided: statically admissible forces exist")


@pytest.mark.long
@pytest.mark.parametrize(("share", "status"), [(0.55, "comes_to_rest"), (0.9, "seen_to_fall")])
def test_a_wall_on_either_side_of_its_limit(share, status):
    """Three courses of three bricks pushed out of their plane; the associated limit is 1/3: half of 0.5 over 1.5."""
    model = model_of(wall(3, 3, mu=0.6), mu=0.6, push=(0.0, share * 0.5, 0.0))
    assert concio.let_go(undecided(model)).verdict.status == status


def test_the_command_lets_go_what_is_undecided_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "block.toml"
    concio.save(leaning(0.97), path)
    code, out, _ = run("run", path, "--let-go", "--json")
    assert code == 0
    assert "let_go" not in json.loads(out)
    monkeypatch.setattr(concio, "solve", lambda model, **options: undecided(model), raising=False)
    code, out, _ = run("run", path, "--let-go", "--json")
    told = json.loads(out)
    assert (code, told["status"], told["let_go"]["status"]) == (0, "comes_to_rest", "at_rest")
    code, out, _ = run("run", path, "--let-go")
    assert code == 0
    assert "comes to rest after" in " ".join(out.split())
