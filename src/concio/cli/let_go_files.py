"""What is written of a structure that was let go: the report of its motion, how it stood and stands, histories."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from concio.cli.motion_lines import write_motion
from concio.plot.motion_figure import plot_frame

if TYPE_CHECKING:
    from concio.analysis.motion.let_go import LetGo

FOLDER = "let_go"


def write_let_go(found: LetGo, place: Path, language: Literal["en", "it"] = "en") -> list[Path]:
    """Write a folder into the directory of a load step; return its files."""
    from matplotlib.figure import Figure

    folder = place / FOLDER
    folder.mkdir()
    names = write_motion(found.motion, folder, (), False, language, found.verdict)
    text = json.dumps(found.summary(), indent=2, ensure_ascii=False, allow_nan=False)
    (folder / "summary.json").write_text(text + "\n", encoding="utf-8")
    sheet = Figure(figsize=(11.0, 4.6), layout="constrained")
    for k, axes in zip((0, -1), sheet.subplots(1, 2), strict=True):
        plot_frame(found.motion, k, axes)
    for form in ("png", "svg"):
        sheet.savefig(folder / f"moved.{form}", dpi=150)
    return [folder / name for name in (*names, "moved.png")]
