"""A point of the plane interior point, and what the linear equations leave there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array


@dataclass(frozen=True, eq=False)
class Iterate:
    """A point strictly inside (every slack and multiplier positive), or a direction.

    Parameters
    ----------
    u : (N,) array
    t_t : (m,) array
    slack : (4, m) array
        Rows t_n, s+, s- and q; q belongs to capped pairs and is one elsewhere.
    dual : (4, m) array
        Rows y_n, y+, y- and p, the partners of the slacks; p is one where q is.
    """

    u: Array
    t_t: Array
    slack: Array
    dual: Array

    @property
    def t_n(self) -> Array:
        """Shifted normal forces (m,)."""
        return np.asarray(self.slack[0])

    @property
    def t(self) -> Array:
        """Forces of the pairs (m, 2)."""
        return np.stack([self.slack[0], self.t_t], axis=1)

    def size(self) -> tuple[float, float]:
        """Return the largest force and the largest displacement, at least 1 each."""
        force = max(1.0, float(self.t_n.max(initial=0.0)), float(np.abs(self.t_t).max(initial=0.0)))
        return force, max(1.0, float(np.abs(self.u).max(initial=0.0)))

    def typical_product(self) -> float:
        """Return the mean force times the mean of the gaps and slips of a pair, at least 1 each."""
        return max(1.0, float(self.t_n.mean())) * max(1.0, float(self.dual[:3].sum(axis=0).mean()))

    def products(self) -> Array:
        """Return the four complementarity products of each pair, (4, m)."""
        products: Array = self.slack * self.dual
        return products

    def moved(self, d: Iterate, step: float) -> Iterate:
        """Return the point a step further along d."""
        return Iterate(
            self.u + step * d.u, self.t_t + step * d.t_t, self.slack + step * d.slack, self.dual + step * d.dual
        )

    def longest(self, d: Iterate, share: float = 1.0) -> float:
        """Return ``share`` of the step along d to the boundary, at most 1."""
        falls = min(float((d.slack / self.slack).min(initial=0.0)), float((d.dual / self.dual).min(initial=0.0)))
        return 1.0 if -falls <= share else share / -falls


@dataclass(frozen=True, eq=False)
class Residuals:
    """What the linear equations leave: equilibrium (N,), and of each pair (m,) gap, slip, s+, s- and cap."""

    u: Array
    n: Array
    t: Array
    p: Array
    m: Array
    q: Array

    def size(self, force: float, length: float) -> float:
        """Return the largest, forces relative to ``force`` and lengths to ``length``."""
        forces, lengths = np.concatenate([self.u, self.p, self.m, self.q]), np.concatenate([self.n, self.t])
        return max(float(np.abs(forces).max(initial=0.0)) / force, float(np.abs(lengths).max(initial=0.0)) / length)
