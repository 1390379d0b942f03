"""A body too light beside its part for any certificate to see leaves every command incomplete, which says so."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from commands import run
from concio.verdict.unseen import SEEN, unseen, unseen_bodies
from pillars import pillar, sideways
from samples import sample
from seismic_walls import overturning, site

COMMANDS: dict[str, tuple[str, ...]] = {
    "run": (), "path": ("--stage", "dead=1", "--stage", "live=1"), "limit": ("--no-friction",),
    "limit ": ("--no-path", "--no-steps", "--no-friction"), "push": ("--until", "5 mm"),
    "shake": ("--pulse", "sine,0.02 g,0.1 s", "--duration", "2 ms"), "compare": ("--methods", "auto"),
}  # fmt: skip
LONG = ("limit", "push", "shake")
DUST = """
[materials.dust]
kind = "rigid"
unit_weight = "{weight} kN/m3"
[[blocks]]
name = "pebble"
rectangle = [[-0.02, {z}], [0.02, {top}]]
kind = "rigid"
material = "dust"
"""


def with_pebble(share: float, *, apart: bool = False) -> str:
    """Return the pillar with a pebble of a share of all weight on it, or apart on the floor."""
    z = 0.0 if apart else 1.6
    dust = DUST.format(weight=share * 12.8 / (0.04 * 0.02), z=z, top=z + 0.02)
    text = pillar(sideways(0.1), more=dust)
    return text.replace("[-0.02, 0.0], [0.02, 0.02]", "[2.0, 0.0], [2.04, 0.02]") if apart else text


def asked(command: str, path: Path) -> tuple[int, dict[str, Any]]:
    code, out, err = run(command.strip(), path, *COMMANDS[command], "--json")
    assert code in (0, 3, 4), err
    return code, json.loads(out)["verdict"]


@pytest.mark.parametrize("command", [pytest.param(c, marks=pytest.mark.long) if c in LONG else c for c in COMMANDS])
def test_every_command_says_of_which_body_nothing_is_shown(command: str, tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(with_pebble(1e-11))
    code, found = asked(command, path)
    assert any("whether pebble is held" in line for line in found["unchecked"])
    assert "whether pebble is held" in found["sentence"]
    assert code == 4, found["outcome"]
    path.write_text(with_pebble(1e-4))
    code, found = asked(command, path)
    assert not any("pebble" in line for line in found["unchecked"])
    if command != "shake":  # ends before it rests
        assert code == 0, found["sentence"]
    path.write_text(with_pebble(1e-11, apart=True))
    _, found = asked(command, path)
    assert not any("pebble" in line for line in found["unchecked"]), "a part of its own is seen by its own loads"


STUDY = """
[study]
size = 2
outputs = [{outputs}]
[[study.variables]]
name = "friction"
distribution = "choice"
keys = "joints.dry.friction"
values = [0.7]
"""


@pytest.mark.parametrize("outputs", ['"stands"', '"associated_multiplier"'])
def test_a_study_says_so_of_its_runs(outputs: str, tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    for share, light in ((1e-11, True), (1e-4, False)):
        path.write_text(with_pebble(share) + STUDY.format(outputs=outputs))
        code, out, err = run("study", path, "--no-figures", "--json", "--out", tmp_path / f"study{light}")
        found = json.loads(out)["verdict"]
        assert any("in 2 of 2 runs: whether pebble is held" in line for line in found["unchecked"]) == light, err
        assert (code, found["outcome"]) == ((4, "incomplete") if light else (0, "holds"))


@pytest.mark.long
def test_an_assessment_says_so_in_both_languages() -> None:
    wall = overturning()
    light = concio.Body("pebble", [(0.2, 6.0), (0.22, 6.0), (0.22, 6.02), (0.2, 6.02)], kind="rigid", material="dust")
    small = replace(wall, bodies=(*wall.bodies, light), materials={**wall.materials, "dust": concio.Rigid(1e-7)})
    given_ = {"site": site(), "direction": "right"}
    whole, found = concio.assess(wall, **given_).verdict, concio.assess(small, **given_)
    assert not any("c1" in line for line in whole.unchecked)
    assert any("whether anything holds pebble" in line for line in found.verdict.unchecked)
    assert "unseen" in [item.kind for item in found.open]


@settings(max_examples=sample(10, 25, 60), deadline=None)
@given(st.floats(-14, -3), st.floats(-3, 2), st.integers(2, 3))
def test_what_is_seen_depends_on_shares_alone(share: float, size: float, dim: int) -> None:
    """Whatever the size, in plane and space, and whatever else stands unconnected."""
    h, share = 10.0**size, 10.0**share

    def block(name: str, x: float, z: float, a: float, material: str = "stone", kind: str = "rigid") -> Any:
        if dim == 2:
            outline = [(x, z), (x + a, z), (x + a, z + a), (x, z + a)]
            return concio.Body(name, [(p * h, q * h) for p, q in outline], kind=kind, material=material)
        low, high = (x * h, 0.0, z * h), ((x + a) * h, a * h, (z + a) * h)
        return concio.Polyhedron.box(name, low, high, kind=kind, material=material)

    bodies = (
        block("ground", 0.0, -1.0, 1.0, kind="fixed"), block("wall", 0.0, 0.0, 1.0),
        block("light", 0.0, 1.0, 0.1, "dust"), block("far ground", 9.0, -1.0, 1.0, kind="fixed"),
        block("far", 9.0, 0.0, 1.0, "lead"),
    )  # fmt: skip
    dust = share * 20.0 / 0.1**dim
    materials = {"stone": concio.Rigid(20.0), "dust": concio.Rigid(dust), "lead": concio.Rigid(20.0 / share)}
    down = (0.0,) * (dim - 1) + (-1.0,)
    model = concio.Model(bodies, materials, {"joint": concio.JointLaw(0.6)}, loads=(concio.Load("weight", down),))
    seen = unseen_bodies(concio.assemble(model), (None,))
    assert seen == (("light",) if share < SEEN * (1 + share) else ())


def test_what_is_seen_is_seen_at_every_factor_that_is_told_of() -> None:
    """A body without a weight worth speaking of is seen where another load acts on it, at these factors alone."""
    ground, wall, light = (
        concio.Body(name, [(x, z), (x + a, z), (x + a, z + a), (x, z + a)], kind=kind, material=material)
        for name, x, z, a, kind, material in (
            ("ground", 0.0, -1.0, 1.0, "fixed", "stone"), ("wall", 0.0, 0.0, 1.0, "rigid", "stone"),
            ("light", 0.0, 1.0, 0.1, "rigid", "dust"),
        )
    )  # fmt: skip
    loads = (
        concio.Load("weight", (0.0, -1.0)),
        concio.Load("point", (0.0, -1.0), bodies=("light",), at=(0.05, 1.1), group="live"),
    )
    materials = {"stone": concio.Rigid(20.0), "dust": concio.Rigid(1e-9)}
    model = concio.Model((ground, wall, light), materials, {"joint": concio.JointLaw(0.6)}, loads=loads)
    assembly = concio.assemble(model)
    assert unseen(assembly, None) == unseen(assembly, {"live": 1.0}) == unseen(assembly, {"live": -0.2}) == ()
    (told,) = unseen(assembly, {"live": 0.0})
    assert "whether light is held" in told
    assert unseen(assembly, {"live": 1.0}, {"live": 0.0}) == (told,)
    assert unseen(assembly, {"live": 0.0}, {"live": 1.0}) == (told,)
