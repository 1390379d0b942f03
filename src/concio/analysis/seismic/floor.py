r"""Spectra at height: what a mechanism feels on an upper storey, filtered by the modes of the building.

For each mode k of the building, with period T_k and damping xi_k:

.. math::

    a_{Z,k} = S_e(T_k, \xi_k) |\gamma_k \psi_k(z)| \sqrt{1 + 0.0004 \xi_k^2}, \qquad
    K = 1.1 \xi_k^{-0.5} \eta(\xi)

with xi_k in per cent under the root and as a fraction in K: read with one and the same unit, K < 1 would make the
spectrum negative. Around T_k the plateau K a_Z,k is met from below with the power 1.6 and left with the power 1.2;
modes are combined by the square root of the sum of squares; for T > T_1 the spectrum of the ground is the least.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from concio.analysis.seismic.spectrum import Spectrum
from concio.errors import InputError

Array = np.ndarray


@dataclass(frozen=True)
class Mode:
    """A mode of the building.

    Parameters
    ----------
    T : float
        Period [s].
    participation : float
        gamma.
    shape : float
        psi(z) at the height of the mechanism.
    xi : float
        Damping ratio in per cent.

    Examples
    --------
    >>> import concio
    >>> from concio.seismic import Mode
    >>> mode = Mode(T=0.25, participation=1.2, shape=0.5, xi=10.0)
    >>> site = concio.Site({"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}, building=(mode,))
    >>> site.building[0].T
    0.25
    """

    T: float
    participation: float
    shape: float
    xi: float = 5.0

    def __post_init__(self) -> None:
        for name, value in (("T", self.T), ("xi", self.xi)):
            if not 0 < value < math.inf:
                msg = f"{name} = {value:g} of a mode must be positive"
                raise InputError(msg)


@dataclass(frozen=True)
class Storeys:
    """First mode of a regular building: gamma = 3 n/(2 n + 1), psi = z/H.

    Parameters
    ----------
    height : float
        H [m].
    storeys : int
        n.
    T1 : float, optional
        Period [s]; by default that of the height alone, as the code's table ``[floor]`` says.
    xi : float
        Damping ratio in per cent.
    base : float
        Level of the ground in the model [m].

    Examples
    --------
    The participation of the first mode of two storeys is 3 * 2 / (2 * 2 + 1), and its shape half-way up 1/2:

    >>> from concio.seismic import Storeys
    >>> building = Storeys(height=6.0, storeys=2, T1=0.25)
    >>> mode = building.mode(3.0, {})
    >>> mode.participation, mode.shape
    (1.2, 0.5)
    """

    height: float
    storeys: int = 1
    T1: float | None = None
    xi: float = 5.0
    base: float = 0.0

    def __post_init__(self) -> None:
        if not (0 < self.height < math.inf and self.storeys >= 1 and float(self.storeys).is_integer()):
            msg = f"a building of {self.storeys:g} storeys and a height of {self.height:g} m"
            raise InputError(msg, hint="height in m, and a whole number of storeys")
        Mode(1.0 if self.T1 is None else self.T1, 1.0, 1.0, self.xi)

    def mode(self, z: float, rules: Mapping[str, Any]) -> Mode:
        """Return the mode at the height ``z`` [m] under the code's table ``[floor]``."""
        n, share = self.storeys, min(max((z - self.base) / self.height, 0.0), 1.0)
        T1 = rules["period"]["factor"] * self.height ** rules["period"]["power"] if self.T1 is None else self.T1
        return Mode(T1, 3.0 * n / (2.0 * n + 1.0), share, self.xi)


@dataclass(frozen=True)
class FloorSpectrum:
    """The spectrum at the height of a mechanism.

    Parameters
    ----------
    ground : Spectrum
    modes : tuple of Mode
        The first mode first.
    rules : mapping
        Table ``[floor]`` of the code.
    """

    ground: Spectrum
    modes: tuple[Mode, ...]
    rules: Mapping[str, Any]

    def peak(self, mode: Mode) -> float:
        """Return a_Z,k [m/s2]."""
        own = float(self.ground.acceleration(mode.T, mode.xi))
        spread = math.sqrt(1.0 + self.rules["velocity_damping"] * mode.xi**2)
        return own * abs(mode.participation * mode.shape) * spread

    def amplification(self, mode: Mode, xi: float) -> float:
        """Return K for an element damped by ``xi`` per cent."""
        rule = self.rules["amplification"]
        return float(rule["factor"] * (mode.xi / 100.0) ** rule["power"] * self.ground.eta(xi))

    def filtered(self, T: Any, xi: float = 5.0) -> Array:
        """Return what the modes alone bring to the height at the periods ``T`` (n,) [s], in m/s2."""
        low, high = self.rules["lower"], self.rules["upper"]
        if isinstance(T, float):
            return np.asarray(math.sqrt(sum(self._of_mode(m, T, xi, low, high) ** 2 for m in self.modes)))
        T = np.asarray(T, dtype=float)
        squares = np.zeros_like(T)
        for mode in self.modes:
            K, a = self.amplification(mode, xi), self.peak(mode)
            before, after = low["share"] * mode.T, high["share"] * mode.T
            rising = 1.0 + (K - 1.0) * np.maximum(1.0 - T / before, 0.0) ** low["power"]
            falling = 1.0 + (K - 1.0) * np.maximum(T / after - 1.0, 0.0) ** high["power"]
            squares += (K * a / np.where(before > T, rising, np.where(after < T, falling, 1.0))) ** 2
        found: Array = np.sqrt(squares)
        return found

    def _of_mode(self, mode: Mode, T: float, xi: float, low: Mapping[str, float], high: Mapping[str, float]) -> float:
        """Return what one mode brings at one period [m/s2]."""
        K, a = self.amplification(mode, xi), self.peak(mode)
        before, after = low["share"] * mode.T, high["share"] * mode.T
        less = 1.0
        if before > T:
            less = 1.0 + (K - 1.0) * (1.0 - T / before) ** low["power"]
        elif after < T:
            less = 1.0 + (K - 1.0) * (T / after - 1.0) ** high["power"]
        return K * a / less

    def acceleration(self, T: Any, xi: float = 5.0) -> Array:
        """Return S_eZ at the periods ``T`` (n,) [s], in m/s2: beyond T_1 not less than on the ground."""
        if isinstance(T, float):
            own, beyond = self.filtered(T, xi), self.modes[0].T < T
            return np.maximum(own, self.ground.acceleration(T, xi)) if beyond else own
        T = np.asarray(T, dtype=float)
        least = np.where(self.modes[0].T < T, self.ground.acceleration(T, xi), 0.0)
        found: Array = np.maximum(self.filtered(T, xi), least)
        return found

    def displacement(self, T: Any, xi: float = 5.0) -> Array:
        """Return the displacement demand S_eZ T^2/(4 pi^2) at ``T`` (n,), in m; beyond b T_1 not less than there."""
        T = np.asarray(T, dtype=float)
        plain = self.acceleration(T, xi) * (T / (2.0 * math.pi)) ** 2
        T_b = self.rules["height"]["b"] * self.modes[0].T
        at = float(self.acceleration(self.modes[0].T, xi)) * (T_b / (2.0 * math.pi)) ** 2
        found: Array = np.where(T_b < T, np.maximum(plain, at), plain)
        return found
