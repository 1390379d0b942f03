"""Motions that go on from a file, and ground motions of a file beside those of the command line."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from commands import run
from concio.errors import InputError
from concio.model.file.motion_table import motion_table
from concio.model.file.reading import file_units
from samples import sample

G = 9.80665
few = settings(max_examples=sample(2, 8, 30), deadline=None)
HEAD = """
[materials.stone]
kind = "rigid"
unit_weight = {weight!r}
[joints.dry]
friction = {friction!r}
[[loads]]
kind = "weight"
value = [0, -1]
[[blocks]]
name = "floor"
rectangle = [[-20, -0.5], [20, 0]]
kind = "fixed"
"""
BLOCK = """
[[blocks]]
name = "{name}"
rectangle = [[{left!r}, 0], [{right!r}, {height!r}]]
material = "stone"
"""
SIZES = {"low": (-1.0, 0.0, 0.3), "other": (2.0, 2.8, 0.4)}


def file(order: list[str], friction: float = 0.5, weight: float = 20.0, **sizes: tuple[float, float, float]) -> str:
    """Return a model of blocks on a floor, in an order."""
    text = HEAD.format(weight=weight, friction=friction)
    for name in order:
        left, right, height = (SIZES | sizes)[name]
        text += BLOCK.format(name=name, left=left, right=right, height=height)
    return text


def shaken(path: Path, *options: object) -> dict[str, Any]:
    code, out, err = run("shake", path, *options, "--json")
    assert code in (0, 4), err
    found: dict[str, Any] = json.loads(out)
    return found


@pytest.mark.long
@few
@given(friction=st.floats(0.3, 0.9), speed=st.floats(0.2, 0.7), share=st.floats(0.1, 0.8))
def test_a_block_that_is_thrown_slides_as_far_in_two_runs_as_in_one(
    friction: float, speed: float, share: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """v^2 / (2 mu g), however the time is divided: the second run began with the velocities of the file again."""
    folder = tmp_path_factory.mktemp("thrown")
    path, rest = folder / "model.toml", speed / (friction * G)
    path.write_text(file(["low"], friction) + f"[motion]\nvelocities = {{ low = [{speed!r}, 0, 0] }}\n")
    shaken(path, "--duration", f"{share * rest!r} s", "--out", folder / "first")
    found = shaken(path, "--from", folder / "first" / "motion.npz", "--duration", f"{1.5 * rest!r} s")
    assert found["largest_slip"] == pytest.approx(speed**2 / (2 * friction * G), rel=0.02)
    assert any("velocities of the file" in note for note in found["verdict"]["attention"])


@pytest.mark.long
@few
@given(data=st.data())
def test_a_motion_goes_on_with_its_own_blocks_alone(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Blocks in another order stood at each other's places, and fell."""
    folder = tmp_path_factory.mktemp("other")
    first, second = folder / "model.toml", folder / "second.toml"
    first.write_text(file(["low", "other"]) + '[motion]\nduration = "20 ms"\n')
    shaken(first, "--out", folder / "first")
    left, right, height = SIZES["other"]
    by = data.draw(st.floats(0.01, 0.5))
    changed = data.draw(st.sampled_from([(left + by, right, height), (left, right, height + by), None]))
    second.write_text(file(["other", "low"]) if changed is None else file(["low", "other"], other=changed))
    code, out, err = run("shake", second, "--from", folder / "first" / "motion.npz", "--duration", "20 ms")
    assert code == 2, out
    assert ("in this order" if changed is None else "block 'other' is not the one") in err
    second.write_text(file(["low", "other"], weight=20.0 * (1 + by)))
    found = shaken(second, "--from", folder / "first" / "motion.npz", "--duration", "20 ms")
    assert any("is not that of the earlier motion" in note for note in found["verdict"]["attention"])
    found = shaken(first, "--from", folder / "first" / "motion.npz")
    assert not found["verdict"]["attention"]


@few
@given(scale=st.floats(0.05, 0.9), amplitude=st.floats(0.5, 3.0))
def test_the_scale_of_a_file_is_that_of_its_own_motion_beside_another(
    scale: float, amplitude: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("scaled")
    path, still = folder / "model.toml", folder / "still.txt"
    np.savetxt(still, np.column_stack([np.arange(30) / 100, np.zeros(30)]))
    pulse = f'shape = "half sine", amplitude = {amplitude!r}, length = "40 ms"'
    path.write_text(file(["low"]) + f'[motion]\nscale = {scale!r}\nduration = "20 ms"\npulse = {{ {pulse} }}\n')
    beside = ("--vertical", still, "--record-unit", "m/s2")
    alone = shaken(path)["ground_peak"]
    assert alone == pytest.approx(scale * amplitude, rel=1e-3)
    assert shaken(path, *beside)["ground_peak"] == pytest.approx(alone)
    assert shaken(path, *beside, "--scale", 0.5)["ground_peak"] == pytest.approx(0.5 * amplitude, rel=1e-3)
    other = shaken(path, "--pulse", f"half sine,{amplitude!r},40 ms")
    assert other["ground_peak"] == pytest.approx(amplitude, rel=1e-3)
    assert any("was not applied" in note for note in other["verdict"]["attention"])


def test_what_another_motion_leaves_out_of_the_file_is_said(tmp_path: Path) -> None:
    path, record = tmp_path / "model.toml", tmp_path / "up.txt"
    np.savetxt(record, np.column_stack([np.arange(30) / 100, np.ones(30)]))
    path.write_text(file(["low"]) + '[motion]\nvertical = "up.txt"\nunit = "m/s2"\nduration = "10 ms"\n')
    found = shaken(path, "--pulse", "half sine,0.1 g,40 ms")
    assert any("vertical record of the file" in note for note in found["verdict"]["attention"])


@given(st.sampled_from(["mm", "cm"]), st.floats(0.1, 1e4))
def test_bare_accelerations_and_velocities_are_refused_where_the_file_is_not_in_metres(unit: str, size: float) -> None:
    """200 in a file in mm was 200 m/s, said by nothing."""
    said = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
    for length, factor in said.items():
        text = (
            f'[units]\nlength = "{unit}"\n[motion]\n'
            f'pulse = {{ shape = "sine", amplitude = "{size!r} m/s2", length = 1 }}\n'
            f'velocities = {{ a = ["{size!r} {length}/s", 0, "{size!r} rad/s"] }}\n'
        )
        data = tomllib.loads(text)
        table = motion_table(data, "file", file_units(data, "file"))
        assert table.arguments(2)["velocities"]["a"] == pytest.approx([size * factor, 0, size])
        with pytest.raises(InputError, match="is not a velocity"):
            table.arguments(3)
    for bare in (
        f'pulse = {{ shape = "sine", amplitude = {size!r}, length = 1 }}', f"gravity = {size!r}",
        f"velocities = {{ a = [0, {size!r}] }}", f"velocities = {{ a = [0, '{size!r}', 0] }}",
    ):  # fmt: skip
        data = tomllib.loads(f'[units]\nlength = "{unit}"\n[motion]\n{bare}\n')
        with pytest.raises(InputError, match="has no unit"):
            motion_table(data, "file", file_units(data, "file"))
        assert motion_table(data, "file") is not None


@pytest.mark.parametrize(("option", "value"), [("--record-unit", "g"), ("--record-step", "10 ms")])
def test_a_unit_of_no_record_is_refused(tmp_path, option, value):
    """It was left aside: the record of the file kept its own."""
    path = tmp_path / "low.toml"
    path.write_text(file(["low"]) + '[motion]\npulse = { shape = "sine", amplitude = "0.1 g", length = "0.1 s" }\n')
    code, _, err = run("shake", path, option, value, "--duration", "0.02 s")
    assert code == 2
    assert "none is given" in err


def test_what_a_motion_has_otherwise_than_the_one_before_is_said(tmp_path):
    """Other load factors, gravity and impacts acted from the end of the earlier motion on without a word."""
    path = tmp_path / "low.toml"
    live = '[[loads]]\nkind = "point"\nvalue = [0, -2]\nat = [-0.5, 0.3]\nbodies = ["low"]\ngroup = "live"\n'
    text = file(["low"]) + live + '[motion]\nstep = "5 ms"\nduration = "0.02 s"\n'
    path.write_text(text)
    shaken(path, "-f", "live=3", "--out", tmp_path / "first")
    begun = ("--from", tmp_path / "first" / "motion.npz")
    path.write_text(text + "gravity = 5.0\nrestitution = 0.5\n")
    said = [line for line in shaken(path, *begun)["attention"] if "the earlier motion had" in line]
    assert said == [
        "the earlier motion had live x 3, gravity 9.80665 m/s2, restitution 0: what is stated here acts from its end on"
    ]
    path.write_text(text)
    assert not any("earlier motion had" in line for line in shaken(path, *begun, "-f", "live=3")["attention"])


@pytest.mark.parametrize("key", ['unit = "g"', 'record_step = "10 ms"'])
def test_a_unit_of_no_record_in_a_file_is_refused(tmp_path, key):
    path = tmp_path / "low.toml"
    pulse = 'pulse = { shape = "sine", amplitude = "0.1 g", length = "0.1 s" }\n'
    path.write_text(file(["low"]) + "[motion]\n" + pulse + key + "\n")
    code, _, err = run("shake", path, "--duration", "0.02 s")
    assert code == 2
    assert "no record is named" in err
