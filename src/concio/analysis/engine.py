"""The engine that a model names, for all that is solved on the way to an answer."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any, ParamSpec, TypeVar

from concio.model.model import Model
from concio.solvers.algebra.sparse_factor import Engine, factorised_by

P = ParamSpec("P")
T = TypeVar("T")


def by_its_engine(function: Callable[P, T]) -> Callable[P, T]:
    """Return a function of a model, or of its assembly, that solves everything by the engine the model names."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> T:
        with factorised_by(engine_of(args, kwargs)):
            return function(*args, **kwargs)

    return run


def step_by_step(function: Callable[P, Iterator[T]]) -> Callable[P, Iterator[T]]:
    """Return :func:`by_its_engine` of a generator; between two of its answers the engine is what it was."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> Iterator[T]:
        answers, engine = function(*args, **kwargs), engine_of(args, kwargs)
        while True:
            with factorised_by(engine):
                try:
                    answer = next(answers)
                except StopIteration:
                    return
            yield answer

    return run


def engine_of(args: tuple[Any, ...], kwargs: dict[str, Any]) -> Engine | None:
    """Return the engine named by the first argument: a model, or what is made of one; None where it is neither."""
    first = args[0] if args else next((kwargs[name] for name in ("model", "cell") if name in kwargs), None)
    model = first if isinstance(first, Model) else getattr(first, "model", None)
    return model.engine if isinstance(model, Model) else None
