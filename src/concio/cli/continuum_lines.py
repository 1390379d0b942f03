"""What ``concio continuum`` prints: elastic answers and limit loads of blocks and continuum, and what lies between."""

from __future__ import annotations

from typing import Any

import numpy as np

from concio.analysis.continuum.answers import ElasticComparison, StrengthComparison
from concio.analysis.continuum.comparison import ContinuumComparison
from concio.analysis.continuum.halving import BlockHalving
from concio.display import Units
from concio.verdict.continuum_verdict import continuum_strength_words, continuum_verdict


def continuum_facts(found: ContinuumComparison, halving: BlockHalving | None) -> dict[str, Any]:
    """Return everything as plain types: the object of ``--json``."""
    verdict = continuum_verdict(found, halving)
    return {
        "status": verdict.status,
        **found.summary(),
        "verdict": verdict.as_dict(),
        "halving": None if halving is None else halving.summary(),
        "units": {"force": "kN", "length": "m", "stress": "kN/m2"},
    }


def continuum_lines(found: ContinuumComparison, halving: BlockHalving | None) -> list[str]:
    """Return everything in words."""
    count = len(found.assembly.model.free_bodies)
    lines = [
        found.assembly.model.title or "wall without a title",
        f"  blocks       {count:,}, {len(found.assembly.pairs):,} contact pairs",
        f"  continuum    {len(found.wall.triangles):,} triangles; {found.cell.model.title}",
    ]
    verdict = continuum_verdict(found, halving)
    lines += [verdict.headline, *verdict.lines(found.assembly.model.report)]
    units, elastic = found.assembly.model.report, found.elastic
    lines += [f"  elastic      none: {found.elastic_note}"] if elastic is None else elastic_lines(elastic, units)
    if found.strength is None:
        lines.append(f"  limit load   none: {found.strength_note}")
    else:
        lines += strength_lines(found.strength)
    return lines if halving is None else [*lines, *halving_lines(halving, units)]


def elastic_lines(found: ElasticComparison, units: Units) -> list[str]:
    """Return the elastic answers."""
    blocks, bonded, smooth = (units.text("motion", v, 5) for v in found.settlements)
    far, near = found.differences
    if found.bonded is None:
        bonded = "have no answer, the supports tear blocks apart"
    head = f"  elastic      settlement: continuum {smooth}; blocks bonded {bonded}"
    apart = "               apart by (root mean square): "
    apart += f"bonded {100 * near:.3g} %, " if near == near else ""
    if found.blocks.solved:
        head, apart = f"{head}; blocks {blocks}", f"{apart}blocks with joints that open and slip {100 * far:.3g} %"
        pushed = found.blocks.reactions
        lines = [
            f"  force on wall from {name}: blocks ({_force(pushed.get(name), units)}), continuum ({_force(own, units)})"
            for name, own in found.continuum.reactions.items()
        ]
        if found.bonded is None:
            lines.append("  note         supports move apart: stresses of the continuum there grow with its mesh")
        return [head, apart, *lines]
    lines = [f"{head}; blocks: {found.blocks.status.name.lower()}"]
    return [*lines, apart.rstrip(", ")] if near == near else lines


def _force(value: Any, units: Units) -> str:
    return "none" if value is None else units.force_vector(value)


def strength_lines(found: StrengthComparison) -> list[str]:
    """Return the limit loads."""
    first, *rest = continuum_strength_words(found)
    return [f"  limit load   {first}", *(f"               {line}" for line in rest)]


def halving_lines(halving: BlockHalving, units: Units) -> list[str]:
    """Return the table of the halved blocks."""
    table = halving.table()
    factor, unit = units.factor("motion")
    heads = [f"{word} [{unit}]".rjust(14) for word in ("settle", "bonded")]
    lines = [f"  halving         blocks{''.join(heads)}{f'continuum [{unit}]':>16}  bonded apart    limit load"]
    for k, n in enumerate(halving.sizes):
        cells = [
            f"{table['blocks'][k]:12,d}",
            *(_cell(factor * table[f"settlement_{name}"][k], 14) for name in ("blocks", "bonded", "continuum")),
            _cell(100 * table["difference_bonded"][k], 12, " %"),
            _cell(table["limit_blocks"][k], 14),
        ]
        lines.append(f"  1/{n:<8d}" + "".join(cells))
    return lines


def _cell(value: float, width: int, unit: str = "") -> str:
    return (f"{value:.5g}{unit}" if np.isfinite(value) else "-").rjust(width)
