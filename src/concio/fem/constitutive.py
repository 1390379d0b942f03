"""Isotropic elasticity, plane and in space. Ours and tested, because its meaning must never change under a user."""

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


def solid_matrix(material: Elastic) -> Array:
    """Return D (6, 6) with sigma = D (e_x, e_y, e_z, g_xy, g_yz, g_xz) [kN/m2]."""
    E, nu = material.E, material.nu
    shear = E / (2 * (1 + nu))
    D = np.diag([2 * shear] * 3 + [shear] * 3)
    D[:3, :3] += E * nu / ((1 + nu) * (1 - 2 * nu))
    return D


def principal_in_space(stress: Array) -> tuple[Array, Array]:
    """Return principal stresses (..., 3), s1 >= s2 >= s3, and their unit directions (..., 3, 3), one a row.

    Parameters
    ----------
    stress : (..., 6) array
        (s_x, s_y, s_z, t_xy, t_yz, t_xz); where a component is nan all results are.
    """
    s = np.asarray(stress, dtype=float)
    index = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
    tensor = s[..., index]
    known = np.isfinite(tensor).all((-1, -2))
    values, vectors = np.linalg.eigh(np.where(known[..., None, None], tensor, 0.0))
    values, vectors = values[..., ::-1], np.swapaxes(vectors[..., ::-1], -1, -2)
    values = np.where(known[..., None], values, np.nan)
    return values, np.where(known[..., None, None], vectors, np.nan)
