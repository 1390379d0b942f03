"""What ``concio limit --out`` writes: numbers, and a figure of each mechanism."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.limit import LimitResult
from concio.analysis.result import Result
from concio.problem.solution import Mechanism, Status, failed

Array = np.ndarray


def write_limit(found: LimitResult, groups: list[str], told: dict[str, Any], place: Path) -> list[str]:
    """Write ``summary.json`` and the figures there are; return the names of the files."""
    text = json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    named, written = "' and '".join(groups), ["summary.json"]
    bound = found.associated
    if bound.mechanism is not None:
        title = f"Associated mechanism at {bound.multiplier:.6g} times the load of '{named}'"
        note = "joints that slide open by the friction coefficient times their slip"
        written += _draw(found, bound.mechanism.velocity, title, note, place / "associated_mechanism")
    if found.collapse_state is not None:
        title = f"Coulomb collapse state at {found.collapse_state.multiplier:.6g} times the load of '{named}'"
        written += _draw(found, found.collapse_state.velocity, title, "joints that slide stay closed",
                         place / "collapse_state")  # fmt: skip
    if found.path is not None and np.abs(found.path.direction).any():
        end = "end of the Coulomb path" if found.collapse_shown else "point where the Coulomb path was lost"
        title = f"Motion at the {end}, peak {found.carried:.6g} times the load of '{named}'"
        written += _draw(found, found.path.direction, title, "joints that slide stay closed", place / "path_mechanism")
    return written


def _draw(found: LimitResult, velocity: Array, title: str, note: str, place: Path) -> list[str]:
    """Draw a motion (N,) of the free unknowns as PNG and SVG."""
    from matplotlib.figure import Figure

    from concio.plot.deformed import plot_mechanism

    assembly = found.assembly
    motion = Mechanism(velocity / float(np.abs(velocity).max()), 0.0, 0.0)
    solution = failed(assembly.problem(), Status.NO_EQUILIBRIUM, method="limit", mechanism=motion)
    figure = plot_mechanism(Result(assembly, {}, solution, {}), title=title, note=note).figure
    assert isinstance(figure, Figure)
    names = [f"{place.name}.{form}" for form in ("png", "svg")]
    for name in names:
        figure.savefig(place.with_name(name), dpi=150)
    return names
