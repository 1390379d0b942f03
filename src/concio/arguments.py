"""Arguments of public functions: what a function does not know it refuses, and says what was probably meant.

Python refuses an unknown keyword by itself unless a function passes its keywords on; then a misspelt one must not be
lost on the way. :func:`strict` makes either case the same error with the same words.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

import numpy as np

from concio.argument_types import Check, checker, told
from concio.errors import ArgumentError, ConcioError
from concio.synonyms import meant

P = ParamSpec("P")
T = TypeVar("T")

CLOSE = 0.6
"""Similarity (of :mod:`difflib`) from which on a word is taken for another one misspelt."""


def closest(word: str, known: Iterable[str], *, names: str = "known", otherwise: str = "") -> str:
    """Return a hint that names the word that was probably meant, or all that are known.

    Another word for a known one (:mod:`concio.synonyms`) comes before one that is only spelt alike.

    Parameters
    ----------
    word : str
    known : iterable of str
    names : str
        What stands before the list of all that are known.
    otherwise : str
        What to say in place of that list, where it would be long.
    """
    words = list(known)
    other = meant(word, words)
    if other is not None:
        return f"did you mean '{other}'?"
    folded = {w.casefold(): w for w in reversed(words)}
    near = difflib.get_close_matches(word.casefold(), list(folded), n=1, cutoff=CLOSE)
    if near:
        return f"did you mean '{folded[near[0]]}'?"
    return otherwise or f"{names}: {', '.join(words) or 'none'}"


def refuse_unknown(given: Iterable[str], known: Sequence[str], function: str) -> None:
    """Raise where a name is none of those that ``function`` (``"solve()"``, for the message) knows.

    Raises
    ------
    ArgumentError
        With the name that was probably meant.
    """
    for name in given:
        if name not in known:
            msg = f"{function} has no argument '{name}'"
            raise ArgumentError(msg, hint=closest(name, known))


def options_of(function: Callable[..., object]) -> tuple[str, ...]:
    """Return the names of the keyword-only arguments of a function: its options."""
    parameters = inspect.signature(function).parameters.values()
    return tuple(p.name for p in parameters if p.kind is inspect.Parameter.KEYWORD_ONLY)


def strict(function: Callable[P, T]) -> Callable[P, T]:
    """Return a function that refuses, in words, arguments it does not know and calls that leave one out.

    A function that passes further keywords on (``**options``) checks these itself.
    """
    return _strict(function, _Expected.of(function))


def strict_with(names: Iterable[str]) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Return :func:`strict` for functions whose further keywords (``**common``) have the ``names`` given."""
    also = tuple(names)

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        return _strict(function, _Expected.of(function, also=also))

    return decorate


def strict_class(cls: type[T]) -> type[T]:
    """Make the constructor of a class :func:`strict`; it keeps copies of dictionaries, lists and arrays.

    Where the constructor fails on arguments whose annotations do not say for sure what they may be, it says so.
    """
    made: Any = cls.__init__
    expected = _Expected.of(made, method_of=cls.__name__)

    @functools.wraps(made)
    def keeping(self: object, *args: object, **kwargs: object) -> None:
        try:
            made(self, *map(_own, args), **{name: _own(value) for name, value in kwargs.items()})
        except ConcioError:
            raise
        except (TypeError, ValueError, AttributeError) as error:
            expected.refuse(expected.doubtful((self, *args), kwargs), error)
            raise

    type.__setattr__(cls, "__init__", _strict(keeping, expected))
    return cls


def _own(value: object) -> object:
    """Return a copy of a dictionary, a list or an array, and everything else as it is."""
    if type(value) is list:
        return [_own(v) for v in value]
    if isinstance(value, np.ndarray) or type(value) is dict:
        return value.copy()
    return value


def _strict(function: Callable[P, T], expected: _Expected) -> Callable[P, T]:
    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> T:
        expected.check(args, kwargs)
        try:
            return function(*args, **kwargs)
        except ConcioError:
            raise
        except (TypeError, ValueError) as error:
            expected.refuse(expected.texts_for_numbers(args, kwargs), error)
            raise

    return run


def _hint(wanted: str, value: object) -> str | None:
    """Return how to write what was probably meant."""
    if wanted.startswith("a sequence of numbers") and isinstance(value, int | float):
        return f"write ({value!r},)"
    if wanted.startswith("a sequence of texts") and isinstance(value, str):
        return f"write ({value!r},)"
    if wanted == "a Result":
        return "solve the model first: concio.solve(model)"
    return None


@dataclass(frozen=True)
class _Expected:
    """What a function takes: names in order, those without a default with their places, whether it takes more."""

    name: str
    order: tuple[str, ...]
    types: Mapping[str, tuple[Check, str]]
    defaults: Mapping[str, object]
    known: tuple[str, ...]
    needed: tuple[tuple[str, float], ...]
    passes_on: bool
    own: int
    any_number: bool = False

    @classmethod
    def of(cls, function: Callable[..., object], *, also: tuple[str, ...] = (), method_of: str = "") -> _Expected:
        parameters = list(inspect.signature(function).parameters.values())
        own = 1 if method_of else 0  # self
        named = [p for p in parameters[own:] if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
        order = tuple(p.name for p in named if p.kind is p.POSITIONAL_OR_KEYWORD)
        needed = tuple(
            (p.name, float(order.index(p.name)) if p.name in order else math.inf) for p in named if p.default is p.empty
        )
        more = any(p.kind is p.VAR_KEYWORD for p in parameters) and not also
        any_number = any(p.kind is p.VAR_POSITIONAL for p in parameters)
        found = {p.name: checker(p.annotation) for p in named}
        types = {name: check for name, check in found.items() if check is not None}
        defaults = {p.name: p.default for p in named}
        known = (*defaults, *also)
        return cls(method_of or function.__name__, order, types, defaults, known, needed, more, own, any_number)

    def texts_for_numbers(self, by_place: Sequence[object], named: Mapping[str, object]) -> dict[str, object]:
        """Return the arguments that are texts where numbers are due: some functions read numbers with their units."""
        given = {**dict(zip(self.order, by_place[self.own :], strict=False)), **named}
        return {
            name: value for name, value in given.items()
            if isinstance(value, str) and name in self.types and "a number" in self.types[name][1]
        }  # fmt: skip

    def doubtful(self, by_place: Sequence[object], named: Mapping[str, object]) -> dict[str, object]:
        """Return these, or else arrays and what was not checked, as its annotation does not say for sure what it is."""
        given = {**dict(zip(self.order, by_place[self.own :], strict=False)), **named}
        return self.texts_for_numbers(by_place, named) or {
            name: value for name, value in given.items()
            if value is not self.defaults.get(name) and (name not in self.types or isinstance(value, np.ndarray))
        }  # fmt: skip

    def refuse(self, found: Mapping[str, object], error: Exception) -> None:
        """Raise where arguments were found that explain an error.

        Raises
        ------
        ArgumentError
            With their values.
        """
        if found:
            said = " or ".join(f"{name} = {told(value)}" for name, value in found.items())
            msg = f"{self.name}(): {said} cannot be used: {error}"
            raise ArgumentError(msg) from error

    def check(self, by_place: Sequence[object], named: Mapping[str, object]) -> None:
        """Raise where a call with arguments by place and others by name is not one the function takes."""
        given = len(by_place)
        if not self.passes_on:
            refuse_unknown(named, self.known, f"{self.name}()")
        given -= self.own
        for name, place in self.needed:
            if place >= given and name not in named:
                msg = f"{self.name}() needs the argument '{name}'"
                raise ArgumentError(msg, hint=f"its arguments: {', '.join(self.known)}")
        if given > len(self.order) and not self.any_number:
            msg = f"{self.name}() takes {len(self.order)} arguments by place, {given} were given"
            raise ArgumentError(msg, hint="give the others by name: " + ", ".join(self.known[len(self.order) :]))
        for name in self.order[:given]:
            if name in named:
                msg = f"{self.name}() was given '{name}' twice, by place and by name"
                raise ArgumentError(msg, hint="leave one of them out")
        for name, value in (*zip(self.order, by_place[self.own :], strict=False), *named.items()):
            check = self.types.get(name)
            if check is not None and value is not self.defaults[name] and not check[0](value):
                what = told(value)
                msg = f"{self.name}(): {name} = {what} must be {check[1]}"
                if what.startswith(("a ", "an ")):
                    msg = f"{self.name}(): {name} must be {check[1]}, not {what}"
                raise ArgumentError(msg, hint=_hint(check[1], value))
