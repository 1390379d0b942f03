"""What ``concio cell`` prints: moduli with what they hold for, half-spaces of the strength, directions, the path."""

from __future__ import annotations

from typing import Any

import numpy as np

from concio.analysis.cells.cell_path_result import CellPath
from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.cells.moduli import Moduli
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.cells.strength import StrengthDomain, StrengthRay
from concio.contact.macroscopic_strain import COMPONENTS
from concio.display import Units
from concio.verdict.cell_verdict import cell_verdict, direction_words, domain_words, ray_words

Array = np.ndarray

MOST_FACES = 12
"""More half-spaces than this are counted; the table in --out has them all."""


def cell_facts(
    cell: PeriodicCell, moduli: Moduli | None, domain: StrengthDomain | None, path: CellPath | None, *, none: str = ""
) -> dict[str, Any]:
    """Return everything as plain types, the object of ``--json``; ``none`` says why there are no moduli."""
    verdict = cell_verdict(cell, moduli, domain, path, none=none)
    return {
        "status": verdict.status,
        "verdict": verdict.as_dict(),
        "title": cell.model.title,
        "bodies": len(cell.model.bodies),
        "contacts": len(cell.assembly.pairs),
        "periods": cell.periods.tolist(),
        "components": list(COMPONENTS),
        "moduli": None if moduli is None else moduli.summary(),
        "strength": None if domain is None else domain.summary(),
        "path": None if path is None else path.summary(),
        "units": {"force": "kN", "length": "m", "stress": "kN/m2"},
    }


def cell_lines(
    cell: PeriodicCell, moduli: Moduli | None, domain: StrengthDomain | None, path: CellPath | None, *, none: str = ""
) -> list[str]:
    """Return everything in words; ``none`` says why there are no moduli."""
    units = cell.model.report
    long, metre = units.factor("length")
    (a, b), (c, d) = long * cell.periods
    count = len(cell.model.bodies)
    lines = [
        cell.model.title or "cell without a title",
        f"  cell         {count} {'body' if count == 1 else 'bodies'}, {len(cell.assembly.pairs):,} contact pairs; "
        f"repeats by ({a:.6g}, {b:.6g}) and ({c:.6g}, {d:.6g}) {metre}",
    ]
    verdict = cell_verdict(cell, moduli, domain, path, none=none)
    lines += [verdict.headline, *verdict.lines(units)]
    lines += [f"  moduli       none: {none}"] if moduli is None else moduli_lines(moduli, units)
    if domain is not None:
        lines += strength_lines(domain, units)
    if path is not None:
        lines += path_lines(path, units)
    return lines


def _stresses(units: Units) -> tuple[float, str]:
    """Return the factor and the symbol of all stresses and moduli: kN/m2 where no unit was chosen."""
    return (1.0, "kN/m2") if units.stress == "auto" else units.factor("stress")


def moduli_lines(moduli: Moduli, units: Units) -> list[str]:
    """Return the moduli, what they hold for and how they were checked."""
    factor, symbol = _stresses(units)
    matrix = factor * moduli.matrix
    size = float(np.abs(matrix).max())
    rows = [
        "  ".join(f"{v if abs(v) > 1e-9 * size else 0.0:12.6g}" for v in row)
        for row in matrix
    ]  # fmt: skip
    E_x, E_y, G_xy = (f"{factor * v:.6g}" for v in (moduli.E_x, moduli.E_y, moduli.G_xy))
    lines = [
        f"  moduli       E_x {E_x}, E_y {E_y}, G_xy {G_xy} {symbol}; "
        f"nu_xy {_round(moduli.nu_xy)}, nu_yx {_round(moduli.nu_yx)}",
        f"  matrix       {rows[0]}   stresses xx, yy, xy [{symbol}]",
        f"               {rows[1]}   by strains xx, yy and",
        f"               {rows[2]}   engineering shear xy",
    ]
    faces = None if moduli.holds is None else moduli.holds.reduced()
    hold = "  hold         with all joints closed and none slipping"
    if faces is None:
        lines.append(hold)
    else:
        lines += [f"{hold}: as long as", *_faces(faces, units)]
    lines.append(f"  checked      worst residual {moduli.certificate.worst:.0e}: balance, joints, symmetry, energy")
    return lines


def strength_lines(domain: StrengthDomain, units: Units) -> list[str]:
    """Return the half-spaces of the strength domain and the strength in directions."""
    words = domain_words(domain)
    lines = [f"  strength     {words}"] if words else []
    if domain.domain is not None:
        lines += _faces(domain.domain.faces, units)
    for ray in domain.rays:
        lines += ray_lines(ray, units)
    return lines


def ray_lines(ray: StrengthRay, units: Units) -> list[str]:
    """Return the strength in one direction, whose components are stresses."""
    first, *rest = ray_words(ray)
    factor, symbol = _stresses(units)
    unit = "" if units.stress == "auto" else f" {symbol}"
    head = f"  direction    {direction_words(ray, factor)}{unit}: {first}"
    return [head, *(f"               {line}" for line in rest)]


def path_lines(path: CellPath, units: Units) -> list[str]:
    """Return the stages of a path with the strain and stress at the end of each."""
    factor, symbol = _stresses(units)
    lines = []
    for k, outcome in enumerate(path.outcomes):
        own = [step for step in path.steps if step.stage == k]
        events = sum(event.stage == k for event in path.events)
        lines.append(f"  stage        {path.stages[k].name}: {outcome.value} {events:,} events")
        if own:
            stress = _three(factor * own[-1].stress)
            lines.append(f"               strain {_three(own[-1].strain)}; stress {stress} {symbol}")
    lines += [f"  note         {note}" for note in path.notes]
    lines += [f"  stage        {later.name}: not begun" for later in path.stages[len(path.outcomes) :]]
    lines.append(
        f"  certificate  worst {path.certificate:.1e} of {len(path.steps):,} states; energy closed to "
        f"{path.energy_error:.1e}"
    )
    return lines


def _faces(faces: HalfSpaces, units: Units) -> list[str]:
    factor, symbol = _stresses(units)
    lines = []
    for normal, offset in list(zip(faces.normals, faces.offsets, strict=True))[:MOST_FACES]:
        size = float(np.abs(normal).max())
        terms = [f"{v:+.6g} s_{name}" for name, v in zip(COMPONENTS, normal / size, strict=True) if abs(v) > 1e-9]
        lines.append(f"               {' '.join(terms)} <= {_round(factor * offset / size)} {symbol}")
    if len(faces) > MOST_FACES:
        lines.append(f"               ... and {len(faces) - MOST_FACES} more (--out writes them all)")
    return lines or ["               (no condition at all)"]


def _three(values: Array) -> str:
    size = float(np.abs(values).max())
    return "(" + ", ".join(f"{v if abs(v) > 1e-9 * size else 0.0:.6g}" for v in values) + ")"


def _round(value: float) -> str:
    return f"{value if abs(value) > 1e-12 else 0.0:.6g}"
