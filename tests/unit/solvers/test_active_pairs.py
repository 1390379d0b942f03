"""Pairs of a step that stand apart are left out of its problem, and change nothing."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.solvers.stepping import active_pairs
from space_motions import blocks


def rocked(monkeypatch, least):
    monkeypatch.setattr(active_pairs, "MANY", least)
    model = blocks(((-0.2, -0.3, 0.0), (0.2, 0.3, 0.5)), ((-0.2, -0.3, 0.5), (0.1, 0.3, 1.2)))
    pulse = concio.Pulse("sine", amplitude=5.0, length=0.3)
    return concio.dynamics(model, {"x": pulse, "y": pulse}, duration=0.4, step=5e-3, stop_overturned=False)


@pytest.mark.long
def test_a_motion_is_the_same_with_the_pairs_that_stand_apart(monkeypatch):
    picked = []
    of = active_pairs.ActivePairs.of
    monkeypatch.setattr(
        active_pairs.ActivePairs, "of", lambda p, known: picked.append(of(p, known)) or picked[-1]
    )
    part, whole = rocked(monkeypatch, 0), rocked(monkeypatch, 10**9)
    assert any(one.pick is not None and len(one.pick) < one.whole.pairs for one in picked)
    assert part.certified
    assert np.abs(whole.end.rotation - np.eye(3)).max() > 0.01  # it rocks
    assert part.end.centre == pytest.approx(whole.end.centre, abs=1e-10)
    assert part.end.rotation == pytest.approx(whole.end.rotation, abs=1e-10)


@pytest.mark.long
def test_rows_are_shared_by_problems_that_differ_in_loads_alone(monkeypatch):
    shared = []
    take = active_pairs.StepProblem.share_rows
    monkeypatch.setattr(
        active_pairs.StepProblem, "share_rows", lambda self, other: shared.append(self) or take(self, other)
    )
    rocked(monkeypatch, 0)
    assert shared
    for p in shared[:20]:
        once = p.opening(np.arange(1.0, 1.0 + len(p.b)))
        direct = np.append(np.arange(1.0, 1.0 + len(p.b)), 0.0)
        assert once == pytest.approx(np.einsum("mdw,mw->md", p.values, direct[p.columns]), rel=1e-12, abs=1e-12)
