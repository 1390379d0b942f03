"""Parts of a model in words, each number with its unit."""

from __future__ import annotations

from concio.display import Units, number
from concio.model.materials import Elastic, JointLaw, Rigid

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
