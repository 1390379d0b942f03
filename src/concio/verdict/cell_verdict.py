"""The verdict of a homogenised cell: moduli, strength in directions, and its path of strains and stresses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from concio.display import number
from concio.verdict.attention import attention
from concio.verdict.question import Question
from concio.verdict.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from concio.analysis.cells.cell_path_result import CellPath
    from concio.analysis.cells.moduli import Moduli
    from concio.analysis.cells.periodic_cell import PeriodicCell
    from concio.analysis.cells.strength import StrengthDomain, StrengthRay

COMPONENTS = ("xx", "yy", "xy")
ENDS = ("LIMIT", "MECHANISM")
"""Outcomes of a stage at which the cell is shown to take no more."""


def cell_verdict(
    cell: PeriodicCell, moduli: Moduli | None, domain: StrengthDomain | None, path: CellPath | None, *, none: str = ""
) -> Verdict:
    """Return the verdict of a cell.

    Parameters
    ----------
    cell : PeriodicCell
    moduli : Moduli or None
    domain : StrengthDomain or None
    path : CellPath or None
    none : str
        Why there are no moduli.
    """
    outcome, unchecked = _outcome(domain, path), _unchecked(domain, path)
    answers = [*_moduli(moduli, none), *_strength(domain), *_path(path)]
    asked = (("moduli", moduli or none), ("strength", domain), ("path of strains and stresses", path))
    parts = [word for word, part in asked if part]
    status = {Outcome.HOLDS: "solved"}.get(outcome, "incomplete")
    headline = {
        Outcome.HOLDS: "Everything that was asked of the cell has its answer.",
        Outcome.FAILS: "The path ends before its last stage: the cell carries no more.",
    }
    return Verdict(
        outcome=outcome,
        status=status,
        question=Question(f"{', '.join(parts)} of a periodic cell"),
        headline=headline.get(outcome, "Not everything that was asked of the cell has its answer."),
        answer=" ".join(answers),
        proof=_proof(moduli, domain, path),
        meaning="The cell stands for a wall without edges, whose blocks all do the same; nothing is said of arches, "
        "of edges, or of strains that differ from block to block.",
        limits=_limits(moduli, domain),
        unchecked=unchecked,
        attention=(*attention(cell.assembly), *(path.notes if path is not None else ())),
    )


def _outcome(domain: StrengthDomain | None, path: CellPath | None) -> Outcome:
    if path is not None and not path.complete:
        ended = bool(path.outcomes) and path.outcomes[-1].name in ENDS
        return Outcome.FAILS if ended else Outcome.INCOMPLETE
    return Outcome.HOLDS if domain is None or domain.checked else Outcome.INCOMPLETE


def _unchecked(domain: StrengthDomain | None, path: CellPath | None) -> tuple[str, ...]:
    found = []
    for ray in domain.rays if domain is not None else ():
        if not ray.associated.checked:
            found.append(f"the bound in direction {direction_words(ray)}: residual {ray.associated.worst:.0e}")
    for stage in path.stages[len(path.outcomes) :] if path is not None else ():
        found.append(f"stage '{stage.name}', which was not begun")
    return tuple(found)


def _moduli(moduli: Moduli | None, none: str) -> list[str]:
    if moduli is None:
        return [f"No moduli: {none.rstrip('.')}."] if none else []
    return [
        f"E_x {number(moduli.E_x)}, E_y {number(moduli.E_y)}, G_xy {number(moduli.G_xy)} kN/m2 as long as all joints "
        "are closed and none slips."
    ]


def _strength(domain: StrengthDomain | None) -> list[str]:
    if domain is None:
        return []
    found = domain.domain
    faces = [f"Strength: {len(found.faces)} half-spaces around the stresses the cell can bear."] if found else []
    return [*faces, *(f"Direction {direction_words(ray)}: {'; '.join(ray_words(ray))}." for ray in domain.rays)]


def direction_words(ray: StrengthRay, factor: float = 1.0) -> str:
    """Return the direction of a ray in words, its components times a factor of their unit."""
    return ", ".join(f"{name} {factor * v:g}" for name, v in zip(COMPONENTS, ray.direction, strict=True) if v)


def ray_words(ray: StrengthRay) -> list[str]:
    """Return the strength in one direction, a phrase each: the bound, the Coulomb path, the collapse state."""
    if math.isinf(ray.multiplier):
        return ["no associated bound: friction that dilates bears any multiple, which says nothing of Coulomb friction"]
    bound = ray.associated
    state = "checked from both sides" if bound.checked else "NOT checked"
    lines = [f"associated bound {ray.multiplier:.6g}, {state}: {bound.worst:.0e}"]
    if math.isfinite(ray.carried):
        shown = "collapses at" if ray.collapse_shown else "carries at least"
        lines.append(f"Coulomb path {shown} {ray.carried:.6g}")
    if ray.collapse_state is not None:
        small = abs(ray.collapse_state.multiplier) < 1e-9 * abs(ray.multiplier)
        least = 0.0 if small else ray.collapse_state.multiplier
        lines.append(f"Coulomb collapse state at {least:.6g} ({ray.search})")
    elif ray.search != "not asked for":
        lines.append(f"Coulomb collapse state: {ray.search}")
    return lines


def domain_words(domain: StrengthDomain) -> str:
    """Return what the half-spaces of a strength domain are, in a phrase; empty where there is nothing to say."""
    found = domain.domain
    if found is not None:
        part = (
            "exactly" if found.exact else f"within it by at most {100 * found.shortfall:.2g} % of the way to a corner"
        )
        return f"the stresses that associated friction bears are those with, {part}"
    return "" if domain.rays else "no stress is carried with a margin: there is no domain"


def _path(path: CellPath | None) -> list[str]:
    if path is None:
        return []
    return [f"Stage {path.stages[k].name}: {outcome.value}" for k, outcome in enumerate(path.outcomes)]


def _proof(moduli: Moduli | None, domain: StrengthDomain | None, path: CellPath | None) -> str:
    found = []
    if moduli is not None:
        found.append(
            f"moduli: balance, joints, symmetry and energy of the cell's own matrices, {moduli.certificate.worst:.0e}"
        )
    if domain is not None and domain.rays:
        found.append(
            "strength: forces and a mechanism from the cell's joints, one from below and one from above, "
            f"{domain.worst:.0e}"
        )
    if path is not None:
        found.append(
            f"path: certificates of {len(path.steps):,} states, {path.certificate:.1e}; energy closed to "
            f"{path.energy_error:.1e}"
        )
    return "; ".join(found)


def _limits(moduli: Moduli | None, domain: StrengthDomain | None) -> tuple[str, ...]:
    found = []
    if moduli is not None:
        found.append("moduli hold with all joints closed and none slipping")
    if domain is not None and (domain.domain is not None or domain.rays):
        found.append(
            "the associated bound is an upper bound: Coulomb friction bears what it bears or less; a Coulomb path or a "
            "collapse state below it counts"
        )
    if domain is not None and domain.domain is not None and not domain.domain.exact:
        found.append("half-spaces lie around the domain, which was not found exactly")
    return tuple(found)
