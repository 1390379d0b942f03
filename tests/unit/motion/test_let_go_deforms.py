"""Elastic blocks, joints with a stiffness and ties are let go like rigid blocks; what is written of it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.step import solve
from concio.cli import run_command
from concio.model.file.writing import dumps
from concio.problem.solution import Status
from concio.verdict.italian import italian
from concio.verdict.verdict import Outcome

WIDTH, HEIGHT, UNIT = 1.0, 0.5, 20.0
WEIGHT = WIDTH * HEIGHT * UNIT


def block(material: concio.Rigid | concio.Elastic, push: float = 0.0, ties: tuple[concio.Tie, ...] = (), **law: float):
    """A block on a floor, under its weight and a share of it to the side."""
    kind = "rigid" if isinstance(material, concio.Rigid) else "elastic"
    floor = concio.Body("floor", ((-2, -0.5), (3, -0.5), (3, 0), (-2, 0)), kind="fixed")
    stone = concio.Body("stone", ((0, 0), (WIDTH, 0), (WIDTH, HEIGHT), (0, HEIGHT)), material="stone", kind=kind)
    return concio.Model(
        bodies=(floor, stone), materials={"stone": material}, laws={"joint": concio.JointLaw(**law)},
        loads=(concio.Load("weight", (push, -1.0)),), ties=ties,
    )  # fmt: skip


def undecided(model: concio.Model) -> concio.Result:
    found = solve(model, on_failure="return")
    return replace(found, solution=replace(found.solution, status=Status.UNDECIDED))


def moved(found) -> np.ndarray:
    return np.asarray(found.motion.end.centre[1] - found.motion.reference.disc.centroids[1])


def test_a_block_on_mortar_comes_to_rest_where_its_weight_presses_the_joint():
    """Weight over stiffness and area; without damping of the joint it goes on for seconds."""
    found = concio.let_go(undecided(block(concio.Rigid(UNIT), friction=0.6, normal_stiffness=1e4)))
    assert found.verdict.status == "comes_to_rest"
    assert moved(found) == pytest.approx([0.0, -WEIGHT / (1e4 * WIDTH)], abs=1e-7)
    assert len(found.motion.steps) < 1000
    assert any("fade in the motion" in line for line in found.verdict.limits)
    assert "not for hard ones" not in found.verdict.answer


@pytest.mark.long  # the elastic one comes to rest, too
def test_a_block_on_a_smooth_floor_comes_to_rest_where_its_tie_holds_it():
    """Push over stiffness of the tie, within what counts as the place where an equilibrium was certified."""
    tie = concio.Tie("tie", "floor", (-1.0, 0.5 * HEIGHT), "stone", (0.0, 0.5 * HEIGHT), 500.0)
    found = concio.let_go(undecided(block(concio.Rigid(UNIT), 0.2, (tie,), friction=0.0)))
    assert found.verdict.status == "comes_to_rest"
    assert moved(found)[0] == pytest.approx(0.2 * WEIGHT / 500.0, abs=1e-5)
    assert any("fade in the motion" in line for line in found.verdict.limits)
    assert "not for hard ones" in found.verdict.answer


@pytest.mark.long
def test_an_elastic_block_comes_to_rest_as_its_load_step_has_it():
    model = block(concio.Elastic(E=1e4, nu=0.2, unit_weight=UNIT), 0.1, friction=0.6)
    step = concio.solve(model)
    found = concio.let_go(undecided(model))
    assert found.verdict.status == "comes_to_rest"
    assert any("fade in the motion" in line for line in found.verdict.limits)
    force = np.asarray(found.motion.steps.reaction[-1][found.motion.reactions_of.index("floor")])
    assert np.abs(force) == pytest.approx([0.1 * WEIGHT, WEIGHT], rel=1e-2)  # of the last step, in which it still moves
    assert np.abs(np.asarray(step.reactions["floor"])[:2]) == pytest.approx([0.1 * WEIGHT, WEIGHT], rel=1e-6)


@pytest.mark.long  # the one that comes to rest below
def test_an_elastic_block_beyond_its_limit_is_seen_to_fall_and_all_of_it_is_said_in_italian():
    tall = replace(block(concio.Elastic(E=1e5, nu=0.2, unit_weight=UNIT), 2.2, friction=5.0))
    found = concio.let_go(undecided(tall))
    assert found.verdict.outcome is Outcome.FAILS
    told = found.verdict
    texts = (told.question.asked, told.headline, told.answer, told.proof, told.meaning, *told.limits, *told.next_steps)
    for text in texts:
        assert {piece.language for piece in italian(text)} == {"it"}, text


def test_every_outcome_and_what_is_seen_is_said_in_italian():
    from concio.verdict import let_go_verdict as module

    for text in (*module.HEADLINES.values(), *module.MEANINGS.values(), *module.NEXT, module.FADING, module.ONE_MOTION):
        assert {piece.language for piece in italian(text)} == {"it"}, text
    rests = concio.let_go(undecided(block(concio.Rigid(UNIT), friction=0.6)))
    moves = concio.let_go(undecided(block(concio.Rigid(UNIT), 0.9, friction=0.6)), 0.05)
    for found, status in ((rests, "comes_to_rest"), (moves, "still_moves")):
        assert found.verdict.status == status
        assert {piece.language for piece in italian(found.verdict.answer)} == {"it"}, found.verdict.answer


@pytest.mark.long  # test_let_go asks by the command without a directory
def test_the_directory_of_a_step_that_was_let_go_has_its_motion(tmp_path: Path, monkeypatch):
    model = tmp_path / "block.toml"
    model.write_text(dumps(block(concio.Rigid(UNIT), friction=0.6)), encoding="utf-8")
    out = tmp_path / "out"
    code, said, _ = run("run", model, "--let-go", "--out", out, "--no-figures")
    assert code == 0
    assert "not released, as the load step is decided" in said
    assert not (out / "let_go").exists()
    monkeypatch.setattr(run_command, "_followed", lambda result, progress: concio.let_go(undecided(result.model)))
    code, said, _ = run("run", model, "--let-go", "--out", out, "--no-figures", "--language", "it")
    assert code == 0
    assert "comes_to_rest" in said
    assert str(out / "let_go" / "report.html") in said
    text = (out / "let_go" / "report.html").read_text(encoding="utf-8")
    assert "Lasciata da ferma" in text
    assert "Released at rest" not in text
    assert json.loads((out / "let_go" / "summary.json").read_text(encoding="utf-8"))["status"] == "comes_to_rest"
    assert (out / "let_go" / "moved.png").stat().st_size > 1000
    monkeypatch.undo()
    run("run", model, "--out", out, "--no-figures")
    assert not (out / "let_go").exists()  # the motion of an earlier run does not stand beside another result


def test_stones_whose_edges_meet_with_rounding_in_common_move():
    """Two collinear edges of this wall share 3e-17 m: its motion ended with an error of an index."""
    model = concio.load(Path(__file__).parents[3] / "examples" / "rubble_wall.toml")
    found = concio.dynamics(model, duration=4e-3, step=2e-3, start="as described")
    assert found.ending.name == "COMPLETE"
    assert found.steps.residual.max() <= 1e-9
