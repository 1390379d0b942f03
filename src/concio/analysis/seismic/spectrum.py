r"""Elastic response spectra: acceleration S_e(T, xi) and displacement S_De(T, xi), as the codes write them.

.. math::

    S_e = a_g S [1 + (T/T_B)(\eta F_0 - 1)]  (T < T_B), \quad a_g S \eta F_0, \quad a_g S \eta F_0 T_C/T, \quad
    a_g S \eta F_0 T_C T_D/T^2

and :math:`S_{De} = S_e (T/2\pi)^2` up to T_E, from where it falls to the displacement of the ground at T_F.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Spectrum:
    """An elastic response spectrum.

    Parameters
    ----------
    a_g : float
        Peak acceleration on rock [m/s2].
    S : float
        Amplification by soil and topography.
    F0 : float
        Largest amplification of the spectrum.
    T_B, T_C, T_D, T_E, T_F : float
        Corner periods [s].
    damping : tuple of float
        (numerator, added, least): eta = sqrt(numerator / (added + xi)), at least the third; xi in per cent.
    """

    a_g: float
    S: float
    F0: float
    T_B: float
    T_C: float
    T_D: float
    T_E: float
    T_F: float
    damping: tuple[float, float, float] = (10.0, 5.0, 0.55)

    def eta(self, xi: float = 5.0) -> float:
        """Return the damping factor for a damping ratio ``xi`` in per cent."""
        numerator, added, least = self.damping
        return max(math.sqrt(numerator / (added + xi)), least)

    def acceleration(self, T: Any, xi: float = 5.0) -> Array:
        """Return S_e at the periods ``T`` (n,) [s], in m/s2."""
        if isinstance(T, float):  # thousands of them: half of the time of a check, as arrays
            return np.asarray(self.a_g * self.S * self._shape(T, self.eta(xi) * self.F0))
        T = np.asarray(T, dtype=float)
        top = self.eta(xi) * self.F0
        safe = np.maximum(T, 1e-12)
        shape = np.select(
            [T < self.T_B, T < self.T_C, T < self.T_D],
            [1.0 + T / self.T_B * (top - 1.0), top * np.ones_like(T), top * self.T_C / safe],
            top * self.T_C * self.T_D / safe**2,
        )
        found: Array = self.a_g * self.S * shape
        return found

    def _shape(self, T: float, top: float) -> float:
        """Return the acceleration at one period over that of the ground; ``top`` is its largest value."""
        if T < self.T_B:
            return 1.0 + T / self.T_B * (top - 1.0)
        if T < self.T_C:
            return top
        return top * self.T_C / T if T < self.T_D else top * self.T_C * self.T_D / (T * T)

    def displacement(self, T: Any, xi: float = 5.0) -> Array:
        """Return S_De at the periods ``T`` (n,) [s], in m."""
        one = isinstance(T, float)
        T = T if one else np.asarray(T, dtype=float)
        plain: Array = self.acceleration(T, xi) * (T / (2.0 * math.pi)) ** 2
        ground = 0.025 * self.a_g * self.S * self.T_C * self.T_D
        top = self.F0 * self.eta(xi)
        if one and self.T_E >= T:
            return plain
        falling = ground * (top + (1.0 - top) * (T - self.T_E) / max(self.T_F - self.T_E, 1e-9))
        found: Array = np.select([self.T_E >= T, self.T_F >= T], [plain, falling], ground)
        return found
