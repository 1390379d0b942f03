"""Settlements, studies, comparisons, bridges and what is let go: a body elsewhere changes no digit of their answers.

The other body stands on a ground of its own, of any size and weight; it shares the question and nothing else.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_commands_agree import BRIDGE, asked
from test_more_commands_agree import STUDY

import concio
from concio import Body, Model, Rigid
from concio.analysis.step import solve
from concio.problem.solution import Status
from pillars import pillar, sideways

SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 6))]


def drawn(seed: int, *, least: float = -3.0, most: float = 2.0) -> tuple[float, float, bool]:
    """Return powers of ten of size and weight of the other body, and whether it comes first."""
    rng = np.random.default_rng([25, 3, seed])
    return float(rng.uniform(least, most)), float(rng.uniform(-3, 3)), bool(rng.integers(2))


def beside(
    model: Model, size: float, weight: float, first: bool, at: tuple[float, float] = (500.0, 0.0)
) -> Model:
    """Return the model with a block on a ground of its own, some way off."""
    low, high = np.array([[0.0, 0.0], [1.0, 1.0]]) * 10.0**size + at
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    down = [(x, y - 10.0**size) for x, y in corners]
    more = (Body("other", corners, "other", "rigid"), Body("other ground", down, kind="fixed"))
    return replace(
        model, bodies=(*more, *model.bodies) if first else (*model.bodies, *more),
        materials={**model.materials, "other": Rigid(20.0 * 10.0**weight)},
    )  # fmt: skip


def other(size: float, weight: float) -> str:
    """Return that block in words of a model file."""
    a, b, w = 500.0, 500.0 + 10.0**size, 10.0**size
    return (
        f'[materials.other]\nkind = "rigid"\nunit_weight = "{20.0 * 10.0**weight!r} kN/m3"\n'
        f'[[blocks]]\nname = "other"\nrectangle = [[{a!r}, 0.0], [{b!r}, {w!r}]]\nkind = "rigid"\nmaterial = "other"\n'
        f'[[blocks]]\nname = "other ground"\nrectangle = [[{a!r}, {-w!r}], [{b!r}, 0.0]]\nkind = "fixed"\n'
    )


def near(found: Any, wanted: Any, digits: float = 1e-9) -> None:
    np.testing.assert_allclose(found, wanted, rtol=digits, atol=digits * float(np.abs(wanted).max(initial=0.0)))


@pytest.mark.parametrize("moved", [-0.005, 0.002])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_settlement_has_the_same_reactions_and_events(seed: int, moved: float) -> None:
    size, weight, first = drawn(seed)
    arch = concio.arch(span=2.0, ring=0.3, voussoirs=5, block="rigid", unit_weight=20.0)
    arch = replace(arch, supports=(concio.Support("spread", "left abutment", displacement=(moved, 0.0)),))
    alone, both = concio.settle(arch), concio.settle(beside(arch, size, weight, first))
    assert both.verdict.outcome is alone.verdict.outcome
    assert both.reached == alone.reached
    for name, force in alone.reactions.items():
        near(both.reactions[name][-1], force[-1])
    events = [(e.kind, e.bodies) for e in both.path.events if "other" not in e.bodies]
    assert events == [(e.kind, e.bodies) for e in alone.path.events]
    near(sorted(e.parameter for e in both.path.events if "other" not in e.bodies),
         sorted(e.parameter for e in alone.path.events))  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("live", [0.2, 0.3])
@pytest.mark.parametrize("seed", range(3))
def test_a_study_has_the_same_rows(seed: int, live: float, tmp_path: Path) -> None:
    """The other block is not pushed: it has no multiplier, and stands whatever the friction is."""
    more = STUDY.replace("LIVE", "live").replace("KEY", "joints.dry.friction").replace("VALUE", "0.7, 0.22")
    push = sideways(live).replace('group', 'bodies = ["pillar"]\ngroup')
    size, weight, first = drawn(seed)
    found = []
    for k, beside_it in enumerate(("", other(size, weight))):
        path, text = tmp_path / f"model{k}.toml", pillar(push, more=more.replace("size = 1", "size = 4"))
        path.write_text(beside_it + text if first else text + beside_it)
        found.append(asked("study", path, "--no-figures"))
    alone, both = found
    assert both["verdict"]["outcome"] == alone["verdict"]["outcome"]
    for name in alone["outputs"]:
        near(*(np.array(list(f["outputs"][name]["quantiles"].values()), dtype=float) for f in (both, alone)))


@pytest.mark.long
@pytest.mark.parametrize("live", [0.2, 0.3])
@pytest.mark.parametrize("seed", range(3))
def test_methods_that_are_compared_end_alike(seed: int, live: float, tmp_path: Path) -> None:
    size, weight, first = drawn(seed)
    path = tmp_path / "model.toml"
    push = sideways(live).replace('group', 'bodies = ["pillar"]\ngroup')
    found = []
    for beside_it in ("", other(size, weight)):
        path.write_text(beside_it + pillar(push) if first else pillar(push) + beside_it)
        found.append(asked("compare", path, "--methods", "auto,sparse-lemke"))
    alone, both = found
    assert both["verdict"]["outcome"] == alone["verdict"]["outcome"]
    assert [(r["method"], r["outcome"]) for r in both["rows"]] == [(r["method"], r["outcome"]) for r in alone["rows"]]


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_a_bridge_carries_the_same(seed: int) -> None:
    size, weight, first = drawn(seed)
    model = concio.loads(BRIDGE.format(axle=100.0))
    asked_of = {"step": 0.5, "fine": 0.2, "worst": 1, "checked": 0, "sensitivity": False}
    alone = concio.assess_bridge(model, **asked_of)
    both = concio.assess_bridge(beside(model, size, weight, first, (0.0, -500.0)), **asked_of)
    with pytest.raises(concio.InputError, match="nothing lies below the road"):  # beside it, where a vehicle would go
        concio.assess_bridge(beside(model, size, weight, first), **asked_of)
    assert both.verdict.outcome is alone.verdict.outcome
    near(both.worst.multiplier, alone.worst.multiplier)


@pytest.mark.long
@pytest.mark.parametrize("live", [0.2, 0.3])
@pytest.mark.parametrize("seed", range(2))
def test_what_is_let_go_moves_alike(seed: int, live: float) -> None:
    size, weight, first = drawn(seed, least=-0.5, most=0.5)

    def let_go(model: Model) -> Any:
        step = solve(model, on_failure="return")
        undecided = replace(step, solution=replace(step.solution, status=Status.UNDECIDED))
        return concio.let_go(undecided)

    model = concio.loads(pillar(sideways(live).replace('group', 'bodies = ["pillar"]\ngroup')))
    alone, both = let_go(model), let_go(beside(model, size, weight, first))
    assert (both.verdict.outcome, both.verdict.status) == (alone.verdict.outcome, alone.verdict.status)
    place, wanted = (
        f.motion.shots.centre[-1, [b.name for b in f.motion.model.bodies].index("pillar")] for f in (both, alone)
    )
    if live < 0.25:  # what falls is followed in steps that go by the size of all bodies
        assert place == pytest.approx(wanted, abs=1e-6)
