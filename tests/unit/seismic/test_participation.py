"""The participating mass and the spectral quantities of a chain of blocks, against their formulas by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.seismic import participation
from concio.analysis.seismic.participation import Chain, Participant, gathered


def participant(size: tuple[float, ...], delta: float) -> Participant:
    return Participant(0, "weight", np.array(size), np.zeros(len(size)), delta)


def test_participating_mass_of_three_forces() -> None:
    """Forces of 5, 2 and 1 kN that move by 0.5, 2 and -1: sums 8, 5.5 and 10.25."""
    found = Chain((participant((3.0, -4.0), 0.5), participant((0.0, -2.0), 2.0), participant((1.0, 0.0), -1.0)))
    assert found.sums == pytest.approx((8.0, 5.5, 10.25))
    assert found.e_star == pytest.approx(5.5**2 / (8.0 * 10.25))
    assert found.spectral == pytest.approx(10.25 / 5.5)


def test_what_moves_as_one_takes_part_as_a_whole() -> None:
    """All forces move alike: e* is one whatever they are, and the spectral displacement is that of any of them."""
    found = Chain(tuple(participant((0.0, -w), 0.3) for w in (1.0, 7.0, 0.2)))
    assert found.e_star == pytest.approx(1.0)
    assert found.spectral == pytest.approx(0.3)


def applied(body: int, load: int, force: tuple[float, ...], point: tuple[float, ...]) -> SimpleNamespace:
    return SimpleNamespace(body=body, load=load, force=np.array(force, dtype=float), point=np.array(point, dtype=float))


def test_forces_of_a_load_on_a_block_are_gathered_and_what_pushes_sideways_is_kept_apart(monkeypatch) -> None:
    """Weights of two bodies are one force in their centroid; what pushes along y in space is not one with them."""
    parts = [
        applied(0, 0, (0, 0, -3), (0, 0, 1)), applied(1, 0, (0, 0, -1), (4, 0, 3)),
        applied(2, 0, (0, 0, -5), (9, 9, 9)), applied(7, 0, (0, 0, -50), (1, 1, 1)),
        applied(0, 3, (0, 2, -1), (1, 0, 0)), applied(0, 3, (1, 0, -4), (2, 0, 0)), applied(0, 3, (0, 0, 0), (8, 8, 8)),
        applied(1, 3, (0, -6, 4), (3, 0, 0)),
    ]  # fmt: skip
    monkeypatch.setattr(participation, "applied_forces", lambda model, numbers: [p for p in parts if p.load in numbers])
    model = SimpleNamespace(loads={0: SimpleNamespace(kind="weight"), 3: SimpleNamespace(kind="pressure")})
    mechanics = SimpleNamespace(of_body={0: 0, 1: 0, 2: 1})
    found = gathered(model, mechanics, (0, 3), {3: 1})
    told = [(name, f.block, f.force.tolist(), f.point.tolist()) for name, f in found]
    a, b = np.hypot(2, 1), np.hypot(6, 4)
    assert told[0] == ("pressure 2", 0, [0.0, -4.0, 3.0], [pytest.approx((a * 1 + b * 3) / (a + b)), 0.0, 0.0])
    assert told[1] == ("pressure 2", 0, [1.0, 0.0, -4.0], [2.0, 0.0, 0.0])
    assert told[2] == ("weight", 0, [0.0, 0.0, -4.0], [1.0, 0.0, 1.5])
    assert told[3] == ("weight", 1, [0.0, 0.0, -5.0], [9.0, 9.0, 9.0])
    assert len(told) == 4
    assert {name for name, _ in gathered(model, mechanics, (3,))} == {"pressure 4"}
