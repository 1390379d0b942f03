"""Self-weight that is missing, acts twice, or is not multiplied by 1: what a certificate can never see."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

from concio.contact.edge_loads import loaded_bodies
from concio.display import counted
from concio.errors import InputError
from concio.model.model import Model

MOST_NAMES = 3
EARTH = (9.0, 10.5)
"""Lengths of a vector of gravity that is meant as an acceleration [m/s2]; weights are multiplied by it."""
ROUNDING = 1e-9


@dataclass
class _Down:
    """What multiplies the weight of one body downwards: the sum over loads, and the groups they belong to."""

    total: float = 0.0
    groups: list[str] = field(default_factory=list)


def odd_weights(model: Model) -> tuple[str, ...]:
    """Return a sentence for each way in which the self-weight of blocks is missing or not what it usually is.

    Parameters
    ----------
    model : Model
    """
    if model.periods is not None:
        return ()
    free = {b: body for b, body in enumerate(model.bodies) if body.kind != "fixed"}
    weightless = [body.name for body in free.values() if model.materials[body.material].unit_weight == 0]
    heavy = len(free) - len(weightless)
    acting = _downwards(model)
    if not acting:
        return _no_weight(model, heavy)
    found = []
    if weightless and heavy:
        found.append(
            f"{_first(weightless)} {_has(weightless)} no unit weight, the other {heavy:,} have one: was it forgotten?"
        )
    left = [body.name for b, body in free.items() if b not in acting and body.name not in weightless]
    if left:
        found.append(f"self-weight does not act on {_first(left)}: loads of kind weight name other blocks")
    return (*found, *_factors(model, acting))


def _downwards(model: Model) -> dict[int, _Down]:
    found: dict[int, _Down] = defaultdict(_Down)
    for load in model.loads:
        if load.kind != "weight" or not load.value or load.value[-1] == 0:
            continue
        try:
            bodies = loaded_bodies(model, load)
        except InputError:  # told by the assembly, which refuses it
            continue
        for b in bodies:
            found[b].total -= load.value[-1]
            found[b].groups.append(load.group)
    return found


def _no_weight(model: Model, heavy: int) -> tuple[str, ...]:
    """Return what to say where no load of kind weight acts downwards."""
    sideways = any(load.kind == "weight" for load in model.loads)
    if heavy:
        words = f"{counted(heavy, 'block')} {'has' if heavy == 1 else 'have'} a unit weight"
        why = "loads of kind weight act sideways alone" if sideways else "there is no load of kind weight"
        return (f"self-weight does not act{' downwards' * sideways}: {words}, and {why}",)
    acts = any(s.moves for s in model.supports) or any(t.prestress for t in model.ties)
    if not (acts or model.loads or model.temperatures):
        return ("nothing acts: there are no loads, no support is moved and no tie is prestressed",)
    return ()


def _factors(model: Model, acting: dict[int, _Down]) -> tuple[str, ...]:
    """Return a sentence for each multiple of the weights that is not 1."""
    by_factor: dict[tuple[float, tuple[str, ...]], list[str]] = defaultdict(list)
    for b, down in acting.items():
        if abs(down.total - 1.0) > ROUNDING:
            by_factor[(round(down.total, 9), tuple(down.groups))].append(model.bodies[b].name)
    found = []
    for (factor, groups), names in by_factor.items():
        whose = f"of {_first(names)}" if len(names) < len(acting) else "of every block"
        several = (
            f" by {len(groups)} loads of {', '.join(f'{g!r}' for g in dict.fromkeys(groups))}"
            if len(groups) > 1
            else ""
        )
        text = f"the self-weight {whose} acts {factor:g} times downwards{several}, with every load factor 1"
        if factor < 0:
            text = f"the self-weight {whose} acts upwards ({-factor:g} times){several}"
        elif any(EARTH[0] <= np.abs(factor / max(n, 1)) <= EARTH[1] for n in (1, len(groups))):
            text += ": the value of a weight is a multiple of the unit weight, (0, -1) is gravity, not (0, -9.81)"
        found.append(text)
    return tuple(found)


def _has(names: list[str]) -> str:
    return "has" if len(names) == 1 else "have"


def _first(names: list[str]) -> str:
    more = f" and {len(names) - MOST_NAMES:,} more" if len(names) > MOST_NAMES else ""
    return ", ".join(f"'{name}'" for name in names[:MOST_NAMES]) + more
