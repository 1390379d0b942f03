"""Files: result directories, CSV, VTU and PVD for ParaView, DXF."""

from __future__ import annotations

from concio.io.paraview import write_paraview
from concio.io.result_dir import write_result
from concio.io.result_file import load_result, save_result

__all__ = ["load_result", "save_result", "write_paraview", "write_result"]
