"""Ties that break, yield or pull: on a block that slides against a tie, where every number is known by hand.

A rigid block of weight W with friction mu is drawn by live P against a tie of stiffness k, prestress 0: it slides at
P = mu W, from there on the tie takes the rest, and at the elongation d where it breaks it carries k d.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.analysis.path import Stage, run_path
from concio.cli.check_lines import check_lines
from concio.cli.lines import tie_lines
from concio.cli.path_lines import path_facts
from concio.contact.detection import detect
from concio.errors import NoEquilibriumError
from concio.model.materials import JointLaw, Rigid
from concio.model.model import Load, Tie
from concio.post.path_curve import most_moving
from concio.report.page import report_html
from concio.verdict.verdict import Outcome
from models import box, on_ground, weight
from samples import sample
from solids import box as solid

SEEDS = range(sample(2, 6, 12))
DEAD = Stage("weight", {"dead": 1.0})
STONE = {"kind": "rigid", "material": "stone"}


def drawn(rng, **tie):
    """The block, its friction force, the stiffness of the tie and where it breaks [m]."""
    mu, k, far = float(rng.uniform(0.05, 0.4)), float(10 ** rng.uniform(3.5, 5)), float(10 ** rng.uniform(-4, -2))
    rod = Tie("rod", "b", (-0.5, 0.0), "", (-2.0, 0.0), k, break_elongation=far, **tie)
    model = on_ground(
        box("b", -0.5, 0.5, 0, 1, **STONE), law=mu, ties=(rod,),
        loads=(weight(), Load("point", (1.0, 0.0), bodies=("b",), at=(0.5, 0.002), group="live")),
    )  # fmt: skip
    return model, mu * 20.0, k, far


@pytest.mark.parametrize("seed", SEEDS)
def test_one_step_obeys_a_tie_that_breaks(seed):
    rng = np.random.default_rng(seed)
    model, friction, k, far = drawn(rng)
    most = friction + k * far
    whole = concio.solve(model, factors={"live": friction + 0.9 * k * far})
    assert whole.broken_ties == ()
    assert whole.ties.tension[0] == pytest.approx(0.9 * k * far, rel=1e-6)
    assert whole.ties.elongation[0] == pytest.approx(0.9 * far, rel=1e-6)
    with pytest.raises(NoEquilibriumError):
        concio.solve(model, factors={"live": 1.01 * most})
    strong = replace(model, ties=(replace(model.ties[0], yield_force=0.5 * k * far),))
    with pytest.raises(NoEquilibriumError):
        concio.solve(strong, factors={"live": friction + 0.6 * k * far})


@pytest.mark.parametrize("seed", SEEDS)
def test_what_stands_without_the_tie_is_told_without_it(seed):
    """A support moves the far end away: the tie is stretched past its break, and friction alone holds the block."""
    rng = np.random.default_rng(seed)
    model, friction, _, far = drawn(rng)
    frame = box("frame", -4, -3, 0, 1, kind="fixed")
    rod = replace(model.ties[0], body_b="frame", at_b=(-3.0, 0.0))
    away = concio.Support("away", "frame", displacement=(-float(rng.uniform(1.2, 3.0)) * far, 0.0))
    tall = box("b", -0.5, 0.5, 0, 1, **STONE)
    bodies = (model.bodies[0], tall, frame)
    heavy = replace(
        model, bodies=bodies, ties=(rod,), supports=(away,), loads=(Load("weight", (0.0, -1e6)), model.loads[1])
    )
    found = concio.solve(heavy, factors={"live": 0.5 * friction})
    assert [name for name, _ in found.broken_ties] == ["rod"]
    assert found.broken_ties[0][1] >= far
    assert len(found.ties) == 0
    assert "tie 'rod' breaks" in found.sentence.lower()
    assert found.reactions["ground"][0] == pytest.approx(-0.5 * friction, rel=1e-6)
    assert found.summary()["broken_ties"][0]["name"] == "rod"


@pytest.mark.parametrize("seed", SEEDS)
def test_a_limit_load_is_told_with_and_without_the_tie(seed):
    rng = np.random.default_rng(seed)
    model, friction, k, far = drawn(rng)
    found = concio.limit(model, path=False, search=False)
    assert found.associated.multiplier == pytest.approx(friction + k * far, rel=1e-9)
    assert found.untied.multiplier == pytest.approx(friction, rel=1e-9)
    assert any("can break" in line and "'rod'" in line for line in found.verdict.limits)
    assert not any("crush" in line for line in found.verdict.limits)
    never = replace(model, ties=(replace(model.ties[0], break_elongation=None, yield_force=1.0),))
    assert concio.limit(never, path=False, search=False).untied is None


@pytest.mark.parametrize("seed", SEEDS)
def test_a_path_ends_where_a_tie_breaks(seed):
    rng = np.random.default_rng(seed)
    model, friction, k, far = drawn(rng)
    most = friction + k * far
    found = run_path(model, [DEAD, Stage("pull", {"live": 3.0 * most})])
    (load,) = found.group_loads()
    assert load.end == pytest.approx(most, rel=1e-6)
    assert found.certified
    assert found.verdict.outcome is Outcome.INCOMPLETE
    assert [name for name, _ in found.broken_ties] == ["rod"]
    assert "Tie 'rod' breaks there" in found.sentence
    assert found.events[-1].kind == "breaks"
    assert found.energy_error <= 1e-6
    short = run_path(model, [DEAD, Stage("pull", {"live": 0.9 * most})])
    assert short.verdict.outcome is Outcome.HOLDS
    assert short.broken_ties == ()


@pytest.mark.parametrize("method", ["events", "steps"])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_tie_that_a_moving_support_stretches_breaks_in_time(seed, method):
    """Its far end is moved by some of its break elongations, in load steps of any size: it breaks at the first."""
    rng = np.random.default_rng(seed)
    model, _, k, far = drawn(rng)
    times = float(rng.uniform(1.5, 4.0))
    frame = box("frame", -4, -3, 0, 1, kind="fixed")
    rod = replace(model.ties[0], body_b="frame", at_b=(-3.0, 0.0))
    away = concio.Support("away", "frame", displacement=(-times * far, 0.0), group="away")
    heavy = (Load("weight", (0.0, -1e3)),)
    model = replace(model, bodies=(*model.bodies, frame), ties=(rod,), supports=(away,), loads=heavy)
    stages = [replace(DEAD, steps=1), Stage("away", {"away": 1.0}, steps=int(rng.integers(1, 6)))]
    found = run_path(model, stages, method=method)
    (load,) = found.group_loads()
    assert found.certified
    (breaks,) = [e for e in found.events if e.kind == "breaks"]
    assert breaks.parameter * times == pytest.approx(1.0, rel=1e-3)  # hard joints were given a compliance
    assert found.result(breaks.step).ties.tension[0] == pytest.approx(k * far, rel=1e-5)
    assert [name for name, _ in found.broken_ties] == ["rod"]
    assert load.end == 1.0, "friction holds the block without it, and the path goes on"
    assert found.result().ties.tension[0] == 0.0
    assert [name for name, _ in found.result().broken_ties] == ["rod"]
    assert found.verdict.outcome is Outcome.HOLDS
    assert "breaks on the way" in found.sentence


@pytest.mark.parametrize("method", ["events", "steps"])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_path_goes_on_with_the_ties_that_are_left(seed, method):
    """The second tie takes over what the first one carried: its stretch is what is left over its stiffness."""
    rng = np.random.default_rng(seed)
    model, friction, k, far = drawn(rng)
    times = float(rng.uniform(2.0, 8.0))
    second = replace(model.ties[0], name="second", stiffness=times * k, break_elongation=None)
    load = friction + float(rng.uniform(1.3, 3.0)) * (1 + times) * k * far
    found = run_path(replace(model, ties=(model.ties[0], second)), [DEAD, Stage("pull", {"live": load})], method=method)
    assert found.complete
    assert found.certified
    assert found.energy_error <= 1e-6
    (breaks,) = [e for e in found.events if e.kind == "breaks"]
    at = found.result(breaks.step)
    assert breaks.parameter * load == pytest.approx(friction + (1 + times) * k * far, rel=1e-6)
    assert at.ties.elongation[0] == pytest.approx(far, rel=1e-6)
    end = found.result()
    assert end.ties.tension[0] == 0.0
    assert end.ties.elongation[1] == pytest.approx((load - friction) / (times * k), rel=1e-5)
    assert end.certificate.certified


@pytest.mark.long
@pytest.mark.parametrize("seed", SEEDS)
def test_under_the_motion_of_a_point_the_load_falls_and_the_path_goes_on(seed):
    """Where the tie lets go the point stays: friction is all that is left."""
    rng = np.random.default_rng(seed)
    model, friction, k, far = drawn(rng)
    most = friction + k * far
    point = concio.ControlPoint("b", (0.5, 0.002))
    found = run_path(model, [DEAD, Stage("pull", {"live": 3.0 * most}, control=point, until=3.0 * far)])
    _, load = found.load()
    moved, _ = found.curve(point, 1)
    assert load.max() == pytest.approx(most, rel=1e-6)
    assert load[-1] == pytest.approx(friction, rel=1e-6)
    assert moved[-1] == pytest.approx(3.0 * far, rel=1e-6)
    k_break = int(np.argmax(load))
    assert moved[k_break + 1] == pytest.approx(moved[k_break], rel=1e-6), "the point stays as the tie lets go"
    assert (np.diff(moved) >= -1e-9 * far).all()
    assert found.certified
    assert found.energy_error <= 1e-6
    assert found.verdict.outcome is Outcome.INCOMPLETE, "the load was not reached"


@pytest.mark.parametrize("power", range(-1, 8))
def test_a_soft_tie_beside_hard_joints_is_followed_corner_by_corner(power):
    """All that holds the sliding block is the tie, much softer than the compliance added to the joints: no restarts."""
    model, friction, _, _ = drawn(np.random.default_rng(0))
    k = 10.0**power
    loose = replace(model, ties=(replace(model.ties[0], stiffness=k, break_elongation=None),))
    found = run_path(loose, [DEAD, Stage("pull", {"live": 5.0 * friction})], max_events=300)
    assert found.complete
    assert found.certified
    assert not [e for e in found.events if e.kind in ("restarts", "jumps")]
    assert found.result().ties.elongation[0] == pytest.approx(4.0 * friction / k, rel=1e-3)


def test_ties_break_one_after_the_other():
    """Each takes over what the last one carried, and none can: all break at one load, and nothing is left."""
    model, friction, k, far = drawn(np.random.default_rng(3))
    ties = tuple(replace(model.ties[0], name=f"t{i}", break_elongation=(1 + 0.1 * i) * far) for i in range(3))
    most = friction + 3 * k * far
    found = run_path(replace(model, ties=ties), [DEAD, Stage("pull", {"live": 2.0 * most})])
    assert [name for name, _ in found.broken_ties] == ["t0"], "what follows is not an equilibrium nearby"
    assert found.group_loads()[0].end == pytest.approx(most, rel=1e-6)
    strong = replace(ties[2], stiffness=9 * k, break_elongation=None)
    load = friction + 30 * k * far
    held = run_path(replace(model, ties=(*ties[:2], strong)), [DEAD, Stage("pull", {"live": load})])
    assert [name for name, _ in held.broken_ties] == ["t0", "t1"]
    assert held.complete
    assert held.result().ties.elongation[2] == pytest.approx(30 / 9 * far, rel=1e-4)


def test_a_tie_that_yields_is_said_to_yield():
    model, friction, k, _ = drawn(np.random.default_rng(1))
    frame = box("frame", -4, -3, 0, 1, kind="fixed")
    rod = replace(model.ties[0], body_b="frame", at_b=(-3.0, 0.0), break_elongation=None, yield_force=0.3 * friction)
    away = concio.Support("away", "frame", displacement=(-0.5 * friction / k, 0.0), group="away")
    model = replace(model, bodies=(*model.bodies, frame), ties=(rod,), supports=(away,))
    path = run_path(model, [Stage("weight", {"dead": 1.0}), Stage("away", {"away": 1.0})])
    assert [e.kind for e in path.events if "frame" in e.bodies][-1] == "yields"
    found = path.result()
    assert found.ties.state == ("yields",)
    assert found.ties.tension[0] == pytest.approx(0.3 * friction)
    assert "crush" not in found.contacts.counted
    assert "yields" in "\n".join(tie_lines(found))
    states = found.tables.contacts()["state"]
    assert states[-1] == "yields"
    assert "crushed" not in states


IN_SPACE = [pytest.param(seed, 3, marks=pytest.mark.long) for seed in range(4)]


@pytest.mark.parametrize(("seed", "dim"), [*((seed, 2) for seed in SEEDS), *IN_SPACE])
def test_the_load_at_which_a_tie_yields_is_located_within_a_step(seed, dim):
    """A weaker tie yields on the way, whatever the steps; the other one, three times as stiff, takes the rest."""
    rng = np.random.default_rng([dim, seed])
    mu, k = float(rng.uniform(0.05, 0.3)), float(10 ** rng.uniform(3.5, 5))
    most, factor = float(rng.uniform(0.5, 3.0)), float(rng.uniform(1.1, 3.0))
    if dim == 2:
        bodies = on_ground(box("b", -0.5, 0.5, 0, 1, **STONE), loads=(weight(),)).bodies
    else:
        ground = solid("ground", (-3, -3, -1), (3, 3, 0), kind="fixed")
        bodies = (ground, solid("b", (-0.5, -0.5, 0), (0.5, 0.5, 1), **STONE))
    low, mid = float(rng.uniform(0.001, 0.01)), (0.0,) * (dim - 2)
    loads = (
        Load("weight", (*(0.0,) * (dim - 1), -1.0)),
        Load("point", (1.0, *(0.0,) * (dim - 1)), bodies=("b",), at=(0.5, *mid, low), group="live"),
    )
    rods = tuple(
        Tie(name, "b", (-0.5, *mid, low), "", (-2.0, *mid, low), times * k, yield_force=force)
        for name, times, force in (("weak", 1.0, most), ("strong", 3.0, 100.0 * most))
    )
    model = concio.Model(bodies, {"stone": Rigid(20.0)}, {"joint": JointLaw(mu)}, ties=rods, loads=loads)
    at = mu * 20.0 + 4.0 * most
    found = run_path(
        model, [replace(DEAD, steps=2), Stage("pull", {"live": factor * at}, steps=int(rng.integers(1, 6)))],
        method="steps",
    )  # fmt: skip
    assert found.complete
    assert found.certified
    (yields,) = [event for event in found.events if event.kind == "yields"]
    assert yields.parameter * factor * at == pytest.approx(at, rel=1e-3)  # hard joints were given a compliance
    state = found.result(yields.step)
    assert state.ties.state[0] == "yields"
    assert state.ties.tension == pytest.approx([most, 3.0 * most], rel=1e-6)
    end = found.result().ties.tension
    assert end == pytest.approx([most, factor * at - mu * 20.0 - most], rel=1e-3)


@pytest.mark.parametrize("space", [False, True])
def test_forces_of_ties_close_the_balance_for_the_reader(space):
    """Loads, reactions and ties to fixed points add up to nothing, in the table and in the report."""
    model = drawn(np.random.default_rng(2), prestress=0.5)[0] if not space else in_space()
    found = concio.solve(model)
    ties = found.tables.ties()
    total = np.array(found.total_load) + np.array(found.reactions["ground"])
    total += np.array([ties[f"force_{axis}"].sum() for axis in "xyz"[: model.dim]])
    assert total == pytest.approx(np.zeros(model.dim), abs=1e-9)
    assert ties["tension"][0] > 0.1
    page = report_html(found, figures=False)
    assert "<h2>Ties</h2>" in page
    assert "rod" in page
    assert found.summary()["ties"][0]["tension"] == pytest.approx(ties["tension"][0])
    path = run_path(model, [Stage("weight", {"dead": 1.0})])
    assert path_facts(path, most_moving(path))["ties"][0]["name"] == "rod"


def in_space():
    """A block on the ground, pulled by its weight's share and held by a prestressed tie to a fixed point."""
    rod = Tie("rod", "b", (-0.5, 0.0, 0.2), "", (-2.0, 0.5, 0.7), 1e3, prestress=0.5)
    return concio.Model(
        (solid("ground", (-3, -3, -1), (3, 3, 0), kind="fixed"), solid("b", (-0.5, -0.5, 0), (0.5, 0.5, 1), **STONE)),
        {"stone": Rigid(20.0)}, {"joint": JointLaw(0.5)}, ties=(rod,), loads=(Load("weight", (0.1, 0.0, -1.0)),),
    )  # fmt: skip


def test_check_states_what_a_tie_is():
    model, *_ = drawn(np.random.default_rng(3), prestress=0.25, yield_force=7.0)
    (line,) = [t for t in check_lines(model, detect(model), {}, every=True) if t.startswith("tie ")]
    for word in ("stiffness", "kN/m", "prestress 0.25 kN", "yields at 7 kN", "breaks when stretched by"):
        assert word in line
