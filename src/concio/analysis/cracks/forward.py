"""What motions of supports do to the measurements: a settlement path from the loaded structure, for any motions.

All loads act first, once; every motion is then followed from there, as :func:`concio.settle` does it. The motions grow
together in proportion: the openings are piecewise linear along the way and depend on it, since friction does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from concio.analysis.cracks.moved import MovedModel
from concio.analysis.cracks.observed import Reading
from concio.analysis.path import run_path
from concio.analysis.path_result import PathResult
from concio.contact.assembly import Assembly
from concio.errors import NoEquilibriumError, SolverError
from concio.model.stages import Stage
from concio.problem.limits_of_work import EXACT_PAIRS
from concio.verdict.not_standing import not_standing

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Prediction:
    """The state that motions lead to.

    Parameters
    ----------
    motions : (k,) array
        Of all candidates.
    values : (n,) array
        What every measurement would read [m or rad]; nan where the motions were not reached.
    displacement : (N_all,) array
        Of the state that was reached [m].
    factors : mapping of str to float
        Its load factors.
    path : PathResult
        The path from the loaded structure.
    """

    motions: Array
    values: Array
    displacement: Array
    factors: Mapping[str, float]
    path: PathResult

    @property
    def reached(self) -> bool:
        """Whether the motions were reached, in certified states."""
        return self.path.complete and self.path.certified


@dataclass(eq=False)
class Forward:
    """Predictions of one model, each computed once.

    Parameters
    ----------
    assembly : Assembly
        Of the model in which every candidate has a load group.
    moved : MovedModel
    readings : tuple of Reading
    method : {"events", "steps"}
    steps : int
        Load steps, if the path is followed in steps.
    """

    assembly: Assembly
    moved: MovedModel
    readings: tuple[Reading, ...]
    method: Literal["events", "steps"]
    steps: int
    runs: int = 0
    _known: dict[tuple[float, ...], Prediction] = field(default_factory=dict)
    _loaded: PathResult | None = None

    @classmethod
    def of(
        cls, assembly: Assembly, moved: MovedModel, found: Sequence[Reading],
        method: Literal["events", "steps"] | None, steps: int,
    ) -> Forward:  # fmt: skip
        """Return the predictions of a model, event by event where it is plane and small unless stated otherwise."""
        small = assembly.model.dim == 2 and len(assembly.pairs) <= EXACT_PAIRS
        return cls(assembly, moved, tuple(found), method or ("events" if small else "steps"), steps)

    @property
    def loaded(self) -> PathResult:
        """The path of the loads before anything moves.

        Raises
        ------
        NoEquilibriumError
            The structure does not stand under its loads.
        """
        if self._loaded is None:
            stage = Stage("loads", dict(self.moved.base))
            path = run_path(self.assembly, [stage], method=self.method)
            if not path.complete:
                msg = "the structure does not stand under its loads before anything moves"
                told = not_standing(self.assembly, "the cause of cracks", msg, factors=self.moved.base)
                raise NoEquilibriumError(msg, hint="see 'concio run' for its collapse", verdict=told)
            self._loaded = path
        return self._loaded

    def predict(self, motions: Array) -> Prediction:
        """Return the state that motions (k,) of all candidates lead to."""
        motions = np.asarray(motions, dtype=float)
        key = tuple(motions.tolist())
        if key not in self._known:
            self._known[key] = self._followed([motions], self.steps)
        return self._known[key]

    def in_order(self, parts: Sequence[Array]) -> Prediction:
        """Return the state that motions lead to which come one after the other; each is what a part adds (k,)."""
        return self._followed(np.cumsum(np.asarray(parts, dtype=float), axis=0), self.steps)

    def refined(self, motions: Array, times: int) -> Prediction:
        """Return the state in ``times`` as many steps; the same where the path is exact."""
        if self.method == "events" or times == 1:
            return self.predict(motions)
        return self._followed([np.asarray(motions, dtype=float)], times * self.steps)

    @property
    def _solvers(self) -> tuple[str, ...]:
        """Solvers of the steps of a path: what fails by the first is followed again by the next.

        A step that the interior point does not solve is halved by it, where ``auto`` would look for where the structure
        comes to rest: many times the work, of the same answer where half a step is solved.
        """
        quick = self.method == "steps" and self.assembly.model.dim == 2
        return ("interior-point", "auto") if quick else ("auto",)

    def _followed(self, ends: Sequence[Array] | Array, steps: int) -> Prediction:
        """Return the state at the last of some motions, each followed from the one before."""
        self.runs += 1
        loaded = self.loaded
        path = loaded
        for solver in self._solvers:
            with suppress(SolverError):
                path = run_path(
                    self.assembly, self.moved.stages(ends, steps), method=self.method, solver=solver,
                    restart=(loaded, len(loaded.steps) - 1),
                )  # fmt: skip
            if path.complete and path is not loaded:
                break
        last = path.steps[-1]
        u = path.assembly.displacement(last.state.displacement, last.factors)
        reached = path is not loaded and path.complete and path.certified
        values = self.read(self.readings, u, last.factors) if reached else np.full(len(self.readings), np.nan)
        return Prediction(np.asarray(ends[-1], dtype=float), values, u, dict(last.factors), path)

    def closing(self, prediction: Prediction) -> float:
        """Return how far the compliance added to hard joints lets one close at most in a state [m].

        Blocks that can move aside close them by next to nothing. Where they are forced together it is what makes room
        for the motion, and the forces between them belong to the compliance.
        """
        lent, hard = prediction.path.assembly, self.assembly
        if not lent.lent_compliance:
            return 0.0
        added = lent.laws.normal_compliance - hard.laws.normal_compliance
        return float((added * prediction.path.steps[-1].state.normal_force).max(initial=0.0))

    def read(self, found: Sequence[Reading], displacement: Array, factors: Mapping[str, float]) -> Array:
        """Return what some readings (n,) give of a state, from the loaded structure where they count from there."""
        start = self.loaded.steps[-1]
        zero = self.assembly.displacement(start.state.displacement, start.factors)
        return np.array([
            r.value(displacement, factors) - (r.value(zero, start.factors) if r.change else 0.0) for r in found
        ])  # fmt: skip
