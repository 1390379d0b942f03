"""What ``concio cell --out`` writes: numbers for a finite element program, tables and figures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cells.cell_path_result import CellPath
from concio.analysis.cells.moduli import Moduli
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.cells.strength import StrengthDomain
from concio.cli.cell_lines import cell_facts
from concio.cli.outcome import plain
from concio.contact.macroscopic_strain import COMPONENTS
from concio.io.csv_table import write_csv

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_DRAWN = 6
"""Mechanisms of this many directions at most are drawn."""


def write_cell(
    cell: PeriodicCell, moduli: Moduli | None, domain: StrengthDomain | None, path: CellPath | None, place: Path
) -> list[str]:
    """Write summary, tables and figures; return the names of the files."""
    from concio.plot.model_figure import plot_model

    text = json.dumps(plain(cell_facts(cell, moduli, domain, path)), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    written = ["summary.json", *_draw(plot_model(cell.model), place / "cell")]
    if moduli is not None:
        table = {"stress": np.array(COMPONENTS)}
        table |= {f"by_strain_{name} [kN/m2]": moduli.matrix[:, k] for k, name in enumerate(COMPONENTS)}
        write_csv(table, place / "moduli.csv")
        written += ["moduli.csv", *_draw(moduli.plot.polar(), place / "moduli")]
    if domain is not None:
        written += _write_strength(domain, place)
    if path is not None:
        write_csv(path.table(), place / "path.csv")
        written += ["path.csv", *_draw(path.plot.curve(), place / "path")]
        written += _draw(path.plot.state(), place / "path_end")
    return written


def _write_strength(domain: StrengthDomain, place: Path) -> list[str]:
    written = []
    if domain.rays:
        write_csv(domain.table(), place / "strength.csv")
        written.append("strength.csv")
    if domain.domain is not None:
        write_csv(domain.face_table(), place / "half_spaces.csv")
        written += ["half_spaces.csv", *_draw(domain.plot.sections(), place / "strength_yy_xy")]
        written += _draw(domain.plot.sections(along="xx", up="yy"), place / "strength_xx_yy")
        written += _draw(domain.plot.uniaxial(), place / "strength_by_direction")
        written += _draw(domain.plot.surface(), place / "strength_surface")
    for k, ray in enumerate(domain.rays[:MOST_DRAWN]):
        if ray.associated.mechanism is not None:
            written += _draw(domain.plot.mechanism(k), place / f"mechanism_{k + 1}")
    return written


def _draw(axes: Axes | Any, place: Path) -> list[str]:
    """Save a figure as PNG and SVG; return the names of both."""
    from matplotlib.figure import Figure

    figure = axes.figure
    assert isinstance(figure, Figure)
    names = [f"{place.name}.{form}" for form in ("png", "svg")]
    for name in names:
        figure.savefig(place.with_name(name), dpi=150)
    return names
