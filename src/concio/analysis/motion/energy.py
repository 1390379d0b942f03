"""The energy balance of a motion: what was put in, what is stored, what was dissipated, and what is left over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.read_only import read_only

Array = np.ndarray

NAMES = ("kinetic", "strain", "potential", "friction", "impact", "damping", "crushing", "input", "overlap", "drift")
"""Energies now (kinetic, strain of bodies, joints and ties, potential of the loads), and sums since the start:
dissipated by friction, in impacts, by damping, by crushing; put in by the ground, moved supports and loads that turn
with their bodies; what springs of joints gained as the areas changed that faces have in common; and work done in
pushing back what had sunk into each other, or what springs had come to differ from the gaps of turning bodies, and by
hard joints that give way where nothing is hit."""


@dataclass(frozen=True, eq=False)
@read_only
class EnergyBalance:
    """Energies at stored times [kN m].

    Parameters
    ----------
    values : mapping of str to (n,) array
    rounding : float
        Energy below which exchanges are rounding: what lifts all weights by a share
        :data:`concio.problem.tolerances.ENERGY_ROUNDING` of the size of the model [kN m].
    """

    values: dict[str, Array]
    rounding: float = 0.0

    def __getitem__(self, name: str) -> Array:
        return self.values[name]

    @property
    def total(self) -> Array:
        """Stored and dissipated less put in (n,): constant where the balance closes [kN m]."""
        v = self.values
        stored = v["kinetic"] + v["strain"] + v["potential"]
        lost = v["friction"] + v["impact"] + v["damping"] + v["crushing"]
        balance: Array = stored + lost - v["input"] - v["overlap"] - v["drift"]
        return balance

    @property
    def turned_over(self) -> float:
        """Energy that was exchanged: the largest range of any energy, or the largest kinetic energy [kN m]."""
        moving = float(self.values["kinetic"].max(initial=0.0))  # an elastic impact in free flight turns nothing over
        return max(moving, *(float(np.ptp(v)) if len(v) else 0.0 for v in self.values.values()))

    @property
    def error(self) -> float:
        """Largest deviation of the balance from its beginning over :attr:`scale`."""
        total = self.total
        worst = float(np.abs(total - total[0]).max()) if len(total) else 0.0
        return worst / self.scale if self.scale > 0 else 0.0

    @property
    def still(self) -> bool:
        """Whether no more energy was exchanged than rounding of places explains."""
        return self.turned_over <= self.rounding

    @property
    def scale(self) -> float:
        """The larger of :attr:`turned_over` and :attr:`rounding` [kN m]."""
        return max(self.turned_over, self.rounding)
