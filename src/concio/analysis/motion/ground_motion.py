"""The ground in a motion: its components, as inertia forces or as a moving base."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from concio.analysis.motion.scheme import Drive
from concio.errors import InputError
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import rotated, rotation_matrix
from concio.kinematics.spins import rotation_vector
from concio.model.motion.records import STANDARD_GRAVITY, attention, read_record
from concio.model.motion.signals import Pulse, Record, Signal

Array = np.ndarray
Motion: TypeAlias = "Signal | Path | str | Mapping[str, Signal | Path | str] | None"
"""A signal or the name of a record along x, or signals by component "x", "y", in space also "z".

"rz", in space also "rx" and "ry", are rotations.
"""


AXES = {2: "xy", 3: "xyz"}
"""Components by dimension; the last one is vertical."""

TURNS: dict[int, tuple[str, ...]] = {2: ("rz",), 3: ("rx", "ry", "rz")}
"""Rotations by dimension: anticlockwise in the plane, in space the components of a rotation vector."""

WHICH = {2: "x is horizontal, y vertical", 3: "x and y are horizontal, z vertical"}


APART = 0.01
"""Share by which durations of records that belong together may differ."""


@dataclass(frozen=True, eq=False)
class Ground:
    """Motion of the ground.

    Parameters
    ----------
    components : tuple of Signal or None
        Along x and y, in space also z.
    scale : float
        Factor of all of them.
    turns : tuple of Signal or None
        Rotation of the base, that of its rotation vector in space [rad].
    pivot : (d,) array or float
        About which it turns, before it is moved [m]: the origin of the coordinates of the user.
    """

    components: tuple[Signal | None, ...]
    scale: float = 1.0
    turns: tuple[Signal | None, ...] = ()
    pivot: Array | float = 0.0

    @classmethod
    def of(cls, motion: Motion, scale: float = 1.0, dim: int = 2, pivot: Array | float = 0.0) -> Ground:
        """Return the motion that a user asked for; rotations are about ``pivot`` (d,) [m].

        Raises
        ------
        InputError
            A component is not known, a record cannot be read, or the scale is not finite.
        """
        if not np.isfinite(scale):
            msg = f"scale = {scale:g} is not finite"
            raise InputError(msg, hint="1 takes the record as it is")
        given = dict(motion) if isinstance(motion, Mapping) else {} if motion is None else {"x": motion}
        for name in given:
            if name not in (*AXES[dim], *TURNS[dim]):
                where = "the plane" if dim == 2 else "space"
                msg = f"there is no component '{name}' of a ground motion in {where}"
                raise InputError(msg, hint=WHICH[dim])
        signals = {name: _signal(given.get(name)) for name in (*AXES[dim], *TURNS[dim])}
        _refuse_other_origins(signals)
        turns = tuple(signals[name] for name in TURNS[dim])
        return cls(tuple(signals[name] for name in AXES[dim]), float(scale), turns, pivot)

    @property
    def turning(self) -> bool:
        """Whether the base turns."""
        return any(signal is not None for signal in self.turns)

    def rotation(self, time: float) -> Array:
        """Return the rotation of the base (1,) in the plane, its rotation vector (3,) in space [rad]."""
        at = np.array(time)
        return np.array([0.0 if s is None else self.scale * float(s.displacement(at)) for s in self.turns])

    def base(self, time: float, h: float, factors: Mapping[str, float]) -> Drive:
        """Return what a moving base imposes in a step."""
        moved = np.asarray(self.displacement(np.array(time)), dtype=float).reshape(-1)
        velocity = self.mean_velocity(time, time + h)
        still = np.zeros_like(velocity)
        if not self.turning:
            return Drive(still, velocity, factors, moved)
        turn = _from_to(self.rotation(time), self.rotation(time + h)) / h
        return Drive(still, velocity, factors, moved, turn if len(turn) == 3 else float(turn[0]),
                     moved + self.pivot)  # fmt: skip

    def carried(self, placement: Placement, since: float, time: float) -> Placement:
        """Return where a base that stood so at a time is at another one."""
        first, last = self.displacement(np.array([since, time]))
        if not self.turning:
            return replace(placement, centre=placement.centre + last - first)
        turn = _from_to(self.rotation(since), self.rotation(time))
        first, last = first + self.pivot, last + self.pivot
        arm = placement.centre - first
        about = np.repeat(turn if len(turn) == 1 else turn[None], len(arm), axis=0)
        return placement.moved(last + rotated(arm, turn if len(turn) == 3 else turn[0]) - placement.centre, about)

    @property
    def duration(self) -> float:
        """When the last component ends [s]."""
        return max((s.duration for s in (*self.components, *self.turns) if s is not None), default=0.0)

    @property
    def sample(self) -> float:
        """Least time between samples of a record, or quarter of a half wave of a pulse; infinite without either [s]."""
        return min((s.step for s in (*self.components, *self.turns) if isinstance(s, Record | Pulse)), default=np.inf)

    @property
    def attention(self) -> tuple[str, ...]:
        """What is strange about records and pulses."""
        found = [attention(s.scaled(self.scale)) for s in self.components if isinstance(s, Record | Pulse)]
        return (*(text for text in found if text is not None), *self._unequal())

    def _unequal(self) -> list[str]:
        """Return what is strange about records beside each other: samples, ends, a vertical one that is the largest."""
        axes = AXES[len(self.components)]
        records = [(a, s) for a, s in zip(axes, self.components, strict=True) if isinstance(s, Record)]
        told = []
        if len({f"{s.step:.6g}" for _, s in records}) > 1:
            steps = ", ".join(f"{s.step:.4g} s along {axis}" for axis, s in records)
            told.append(f"the records have different sampling intervals ({steps}): each is integrated with its own")
        if records and max(s.duration for _, s in records) > (1 + APART) * min(s.duration for _, s in records):
            ends = ", ".join(f"{s.duration:.4g} s along {axis}" for axis, s in records)
            told.append(f"the records end at different times ({ends}): have they one origin of time?")
        peaks = {axis: float(np.abs(s.values).max()) for axis, s in records if s.quantity == "acceleration"}
        if len(peaks) > 1 and peaks.get(axes[-1], 0.0) > max(peaks[axis] for axis in peaks if axis != axes[-1]):
            told.append(f"the vertical record (along {axes[-1]}) has the largest peak of all: are components swapped?")
        return told

    @property
    def words(self) -> str:
        """What moves the ground, such as "sine pulse of 0.4 g over 0.5 s along x, times 0.1"; empty for nothing."""
        axes = AXES[len(self.components)]
        told = [f"{_words(s)} along {axis}" for s, axis in zip(self.components, axes, strict=True) if s is not None]
        named = zip(self.turns, TURNS[len(axes)], strict=bool(self.turns))
        told += [f"a rotation of up to {_largest(s):.4g} rad about {name[1]}" for s, name in named if s is not None]
        told = [", ".join(told[:-1]), told[-1]] if len(told) > 2 else told
        return " and ".join(told) + (f", times {self.scale:g}" if told and self.scale != 1.0 else "")

    def mean_acceleration(self, start: float, end: float) -> Array:
        """Return the mean acceleration between two times (d,) [m/s2]."""
        return self._difference("velocity", start, end)

    def mean_velocity(self, start: float, end: float) -> Array:
        """Return the mean velocity between two times (d,) [m/s]."""
        return self._difference("displacement", start, end)

    def acceleration(self, time: Array) -> Array:
        """Return the acceleration at times (n,), shape (n, d) [m/s2]."""
        zero = np.zeros(np.shape(time))
        return np.stack([zero if s is None else self.scale * s.acceleration(time) for s in self.components], axis=-1)

    def velocity(self, time: Array) -> Array:
        """Return the velocity at times (n,), shape (n, d) [m/s]."""
        zero = np.zeros(np.shape(time))
        return np.stack([zero if s is None else self.scale * s.velocity(time) for s in self.components], axis=-1)

    def displacement(self, time: Array) -> Array:
        """Return the displacement at times (n,), shape (n, d) [m]."""
        zero = np.zeros(np.shape(time))
        return np.stack([zero if s is None else self.scale * s.displacement(time) for s in self.components], axis=-1)

    def _difference(self, quantity: str, start: float, end: float) -> Array:
        mean = np.zeros(len(self.components))
        for k, signal in enumerate(self.components):
            if signal is not None:
                first, last = getattr(signal, quantity)(np.array([start, end]))
                mean[k] = self.scale * (last - first) / (end - start)
        return mean


def _refuse_other_origins(signals: Mapping[str, Signal | None]) -> None:
    """Refuse records whose first samples are at different times: each would begin with the motion.

    Raises
    ------
    InputError
        Two of them begin more than a sample apart.
    """
    records = {name: s for name, s in signals.items() if isinstance(s, Record)}
    begins = [s.begins for s in records.values()]
    if begins and max(begins) - min(begins) > 1.5 * max(s.step for s in records.values()):
        told = ", ".join(f"{s.begins:.6g} s along {name}" for name, s in records.items())
        msg = f"the records begin at different times: {told}"
        hint = "let them begin at the same time: zeros before the later one, or cut the earlier one"
        raise InputError(msg, where="motion", hint=hint)


def _largest(signal: Signal) -> float:
    """Return the largest displacement of a signal."""
    return float(np.abs(signal.displacement(np.linspace(0.0, signal.duration, 1001))).max())


def _from_to(before: Array, after: Array) -> Array:
    """Return the rotation from one to another: angles (1,) in the plane, rotation vectors (3,) in space [rad]."""
    if len(before) == 1:
        return np.asarray(after - before)
    return np.asarray(rotation_vector(rotation_matrix(after[None]) @ rotation_matrix(-before[None]))[0])


def _words(signal: Signal) -> str:
    if isinstance(signal, Pulse):
        return f"{signal.shape} pulse of {signal.amplitude / STANDARD_GRAVITY:.4g} g over {signal.length:g} s"
    if isinstance(signal, Record):
        peak = f" with a peak of {float(np.abs(signal.values).max()) / STANDARD_GRAVITY:.4g} g"
        told = peak if signal.quantity == "acceleration" else f" of {signal.quantity}"
        return f"record '{signal.name}'{told}, {signal.duration:.4g} s"
    return f"{type(signal).__name__} of {signal.duration:.4g} s"


def _signal(thing: Signal | Path | str | None) -> Signal | None:
    if thing is None or isinstance(thing, Record | Pulse):
        return thing
    if isinstance(thing, Path | str):
        return read_record(thing)
    if all(hasattr(thing, name) for name in ("duration", "acceleration", "velocity", "displacement")):
        return thing
    msg = f"a ground motion is a record, a pulse or the name of a file, not {type(thing).__name__}"
    raise InputError(msg, hint="concio.read_record reads a file, concio.Pulse('half sine', 3.0, 0.5) is a pulse")
