"""Mechanisms that are named change no answer: what they find was sought by default, is followed and proved alike."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from concio import Assessment, Body, JointLaw, Load, Model, Rigid
from concio.verdict.assessment_verdict import ROUNDED, grounds
from samples import sample
from seismic_walls import ground, site

ROOT = Path(__file__).resolve().parents[1]

SLACK = 1e-6
"""Two searches of one mechanism end within this share of each other."""


def drawn(rng: np.random.Generator) -> Model:
    """Return a wall of courses of random heights and thicknesses that stand on each other, some with a floor."""
    bodies, loads, z = [ground(-2.0, 3.0)], [Load("weight", (0.0, -1.0))], 0.0
    left, right = 0.0, float(rng.uniform(0.5, 0.8))
    for k in range(int(rng.integers(3, 6))):
        h = float(rng.uniform(0.4, 1.2))
        corners = np.array([[left, z], [right, z], [right, z + h], [left, z + h]])
        bodies.append(Body(f"c{k}", corners, kind="rigid"))
        z += h
        if rng.random() < 0.5:
            at = float(rng.uniform(0.3, 0.7)) * (right - left) + left
            loads.append(Load("point", (0.0, -float(rng.uniform(1.0, 20.0))), bodies=(f"c{k}",), at=(at, z)))
        thinner = float(rng.uniform(0.6, 1.0)) * (right - left)
        left += float(rng.random()) * (right - left - thinner)
        right = left + thinner
    friction = float(rng.choice([0.1, 0.3, 0.8]))
    return Model(tuple(bodies), {"block": Rigid(19.0)}, {"joint": JointLaw(friction)}, loads=tuple(loads))


def named(rng: np.random.Generator, model: Model) -> dict[str, Any]:
    """Return what is above a random joint, what is below another, and random blocks by name."""
    free = [b for b in model.bodies if b.kind != "fixed"]
    chosen = rng.choice(len(free), int(rng.integers(1, len(free) + 1)), replace=False)
    edges = np.array([float(b.vertices[:, -1].min()) for b in free])
    top = float(max(b.vertices[:, -1].max() for b in free))
    above, below = float(rng.choice(edges)), float(rng.choice([*edges[edges > edges.min() + 1e-9], top]))
    return {
        "upper half": {"above": above}, "foot": {"below": below}, "some": [free[k].name for k in sorted(chosen)],
    }  # fmt: skip


def compared(model: Model, names: dict[str, Any], **asked: Any) -> Assessment:
    """Assess with and without named mechanisms; what is named worsens nothing, and stands in no better place."""
    plain, found = (concio.assess(model, site=site(), mechanisms=m, **asked) for m in (None, names))
    assert found.zeta == pytest.approx(plain.zeta, rel=SLACK)
    assert found.verdict.outcome is plain.verdict.outcome
    weakest = {m.direction: m.multiplier for m in found.mechanisms if m.name == "weakest of all"}
    assert weakest == pytest.approx({m.direction: m.multiplier for m in plain.mechanisms if m.name == "weakest of all"},
                                    rel=SLACK)  # fmt: skip
    listed = {(m.name, m.direction) for m in found.mechanisms} | {(m.name, m.direction) for m in found.locked}
    for way in found.bounds:
        assert {(name, way) for name in names} <= listed, "what was named is told, whatever it came to"
    for m in (*found.mechanisms, *found.others):
        assert m.multiplier >= weakest[m.direction] * (1 - SLACK)
        if not m.followed.ends:  # no curve: it is among what was not checked, and nothing is verified
            assert found.verdict.outcome.value != "holds"
    assert found.zeta == min(m.zeta for m in (*found.mechanisms, *found.others))
    return found


def gaps_belong(found: Assessment) -> None:
    """A duality gap stands beside the bound that it is the gap of, in the proof and in the grounds."""
    for way, bound in found.bounds.items():
        lines = [line for line in grounds(found) if f"of push {way} over all motions" in line]
        assert len(lines) == (bound.checked and np.isfinite(bound.multiplier))
        for line in lines:
            told, gap = re.search(r"friction, ([\d.e+-]+), with a duality gap of (< )?", line), quoted(line)
            assert told is not None
            assert float(told[1]) == pytest.approx(bound.multiplier, rel=1e-5)
            assert gap == pytest.approx(bound.gap, rel=0.5, abs=ROUNDED)
    worst = found.worst
    if worst is None:
        return
    own = worst.found.associated
    told = re.search(r"lies above ([\d.e+-]+\d) \(associated limit (of|over)", found.verdict.proof)
    assert (told is not None) == (worst.found.flow == "Coulomb")
    if told is not None:
        own = own if told[2] == "of" else found.bounds[worst.direction]
        assert float(told[1]) == pytest.approx(own.upper, rel=1e-3)
        assert own.upper >= worst.multiplier * (1 - SLACK)
    assert quoted(found.verdict.proof) == pytest.approx(own.gap, rel=0.5, abs=ROUNDED)


def quoted(line: str) -> float:
    """Return the duality gap that a sentence tells."""
    told = re.search(r"duality gap (?:of )?(?:< )?([\d.e+-]+\d)", line)
    assert told is not None, line
    return float(told[1])


WALLS = [(1, "right"), *(pytest.param(seed, None, marks=pytest.mark.long) for seed in range(sample(1, 10, 40)))]


@pytest.mark.parametrize(("seed", "way"), WALLS)
def test_named_parts_of_a_random_wall_worsen_nothing(seed: int, way: str | None) -> None:
    rng = np.random.default_rng([25, 7, seed])
    model = drawn(rng)
    gaps_belong(compared(model, named(rng, model), levels=["SLV"], direction=way))


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, 0, 1, 2, 4, 5][: sample(1, 1, 6)])
def test_named_parts_of_a_random_corner_worsen_nothing(seed: int) -> None:
    rng = np.random.default_rng([25, 77, seed])
    courses = int(rng.integers(2, 4))
    model = concio.walls(
        lines=[((0, 0), (0, float(rng.choice([1.0, 1.5])))), ((0, 0), (float(rng.choice([1.0, 1.5])), 0))],
        height=0.25 * courses, block_size=(0.5, 0.25, 0.25), block="rigid", friction=float(rng.uniform(0.4, 0.8)),
    )  # fmt: skip
    names = {"upper half": {"above": 0.25 * int(rng.integers(1, courses))}}
    gaps_belong(compared(model, names, levels=["SLV"], direction="-x"))


@pytest.mark.long
def test_the_upper_half_of_the_shipped_corner_worsens_nothing() -> None:
    """With its upper half named, zeta_E fell from 1.337 to 0.665 once: half of the courses was not sought by itself."""
    model = concio.load(ROOT.parent / "examples" / "facade_with_return.toml")
    found = compared(model, {"upper half": {"above": 1.0}}, levels=["SLV"], direction="-x")
    gaps_belong(found)
    assert found.zeta < 1
