"""What follows from the matrices of a structure alone is computed once, and kept while these matrices live.

Paths, motions and diagnoses build many problems that share their matrices and differ in loads, gaps and slip origins.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

Found = TypeVar("Found")

KEPT = 8
"""Answers of a function that are kept at a time; one whose arguments are gone is not kept."""


def once(function: Callable[..., Found]) -> Callable[..., Found]:
    """Return a function of arrays and matrices that keeps its last answers: the same objects have the same answer.

    Objects are compared by identity, so that nothing is read to find an answer. Their entries must not be changed
    in place between two calls; the matrices of problems never are.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.problem.once import once
    >>> calls = []
    >>> total = once(lambda a: calls.append(1) or float(a.sum()))
    >>> a = np.ones(3)
    >>> total(a), total(a), len(calls)
    (3.0, 3.0, 1)
    """
    kept: list[tuple[tuple[weakref.ref[Any], ...], Found]] = []

    def gone(_: weakref.ref[Any]) -> None:
        kept[:] = [entry for entry in kept if all(r() is not None for r in entry[0])]

    @wraps(function)
    def answered(*arrays: Any) -> Found:
        for references, answer in tuple(kept):
            if len(references) == len(arrays) and all(r() is a for r, a in zip(references, arrays, strict=True)):
                return answer
        answer = function(*arrays)
        kept.append((tuple(weakref.ref(a, gone) for a in arrays), answer))
        del kept[:-KEPT]
        return answer

    return answered
