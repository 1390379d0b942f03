r"""The elastic branch of the capacity curve of elements that are free to vibrate before they rock.

Parapets, chimneys, gables, pinnacles answer as elastic beams until their mechanism forms. Their curve begins with

.. math::

    a = \frac{4\pi^2}{T_0^2}\,d, \qquad T_0 = \kappa\,\lambda\,L \sqrt{\frac{W}{E g}}, \qquad \lambda = L/t

up to where it meets that of the mechanism, at :math:`(d_y, a_y)`; L is the length of the element, t its thickness, W
the weight of its masonry per volume and E the modulus of the masonry. It is the first period of a beam of constant
rectangular section: :math:`\kappa = 4\pi\sqrt 3/\beta^2` with :math:`\beta = 1.8751` of a cantilever and
:math:`\beta = \pi` of a simple beam, rounded by the code to 6.2 and 2.2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from concio.analysis.seismic.code import Code
from concio.analysis.seismic.curve import CapacityCurve
from concio.analysis.seismic.macro_blocks import Mechanics
from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.model.model import Model
from concio.units import quantity

Array = np.ndarray

SOFTEST, STIFFEST = 1e4, 1e8
"""Moduli of masonry lie between these [kN/m2]."""


@strict_class
@dataclass(frozen=True)
class FreeStanding:
    """An element that is free to vibrate: what its elastic period depends on.

    Parameters
    ----------
    kind : str
        How it is held, as the code's table ``[free_standing]`` says: "cantilever" or "supported".
    E : float
        Modulus of the masonry [kN/m2]; the code suggests a reduced one, for cracks.
    length : float, optional
        L [m]; by default the height of the blocks that move.
    thickness : float, optional
        t [m]; by default how far the blocks that move reach along the push.
    unit_weight : float, optional
        W [kN/m3]; by default the weight of the blocks that move over their volume.

    Examples
    --------
    >>> from concio.seismic import FreeStanding
    >>> parapet = FreeStanding("cantilever", E="900 MPa", thickness="30 cm")
    >>> round(parapet.E), round(parapet.thickness, 6)
    (900000, 0.3)
    """

    kind: str
    E: float
    length: float | None = None
    thickness: float | None = None
    unit_weight: float | None = None

    def __post_init__(self) -> None:
        kinds = {"E": "stress", "length": "length", "thickness": "length", "unit_weight": "unit weight"}
        for name, kind in kinds.items():
            if getattr(self, name) is None:
                continue
            value = quantity(getattr(self, name), kind, where=name)
            object.__setattr__(self, name, value)
            if not 0 < value < math.inf:
                msg = f"{name} = {value:g} must be positive"
                raise InputError(msg)
        if not SOFTEST <= self.E <= STIFFEST:
            msg = f"E = {self.E:g} kN/m2 is not a modulus of masonry"
            raise InputError(msg, hint='in kN/m2, or a text with a unit: "900 MPa"')


@dataclass(frozen=True)
class ElasticBranch:
    """The elastic branch of a mechanism.

    Parameters
    ----------
    kind : str
    kappa : float
    E, length, thickness, unit_weight : float
        As they were used [kN/m2], [m], [m], [kN/m3].
    T0 : float
        Period [s].
    d : float
        d_y, where it meets the curve of the mechanism [m].
    a : float
        a_y [m/s2].
    xi : float
        Damping of the element until then [%].
    """

    kind: str
    kappa: float
    E: float
    length: float
    thickness: float
    unit_weight: float
    T0: float
    d: float
    a: float
    xi: float

    @property
    def slenderness(self) -> float:
        """L / t."""
        return self.length / self.thickness

    @property
    def stiffness(self) -> float:
        """Spectral acceleration over displacement, 4 pi^2 / T0^2 [1/s2]."""
        return (2.0 * math.pi / self.T0) ** 2

    def summary(self) -> dict[str, float | str]:
        """Return its numbers."""
        return {
            "kind": self.kind, "kappa": self.kappa, "L": self.length, "t": self.thickness, "W": self.unit_weight,
            "E": self.E, "T0": self.T0, "d_y": self.d, "a_y": self.a,
        }  # fmt: skip


def elements_of(given: Mapping[str, Any], names: tuple[str, ...], rules: Code) -> dict[str, FreeStanding]:
    """Return the free-standing elements by the mechanism that they are.

    Parameters
    ----------
    given : mapping
        For the name of a mechanism a :class:`FreeStanding`, or its arguments.
    names : tuple of str
        Of all mechanisms sought.
    rules : Code

    Raises
    ------
    InputError
        There is no such mechanism; or something in it is not known, or is not a number of masonry.
    """
    found = {}
    for name, value in given.items():
        where = f"free-standing '{name}'"
        if name not in names:
            msg = f"there is no mechanism '{name}'"
            raise InputError(msg, where=where, hint=closest(name, names, names="mechanisms"))
        if "free_standing" not in rules.tables:
            msg = f"{rules.name} has no elastic branch of free-standing elements"
            raise InputError(msg, where=where, hint="add a table [free_standing] to the code, or leave this one out")
        try:
            element = value if isinstance(value, FreeStanding) else FreeStanding(**value)
        except InputError as error:
            raise InputError(error.what, where=where, hint=error.hint) from None
        known = tuple(rules.tables["free_standing"]["kappa"])
        if element.kind not in known:
            msg = f"there is no kind '{element.kind}'"
            raise InputError(msg, where=where, hint=closest(element.kind, known, names="kinds"))
        found[name] = element
    return found


def branch_of(
    element: FreeStanding, rules: Code, model: Model, mechanics: Mechanics, along: Array, curve: CapacityCurve | None,
    *, onset: float, spectral: float, factor: float,
) -> ElasticBranch:  # fmt: skip
    """Return the elastic branch of a mechanism, up to where it meets its capacity curve.

    Parameters
    ----------
    element : FreeStanding
    rules : Code
    model : Model
    mechanics : Mechanics
    along : (d,) array
        Direction of the push.
    curve : CapacityCurve or None
        None where there is none: a_y is a_0* then.
    onset : float
        a_0* [m/s2].
    spectral, factor : float
        Spectral displacement over that of the control point; spectral acceleration over alpha [m/s2].
    """
    bodies = [model.bodies[b] for b in mechanics.of_body]
    points = np.vstack([np.asarray(b.vertices) for b in bodies])
    volumes = np.array([b.volume for b in bodies])
    weights = np.array([model.materials[b.material].unit_weight for b in bodies])
    L = float(np.ptp(points[:, -1])) if element.length is None else element.length
    t = float(np.ptp(points @ along)) if element.thickness is None else element.thickness
    W = float(volumes @ weights / volumes.sum()) if element.unit_weight is None else element.unit_weight
    if W <= 0:
        msg = "the blocks that move have no weight, which the elastic period of a free-standing element depends on"
        raise InputError(msg, hint="give it a unit_weight")
    rule = rules.tables["free_standing"]
    kappa = float(rule["kappa"][element.kind])
    T0 = kappa * (L / t) * L * math.sqrt(W / (element.E * rules.gravity))
    stiffness = (2.0 * math.pi / T0) ** 2
    d, a = onset / stiffness, onset
    if curve is not None and curve.ends:
        d, a = _meeting(spectral * curve.displacement, factor * curve.multiplier, stiffness)
    return ElasticBranch(element.kind, kappa, element.E, L, t, W, T0, d, a, float(rule["damping"]))


def _meeting(d: Array, a: Array, stiffness: float) -> tuple[float, float]:
    """Return where the line of a stiffness from the origin first meets a curve that begins above it and ends at 0."""
    over = a - stiffness * d
    k = int(np.argmax(over <= 0.0))
    share = float(over[k - 1] / (over[k - 1] - over[k])) if k else 0.0
    at = float(d[k - 1] + share * (d[k] - d[k - 1])) if k else float(d[0])
    return at, stiffness * at
