"""What rounding of places is granted in the laws of a motion: what double precision loses where the bodies are."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from concio.analysis.motion.certified import PLACES, RETURN, Certificate

THETA, BETA, SIZE = 0.7, 0.003, 4.0


def granted(far: float, h: float, *, springs: tuple[bool, ...] = (), held: int = 0, ties: int = 0) -> np.ndarray:
    """Return what three hard or elastic pairs, held points and ties of bodies ``far`` away are granted [m/s]."""
    joint = SimpleNamespace(gap=np.zeros(3), springs=None)
    if springs:
        normal = np.array(springs)
        joint.springs = SimpleNamespace(normal=normal, shear=np.zeros(3, dtype=bool))
    own: Any = SimpleNamespace(
        scheme=SimpleNamespace(theta=THETA, stiffness_damping=BETA), maker=SimpleNamespace(held=[0] * held),
        reference=SimpleNamespace(disc=SimpleNamespace(size=SIZE)),
    )  # fmt: skip
    centre = np.array([[0.3, -far], [0.1, 0.2]])
    found: np.ndarray = Certificate._rounding(own, centre, h, 3 + held + ties, joint)  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize("far", [0.3, 10.0, 1e6])
@pytest.mark.parametrize("h", [1e-4, 1e-2])
def test_it_grows_with_the_distance_from_the_origin_and_falls_with_the_step(far: float, h: float) -> None:
    place = PLACES * np.finfo(float).eps * (SIZE + far)
    hard, elastic = place * RETURN / h, place / (h * THETA**2 + BETA * THETA)
    assert granted(far, h) == pytest.approx([hard] * 3)
    assert granted(far, h, held=2) == pytest.approx([hard] * 5)
    assert granted(far, h, springs=(False, True, False)) == pytest.approx([hard, elastic, hard])
    assert granted(far, h, held=1, ties=2) == pytest.approx([*[hard] * 4, elastic, elastic])
