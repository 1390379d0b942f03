"""The methods by name. A method is a module with a function ``solve(problem, *, progress=None, **options)``."""

from __future__ import annotations

from importlib import import_module

from concio.errors import MethodError
from concio.lcp.solution import Solver

METHODS: dict[str, str] = {
    "auto": "concio.lcp.auto",
    "interior-point": "concio.lcp.engine",
    "lemke": "concio.lcp.lemke",
    "sparse-lemke": "concio.lcp.sparse_lemke",
    "exhaustive": "concio.lcp.exhaustive",
    "klarbring": "concio.lcp.klarbring",
    "ercolano": "concio.lcp.ercolano",
    "lee": "concio.lcp.lee",
    "del-piero": "concio.lcp.del_piero",
    "penalty": "concio.lcp.penalty",
    "alart-curnier": "concio.lcp.alart_curnier",
    "simo-laursen": "concio.lcp.simo_laursen",
    "de-saxce": "concio.lcp.de_saxce",
    "panagiotopoulos": "concio.lcp.panagiotopoulos",
    "lagrange": "concio.lcp.lagrange",
    "uzawa": "concio.lcp.uzawa",
    "gauss-seidel": "concio.lcp.gauss_seidel",
    "admm": "concio.lcp.admm",
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
        raise MethodError(msg, hint="one of: " + ", ".join(METHODS))
    solver: Solver = import_module(METHODS[name]).solve
    return solver
