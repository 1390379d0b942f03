"""What is kept of a motion: placements at some times, points and reactions at every step, what solved each step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.analysis.motion.energy import NAMES, EnergyBalance
from concio.analysis.motion.state import MotionState
from concio.contact.reference import Reference
from concio.problem.tolerances import ENERGY_ROUNDING
from concio.read_only import read_only

Array = np.ndarray


@dataclass(frozen=True, eq=False)
@read_only
class Shots:
    """Placements at n times.

    Parameters
    ----------
    time : (n,) array
        [s].
    centre : (n, B, d) array
        Centroids [m].
    rotation : (n, B) array in the plane, (n, B, 3, 3) in space
        [rad]; rotation matrices in space.
    strain : (n, nodes, d) array
        Displacements of nodes in the frames of their bodies [m].
    opening, slip : (n, f) arrays
        Of each joint that was there in the beginning: largest opening and plastic slip [m].
    """

    time: Array
    centre: Array
    rotation: Array
    strain: Array
    opening: Array
    slip: Array

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True, eq=False)
@read_only
class Steps:
    """What is kept of every step, k of them.

    Parameters
    ----------
    time : (k,) array
        At its end [s].
    residual : (k,) array
        Worst relative violation of any equation: forces over the loads, velocities over what the loads do in the step.
    how : (k,) integer array
        What solved it, index into ``methods``.
    methods : tuple of str
    factorisations : (k,) integer array
    depth : (k,) array
        Deepest penetration of hard joints [m].
    point : (k, p, d) array
        Positions of the points asked for [m].
    reaction : (k, r, d) array
        Force of each fixed body and support on the structure [kN].
    """

    time: Array
    residual: Array
    how: Array
    methods: tuple[str, ...]
    factorisations: Array
    depth: Array
    point: Array
    reaction: Array

    def __len__(self) -> int:
        return len(self.time)

    def shares(self) -> dict[str, float]:
        """Return the share of steps by what solved them."""
        if not len(self):
            return {}
        return {name: float((self.how == k).mean()) for k, name in enumerate(self.methods)}


class Recorder:
    """Collects placements and steps."""

    def __init__(self) -> None:
        self.shots: list[tuple[MotionState, Array, Array]] = []
        self.energies: list[dict[str, float]] = []
        self.rows: list[tuple[float, float, int, int, float]] = []
        self.points: list[Array] = []
        self.reactions: list[Array] = []
        self.methods: dict[str, int] = {}

    def shot(self, state: MotionState, opening: Array, slip: Array, energy: dict[str, float]) -> None:
        """Keep a state."""
        self.shots.append((state, opening, slip))
        self.energies.append(energy)

    def step(
        self, time: float, residual: float, how: str, factorisations: int, depth: float, point: Array, reaction: Array
    ) -> None:
        """Keep what a step did."""
        self.rows.append((time, residual, self.methods.setdefault(how, len(self.methods)), factorisations, depth))
        self.points.append(point)
        self.reactions.append(reaction)

    def done(self, reference: Reference, points: int, reactions: int) -> tuple[Shots, Steps, EnergyBalance]:
        """Return everything as arrays."""
        dim = reference.disc.dim
        states = [s[0] for s in self.shots]
        shots = Shots(
            np.array([s.time for s in states]), np.array([s.centre for s in states]),
            np.array([s.rotation for s in states]), np.array([s.strain for s in states]),
            np.array([s[1] for s in self.shots]), np.array([s[2] for s in self.shots]),
        )  # fmt: skip
        table = np.array(self.rows, dtype=float).reshape(-1, 5)
        steps = Steps(
            table[:, 0], table[:, 1], table[:, 2].astype(np.int64), tuple(self.methods), table[:, 3].astype(np.int64),
            table[:, 4], np.array(self.points).reshape(len(table), points, dim),
            np.array(self.reactions).reshape(len(table), reactions, dim),
        )  # fmt: skip
        values = {name: np.array([e[name] for e in self.energies]) for name in NAMES}
        weight = float(reference.body_mass.sum()) * reference.gravity
        return shots, steps, EnergyBalance(values, ENERGY_ROUNDING * weight * reference.disc.size)
