"""Numbers that are possible but hardly meant: degrees for a coefficient, millimetres for metres, kg for kN.

Nothing here is refused. Each finding is a sentence for a person, shown as "attention" by ``concio check``, ``concio
run`` and the report.
"""

from __future__ import annotations

import numpy as np

from concio.model.materials import Elastic, JointLaw
from concio.model.model import Model

STEEP = 1.5
"""Coefficients of friction above this are not those of masonry: 56 degrees."""
SOFT, STIFF = 5e4, 2e8
"""Young's moduli of masonry, timber and steel lie between these [kN/m2]: 50 MPa and 200 GPa."""
HEAVY = 80.0
"""No building material is heavier; steel has 78.5 [kN/m3]."""
LONG = 50.0
"""No block is longer [m]."""
FAR = 0.5
"""Share of the size of a block by which the end of a tie may lie outside it."""
MOVED = 0.1
"""Imposed displacements above this share of a block's size are large, and rotations above this [rad]."""


def implausible(model: Model) -> tuple[str, ...]:
    """Return a sentence for each number of a model that is hardly meant.

    Parameters
    ----------
    model : Model
    """
    used = dict.fromkeys(rule.law for rule in model.rules)
    made_of = dict.fromkeys(b.material for b in model.free_bodies)
    found = [text for name in used for text in _law(name, model.laws[name])]
    for name in made_of:
        material = model.materials[name]
        if isinstance(material, Elastic) and not SOFT <= material.E <= STIFF:
            word = "below 50 MPa, very soft" if material.E < SOFT else "above 200 GPa, stiffer than steel"
            found.append(f"material '{name}': E = {_modulus(material.E)} is {word}: is that its unit?")
        if material.unit_weight > HEAVY:
            found.append(
                f"material '{name}': a unit weight of {material.unit_weight:g} kN/m3 is more than that of steel: "
                f"masses are written with their unit, '{material.unit_weight:g} kg/m3'"
            )
    return (*found, *_sizes(model), *_ties(model))


def _law(name: str, law: JointLaw) -> list[str]:
    if law.friction <= STEEP:
        return []
    angle = np.rad2deg(np.arctan(law.friction))
    text = f"joint law '{name}': friction {law.friction:g} is an angle of {angle:.3g} degrees"
    return [text + f": an angle is written with its unit, '{law.friction:g} deg'" if law.friction < 90 else text]


def _modulus(E: float) -> str:
    return f"{E / 1e6:g} GPa" if E >= 1e6 else f"{E / 1e3:g} MPa"


def _ties(model: Model) -> list[str]:
    """Return a sentence for each end of a tie that lies far from the block it is fixed to."""
    at = {b.name: b for b in model.bodies}
    found = []
    for tie in model.ties:
        for name, end in ((tie.body_a, tie.at_a), (tie.body_b, tie.at_b)):
            if name not in at:
                continue
            low, high = at[name].vertices.min(0), at[name].vertices.max(0)
            point = np.asarray(end, dtype=float)
            off = float(np.linalg.norm(np.maximum(0.0, np.maximum(low - point, point - high))))
            if off > FAR * float((high - low).max()):
                place = ", ".join(f"{v:g}" for v in point)
                found.append(f"tie '{tie.name}' ends at ({place}) m, {off:.3g} m outside '{name}': is that its anchor?")
    return found


def _sizes(model: Model) -> list[str]:
    sizes = {b.name: float(np.ptp(b.vertices, axis=0).max()) for b in model.free_bodies}
    found = []
    large = [name for name, size in sizes.items() if size > LONG]
    if large:
        most = max(large, key=lambda name: sizes[name])
        several = f", as are {len(large) - 1} others" if len(large) > 1 else ""
        found.append(
            f"block '{most}' is {sizes[most]:,.4g} m long{several}, more than {LONG:g} m: is that the unit of length?"
        )
    usual = float(np.median(list(sizes.values()))) if sizes else 0.0
    for support in model.supports:
        size = sizes.get(support.body, usual)
        move = float(np.linalg.norm(support.displacement))
        if move > MOVED * size:
            found.append(
                f"support '{support.name}' moves '{support.body}' by {1e3 * move:,.4g} mm, more than a tenth of a "
                f"block of {size:.3g} m: is that its unit? Displacements are taken to be small"
            )
        turn = float(np.linalg.norm(support.rotation))
        if turn > MOVED:
            found.append(
                f"support '{support.name}' turns '{support.body}' by {turn:.3g} rad: rotations are taken "
                f"to be small; in degrees an angle is written with its unit, '{turn:g} deg'"
            )
    return found
