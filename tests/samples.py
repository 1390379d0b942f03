"""How many cases a test draws: few in the quick suite, more where long tests run, all where they are asked for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

import pytest

T = TypeVar("T")

QUICK, WHOLE, EVERY = 0, 1, 2

level = EVERY
"""What ``conftest`` sets: QUICK where ``-m "not long"`` leaves the long tests out, EVERY for ``CONCIO_CASES=all``."""


def sample(few: T, some: T, every: T | None = None) -> T:
    """Return the number of cases to draw, or the cases themselves.

    ``few`` are drawn in the quick suite, ``some`` in the whole one, ``every`` one, or ``some`` where there is no third
    number, by ``make test-ensembles``.
    """
    if level == EVERY and every is not None:
        return every
    return few if level == QUICK else some


def first(count: int, cases: Iterable[Any], *, single: bool = False) -> list[Any]:
    """Return the cases of a parametrised test, of which the quick suite runs the first ones: all others are long.

    A tuple holds the values of several arguments, or is the value of a single one.
    """
    given = [_as_given(case, single) for case in cases]
    rest = [pytest.param(*c.values, id=c.id, marks=[*c.marks, pytest.mark.long]) for c in given[count:]]
    return given[:count] + rest


def _as_given(case: Any, single: bool) -> Any:
    if isinstance(case, type(pytest.param())):
        return case
    return pytest.param(*case) if isinstance(case, tuple) and not single else pytest.param(case)
