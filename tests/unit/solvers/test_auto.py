"""The table of strategies of ``auto``: each has its case, and without it the case gets another verdict or none."""

from __future__ import annotations

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


CASES = {
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
    [("interior-point", "neighbours in friction"), ("statics", "release"), ("release", "none")],
)
def test_a_case_goes_another_way_without_its_strategy(monkeypatch, name, without):
    """A wall pushed over is only seen to move away; a panel that moves away is undecided."""
    others = tuple(strategy for strategy in chain.STRATEGIES if strategy.name != name)
    monkeypatch.setattr(chain, "STRATEGIES", others)
    answer = chain.solve(CASES[name][0]())
    assert answer.info["strategy"] == without
    if name != "interior-point":
        assert answer.status in (Status.COLLAPSES, Status.UNDECIDED)
        assert answer.status is not CASES[name][1]


@pytest.mark.long
def test_neighbours_in_friction_decide_a_jammed_panel():
    """10 x 20 blocks in soft mortar hang between walls at friction 1: from no start, but from friction 0.98."""
    answer = find("auto")(hung(1.0, 10, 20, joint=0.02))
    assert answer.solved
    assert answer.info["strategy"] == "neighbours in friction"
