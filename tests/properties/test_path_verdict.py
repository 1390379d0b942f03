"""What a load path says of its question: what was asked, what was reached, and what follows; on a pillar known by hand.

A rigid pillar of width b and height h under its weight W and a horizontal share of it turns about its toe at the share
b / h, where friction is higher.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from concio.analysis.limit import limit
from concio.analysis.path import ControlPoint, Stage, run_path
from concio.cli.main import app
from concio.display import number
from concio.model.generate.walls import wall
from concio.model.model import Load
from concio.verdict.verdict import Outcome
from models import box, on_ground, weight
from samples import sample

SEEDS = range(sample(4, 8, 20))
STONE = {"kind": "rigid", "material": "stone"}
DEAD = Stage("dead", {"dead": 1.0})


def pillar(b=0.4, h=1.6, *, live=(1.0, 0.0), first=()):
    """A pillar of width b and height h whose weight is 'dead', and its horizontal share 'live'."""
    loads = (*first, weight(), Load("weight", live, group="live"))
    return on_ground(box("pillar", -b / 2, b / 2, 0, h, **STONE), loads=loads, law=4.0)


def push(asked, b, h, *, way=1.0, until=0.02):
    return Stage("push", {"live": asked}, control=ControlPoint("pillar", (way * b / 2, h), (way, 0.0)), until=until)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_controlled_stage_holds_only_where_its_load_was_reached(seed):
    rng = np.random.default_rng(seed)
    b, h = rng.uniform(0.2, 1.0), rng.uniform(1.0, 3.0)
    side = float(rng.choice([-1.0, 1.0]))
    for share, outcome in ((rng.uniform(0.2, 0.9), Outcome.HOLDS), (rng.uniform(1.1, 9.0), Outcome.INCOMPLETE)):
        asked = side * share * b / h
        found = run_path(pillar(b, h), [DEAD, push(asked, b, h, way=side)])
        (load,) = found.group_loads()
        assert load.most == pytest.approx(side * b / h, rel=1e-6)
        assert (load.group, load.begin, load.asked) == ("live", 0.0, asked)
        assert found.verdict.outcome is outcome
        assert found.complete is load.applied is (share < 1)
        assert found.verdict.exit_code == (0 if share < 1 else 4)
        if share > 1:
            assert f"live reached {number(side * b / h, 6)} of the {number(asked, 6)} asked" in found.sentence
            assert "20 mm" in found.sentence
            assert "carried to the end" not in found.sentence


@pytest.mark.parametrize("seed", SEEDS)
def test_a_motion_too_far_for_small_displacements_is_told(seed):
    """A pillar whose top moves by a share of its height opens its foot by that share of its width."""
    rng = np.random.default_rng(seed)
    b, h = rng.uniform(0.2, 1.0), rng.uniform(1.0, 3.0)
    for share, far in ((rng.uniform(0.01, 0.099), False), (rng.uniform(0.101, 0.3), True)):
        found = run_path(pillar(b, h), [DEAD, push(b / h, b, h, until=share * h)])
        (load,) = found.group_loads()
        assert load.most == pytest.approx(b / h, rel=1e-6)
        told = [line for line in found.verdict.limits if "too far for small displacements" in line]
        assert len(told) == far
        assert not far or f"by {1e3 * share * b:.4g} mm, {100 * share:.3g} % of its length" in told[0]


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_pushed_away_from_its_load_is_told(seed):
    """The point is pulled to the other side: the load that goes with it has the other sign."""
    rng = np.random.default_rng(seed)
    b, h, asked = rng.uniform(0.2, 1.0), rng.uniform(1.0, 3.0), rng.uniform(0.1, 3.0)
    found = run_path(pillar(b, h), [DEAD, push(asked, b, h, way=-1.0)])
    (load,) = found.group_loads()
    assert load.away
    assert load.end == pytest.approx(-b / h, rel=1e-6)
    assert found.verdict.outcome is Outcome.INCOMPLETE
    assert "away from" in found.sentence
    assert not found.complete


@pytest.mark.parametrize("seed", SEEDS)
def test_a_load_that_is_shown_not_to_be_carried_fails(seed):
    rng = np.random.default_rng(seed)
    b, h = rng.uniform(0.2, 1.0), rng.uniform(1.0, 3.0)
    found = run_path(pillar(b, h), [DEAD, Stage("push", {"live": 2.0 * b / h})])
    assert found.verdict.outcome is Outcome.FAILS
    assert found.verdict.exit_code == 3
    assert found.group_loads()[0].most == pytest.approx(b / h, rel=1e-6)


@pytest.mark.parametrize("seed", range(sample(2, 4, 8)))
def test_displacement_control_load_control_and_limit_reach_one_multiplier(seed):
    rng = np.random.default_rng(seed)
    columns, courses = int(rng.integers(1, 3)), int(rng.integers(2, 4))
    model = wall(
        length=0.4 * columns, height=0.3 * courses, block_size=(0.4, 0.3), friction=float(rng.uniform(0.9, 1.5)),
        horizontal=1.0, block="rigid", bond="stack",
    )  # fmt: skip
    found = limit(model, path=True, search=False)
    top = model.bodies[-1]
    point = ControlPoint(top.name, tuple(float(v) for v in np.max(top.vertices, axis=0)), (1.0, 0.0))
    by_load = run_path(model, [DEAD, Stage("push", {"live": 5.0})])
    by_motion = run_path(model, [DEAD, Stage("push", {"live": 5.0}, control=point, until=0.002)])
    reached = [p.group_loads()[0].most for p in (by_load, by_motion)]
    assert reached == pytest.approx([found.path.peak] * 2, rel=1e-6)
    assert by_load.verdict.outcome is Outcome.FAILS
    assert by_motion.verdict.outcome is not Outcome.HOLDS


@pytest.mark.parametrize("seed", SEEDS)
def test_without_its_weight_a_structure_is_not_shown_to_stand(seed):
    """Whatever stages leave the weight out: never exit code 0, and the group is named."""
    rng = np.random.default_rng(seed)
    b, h = rng.uniform(0.2, 1.0), rng.uniform(1.0, 3.0)
    down = Load("point", (0.0, -5.0), bodies=("pillar",), at=(0.0, h), group="top")
    model = pillar(b, h, first=(down,))
    stages = [Stage("load", {"top": float(rng.uniform(0.1, 2.0))}), Stage("more", {"top": 2.0})][: 1 + seed % 2]
    found = run_path(model, stages)
    assert found.outcomes[-1].name == "REACHED"
    assert found.verdict.outcome is Outcome.INCOMPLETE
    assert "self-weight" in found.sentence
    assert "'dead'" in found.sentence
    late = run_path(model, [*stages, DEAD])  # put on at last: every load acts in the end, in an order that is reported
    assert late.verdict.outcome is Outcome.HOLDS
    assert any("without self-weight" in line for line in late.verdict.limits)
    assert "load group 'live'" in late.sentence  # never applied


def test_a_group_that_no_stage_applies_is_named():
    found = run_path(pillar(), [DEAD])
    assert found.never_applied == ("live",)
    assert "Never applied: load group 'live'." in found.sentence
    assert {a.group: a.role for a in found.verdict.question.acting}["live"] == "not applied"


@pytest.mark.parametrize("order", [("live", "dead"), ("dead", "live")])
def test_the_order_of_the_file_does_not_decide(order, tmp_path):
    """Without stages self-weight comes first, wherever it stands in the file."""
    loads = {"dead": "value = [0, -1]", "live": "value = [0.1, 0]"}
    text = '[materials.stone]\nkind = "rigid"\nunit_weight = 20\n[joints.dry]\nfriction = 0.7\n'
    text += '[[blocks]]\nname = "floor"\n'
    text += 'rectangle = [[-3, -0.5], [3, 0]]\nkind = "fixed"\n[[blocks]]\nname = "pillar"\nmaterial = "stone"\n'
    text += "rectangle = [[-0.2, 0], [0.2, 1.6]]\n"
    text += "".join(f'[[loads]]\nkind = "weight"\n{loads[g]}\ngroup = "{g}"\n' for g in order)
    file = tmp_path / "pillar.toml"
    file.write_text(text)
    done = CliRunner().invoke(app, ["path", str(file), "--json"])
    assert done.exit_code == 0
    told = json.loads(done.stdout)
    assert [list(s["factors"]) for s in told["stages"]] == [["dead"], ["live"]]
    assert told["verdict"]["outcome"] == "holds"
    light = CliRunner().invoke(app, ["path", str(file), "--stage", "live=0"])
    assert light.exit_code == 4
    assert "self-weight" in light.stdout


def test_every_view_of_a_path_says_the_same(tmp_path):
    """Sentence, --json, report, notebook and repr are the verdict's."""
    from concio.cli.path_lines import path_facts, path_lines
    from concio.report.path_page import path_html

    found = run_path(pillar(), [DEAD, push(1.0, 0.4, 1.6)])
    point = ControlPoint("pillar", (0.2, 1.6))
    told = path_facts(found, point)
    assert told["verdict"] == found.verdict.as_dict()
    assert told["status"] == "incomplete"
    assert told["stages"][1]["loads"][0]["applied"] is False
    assert found.sentence in repr(found)
    assert any(found.sentence in line for line in path_lines(found, point, every=False))
    for page in (path_html(found), found._repr_html_()):
        assert found.sentence in page.replace("&#x27;", "'")
        assert "carried to the end" not in page


def test_a_path_that_is_not_certified_shows_nothing(monkeypatch):
    from dataclasses import replace

    found = run_path(pillar(), [DEAD])
    bad = replace(found.steps[-1].certificate, equilibrium=1e-3)
    wrong = replace(found, steps=(*found.steps[:-1], replace(found.steps[-1], certificate=bad)))
    assert wrong.verdict.outcome is Outcome.UNDECIDED
    assert wrong.verdict.exit_code == 4
    assert "1.0e-03" in wrong.sentence
