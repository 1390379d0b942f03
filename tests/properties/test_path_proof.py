"""Every state of a path is checked against the original problem at its factors, never against what the path kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio.analysis import path as paths
from concio.analysis.limit import limit
from concio.analysis.path import Stage, run_path
from concio.contact.assembly import PRESTRESS
from concio.model.body import Body
from concio.model.generate.columns import column
from concio.model.generate.walls import wall
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Load, Model, Support, Tie
from concio.problem.certificate import certify
from samples import sample

SEEDS = range(sample(3, 6, 12))


def random_wall(rng):
    """A small wall of rigid or elastic blocks between walls, whose ground moves sideways and down."""
    columns, courses = int(rng.integers(2, 4)), int(rng.integers(1, 4))
    rigid = bool(rng.integers(2))
    model = wall(
        length=0.4 * columns, height=0.2 * courses, block_size=(0.4, 0.2), friction=float(rng.uniform(0.4, 0.8)),
        horizontal=float(rng.uniform(0.01, 0.1)), block="rigid" if rigid else "elastic", mesh_size=0.2, side_walls=True,
        top_pressure=float(rng.uniform(0.0, 20.0)),
    )  # fmt: skip
    away = (float(rng.uniform(1e-5, 1e-4)), float(rng.uniform(-1e-5, 0.0)))
    return replace(model, supports=(Support("moves", "ground", displacement=away, group="settlement"),))


def random_stages(rng, groups):
    """Weight, then some stages in which some groups take new factors, up and down."""
    stages = [Stage("weight", {"dead": 1.0})]
    for k in range(int(rng.integers(1, 4))):
        named = rng.permutation(groups)[: int(rng.integers(1, len(groups) + 1))]
        least = {g: 0.5 if g == "dead" else 0.0 for g in groups}
        stages.append(Stage(f"s{k}", {str(g): float(rng.uniform(least[g], 1.0)) for g in named}))
    return [*stages, Stage("all", dict.fromkeys(groups, 1.0))]


@pytest.mark.parametrize("seed", SEEDS)
def test_every_state_obeys_the_original_equations(seed):
    """Equilibrium and the cone of every state, in the problem of the assembly at its factors, made again here."""
    rng = np.random.default_rng(seed)
    model = random_wall(rng)
    found = run_path(model, random_stages(rng, ["dead", "live", "top", "settlement"]))
    assert found.certified
    assert len(found.steps) >= len(found.outcomes)
    for step in found.steps:
        problem = found.assembly.problem(step.factors)
        own = certify(problem, step.state.displacement, step.state.normal_force, step.state.friction_force)
        assert max(own.equilibrium, own.cone, own.penetration) <= 1e-9


@pytest.mark.parametrize("dilatancy", [0.0, 0.2])
def test_a_block_that_slides_against_a_tie_rises_by_its_dilatancy(dilatancy):
    """Of 0.7 weights 0.5 are friction: the tie takes the rest, and each state is proved from the swelling before it."""
    weight, stiffness = 0.5 * 0.2 * 20.0, 100.0
    model = column(width=0.5, height=0.2, blocks=1, block=Rigid(20.0), horizontal=0.7,
                   friction=JointLaw(0.5, dilatancy=dilatancy))  # fmt: skip
    far = Tie("rod", "b01", (-0.25, 0.0), "", (-100.25, 0.0), stiffness)
    found = run_path(replace(model, ties=(far,)), [Stage("weight", {"dead": 1.0}), Stage("live", {"live": 1.0})])
    assert found.certified
    slip = 0.2 * weight / stiffness
    body = [b.name for b in found.assembly.model.bodies].index("b01")
    first = found.assembly.disc.offsets[body]  # two translations of the centroid, then its rotation
    moved = found.steps[-1].state.displacement[first : first + 2]
    assert moved == pytest.approx([slip, dilatancy * slip], rel=1e-3, abs=1e-8)


def trilith(rng):
    """Two piers and a lintel whose joints dilate, pushed by 0.9 of what makes them move."""
    height, clear, friction = float(rng.uniform(0.5, 2.0)), float(rng.uniform(0.4, 1.4)), float(rng.uniform(0.3, 0.8))
    elastic = bool(rng.integers(2))
    made = {
        "floor": [(-3.0, -0.5), (5.0, 0.0)], "left": [(0.0, 0.0), (0.5, height)],
        "right": [(0.5 + clear, 0.0), (1.0 + clear, height)],
        "lintel": [(-0.1, height), (1.15 + clear, height + 0.3)],
    }  # fmt: skip
    bodies = [
        Body(name, np.array([low, (high[0], low[1]), high, (low[0], high[1])]),
             kind="fixed" if name == "floor" else "elastic" if elastic else "rigid", material="stone", mesh_size=0.5)
        for name, (low, high) in made.items()
    ]  # fmt: skip
    stone = Elastic(3e5, 0.2, 20.0) if elastic else Rigid(20.0)
    law = JointLaw(friction, dilatancy=float(rng.uniform(0.02, 0.8)) * friction)
    loads = (Load("weight", (0.0, -1.0)), Load("weight", (1.0, 0.0), group="live"))
    return Model(tuple(bodies), {"stone": stone}, {"joint": law}, loads=loads)


@pytest.mark.parametrize("seed", range(sample(1, 6, 12)))
def test_joints_that_dilate_are_followed_alike_by_events_and_by_steps(seed):
    """A joint that opens at one end slips there, too, and its slip lifts as the law of one step says."""
    model = trilith(np.random.default_rng([71, seed]))
    share = 0.9 * limit(model, path=False, steps=False, search=False).associated.multiplier
    stages = [Stage("weight", {"dead": 1.0}), Stage("live", {"live": share}, steps=60)]
    exact = run_path(model, stages)
    stepped = run_path(model, stages, method="steps")
    for found in (exact, stepped):
        assert found.verdict.holds, found.verdict.sentence
    a, b = (found.steps[-1].state for found in (exact, stepped))
    assert a.displacement == pytest.approx(b.displacement, abs=0.03 * float(np.abs(a.displacement).max()))
    slipped = np.abs(a.slip).max()
    assert a.offset == pytest.approx(b.offset, abs=0.05 * float(slipped + np.abs(a.offset).max()))
    assert np.abs(a.offset).max() > 0


MUTANTS = {
    "slip of moved obstacles": lambda a, b: {"tangent_rate": b.slip_origin - a.slip_origin},
    "no slip of moved obstacles": lambda a, b: {"tangent_rate": 0.0 * a.slip_origin},
    "gap of moved obstacles": lambda a, b: {"gap_rate": a.gap - b.gap},
    "half the gap": lambda a, b: {"gap_rate": 0.5 * (b.gap - a.gap)},
    "a thousandth of the load": lambda a, b: {"load_rate": 1.001 * (b.f - a.f)},
}  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("mutant", MUTANTS)
def test_a_path_that_interpolates_wrongly_is_not_certified(mutant, monkeypatch):
    rng = np.random.default_rng(7)
    model = replace(random_wall(rng), ties=())
    right = paths._linear

    def wrong(assembly, start, end):
        a, b = assembly.problem(start), assembly.problem(end)
        return replace(right(assembly, start, end), **MUTANTS[mutant](a, b))

    stages = [Stage("weight", {"dead": 1.0}), Stage("support", {"settlement": 1.0}), Stage("more", {"dead": 1.2})]
    assert run_path(model, stages).certified
    monkeypatch.setattr(paths, "_linear", wrong)
    found = run_path(model, stages)
    assert found.certificate > 1e-6
    assert not found.certified


@pytest.mark.parametrize("what", ["displacement", "normal_force", "friction_force", "offset"])
def test_states_that_are_changed_are_not_certified(what, monkeypatch):
    model = random_wall(np.random.default_rng(7))
    walk = paths._walk

    def wrong(*arguments):
        found = walk(*arguments)
        last = found.states[-1]
        size = float(np.abs(last.displacement if what == "offset" else getattr(last, what)).max())
        changed = replace(last, **{what: getattr(last, what) + 1e-6 * size})
        return replace(found, states=(*found.states[:-1], changed))

    monkeypatch.setattr(paths, "_walk", wrong)
    assert not run_path(model, [Stage("all", {"dead": 1.0, "live": 1.0})]).certified


@pytest.mark.parametrize("seed", SEEDS)
def test_prestressed_ties_are_put_on_with_the_first_stage(seed):
    """A tie through one joint pulls with its prestress, which grows with the weight or with a stage of its own."""
    rng = np.random.default_rng(seed)
    pull = float(rng.uniform(0.1, 2.0))
    model = wall(length=0.4, height=0.2, block_size=(0.4, 0.2), friction=0.7, block=Rigid(unit_weight=20.0))
    top = (0.2, 0.2)
    rod = Tie("rod", "c1-b1", top, "ground", (0.2, 0.0), stiffness=float(10 ** rng.uniform(2, 5)), prestress=pull)
    name = next(b.name for b in model.bodies if b.name != "ground")
    model = replace(model, ties=(replace(rod, body_a=name),))
    found = run_path(model, [Stage("weight", {"dead": 1.0}), Stage("less", {"dead": 0.5})])
    assert found.complete
    assert found.certified
    weight = 20.0 * 0.4 * 0.2
    for step in found.steps:
        *pressed, tension = step.state.normal_force
        assert sum(pressed) == pytest.approx(weight * step.factors["dead"] + tension, rel=1e-9, abs=1e-12)
        assert tension == pytest.approx(pull * step.factors[PRESTRESS], rel=1e-2)  # hard joints were given a compliance
    assert found.steps[-1].factors[PRESTRESS] == 1.0
    named = run_path(model, [Stage("weight", {"dead": 1.0}), Stage("tension", {PRESTRESS: 0.5})])
    assert named.steps[-1].state.normal_force[-1] == pytest.approx(0.5 * pull, rel=1e-2)
