"""What will act in a question, before it runs: the sentences of its verdict, in kN, and what the question adds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from concio.analysis.path import Stage
from concio.analysis.settlement import moved_groups
from concio.contact.applied import resultants, sideways
from concio.contact.assembly import assemble
from concio.contact.factors import load_factor
from concio.errors import ConcioError
from concio.model.model import Model
from concio.verdict.italian import in_italian
from concio.verdict.path_verdict import stage_words
from concio.verdict.question import Acting, acting_groups, assumed_words, movement_words
from concio.window.read_models import read
from concio.window.worker import Tell

WEIGHTS = "weights"


def acts(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return what will act.

    Parameters
    ----------
    request : mapping
        As for :func:`concio.window.read_models.read`; ``question``, the name of the command, and ``options`` of the
        page.
    tell : callable
        Not used.

    Returns
    -------
    dict
        ``lines``: sentences in English; ``italian``: the same in pieces with their language.
    """
    data, model = read(request)
    lines = list(_lines(str(request["question"]), dict(request["options"]), data, model))
    return {"lines": lines, "italian": [in_italian(line) for line in lines]}


def _lines(question: str, options: Mapping[str, Any], data: Mapping[str, Any], model: Model) -> Iterator[str]:
    assembly, units = assemble(model), model.report
    live = {str(g) for g in options.get("groups") or ()}
    if question == "push" and not live and "live" in model.load_groups and not options.get("weights"):
        live = {"live"}
    moved = _moved(options, model)
    if question == "settle":
        live = {moved}
    factors = dict(_factors(options.get("factor")))
    groups = [_role(group, live if question in ("limit", "push", "settle") else set(), factors)
              for group in acting_groups(assembly)]  # fmt: skip
    for group in groups:
        yield group.sentence(units)
        if group.role != "not applied":
            amount = _number(options.get("amount")) if question == "settle" and group.group == moved else group.factor
            yield from movement_words(model, group.group, 1.0 if math.isnan(amount) else amount)
    if not groups and question in ("run", "limit", "path"):
        yield "nothing: the model has no loads and no support is moved"
    weight = units.text("force", _weight(model), 4) if question in ("push", "assess") else ""
    if question == "push" and not live:
        way = str(options.get("direction") or "x")
        yield f"a horizontal share of all weights: multiplied; at factor 1 {weight} along {way}"
    if question == "assess":
        yield (
            "a horizontal share of all weights, mechanism by mechanism, to both sides: multiplied; "
            f"all of it is {weight} at factor 1"
        )
    yield from _added(question, options, data, model)
    yield from assumed_words(model)


def _added(question: str, options: Mapping[str, Any], data: Mapping[str, Any], model: Model) -> Iterator[str]:
    """Return what a question adds to the loads of the model."""
    units = model.report
    if question == "bridge" and model.vehicle is not None:
        axles = model.vehicle.axles
        total = units.text("force", sum(a.load for a in axles), 4)
        name = model.vehicle.name or "of the file"
        yield f"vehicle {name}: multiplied at every position; at factor 1 {len(axles)} axles, {total} in all"
    if question == "shake":
        pulse = str(options.get("pulse") or "")
        still = "the ground does not move: the bodies are let go as described"
        yield f"the ground moves by the pulse {pulse}" if pulse else (
            "the ground moves as the file states" if data.get("motion") else still
        )
    if question == "path" and not options.get("stage"):
        stages = model.stages or [Stage(g, {g: 1.0}) for g in model.load_groups]
        for k, stage in enumerate(stages, 1):
            yield f"stage {k}: {stage_words(stage, units)}"
    if question == "settle":
        yield "supports are moved after all loads act; reactions are listed before and meanwhile"
    if question == "study":
        yield "each run has its own values, as the table [study] states"
    if question == "diagnose":
        yield "supports are moved one after the other, as the table [survey] states"


def _role(group: Acting, live: set[str], factors: Mapping[str, float]) -> Acting:
    if group.group in live:
        return replace(group, role="multiplied", factor=math.nan)
    factor = load_factor(factors, group.group)
    return replace(group, factor=factor, role="constant" if factor else "not applied")


def _moved(options: Mapping[str, Any], model: Model) -> str:
    """Return the load group of a settlement, as the command chooses it."""
    known = moved_groups(model)
    return str(options.get("moving") or (known[0] if len(known) == 1 else "settlement"))


def _number(text: Any) -> float:
    """Return the number of a field; nan where it is not complete yet."""
    try:
        return float(str(text))
    except ValueError:
        return math.nan


def _factors(text: Any) -> Iterator[tuple[str, float]]:
    """Return groups and factors of a field such as ``live=1.5, wind=0``; what is not complete yet is left out."""
    for part in str(text or "").replace(";", ",").split(","):
        name, _, value = part.partition("=")
        try:
            yield name.strip(), float(value)
        except ValueError:
            continue


def _weight(model: Model) -> float:
    """Return what a push of the weights multiplies: the weight of the bodies and what loads them from above [kN]."""
    try:
        made, numbers = sideways(model, (1.0, *(0.0,) * (model.dim - 1)), WEIGHTS)
    except ConcioError:
        return math.nan
    groups = [model.loads[k].group for k in numbers]
    found = resultants(replace(model, loads=tuple(made)), range(len(made)), groups)
    return float(sum(size for _, size in found.values()))
