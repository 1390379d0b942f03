"""Tables as CSV: a heading of names with units, numbers that read back to the last bit.

Texts that a spreadsheet would take for a formula get an apostrophe in front.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from concio.files import guarded
from concio.post.result_tables import UNITS

Array = np.ndarray


def write_csv(table: Mapping[str, Array], path: Path, units: Mapping[str, str] = UNITS) -> Path:
    """Write a table.

    Parameters
    ----------
    table : mapping of str to (n,) array
        Columns; those named in ``units`` get their unit in the heading.
    path : Path
    units : mapping of str to str
        Of columns by name; none where the user names columns, whose units are not those of results.

    Returns
    -------
    Path
        ``path``.
    """
    heading = [f"{name} [{units[name]}]" if name in units else name for name in table]
    columns = [_texts(column) for column in table.values()]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([guarded(name) for name in heading])
        writer.writerows(zip(*columns, strict=True))
    return path


def _texts(column: Array) -> list[str]:
    if column.dtype.kind == "f":
        return ["" if np.isnan(v) else repr(v) for v in column.tolist()]
    if column.dtype.kind == "b":
        return ["yes" if v else "no" for v in column.tolist()]
    return [guarded(v) if isinstance(v, str) else str(v) for v in column.tolist()]
