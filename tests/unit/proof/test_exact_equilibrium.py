"""Equilibrium certificates: closed forms, the answers of the solver, and a program that refuses what was changed."""

from __future__ import annotations

import itertools
import subprocess
import sys
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from commands import run
from concio import Body, Elastic, JointLaw, JointRule, Load, Model, Rigid, Support, Tie
from concio.analysis.lent_compliance import lend
from concio.errors import InputError, SolverError
from concio.problem.pair_state import PairStates
from concio.problem.solution import Status
from concio.proof import verify_equilibrium as checker
from concio.proof.equilibrium import prove_equilibrium
from concio.proof.exact_certificate import prove_balance, sealed
from concio.proof.programs import recompute
from pillars import pillar, sideways
from samples import sample

PUSHED = (Load("weight", (0, -1)), Load("weight", (1, 0), group="live"))
SPRINGS = JointLaw(0.6, normal_stiffness=4e4, tangential_stiffness=2e4)


def block(kind: str = "rigid", push: float = 0.25, law: JointLaw = SPRINGS, **more: Any) -> concio.Result:
    """Return the answer for a block of 1 m and 20 kN on the ground."""
    ground = Body("ground", [(-1, -1), (3, -1), (3, 0), (-1, 0)], kind="fixed")
    a = Body("a", [(0, 0), (1, 0), (1, 1), (0, 1)], kind=kind, material="stone")
    stone: Any = Rigid(20.0) if kind == "rigid" else Elastic(E=1e5, nu=0.2, unit_weight=20.0)
    given: dict[str, Any] = {"laws": {"joint": law}, "loads": PUSHED, "mesh_size": 0.5, **more}
    return concio.solve(Model((ground, a), {"stone": stone}, **given), factors={"live": push}, on_failure="return")


def solved(made: dict[str, Any]) -> tuple[list[tuple[Fraction, Fraction]], int]:
    """Return the bounds of all unknowns and the number of those of the blocks."""
    rows, right, _ = checker.system(made)
    return checker.solution(made, rows, right), checker.numbering(made)[2]


def test_a_block_on_springs_has_the_motion_of_the_closed_form() -> None:
    """It moves by H/k_t and sinks by W/k_n, and turns by H/2 over the sum of k x^2 about the middle of the joint."""
    made = block(law=JointLaw(5.0, normal_stiffness=4e4, tangential_stiffness=2e4)).proof("decimal")
    (x, n), (w, h) = solved(made), (Fraction(20), Fraction(5))
    arms = [(checker.exact(j["at"][0]) - Fraction(1, 2), checker.exact(j["normal_compliance"])) for j in made["joints"]]
    turn = -(h / 2) / sum(arm**2 / a for arm, a in arms)
    right = [h / 20000, -w / 40000 - turn / 2, turn]
    assert n == 3
    assert "(0 open, 5 closed, 0 crushed, 0 at the limit of friction)" in recompute(made)
    for (low, high), value in zip(x[:3], right, strict=True):
        assert low <= value <= high
        assert high - low < Fraction(1, 10**15)


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("push", [0.1, 0.3, 0.55])
def test_enclosures_hold_the_answer_of_the_solver(kind: str, push: float) -> None:
    result = block(kind, push)
    made = result.proof()
    assert "a Coulomb equilibrium" in recompute(made)
    x, n = solved(made)
    forces = np.array([float(low) for low, _ in x[n:]]).reshape(-1, 2)
    assert np.allclose(forces[:, 0], result.contacts.normal_force, atol=1e-9)
    assert np.allclose(forces[:, 1], result.contacts.friction_force.ravel(), atol=1e-9)
    bodies = [float(low) for low, _ in x[:3]]
    if kind == "rigid":  # the middle of the block, from the motion of the origin
        centre = result.displacement[:2]
        assert np.allclose([bodies[0] - 0.5 * bodies[2], bodies[1] + 0.5 * bodies[2]], centre, atol=1e-12)


@pytest.mark.parametrize(
    "more",
    [
        {"ties": (Tie("rod", "a", (0, 0.5), "", (-2, 0.5), 1e4, prestress=1.0, yield_force=3.0),)},
        {"law": JointLaw(0.3, 3.0, 1.0, normal_stiffness=4e4, tangential_stiffness=4e4)},
        {"supports": (Support("top", "a", edge=((0, 1), (0, 1)), directions="x"),)},
        {"rules": (JointRule("joint", gap=1e-4),), "push": 0.1},
    ],
    ids=["tie", "cohesion", "held", "gap"],
)
@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_ties_strength_held_blocks_and_gaps_are_proved(kind: str, more: dict[str, Any]) -> None:
    result = block(kind, **more)
    sentence = recompute(result.proof())
    assert "proved" in sentence
    solution, problem = result.solution, result.assembly.problem(result.factors)
    strength = problem.cone.linear_strength(solution.normal_force)
    full = (np.abs(solution.friction_force).ravel() > strength - 1e-9) & (strength > 1e-9)
    assert f" crushed, {full.sum()} at the limit of friction)" in sentence


def test_rigid_blocks_on_hard_joints_are_proved_for_any_small_compliance() -> None:
    made = block(law=JointLaw(0.6)).proof()
    assert "with these compliances or any multiple of them: proved" in recompute(made)
    assert "lent" in made
    fails = block(push=0.7, law=JointLaw(0.6))
    assert fails.proof()["claim"] == "collapse"
    assert "balance" in fails.proved


def hanging(stiffness: float | None) -> Model:
    """Return a block between two walls that do not squeeze it."""
    faces = {"l": (-1, 0, "fixed"), "r": (1, 2, "fixed"), "b": (0, 1, "rigid")}
    bodies = [Body(name, [(x, 0), (z, 0), (z, 1), (x, 1)], kind=kind) for name, (x, z, kind) in faces.items()]
    law = {"joint": JointLaw(0.6, normal_stiffness=stiffness, tangential_stiffness=stiffness)}
    return Model(tuple(bodies), {"block": Rigid(20.0)}, law, loads=(Load("weight", (0, -1)),))


@pytest.mark.parametrize("stiffness", [None, 1e7, 1e12])
def test_a_block_that_nothing_squeezes_has_no_certificate_of_equilibrium(stiffness: float | None) -> None:
    """Forces out of nothing balance its weight; no compliance, however small, brings them about."""
    result = concio.solve(hanging(stiffness), on_failure="return")
    with pytest.raises(SolverError):
        result.proof()
    assert result.proved == ""
    lent = lend(concio.assemble(hanging(stiffness)))
    m = len(lent.pairs)
    forces = np.column_stack([np.full(m, 100.0), np.zeros(m)])
    for codes in itertools.product((0, 1), (0, 1, -1), repeat=2):  # both joints open or closed, stick or slip
        normal = np.array(codes[::2])[lent.pairs.interface]
        states = PairStates.plane(normal, np.array(codes[1::2])[lent.pairs.interface])
        with pytest.raises(SolverError):
            prove_equilibrium(lent, None, states, forces)


def test_collapse_for_want_of_a_joint_that_was_almost_made_has_no_certificate() -> None:
    """A beam on a bearing and a knife edge stands; an edge has no area for a strength, and no joint is made there."""
    ground = Body("g", [(-0.5, 0), (0.2, 0), (0.2, 1), (-0.5, 1)], kind="fixed")
    knife = Body("k", [(3.8, 0.5), (4.2, 0.5), (4, 1)], kind="fixed")
    beam = Body("beam", [(0, 1), (4.5, 1), (4.5, 1.3), (0, 1.3)], kind="rigid")
    law = {"joint": JointLaw(0.6, compressive_strength=1e4)}
    model = Model((ground, knife, beam), {"block": Rigid(20.0)}, law, loads=(Load("weight", (0, -1)),))
    result = concio.solve(model, on_failure="return")
    with pytest.raises(InputError, match="almost made"):
        result.proof()
    assert result.proved == ""


def test_forces_chosen_at_will_are_refused_by_the_program() -> None:
    """A hand-made certificate of the hanging block without compliance, with forces that balance its weight."""
    made = prove_balance(concio.assemble(hanging(None)))
    x = ["0", "0", "0"]
    for joint, force in zip(made["joints"], made["forces"], strict=True):
        n, f = ([Fraction(checker.exact(t)) for t in texts] for texts in (joint["normal"], force))
        x += [str(n[0] * f[0] + n[1] * f[1]), str(n[0] * f[1] - n[1] * f[0])]
    states = [["closed", "stick"]] * len(made["joints"])
    false = {**made, "claim": "equilibrium", "shapes": [], "states": states, "solution": x}
    with pytest.raises(ValueError, match="any forces would pass"):
        checker.check(sealed(false))


@pytest.mark.parametrize("name", ["friction", "normal_compliance", "tangential_compliance"])
def test_a_joint_with_a_negative_number_is_refused(name: str) -> None:
    made = block().proof()
    joints = [{**joint, name: "-1/1000"} for joint in made["joints"]]
    with pytest.raises(ValueError, match="below 0"):
        checker.check(sealed({**made, "joints": joints}))


def wall(number: int) -> concio.Result:
    """Return the answer for a wall of elastic blocks of random friction, weight and push."""
    rng = np.random.default_rng(number)
    model = concio.wall(
        length=1.0, height=0.6, block_size=(0.5, 0.2), unit_weight=float(rng.uniform(15, 28)), mesh_size=0.25,
        friction=float(rng.uniform(0.3, 0.9)), horizontal=float(rng.choice([-1.0, 1.0])),
    )  # fmt: skip
    return concio.solve(model, factors={"live": float(rng.uniform(0, 0.25))}, on_failure="return")


@pytest.mark.parametrize("number", range(sample(2, 8, 20)))
def test_elastic_walls_are_proved_though_joint_points_repeat_each_other(number: int) -> None:
    result = wall(number)
    made = result.proof()
    x, n = solved(made)
    total = sum(high - low for low, high in x)
    assert total < Fraction(1, 10**15)
    assert made["left_out"], "corners of three blocks have points that repeat each other"
    wanted = result.contacts.normal_force
    found = np.array([float(low) for low, _ in x[n::2]])[: len(wanted)]
    _, place, count = np.unique(result.contacts.point.round(9), axis=0, return_inverse=True, return_counts=True)
    alone = count[place.ravel()] == 1  # elsewhere blocks share their forces in several ways
    assert 5 < alone.sum() < len(wanted)
    assert np.allclose(found[alone], wanted[alone], atol=1e-7 * np.abs(found).max())


def test_states_that_are_not_those_of_the_answer_are_refused() -> None:
    made = block("elastic").proof()
    base = {k: v for k, v in made.items() if k != "digest"}
    for k, (normal, along) in enumerate(made["states"]):
        for other in ([normal, "+"], [normal, "-"], ["open", "free"], ["closed", "stick"]):
            if other == [normal, along]:
                continue
            states = deepcopy(made["states"])
            states[k] = other
            with pytest.raises((ValueError, ZeroDivisionError, KeyError)):
                checker.check(sealed({**base, "states": states}))


def test_joints_on_the_edge_are_exact_or_named() -> None:
    """A block without weight touches and is not pressed: no interval says that it neither opens nor presses."""
    ground = Body("ground", [(-1, -1), (3, -1), (3, 0), (-1, 0)], kind="fixed")
    a = Body("a", [(0, 0), (1, 0), (1, 1), (0, 1)], kind="elastic", material="stone")
    loads = (Load("point", (0, -8.0), bodies=("a",), at=(0.5, 1.0)),)
    law = {"joint": JointLaw(0.5, normal_stiffness=1e4, tangential_stiffness=1e4)}
    model = Model((ground, a), {"stone": Elastic(E=1e5, nu=0.0, unit_weight=0.0)}, law, loads=loads, mesh_size=0.5)
    assert "proved" in recompute(concio.solve(model).proof())


def test_what_is_not_stated_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="a joint that dilates"):
        block(law=JointLaw(0.6, dilatancy=0.1, normal_stiffness=4e4)).proof()
    with pytest.raises(InputError, match="a support that is moved"):
        block(supports=(Support("sinks", "ground", displacement=(0.0, -0.1)),)).proof()
    left_open = replace(block().solution, status=Status.UNDECIDED)
    with pytest.raises(SolverError, match="no exact certificate"):
        replace(block(), solution=left_open).proof()


def test_the_program_runs_alone_and_commands_prove_and_verify(tmp_path: Path) -> None:
    model = tmp_path / "pillar.toml"
    model.write_text(pillar(sideways(0.1)))
    code, out, err = run("prove", model, "--claim", "equilibrium")
    assert (code, err) == (0, "")
    assert "a Coulomb equilibrium" in out
    file = tmp_path / "pillar.proof.json"
    assert "a Coulomb equilibrium" in run("verify", file)[1]
    alone = [sys.executable, "-I", "-S", str(Path(checker.__file__)), str(file)]
    done = subprocess.run(alone, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (done.returncode, "proved" in done.stdout) == (0, True)
    file.write_text(file.read_text().replace("equilibrium", "limit"))
    done = subprocess.run(alone, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (done.returncode, done.stdout[:8]) == (1, "REFUSED:")
    imports = [line for line in Path(checker.__file__).read_text().splitlines() if line.startswith(("import", "from"))]
    assert "concio" not in " ".join(imports)


def test_reports_and_notebooks_say_that_it_is_proved_where_it_is() -> None:
    assert "Proved" in block(law=JointLaw(0.6))._repr_html_()
    assert "Proved exactly" in block(push=0.7, law=JointLaw(0.6))._repr_html_()
    assert "Proved, with intervals" in wall(0)._repr_html_()
    dilates = block(law=JointLaw(0.6, dilatancy=0.1, normal_stiffness=4e4))
    assert dilates.proved == ""
    assert "Proved" not in dilates._repr_html_()
