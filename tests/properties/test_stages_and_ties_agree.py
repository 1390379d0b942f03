"""Stages of a path and ties that break or yield: every command says the same of a load, or what else it was asked.

A pillar of width b and height h tips at the share b / h of its weight; a block that slides against a tie carries the
friction and what the tie has at its elongation at break, or its yield force.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_commands_agree import FAILS, HOLDS, answer_of_limit, asked

from pillars import STONE, WEIGHT, sideways
from pillars import pillar as leaning
from samples import sample

NEAR = 1e-3
"""Share of a load below and above it at which a load step is asked."""

STAGE = '[[stages]]\nname = "{name}"\nfactors = {{ {factors} }}\n'
CONTROL = 'control = {{ body = "pillar", at = [{x}, {h}], direction = [{way}, 0.0] }}\nuntil = "{until} mm"\n'


def pillar(b: float, h: float, *, live: float = 1.0, more: str = "") -> str:
    """Return a pillar b x h on a floor, whose weight is 'dead' and a horizontal share of it 'live'."""
    blocks = (
        '[[blocks]]\nname = "floor"\nrectangle = [[-3.0, -0.5], [3.0, 0.0]]\nkind = "fixed"\n'
        f'[[blocks]]\nname = "pillar"\nrectangle = [[{-b / 2}, 0.0], [{b / 2}, {h}]]\nkind = "rigid"\n'
        'material = "stone"\n'
    )
    return STONE.format(friction=4.0) + blocks + WEIGHT + sideways(live) + more


def put(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def acting(found: dict[str, Any]) -> dict[str, Any]:
    """Return what a verdict says of each load group."""
    return {row["group"]: row for row in found["verdict"]["question"]["acting"]}


DRAWN = range(sample(2, 3, 6))


@pytest.mark.long
@pytest.mark.parametrize("seed", DRAWN)
def test_what_a_controlled_stage_reached_is_what_every_command_carries(seed: int, tmp_path: Path) -> None:
    """20 mm of the top are reached with 'live' = b / h of the 1.0 asked: run, compare, limit and push say b / h."""
    rng = np.random.default_rng([25, 20, seed])
    b, h = float(rng.uniform(0.2, 0.6)), float(rng.uniform(1.0, 2.5))
    stages = STAGE.format(name="dead", factors="dead = 1.0") + STAGE.format(name="push", factors="live = 1.0")
    stages += CONTROL.format(x=b / 2, h=h, way=1.0, until=20)
    path = put(tmp_path / "model.toml", pillar(b, h, more=stages))
    followed = asked("path", path)
    assert followed["verdict"]["outcome"] == "incomplete"
    assert followed["verdict"]["exit_code"] == 4
    live = acting(followed)["live"]
    assert live["factor"] == pytest.approx(b / h, rel=1e-6)
    assert live["asked"] == 1.0
    assert asked("run", path)["verdict"]["outcome"] == FAILS, "all of it, which the stage did not reach"
    for command, more in (("run", ()), ("compare", ("--methods", "auto,sparse-lemke"))):
        for share, right in ((1 - NEAR, HOLDS), (1 + NEAR, FAILS)):
            factor = f"live={share * live['factor']!r}"
            assert asked(command, path, "--factor", factor, *more)["verdict"]["outcome"] == right
    assert answer_of_limit(asked("limit", path, "--no-friction")) == FAILS
    assert asked("limit", path, "--no-friction")["associated_multiplier"] == pytest.approx(b / h, rel=1e-9)
    assert asked("push", path, "--until", "1 mm")["peak"]["multiplier"] == pytest.approx(b / h, rel=1e-3)


@pytest.mark.parametrize(("lean", "share"), [(False, 0.5), (False, 1.5), (True, 0.5)])
def test_a_group_that_no_stage_applies_is_none_that_was_carried(lean: bool, share: float, tmp_path: Path) -> None:
    """The stages of the file hold the weight alone: what is carried is what 'run' carries without 'live', and told."""
    stages = STAGE.format(name="dead", factors="dead = 1.0")
    text = leaning(sideways(share * 0.25), lean=0.8 if lean else 0.0, more=stages)
    path = put(tmp_path / "model.toml", text)
    followed, alone = asked("path", path), asked("run", path, "--factor", "live=0")
    assert followed["verdict"]["outcome"] == alone["verdict"]["outcome"] == (FAILS if lean else HOLDS)
    assert asked("run", path)["verdict"]["outcome"] == (FAILS if lean or share > 1 else HOLDS)
    assert acting(followed)["live"]["role"] == "not applied"
    if not lean:
        assert "Never applied: load group 'live'" in followed["verdict"]["sentence"]


def test_a_load_that_comes_before_the_weight_is_asked_of_a_weightless_pillar(tmp_path: Path) -> None:
    """Nothing holds it: the path ends at once, though the last load step of the other order is carried."""
    first, then = (STAGE.format(name=g, factors=f"{g} = 1.0") for g in ("live", "dead"))
    path = put(tmp_path / "model.toml", pillar(0.4, 1.6, live=0.2, more=first + then))
    assert asked("run", path)["verdict"]["outcome"] == HOLDS
    ended = asked("path", path)["verdict"]
    assert ended["outcome"] == FAILS
    assert "'live'" in ended["sentence"]
    path = put(tmp_path / "model.toml", pillar(0.4, 1.6, live=0.2, more=then + first))
    assert asked("path", path)["verdict"]["outcome"] == HOLDS


TIE = """
[[blocks]]
name = "floor"
rectangle = [[-3.0, -0.5], [3.0, 0.0]]
kind = "fixed"
[[blocks]]
name = "b"
rectangle = [[-0.5, 0.0], [0.5, 1.0]]
kind = "rigid"
material = "stone"
[[loads]]
kind = "point"
value = [1.0, 0.0]
bodies = ["b"]
at = [0.5, 0.002]
group = "live"
[[ties]]
name = "rod"
body_a = "b"
at_a = [-0.5, 0.0]
body_b = ""
at_b = [-2.0, 0.0]
"""
STUDIED = """
[study]
size = 1
outputs = ["stands", "associated_multiplier"]
live = ["live"]
[[study.variables]]
name = "friction"
distribution = "choice"
keys = "joints.dry.friction"
values = [{friction}]
"""


@pytest.mark.long
@pytest.mark.parametrize("seed", DRAWN)
@pytest.mark.parametrize("breaks", [True, False])
def test_a_tie_that_gives_way_gives_way_at_one_load(breaks: bool, seed: int, tmp_path: Path) -> None:
    """A block of 20 kN is drawn against a tie: 20 mu and what the tie has at its break, or its yield force."""
    rng = np.random.default_rng([25, 28, seed])
    mu, k = float(rng.uniform(0.05, 0.4)), float(10 ** rng.uniform(3.5, 5.0))
    tie = float(rng.uniform(1.0, 10.0))
    end = f'break_elongation = "{1000.0 * tie / k!r} mm"' if breaks else f'yield_force = "{tie!r} kN"'
    text = STONE.format(friction=mu) + WEIGHT + TIE + f'stiffness = "{k!r} kN/m"\n{end}\n'
    path = put(tmp_path / "model.toml", text + STUDIED.format(friction=mu))
    most = 20.0 * mu + tie
    for command, more in (("run", ()), ("compare", ("--methods", "auto,sparse-lemke"))):
        for share, right in ((1 - NEAR, HOLDS), (1 + NEAR, FAILS)):
            found = asked(command, path, "--factor", f"live={share * most!r}", *more)
            assert found["verdict"]["outcome"] == right, (command, share)
    followed = asked("path", path, "--stage", "dead=1", "--stage", f"live={2.0 * most!r}")
    assert followed["verdict"]["outcome"] == ("incomplete" if breaks else FAILS), "nothing after the break was shown"
    assert acting(followed)["live"]["factor"] == pytest.approx(most, rel=1e-6)
    limit = asked("limit", path, "--no-friction")
    assert limit["design_multiplier"] == pytest.approx(most, rel=1e-6)
    assert limit["associated_multiplier"] == pytest.approx(most, rel=1e-9)
    pushed = asked("push", path, "--until", f"{2000.0 * tie / k!r} mm")
    assert pushed["peak"]["multiplier"] == pytest.approx(most, rel=1e-5)
    rows = asked("study", path, "--no-figures")["outputs"]
    assert rows["associated_multiplier"]["quantiles"]["50 %"][0] == pytest.approx(most, rel=1e-9)
    assert rows["stands"]["quantiles"]["50 %"][0] == 1.0  # live = 1 kN, which 20 mu carries
    shaken = asked("shake", path, "--pulse", "sine,0.0001 g,0.05 s", "--factor", f"live={0.5 * most!r}")
    assert shaken["verdict"]["outcome"] == HOLDS
