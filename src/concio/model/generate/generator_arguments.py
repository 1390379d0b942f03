"""Arguments of the generators, checked one by one, and the options all generators have in common."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, TypedDict

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.model.limits import LARGEST_BLOCKS, LARGEST_REFINEMENT
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.units import quantity

STONE = Elastic(E=5e6, nu=0.2, unit_weight=20.0)
"""Material where none is given: 5 GPa, 20 kN/m3."""


class Common(TypedDict, total=False):
    """Options that every generator takes.

    Keys
    ----
    block : Elastic, Rigid, "elastic" or "rigid"
        Material of the blocks; a word takes :data:`STONE`, or its weight alone. Default "elastic".
    friction : float, str or JointLaw
        Law of all joints; a number is a Coulomb coefficient, a text its angle: ``"31 deg"``. Default 0.6.
    base_friction : float, str or None
        Another coefficient against the ground or the abutments.
    unit_weight : float or str or None
        Weight per volume [kN/m3]; None takes the material's.
    thickness : float or str
        Out of plane [m]. Default 1 m.
    horizontal : float
        Horizontal force towards +x as a share of the self-weight, load group "live". Default 0.
    plane : {"stress", "strain"}
        Plane stress or plane strain.
    element : str
        Element family, "Q4" by default.
    mesh_size : float, str or None
        Target element size [m].
    refinement : int
        Every element is split this many times more.
    title : str
        Title of the model; by default what was made.
    """

    block: Elastic | Rigid | Literal["elastic", "rigid"]
    friction: float | str | JointLaw
    base_friction: float | str | None
    unit_weight: float | str | None
    thickness: float | str
    horizontal: float
    plane: Literal["stress", "strain"]
    element: str
    mesh_size: float | str | None
    refinement: int
    title: str


@dataclass(frozen=True)
class Checked:
    """The common options after checking; meanings as in :class:`Common`."""

    where: str
    block: Elastic | Rigid
    law: JointLaw
    base_law: JointLaw | None
    thickness: float
    horizontal: float
    plane: Literal["stress", "strain"]
    element: str
    mesh_size: float | None
    refinement: int
    title: str

    @property
    def kind(self) -> Literal["elastic", "rigid"]:
        """Kind of the blocks."""
        return "rigid" if isinstance(self.block, Rigid) else "elastic"


def checked(where: str, options: Mapping[str, Any]) -> Checked:
    """Return the common options with defaults filled in.

    Raises
    ------
    InputError
        A key that is not known, or a value out of range.
    """
    for key in options:
        if key not in Common.__annotations__:
            msg = f"unknown option '{key}'"
            raise InputError(msg, where=where, hint=closest(key, Common.__annotations__, names="common options"))
    block = options.get("block", "elastic")
    if block == "elastic":
        block = STONE
    elif block == "rigid":
        block = Rigid(STONE.unit_weight)
    if not isinstance(block, Elastic | Rigid):
        msg = f"block = {block!r} is not a material"
        raise InputError(msg, where=where, hint="give Elastic(...), Rigid(...), 'elastic' or 'rigid'")
    if options.get("unit_weight") is not None:
        block = replace(block, unit_weight=not_negative(where, "unit_weight", options["unit_weight"], "unit weight"))
    friction = options.get("friction", 0.6)
    law = friction if isinstance(friction, JointLaw) else JointLaw(quantity(friction, "friction", where="friction"))
    base_friction = options.get("base_friction")
    base_law = None if base_friction is None else replace(law, friction=base_friction)
    plane, horizontal = options.get("plane", "stress"), quantity(options.get("horizontal", 0.0), "number", where=where)
    if plane not in ("stress", "strain"):
        msg = f"plane = '{plane}' is not one of stress, strain"
        raise InputError(msg, where=where)
    if not np.isfinite(horizontal):
        msg = f"horizontal = {horizontal} must be finite"
        raise InputError(msg, where=where)
    if horizontal and not block.unit_weight:
        msg = "horizontal is a share of the self-weight, but unit_weight is zero"
        raise InputError(msg, where=where, hint="give unit_weight")
    size = options.get("mesh_size")
    return Checked(
        where,
        block,
        law,
        base_law,
        positive(where, "thickness", options.get("thickness", 1.0)),
        horizontal,
        plane,
        str(options.get("element", "Q4")),
        None if size is None else positive(where, "mesh_size", size),
        count(where, "refinement", options.get("refinement", 1), most=LARGEST_REFINEMENT),
        str(options.get("title", "")),
    )


def positive(where: str, name: str, value: float | str, kind: str = "length") -> float:
    """Return a positive finite number in kN and m."""
    number = quantity(value, kind, where=f"{where}, {name}")
    if not (0 < number < np.inf):
        msg = f"{name} = {number:g} must be positive and finite"
        raise InputError(msg, where=where)
    return number


def not_negative(where: str, name: str, value: float | str, kind: str = "length") -> float:
    """Return a finite number in kN and m that is zero or positive."""
    number = quantity(value, kind, where=f"{where}, {name}")
    if not (0 <= number < np.inf):
        msg = f"{name} = {number:g} must be zero or positive and finite"
        raise InputError(msg, where=where)
    return number


def finite(where: str, name: str, value: float | str, kind: str = "length") -> float:
    """Return a finite number in kN and m."""
    number = quantity(value, kind, where=f"{where}, {name}")
    if not np.isfinite(number):
        msg = f"{name} = {number:g} must be finite"
        raise InputError(msg, where=where)
    return number


def count(where: str, name: str, value: object, least: int = 1, most: int = LARGEST_BLOCKS) -> int:
    """Return a whole number that is at least ``least`` and at most ``most``."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        msg = f"{name} = {value!r} must be a whole number"
        raise InputError(msg, where=where)
    if value < least:
        msg = f"{name} = {value} must be at least {least}"
        raise InputError(msg, where=where)
    if value > most:
        shown = f"{value:,}" if value < 10**30 else "a number of more than 30 digits"
        msg = f"{name} = {shown} is more than {most:,}"
        raise InputError(msg, where=where, hint="is this a typing error?")
    return int(value)


def check_blocks(where: str, number: float, hint: str) -> None:
    """Refuse a structure of more than :data:`concio.model.limits.LARGEST_BLOCKS` blocks."""
    if not number <= LARGEST_BLOCKS:
        msg = f"some {number:.3g} blocks are more than {LARGEST_BLOCKS:,}"
        raise InputError(msg, where=where, hint=hint)


def check_keys(where: str, given: Iterable[str], kind: type) -> None:
    """Refuse keys that are not fields of the dataclass ``kind``.

    Raises
    ------
    InputError
        A key is not known.
    """
    known = [f.name for f in fields(kind)]
    for key in given:
        if key not in known:
            msg = f"unknown key '{key}'"
            raise InputError(msg, where=where, hint=closest(key, known))


def two(where: str, name: str, value: Sequence[Any]) -> tuple[Any, Any]:
    """Return a value that must have two parts."""
    try:
        first, second = value
    except (TypeError, ValueError):
        msg = f"{name} = {value!r} must be two values"
        raise InputError(msg, where=where) from None
    return first, second


def choice(where: str, name: str, value: object, allowed: Sequence[str]) -> str:
    """Return a word that must be one of ``allowed``."""
    if value not in allowed:
        msg = f"{name} = {value!r} is not one of {', '.join(allowed)}"
        raise InputError(msg, where=where, hint=closest(str(value), allowed))
    return str(value)
