"""What pushes and shakes ask on the command line: which loads, which way, from where, by how much the ground moves."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from commands import run
from pillars import pillar, point, sideways
from samples import sample

HELD = pillar(point(1.0, 0.0, (0.0, 0.8)))
"""Pillar of 12.8 kN, pushed by 1 kN at half its height."""
WEIGHT, ARM, HEIGHT = 12.8, 0.2, 0.8


def asked(command: str, path: Path, *options: object) -> dict[str, Any]:
    code, out, err = run(command, path, *options, "--json")
    assert code in (0, 3, 4), (code, err)
    found: dict[str, Any] = json.loads(out)
    return found


@pytest.mark.parametrize("way", [1, -1])
def test_weights_are_multiplied_beside_a_live_load_that_is_constant(way: int, tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(HELD)
    options = ("--weights", *(["--direction=-x"] if way < 0 else []), "--until", "2 mm")
    found = asked("push", path, *options)
    by_hand = (WEIGHT * ARM - way * 1.0 * HEIGHT) / (WEIGHT * HEIGHT)
    assert found["peak"]["multiplier"] == pytest.approx(by_hand, rel=1e-4)
    roles = {a["group"]: a["role"] for a in found["verdict"]["question"]["acting"]}
    assert roles == {"dead": "constant", "live": "constant", "weights": "multiplied"}


@pytest.mark.long
@settings(max_examples=sample(2, 6, 20), deadline=None)
@given(lean=st.floats(-0.15, 0.1), share=st.one_of(st.floats(0.3, 0.97), st.floats(1.03, 3.0)))
def test_a_growing_load_that_ends_below_the_multiplier_asked_for_has_not_shown_it(
    lean: float, share: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """It was exit code 0, "followed to where it was to end", with half of what was asked for."""
    path = tmp_path_factory.mktemp("load") / "model.toml"
    path.write_text(pillar(sideways(1.0), lean=lean))
    tips = (ARM - lean / 2) / HEIGHT
    code, out, err = run("push", path, "--load", "--step", repr(tips / 20), "--until", repr(share * tips), "--json")
    verdict = json.loads(out)["verdict"]
    assert code == verdict["exit_code"] == (0 if share < 1 else 4), err
    assert (verdict["headline"] == "The multiplier asked for was not reached.") == (share > 1)
    assert bool(verdict["unchecked"]) == (share > 1)


@pytest.mark.parametrize("way", [1, -1])
def test_a_direction_is_that_of_the_live_group_too(way: int, tmp_path: Path) -> None:
    """It was ignored where a live group was multiplied: a leaning pillar tips at another multiplier each way."""
    lean = -0.1
    path = tmp_path / "model.toml"
    path.write_text(pillar(sideways(1.0), lean=lean))
    options = ("--until", "2 mm", *(["--direction=-x"] if way < 0 else []))
    found = asked("push", path, *options)
    assert found["peak"]["multiplier"] == pytest.approx((ARM - way * lean / 2) / HEIGHT, rel=1e-4)
    live = next(a for a in found["verdict"]["question"]["acting"] if a["group"] == "live")
    assert live["role"] == "multiplied"


@pytest.mark.long  # three motions
def test_a_restart_counts_rotation_from_the_first_start(tmp_path: Path) -> None:
    """A pillar falls in two parts: together they turn it by what one run does, of which the second adds a fifth."""
    path, first = tmp_path / "model.toml", tmp_path / "first"
    path.write_text(pillar())
    shake = ("--pulse", "half sine,0.6 g,0.4 s")
    begun = asked("shake", path, *shake, "--duration", "0.6 s", "--out", first)["largest_rotation"]["angle"]
    whole = asked("shake", path, *shake, "--duration", "0.7 s")["largest_rotation"]["angle"]
    again = asked("shake", path, "--from", first / "motion.npz", "--duration", "0.1 s")
    assert whole > 1.2 * begun
    assert again["largest_rotation"]["angle"] == pytest.approx(whole, rel=1e-6)
    assert f"leans beyond its own equilibrium, at {math.degrees(whole):.3g} degrees" in again["verdict"]["sentence"]
    assert "from where it was described" in again["verdict"]["sentence"]


def test_the_largest_acceleration_of_the_ground_stands_in_the_first_lines(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(pillar())
    values = [round(1.25 * math.sin(0.4 * k), 6) for k in range(9)]
    rows = "".join(f"{0.01 * k},{v}\n" for k, v in enumerate(values))
    (tmp_path / "record.csv").write_text("time,acceleration\ns,m/s2\n" + rows)
    code, out, err = run(
        "shake", path, "--motion", tmp_path / "record.csv", "--record-unit", "m/s2", "--duration", "0.05 s"
    )
    assert code in (0, 4), err
    peak = max(map(abs, values)) / 9.80665
    assert any(f"largest acceleration {peak:.4g} g" in line for line in out.splitlines()[:3]), out
