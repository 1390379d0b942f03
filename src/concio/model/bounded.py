"""Quantities that have to be positive, or not negative."""

from __future__ import annotations

import math

from concio.errors import InputError
from concio.units import quantity


def positive(name: str, value: float | str, kind: str, where: str) -> float:
    """Return a quantity that is positive, in kN and m.

    Parameters
    ----------
    name : str
        Of the argument.
    value : float or str
        A bare number, or a number with its unit.
    kind : str
        Kind of quantity: a key of :data:`concio.units.KINDS`.
    where : str
        What it belongs to.

    Raises
    ------
    InputError
        It is not.
    """
    number = quantity(value, kind, where=f"{where}, {name}")
    if not 0 < number < math.inf:
        msg = f"{name} = {number:g} must be positive"
        raise InputError(msg, where=where)
    return number


def not_negative(name: str, value: float | str, kind: str, where: str) -> float:
    """Return a quantity that is zero or positive, in kN and m.

    Parameters
    ----------
    name : str
        Of the argument.
    value : float or str
        A bare number, or a number with its unit.
    kind : str
        Kind of quantity: a key of :data:`concio.units.KINDS`.
    where : str
        What it belongs to.

    Raises
    ------
    InputError
        It is negative.
    """
    number = quantity(value, kind, where=f"{where}, {name}")
    if not 0 <= number < math.inf:
        msg = f"{name} = {number:g} must be zero or positive"
        raise InputError(msg, where=where)
    return number
