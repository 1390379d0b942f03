"""Parts of a model in words, each number with its unit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from concio.display import Units, number
from concio.model.materials import Elastic, JointLaw, Rigid

if TYPE_CHECKING:
    from concio.model.model import Model, Tie

T = TypeVar("T")

MOST = 6
"""More materials and joint laws than this are not listed one by one."""

LAW_KINDS: dict[str, str] = {
    "cohesion": "stress",
    "tensile_strength": "stress",
    "dilatancy": "number",
    "normal_stiffness": "joint stiffness",
    "tangential_stiffness": "joint stiffness",
    "compressive_strength": "stress",
}
"""Kind of quantity of each constant of a joint law besides its friction."""


def material_words(material: Elastic | Rigid, units: Units) -> str:
    """Return the constants of a material, such as ``"E = 5 GPa, nu = 0.2, unit weight 25 kN/m3"``."""
    weight = f"unit weight {units.text('unit weight', material.unit_weight)}"
    if isinstance(material, Rigid):
        return f"rigid, {weight}"
    return f"E = {units.text('modulus', material.E)}, nu = {number(material.nu)}, {weight}"


def law_words(law: JointLaw, units: Units) -> str:
    """Return the constants of a joint law that are not zero; friction always."""
    words = [f"friction {number(law.friction)}"]
    for name, kind in LAW_KINDS.items():
        value = getattr(law, name)
        if value:
            words.append(f"{name.replace('_', ' ')} {units.text(kind, value)}")
    return ", ".join(words)


def tie_words(tie: Tie, units: Units) -> str:
    """Return stiffness, prestress, yield force and break elongation of a tie, what it has not included."""
    words = [f"stiffness {units.text('stiffness', tie.stiffness)}"]
    words.append(f"prestress {units.text('force', tie.prestress)}" if tie.prestress else "no prestress")
    strong = "never yields" if tie.yield_force is None else f"yields at {units.text('force', tie.yield_force)}"
    if tie.break_elongation is None:
        return ", ".join((*words, strong, "never breaks"))
    far = units.text("motion", tie.break_elongation)
    return ", ".join((*words, strong, f"breaks when stretched by {far}, with {units.text('force', tie.strength)}"))


def model_lines(model: Model) -> list[str]:
    """Return a model in a few lines: sizes, materials, joint laws, loads."""
    units = model.report
    free = len(model.free_bodies)
    fixed = len(model.bodies) - free
    plane = model.dim == 2
    corners = [b.outline for b in model.outlines] if plane else [b.vertices for b in model.polyhedra]
    box = np.ptp(np.vstack(corners), axis=0)
    scale, symbol = units.factor("length")
    size = " x ".join(number(scale * side, 4) for side in box.tolist())
    kinds = Counter(body.kind for body in model.bodies if body.kind != "fixed")
    what = ", ".join(f"{count:,} {kind}" for kind, count in kinds.items())
    lines = [
        f"Model: {model.title or 'without a title'}",
        f"  {free:,} bod{'y' if free == 1 else 'ies'} ({what}), {fixed:,} fixed; {size} {symbol}",
        *(f"  material {name}: {material_words(given, units)}" for name, given in _first(model.materials)),
        *(f"  joint law {name}: {law_words(law, units)}" for name, law in _first(model.laws)),
    ]
    for group in model.load_groups:
        loads = Counter(load.kind for load in model.loads if load.group == group)
        words = [f"{count} {kind}" for kind, count in loads.items()]
        moved = sum(support.group == group for support in model.supports)
        words += [f"{moved} support{'s' if moved > 1 else ''}"] if moved else []
        warmed = sum(change.group == group for change in model.temperatures)
        words += [f"{warmed} change{'s' if warmed > 1 else ''} of temperature"] if warmed else []
        lines.append(f"  load group {group}: {', '.join(words)}")
    if model.stages:
        lines.append(f"  stages: {', '.join(stage.name for stage in model.stages)}")
    return lines


def _first(named: Mapping[str, T]) -> list[tuple[str, T]]:
    return list(named.items())[:MOST]
