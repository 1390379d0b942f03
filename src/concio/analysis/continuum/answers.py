"""Answers of a wall block by block and as a continuum, next to each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from concio.analysis.cells.moduli import Moduli
from concio.analysis.cells.strength import StrengthDomain
from concio.analysis.continuum.elastic import ElasticContinuum
from concio.analysis.continuum.kinematic_bound import KinematicBound
from concio.analysis.continuum.static_bound import StaticBound
from concio.analysis.limit import LimitResult
from concio.analysis.result import Result
from concio.fem.discretisation import Discretisation
from concio.problem.tolerances import CHECKED

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class ElasticComparison:
    """Elastic answers.

    Parameters
    ----------
    moduli : Moduli
        Of the cell.
    blocks : Result
        The blocks with their unilateral joints; it may say that they do not stand.
    bonded : (N_all,) array or None
        Displacements of the blocks with all joints closed and stuck [m]; None where supports move them apart.
    continuum : ElasticContinuum
    """

    moduli: Moduli
    blocks: Result
    bonded: Array | None
    continuum: ElasticContinuum

    @cached_property
    def free(self) -> Array:
        """Numbers of the blocks that are compared, mortar films left out."""
        bodies = self.blocks.model.bodies
        return np.array([b for b, body in enumerate(bodies) if body.kind != "fixed" and body.role != "mortar"])

    @cached_property
    def centres(self) -> Array:
        """Centroids (k, 2) of those blocks; a point inside where an angular block has it outside [m]."""
        outlines = [shapely.Polygon(self.blocks.model.outlines[b].outline) for b in self.free]
        places = [p.centroid if p.contains(p.centroid) else p.representative_point() for p in outlines]
        return np.array([(p.x, p.y) for p in places]).reshape(-1, 2)

    @cached_property
    def displacements(self) -> tuple[Array, Array, Array]:
        """Displacements (k, 2) at the centroids [m]: blocks, bonded (nan where there is no answer), continuum."""
        disc = self.blocks.assembly.disc
        own = self.blocks.displacement if self.blocks.solved else None
        blocks, bonded = (
            np.full_like(self.centres, np.nan) if u is None else _moved(disc, u, self.free, self.centres)
            for u in (own, self.bonded)
        )
        return blocks, bonded, self.continuum.at(self.centres)[0]

    @property
    def settlements(self) -> tuple[float, float, float]:
        """Largest downward displacement of a centroid [m]: blocks, bonded, continuum."""
        blocks, bonded, smooth = (float(np.maximum(-u[:, 1], 0.0).max()) for u in self.displacements)
        return blocks, bonded, smooth

    @property
    def differences(self) -> tuple[float, float]:
        """Root mean square difference from the continuum's displacements, over their own: blocks, bonded."""
        blocks, bonded, smooth = self.displacements
        size = float(np.linalg.norm(smooth)) or 1.0
        return float(np.linalg.norm(blocks - smooth)) / size, float(np.linalg.norm(bonded - smooth)) / size

    def table(self) -> dict[str, Array]:
        """Return the blocks as columns: centroid, displacements of the three, mean stresses where there are any."""
        columns: dict[str, Array] = {"block": np.array([self.blocks.model.bodies[b].name for b in self.free])}
        columns |= {"x": self.centres[:, 0], "y": self.centres[:, 1]}
        for name, u in zip(("blocks", "bonded", "continuum"), self.displacements, strict=True):
            columns |= {f"u_x_{name}": u[:, 0], f"u_y_{name}": u[:, 1]}
        smooth = self.continuum.at(self.centres)[1]
        own = self.blocks.stress.mean[self.free] if self.blocks.solved else np.full_like(smooth, np.nan)
        for k, name in enumerate(("xx", "yy", "xy")):
            columns |= {f"stress_{name}_blocks": own[:, k], f"stress_{name}_continuum": smooth[:, k]}
        return columns


@dataclass(frozen=True, eq=False)
class StrengthComparison:
    """Limit loads.

    Parameters
    ----------
    live : tuple of str
        Load groups that grow.
    domain : StrengthDomain
        Of the cell.
    blocks : LimitResult
        Of the wall of blocks.
    static : StaticBound
        Stresses of the continuum that carry the load, the best of several meshes.
    kinematic : KinematicBound
        A mechanism of the continuum.
    """

    live: tuple[str, ...]
    domain: StrengthDomain
    blocks: LimitResult
    static: StaticBound
    kinematic: KinematicBound

    @property
    def bracket(self) -> tuple[float, float]:
        """Limit load of the continuum: at least, at most."""
        return self.static.multiplier, self.kinematic.multiplier

    @property
    def proven(self) -> tuple[bool, bool]:
        """Whether the lower and the upper bound stand: small residuals, and half-spaces that are the domain.

        Half-spaces that were not found exactly lie around the domain: then only the upper bound is one. A mechanism
        under the dead load alone leaves nothing for a lower bound to prove.
        """
        if self.kinematic.multiplier == -np.inf:
            return (self.kinematic.residual <= CHECKED,) * 2
        exact = self.domain.domain is not None and self.domain.domain.exact
        lower = exact and self.static.residual <= CHECKED
        return lower, self.kinematic.residual <= CHECKED or (lower and self.static.multiplier == np.inf)


def _moved(disc: Discretisation, u: Array, bodies: Array, places: Array) -> Array:
    """Return the displacements (k, 2) of places (k, 2) in bodies (k,)."""
    found = np.empty((len(bodies), 2))
    for k, b in enumerate(bodies):
        index, matrix = disc.point_operator(int(b), places[k])
        found[k] = matrix @ u[index]
    return found
