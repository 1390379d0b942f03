"""What is said of controlled stages, of ties that yield, of settlements of nothing and of weights that are missing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import concio
from commands import run
from concio import JointLaw, Load, Model, Polyhedron, Rigid, Tie
from pillars import pillar, point, turned

EXAMPLES = Path(__file__).parents[3] / "examples"
UNITS = """
[units]
force = "N"
length = "mm"
[materials.stone]
kind = "rigid"
unit_weight = "20 kN/m3"
[joints.dry]
friction = 0.7
[[blocks]]
name = "floor"
rectangle = [[-3000, -500], [3000, 0]]
kind = "fixed"
[[blocks]]
name = "pillar"
rectangle = [[-200, 0], [200, 1600]]
material = "stone"
[[loads]]
kind = "weight"
value = [0, -1]
[[loads]]
kind = "point"
value = [1000, 0]
bodies = ["pillar"]
at = [0, 1600]
group = "live"
[[stages]]
name = "dead"
factors = { dead = 1.0 }
[[stages]]
name = "push"
factors = { live = FACTOR }
control = { body = "pillar", at = [0, 1600], direction = [1, 0] }
until = 20
[report]
force = "N"
length = "mm"
"""


def test_a_controlled_stage_whose_load_falls_short_ends_with_4(tmp_path: Path) -> None:
    """12.8 kN at 0.2 m against 1.6 m of height: 1.6 kN of the 2 that are asked for, in N and mm."""
    path = tmp_path / "units.toml"
    path.write_text(UNITS.replace("FACTOR", "2.0"))
    code, out, _ = run("path", path)
    assert code == 4
    assert "reached 20 mm; live reached 1.6 of the 2 asked for" in " ".join(out.split())
    assert "carried to the end" not in out
    told = json.loads(run("path", path, "--json")[1])["verdict"]
    assert (told["exit_code"], told["outcome"]) == (4, "incomplete")
    live = next(a for a in told["question"]["acting"] if a["group"] == "live")
    assert live["asked"] == 2.0
    assert live["factor"] == pytest.approx(12.8 * 0.2 / 1.6, rel=1e-3)


def test_the_path_of_leaning_stones_takes_their_prestressed_tie(tmp_path: Path) -> None:
    """It was refused, with a hint that could not be followed."""
    path = tmp_path / "leaning.toml"
    path.write_text((EXAMPLES / "leaning_stones_with_tie.toml").read_text(encoding="utf-8"))
    code, out, err = run("path", path, "--json")
    assert (code, err) == (0, "")
    told = json.loads(out)["verdict"]
    assert told["outcome"] == "holds"
    assert "prestress = 1" in told["question"]["asked"]


@pytest.mark.parametrize("angle", ["0.0", "1e-120"])
def test_a_settlement_of_nothing_is_none(angle: str, tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(pillar(more=turned(0.0).replace('"0.0 deg"', f'"{angle} deg"')))
    for command in ("run", "path"):
        options = ("--stage", "dead=1", "--stage", "settlement=1") if command == "path" else ()
        _, out, err = run(command, path, *options)
        assert "e-12" not in out + err


def held_in_space(force: float) -> Model:
    """Return a block of 10 kN pushed at its top, held at 0.75 m by a tie of 3 kN."""
    bodies = (
        Polyhedron.box("floor", (-3, -3, -1), (3, 3, 0), kind="fixed"),
        Polyhedron.box("b", (0, 0, 0), (0.5, 1.0, 1.0), kind="rigid"),
    )
    loads = (Load("weight", (0, 0, -1)), Load("point", (force, 0, 0), bodies=("b",), at=(0, 0.5, 1.0), group="live"))
    tie = Tie("rod", "b", (0, 0.5, 0.75), "", (-1, 0.5, 0.75), stiffness=1000.0, yield_force=3.0)
    return Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.8)}, loads=loads, ties=(tie,))


@pytest.mark.long  # two paths in space
def test_a_tie_in_space_that_yields_is_said_to_yield() -> None:
    """About the toe: 10 kN at 0.25 m and 3 kN at 0.75 m carry 4.75 kN at 1 m."""
    with pytest.raises(concio.NoEquilibriumError):
        concio.solve(held_in_space(4.8))
    assert concio.solve(held_in_space(4.7)).solved
    stages = [concio.Stage("dead", {"dead": 1.0}), concio.Stage("live", {"live": 1.0})]
    alone = concio.run_path(held_in_space(4.8), stages)
    assert alone.load()[1].max() == pytest.approx(4.75 / 4.8, rel=1e-3)
    model = held_in_space(9.0)  # the first yields at 7.99 kN, and the other pulls with 4.72 kN in the end
    second = replace(model.ties[0], name="stronger", at_a=(0, 0.5, 0.9), at_b=(-1, 0.5, 0.9), yield_force=10.0)
    path = concio.run_path(replace(model, ties=(*model.ties, second)), stages)
    assert path.verdict.holds
    kinds = [event.kind for event in path.events]
    (at,) = (event.parameter for event in path.events if event.kind == "yields")
    by_hand = (2.5 + 3.0 * 0.75 + 3.6 * 0.9) / 9.0
    assert at == pytest.approx(by_hand, rel=1e-4), "located, not stepped over; joints were given a compliance"
    assert not any("crush" in kind for kind in kinds)


def test_a_weight_that_one_of_two_materials_lacks_is_in_the_sentence(tmp_path: Path) -> None:
    """A slab without weight overhangs: the question is another one, and the sentence says so."""
    light = pillar(point(0.0, -0.01, (0.0, 1.6)))
    light += (
        '[materials.light]\nkind = "rigid"\n[[blocks]]\nname = "slab"\nmaterial = "light"\n'
        "rectangle = [[0.1, 1.6], [1.4, 1.8]]\n"
    )
    path = tmp_path / "model.toml"
    path.write_text(light)
    told = json.loads(run("run", path, "--json")[1])["verdict"]
    assert told["outcome"] == "holds"
    assert "'slab' has no unit weight" in told["sentence"]
    assert "?." not in told["sentence"]
    path.write_text(light.replace("[materials.light]", "[materials.light]\nunit_weight = 20"))
    assert json.loads(run("run", path, "--json")[1])["verdict"]["outcome"] == "fails"
    none = replace(concio.loads(light), loads=())
    assert "Self-weight does not act" in concio.solve(none).sentence
