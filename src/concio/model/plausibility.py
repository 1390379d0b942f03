"""Numbers that are possible but hardly meant: degrees for a coefficient, millimetres for metres, kg for kN.

Nothing here is refused. Each finding is a sentence for a person, shown as "attention" by ``concio check``, ``concio
run`` and the report.
"""

from __future__ import annotations

import numpy as np

from concio.model.actions import Point
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
"""Share of the size of a block by which the end of a tie, a support or a point load may lie outside it."""
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
    return (*found, *_sizes(model), *_places(model), *_weights(model), *_stages(model))


def _law(name: str, law: JointLaw) -> list[str]:
    if law.friction <= STEEP:
        return []
    angle = np.rad2deg(np.arctan(law.friction))
    text = f"joint law '{name}': friction {law.friction:g} is an angle of {angle:.3g} degrees"
    return [text + f": an angle is written with its unit, '{law.friction:g} deg'" if law.friction < 90 else text]


def _modulus(E: float) -> str:
    return f"{E / 1e6:g} GPa" if E >= 1e6 else f"{E / 1e3:g} MPa"


def _places(model: Model) -> list[str]:
    """Return a sentence for each tie, support and point load that acts far outside its block."""
    at = {b.name: b for b in model.bodies}
    acting: list[tuple[str, str, tuple[Point, ...], str]]
    acting = [(f"tie '{t.name}' ends", name, (end,), "its anchor") for t in model.ties
              for name, end in ((t.body_a, t.at_a), (t.body_b, t.at_b))]  # fmt: skip
    for support in model.supports:
        region = support.edge if support.edge is not None else support.polygon
        acting.append((f"support '{support.name}' holds", support.body, region or (), "its place"))
    for load in model.loads:
        if load.kind == "point" and load.at is not None and len(load.bodies) == 1:
            words = f"a point load of group '{load.group}' acts"
            acting.append((words, load.bodies[0], (load.at,), "its place"))
    found = []
    for words, name, points, place in acting:
        if name not in at:
            continue
        low, high = at[name].vertices.min(0), at[name].vertices.max(0)
        for point in np.array([p for p in points if len(p) == len(low)], dtype=float):
            off = float(np.linalg.norm(np.maximum(0.0, np.maximum(low - point, point - high))))
            if off > FAR * float((high - low).max()):
                where = ", ".join(f"{v:g}" for v in point)
                found.append(f"{words} at ({where}) m, {off:.3g} m outside '{name}': is that {place}?")
                break
    return found


def _weights(model: Model) -> list[str]:
    """Return a sentence where the own weight of a model in space acts along -y, as it does in the plane."""
    weights = [load.value for load in model.loads if load.kind == "weight"]
    down = any(len(v) == 3 and v[0] == 0 and v[1] < 0 for v in weights)
    if model.dim != 3 or not down or any(v[-1] != 0 for v in weights):
        return []
    return ["own weight acts along -y and none along z: in space z points up, and gravity is [0, 0, -1]"]


def _stages(model: Model) -> list[str]:
    """Return a sentence for each stage of a path that names a load group that no load and no support belongs to."""
    if model.periods is not None:  # a cell: its stages name strains and stresses
        return []
    known = model.load_groups
    return [
        f"stage '{stage.name}' names the load group '{group}', which does not exist: groups are {', '.join(known)}"
        for stage in model.stages
        for group in stage.factors
        if group not in known
    ]


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
