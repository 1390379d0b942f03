"""What ``concio bridge --out`` writes: the numbers, the curve over positions, sensitivities."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.bridges.bridge_result import BridgeResult
from concio.io.csv_table import write_csv


def write_bridge(found: BridgeResult, told: dict[str, Any], place: Path, language: str) -> list[str]:
    """Write summary, curve and sensitivities into a directory; return the names of the files."""
    from concio.cli.outcome import plain

    text = json.dumps(plain(told), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    write_csv(found.curve(), place / "curve.csv")
    written = ["summary.json", "curve.csv"]
    if found.changes:
        columns = {key: np.array([getattr(c, key) for c in found.changes])
                   for key in ("name", "unit", "low", "high", "at_low", "at_high")}  # fmt: skip
        write_csv(columns, place / "sensitivity.csv")
        written.append("sensitivity.csv")
    return written
