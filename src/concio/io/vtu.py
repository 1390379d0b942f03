"""VTU and PVD files, written by hand: unstructured grids of VTK with their data appended as base64.

The format is VTK's XML, version 1.0 with 64-bit headers: every array is ``base64(length)`` followed by
``base64(bytes)`` in the block of appended data, found by its offset. Numbers are little-endian; those that are read
again (stresses, forces, displacements) are in double precision.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

Array = np.ndarray

VERTEX, LINE, TRIANGLE, POLYGON, QUAD = 1, 3, 5, 7, 9
TETRAHEDRON, HEXAHEDRON, QUADRATIC_TETRAHEDRON, TRIQUADRATIC_HEXAHEDRON = 10, 12, 24, 29
"""Cell types of VTK."""

_NAMES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "i1": "Int8", "u1": "UInt8"}


@dataclass(frozen=True, eq=False)
class Grid:
    """An unstructured grid.

    Parameters
    ----------
    points : (p, 2) or (p, 3) array
        [m].
    connectivity : (k,) integer array
        Points of the cells, one cell after the other.
    offsets : (c,) integer array
        Where each cell ends in ``connectivity``.
    types : (c,) integer array
        Cell types of VTK.
    point_data, cell_data : mapping of str to arrays
        Scalars (n,), vectors (n, 2) made three-dimensional, or any (n, j).
    """

    points: Array
    connectivity: Array
    offsets: Array
    types: Array
    point_data: Mapping[str, Array] = field(default_factory=dict)
    cell_data: Mapping[str, Array] = field(default_factory=dict)


UNITS = "forces in kN, lengths in m, stresses in kN/m2, times in s"
"""Written at the head of every file, whose arrays have names alone."""


class _Appended:
    """Collects the arrays of the appended block."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.offset = 0

    def element(self, name: str, values: Array) -> str:
        """Store an array and return its DataArray element."""
        values = np.asarray(values)
        if values.dtype.kind == "b":
            values = values.astype(np.uint8)
        if values.ndim == 2 and values.shape[1] == 2:
            values = np.column_stack([values, np.zeros(len(values))])
        kind = f"{values.dtype.kind}{values.dtype.itemsize}"
        plain = np.ascontiguousarray(values, dtype=f"<{kind}" if values.dtype.itemsize > 1 else kind)
        raw = plain.tobytes()
        text = base64.b64encode(np.array([len(raw)], dtype="<u8").tobytes()) + base64.b64encode(raw)
        components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
        element = (
            f'<DataArray type="{_NAMES[kind]}" Name={quoteattr(name)}{components} format="appended" '
            f'offset="{self.offset}"/>'
        )
        self.parts.append(text)
        self.offset += len(text)
        return element


def write_vtu(grid: Grid, path: Path) -> Path:
    """Write a grid.

    Parameters
    ----------
    grid : Grid
    path : Path
        Ends in ``.vtu``.

    Returns
    -------
    Path
        ``path``.
    """
    data = _Appended()

    def section(tag: str, arrays: Mapping[str, Array]) -> str:
        return f"<{tag}>{''.join(data.element(k, v) for k, v in arrays.items())}</{tag}>"

    points = np.asarray(grid.points, dtype=float)
    cells: dict[str, Array] = {
        "connectivity": grid.connectivity.astype(np.int64),
        "offsets": grid.offsets.astype(np.int64),
        "types": grid.types.astype(np.uint8),
    }
    head = (
        f'<?xml version="1.0"?>\n<!-- {UNITS} -->\n'
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(grid.types)}">\n'
        f"{section('PointData', grid.point_data)}\n{section('CellData', grid.cell_data)}\n"
        f"{section('Points', {'points': points})}\n{section('Cells', cells)}\n"
        '</Piece></UnstructuredGrid>\n<AppendedData encoding="base64">_'
    )
    with path.open("wb") as file:
        file.write(head.encode("utf-8"))
        file.writelines(data.parts)
        file.write(b"</AppendedData>\n</VTKFile>\n")
    return path


def write_pvd(files: Sequence[Path], times: Sequence[float], path: Path) -> Path:
    """Write a time series: a list of files beside ``path`` with a time each.

    Parameters
    ----------
    files : sequence of Path
        In the directory of ``path`` or below.
    times : sequence of float
        Growing.
    path : Path
        Ends in ``.pvd``.

    Returns
    -------
    Path
        ``path``.
    """
    sets = "\n".join(
        f'<DataSet timestep="{float(t)!r}" part="0" file={quoteattr(f.relative_to(path.parent).as_posix())}/>'
        for f, t in zip(files, times, strict=True)
    )
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">\n<Collection>\n'
        f"{sets}\n</Collection>\n</VTKFile>\n",
        encoding="utf-8",
    )
    return path
