"""Periodic cells of masonry: moduli, strength, strain paths, and walls beside their homogenised continuum.

>>> from concio import cells, generate
>>> cell = generate.cell(block_size=(0.25, 0.125), friction=0.6, block="rigid")
>>> isinstance(cells.strength(cell, 4, stress=(0.0, -100.0, 0.0), coulomb=False), cells.StrengthDomain)
True

The functions are those of ``concio`` itself. Beside them are the classes of their results.
:func:`concio.cell` makes cells.
"""

from __future__ import annotations

from concio.analysis.cells.cell_path import strain_path
from concio.analysis.cells.cell_path_result import CellPath
from concio.analysis.cells.moduli import Moduli, homogenise
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.cells.strength import StrengthDomain, strength
from concio.analysis.continuum.comparison import ContinuumComparison, compare_with_continuum
from concio.analysis.continuum.halving import BlockHalving, halve_blocks

__all__ = [
    "BlockHalving",
    "CellPath",
    "ContinuumComparison",
    "Moduli",
    "PeriodicCell",
    "StrengthDomain",
    "compare_with_continuum",
    "halve_blocks",
    "homogenise",
    "strain_path",
    "strength",
]
