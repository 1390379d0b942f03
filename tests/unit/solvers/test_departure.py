"""Motions without end: hand-worked accelerations, proofs that fail when anything in them is changed, verdicts."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio import Body, Elastic, JointLaw, Load, Model, Rigid, Status
from concio.cli.lines import result_lines
from concio.contact.inertia import GRAVITY, masses
from concio.io import load_result, save_result
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Departure
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.interior.run import Run
from concio.solvers.methods import find
from concio.solvers.relaxation import slow_step as one_step
from concio.solvers.relaxation.slow_motion import MOST, ahead, relax
from concio.solvers.relaxation.unbounded_motion import unbounded_motion, verify_motion
from concio.solvers.states.state_reading import Finished, natural_residual, read_states
from concio.verdict.step_verdict import proof as certificate_sentence
from concio.verdict.step_verdict import step_verdict as verdict

BRICK = Elastic(E=1e6, nu=0.2, unit_weight=20.0)


def box(name: str, x: float, y: float, w: float, h: float, kind: str = "elastic") -> Body:
    outline = np.array([(x, y), (x + w, y), (x + w, y + h), (x, y + h)])
    return Body(name, outline, "brick", kind)


def between_walls(material: Elastic | Rigid = BRICK) -> Model:
    """A block that touches two vertical walls and nothing else, under its own weight."""
    bodies = (
        box("left", -0.5, 0.0, 0.5, 1.0, "fixed"),
        box("block", 0.0, 0.2, 1.0, 0.5, "rigid" if isinstance(material, Rigid) else "elastic"),
        box("right", 1.0, 0.0, 0.5, 1.0, "fixed"),
    )
    own = Load("weight", (0.0, -1.0)) if material.unit_weight else Load("body", (0.0, -1.0))
    return Model(bodies, {"brick": material}, {"joint": JointLaw(0.5)}, loads=(own,))


def falling(material: Elastic | Rigid = BRICK) -> ContactProblem:
    """The arrays of the block between the walls."""
    return concio.assemble(between_walls(material)).problem()


@cache
def pushed_wall(share: float, mu: float = 0.4) -> ContactProblem:
    """A dry wall of elastic blocks pushed sideways by a share of its weight, on its base."""
    model = concio.running_bond_panel(
        courses=3, blocks=3, block_size=(0.2, 0.1), block=BRICK, friction=mu, base="full", side_walls=False,
        elements_per_block=(2, 1),
    )  # fmt: skip
    model = replace(model, loads=(*model.loads, Load("weight", (share, 0.0))))
    return concio.assemble(model).problem()


@cache
def moving_wall() -> tuple[ContactProblem, Departure]:
    """The wall pushed by more than its friction, and how it moves away."""
    problem = pushed_wall(0.41)
    motion = relax(Run(scale(problem)))
    assert isinstance(motion, Departure)
    return problem, motion


def at(s: Scaled, u: np.ndarray, t: np.ndarray) -> Finished:
    """A point of slow motion."""
    error, _ = natural_residual(s, u, t)
    return Finished(u, t, read_states(s, u, t), error, 0, np.zeros(0, dtype=int))


def test_masses_are_weights_over_gravity() -> None:
    problem = falling()
    assert problem.inertia[::2].sum() == pytest.approx(20.0 * 0.5 / GRAVITY)
    assert problem.inertia[1::2].sum() == pytest.approx(20.0 * 0.5 / GRAVITY)
    rigid = falling(Rigid(unit_weight=20.0))
    np.testing.assert_allclose(rigid.inertia.diagonal()[:2], 20.0 * 0.5 / GRAVITY)


def test_rotational_inertia_of_a_rigid_block_is_that_of_the_textbook() -> None:
    """m (b^2 + h^2) / 12 for a block b x h; the unknown is the rotation times ``reach``."""
    width, height, thickness = 0.5, 1.5, 0.7
    stone = replace(box("stone", 0.1, 0.0, width, height, "rigid"), thickness=thickness)
    model = Model((box("ground", -1.0, -0.2, 3.0, 0.2, "fixed"), stone), {"brick": Rigid(unit_weight=24.0)},
                  {"joint": JointLaw(0.5)}, loads=(Load("weight", (0.0, -1.0)),))  # fmt: skip
    assembly = concio.assemble(model)
    about_centroid = assembly.inertia[2, 2] * assembly.disc.reach[1] ** 2
    mass = 24.0 / GRAVITY * width * height * thickness
    assert about_centroid == pytest.approx(mass * (width**2 + height**2) / 12, rel=1e-13)


def test_masses_without_weight_are_volumes() -> None:
    np.testing.assert_allclose(falling(Elastic(E=1e6, nu=0.2)).inertia[::2].sum(), 0.5)


@pytest.mark.parametrize("element", ["Q4", "Q8", "Q9", "T6"])
def test_masses_are_positive_for_every_element(element: str) -> None:
    model = concio.running_bond_panel(courses=2, blocks=2, block=BRICK, element=element)
    disc = concio.assemble(model).disc
    mass = masses(disc)
    assert np.linalg.eigvalsh(mass.toarray()).min() > 0
    area = sum(b.area * b.thickness for b in model.bodies if b.kind == "elastic")
    assert mass[::2].sum() == pytest.approx(20.0 / GRAVITY * area)


def test_block_between_two_walls_falls_freely() -> None:
    solution = find("auto")(falling())
    assert solution.status is Status.COLLAPSES
    motion = solution.departure
    np.testing.assert_allclose(motion.acceleration[0::2], 0.0, atol=1e-9 * GRAVITY)
    np.testing.assert_allclose(motion.acceleration[1::2], -GRAVITY, rtol=1e-9)
    np.testing.assert_allclose(motion.normal_force, 0.0, atol=1e-9 * 10.0)
    assert motion.power == pytest.approx(1.0)
    assert not solution.displacement.any()


def test_block_on_an_incline_accelerates_as_galileo_says() -> None:
    angle, mu = np.radians(30.0), 0.3
    rotate = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    bodies = tuple(
        replace(b, outline=b.outline @ rotate.T)
        for b in (box("ground", -1.0, -0.2, 4.0, 0.2, "fixed"), box("block", 1.0, 0.0, 0.8, 0.2))
    )
    model = Model(bodies, {"brick": BRICK}, {"joint": JointLaw(mu)}, loads=(Load("weight", (0.0, -1.0)),))
    problem = concio.assemble(model).problem()
    s = scale(problem)
    m = problem.pairs
    down = -np.tile(rotate[:, 0], problem.unknowns // 2)
    motion = unbounded_motion(s, at(s, np.zeros(problem.unknowns), np.tile([1.0, 0.0], (m, 1))), down)
    assert motion is not None
    expected = -GRAVITY * (np.sin(angle) - mu * np.cos(angle)) * rotate[:, 0]
    np.testing.assert_allclose(motion.acceleration.reshape(-1, 2), np.tile(expected, (problem.unknowns // 2, 1)),
                               rtol=1e-8, atol=1e-8)  # fmt: skip


@pytest.mark.long
def test_wall_moves_away_and_its_proof_stands_by_itself() -> None:
    problem, ended = moving_wall()
    a, u, t_n, t_t = ended.acceleration, ended.displacement, ended.normal_force, ended.friction_force[:, 0]
    total = np.abs(problem.f).sum()
    # equilibrium with inertia, friction cones, rates of closed joints: written out here again
    balance = problem.K @ u + problem.inertia @ a - problem.f - problem.C_n.T @ t_n - problem.C_t.T @ t_t
    assert np.abs(balance).max() < 1e-9 * total
    assert (np.abs(t_t) <= problem.laws.friction * t_n + 1e-9 * total).all()
    top = np.abs(a).max()
    w_n, w_t = problem.C_n @ a, problem.C_t @ a
    pressed = t_n > 1e-6 * total
    assert pressed.any()
    assert np.abs(w_n[pressed]).max() < 1e-8 * top
    assert w_n.min() > -1e-8 * top
    slides = pressed & (np.abs(w_t) > 1e-6 * top)
    assert slides.any()
    np.testing.assert_allclose(a[0::2], GRAVITY * (0.41 - 0.4), rtol=1e-7)  # all of it, over the base alone
    np.testing.assert_allclose(a[1::2], 0.0, atol=1e-9 * GRAVITY)
    np.testing.assert_allclose(
        t_t[slides], -(problem.laws.friction * t_n * np.sign(w_t))[slides], rtol=0, atol=1e-8 * total
    )
    assert problem.f @ a > a @ (problem.inertia @ a) > 0


@pytest.mark.parametrize("part", ["acceleration", "displacement", "normal_force", "friction_force"])
def test_a_changed_proof_is_refused(part: str) -> None:
    problem, motion = moving_wall()
    pieces = {n: getattr(motion, n) for n in ("acceleration", "displacement", "normal_force", "friction_force")}

    def check(values: dict[str, np.ndarray]) -> Departure:
        return verify_motion(problem, *(values[n] for n in pieces))

    assert check(pieces).certified
    for change in (1.0 + 1e-4, -1.0):
        assert not check({**pieces, part: change * pieces[part]}).certified


def test_a_motion_into_the_ground_is_no_departure() -> None:
    """A load that keeps the balance of accelerations, downward: nothing is wrong but that joints close without end."""
    problem, motion = moving_wall()
    down = np.zeros_like(motion.acceleration)
    down[1::2] = -0.01 * np.abs(motion.acceleration).max()
    pressed = problem.with_loads(problem.f + problem.inertia @ down)
    state = motion.displacement, motion.normal_force, motion.friction_force
    found = verify_motion(pressed, motion.acceleration + down, *state)
    assert motion.violation < 1e-11
    assert found.violation == pytest.approx(0.01, abs=10 * motion.violation)


def test_a_joint_that_crushes_without_end_is_a_departure() -> None:
    """A block that weighs 14 kN/m2 on a bed that carries 8: it sinks with what is left of its weight."""
    bodies = (box("ground", -1.0, -0.2, 4.0, 0.2, "fixed"), box("block", 1.0, 0.0, 0.8, 0.7, "rigid"))
    law = JointLaw(0.3, compressive_strength=8.0)
    loads = (Load("weight", (0.0, -1.0)),)
    problem = concio.assemble(Model(bodies, {"brick": Rigid(unit_weight=20.0)}, {"joint": law}, loads=loads)).problem()
    sinks, none = np.array([0.0, -GRAVITY * (1 - 8.0 / 14.0), 0.0]), np.zeros((problem.pairs, 1))
    crushed = verify_motion(problem, sinks, np.array([0.0, -0.3, 0.0]), problem.cone.cap, none)
    assert crushed.violation <= 1e-14
    carried = verify_motion(problem, 0.0 * sinks, np.array([0.0, -0.3, 0.0]), 14.0 / 8.0 * problem.cone.cap, none)
    assert not carried.certified


@pytest.mark.parametrize(("error", "taken"), [(0.5, True), (2.0, False)])
def test_a_step_is_taken_from_the_best_iterate_where_that_is_near_enough(
    monkeypatch: pytest.MonkeyPatch, error: float, taken: bool
) -> None:
    run = Run(scale(pushed_wall(0.1)))
    best = SimpleNamespace(error=error * one_step.RELAXED)

    class GivesUp(Run):
        def attempts(self, further=()):
            self.best = best
            yield None

    run = GivesUp(run.scaled)
    assert one_step.solve_afresh(run, run.scaled) is (best if taken else None)


def test_what_stands_comes_to_rest() -> None:
    problem = pushed_wall(0.1)
    whole = find("interior-point")(problem)
    run = Run(scale(problem))
    for begin in (None, 2.0 * whole.displacement / run.scaled.length):
        ended = relax(run, begin)
        assert not isinstance(ended, Departure)
        assert ended is not None
        u, t_n, t_t = run.scaled.restore(ended.u, ended.t)
        assert concio.problem.certificate.certify(problem, u, t_n, t_t).certified
        np.testing.assert_allclose(u, whole.displacement, rtol=0, atol=1e-8 * np.abs(u).max())
        told = re.fullmatch(r"release: (\d+) steps of slow motion, 0 failed, comes to rest", run.trace[-1])
        assert told is not None, run.trace
        assert 1 <= int(told[1]) < MOST[2]


@pytest.mark.parametrize("lift", [0.1, 1.0])
def test_a_block_is_carried_clear_of_what_it_leaves(lift: float) -> None:
    """A block lifted off the ground and thrown aside, from a place deep within it, one corner deeper than the other."""
    bodies = (box("ground", -1.0, -0.2, 4.0, 0.2, "fixed"), box("block", 1.0, 0.0, 0.8, 0.2, "rigid"))
    loads = (Load("weight", (1.0, lift)),)
    problem = concio.assemble(
        Model(bodies, {"brick": Rigid(unit_weight=20.0)}, {"joint": JointLaw(0.3)}, loads=loads)
    ).problem()
    m = problem.pairs
    s = scale(problem)
    motion = unbounded_motion(s, at(s, np.array([0.0, 0.0, 50.0]), np.zeros((m, 2))), np.array([1.0, lift, 0.0]))
    assert motion is not None
    assert motion.certified
    np.testing.assert_allclose(motion.acceleration, [GRAVITY, lift * GRAVITY, 0.0], rtol=1e-9, atol=1e-9)
    assert (problem.gap + problem.C_n @ motion.displacement >= -1e-9).all()


def test_held_bodies_have_no_departure() -> None:
    problem = falling()
    held = replace(problem, K=sp.csr_array(problem.K + sp.eye_array(problem.unknowns)), R=problem.R[:, :0])
    s = scale(held)
    m = held.pairs
    assert unbounded_motion(s, at(s, np.zeros(held.unknowns), np.zeros((m, 2))), np.ones(held.unknowns)) is None


def test_verdict_of_a_motion_reaches_the_result() -> None:
    model = between_walls()
    with pytest.raises(concio.NoEquilibriumError, match="moves away"):
        concio.solve(model)
    result = concio.solve(model, on_failure="return")
    assert result.status is Status.COLLAPSES
    assert result.status.exit_code == 3
    assert result.mechanism.power == pytest.approx(10.0)
    assert "moves away" in str(result) or "moves away" in result.status.value
    result.plot.mechanism()


def test_verdict_of_a_motion_is_stored_and_told(tmp_path: Path) -> None:
    result = concio.solve(between_walls(), on_failure="return")
    save_result(result, tmp_path)
    again = load_result(tmp_path)
    assert again.status is Status.COLLAPSES
    np.testing.assert_array_equal(again.solution.departure.acceleration, result.solution.departure.acceleration)
    assert "moves away" in verdict(again).headline
    assert "mass" in certificate_sentence(again)
    assert any(line.startswith("  motion") for line in result_lines(again))


def test_a_problem_without_pairs_is_linear_or_falls() -> None:
    problem = falling()
    nothing = np.zeros(problem.pairs, bool)
    alone = replace(
        problem, C_n=problem.C_n[nothing], C_t=problem.C_t[nothing], gap=problem.gap[nothing],
        laws=problem.laws[nothing], slip_origin=problem.slip_origin[nothing], area=problem.area[nothing],
    )  # fmt: skip
    assert find("auto")(alone).status is Status.NO_EQUILIBRIUM
    held = replace(alone, K=sp.csr_array(alone.K + sp.eye_array(alone.unknowns)), R=alone.R[:, :0])
    answer = find("auto")(held)
    assert answer.solved
    np.testing.assert_allclose(held.K @ answer.displacement, held.f, rtol=0, atol=1e-9 * 10.0)


def test_a_steady_motion_goes_on_almost_to_where_a_pair_meets_or_a_slip_has_gone_back() -> None:
    """Gaps over rates by hand, of pairs that come nearer, and of slips that go back under pressure."""
    known = {
        "meets": ((1.0, 0.0), (-0.01, 0.0)), "parts": ((1.0, 0.0), (0.01, 0.0)), "back": ((0.0, 0.5), (0.0, -0.02)),
        "away": ((0.0, 0.5), (0.0, 0.02)), "dust": ((0.0, 1e-8), (0.0, -1e-9)),
    }  # fmt: skip

    def asked(*names: str, pressed: float = 1.0) -> float:
        places, rates = (np.array([known[name][i] for name in names]) for i in (0, 1))
        rough = np.ones(len(names), dtype=bool)
        at: Any = SimpleNamespace(position=lambda u, t: places, along=lambda step: rates, rough=rough)
        return ahead(at, np.zeros(1), np.full((len(names), 2), pressed), np.zeros(1))

    assert asked("meets", "parts", "away") == pytest.approx(0.999 * 100.0)
    assert asked("back", "meets", "dust") == pytest.approx(0.999 * 25.0)
    assert asked("back", "meets", pressed=0.0) == pytest.approx(0.999 * 100.0)
    assert asked("parts", "away") == 0.0
