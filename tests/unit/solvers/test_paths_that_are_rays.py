"""A path is a ray from rest only where nothing in it has a size of its own: one entry is enough."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.solvers.path.ray import homogeneous

SIZED = {"cohesion": 1.0, "tension": 0.5, "cap": 10.0, "gap": -1e-9, "f": -2.0, "slip_origin": 1e-6}


def path(**entry: float) -> SimpleNamespace:
    """Return a path of four pairs and five unknowns in which one entry of some arrays is not that of rest."""
    values = {name: np.zeros(4) for name in SIZED} | {"cap": np.full(4, np.inf), "f": np.zeros(5)}
    values["slip_origin"] = np.zeros((4, 1))
    for name, value in entry.items():
        values[name][2] = value
    laws = SimpleNamespace(**{k: values.pop(k) for k in ("cohesion", "tension", "cap")})
    return SimpleNamespace(problem=SimpleNamespace(laws=laws, **values))


def test_nothing_of_its_own_size_is_a_ray() -> None:
    assert homogeneous(path())  # type: ignore[arg-type]


@pytest.mark.parametrize("name", SIZED)
def test_one_entry_is_enough(name: str) -> None:
    assert not homogeneous(path(**{name: SIZED[name]}))  # type: ignore[arg-type]
