"""Numbers that are possible but implausible: degrees for a coefficient, millimetres for metres, kg for kN.

Nothing here is refused. Each finding is a sentence for a person, and part of the one list of attention of
:mod:`concio.verdict.attention`.
"""

from __future__ import annotations

import numpy as np

from concio.model.actions import Point
from concio.model.body import Body
from concio.model.materials import Elastic, JointLaw
from concio.model.model import Model
from concio.model.odd_crossing import odd_crossing

STEEP = 1.5
"""Coefficients of friction above this are not those of masonry: 56 degrees."""
SOFT, STIFF = 5e4, 2e8
"""Young's moduli of masonry, timber and steel lie between these [kN/m2]: 50 MPa and 200 GPa."""
HEAVY = 80.0
"""No building material is heavier; steel has 78.5 [kN/m3]."""
LONG = 50.0
"""No block is longer [m]."""
SHORT = 1e-3
"""No block is shorter [m]."""
THIN, THICK = 0.01, 20.0
"""Plane bodies are thicker than the first and thinner than the second [m]."""
WEAK = 200.0
"""Compressive strengths of masonry lie above [kN/m2]: 0.2 MPa."""
LOOSE = 1.0
"""Cohesions and tensile strengths that are not zero lie above [kN/m2]: 0.001 MPa."""
SLACK = 1e3
"""Stiffnesses of joints lie above [kN/m3]; those of mortar joints from 1e6 on."""
INFINITE = 1e8
"""No tie is stiffer [kN/m]: a bar of 100 mm and 1 m length has 1.6e6."""
FAR = 0.5
"""Share of the size of a block by which the end of a tie, a support or a point load may lie outside it."""
MOVED = 0.1
"""Imposed displacements above this share of a block's size are large, and rotations above this [rad]."""
TURNED = 0.005
"""Rotations of supports above this change multipliers by about as much, where displacements are large [rad]."""


def implausible(model: Model) -> tuple[str, ...]:
    """Return a sentence for each number of a model that is implausible.

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
    return (
        *found, *_sizes(model), *_thickness(model), *_ring(model), *_places(model), *_ties(model), *_weights(model),
        *_stages(model), *odd_crossing(model),
    )  # fmt: skip


def _law(name: str, law: JointLaw) -> list[str]:
    return [*_friction(name, law), *_strengths(name, law)]


def _strengths(name: str, law: JointLaw) -> list[str]:
    """Return a sentence for each strength or stiffness below that of any masonry: mostly a bare number in MPa."""
    least = {
        "compressive_strength": (WEAK, "kN/m2", "MPa"), "cohesion": (LOOSE, "kN/m2", "MPa"),
        "tensile_strength": (LOOSE, "kN/m2", "MPa"), "normal_stiffness": (SLACK, "kN/m3", "N/mm3"),
        "tangential_stiffness": (SLACK, "kN/m3", "N/mm3"),
    }  # fmt: skip
    found = []
    for key, (limit, unit, other) in least.items():
        value = getattr(law, key)
        if value is not None and 0 < value < limit:
            found.append(
                f"joint law '{name}': {key} = {value:g} {unit} is below that of any masonry: a value in {other} is "
                f"written with its unit, '{value:g} {other}'"
            )
    return found


def _friction(name: str, law: JointLaw) -> list[str]:
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
    """Return a sentence where the self-weight of a model in space acts along -y, as it does in the plane."""
    weights = [load.value for load in model.loads if load.kind == "weight"]
    down = any(len(v) == 3 and v[0] == 0 and v[1] < 0 for v in weights)
    if model.dim != 3 or not down or any(v[-1] != 0 for v in weights):
        return []
    return ["self-weight acts along -y and none along z: in space z points up, and gravity is [0, 0, -1]"]


def _thickness(model: Model) -> list[str]:
    """Return a sentence where plane bodies are thinner or thicker than any wall."""
    depths = [b.thickness for b in model.bodies if isinstance(b, Body) and b.kind != "fixed"]
    odd = [v for v in depths if not THIN <= v <= THICK]
    if not odd:
        return []
    word = "that of a sheet" if odd[0] < THIN else "more than that of any wall"
    return [f"a thickness of {odd[0]:g} m is {word}: is that its unit?"]


def _ring(model: Model) -> list[str]:
    """Return a sentence where the ring of an arch is thicker than half of its span."""
    ring, span = (model.generator.get(key) for key in ("ring", "span"))
    if isinstance(ring, int | float) and isinstance(span, int | float) and ring > 0.5 * span > 0:
        return [f"a ring of {ring:g} m in a span of {span:g} m is more than half of it: is that its unit?"]
    return []


def _ties(model: Model) -> list[str]:
    """Return a sentence on ties that are stiffer than any, and on those whose force has no limit."""
    found = [
        f"tie '{t.name}': a stiffness of {t.stiffness:.4g} kN/m is that of no bar: is that its unit?"
        for t in model.ties
        if t.stiffness > INFINITE
    ]
    unlimited = [t.name for t in model.ties if t.yield_force is None]
    if unlimited:
        more = f" and {len(unlimited) - 1} more" if len(unlimited) > 1 else ""
        found.append(f"tie '{unlimited[0]}'{more} without a yield_force: bar and anchors carry any tension")
    return found


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
        others = len(large) - 1
        several = f", as {'is' if others == 1 else 'are'} {others} other{'s' if others > 1 else ''}" if others else ""
        found.append(
            f"block '{most}' is {sizes[most]:,.4g} m long{several}, more than {LONG:g} m: check the unit of length"
        )
    small = [name for name, size in sizes.items() if size < SHORT]
    if small:
        found.append(
            f"block '{small[0]}' is {sizes[small[0]]:.4g} m long{f', and {len(small) - 1} more' if small[1:] else ''}: "
            "check the unit of length"
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
        elif turn > TURNED:
            found.append(
                f"support '{support.name}' turns '{support.body}' by {np.rad2deg(turn):.3g} degrees: where "
                "displacements are taken to be small, weights and joints keep their directions; 'concio push' turns "
                "the structure"
            )
    return found
