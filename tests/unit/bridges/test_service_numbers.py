"""Counts and pressures of a bridge in service, from joints whose numbers are known."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.analysis.bridges import service
from concio.analysis.bridges.service import service_state


def told(monkeypatch: pytest.MonkeyPatch, force: float = 1.0, **changed: object) -> service.ServiceState:
    """Return the state of four joints, the forces times a factor."""
    joints = {
        "N": force * np.array([12.0, 3.0, 1e-9, 0.0]),
        "eccentricity": np.array([-0.1, 0.05, 0.3, np.nan]),  # a joint of rounding is pressed beyond its edge
        "length": np.array([0.5, 0.4, 0.6, 0.6]), "body_a": np.array([0, 1, 0, 0]), "body_b": np.array([1, 2, 2, 1]),
        "open_share": np.array([0.3, 0.0, 0.9, 1e-4]), "slipping": np.array([False, True, False, True]),
    }  # fmt: skip
    found = SimpleNamespace(
        solved=True, status=concio.Status.SOLVED, joints=SimpleNamespace(**(joints | changed)),
        ties=SimpleNamespace(tension=force * np.array([2.0, 30.0, 5.0])),
        contacts=SimpleNamespace(states=SimpleNamespace(code=np.array([3, 1, 3, 0, 3, 2]))),
        assembly=SimpleNamespace(pairs=SimpleNamespace(interface=np.array([0, 0, 1, 1, -1, -1]))),  # soil has none
    )  # fmt: skip
    model = SimpleNamespace(
        bodies=[SimpleNamespace(thickness=t) for t in (2.0, 1.5, 4.0)],
        ties=[SimpleNamespace(kind=k) for k in ("soil", "bar", "soil")],
    )
    monkeypatch.setattr(service, "with_settlement", lambda model, settled: model)
    monkeypatch.setattr(service, "solve", lambda model, on_failure: found)
    monkeypatch.setattr(service, "_deflection", lambda model, found: 0.25)
    return service_state(model)


@pytest.mark.parametrize("force", [1e-6, 1.0, 1e6])
def test_pressure_is_that_of_the_loaded_part_of_the_narrower_body(monkeypatch, force) -> None:
    """12 kN on 2 (0.25 - 0.1) x 1.5 m; 3 kN on 2 (0.2 - 0.05) x 1.5 m. Rounding presses nothing."""
    found = told(monkeypatch, force)
    assert found.largest_pressure == pytest.approx(force * 12.0 / (0.3 * 1.5))
    assert (found.open_joints, found.slipping, found.crushed) == (2, 2, 2)
    assert found.soil == pytest.approx(7.0 * force)
    assert found.deflection == 0.25


def test_a_joint_that_is_pressed_at_its_edge_alone_has_no_finite_pressure(monkeypatch: pytest.MonkeyPatch) -> None:
    """The loaded part of the second is 0.9 per cent of its length, or 1.1."""
    for share, finite in ((0.009, False), (0.011, True)):
        e = 0.5 * 0.4 * (1 - share)
        found = told(monkeypatch, eccentricity=np.array([-0.1, -e, 0.3, np.nan]))
        assert math.isfinite(found.largest_pressure) == finite
        if finite:
            assert found.largest_pressure == pytest.approx(3.0 / (share * 0.4 * 1.5), rel=1e-9)
