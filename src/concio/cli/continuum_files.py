"""What ``concio continuum --out`` writes: tables, and figures side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.continuum.comparison import ContinuumComparison
from concio.analysis.continuum.halving import BlockHalving
from concio.cli.continuum_lines import continuum_facts
from concio.cli.outcome import plain
from concio.io.csv_table import write_csv


def write_continuum(found: ContinuumComparison, halving: BlockHalving | None, place: Path) -> list[str]:
    """Write summary, tables and figures; return the names of the files."""
    text = json.dumps(plain(continuum_facts(found, halving)), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    written = ["summary.json"]
    if found.elastic is not None:
        write_csv(found.elastic.table(), place / "blocks.csv")
        written += ["blocks.csv", *_draw(found.plot.displacement(), place / "displacement")]
        elastic = all(b.kind != "rigid" for b in found.assembly.model.bodies)
        if found.elastic.blocks.solved and elastic:
            for name in ("yy", "xx", "xy"):
                written += _draw(found.plot.stress(component=name), place / f"stress_{name}")
    if found.strength is not None:
        strength = found.strength
        if strength.blocks.associated.mechanism is not None and strength.kinematic.multiplier < np.inf:
            written += _draw(found.plot.mechanism(), place / "mechanism")
    if halving is not None:
        write_csv(halving.table(), place / "halving.csv")
        written.append("halving.csv")
        if np.isfinite(halving.associated).any():
            written += _draw([halving.plot.limit()], place / "halving_limit")
        if found.elastic is not None:
            written += _draw([halving.plot.difference()], place / "halving_displacement")
    return written


def _draw(axes: list[Any], place: Path) -> list[str]:
    """Save a figure as PNG and SVG; return the names of both."""
    names = [f"{place.name}.{form}" for form in ("png", "svg")]
    for name in names:
        axes[0].figure.savefig(place.with_name(name), dpi=150)
    return names
