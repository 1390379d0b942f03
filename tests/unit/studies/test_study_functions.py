"""Functions of studies are told by their code and by what they hold, so that rows of two are not mixed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.studies.functions import function_text


class Scaled:
    """A function with a number of its own."""

    def __init__(self, by: float) -> None:
        self.by = by

    def __call__(self, values: dict[str, float]) -> float:
        """Return a number times its own."""
        return self.by * values["a"]

    def method(self, values: dict[str, float]) -> float:
        return self.by * values["a"]


def scaled(by: float, values: dict[str, float]) -> float:
    return by * values["a"]


def within(by: object) -> Callable[[dict[str, float]], float]:
    return lambda values: float(np.sum(by)) * values["a"]


def by_default(by: float) -> Callable[[dict[str, float]], float]:
    return lambda values, *, by=by: by * values["a"]


MADE: dict[str, Callable[[float], Callable[[dict[str, float]], float]]] = {
    "partial": lambda by: partial(scaled, by),
    "object": Scaled,
    "method": lambda by: Scaled(by).method,
    "within": within,
    "within, an array": lambda by: within(np.full(2000, by)),
    "within, an object": lambda by: within(Scaled(by).method),
    "default": by_default,
    "partial of a partial": lambda by: partial(partial(Scaled(by)), seed=Scaled(1.0)),
}


@pytest.mark.parametrize("kind", MADE)
def test_functions_that_hold_other_values_are_other_functions(kind: str) -> None:
    """Rows of both were mixed: a partial was "partial", whatever it held."""
    make = MADE[kind]
    assert function_text(make(2.0)) == function_text(make(2.0))
    assert " at 0x" not in function_text(make(2.0))
    assert function_text(make(2.0)) != function_text(make(3.0))


def test_a_study_of_another_partial_is_not_resumed(tmp_path: Path) -> None:
    variables = {"a": {"low": 1.0, "high": 2.0}}
    for by in (2.0, 2.0):
        concio.study(partial(scaled, by), variables, "m", size=2, directory=tmp_path, resume=tmp_path.joinpath(
            "study.json").exists())  # fmt: skip
    with pytest.raises(concio.InputError, match="another study: source differs"):
        concio.study(partial(scaled, 3.0), variables, "m", size=2, directory=tmp_path, resume=True)


def test_functions_that_hold_themselves_are_told() -> None:
    def around(n: int) -> int:
        return around(n - 1) if n else 0

    own = Scaled(1.0)
    own.by = own.method  # type: ignore[assignment]
    assert "itself" in function_text(around)
    assert "itself" in function_text(own)
