"""The methods by name: modules with a function ``solve(problem, *, progress=None, ...)`` and its options."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module

from concio.arguments import closest, options_of, refuse_unknown
from concio.errors import MethodError
from concio.problem.solution import Solver

METHODS: dict[str, str] = {
    "auto": "concio.solvers.auto.chain",
    "interior-point": "concio.solvers.interior.engine",
    "lemke": "concio.solvers.forms.lemke",
    "sparse-lemke": "concio.solvers.pivoting.sparse_lemke",
    "exhaustive": "concio.solvers.exhaustive.search",
    "klarbring": "concio.solvers.forms.klarbring",
    "ercolano": "concio.solvers.forms.ercolano",
    "lee": "concio.solvers.forms.lee",
    "del-piero": "concio.solvers.forms.del_piero",
    "penalty": "concio.solvers.iterative.penalty",
    "alart-curnier": "concio.solvers.iterative.alart_curnier",
    "simo-laursen": "concio.solvers.iterative.simo_laursen",
    "de-saxce": "concio.solvers.iterative.de_saxce",
    "panagiotopoulos": "concio.solvers.iterative.panagiotopoulos",
    "lagrange": "concio.solvers.iterative.lagrange",
    "uzawa": "concio.solvers.iterative.uzawa",
    "gauss-seidel": "concio.solvers.iterative.gauss_seidel",
    "admm": "concio.solvers.iterative.admm",
}
"""Name of each method and the module that holds its ``solve``."""


def find(name: str) -> Solver:
    """Return the solver called ``name``.

    Raises
    ------
    MethodError
        There is no method of that name.
    """
    if name not in METHODS:
        msg = f"unknown method '{name}'"
        raise MethodError(msg, hint=closest(name, METHODS, names="one of"))
    solver: Solver = import_module(METHODS[name]).solve
    return solver


def check_options(name: str, options: Iterable[str], *, function: str, others: tuple[str, ...] = ()) -> None:
    """Refuse options that a method does not have.

    Parameters
    ----------
    name : str
        The method.
    options : iterable of str
        Names of the options given.
    function : str
        The function that was called with them, for the message.
    others : tuple of str
        Arguments of that function itself, which may have been meant.

    Raises
    ------
    ArgumentError
        An option is not known.
    MethodError
        There is no method of that name.
    """
    own = tuple(option for option in options_of(find(name)) if option != "progress")
    refuse_unknown(options, (*others, *own), function)
