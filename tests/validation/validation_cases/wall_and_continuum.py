r"""A wall of blocks beside its homogenised continuum: exact cases, halved blocks, and the paper's panel.

*From both sides.* A long low wall on a smooth base slides at the coefficient of the base; joints that crush do so at
their strength: stresses and mechanism of the continuum both give the exact number. The programmes alone, with a
material of :math:`|\sigma_1 - \sigma_2| \le 2c` (a polygon of 24 sides around Mohr's circle), enclose Prandtl's
:math:`(2 + \pi) c` under a strip.

*Halved blocks.* The limit load of a dry wall of 3.2 x 2.1 m approaches that of the continuum; what is left goes with
the size of the blocks. So does the difference of displacements between bonded blocks and the continuum.

*The paper's panel* hangs between two walls. With all joints closed and stuck, blocks and continuum agree. With
joints that open, the panel is an arch that settles ten times as far (figure). A continuum with the strength of the cell
cannot carry the load at all, while the blocks carry any multiple of it: their size is finite.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import concio
from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.continuum.comparison import ContinuumComparison
from concio.analysis.continuum.continuum import continuum_of
from concio.analysis.continuum.halving import BlockHalving
from concio.analysis.continuum.kinematic_bound import kinematic_bound
from concio.analysis.continuum.static_bound import static_bound
from validation_cases.row import Row

SOURCE = (
    "P. de Buhan and G. de Felice, J. Mech. Phys. Solids 45 (1997) 1085-1104 (limit loads of homogenised brickwork as"
    " limits for small blocks); L. Prandtl (1920) for the strip; A. Ercolano's paper for the panel."
)

STONE = concio.Rigid(unit_weight=20.0)


@cache
def sliding() -> ContinuumComparison:
    wall = concio.wall(
        length=4.8, height=0.7, block_size=(0.8, 0.35), friction=0.65, base_friction=0.2, block=STONE, horizontal=1.0
    )
    return concio.compare_with_continuum(wall, elastic=False)


@cache
def crushing() -> ContinuumComparison:
    law = concio.JointLaw(0.6, cohesion=50.0, tensile_strength=20.0, compressive_strength=3000.0)
    wall = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), block=STONE, friction=law, top_pressure=1.0)
    loads = tuple(replace(v, group="live") for v in wall.loads if v.kind == "pressure")
    return concio.compare_with_continuum(replace(wall, loads=loads), elastic=False)


@cache
def strip() -> tuple[float, float]:
    """Pressure on a strip over the cohesion: at least, at most."""
    turn = 2 * np.pi * (np.arange(24) + 0.5) / 24
    faces = HalfSpaces.of(np.column_stack([np.cos(turn) / 2, -np.cos(turn) / 2, np.sin(turn)]), np.ones(24))
    glue = concio.JointLaw(0.6, cohesion=1e4, tensile_strength=1e4)
    wall = concio.wall(length=4.0, height=1.5, block_size=(0.5, 0.25), block=STONE, side_walls=True, friction=glue)
    load = concio.Load("pressure", (1.0,), edge=((1.5, 1.5), (2.5, 1.5)), group="live")
    mesh = continuum_of(concio.assemble(replace(wall, loads=(load,))), 0.5)
    low = static_bound(mesh, faces, {"live": 0.0}, {"live": 1.0})
    high = kinematic_bound(mesh, faces, {"live": 0.0}, {"live": 1.0})
    return low.multiplier, high.multiplier


@cache
def pushed() -> BlockHalving:
    def make(n: int) -> concio.Model:
        return concio.wall(
            length=3.2, height=2.1, block_size=(0.8 / n, 0.35 / n), friction=0.65, block=STONE, horizontal=1.0
        )

    return concio.halve_blocks(make, sizes=(1, 2, 4, 8), elastic=False)


@cache
def pressed() -> BlockHalving:
    def make(n: int) -> concio.Model:
        law = concio.JointLaw(0.65, normal_stiffness=3e5 * n, tangential_stiffness=1.2e5 * n)
        return concio.wall(
            length=3.2, height=2.1, block_size=(0.8 / n, 0.35 / n), friction=law, side_walls=True, top_pressure=100.0,
            block=concio.Elastic(1e6, 0.2, unit_weight=20.0),
        )  # fmt: skip

    return concio.halve_blocks(make, sizes=(1, 2, 4), strength=False)


@cache
def panel(times: int = 1) -> ContinuumComparison:
    mortar = concio.Elastic(E=1e5, nu=0.15)
    model = concio.running_bond_panel(
        courses=3 * times, blocks=6 * times, block_size=(0.2 / times, 0.1 / times), joint=0.02 / times, thickness=0.1,
        block=mortar, mortar=mortar, friction=1.0, base="none", top_pressure=10.0,
    )  # fmt: skip
    return concio.compare_with_continuum(model, live="top", strength=times == 1)


def rows() -> list[Row]:
    both = "constant stresses and rigid motions are in the space of any mesh"
    found = []
    for name, case, value, unit in (
        ("sliding on the base", sliding(), 0.2, "-"),
        ("crushing under pressure", crushing(), 3000.0, "kN/m2"),
    ):
        low, high = case.strength.bracket
        found += [
            Row(f"{name}: stresses of the continuum", value, low, 1e-8, both, unit),
            Row(f"{name}: mechanism of the continuum", value, high, 1e-8, both, unit),
        ]
    low, high = strip()
    coarse = "a mesh of half the strip's width"
    found += [
        Row("strip on cohesive ground, over c: stresses", 2 + np.pi, low, 0.1, coarse),
        Row("strip on cohesive ground, over c: mechanism", 2 + np.pi, high, 0.1, coarse),
    ]
    halved = pushed()
    low, high = halved.bracket
    last = halved.associated
    found.append(
        Row(
            "pushed wall: limit load for vanishing blocks, from those 4 and 8 times smaller",
            (low + high) / 2,
            float(2 * last[-1] - last[-2]),
            (high - low) / (high + low),
            "the continuum's own is known to half its bracket only; the blocks' error is taken as in proportion",
            check="second method",
        )
    )
    apart = pressed().table()["difference_bonded"]
    found.append(
        Row(
            "pressed wall between walls, bonded: difference from the continuum, blocks halved twice", 0.25,
            float(apart[2] / apart[0]), 0.5, "of first order in the size up to corners, where stresses are singular",
        )
    )  # fmt: skip
    _, bonded, smooth = panel().elastic.settlements
    found.append(
        Row("Ercolano's panel, bonded: settlement", smooth, bonded, 0.03, "three courses only", "m",
            check="second method")
    )  # fmt: skip
    found.append(
        Row("Ercolano's panel as a material with the strength of its cell: load carried", 0.0,
            panel().strength.bracket[1], 1e-9, "a mechanism of the continuum without resistance", check="second method")
    )  # fmt: skip
    return found


def figure(axes: Any) -> None:
    for times, mark in ((1, "o-"), (2, "s-")):
        found = panel(times).elastic
        low = np.abs(found.centres[:, 1] - 0.05 / times) < 1e-6
        order = np.argsort(found.centres[low, 0])
        x = found.centres[low, 0][order]
        blocks, bonded, smooth = (-1e3 * u[low][order, 1] for u in found.displacements)
        size = "blocks" if times == 1 else "blocks half as large"
        axes.plot(x, blocks, mark, ms=3, lw=1, label=size)
        if times == 1:
            axes.plot(x, bonded, "k^", ms=4, label="blocks bonded")
            axes.plot(x, smooth, "k-", lw=1, label="homogenised")
    axes.invert_yaxis()
    axes.set(xlabel="x along the lowest course [m]", ylabel="settlement [mm]")
    axes.legend(fontsize=8)
