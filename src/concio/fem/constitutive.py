"""Isotropic elasticity in the plane. Ours and tested, because its meaning must never change under a user."""

from __future__ import annotations

from typing import Literal

import numpy as np

from concio.errors import InputError
from concio.model.materials import Elastic

Array = np.ndarray


def constitutive_matrix(material: Elastic, plane: Literal["stress", "strain"]) -> Array:
    """Return D (3, 3) with sigma = D (e_x, e_y, g_xy) [kN/m2].

    Parameters
    ----------
    material : Elastic
    plane : {"stress", "strain"}

    Raises
    ------
    InputError
        The plane is neither stress nor strain.
    """
    E, nu = material.E, material.nu
    if plane not in ("stress", "strain"):
        msg = f"plane '{plane}' is neither 'stress' nor 'strain'"
        raise InputError(msg)
    if plane == "strain":
        E, nu = E / (1 - nu**2), nu / (1 - nu)
    return E / (1 - nu**2) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, (1 - nu) / 2]])


def principal(stress: Array) -> tuple[Array, Array, Array]:
    """Return (s1, s2, angle) of stresses (..., 3) = (s_x, s_y, t_xy): s1 >= s2, angle of s1 to the x axis [rad]."""
    sx, sy, txy = np.moveaxis(np.asarray(stress, dtype=float), -1, 0)
    centre, half = (sx + sy) / 2, (sx - sy) / 2
    radius = np.hypot(half, txy)
    return centre + radius, centre - radius, 0.5 * np.arctan2(txy, half)
