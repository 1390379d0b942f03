"""Studies, motions, proofs, assessments and settlements say what a load step says, or say what else they were asked."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_commands_agree import FAILS, HOLDS, LIVE, MODELS, asked, spread

import concio
from concio.analysis.exact_proofs import collapse_proof
from concio.analysis.limit_result import LimitResult
from concio.problem.solution import Status
from concio.proof.exact_certificate import prove_collapse
from concio.proof.verify import check
from concio.verdict.verdict import Outcome
from pillars import ARCH, pillar, sideways, turned
from samples import first, sample

SELF_STRESS = ("slot of rigid blocks", "slot of elastic blocks", "narrow panel", "hangs beside a heavy block",
               "hangs beside a heavy block that is pushed")  # fmt: skip
"""They fall, though forces in balance within friction exist: no proof says that nothing balances the loads."""
NOT_PROVED = ("floor turned", "floor turned too far")
"""A proof in fractions refuses moved supports by name."""
TURNED = {"floor turned too far": FAILS}
"""Where weights turn with their floor the answer is another one, which the motion and the push name."""
SITE = """
[site]
soil = "B"
[site.hazard]
SLV = { a_g = 0.1, F0 = 2.45, Tc = 0.32 }
"""
STUDY = """
[study]
size = 1
outputs = ["stands", "associated_multiplier"]
live = ["LIVE"]
[[study.variables]]
name = "friction"
distribution = "choice"
keys = "KEY"
values = [VALUE]
"""


def written(name: str, tmp_path: Path, more: str = "") -> Path:
    path = tmp_path / "model.toml"
    path.write_text(MODELS[name][0] + more)
    return path


def friction_of(text: str) -> tuple[str, str]:
    """Return the key of the friction of a model file, and its value."""
    table = next((kind for kind in ("arch", "panel") if f"[{kind}]" in text), "joints.dry")
    return f"{table}.friction", text.partition("friction = ")[2].split()[0]


@pytest.mark.parametrize("name", spread(list(MODELS), 0, 3))
def test_a_study_of_one_row_says_what_run_and_limit_say(name: str, tmp_path: Path) -> None:
    """The one value of its variable is that of the file: the row is the model."""
    live = LIVE.get(name, "live")
    key, value = friction_of(MODELS[name][0])
    more = STUDY.replace("LIVE", live).replace("KEY", key).replace("VALUE", value)
    path = written(name, tmp_path, more)
    found = asked("study", path, "--no-figures")
    stands = found["outputs"]["stands"]["quantiles"]["50 %"][0]
    assert stands == {HOLDS: 1.0, FAILS: 0.0}[MODELS[name][1]]
    bound = float(found["outputs"]["associated_multiplier"]["quantiles"]["50 %"][0])
    limit = asked("limit", path, "--no-path", "--no-steps", "--no-friction", "--group", live)
    if limit["status"] == "error":  # nothing can be added to what falls already
        assert bound == -np.inf
    elif limit["associated_multiplier"] is None:
        assert bound == np.inf
    else:
        assert bound == pytest.approx(limit["associated_multiplier"], rel=1e-9)


MOVES = [n for n in MODELS if n != "narrow panel"]


@pytest.mark.parametrize("name", spread(MOVES, 0, 5))
def test_a_motion_that_hardly_begins_says_whether_the_structure_stands(name: str, tmp_path: Path) -> None:
    """A ten-thousandth of gravity moves nothing that stands: what falls does not stand before the ground moves."""
    options = ("--duration", "0.05 s") if MODELS[name][1] == FAILS or name in TURNED else ()
    found = asked("shake", written(name, tmp_path), "--pulse", "sine,0.0001 g,0.05 s", *options)["verdict"]
    right = TURNED.get(name, MODELS[name][1])
    assert found["outcome"] == right, found["sentence"]
    assert ("does not stand before the ground moves" in found["sentence"]) == (right == FAILS)
    if name in TURNED:
        assert any("where displacements are taken to be small" in line for line in found["attention"])
        assert "come to rest" not in found["sentence"], "what it does elsewhere is no answer"
        assert "is not the motion that was asked for" in found["sentence"]


@pytest.mark.parametrize("name", spread(list(MODELS), 2, 4))
def test_a_proof_in_fractions_says_what_run_and_limit_say(name: str, tmp_path: Path) -> None:
    path, live = written(name, tmp_path), LIVE.get(name, "live")
    if name in NOT_PROVED:
        from commands import run

        code, out, _ = run("prove", path, "--json")
        assert code == 2
        assert "not proved exactly" in json.loads(out)["what"]
        return
    collapse = asked("prove", path, "--claim", "collapse")
    falls = MODELS[name][1] == FAILS and name not in SELF_STRESS
    assert (collapse["verdict"]["outcome"] == HOLDS) == falls, "proved: nothing balances the loads"
    assert falls == (asked("run", path)["status"] == "no_equilibrium")
    bounds = asked("prove", path, "--group", live, "--force")
    limit = asked("limit", path, "--no-path", "--no-steps", "--no-friction", "--group", live)
    if limit["status"] == "error":
        assert bounds["verdict"]["outcome"] == limit["verdict"]["outcome"] == FAILS
    elif limit["associated_multiplier"] is None:  # any multiple is balanced: there is no number to prove
        assert bounds["verdict"]["outcome"] == "undecided"
    else:
        low, high = (float(Fraction(bounds[side])) for side in ("lower", "upper"))
        slack = 1e-6 * max(1.0, high)
        assert low - slack <= limit["associated_multiplier"] <= high + slack
        assert (high < 1) == falls


PUSHED = ["leans and stands", "standing", "shelf", "pressed down", "live load holds", "stiff joints hold"]


@pytest.mark.parametrize("name", spread(PUSHED, 0, 3))
def test_at_the_multiplier_of_an_assessment_a_load_step_ceases_to_hold(name: str, tmp_path: Path) -> None:
    """The weights and what presses from above act sideways, times alpha_0, beside all that acts as it is."""
    path = written(name, tmp_path, SITE)
    found = asked("assess", path)
    per_way = {m["direction"]: m["alpha0"] for m in found["mechanisms"]}
    assert len(per_way) == 2
    pressing = [("0.0, 1.6", 5.0)] if name == "pressed down" else []
    least = []
    for way in (1.0, -1.0):
        quake = sideways(way, "quake")
        for at, force in pressing:
            quake += (
                f'[[loads]]\nkind = "point"\nvalue = [{way * force}, 0.0]\nbodies = ["pillar"]\nat = [{at}]\n'
                'group = "quake"\n'
            )
        path = written(name, tmp_path, quake)
        bound = asked("limit", path, "--no-path", "--no-steps", "--no-friction", "--group", "quake")
        least.append(bound["associated_multiplier"])
        for share, right in ((0.999, HOLDS), (1.001, FAILS)):
            step = asked("run", path, "--factor", f"quake={share * least[-1]!r}")["verdict"]["outcome"]
            assert step == right, (way, share)
    assert sorted(per_way.values()) == pytest.approx(sorted(least), rel=1e-6)


@pytest.mark.parametrize("angle", first(1, [-5.0, 2.0]))
@pytest.mark.parametrize("load", [0.1, 0.3])
def test_a_settlement_ends_as_the_load_step_of_all_loads(angle: float, load: float, tmp_path: Path) -> None:
    model = concio.loads(pillar(sideways(load), more=turned(angle)))
    result = concio.solve(model, on_failure="return")
    settled = concio.settle(model)
    assert settled.verdict.outcome is (Outcome.HOLDS if result.solved else settled.verdict.outcome)
    assert settled.reached == result.solved == settled.verdict.holds
    if not result.solved:
        assert settled.verdict.outcome in (Outcome.FAILS, Outcome.INCOMPLETE)


def drawn(seed: int, dim: int) -> concio.Model:
    """Return a random wall pushed sideways by 0.4 to 1.3 times its associated bound; in space one block thick."""
    rng = np.random.default_rng([25, seed])
    unit_weight = float(rng.uniform(10, 25))
    block: concio.Elastic | concio.Rigid = concio.Rigid(unit_weight)
    if rng.integers(2):
        block = concio.Elastic(E=10 ** rng.uniform(5, 7), nu=0.2, unit_weight=unit_weight)
    friction, share = float(rng.uniform(0.3, 1.0)), float(rng.uniform(0.4, 1.3))
    courses = int(rng.integers(2, 4)) if dim == 2 else 2
    size = (float(rng.uniform(0.2, 0.5)), float(rng.uniform(0.1, 0.3)))

    def made(horizontal: float) -> concio.Model:
        model = concio.running_bond_panel(
            courses=courses, blocks=2, block_size=size, block=block, friction=friction, horizontal=horizontal,
            base="full", side_walls=False, elements_per_block=(2, 1),
        )  # fmt: skip
        return model if dim == 2 else concio.extrude(model, 0.3)

    whole = concio.limit(made(1.0), path=False, steps=False, search=False).associated.multiplier
    return made(share * whole)


IN_SPACE = [pytest.param(k, 3, marks=pytest.mark.long) for k in sample([4], [3, 4], [0, 1, 3, 4, 5, 6, 7])]


@pytest.mark.parametrize(("seed", "dim"), [*((k, 2) for k in range(sample(2, 8, 20))), *IN_SPACE])
def test_every_analysis_of_a_random_wall_says_the_same(seed: int, dim: int) -> None:
    model = drawn(seed, dim)
    assembly = concio.assemble(model)
    step = concio.solve(assembly, on_failure="return")
    assert step.verdict.outcome in (Outcome.HOLDS, Outcome.FAILS), step.sentence
    limit = concio.limit(assembly, search=False, path=False)
    bound = limit.associated.multiplier
    margin = concio.load_margin(assembly, tolerance=0.02)
    friction = concio.friction_margin(assembly)
    stages = [concio.Stage("dead", {"dead": 1.0}), concio.Stage("live", {"live": 1.0})]
    path = concio.run_path(assembly, stages)
    holds = step.verdict.holds
    assert (bound < 1) == (step.status is Status.NO_EQUILIBRIUM), "the bound of statics and the proof of the step"
    assert (friction.factor > 1) == (bound < 1)
    assert friction.verdict.holds == (bound >= 1)
    if path.verdict.holds or limit.design >= 1:
        assert holds or any("several equilibria" in line for line in (*path.verdict.limits, *limit.verdict.limits))
        assert bound >= 1
    if holds:
        assert bound >= 1
        assert not margin.fails < 1 or margin.holds < margin.fails
    if margin.holds >= 1:
        assert bound >= 1
    names = proofs(assembly, limit)
    assert names["collapse"] == (bound < 1)


def proofs(assembly: concio.Assembly, limit: LimitResult) -> dict[str, Any]:
    """Return what fractions say of a structure, which has to enclose the bound."""
    found: dict[str, Any] = {"collapse": False}
    bound = limit.associated.multiplier
    try:
        collapse_proof(assembly)
        found["collapse"] = True
    except concio.SolverError:
        pass
    made = limit.proof()
    slack = 1e-6 * max(1.0, bound)
    if "lower" in made:
        assert float(Fraction(made["lower"])) <= bound + slack
    if "upper" in made:
        assert float(Fraction(made["upper"])) >= bound - slack
    assert {"lower", "upper"} & set(made)
    return found


@pytest.mark.parametrize("angle", [20.0, 45.0])
def test_a_cube_pushed_just_beyond_its_friction_is_proved_to_slide(angle: float) -> None:
    """Between two of the planes that cut the round cone coarsely there is more friction than 1.002 times its own."""
    cube = concio.extrude(concio.column(width=0.5, height=0.25, blocks=1, block="rigid", friction=0.6), 0.5)
    for share, falls in ((1.002, True), (0.998, False)):
        push = 0.6 * share * np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))])
        assembly = concio.assemble(replace(cube, loads=(concio.Load("weight", (*push.tolist(), -1.0)),)))
        with pytest.raises(concio.SolverError):
            prove_collapse(assembly)
        if falls:
            assert check(collapse_proof(assembly)).startswith("no forces")
        else:
            with pytest.raises(concio.SolverError):
                collapse_proof(assembly)


@pytest.mark.long  # the cube above is pushed as near
def test_a_collapse_in_space_is_proved_near_its_mechanism() -> None:
    """Round cones cut by planes: cut coarsely they resist a motion that the round ones do not."""
    assembly = concio.assemble(drawn(5, 3))
    with pytest.raises(concio.SolverError):
        prove_collapse(assembly)
    assert check(collapse_proof(assembly)).startswith("no forces")


def test_the_arch_is_asked_by_every_command(tmp_path: Path) -> None:
    """A bound, a proof, a margin and a load step of one structure, as numbers."""
    model = concio.loads(ARCH)
    bound = concio.limit(model, path=False, steps=False, search=False).associated.multiplier
    margin = concio.load_margin(model, tolerance=0.02)
    assert margin.holds <= bound * (1 + 1e-9)
    assert concio.solve(model, factors={"live": 0.99 * margin.holds}).solved
    beyond = concio.solve(model, factors={"live": 1.01 * bound}, on_failure="return")
    assert beyond.verdict.outcome is Outcome.FAILS
