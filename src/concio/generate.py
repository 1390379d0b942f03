"""Models of masonry from a few numbers: walls, arches, vaults, bridges, columns, rubble, periodic cells.

>>> from concio import generate
>>> model = generate.arch(span=2.0, ring=0.3, voussoirs=7)
>>> len(model.free_bodies)
7

The functions are those of ``concio`` itself. Beside them are the classes of openings, panels and lines of walls, and
the arguments that generators share.
"""

from __future__ import annotations

from concio.model.generate.arch_bridges import bridge
from concio.model.generate.arch_on_piers import arch_on_piers
from concio.model.generate.arches import arch
from concio.model.generate.barrel import barrel
from concio.model.generate.columns import buttress, column
from concio.model.generate.dome import dome
from concio.model.generate.drums import drums
from concio.model.generate.generator_arguments import Common
from concio.model.generate.groins import cloister_vault, cross_vault
from concio.model.generate.openings import Opening
from concio.model.generate.panel import running_bond_panel
from concio.model.generate.periodic_cells import cell
from concio.model.generate.plan import WallLine
from concio.model.generate.plan_walls import tower, walls
from concio.model.generate.rubble import rubble
from concio.model.generate.solid_masonry import CommonSpace
from concio.model.generate.wall_panels import Panel
from concio.model.generate.walls import wall, wall_of_courses

__all__ = [
    "Common",
    "CommonSpace",
    "Opening",
    "Panel",
    "WallLine",
    "arch",
    "arch_on_piers",
    "barrel",
    "bridge",
    "buttress",
    "cell",
    "cloister_vault",
    "column",
    "cross_vault",
    "dome",
    "drums",
    "rubble",
    "running_bond_panel",
    "tower",
    "wall",
    "wall_of_courses",
    "walls",
]
