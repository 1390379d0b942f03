"""The analyses of one model in a study, each made once, when it is first asked for."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.contact.factors import load_factor
from concio.errors import NoEquilibriumError
from concio.model.model import Model
from concio.problem.solution import Progress
from concio.solvers.algebra.threads import one_thread

if TYPE_CHECKING:
    from concio.analysis.bridges.sweep import Standing
    from concio.analysis.limit import LimitResult
    from concio.analysis.margins import Margin
    from concio.analysis.result import Result
    from concio.contact.assembly import Assembly
    from concio.problem.solution import ProgressCallback


@dataclass(frozen=True)
class Settings:
    """How the analyses of every run are made.

    Parameters
    ----------
    method : str
        Method of :func:`concio.solve`.
    factors : mapping of str to float
        Load factors of every analysis; a group that is not named has 1.
    live : tuple of str
        Load groups that limits and margins multiply from zero, whatever their factors.
    """

    method: str = "auto"
    factors: Mapping[str, float] = field(default_factory=dict)
    live: tuple[str, ...] = ("live",)


class Analyses:
    """The analyses of one model, each made when it is first asked for.

    Parameters
    ----------
    model : Model
    settings : Settings
    deadline : float
        Time of :func:`time.monotonic` at which solvers are asked to stop.
    """

    def __init__(self, model: Model, settings: Settings | None = None, deadline: float = np.inf) -> None:
        self.model, self.settings, self.deadline = model, settings or Settings(), deadline

    @property
    def progress(self) -> ProgressCallback:
        """The callback that asks solvers to stop when the time of the run is over."""

        def late(_: Progress) -> bool:
            return time.monotonic() > self.deadline

        return late

    @cached_property
    def assembly(self) -> Assembly:
        """The discretised model."""
        from concio.contact.assembly import assemble

        return assemble(self.model)

    @cached_property
    def result(self) -> Result:
        """One load step, whatever its outcome."""
        from concio.analysis.step import solve

        s = self.settings
        return solve(
            self.assembly, method=s.method, factors=dict(s.factors), on_failure="return", progress=self.progress
        )

    @cached_property
    def multiplied(self) -> Model | Assembly:
        """What limits and margins are asked about: groups that are not multiplied act with their factors."""
        s = self.settings
        scaled = {g: f for g, f in s.factors.items() if g not in s.live and f != 1.0}
        return at_factors(self.model, scaled) if scaled else self.assembly

    @cached_property
    def limit(self) -> LimitResult:
        """The associated limit load, without the Coulomb path."""
        from concio.analysis.limit import limit

        return limit(self.multiplied, self.settings.live, path=False, search=False)

    @cached_property
    def coulomb(self) -> LimitResult:
        """The associated limit load and the Coulomb path."""
        from concio.analysis.limit import limit

        return limit(self.multiplied, self.settings.live, path=True, search=False, progress=self.progress)

    @cached_property
    def load_margin(self) -> Margin:
        """The largest factor of the live load that single steps were found to carry."""
        from concio.analysis.margins import load_margin

        return load_margin(self.multiplied, self.settings.live)

    @cached_property
    def friction_factor(self) -> float:
        """The smallest common factor of friction with which forces balance the loads of the load step."""
        from concio.solvers.statics.friction import smallest_friction

        with one_thread():
            return smallest_friction(self.assembly.problem(dict(self.settings.factors))).factor

    @cached_property
    def bridge(self) -> Standing | None:
        """The worst position of the vehicle of a bridge with its bound; None where nothing bounds its load."""
        from concio.analysis.bridges.sweep import Sweep, least, search
        from concio.solvers.statics.existence import find_mechanism

        sweep = Sweep(self.model)
        with one_thread():
            if find_mechanism(sweep.dead) is not None:
                msg = "the bridge does not stand without the vehicle"
                raise NoEquilibriumError(msg)
            found = least(search(sweep, worst=1, progress=self.progress), 1, 0.0)
        return found[0] if found else None

    @cached_property
    def crossed(self) -> Assembly:
        """The model with its vehicle where that is worst."""
        from concio.analysis.bridges.sweep import placed
        from concio.contact.assembly import assemble

        return assemble(self.model if self.bridge is None else placed(self.model, self.bridge))

    @property
    def acting(self) -> dict[str, dict[str, Any]]:
        """Load groups with their forces at factor 1, where the model was assembled."""
        from concio.verdict.question import acting_groups

        if not (self.made("assembly") or self.made("bridge")):
            return {}
        shown = self.assembly if self.made("assembly") else self.crossed
        return {a.group: {"what": a.what, "force": list(a.force), "size": a.size} for a in acting_groups(shown)}

    @property
    def attention(self) -> tuple[str, ...]:
        """What is suspicious about the model, where it was assembled."""
        from concio.verdict.attention import attention

        return attention(self.assembly) if self.made("assembly") else ()

    @property
    def assumed(self) -> tuple[str, ...]:
        """What of the model was not given."""
        from concio.verdict.question import assumed_words, other_stages

        return (*assumed_words(self.model), *other_stages(self.model))

    @property
    def unseen(self) -> tuple[str, ...]:
        """Bodies too light for the certificates of what was computed, where that says that something holds."""
        from concio.verdict.unseen import unseen_bodies

        multiplied = any(self.made(name) for name in ("limit", "coulomb", "load_margin"))
        stepped = self.made("result") and self.result.solved
        at = [dict(self.settings.factors)] if stepped or multiplied else []
        if multiplied:
            at.append({**self.settings.factors, **dict.fromkeys(self.settings.live, 0.0)})
        return unseen_bodies(self.assembly, at) if at else ()

    def made(self, name: str) -> bool:
        """Return whether an analysis was asked for."""
        return name in self.__dict__


def at_factors(model: Model, factors: Mapping[str, float]) -> Model:
    """Return a model whose loads and moved supports are multiplied by the factors of their groups."""
    loads = tuple(
        replace(load, value=tuple(load_factor(factors, load.group) * v for v in load.value)) for load in model.loads
    )
    supports = tuple(
        replace(
            one,
            displacement=_times(factors[one.group], one.displacement),
            rotation=_times(factors[one.group], one.rotation),
        )
        if one.group in factors and one.moves
        else one
        for one in model.supports
    )
    return replace(model, loads=loads, supports=supports)


def _times(factor: float, value: Any) -> Any:
    return tuple(factor * v for v in value) if isinstance(value, tuple | list) else factor * value
