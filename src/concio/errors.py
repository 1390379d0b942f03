"""Exceptions of concio: one base class, and messages that say what, where and what to do."""

from __future__ import annotations

from typing import Any, Protocol


class Told(Protocol):
    """A verdict: :class:`concio.Verdict`."""

    @property
    def exit_code(self) -> int:
        """Exit code of a command that ends with it."""

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain types."""


class ConcioError(Exception):
    """Base of every exception concio raises on purpose.

    Parameters
    ----------
    what : str
        What was found, with the number or the word that is wrong.
    where : str, optional
        The place: file and key, block or joint by name.
    hint : str, optional
        What to do about it.
    verdict : Verdict, optional
        The question that was asked and what was found of it.

    Examples
    --------
    A mistake in a model, and an arch that is too thin to stand:

    >>> import concio
    >>> try:
    ...     concio.column(width=-0.5, height=2.0, blocks=4)
    ... except concio.ConcioError as error:
    ...     print(error)
    column: width = -0.5 must be positive and finite
    >>> try:
    ...     concio.solve(concio.arch(span=1.9, ring=0.1, voussoirs=9, block="rigid"))
    ... except concio.NoEquilibriumError as error:
    ...     print(error.exit_code, error.verdict.outcome.name)
    3 FAILS
    """

    exit_code = 1

    def __init__(
        self, what: str, *, where: str | None = None, hint: str | None = None, verdict: Told | None = None
    ) -> None:
        self.what, self.where, self.hint, self.verdict = what, where, hint, verdict
        text = f"{where}: {what}" if where else what
        if hint:
            text += f" ({hint})"
        super().__init__(text)


class InputError(ConcioError):
    """The model, a file or an option is not usable as given (exit code 2)."""

    exit_code = 2


class ArgumentError(InputError, TypeError):
    """A function was called with an argument it does not know, or without one it needs (exit code 2)."""


class GeometryError(InputError):
    """A polygon, a drawing or the arrangement of blocks is not usable (exit code 2)."""


class NoEquilibriumError(ConcioError):
    """The loads are not carried, and that is proven (exit code 3)."""

    exit_code = 3


class SolverError(ConcioError):
    """The solver stopped without an answer and without a proof that there is none (exit code 4)."""

    exit_code = 4


class MethodError(InputError):
    """The method named does not apply to this problem, or there is no method of that name (exit code 2)."""
