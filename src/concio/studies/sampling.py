"""Samples: the table of values that is made before anything runs, and then no longer changes.

Designs: ``grid`` (every combination of levels), ``monte-carlo``, ``latin-hypercube``, ``sobol`` (scrambled points of a
Sobol sequence), ``saltelli`` (the design of Sobol indices, by SALib) and ``one-at-a-time`` (the median, and each
variable alone at its 5 and 95 per cent quantiles). Correlation is that of ranks (Spearman), brought in by a Gaussian
copula: two normal variables with correlation r have rank correlation (6/pi) asin(r/2).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import prod
from typing import Any

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.representation import short_repr
from concio.studies.variables import Variable

Array = np.ndarray
Correlation = Mapping[tuple[str, str], float] | Sequence[Sequence[float]] | Array

DESIGNS = ("monte-carlo", "latin-hypercube", "sobol", "saltelli", "grid", "one-at-a-time")
MOST = 1_000_000
"""More runs than these are not plausible for one wall."""


@short_repr
@dataclass(frozen=True, eq=False)
class Sample:
    """The values of all variables in all runs.

    Parameters
    ----------
    variables : tuple of Variable
    numbers : (n, k) array
        One row a run; of a choice the index of its value.
    design : str
        One of :data:`DESIGNS`, or "given".
    seed : int
        What random numbers began with.
    seeds : (n,) integers
        A seed of its own for each run, from ``numpy.random.SeedSequence(seed).spawn``.
    correlated : bool
        Whether variables were drawn with a correlation.
    """

    variables: tuple[Variable, ...]
    numbers: Array
    design: str
    seed: int
    seeds: Array
    correlated: bool = False

    def __len__(self) -> int:
        return len(self.numbers)

    def row(self, index: int) -> dict[str, Any]:
        """Return the values of one run by name, choices as what they stand for."""
        return {v.name: v.value(x) for v, x in zip(self.variables, self.numbers[index], strict=True)}

    def column(self, name: str) -> Array:
        """Return the numbers (n,) of one variable.

        Raises
        ------
        InputError
            There is no such variable.
        """
        names = [v.name for v in self.variables]
        if name not in names:
            msg = f"there is no variable '{name}'"
            raise InputError(msg, hint=closest(name, names))
        column: Array = self.numbers[:, names.index(name)]
        return column


def draw(
    variables: Sequence[Variable],
    design: str = "latin-hypercube",
    size: int | None = None,
    *,
    seed: int = 0,
    correlation: Correlation | None = None,
) -> Sample:
    """Return a sample.

    Parameters
    ----------
    variables : sequence of Variable
    design : str
        One of :data:`DESIGNS`.
    size : int, optional
        Number of runs, 100 by default; of a ``saltelli`` design the base number n, which makes n (k + 2) runs. Grids
        and ``one-at-a-time`` follow from their variables.
    seed : int
    correlation : mapping of pairs of names to float, or (k, k) array, optional
        Rank correlation of variables, for random designs; as a matrix in their order.

    Raises
    ------
    InputError
        Unknown design, size that does not fit it, or correlations that cannot be together.
    """
    variables = tuple(variables)
    check_variables(variables)
    if design not in DESIGNS:
        msg = f"there is no sample '{design}'"
        raise InputError(msg, hint=closest(design, list(DESIGNS)))
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        msg = f"seed = {seed!r} must be a whole number, zero or positive"
        raise InputError(msg)
    pairs = correlations(variables, correlation)
    if design in ("grid", "one-at-a-time"):
        if size is not None:
            msg = f"the size of a {design} sample follows from its variables"
            raise InputError(msg, hint="leave size out; set levels or values of the variables")
        if pairs:
            msg = f"a {design} sample has no correlation"
            raise InputError(msg, hint="take monte-carlo, latin-hypercube or sobol")
        table = _grid(variables) if design == "grid" else _one_at_a_time(variables)
        return given_sample(variables, table, design, seed)
    size = 100 if size is None else size
    if isinstance(size, bool) or not isinstance(size, int) or not 1 <= size <= MOST:
        msg = f"size = {size!r} must be a whole number from 1 to {MOST:,}"
        raise InputError(msg)
    u = _shares(len(variables), design, size, seed)
    if pairs:
        if design == "saltelli":
            msg = "Sobol indices are those of independent variables"
            raise InputError(msg, hint="leave the correlation out, or take another sample")
        u = _correlated(u, variables, pairs)
    numbers = np.column_stack([v.quantile(u[:, j]) for j, v in enumerate(variables)])
    return replace(given_sample(variables, numbers, design, seed), correlated=bool(pairs))


def given_sample(variables: Sequence[Variable], numbers: Array, design: str = "given", seed: int = 0) -> Sample:
    """Return a sample of numbers (n, k) made elsewhere.

    Raises
    ------
    InputError
        The table has another number of columns than there are variables, no rows, or numbers that are not finite.
    """
    variables = tuple(variables)
    check_variables(variables)
    table = np.atleast_2d(np.asarray(numbers, dtype=float))
    if table.ndim != 2 or table.shape[1] != len(variables) or not len(table):
        msg = f"a sample of {len(variables)} variables has as many columns, not the shape {np.shape(numbers)}"
        raise InputError(msg)
    if not np.isfinite(table).all():
        row, column = np.argwhere(~np.isfinite(table))[0]
        msg = f"row {row + 1} of the sample has no finite number for '{variables[column].name}'"
        raise InputError(msg)
    if len(table) > MOST:
        msg = f"the sample has {len(table):,} rows, more than {MOST:,}"
        raise InputError(msg)
    for j, v in enumerate(variables):
        whole = table[:, j] == np.floor(table[:, j])
        if v.distribution == "choice" and not (whole & (table[:, j] >= 0) & (table[:, j] < len(v.values))).all():
            msg = f"'{v.name}' is a choice of {len(v.values)}; its column holds other numbers"
            raise InputError(msg)
    children = np.random.SeedSequence(seed).spawn(len(table))
    seeds = np.array([child.generate_state(1)[0] for child in children], dtype=np.int64)
    table.setflags(write=False)
    return Sample(variables, table, design, seed, seeds)


def check_variables(variables: Sequence[Variable]) -> None:
    """Raise where there are no variables, or two of one name."""
    if not variables:
        msg = "a study needs variables"
        raise InputError(msg, hint='for example concio.studies.variable("mu", low=0.3, high=0.7, keys="wall.friction")')
    names = [v.name for v in variables]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        msg = f"two variables are called '{twice}'"
        raise InputError(msg)


def _shares(k: int, design: str, size: int, seed: int) -> Array:
    """Return the design in the unit cube (n, k)."""
    from scipy.stats import qmc

    rng = np.random.default_rng(seed)
    if design == "monte-carlo":
        return rng.random((size, k))
    if design == "latin-hypercube":
        table: Array = qmc.LatinHypercube(k, rng=rng).random(size)
        return table
    if size & (size - 1):
        near = 1 << max(size.bit_length() - 1, 0), 1 << size.bit_length()
        msg = f"a {design} sample keeps its balance in powers of two only, not in {size}"
        raise InputError(msg, hint=f"take {near[0]} or {near[1]}")
    if design == "sobol":
        points: Array = qmc.Sobol(k, rng=rng).random(size)
        return points
    try:
        from SALib.sample import sobol
    except ImportError:
        msg = "the sample of Sobol indices needs the package SALib"
        raise InputError(msg, hint="pip install 'concio[study]'") from None
    problem = {"num_vars": k, "names": [str(j) for j in range(k)], "bounds": [[0.0, 1.0]] * k}
    cube: Array = sobol.sample(problem, size, calc_second_order=False, seed=seed)
    return cube


def correlations(variables: Sequence[Variable], given: Correlation | None) -> dict[tuple[str, str], float]:
    """Return rank correlations by pairs of names, from such a mapping or from a matrix in the order of the variables.

    Raises
    ------
    InputError
        It is neither; or the matrix has another size, is not symmetric, or has no ones on its diagonal.
    """
    if given is None:
        return {}
    names, hint = [v.name for v in variables], 'for example {("mu", "E"): 0.5}, or a matrix in their order'
    if isinstance(given, Mapping):
        pairs: Mapping[Any, float] = given
        for pair in pairs:
            if not (isinstance(pair, tuple) and len(pair) == 2):
                msg = f"correlation: {pair!r} is not a pair of variables"
                raise InputError(msg, hint=hint)
        found = {(str(a), str(b)): float(value) for (a, b), value in given.items()}
        for (a, b), value in found.items():
            if found.get((b, a), value) != value:
                msg = f"correlation of '{a}' and '{b}' is {value:g}, and of '{b}' and '{a}' {found[b, a]:g}"
                raise InputError(msg, hint="state each pair once")
        return found
    try:
        matrix = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        msg = f"correlation: {type(given).__name__} is not a mapping of pairs, and no matrix of numbers"
        raise InputError(msg, hint=hint) from None
    if matrix.shape != (len(names), len(names)):
        k = len(names)
        msg = f"correlation: a matrix of {k} variables has the shape {(k, k)}, not {matrix.shape}"
        raise InputError(msg, hint="its rows follow " + ", ".join(names))
    if not np.isfinite(matrix).all() or not np.allclose(matrix, matrix.T) or not np.allclose(np.diag(matrix), 1.0):
        msg = "correlation: the matrix must be finite and symmetric, with ones on its diagonal"
        raise InputError(msg, hint="its rows follow " + ", ".join(names))
    return {
        (names[i], names[j]): float(matrix[i, j]) for i in range(len(names)) for j in range(i) if matrix[i, j] != 0.0
    }


def _correlated(u: Array, variables: Sequence[Variable], correlation: Mapping[tuple[str, str], float]) -> Array:
    from scipy.stats import norm

    names = [v.name for v in variables]
    matrix = np.eye(len(names))
    for (a, b), value in correlation.items():
        for name in (a, b):
            if name not in names:
                msg = f"correlation: there is no variable '{name}'"
                raise InputError(msg, hint=closest(name, names))
        if a == b or not -1 < value < 1:
            msg = f"correlation of '{a}' and '{b}': {value!r} must lie between -1 and 1, for two different variables"
            raise InputError(msg)
        i, j = names.index(a), names.index(b)
        matrix[i, j] = matrix[j, i] = 2.0 * np.sin(np.pi * value / 6.0)
    try:
        lower = np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        msg = "these correlations cannot hold together: their matrix is not positive definite"
        raise InputError(msg, hint="make them smaller") from None
    tiny = np.finfo(float).tiny
    shares: Array = norm.cdf(norm.ppf(np.clip(u, tiny, 1.0 - 1e-16)) @ lower.T)
    return shares


def _grid(variables: Sequence[Variable]) -> Array:
    levels = [v.grid() for v in variables]
    runs = prod(len(level) for level in levels)
    if runs > MOST:
        msg = f"the grid has {runs:,} points, more than {MOST:,}"
        raise InputError(msg, hint="take fewer levels, or a sample such as latin-hypercube")
    return np.array(list(product(*levels)))


def _one_at_a_time(variables: Sequence[Variable]) -> Array:
    if any(not v.numeric for v in variables):
        msg = "one-at-a-time takes numbers, not choices of words"
        raise InputError(msg)
    low, middle, high = (np.array([v.quantile(np.array([u]))[0] for v in variables]) for u in (0.05, 0.5, 0.95))
    rows = [middle]
    for j in range(len(variables)):
        for end in (low, high):
            row = middle.copy()
            row[j] = end[j]
            rows.append(row)
    return np.array(rows)
