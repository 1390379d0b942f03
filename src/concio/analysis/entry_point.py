"""What every analysis of a model does first: dense kernels work with one thread, and exceptions carry a verdict."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

from concio.errors import InputError
from concio.model.model import Model
from concio.solvers.algebra.threads import one_thread
from concio.verdict.unanswered import with_a_verdict

P = ParamSpec("P")
T = TypeVar("T")


def entry_point(function: Callable[P, T]) -> Callable[P, T]:
    """Return a function of a model, or of its assembly, whose exceptions carry a verdict.

    It says what was asked, what acts, and what is suspicious about the model.
    """

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> T:
        with _entered(function.__name__, args, kwargs):
            return function(*args, **kwargs)

    return run


def entry_point_in_stages(function: Callable[P, Iterator[T]]) -> Callable[P, Iterator[T]]:
    """Return :func:`entry_point` of a generator; between two of its answers the threads are what they were."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> Iterator[T]:
        answers = function(*args, **kwargs)
        while True:
            with _entered(function.__name__, args, kwargs):
                try:
                    answer = next(answers)
                except StopIteration:
                    return
            yield answer

    return run


@contextmanager
def _entered(name: str, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Iterator[None]:
    """Enter an analysis of the first argument: a model, or what is made of one."""
    first = args[0] if args else next((kwargs[name] for name in ("model", "cell", "wall") if name in kwargs), None)
    model = first if isinstance(first, Model) else getattr(first, "model", None)
    if isinstance(model, Model):
        _refuse_changes(model, name)
    with one_thread(), with_a_verdict(first, name):
        yield


def _refuse_changes(model: Model, name: str) -> None:
    """Refuse joint laws that change with what joints undergo: only a load step treats them."""
    for law, constants in model.laws.items():
        if constants.changes:
            msg = f"joint law '{law}' changes with what the joint undergoes; {name} takes laws as they are at first"
            raise InputError(msg, hint="concio.solve treats them; or give the law the constants it ends with")
