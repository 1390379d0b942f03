"""What a method is: its name, what it can treat, where its ``solve`` is; and :func:`register`, by which all come in."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from concio.arguments import closest, options_of, refuse_unknown
from concio.errors import MethodError
from concio.problem.apart import solve_apart
from concio.problem.contact_problem import ContactProblem
from concio.problem.parts import Part
from concio.problem.solution import ProgressCallback, Solution, Solver

LAWS = ("friction", "cohesion", "tension", "dilatancy", "cap", "stiffness")
"""Joint laws a method may or may not treat; stiffness stands for joints that give way elastically."""

GIVEN = ("start", "start_states")
"""Options that hold arrays of the whole problem, which is then solved as one."""

SPACES = {2: "plane problems", 3: "problems in space"}
"""Words for dimensions."""


@dataclass(frozen=True)
class Method:
    """A method, and what it can treat. Called like the ``solve`` of its module, it refuses what it cannot.

    Parameters
    ----------
    name : str
    modules : mapping of int to str or callable
        For each dimension it treats, the module that holds ``solve``, or the function itself.
    laws : frozenset of str
        Joint laws it treats, of :data:`LAWS`.
    """

    name: str
    modules: Mapping[int, str | Solver]
    laws: frozenset[str] = frozenset(LAWS)

    def __call__(
        self, problem: ContactProblem, *, progress: ProgressCallback | None = None, **options: Any
    ) -> Solution:
        """Solve one load step, each connected part of the structure by itself (:mod:`concio.problem.apart`).

        Raises
        ------
        MethodError
            The method does not treat problems of this dimension or with these joint laws, or an option is for another
            dimension.
        """
        self.check(problem)
        solver = self.solver(problem.dim)
        for option in options:
            if option in self.options and option not in options_of(solver):
                msg = f"method '{self.name}' has no option '{option}' for {SPACES[problem.dim]}"
                raise MethodError(msg, hint="one of: " + ", ".join(o for o in options_of(solver) if o != "progress"))

        def of_part(part: Part) -> Solution:
            if problem.pairs and not part.problem.pairs:  # K u = f, or a body that nothing holds
                linear = METHODS["sparse-lemke" if problem.dim == 2 else "auto"].solver(problem.dim)
                return linear(part.problem, progress=progress)
            return self._checked(solver(part.problem, progress=progress, **options))

        if any(options.get(name) is not None for name in GIVEN):
            return self._checked(solver(problem, progress=progress, **options))
        return solve_apart(problem, of_part)

    def _checked(self, found: object) -> Solution:
        if not isinstance(found, Solution):
            msg = f"method '{self.name}' returned {type(found).__name__} instead of a Solution"
            raise MethodError(msg, hint="return what judge(...) or failed(...) gives")
        return found

    @property
    def dimensions(self) -> tuple[int, ...]:
        """Dimensions it treats."""
        return tuple(sorted(self.modules))

    def solver(self, dim: int) -> Solver:
        """Return the function for problems of dimension ``dim``."""
        found = self.modules[dim]
        return _function(found) if isinstance(found, str) else found

    @property
    def options(self) -> tuple[str, ...]:
        """Names of its options, of all dimensions."""
        named = (option for dim in self.dimensions for option in options_of(self.solver(dim)))
        return tuple(dict.fromkeys(option for option in named if option != "progress"))

    @property
    def __signature__(self) -> inspect.Signature:
        """What a call takes: the options of all dimensions."""
        parameters: dict[str, inspect.Parameter] = {}
        for dim in self.dimensions:
            parameters |= inspect.signature(self.solver(dim)).parameters
        return inspect.Signature(sorted(parameters.values(), key=lambda p: p.kind))

    def check(self, problem: ContactProblem) -> None:
        """Refuse a problem that the method does not treat.

        Raises
        ------
        MethodError
        """
        if not problem.pairs:
            return
        if problem.dim not in self.modules:
            msg = f"method '{self.name}' does not treat {SPACES[problem.dim]}"
            raise MethodError(msg, hint="take one of: " + ", ".join(names_for(problem)))
        foreign = [law for law in laws_of(problem) if law not in self.laws]
        if foreign:
            msg = f"method '{self.name}' does not treat {' and '.join(foreign)}"
            raise MethodError(msg, hint="take one of: " + ", ".join(names_for(problem)))


def laws_of(problem: ContactProblem) -> tuple[str, ...]:
    """Return the joint laws, of :data:`LAWS`, that a problem has."""
    law = problem.laws
    there = {
        "friction": law.friction.any(),
        "cohesion": law.cohesion.any(),
        "tension": law.tension.any(),
        "dilatancy": law.dilatancy.any(),
        "cap": np.isfinite(law.cap).any(),
        "stiffness": law.normal_compliance.any() or law.tangential_compliance.any(),
    }
    return tuple(name for name in LAWS if there[name])


METHODS: dict[str, Method] = {}
"""The methods by name, as :func:`register` has taken them in; ours are in :mod:`concio.solvers.methods`."""


def names_for(problem: ContactProblem) -> tuple[str, ...]:
    """Return the names of the methods that treat a problem of this dimension with these joint laws."""
    laws = set(laws_of(problem))
    return tuple(name for name, method in METHODS.items() if problem.dim in method.modules and laws <= method.laws)


def find(name: str) -> Method:
    """Return the method called ``name``.

    Raises
    ------
    MethodError
        There is no method of that name.
    """
    if name not in METHODS:
        msg = f"unknown method '{name}'"
        raise MethodError(msg, hint=closest(name, METHODS, names="one of"))
    return METHODS[name]


def register(
    name: str,
    solver: str | Solver | Mapping[int, str | Solver],
    *,
    dimensions: Iterable[int] = (2,),
    laws: Iterable[str] = ("friction",),
    load: bool = True,
) -> Method:
    """Add a method of one's own: ``concio.solve(model, name)``, the command line and ``compare`` then know it.

    Parameters
    ----------
    name : str
        One that no method has yet.
    solver : str, callable or mapping of int to either
        The function, or the name of a module with a function ``solve``:
        ``solve(problem, *, progress=None, option=...) -> Solution``, see :func:`concio.problem.solution.judge`.
        A mapping says it for each dimension.
    dimensions : iterable of int
        2, 3, or both: problems of other dimensions are refused before the method sees them.
    laws : iterable of str
        Joint laws it treats, of :data:`LAWS`; others are refused likewise.
    load : bool
        Import modules now and tell what is wrong with them; otherwise when the method is first asked for something.

    Returns
    -------
    Method

    Raises
    ------
    MethodError
        The name is taken, the module cannot be imported or has no ``solve``, or a dimension or joint law is unknown.
    """
    if name in METHODS:
        msg = f"there is a method '{name}' already"
        raise MethodError(msg, hint="choose another name, or take the other out: del METHODS[name]")
    treated = frozenset(laws)
    unknown = sorted(treated - set(LAWS))
    if unknown:
        msg = f"unknown joint law '{unknown[0]}'"
        raise MethodError(msg, hint=closest(unknown[0], LAWS, names="one of"))
    dims = tuple(dimensions)
    if not dims or any(dim not in SPACES for dim in dims):
        msg = f"a method treats dimension 2, 3 or both, not {dims}"
        raise MethodError(msg)
    modules = dict(solver) if isinstance(solver, Mapping) else dict.fromkeys(dims, solver)
    method = Method(name, modules, treated)
    for dim in dims if load else ():
        if "progress" not in options_of(method.solver(dim)):
            msg = f"method '{name}' does not take progress"
            raise MethodError(msg, hint="def solve(problem, *, progress=None, option=...)")
    METHODS[name] = method
    return method


def _function(module: str) -> Solver:
    try:
        solver: Callable[..., Any] | None = getattr(import_module(module), "solve", None)
    except ImportError as error:
        msg = f"module '{module}' cannot be imported: {error}"
        raise MethodError(msg, hint="it must lie where Python looks for modules (PYTHONPATH)") from error
    if not callable(solver):
        msg = f"module '{module}' has no function 'solve'"
        raise MethodError(msg, hint="def solve(problem, *, progress=None, option=...)")
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
    refuse_unknown(options, (*others, *find(name).options), function)
