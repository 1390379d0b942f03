"""Stresses and strains in the plane as three components, turned from axes to axes."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def rotation(angle: float) -> Array:
    """Return T (3, 3): stresses (xx, yy, xy) in axes turned anticlockwise by ``angle`` [rad] are T times the old ones.

    Strains with the engineering shear turn by the inverse of its transpose, moduli become T A T'.
    """
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c * c, s * s, 2 * c * s], [s * s, c * c, -2 * c * s], [-c * s, c * s, c * c - s * s]])


def stress_at(first: float, second: float, angle: float) -> Array:
    """Return the stress (3,) whose principal values act along an axis ``angle`` [rad] from x and across it."""
    found: Array = rotation(-angle) @ np.array([first, second, 0.0])
    return found
