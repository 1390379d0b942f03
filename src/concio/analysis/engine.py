"""What all analyses of a model have in common: the engine that it names, and the verdict of exceptions."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any, ParamSpec, TypeVar

from concio.model.model import Model
from concio.solvers.algebra.sparse_factor import Engine, factorised_by
from concio.verdict.unanswered import with_a_verdict

P = ParamSpec("P")
T = TypeVar("T")


def by_its_engine(function: Callable[P, T]) -> Callable[P, T]:
    """Return a function of a model, or of its assembly, that solves everything by the engine the model names.

    Its exceptions carry a verdict: what was asked, what acts, and what is odd about the model.
    """

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> T:
        with factorised_by(engine_of(args, kwargs)), with_a_verdict(first_of(args, kwargs), function.__name__):
            return function(*args, **kwargs)

    return run


def step_by_step(function: Callable[P, Iterator[T]]) -> Callable[P, Iterator[T]]:
    """Return :func:`by_its_engine` of a generator; between two of its answers the engine is what it was."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> Iterator[T]:
        answers, engine, first = function(*args, **kwargs), engine_of(args, kwargs), first_of(args, kwargs)
        while True:
            with factorised_by(engine), with_a_verdict(first, function.__name__):
                try:
                    answer = next(answers)
                except StopIteration:
                    return
            yield answer

    return run


def first_of(args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    """Return the first argument: a model, or what is made of one; None where there is none."""
    return args[0] if args else next((kwargs[name] for name in ("model", "cell", "wall") if name in kwargs), None)


def engine_of(args: tuple[Any, ...], kwargs: dict[str, Any]) -> Engine | None:
    """Return the engine named by the first argument: a model, or what is made of one; None where it is neither."""
    first = first_of(args, kwargs)
    model = first if isinstance(first, Model) else getattr(first, "model", None)
    return model.engine if isinstance(model, Model) else None
