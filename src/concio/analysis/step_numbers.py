"""The numbers of a load step in plain types, as ``--json`` prints them."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.contacts import STATE_NAMES
from concio.contact.factors import load_factor
from concio.problem.limits_of_work import LARGEST_EXISTENCE

if TYPE_CHECKING:
    from concio.analysis.result import Result


def step_numbers(result: Result) -> dict[str, Any]:
    """Return the numbers of a load step: plain types, kN and m.

    Parameters
    ----------
    result : Result
    """
    contacts = result.contacts if result.solved else None
    data: dict[str, Any] = {
        "status": result.status.name.lower(),
        "sentence": result.sentence,
        "verdict": result.verdict.as_dict(),
        "method": result.method,
        "engine": result.engine,
        "title": result.model.title,
        "bodies": len(result.model.free_bodies),
        "contacts": len(result.assembly.pairs),
        "contact_model": result.assembly.pairs.contact_model,
        "interfaces": len(result.assembly.detection.interfaces),
        "unknowns": result.assembly.disc.unknowns,
        "certificate": {k: _finite(v) for k, v in result.certificate.as_dict().items()},
        "iterations": result.solution.iterations,
        "factorisations": result.solution.factorisations,
        "seconds": {k: round(v, 6) for k, v in result.seconds.items()},
        "load_factors": {g: load_factor(result.factors, g) for g in result.assembly.groups},
        "total_load": list(result.total_load),
        "trace": list(result.solution.trace),
        "lent_compliance": result.lent_compliance,
        "attention": list(result.attention),
        "broken_ties": [{"name": name, "elongation": far} for name, far in result.broken_ties],
        "units": {"force": "kN", "length": "m", "stress": "kN/m2"},
    }
    if contacts is not None:
        data["max_settlement"] = result.max_settlement
        data["joint_motion"] = asdict(result.joint_motion)
        data["outline_gap_difference"] = _finite(result.outline_gap_difference)
        data["reactions"] = {name: list(force) for name, force in result.reactions.items()}
        data["ties"] = result.ties.as_list()
        data["pairs"] = {name: contacts.count(name) for name in STATE_NAMES}
    if 0 < len(result.assembly.pairs) <= LARGEST_EXISTENCE:  # without pairs there is nothing to guarantee
        condition = result.existence
        data["sufficient_condition"] = {"holds": condition.holds, "margin": _finite(condition.margin)}
    if result.self_stress is not None:
        data["self_stress"] = {"compression": result.self_stress.compression, "load": result.self_stress.load}
    if result.mechanism is not None:
        data["mechanism"] = {"power": result.mechanism.power, "violation": result.mechanism.violation}
    return data


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
