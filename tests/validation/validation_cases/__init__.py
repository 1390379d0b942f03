"""Validation cases: each module computes its rows once; tests check them and the validation book prints them.

A module has ``SOURCE`` (citation), ``rows()`` (a list of :class:`validation_cases.row.Row`) and, where a picture helps,
``figure(axes)``. Results are cached inside a module, so that a test and the book do not compute them twice.
"""

from __future__ import annotations

CASES: dict[str, str] = {
    "patch": "Uniform states and bending through joints",
    "ercolano_panel": "Ercolano's panel",
    "ferris_tin_loi": "Walls of Ferris and Tin-Loi",
    "semicircular_arch": "Least thickness of a semicircular arch",
    "arch_and_friction": "A semicircular arch at falling friction, and with vertical joints",
    "flat_arch": "Flat arch with spreading abutments",
    "arch_bridges": "Arch bridges with fill under an axle",
    "fill_as_blocks": "Fill as blocks beside fill as a rule",
    "loaded_bridges": "Bridges that were loaded to failure",
    "block_on_base": "Block that slides or topples",
    "worked_examples": "Worked examples of open textbooks",
    "corners_and_edges": "Blocks on corners and edges",
    "stack_between_walls": "Wall friction in a stack between walls",
    "strip_on_base": "Elastic strip pulled along a base",
    "pillar": "Pillar without tension under an eccentric load",
    "hertz": "Cylinder on a flat base",
    "flat_punch": "Rigid flat punch",
    "one_node": "One node, large friction",
    "cantilever_wall": "Cantilever walls",
    "local_mechanisms": "Local mechanisms under an earthquake",
    "granite_walls": "Dry granite walls in shear and compression",
    "homogenised_cells": "Homogenised running bond",
    "wall_and_continuum": "Walls beside their homogenised continuum",
    "blocks_in_space": "Blocks in space, pushed in any direction",
    "held_by_friction": "Ladders, wedges and hung blocks",
    "corner_walls": "Walls with corners",
    "dome_thickness": "Least thickness of a dome",
    "solid_elements": "Elastic blocks in space: patch tests and bending",
    "sphere_on_base": "Sphere and cube on a plane, pressed and pushed",
    "rocking_block": "Free-standing blocks that rock",
    "moving_blocks": "Blocks that fly, slide, bounce and are pushed over",
    "motion_in_space": "Rigid blocks that move in space",
    "mesh_orders": "Orders of convergence",
}
"""Name of each module and the title of its section in the validation book, in the book's order."""
