"""A wall whose blocks are made smaller at fixed outline: the way to its homogenised continuum."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.continuum.comparison import ContinuumComparison, compare_with_continuum
from concio.analysis.limit import limit
from concio.arguments import strict
from concio.contact.assembly import assemble
from concio.errors import InputError
from concio.model.model import Model
from concio.problem.solution import Progress, ProgressCallback
from concio.representation import short_repr
from concio.verdict.continuum_verdict import continuum_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.continuum_accessor import HalvingPlots

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False, repr=False)
class BlockHalving(Shown):
    """A wall with blocks of several sizes beside its continuum.

    Parameters
    ----------
    sizes : tuple of int
        How many times smaller the blocks are.
    comparisons : tuple of ContinuumComparison
        One for each; limit loads of the continuum stand in the first alone.
    associated : (k,) array
        Associated limit multipliers of the blocks; nan where none were asked for.
    """

    sizes: tuple[int, ...]
    comparisons: tuple[ContinuumComparison, ...]
    associated: Array

    @property
    def bracket(self) -> tuple[float, float]:
        """Limit multiplier of the continuum: at least, at most; nan where none was asked for."""
        strength = self.comparisons[0].strength
        return (float("nan"), float("nan")) if strength is None else strength.bracket

    def table(self) -> dict[str, Array]:
        """Return one row a size: blocks, settlements, differences from the continuum, limit multipliers."""
        elastic = [c.elastic for c in self.comparisons]
        settled = np.array([(np.nan,) * 3 if e is None else e.settlements for e in elastic])
        apart = np.array([(np.nan,) * 2 if e is None else e.differences for e in elastic])
        low, high = self.bracket
        return {
            "times_smaller": np.array(self.sizes),
            "blocks": np.array([len(c.assembly.model.free_bodies) for c in self.comparisons]),
            "settlement_blocks": settled[:, 0],
            "settlement_bonded": settled[:, 1],
            "settlement_continuum": settled[:, 2],
            "difference_blocks": apart[:, 0],
            "difference_bonded": apart[:, 1],
            "limit_blocks": self.associated,
            "limit_continuum_at_least": np.full(len(self.sizes), low),
            "limit_continuum_at_most": np.full(len(self.sizes), high),
        }

    def summary(self) -> dict[str, Any]:
        """Return the table as plain lists."""
        return {name: [v if np.isfinite(v) else None for v in column.tolist()] for name, column in self.table().items()}

    @property
    def verdict(self) -> Verdict:
        """What was compared, for blocks of every size, and what has no proof."""
        return continuum_verdict(self.comparisons[0], self)

    @property
    def plot(self) -> HalvingPlots:
        """Figures by name; matplotlib is loaded here."""
        plots: HalvingPlots = view(self, "plot")
        return plots


@strict
def halve_blocks(
    make: Callable[[int], Model],
    cell: Model | None = None,
    *,
    sizes: Sequence[int] = (1, 2, 4),
    live: str | Sequence[str] | None = None,
    mesh_size: float | None = None,
    elastic: bool = True,
    strength: bool = True,
    progress: ProgressCallback | None = None,
) -> BlockHalving:
    """Compare a wall with its continuum for blocks that become smaller and smaller.

    Parameters
    ----------
    make : callable
        ``make(n)`` returns the wall with blocks n times smaller, in both directions, than ``make(1)``. For the same
        continuum, mortar joints have to be n times thinner and stiffnesses of joints n times larger.
    cell : Model, optional
        Of the wall ``make(1)``; see :func:`concio.compare_with_continuum`.
    sizes : sequence of int
        The n, increasing.
    live, mesh_size, elastic, strength, progress
        As in :func:`concio.compare_with_continuum`. Limit loads of the continuum are found once.

    Raises
    ------
    InputError
        The sizes are not increasing whole numbers from 1 on, or as :func:`concio.compare_with_continuum`.

    Examples
    --------
    Blocks half as large are nearer to the continuum. Their joints are twice as stiff:

    >>> import concio
    >>> def make(n):
    ...     law = concio.JointLaw(0.6, normal_stiffness=n * 10e6, tangential_stiffness=n * 4e6)
    ...     return concio.wall(length=1.0, height=0.5, block_size=(0.5 / n, 0.25 / n), friction=law, top_pressure=100.0)
    >>> found = concio.halve_blocks(make, sizes=(1, 2), strength=False, mesh_size=0.25)
    >>> found.table()["difference_blocks"].round(1).tolist()
    [0.2, 0.1]
    """
    chosen = tuple(sizes)
    whole = all(isinstance(n, int | np.integer) and not isinstance(n, bool) and n >= 1 for n in chosen)
    if not chosen or not whole or any(b <= a for a, b in pairwise(chosen)):
        msg = f"sizes = {list(chosen)} must be increasing whole numbers from 1 on"
        raise InputError(msg, hint="for example sizes = (1, 2, 4, 8)")
    found: list[ContinuumComparison] = []
    loads: list[float] = []
    for k, n in enumerate(chosen):
        model = make(int(n))
        if progress is not None:
            progress(Progress("halving", k, 0.0, f"blocks {n} times smaller"))
        assembly = assemble(model)
        one = compare_with_continuum(
            assembly, cell, live=live, mesh_size=mesh_size, elastic=elastic, strength=strength and not found,
            progress=progress,
        )  # fmt: skip
        found.append(one)
        first = found[0].strength
        if first is None:
            loads.append(float("nan"))
        elif k == 0:
            loads.append(first.blocks.associated.multiplier)
        else:
            loads.append(limit(assembly, first.live, path=False, search=False).associated.multiplier)
    return BlockHalving(tuple(int(n) for n in chosen), tuple(found), np.array(loads))
