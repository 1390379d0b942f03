"""Two joint laws of one file each, by closed forms: cohesion that is lost with slip, stiffness that hardens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import concio
from cohesion_lost import CohesionLost
from models import box, on_ground
from stiffness_hardens import StiffnessHardens

PRESSURE, SIDE = 100.0, 0.5
BLOCKS = 3
SOFT = concio.JointLaw(0.6, normal_stiffness=1e5, tangential_stiffness=5e4)
BONDED = replace(SOFT, cohesion=40.0)


def pile(law: concio.JointLaw, space: bool = False) -> concio.Model:
    model = concio.column(
        width=SIDE, height=1.5, blocks=BLOCKS, friction=law, top_pressure=PRESSURE, block="rigid", unit_weight=0.0
    )
    return concio.extrude(model, SIDE) if space else model


def held(law: concio.JointLaw, push: float, stiffness: float) -> concio.Model:
    """A block on a fixed one, pressed and pushed to the right, held back by an elastic tie level with the push."""
    model = on_ground(
        box("block", 0, 1, 0, 0.2, kind="rigid", material="stone"),
        loads=(
            concio.Load("pressure", (PRESSURE,), edge=((0.0, 0.2), (1.0, 0.2))),
            concio.Load("point", (push, 0.0), ("block",), at=(0.0, 0.0)),
        ),
        ties=(concio.Tie("rod", "ground", (-1.0, 0.0), "block", (0.0, 0.0), stiffness=stiffness),),
    )
    return replace(model, laws=dict.fromkeys(model.laws, law))


@pytest.mark.parametrize("space", [False, True])
def test_closure_approaches_its_largest(space: bool) -> None:
    largest = 2e-3
    found = concio.solve(pile(replace(SOFT, changes=(StiffnessHardens(largest),)), space))
    by_hand = BLOCKS * PRESSURE / (1e5 + PRESSURE / largest)
    assert found.max_settlement == pytest.approx(by_hand, rel=1e-9)
    assert found.max_settlement < concio.solve(pile(SOFT, space)).max_settlement
    assert found.certificate.certified


def test_cohesion_that_is_lost_leaves_more_to_the_tie() -> None:
    push, tie, lost = 180.0, 2e4, 1e-2
    law = replace(BONDED, changes=(CohesionLost(lost),))
    found = concio.solve(held(law, push, tie))
    # t = c (1 - s / lost) + mu p, push = t + tie (s + t / k_t)
    soft = 1.0 + tie / 5e4
    slip = (push - soft * (40.0 + 0.6 * PRESSURE)) / (tie - soft * 40.0 / lost)
    assert 0 < slip < lost
    sheared = 40.0 * (1 - slip / lost) + 0.6 * PRESSURE
    assert float(np.abs(found.contacts.friction_force).sum()) == pytest.approx(sheared, rel=1e-8)
    assert float(found.ties.tension[0]) == pytest.approx(push - sheared, rel=1e-8)
    assert float(found.ties.tension[0]) > float(concio.solve(held(BONDED, push, tie)).ties.tension[0])


def test_what_has_lost_all_is_a_joint_without_cohesion() -> None:
    push, tie = 180.0, 2e4
    found = concio.solve(held(replace(BONDED, changes=(CohesionLost(1e-4),)), push, tie))
    without = concio.solve(held(replace(BONDED, cohesion=0.0), push, tie))
    np.testing.assert_allclose(found.ties.tension, without.ties.tension, rtol=1e-9)


def test_asked_again_of_its_own_assembly_a_step_ends_in_the_same_answer() -> None:
    found = concio.solve(pile(replace(SOFT, changes=(StiffnessHardens(2e-3),))))
    again = concio.solve(found.assembly)
    assert again.max_settlement == pytest.approx(found.max_settlement, rel=1e-12)


def test_changes_that_change_nothing_change_nothing() -> None:
    found = concio.solve(held(replace(BONDED, changes=(lambda law, seen: law,)), 180.0, 2e4))
    plain = concio.solve(held(BONDED, 180.0, 2e4))
    np.testing.assert_allclose(found.displacement, plain.displacement, rtol=1e-12, atol=1e-15)


@pytest.mark.long
def test_laws_that_agree_with_no_answer_are_undecided() -> None:
    def flips(law: object, seen: object) -> object:
        return replace(law, cohesion=np.where(seen.slip > 1e-9, 1e3, 0.0))

    found = concio.solve(held(replace(BONDED, changes=(flips,)), 180.0, 2e4), on_failure="return")
    assert found.status is concio.Status.UNDECIDED
    assert "did not agree" in found.solution.trace[-1]


def test_failures_with_changed_laws_prove_nothing() -> None:
    far = held(replace(BONDED, cohesion=80.0, changes=(CohesionLost(1e-5),)), 200.0, 2e4)
    found = concio.solve(replace(far, ties=()), on_failure="return")
    assert found.status is concio.Status.UNDECIDED


ELSEWHERE = {
    "limit": lambda m: concio.limit(m),
    "friction": lambda m: concio.friction_margin(m),
    "path": lambda m: concio.run_path(m, [concio.Stage("all", {"dead": 1.0})]),
    "push": lambda m: concio.push(m),
    "dynamics": lambda m: concio.dynamics(m, duration=0.1),
}


@pytest.mark.parametrize("asked", ELSEWHERE)
def test_everything_else_refuses_laws_that_change(asked: str) -> None:
    model = pile(replace(SOFT, changes=(StiffnessHardens(2e-3),)))
    with pytest.raises(concio.InputError, match="changes with what the joint undergoes"):
        ELSEWHERE[asked](model)


def test_files_and_wrong_changes_are_refused() -> None:
    model = pile(replace(SOFT, changes=(StiffnessHardens(2e-3),)))
    with pytest.raises(concio.InputError, match="a model file cannot say"):
        concio.dumps(model)
    with pytest.raises(concio.InputError, match="cannot be called"):
        concio.JointLaw(0.6, changes=(0.3,))
    wrong: dict[str, Callable[..., object]] = {
        "friction": lambda law, seen: replace(law, friction=law.friction - 1.0),
        "cohesion": lambda law, seen: replace(law, cohesion=np.full(2, np.nan)),
    }
    for name, change in wrong.items():
        with pytest.raises(concio.InputError, match=f"return {name} of shape"):
            concio.solve(pile(replace(SOFT, changes=(change,))))


@pytest.mark.parametrize("returned", [None, 3.0, "cohesion"])
def test_a_change_that_returns_no_constants_is_refused_with_what_to_return(returned: object) -> None:
    law = replace(BONDED, changes=(lambda law, seen: law.cohesion if returned == "cohesion" else returned,))
    with pytest.raises(concio.InputError, match=r"instead of the constants.*dataclasses\.replace"):
        concio.solve(pile(law))
