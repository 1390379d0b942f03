"""The paper's panel: running bond of blocks, dry or with mortar films, between rigid walls, pressed on top.

Courses are counted from below; odd ones (the first, third...) hold whole blocks, even ones begin and end with a half
block. With mortar, head joints are bodies of their own between neighbouring blocks. Bed joints are films between two
courses, continuous over the whole length (as in the paper) or cut at the middle of every head joint above and below.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal, TypeVar

import numpy as np

from concio.arguments import strict
from concio.errors import InputError
from concio.model.generate.generator_arguments import check_blocks, count
from concio.model.generate.spacing import subdivided
from concio.model.limits import LARGEST_UNKNOWNS
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Body, JointRule, Load, Model
from concio.units import quantity

Array = np.ndarray
T = TypeVar("T")
Base = Literal["full", "bearings", "none"]



@strict
def running_bond_panel(
    *,
    courses: int = 3,
    blocks: int = 3,
    block_size: Sequence[float | str] = (0.20, 0.10),
    joint: float | str = 0.0,
    thickness: float | str = 0.10,
    block: Elastic | Rigid | None = None,
    mortar: Elastic | None = None,
    friction: float | str | JointLaw = 1.0,
    wall_friction: float | str | None = None,
    base_friction: float | str | None = None,
    base: Base = "full",
    side_walls: bool = True,
    side_gap: float | str = 0.0,
    top_pressure: float | str = 0.0,
    unit_weight: float | str = 0.0,
    horizontal: float = 0.0,
    elements_per_block: tuple[int, int] = (4, 2),
    refinement: int = 1,
    plane: Literal["stress", "strain"] = "stress",
    element: str = "Q4",
    bed_mortar: Literal["continuous", "cut"] = "continuous",
) -> Model:
    """Return a running-bond panel of elastic (or rigid) blocks.

    Parameters
    ----------
    courses, blocks : int
        Number of courses, and of whole blocks in the first course.
    block_size : (length, height)
        [m].
    joint : float or str
        Thickness of head and bed joints [m]; 0 is a dry panel.
    thickness : float or str
        Out of plane [m].
    block, mortar : Elastic
        Materials; a Rigid block is allowed in a dry panel. Defaults are the paper's: E = 1e5 kN/m2, nu = 0.15.
    friction : float or JointLaw
        Law of every interface; a number is a Coulomb coefficient.
    wall_friction, base_friction : float, optional
        Other coefficients against side walls and base.
    base : {"full", "bearings", "none"}
        Rigid base under the whole panel, under the two end blocks, or none.
    side_walls : bool
        Rigid walls on both sides.
    side_gap : float or str
        Initial gap between panel and side walls [m].
    top_pressure : float or str
        Uniform pressure on top [kN/m2], load group "top".
    unit_weight : float or str
        Weight per volume of blocks and mortar [kN/m3], load group "dead"; 0 leaves the materials' own.
    horizontal : float
        Horizontal force towards +x as a share of the self-weight, load group "live".
    elements_per_block : (int, int)
        Elements along length and height of a whole block.
    refinement : int
        Each element is split this many times more in both directions.
    plane : {"stress", "strain"}
        Plane stress or plane strain.
    element : str
        Element family, see :data:`concio.fem.elements.FAMILIES`.
    bed_mortar : {"continuous", "cut"}
        Bed joints of mortar as one body along the panel, or cut at every head joint.

    Raises
    ------
    InputError
        A number is out of range.

    Examples
    --------
    The base carries a pressure of 10 kN/m2 on a panel of 0.6 by 0.1 m in plan:

    >>> import concio
    >>> model = concio.running_bond_panel(courses=4, blocks=3, thickness=0.1, top_pressure=10.0, side_walls=False)
    >>> result = concio.solve(model)
    >>> round(float(result.reactions["base"][1]), 6)
    0.6
    """
    where = "panel"
    n_c, n_b, refine = (_count(v, n) for v, n in ((courses, "courses"), (blocks, "blocks"), (refinement, "refinement")))
    nx, ny = (_count(v, "elements_per_block") for v in _two(elements_per_block, "elements_per_block"))
    check_blocks(where, n_c * n_b, "use a smaller panel")
    unknowns = 2 * n_c * n_b * nx * ny * refine**2
    if unknowns > LARGEST_UNKNOWNS and not isinstance(block, Rigid):
        msg = f"{n_c * n_b:,} blocks of {nx * refine:,} x {ny * refine:,} elements are too many"
        hint = f"at most {LARGEST_UNKNOWNS:,} unknowns: use fewer elements_per_block or a smaller refinement"
        raise InputError(msg, where=where, hint=hint)
    length, height = (quantity(v, "length", where="block_size") for v in _two(block_size, "block_size"))
    t_m = quantity(joint, "length", where="joint")
    depth = quantity(thickness, "length", where="thickness")
    gap = quantity(side_gap, "length", where="side_gap")
    pressure = quantity(top_pressure, "stress", where="top_pressure")
    weight = quantity(unit_weight, "unit weight", where="unit_weight")
    for name, value, least in (
        ("block length", length, 1e-9),
        ("block height", height, 1e-9),
        ("thickness", depth, 1e-9),
        ("joint", t_m, 0.0),
        ("side_gap", gap, 0.0),
        ("unit_weight", weight, 0.0),
    ):
        if not (least <= value < np.inf):
            msg = f"{name} = {value:g} must be {'positive' if least else 'zero or positive'} and finite"
            raise InputError(msg, where=where)
    if not np.isfinite(pressure) or not np.isfinite(horizontal):
        msg = "top_pressure and horizontal must be finite"
        raise InputError(msg, where=where)
    if t_m >= length:
        msg = f"the joint ({t_m:g} m) is not thinner than a block is long ({length:g} m)"
        raise InputError(msg, where=where, hint="joint and block_size are lengths in m")
    if base not in ("full", "bearings", "none"):
        msg = f"base '{base}' is not one of full, bearings, none"
        raise InputError(msg, where=where)
    if bed_mortar not in ("continuous", "cut"):
        msg = f"bed_mortar '{bed_mortar}' is not one of continuous, cut"
        raise InputError(msg, where=where)
    if base == "none" and not side_walls:
        msg = "no base and no side walls: nothing holds the panel"
        raise InputError(msg, where=where, hint="set base = 'full' or side_walls = true")
    block = block if block is not None else Elastic(E=1e5, nu=0.15)
    mortar = mortar if mortar is not None else Elastic(E=1e5, nu=0.15)
    if isinstance(block, Rigid) and t_m > 0:
        msg = "rigid blocks with elastic mortar films are not a running-bond panel concio makes"
        raise InputError(msg, where=where, hint="use joint = 0 and a joint law with stiffness")
    if weight:
        block, mortar = replace(block, unit_weight=weight), replace(mortar, unit_weight=weight)

    bodies, width, top = _bodies(n_c, n_b, length, height, t_m, depth, block, (nx, ny), bed_mortar)
    bodies += _obstacles(base, side_walls, width, top, length, depth)
    law = friction if isinstance(friction, JointLaw) else JointLaw(quantity(friction, "friction", where="friction"))
    laws, rules = {"joint": law}, [JointRule("joint")]
    for role, coefficient, opening in (("side wall", wall_friction, gap), ("base", base_friction, 0.0)):
        if (coefficient is not None or opening) and not any(b.role == role for b in bodies):
            msg = f"{'side_gap' if opening else role.split()[-1] + '_friction'} is given, but there is no {role}"
            raise InputError(msg, where=where, hint="leave it out")
        if coefficient is not None or opening:
            given = law.friction if coefficient is None else quantity(coefficient, "friction", where=f"{role} friction")
            laws[role] = replace(law, friction=given)
            rules.append(JointRule(role, (role, "*"), opening))
    loads = []
    if block.unit_weight or (t_m and mortar.unit_weight):
        loads.append(Load("weight", (0.0, -1.0), group="dead"))
        if horizontal:
            loads.append(Load("weight", (horizontal, 0.0), group="live"))
    elif horizontal:
        msg = "horizontal is a share of the self-weight, but unit_weight is zero"
        raise InputError(msg, where=where, hint="give unit_weight")
    if pressure:
        loads.append(Load("pressure", (pressure,), edge=((0.0, top), (width, top)), group="top"))
    films = f"mortar {t_m:g} m" if t_m else "dry"
    return Model(
        bodies=tuple(bodies),
        materials={"block": block, "mortar": mortar} if t_m else {"block": block},
        laws=laws,
        rules=tuple(rules),
        loads=tuple(loads),
        plane=plane,
        element=element,
        refinement=refine,
        title=f"running-bond panel, {n_c} courses of {n_b} blocks, {films}",
        generator={
            "kind": "panel", "courses": n_c, "blocks": n_b, "block_size": [length, height], "joint": t_m,
            "width": width, "height": top, "base": base,
        },
    )


def _two(value: Sequence[T], name: str) -> tuple[T, T]:
    try:
        first, second = value
    except (TypeError, ValueError):
        msg = f"{name} = {value!r} must be two values"
        raise InputError(msg, where="panel") from None
    return first, second


def _count(value: object, name: str) -> int:
    return count("panel", name, value)


def _rectangle(x0: float, x1: float, y0: float, y1: float) -> Array:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _course_edges(whole: bool, blocks: int, length: float, joint: float) -> list[tuple[float, float]]:
    """Return where the blocks of a course begin and end."""
    pitch = length + joint
    if whole:
        return [(k * pitch, k * pitch + length) for k in range(blocks)]
    half = (length - joint) / 2
    width = blocks * pitch - joint
    inner = [(half + joint + k * pitch, half + joint + k * pitch + length) for k in range(blocks - 1)]
    return [(0.0, half), *inner, (width - half, width)]


def _bodies(
    courses: int,
    blocks: int,
    length: float,
    height: float,
    joint: float,
    depth: float,
    block: Elastic | Rigid,
    elements: tuple[int, int],
    bed_mortar: str,
) -> tuple[list[Body], float, float]:
    """Return blocks and mortar films, the width and the height of the panel."""
    width = blocks * (length + joint) - joint
    patterns = [_course_edges(True, blocks, length, joint), _course_edges(False, blocks, length, joint)]
    marks = [x for edges in patterns for pair in edges for x in pair]
    centres = [np.array([(p[1] + q[0]) / 2 for p, q in pairwise(edges)]) for edges in patterns]
    cuts = np.unique(np.concatenate(centres)) if bed_mortar == "cut" else np.zeros(0)
    unit = 1e-9 * length
    places = np.sort(np.concatenate([marks, cuts]))
    places = places[np.concatenate([[True], np.diff(places) > unit])]
    lines = subdivided(places, length / elements[0])

    def between(a: float, b: float) -> Array:
        picked: Array = lines[(lines >= a - unit) & (lines <= b + unit)]
        return picked

    def snapped(x: float) -> float:
        """Return the one value that stands for all computed values of a place."""
        return float(places[np.argmin(np.abs(places - x))])

    kind: Literal["elastic", "rigid"] = "rigid" if isinstance(block, Rigid) else "elastic"
    bodies: list[Body] = []
    digits = (len(str(courses)), len(str(blocks + 1)))

    def add(name: str, a: float, b: float, ys: Array, material: str) -> None:
        a, b = snapped(a), snapped(b)
        grid = (between(a, b), ys) if material == "mortar" or kind == "elastic" else None
        outline = _rectangle(a, b, ys[0], ys[-1])
        body_kind = kind if material == "block" else "elastic"
        bodies.append(Body(name, outline, material, body_kind, role=material, thickness=depth, grid=grid))

    y = 0.0
    for c in range(courses):
        ys = y + height * np.linspace(0.0, 1.0, elements[1] + 1)
        edges = patterns[c % 2]
        for k, (a, b) in enumerate(edges):
            label = f"c{c + 1:0{digits[0]}d}-"
            add(f"{label}b{k + 1:0{digits[1]}d}", a, b, ys, "block")
            if joint and k + 1 < len(edges):
                add(f"{label}h{k + 1:0{digits[1]}d}", b, edges[k + 1][0], ys, "mortar")
        y = float(ys[-1])
        if joint and c + 1 < courses:
            ends = np.concatenate([[0.0], cuts, [width]])
            for k, (a, b) in enumerate(pairwise(ends)):
                name = f"bed{c + 1:0{digits[0]}d}" + (f"-{k + 1}" if len(cuts) else "")
                add(name, float(a), float(b), np.array([y, y + joint]), "mortar")
            y += joint
    return bodies, width, y


def _obstacles(base: str, side_walls: bool, width: float, top: float, length: float, depth: float) -> list[Body]:
    size = 0.15 * max(top, length)
    found = []
    if base == "full":
        found.append(("base", "base", _rectangle(0.0, width, -size, 0.0)))
    elif base == "bearings":
        found.append(("left bearing", "base", _rectangle(0.0, length, -size, 0.0)))
        found.append(("right bearing", "base", _rectangle(width - length, width, -size, 0.0)))
    if side_walls:
        found.append(("left wall", "side wall", _rectangle(-size, 0.0, 0.0, top)))
        found.append(("right wall", "side wall", _rectangle(width, width + size, 0.0, top)))
    return [Body(name, outline, "", "fixed", role=role, thickness=depth) for name, role, outline in found]
