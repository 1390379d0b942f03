"""The reliability index of the multiplier that a study requires, by derivatives and not by its sample.

The limit state is the associated multiplier of the groups of ``live`` less what is required, at the load factors of the
study; its derivatives come by duality (:func:`~concio.studies.reliability.multiplier_over`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from concio.errors import ConcioError, InputError
from concio.studies.analyses import Settings, at_factors
from concio.studies.reliability import Reliability, multiplier_over, reliability
from concio.studies.sampling import Sample
from concio.studies.study_rows import Tables

if TYPE_CHECKING:
    from concio.model.model import Model


@dataclass(frozen=True)
class RequiredMultiplier:
    """What a study says of a multiplier that is required.

    Parameters
    ----------
    required : float
    groups : tuple of str
        Load groups that are multiplied.
    index : Reliability or None
        None where there is no index.
    why : str
        Why there is none.
    """

    required: float
    groups: tuple[str, ...]
    index: Reliability | None
    why: str = ""

    def as_dict(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        told: dict[str, Any] = {"multiplier": self.required, "groups": list(self.groups)}
        if self.index is None:
            return {**told, "beta": None, "why": self.why}
        found = self.index
        return {**told, "beta": found.beta, "probability": found.probability, "design_point": found.point,
                "importance": found.importance, "evaluations": found.evaluations}  # fmt: skip


def required_multiplier(required: float, source: object, sample: Sample, settings: Settings) -> RequiredMultiplier:
    """Return the reliability index of a required multiplier of the models of a study.

    Parameters
    ----------
    required : float
    source : Tables or callable
        Where models come from.
    sample : Sample
        Whose variables differ; its runs are not used.
    settings : Settings

    Raises
    ------
    InputError
        The multiplier is not a number, or models come from a function.
    """
    if not math.isfinite(required):
        msg = f"required = {required!r} must be a number"
        raise InputError(msg)
    if not isinstance(source, Tables):
        msg = "a required multiplier needs a model file"
        raise InputError(msg, hint="for functions call concio.reliability with concio.multiplier_over")
    scaled = {g: f for g, f in settings.factors.items() if g not in settings.live and f != 1.0}

    def made(values: dict[str, float]) -> Model:
        model = source.model(sample.variables, tuple(values[v.name] for v in sample.variables))
        return at_factors(model, scaled) if scaled else model

    if sample.correlated:
        return RequiredMultiplier(required, settings.live, None, "its variables are correlated")
    try:
        found = reliability(multiplier_over(made, required, settings.live), sample.variables)
    except ConcioError as error:
        return RequiredMultiplier(required, settings.live, None, error.what)
    return RequiredMultiplier(required, settings.live, found)
