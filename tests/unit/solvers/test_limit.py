"""Limit multipliers that can be found by hand, and the bounds that check them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.errors import SolverError
from concio.problem.solution import Mechanism
from concio.solvers.statics import collapse_search, collapse_state
from concio.solvers.statics import friction as least_friction
from concio.solvers.statics import programme as statics
from concio.solvers.statics.associated_limit import associated_limit, kinematic_bound
from concio.solvers.statics.collapse_search import find_collapse_state
from concio.solvers.statics.collapse_state import certify_collapse
from concio.solvers.statics.existence import StaticState, statically_admissible
from concio.solvers.statics.friction import smallest_friction
from rigid_walls import FERRIS_TIN_LOI, MU, block_on_incline, semicircular_arch, wall


@pytest.mark.parametrize(
    ("mu", "changes", "wanted"),
    [
        (0.3, {}, 0.3),  # slides
        (0.9, {}, 0.4),  # topples about the toe: (b/2) / (h/2)
        (0.3, {"cohesion": 0.02}, 0.34),  # slides with the cohesion of two pairs
        (0.9, {"cohesion": 0.1, "tension": 0.1}, 0.48),  # toe moment: 0.2 W + 0.4 T over 0.5
        (0.9, {"cap": 0.8}, 0.24),  # crushes: arm of the reactions (2 x 0.8 - 1) 0.2 ... see below
    ],
)
def test_one_block(mu, changes, wanted):
    """Block 0.4 x 1.0 of weight 1 pushed at mid-height; with a cap N the toe carries N, the heel 1 - N."""
    a = block_on_incline(0.4, 1.0, 0.0)
    found = associated_limit(a.problem(mu, a.load(0, -1), **changes), a.load(1, 0))
    assert found.multiplier == pytest.approx(wanted, abs=1e-12)
    assert found.checked
    assert found.upper == pytest.approx(wanted, abs=1e-12)
    assert found.mechanism is not None
    assert abs(found.mechanism.power) <= 1e-12


def test_unbounded_and_impossible():
    a = block_on_incline(0.4, 1.0, 0.0)
    p = a.problem(0.5, a.load(0, -1))
    press = associated_limit(p, a.load(0, -1))
    assert press.multiplier == np.inf
    assert press.checked
    lifted = associated_limit(p.with_loads(a.load(0, 1.0)), a.load(1, 0))
    assert np.isnan(lifted.multiplier)
    assert not lifted.checked


def test_a_load_that_pushes_nothing_leaves_forces_of_the_shape_of_any_other_answer():
    """A load along what the block cannot move to: of equal and opposite parts, which its stiffness takes."""
    a = block_on_incline(0.4, 1.0, 0.0)
    found = associated_limit(a.problem(0.5, a.load(0, -1)), np.zeros(a.load(1, 0).size))
    pushed = associated_limit(a.problem(0.5, a.load(0, -1)), a.load(1, 0))
    assert found.locked
    assert found.normal_force.shape == pushed.normal_force.shape
    assert found.friction_force.shape == pushed.friction_force.shape


def test_negative_multiplier_when_the_dead_load_fails():
    """At 20 degrees and mu 0.3 the block needs a push up the plane; the least push counts as a negative multiplier."""
    angle = np.deg2rad(20)
    a = block_on_incline(2.0, 0.1, angle)
    down = np.array([-np.cos(angle), -np.sin(angle), 0.0])
    found = associated_limit(a.problem(0.3, a.load(0, -1)), down)
    assert found.multiplier == pytest.approx(0.3 * np.cos(angle) - np.sin(angle), abs=1e-12)
    assert found.multiplier < 0


def test_the_bounds_enclose_the_truth_even_for_poor_answers():
    a = wall(FERRIS_TIN_LOI["wall 1"])
    p, live = a.problem(MU, a.load(0, -1)), a.load(1, 0)
    found = associated_limit(p, live)
    other = a.problem(MU, a.load(0, -1)).with_loads(a.load(0, -2))
    upper, _ = kinematic_bound(other, live, 2 * found.multiplier, found.mechanism.velocity)
    assert upper == pytest.approx(2 * found.multiplier, rel=1e-9)
    # any other admissible mechanism gives a larger multiplier: the first course sliding off as a whole
    slide = np.tile([1.0, MU, 0.0], a.blocks)
    upper, mechanism = kinematic_bound(p, live, found.multiplier, slide)
    assert mechanism.violation <= 1e-15
    assert upper == pytest.approx(MU)
    assert upper > found.multiplier


@pytest.mark.parametrize("angle", [5.0, 20.0, 35.0])
def test_smallest_friction_of_an_incline_is_its_slope(angle):
    slope = np.tan(np.deg2rad(angle))
    a = block_on_incline(2.0, 0.5, np.deg2rad(angle))
    found = smallest_friction(a.problem(1.0, a.load(0, -1)))
    assert found.factor == pytest.approx(slope, abs=1e-7)
    assert found.below < slope
    assert found.programmes < 40


def test_smallest_friction_at_its_ends():
    a = block_on_incline(2.0, 0.5, 0.0)
    assert smallest_friction(a.problem(0.5, a.load(0, -1))).factor == 0.0
    lifted = smallest_friction(a.problem(0.5, a.load(0, 1)))
    assert lifted.factor == np.inf  # no friction holds it
    assert lifted.below >= 1024
    assert lifted.settled


def test_smallest_friction_above_what_there_is():
    """A push of 0.6 with friction 0.5: 1.2 times the friction is needed, and both sides of that are proofs."""
    a = block_on_incline(2.0, 0.5, 0.0)
    found = smallest_friction(a.problem(0.5, a.load(0.6, -1)))
    assert found.factor == pytest.approx(1.2, abs=1e-6)
    assert 1.2 - 1e-6 < found.below < 1.2 <= found.factor
    assert found.settled


@pytest.fixture
def only_verdicts(monkeypatch):
    """Let verdicts be those of a table: holds at and above ``least``, nothing is known at ``silent``, no slope."""

    def put(least, silent=()):
        def verdict(problem, *, thorough=True):
            factor = float(problem.laws.friction[0] / 0.5)
            zero, none = np.zeros(problem.pairs), np.zeros(problem.unknowns)
            holds = factor >= least
            mechanism = None if holds or factor in silent else Mechanism(none, 1.0, 0.0)
            return StaticState(holds, zero, zero[:, None], 0.0, none, mechanism)

        monkeypatch.setattr(least_friction, "statically_admissible", verdict)

    return put


def test_least_friction_without_a_slope_is_bisected(only_verdicts):
    a = block_on_incline(2.0, 0.5, 0.0)
    only_verdicts(0.3217)
    found = smallest_friction(a.problem(0.5, a.load(0, -1)), tolerance=1e-6)
    assert found.below < 0.3217 <= found.factor < found.below + 1e-6
    assert found.programmes <= 23  # 0, 1 and twenty halvings


def test_least_friction_without_a_lower_proof_is_left_open(only_verdicts):
    a = block_on_incline(2.0, 0.5, 0.0)
    only_verdicts(0.5, silent=(0.0,))
    found = smallest_friction(a.problem(0.5, a.load(0, -1)))
    assert (found.factor, found.below, found.programmes) == (1.0, -np.inf, 2)
    assert not found.settled


@pytest.mark.long
def test_smallest_friction_of_a_thin_arch_is_bounded_by_proofs():
    """400 voussoirs, weight on the centre line, thickness next to the least: factor was nan with below = 1, "shown"."""
    a = semicircular_arch(400, 0.107428)
    middle = np.pi * (np.arange(400) + 0.5) / 400
    lumped = replace(a, centres=np.column_stack([np.cos(middle), np.sin(middle)]))
    problem = lumped.problem(20.0, a.load(0, -1))
    found = smallest_friction(problem)
    assert 0 < found.below <= found.factor < 1
    assert statically_admissible(problem.with_friction(found.factor)).exists
    assert statically_admissible(problem.with_friction(found.below)).mechanism is not None


def test_smallest_friction_agrees_with_the_limit_multiplier():
    """At the limit load of wall 1 the friction that limit was computed with is the smallest that holds."""
    a = wall(FERRIS_TIN_LOI["wall 1"])
    limit = associated_limit(a.problem(0.5, a.load(0, -1)), a.load(1, 0)).multiplier
    found = smallest_friction(a.problem(MU, a.load(limit, -1)))
    assert found.factor * MU == pytest.approx(0.5, abs=1e-7)


@pytest.mark.parametrize(("mu", "wanted", "motion"), [(0.3, 0.3, [1, 0, 0]), (0.9, 0.4, [0.5, 0.2, -1.0])])
def test_collapse_state_of_one_block(mu, wanted, motion):
    """Sliding without dilatancy, or rocking about the toe."""
    a = block_on_incline(0.4, 1.0, 0.0)
    found = find_collapse_state(a.problem(mu, a.load(0, -1)), a.load(1, 0), starts=1, iterations=5).state
    assert found is not None
    assert found.certified
    assert found.multiplier == pytest.approx(wanted, rel=1e-12)
    assert found.velocity == pytest.approx(motion, abs=1e-9)


def test_collapse_state_with_cohesion_and_tension():
    a = block_on_incline(0.4, 1.0, 0.0)
    sliding = a.problem(0.3, a.load(0, -1), cohesion=0.02)
    slides = find_collapse_state(sliding, a.load(1, 0), starts=1, iterations=5).state
    assert slides.multiplier == pytest.approx(0.34, rel=1e-9)
    rocking = a.problem(0.9, a.load(0, -1), cohesion=0.1, tension=0.1)
    rocks = find_collapse_state(rocking, a.load(1, 0), starts=1, iterations=5).state
    assert rocks.multiplier == pytest.approx(0.48, rel=1e-9)


def test_a_motion_that_is_no_collapse_is_not_certified():
    a = block_on_incline(0.4, 1.0, 0.0)
    p = a.problem(0.9, a.load(0, -1))
    assert certify_collapse(p, a.load(1, 0), np.array([1.0, 0.0, 0.0]), 0) is None  # slides at 0.9, topples at 0.4
    assert certify_collapse(p, a.load(1, 0), np.array([0.0, -1.0, 0.0]), 0) is None
    crushing = a.problem(0.9, a.load(0, -1), cap=0.8)
    assert certify_collapse(crushing, a.load(1, 0), np.array([0.5, 0.2, -1.0]), 0) is None  # toe too weak
    sinking = np.array([0.5, -0.2, -1.0])  # about the heel, the toe sinks
    assert certify_collapse(a.problem(0.9, a.load(0, -1)), a.load(1, 0), sinking, 0) is None
    assert certify_collapse(crushing, a.load(1, 0), sinking, 0) is not None


@pytest.mark.parametrize(
    ("mu", "cap", "cohesion", "wanted", "motion"),
    [
        (0.9, 0.8, 0.0, 0.24, [0.5, -0.2, -1.0]),  # toe carries 0.8, heel 0.2: (0.8 - 0.2) 0.2 = 0.5 lambda; toe sinks
        (0.9, 2.0, 0.0, 0.4, [0.5, 0.2, -1.0]),  # topples before the toe is crushed
        (0.2, 0.8, 0.0, 0.2, [1.0, 0.0, 0.0]),  # slides
        ([0.9, 0.0], [np.inf, 0.8], [1.0, 0.0], 0.24, [0.5, -0.2, -1.0]),  # the same on a smooth toe, glued at the heel
    ],
)
@pytest.mark.parametrize("large", [1, 10**9])
def test_collapse_state_with_a_cap(monkeypatch, large, mu, cap, cohesion, wanted, motion):
    monkeypatch.setattr(statics, "LARGE", large)
    monkeypatch.setattr(collapse_state, "LARGE", large)
    a = block_on_incline(0.4, 1.0, 0.0)
    p = a.problem(np.asarray(mu) * np.ones(2), a.load(0, -1), cap=cap, cohesion=cohesion)
    found = find_collapse_state(p, a.load(1, 0), starts=1, iterations=8).state
    assert found is not None
    assert found.certified
    assert found.multiplier == pytest.approx(wanted, rel=1e-9)
    assert found.velocity == pytest.approx(motion, abs=1e-9)


def test_a_programme_that_stops_ends_one_start_of_the_search_and_not_the_analysis(monkeypatch) -> None:
    """Strengths that grow with the load led to programmes of 1e16 times the load, and an error for an answer."""
    made = []

    def stops(problem, live, **options):
        made.append(1)
        if len(made) > 2:
            msg = "the linear programme stopped"
            raise SolverError(msg)
        return associated_limit(problem, live, **options)

    monkeypatch.setattr(collapse_search, "associated_limit", stops)
    a = wall(FERRIS_TIN_LOI["wall 1"])
    found = find_collapse_state(a.problem(MU, a.load(0, -1)), a.load(1, 0), starts=3)
    assert len(made) > 3, "the other starts are made"
    assert found.state is None or found.state.certified


def test_a_load_that_presses_the_joints_is_unbounded_and_no_state_of_its_reverse_is_told() -> None:
    """Strengths that grow with the load led the search to programmes of 1e16 times the load: an error."""
    wall = concio.wall(length=2.0, height=1.5, block_size=(0.5, 0.25), block="rigid", unit_weight=20, friction=0.6)
    found = concio.limit(replace(wall, loads=(*wall.loads, concio.Load("weight", (0.0, -1.0), group="live"))))
    assert found.verdict.outcome.name == "HOLDS"
    assert "without bound" in found.verdict.answer
    assert found.collapse_state is None
