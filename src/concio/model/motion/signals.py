r"""Signals: one component of the motion of the ground as a function of time, with its exact integrals.

A time step needs the *mean* acceleration of the ground in it, :math:`(v(t_1) - v(t_0)) / (t_1 - t_0)`: then the
velocity of the ground is exact whatever the step. Every signal therefore knows its velocity and displacement. Before
time zero the ground is at rest, after the end of a signal it moves on with the velocity it has then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np

from concio.arguments import strict_class
from concio.errors import InputError

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Array = np.ndarray
Quantity = Literal["acceleration", "velocity", "displacement"]

LONGEST = 60.0
"""Time between samples at most [s]."""


class Signal(Protocol):
    """One component of the motion of the ground."""

    @property
    def duration(self) -> float:
        """When it ends [s]."""

    def acceleration(self, t: Array) -> Array:
        """Return the acceleration at times t [m/s2]."""

    def velocity(self, t: Array) -> Array:
        """Return the velocity at times t [m/s]."""

    def displacement(self, t: Array) -> Array:
        """Return the displacement at times t [m]."""


def _plain(what: str, value: object, where: str) -> None:
    """Refuse a text where a plain number is needed."""
    if isinstance(value, str):
        msg = f"{what} = {value!r} is not a number"
        raise InputError(msg, where=where, hint="accelerations are in m/s2, times in s, without a unit")


@strict_class
@dataclass(frozen=True, eq=False)
class Record:
    """A sampled signal at equal steps of time.

    Accelerations and velocities are taken as straight between samples, displacements as a cubic spline.

    Parameters
    ----------
    values : (n,) array
        [m/s2, m/s or m].
    step : float
        Time between samples [s].
    quantity : {"acceleration", "velocity", "displacement"}
    name : str
    begins : float
        Time of the first sample as its file counts it [s]: the motion begins there. Components of one motion must have
        one origin of time.

    Examples
    --------
    A triangle of 2 m/s2 over 1 s ends with a velocity of 1 m/s:

    >>> import concio
    >>> import numpy as np
    >>> record = concio.Record(np.array([0.0, 2.0, 0.0]), step=0.5)
    >>> round(float(record.velocity(np.array([1.0]))[0]), 6)
    1.0
    """

    values: Array
    step: float
    quantity: Quantity = "acceleration"
    name: str = "record"
    begins: float = 0.0

    def __post_init__(self) -> None:
        where = f"record '{self.name}'"
        values = np.array(self.values, dtype=float)
        if values.ndim != 1 or len(values) < 2:
            msg = f"a record is a list of at least two values, this has the shape {values.shape}"
            raise InputError(msg, where=where)
        if not np.isfinite(values).all():
            k = int(np.flatnonzero(~np.isfinite(values))[0])
            msg = f"sample {k + 1} is not a number: the record has a gap"
            raise InputError(msg, where=where, hint="fill the gap, or cut the record before it")
        _plain("step", self.step, where)
        if not 0 < self.step <= LONGEST:
            msg = f"the time between samples, {self.step:g} s, must be positive and at most {LONGEST:g} s"
            raise InputError(msg, where=where)
        if self.quantity not in ("acceleration", "velocity", "displacement"):
            msg = f"'{self.quantity}' is not acceleration, velocity or displacement"
            raise InputError(msg, where=where)
        values.setflags(write=False)
        object.__setattr__(self, "values", values)

    @property
    def duration(self) -> float:
        """When it ends [s]."""
        return (len(self.values) - 1) * self.step

    @cached_property
    def _pieces(self) -> tuple[PPoly, PPoly, PPoly]:
        """Acceleration, velocity and displacement as piecewise polynomials."""
        from scipy.interpolate import CubicSpline, PPoly

        time = self.step * np.arange(len(self.values))
        v = self.values
        if self.quantity == "displacement":
            u = CubicSpline(time, v - v[0], bc_type="clamped")
            return u.derivative(2), u.derivative(), u
        line = PPoly(np.array([np.diff(v) / self.step, v[:-1]]), time)
        if self.quantity == "velocity":
            return line.derivative(), line, line.antiderivative()
        return line, line.antiderivative(), line.antiderivative(2)

    def acceleration(self, t: Array) -> Array:
        """Return the acceleration at times t [m/s2], zero outside the record."""
        t = np.asarray(t, dtype=float)
        return np.where((t >= 0) & (t <= self.duration), self._pieces[0](np.clip(t, 0.0, self.duration)), 0.0)

    def velocity(self, t: Array) -> Array:
        """Return the velocity at times t [m/s]."""
        t = np.asarray(t, dtype=float)
        return np.where(t >= 0, self._pieces[1](np.clip(t, 0.0, self.duration)), 0.0)

    def displacement(self, t: Array) -> Array:
        """Return the displacement at times t [m]."""
        t = np.asarray(t, dtype=float)
        end = np.maximum(t - self.duration, 0.0) * float(self._pieces[1](self.duration))
        return np.where(t >= 0, self._pieces[2](np.clip(t, 0.0, self.duration)) + end, 0.0)

    def scaled(self, factor: float) -> Record:
        """Return the record with its values times a factor."""
        return replace(self, values=factor * self.values)


@strict_class
@dataclass(frozen=True)
class Pulse:
    r"""A pulse by name; ``amplitude`` is its largest acceleration.

    Parameters
    ----------
    shape : {"rectangular", "half sine", "sine", "ricker"}
        rectangular: constant. half sine: one half wave. sine: whole waves, ``cycles`` of them. ricker:
        :math:`(1 - 2 z) e^{-z}`, :math:`z = \pi^2 f^2 (t - 1.5/f)^2`.
    amplitude : float
        [m/s2].
    length : float
        Duration of a rectangular pulse and of a half wave, period of a sine, 1/f of a Ricker pulse [s].
    cycles : float
        Waves of a sine; 1 for all others.
    name : str

    Examples
    --------
    The velocity at the end of a half sine of amplitude A and length T is 2 A T / pi:

    >>> import concio
    >>> import numpy as np
    >>> pulse = concio.Pulse("half sine", amplitude=np.pi, length=0.5)
    >>> round(float(pulse.velocity(np.array([0.5]))[0]), 6)
    1.0
    """

    shape: str
    amplitude: float
    length: float
    cycles: float = 1.0
    name: str = "pulse"

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            msg = f"there is no pulse called '{self.shape}'"
            raise InputError(msg, hint="one of: " + ", ".join(SHAPES))
        for what, value in (("amplitude", self.amplitude), ("length", self.length), ("cycles", self.cycles)):
            _plain(what, value, f"{self.shape} pulse")
        if self.cycles != 1.0 and self.shape != "sine":
            msg = f"cycles = {self.cycles:g} are those of a sine"
            raise InputError(msg, where=f"{self.shape} pulse", hint="leave cycles out, or take the pulse 'sine'")
        if not np.isfinite(self.amplitude):
            msg = "the amplitude is not finite"
            raise InputError(msg, where=f"{self.shape} pulse")
        for what, value in (("length", self.length), ("cycles", self.cycles)):
            if not 0 < value < np.inf:
                msg = f"{what} = {value:g} must be positive and finite"
                raise InputError(msg, where=f"{self.shape} pulse")

    @property
    def duration(self) -> float:
        """When it ends [s]."""
        return self.length * {"sine": self.cycles, "ricker": 3.0}.get(self.shape, 1.0)

    @property
    def step(self) -> float:
        """Largest step of time in which it is still seen: a quarter of a half wave [s]."""
        return self.length / (4.0 if self.shape in ("rectangular", "half sine") else 8.0)

    def acceleration(self, t: Array) -> Array:
        """Return the acceleration at times t [m/s2]."""
        t = np.asarray(t, dtype=float)
        a, T = self.amplitude, self.length
        value = np.full(t.shape, a)
        if self.shape == "half sine":
            value = a * np.sin(np.pi * t / T)
        elif self.shape == "sine":
            value = a * np.sin(2 * np.pi * t / T)
        elif self.shape == "ricker":
            z = (np.pi * (t / T - 1.5)) ** 2
            value = a * (1 - 2 * z) * np.exp(-z)
        return np.where((t >= 0) & (t <= self.duration), value, 0.0)

    def velocity(self, t: Array) -> Array:
        """Return the velocity at times t [m/s]."""
        t = np.clip(np.asarray(t, dtype=float), 0.0, self.duration)
        a, T = self.amplitude, self.length
        if self.shape == "half sine":
            return np.asarray(a * T / np.pi * (1 - np.cos(np.pi * t / T)))
        if self.shape == "sine":
            return np.asarray(a * T / (2 * np.pi) * (1 - np.cos(2 * np.pi * t / T)))
        if self.shape == "ricker":
            x = np.pi * (t / T - 1.5)
            return np.asarray(a * T / np.pi * (x * np.exp(-(x**2)) - _RICKER_START))
        return np.asarray(a * t)

    def displacement(self, t: Array) -> Array:
        """Return the displacement at times t [m]."""
        time = np.maximum(np.asarray(t, dtype=float), 0.0)
        t = np.minimum(time, self.duration)
        a, T = self.amplitude, self.length
        after = (time - t) * self.velocity(np.asarray(self.duration))
        if self.shape == "half sine":
            inside = a * T / np.pi * (t - T / np.pi * np.sin(np.pi * t / T))
        elif self.shape == "sine":
            inside = a * T / (2 * np.pi) * (t - T / (2 * np.pi) * np.sin(2 * np.pi * t / T))
        elif self.shape == "ricker":
            x = np.pi * (t / T - 1.5)
            first = 0.5 * (np.exp(-((1.5 * np.pi) ** 2)) - np.exp(-(x**2)))
            inside = a * T / np.pi * (T / np.pi * first - _RICKER_START * t)
        else:
            inside = 0.5 * a * t**2
        return np.asarray(inside + after)

    def scaled(self, factor: float) -> Pulse:
        """Return the pulse with another amplitude."""
        return replace(self, amplitude=factor * self.amplitude)


SHAPES = ("rectangular", "half sine", "sine", "ricker")
"""Pulses by name."""

_RICKER_START = -1.5 * np.pi * np.exp(-((1.5 * np.pi) ** 2))
