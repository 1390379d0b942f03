"""Materials of bodies and laws of joints, checked when they are made."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from concio.arguments import strict_class
from concio.errors import InputError
from concio.units import quantity

LARGEST_EXPANSION = 1e-3
"""Strains for each kelvin from this on are mistakes of the unit [1/K]."""


def _number(value: float | str, kind: str, name: str) -> float:
    number = quantity(value, kind, where=name)
    if math.isnan(number):
        msg = f"{name} is not a number"
        raise InputError(msg, hint="give a finite value")
    return number


def _check_weight(unit_weight: float) -> None:
    if not (0 <= unit_weight < math.inf):
        msg = f"unit_weight = {unit_weight:g} must be zero or positive"
        raise InputError(msg, hint="weight acts downwards by itself; give it as a positive number")


def _check_expansion(expansion: float) -> None:
    if not (0 <= expansion < LARGEST_EXPANSION):
        msg = f"expansion = {expansion:g} must be zero or positive and below {LARGEST_EXPANSION:g} for each kelvin"
        raise InputError(msg, hint="masonry has some 5e-6 to 1e-5 for each kelvin")


@strict_class
@dataclass(frozen=True)
class Elastic:
    """Isotropic linear elastic material.

    Parameters
    ----------
    E : float or str
        Young's modulus > 0 [kN/m2], or with a unit: ``"2 GPa"``.
    nu : float
        Poisson's ratio, -1 < nu < 0.5.
    unit_weight : float or str
        Weight per volume >= 0 [kN/m3], or the mass: ``"2100 kg/m3"``.
    expansion : float or str
        Strain for each kelvin >= 0 [1/K], for :class:`concio.Temperature`; brick has some 6e-6, limestone 5e-6 to 9e-6.

    Raises
    ------
    InputError
        A constant is not finite or out of its range.

    Examples
    --------
    >>> import concio
    >>> limestone = concio.Elastic(E="20 GPa", nu=0.2, unit_weight="2300 kg/m3")
    >>> round(limestone.E), round(limestone.unit_weight, 3)
    (20000000, 22.555)
    """

    E: float
    nu: float = 0.2
    unit_weight: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", _number(self.E, "stress", "Young's modulus E"))
        object.__setattr__(self, "nu", _number(self.nu, "number", "Poisson's ratio nu"))
        object.__setattr__(self, "unit_weight", _number(self.unit_weight, "unit weight", "unit_weight"))
        object.__setattr__(self, "expansion", _number(self.expansion, "expansion", "expansion"))
        if not (0 < self.E < math.inf):
            msg = f"Young's modulus E = {self.E:g} must be positive and finite"
            raise InputError(msg, hint="give E in kN/m2 or with a unit, for example '2 GPa'")
        if not (-1 < self.nu < 0.5):
            msg = f"Poisson's ratio nu = {self.nu:g} must lie between -1 and 0.5"
            raise InputError(msg, hint="masonry lies near 0.15 to 0.25; nu = 0.5 is incompressible")
        _check_weight(self.unit_weight)
        _check_expansion(self.expansion)


@strict_class
@dataclass(frozen=True)
class Rigid:
    """Material of a body that does not deform: three unknowns in the plane.

    Parameters
    ----------
    unit_weight : float or str
        Weight per volume >= 0 [kN/m3].
    expansion : float or str
        Strain for each kelvin >= 0 [1/K]: it does not deform under forces, and expands where it is warmed.

    Examples
    --------
    A mass per volume becomes a weight under 9.80665 m/s2:

    >>> import concio
    >>> round(concio.Rigid("2000 kg/m3").unit_weight, 4)
    19.6133
    """

    unit_weight: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "unit_weight", _number(self.unit_weight, "unit weight", "unit_weight"))
        object.__setattr__(self, "expansion", _number(self.expansion, "expansion", "expansion"))
        _check_weight(self.unit_weight)
        _check_expansion(self.expansion)


@strict_class
@dataclass(frozen=True)
class JointLaw:
    """Law of an interface between two bodies; strengths are stresses, integrated over tributary areas later.

    Parameters
    ----------
    friction : float or str
        Coulomb coefficient mu >= 0, or its angle: ``"31 deg"``.
    cohesion : float or str
        Shear strength without compression c >= 0 [kN/m2].
    tensile_strength : float or str
        Tensile strength >= 0 [kN/m2], at most cohesion / friction.
    dilatancy : float or str
        tan(psi), 0 <= tan(psi) <= mu; opening for each unit of slip. Or the angle psi: ``"5 deg"``.
    normal_stiffness, tangential_stiffness : float, str or None
        Stiffness of a compliant joint [kN/m3]; None is a hard joint.
    compressive_strength : float, str or None
        Largest contact pressure [kN/m2]; None is unlimited.
    changes : tuple of callable
        What changes the constants with what the joint has undergone: each takes the constants of k contact points and
        what they have undergone (:class:`concio.analysis.changing_laws.Undergone`), and returns the constants. Only
        :func:`concio.solve` treats them; everything else refuses a model that has any.

    Examples
    --------
    >>> import concio
    >>> law = concio.JointLaw(friction="30 deg", cohesion="0.1 MPa")
    >>> round(law.friction, 4), round(law.cohesion, 6)
    (0.5774, 100.0)
    """

    friction: float
    cohesion: float = 0.0
    tensile_strength: float = 0.0
    dilatancy: float = 0.0
    normal_stiffness: float | None = None
    tangential_stiffness: float | None = None
    compressive_strength: float | None = None
    changes: tuple[Callable[..., Any], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "changes", tuple(self.changes))
        if not all(callable(change) for change in self.changes):
            msg = "changes holds something that cannot be called"
            raise InputError(msg, hint="give functions of the constants and of what the joint has undergone")
        kinds = {
            "friction": "friction",
            "cohesion": "stress",
            "tensile_strength": "stress",
            "dilatancy": "friction",
            "normal_stiffness": "joint stiffness",
            "tangential_stiffness": "joint stiffness",
            "compressive_strength": "stress",
        }
        for name, kind in kinds.items():
            value = getattr(self, name)
            if value is None:
                continue
            number = _number(value, kind, name)
            object.__setattr__(self, name, number)
            optional = kind == "joint stiffness" or name == "compressive_strength"
            if number < 0 or math.isinf(number) or (optional and number == 0):
                msg = f"{name} = {number:g} must be {'positive' if optional else 'zero or positive'} and finite"
                raise InputError(msg, hint="leave it out for a hard joint" if optional else None)
        if self.dilatancy > self.friction:
            msg = f"dilatancy tan(psi) = {self.dilatancy:g} exceeds friction {self.friction:g}"
            raise InputError(msg, hint="a dilatancy above the friction would create energy")
        if self.friction * self.tensile_strength > self.cohesion * (1 + 1e-12):
            msg = (
                f"tensile_strength = {self.tensile_strength:g} needs cohesion of at least "
                f"friction x tensile_strength = {self.friction * self.tensile_strength:g}"
            )
            raise InputError(msg, hint="raise the cohesion or lower the tensile strength")
