"""The table of strategies of ``auto``: each has its case, and without it the case gets another verdict or none."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.model.materials import Elastic
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Status
from concio.solvers.auto import chain
from concio.solvers.methods import find


def hung(friction: float, courses: int = 3, blocks: int = 6, joint: float = 0.0) -> ContactProblem:
    """A panel between two walls with nothing below."""
    panel = concio.running_bond_panel(
        courses=courses, blocks=blocks, joint=joint, friction=friction, base="none", top_pressure=10.0
    )
    return concio.assemble(panel).problem()


def pushed(share: float) -> ContactProblem:
    """A low wall that slides on its base at a share of 0.4 of its weight."""
    wall = concio.wall(length=1.0, height=0.25, block=Elastic(1e6, 0.2, 20.0), friction=0.4, horizontal=share)
    return concio.assemble(wall).problem()


def pushed_slightly(share: float, units: int = 6) -> ContactProblem:
    """A dry wall of elastic blocks far from its limit."""
    wall = concio.running_bond_panel(
        courses=6, blocks=units, block_size=(1.0, 0.5), block=Elastic(1e5, 0.15, 20.0), friction=0.6, side_walls=False,
        horizontal=share, elements_per_block=(2, 2),
    )  # fmt: skip
    return concio.assemble(wall).problem()


CASES = {
    "all pairs stick": (lambda: pushed_slightly(0.15), Status.SOLVED),
    "interior-point": (lambda: pushed(0.39), Status.SOLVED),
    "statics": (lambda: pushed(0.41), Status.NO_EQUILIBRIUM),
    "release": (lambda: hung(0.2, 2, 4), Status.COLLAPSES),
}


@pytest.mark.parametrize("name", CASES)
def test_each_strategy_decides_its_case(name):
    """Nothing is tried once a verdict is proven: the one that decides is the last."""
    problem, verdict = CASES[name]
    answer = find("auto")(problem())
    assert answer.status is verdict
    assert answer.info["strategy"] == name
    order = [strategy.name for strategy in chain.STRATEGIES if 2 in strategy.dimensions]
    assert [tried for tried, _ in answer.info["cost"]] == order[: order.index(name) + 1]
    assert all(seconds >= 0 for _, seconds in answer.info["cost"])


@pytest.mark.parametrize(
    ("name", "without"),
    [
        ("all pairs stick", "interior-point"),
        ("interior-point", "neighbours in friction"),
        ("statics", "release"),
        ("release", "none"),
    ],
)
def test_a_case_goes_another_way_without_its_strategy(monkeypatch, name, without):
    """A wall pushed over is only seen to move away; a panel that moves away is undecided."""
    others = tuple(strategy for strategy in chain.STRATEGIES if strategy.name != name)
    monkeypatch.setattr(chain, "STRATEGIES", others)
    answer = chain.solve(CASES[name][0]())
    assert answer.info["strategy"] == without
    if name in ("statics", "release"):
        assert answer.status in (Status.COLLAPSES, Status.UNDECIDED)
        assert answer.status is not CASES[name][1]


@pytest.mark.long
def test_neighbours_in_friction_decide_a_jammed_panel():
    """10 x 20 blocks in soft mortar hang between walls at friction 1: from no start, but from friction 0.98."""
    answer = find("auto")(hung(1.0, 10, 20, joint=0.02))
    assert answer.solved
    assert answer.info["strategy"] == "neighbours in friction"


@pytest.mark.parametrize("share", [0.05, 0.15, 0.25])
def test_what_begins_with_sticking_is_what_the_interior_point_finds(share):
    """The same displacements and forces; a fifth to a third of the factorisations."""
    near, far = (find(name)(pushed_slightly(share)) for name in ("auto", "interior-point"))
    assert near.info["strategy"] == "all pairs stick"
    assert near.solved
    assert far.solved
    assert 2 * near.factorisations < far.factorisations
    for part in ("displacement", "normal_force", "friction_force"):
        wanted = getattr(far, part)
        assert getattr(near, part) == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max()), part


def test_what_begins_with_sticking_is_symmetric():
    """Forces of a pyramid of blocks whose feet slide are their own mirror image."""
    courses = [
        concio.Body(f"b{k}{j}", [(x, y), (x + 1, y), (x + 1, y + 0.5), (x, y + 0.5)], material="stone")
        for k, y in enumerate((0.0, 0.5, 1.0))
        for j, x in enumerate(np.arange(-2.0 + 0.5 * k, 2.0 - 0.5 * k))
    ]
    ground = concio.Body("ground", [(-4, -1), (4, -1), (4, 0), (-4, 0)], kind="fixed")
    model = concio.Model(
        (ground, *courses), {"stone": Elastic(1e5, 0.3, 20.0)}, {"joint": concio.JointLaw(0.1)},
        loads=(concio.Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    result = concio.solve(model)
    assert result.solution.info["strategy"] == "all pairs stick"
    joints = result.joints
    assert joints.slipping.any()
    for (x, y), force in zip(joints.middle, joints.force, strict=True):
        mirrored = np.abs(joints.middle - (-x, y)).sum(axis=1).argmin()
        assert np.abs(joints.force[mirrored]) == pytest.approx(np.abs(force), abs=1e-9 * joints.N.max())
