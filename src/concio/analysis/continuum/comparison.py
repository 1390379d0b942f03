"""A wall block by block beside the homogenised continuum: elastic answers, and limit loads.

Elastic: the blocks with their unilateral joints, the blocks with all joints closed and stuck, and the continuum with
the moduli of the cell. The second tends to the third as blocks become smaller; what is between the first and the second
(joints that open and slip, arches) is what moduli cannot have.

Strength: the associated limit load of the blocks, and what is shown of that of the continuum from below (stresses) and
from above (a mechanism). The blocks tend to it as they become smaller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cells.moduli import homogenise
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.cells.strength import strength
from concio.analysis.continuum.answers import ElasticComparison, StrengthComparison
from concio.analysis.continuum.bonded import bonded_displacement
from concio.analysis.continuum.cell_of_wall import cell_of
from concio.analysis.continuum.continuum import Continuum, continuum_of
from concio.analysis.continuum.elastic import solve_elastic
from concio.analysis.continuum.kinematic_bound import kinematic_bound
from concio.analysis.continuum.static_bound import StaticBound, static_bound
from concio.analysis.entry_point import entry_point
from concio.analysis.limit import LIVE, limit
from concio.analysis.step import solve
from concio.arguments import closest, strict
from concio.contact.assembly import Assembly, as_assembly
from concio.contact.factors import once
from concio.errors import InputError
from concio.model.model import Model
from concio.problem.solution import Progress, ProgressCallback
from concio.representation import short_repr
from concio.verdict.continuum_verdict import continuum_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.continuum_accessor import ContinuumPlots

Array = np.ndarray

ELEMENTS = 8
"""Rectangles of the default mesh along the longer side of the wall."""

STRETCHES = (1.0, 6.0, 1 / 6)
"""Shapes of the rectangles of the meshes for the lower bound, of which the best counts: stresses that jump across
steep or flat lines need such lines in the mesh."""


@short_repr
@dataclass(frozen=True, eq=False, repr=False)
class ContinuumComparison(Shown):
    """A wall of blocks beside its homogenised continuum.

    Parameters
    ----------
    assembly : Assembly
        The wall of blocks.
    cell : PeriodicCell
    wall : Continuum
        The wall as a continuum.
    elastic : ElasticComparison or None
    strength : StrengthComparison or None
    elastic_note, strength_note : str
        Why one of them is not there.
    """

    assembly: Assembly
    cell: PeriodicCell
    wall: Continuum
    elastic: ElasticComparison | None
    strength: StrengthComparison | None
    elastic_note: str = ""
    strength_note: str = ""

    @property
    def plot(self) -> ContinuumPlots:
        """Figures by name, blocks to the left, continuum to the right; matplotlib is loaded here."""
        plots: ContinuumPlots = view(self, "plot")
        return plots

    @property
    def verdict(self) -> Verdict:
        """What was compared, what came out, and what has no proof."""
        return continuum_verdict(self)

    @property
    def checked(self) -> bool:
        """Whether everything that is reported has been proven or certified, including that the blocks do not stand."""
        limits = self.strength is None or (all(self.strength.proven) and self.strength.blocks.associated.checked)
        return limits and (self.elastic is None or self.elastic.blocks.status.exit_code in (0, 3))

    def summary(self) -> dict[str, Any]:
        """Return the numbers as plain types, kN and m."""
        found: dict[str, Any] = {
            "title": self.assembly.model.title,
            "blocks": len(self.assembly.model.free_bodies),
            "triangles": len(self.wall.triangles),
            "cell": self.cell.model.title,
            "engine": self.assembly.model.engine,
            "elastic": None,
            "elastic_note": self.elastic_note,
            "strength": None,
            "strength_note": self.strength_note,
        }
        if self.elastic is not None:
            blocks, bonded, smooth = self.elastic.settlements
            far, near = self.elastic.differences
            found["elastic"] = {
                "outcome": self.elastic.blocks.status.name.lower(),
                "settlement_blocks": _number(blocks),
                "settlement_bonded": _number(bonded),
                "settlement_continuum": smooth,
                "difference_blocks": _number(far),
                "difference_bonded": _number(near),
                "reactions_blocks": self.elastic.blocks.reactions if self.elastic.blocks.solved else None,
                "reactions_continuum": {k: v.tolist() for k, v in self.elastic.continuum.reactions.items()},
                "continuum_residual": self.elastic.continuum.residual,
            }
        if self.strength is not None:
            low, high = self.strength.bracket
            found["strength"] = {
                "groups": list(self.strength.live),
                "blocks_associated": _number(self.strength.blocks.associated.multiplier),
                "continuum_at_least": _number(low),
                "continuum_at_most": _number(high),
                "lower_proven": self.strength.proven[0],
                "upper_proven": self.strength.proven[1],
                "static_residual": _number(self.strength.static.residual),
                "kinematic_residual": _number(self.strength.kinematic.residual),
            }
        return found


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None


@strict
@entry_point
def compare_with_continuum(
    wall: Model | Assembly,
    cell: Model | Assembly | PeriodicCell | None = None,
    *,
    factors: Mapping[str, float] | None = None,
    live: str | Sequence[str] | None = None,
    mesh_size: float | None = None,
    elastic: bool = True,
    strength: bool = True,
    progress: ProgressCallback | None = None,
) -> ContinuumComparison:
    """Solve a wall block by block and as a homogenised continuum.

    Parameters
    ----------
    wall : Model or Assembly
        Blocks on fixed bodies whose outline has edges along x and y only, under weight, loads on edges and movements
        of the fixed bodies.
    cell : Model or Assembly, optional
        The periodic cell that the wall repeats; by default that of the bond the wall was generated in.
    factors : mapping of str to float, optional
        Load factors of the elastic comparison; groups not named have 1. Limit loads are those of the live groups, all
        others having 1.
    live : str or sequence of str, optional
        Load groups that grow to the limit load; by default "live" where there is such a group.
    mesh_size : float, optional
        Of the continuum [m]; by default an eighth of the longer side of the wall.
    elastic, strength : bool
        What is compared.
    progress : callable, optional
        True stops, where something can be stopped.

    Raises
    ------
    InputError
        The wall has no counterpart in a continuum, the cell is none or is not known, a group does not exist, or factors
        are given without the elastic comparison, the only one that they are for.
    NoEquilibriumError
        The dead load alone cannot be carried by the blocks.
    SolverError
        An answer does not stand up to its check.

    Examples
    --------
    Settlements in mm of the blocks, of the blocks with bonded joints, and of the continuum:

    >>> import concio
    >>> law = concio.JointLaw(0.6, normal_stiffness=10e6, tangential_stiffness=4e6)
    >>> wall = concio.wall(length=1.0, height=1.0, block_size=(0.25, 0.125), friction=law, top_pressure=100.0)
    >>> found = concio.compare_with_continuum(wall, strength=False, mesh_size=0.25)
    >>> print([round(1e3 * settlement, 2) for settlement in found.elastic.settlements])
    [0.11, 0.11, 0.12]
    """
    if factors and not elastic:
        msg = "load factors are those of the elastic comparison, which is not asked for"
        raise InputError(msg, hint="leave them out, or write the loads into the model as they are to act")
    assembly = as_assembly(wall)
    own = PeriodicCell.of(cell_of(assembly) if cell is None else cell)
    if abs(own.model.bodies[0].thickness - assembly.model.free_bodies[0].thickness) > 1e-9 * own.size:
        thick = own.model.bodies[0].thickness
        msg = f"the cell is {thick:g} m thick, the wall {assembly.model.free_bodies[0].thickness:g} m"
        raise InputError(msg, hint="give both the same thickness")
    for group in factors or ():
        if group not in assembly.groups:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint=closest(group, assembly.groups, names="groups"))
    size = _mesh_size(assembly, mesh_size)
    smooth = continuum_of(assembly, size)
    stretched, note, limits, why = None, "not asked for", None, "not asked for"
    if elastic:
        stretched, note = _elastic(assembly, own, smooth, dict(factors or {}), progress)
    if strength:
        groups = _groups(assembly, live)
        if groups:
            limits, why = _strength(assembly, own, smooth, size, groups, progress), ""
        else:
            why = f"there is no load group '{LIVE}' that grows"
    return ContinuumComparison(assembly, own, smooth, stretched, limits, note, why)


def _mesh_size(assembly: Assembly, given: float | None) -> float:
    if given is None:
        points = np.vstack([b.outline for b in assembly.model.outlines if b.kind != "fixed"])
        return float(np.ptp(points, axis=0).max()) / ELEMENTS
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0 < given < np.inf:
        msg = f"mesh_size = {given!r} must be positive and finite"
        raise InputError(msg, hint="give a length in m")
    return float(given)


def _groups(assembly: Assembly, live: str | Sequence[str] | None) -> tuple[str, ...]:
    if live is None:
        return (LIVE,) if LIVE in assembly.groups else ()
    return once(live)


def _told(progress: ProgressCallback | None, k: int, note: str) -> None:
    if progress is not None:
        progress(Progress("continuum", k, 0.0, note))


def _elastic(
    assembly: Assembly, cell: PeriodicCell, wall: Continuum, factors: dict[str, float],
    progress: ProgressCallback | None,
) -> tuple[ElasticComparison | None, str]:  # fmt: skip
    """Return the elastic answers, or why there are none."""
    _told(progress, 0, "moduli of the cell")
    try:
        moduli = homogenise(cell)
    except InputError as error:
        return None, error.what
    _told(progress, 1, "elastic continuum")
    smooth = solve_elastic(wall, moduli.matrix, factors)
    bonded = bonded_displacement(assembly, factors)
    blocks = solve(assembly, factors=factors, on_failure="return", progress=progress)
    return ElasticComparison(moduli, blocks, bonded, smooth), ""


def _strength(
    assembly: Assembly, cell: PeriodicCell, wall: Continuum, size: float, groups: tuple[str, ...],
    progress: ProgressCallback | None,
) -> StrengthComparison:  # fmt: skip
    blocks = limit(assembly, groups, path=False, search=False)
    domain = strength(cell, (), coulomb=False, progress=progress)
    faces = domain.faces
    dead = {name: 0.0 if name in groups else 1.0 for name in wall.groups}
    live = {name: 1.0 if name in groups else 0.0 for name in wall.groups}
    best: StaticBound | None = None
    for k, stretch in enumerate(STRETCHES):
        _told(progress, k, f"stresses of the continuum, mesh {k + 1} of {len(STRETCHES)}")
        found = static_bound(wall if stretch == 1.0 else continuum_of(assembly, size, stretch), faces, dead, live)
        if best is None or np.isnan(best.multiplier) or found.multiplier > best.multiplier:
            best = found
    assert best is not None
    _told(progress, len(STRETCHES), "mechanism of the continuum")
    unsupported = bool(np.isnan(best.multiplier))
    upper = kinematic_bound(wall, faces, dead, live, unsupported=unsupported)
    return StrengthComparison(groups, domain, blocks, best, upper)
