"""Which load groups hold self-weight: a structure without it is another structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from concio.model.model import Model


def weight_groups(model: Model) -> tuple[str, ...]:
    """Return the load groups that hold self-weight acting downwards, in the order of the model."""
    return tuple(dict.fromkeys(load.group for load in model.loads if load.kind == "weight" and load.value[-1] < 0))


def weightless(model: Model, factors: Mapping[str, float]) -> tuple[str, ...]:
    """Return the groups with self-weight that do not act under some factors (a factor that is not named is 0)."""
    return tuple(group for group in weight_groups(model) if group not in factors or factors[group] == 0.0)


def usual_order(model: Model, groups: Sequence[str]) -> tuple[str, ...]:
    """Return load groups in the order in which a structure meets them: self-weight first, then the others as given."""
    first = [group for group in weight_groups(model) if group in groups]
    return (*first, *(group for group in groups if group not in first))
