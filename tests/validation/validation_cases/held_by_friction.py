r"""Blocks that friction alone holds: ladders, wedges, and blocks hung between walls.

A ladder of even weight on a floor (friction mu1) against a wall (mu2) stands while
:math:`\tan\theta \ge (1 - \mu_1 \mu_2) / (2 \mu_1)`. The one here has a foot and a head of width w that lie flat; with
its head at (X, Z) and its weight at x_g the forces act at their ends, :math:`(x_g - w)(1 + \mu_1 \mu_2) = \mu_1 Z +
\mu_1 \mu_2 (X - w)` at the limit.

A block wider below than above, between two fixed plates that lean towards each other by 30 degrees, is held from
tan 30 degrees on: the plates push it down, friction up. Between two vertical plates, forces in balance exist at any
friction; they need a clamping force. There is no clamping force here, so that the block falls. A wedge on the face of a
notch slides off a slope of 30 degrees at tan 30 degrees, off one of 60 degrees at tan 60 degrees. Papers on rigid
blocks use these shapes for comparisons. The rows give the least friction that admits forces in balance. A static
programme, which ignores how forces arise, accepts all of them.
"""

from __future__ import annotations

import numpy as np

import concio
from concio.model.surfaces import prism
from concio.problem.solution import Status
from concio.solvers.statics.friction import smallest_friction
from validation_cases.row import Row

SOURCE = "closed forms; shapes as in G. T.-C. Kao et al., Coupled rigid-block analysis, CAD 146 (2022), own dimensions."

STONE = {"stone": concio.Rigid(unit_weight=1.0)}
WIDTH = 0.05
BRACKET = "bracketed by proofs to 1e-7"


def slab(name: str, outline: list[tuple[float, float]], *, fixed: bool = False) -> concio.Polyhedron:
    """A prism one deep over an outline in the x-z plane, counter-clockwise seen from the front (from -y)."""
    ring = np.array([(x, 1.0, z) for x, z in outline])
    kind = "fixed" if fixed else "rigid"
    return prism(name, [ring], np.array([0.0, -1.0, 0.0]), kind=kind, material="stone")


def between_plates(lean: float) -> concio.Model:
    """A block held by two fixed plates; each leans inward at its top by an angle [degrees]."""
    off = float(np.tan(np.radians(lean)))
    low, high = 1.2, 1.2 - 0.8 * off
    middle = slab("block", [(-low, 0.0), (low, 0.0), (high, 0.8), (-high, 0.8)])
    foot, head = low + 0.5 * off, high - 0.6 * off
    right = slab("right", [(foot, -0.5), (foot + 0.3, -0.5), (head + 0.3, 1.4), (head, 1.4)], fixed=True)
    left = slab("left", [(-foot, -0.5), (-head, 1.4), (-head - 0.3, 1.4), (-foot - 0.3, -0.5)], fixed=True)
    return concio.Model((left, right, middle), STONE, {"joint": concio.JointLaw(0.7)}, loads=(DOWN,))


DOWN = concio.Load("weight", (0.0, 0.0, -1.0))


def wedge_on_its_side(slope: float) -> concio.Model:
    """A wedge in a notch between two fixed blocks, gravity across the notch: one face is a slope [degrees]."""
    t = float(np.tan(np.radians(slope)))
    wedge = slab("wedge", [(0.0, 0.0), (1.0, t), (1.3, t), (1.3, -t), (1.0, -t)][::-1])
    low, high = -1.6 * t, 1.6 * t
    below = slab("below", [(0.0, 0.0), (-0.5, 0.0), (-0.5, low), (1.0, low), (1.0, -t)], fixed=True)
    above = slab("above", [(0.0, 0.0), (1.0, t), (1.0, high), (-0.5, high), (-0.5, 0.0)], fixed=True)
    return concio.Model((below, above, wedge), STONE, {"joint": concio.JointLaw(0.7)}, loads=(DOWN,))


def ladder(height: float, foot: float, wall: float, width: float = WIDTH) -> concio.Model:
    """A ladder whose head is 2 from its foot along the floor and ``height`` above it; friction of floor and wall."""
    bar = slab("ladder", [(0.0, 0.0), (width, 0.0), (2.0, height - width), (2.0, height)])
    bodies = (
        concio.Polyhedron.box("floor", (-1.0, -1.0, -1.0), (3.0, 2.0, 0.0), kind="fixed", role="floor"),
        concio.Polyhedron.box("wall", (2.0, -1.0, 0.1), (3.0, 2.0, 9.0), kind="fixed", role="wall"),
        bar,
    )
    laws = {name: concio.JointLaw(friction) for name, friction in (("floor", foot), ("wall", wall))}
    rules = tuple(concio.JointRule(name, (name, "ladder")) for name in laws)
    return concio.Model(bodies, STONE, laws, rules=rules, loads=(DOWN,))


def least(model: concio.Model) -> float:
    """Least friction at which forces in balance exist; nan where its bracket of proofs is wider than 1e-4."""
    margin = smallest_friction(concio.assemble(model).problem())
    return 0.7 * margin.factor if margin.factor - margin.below <= 1e-4 else np.nan


def ladder_height(foot: float, wall: float) -> float:
    """Height of the head at which the ladder of the model, with its width, begins to slide."""
    low, high = 0.1, 9.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        arm = float(ladder(middle, foot, wall).polyhedra[2].centroid[0]) - WIDTH
        short = arm * (1 + foot * wall) > foot * middle + foot * wall * (2.0 - WIDTH)
        low, high = (middle, high) if short else (low, middle)
    return high


def stands(model: concio.Model) -> float:
    """1 where a certified equilibrium was found, 0 where it was proven that there is none, nan for neither."""
    result = concio.solve(model, on_failure="return")
    if result.solved:
        return 1.0
    return 0.0 if result.solution.status in (Status.NO_EQUILIBRIUM, Status.COLLAPSES) else np.nan


def rows() -> list[Row]:
    found = []
    for lean in (30.0, 15.0, 0.0):
        friction = least(between_plates(lean))
        tangent = float(np.tan(np.radians(lean)))
        found.append(
            Row(f"least friction of a block between plates that lean in by {lean:g} degrees", tangent, friction, 1e-4,
                "there forces grow without bound, and proofs end", absolute=True)
        )  # fmt: skip
    held = between_plates(0.0)
    result = concio.solve(held, on_failure="return")
    weight = float(held.polyhedra[2].volume)
    found += [
        Row("between vertical plates, friction 0.7: is held", 0.0, stands(held), 0.0, "yes or no"),
        Row("least sum of compressions that could hold it, over its weight", 1 / 0.7,
            result.self_stress.compression / weight, 1e-7, "closed form"),
    ]  # fmt: skip
    for slope in (30.0, 60.0):
        tangent = float(np.tan(np.radians(slope)))
        friction = least(wedge_on_its_side(slope))
        words = f"least friction of a wedge on a slope of {slope:g} degrees"
        found.append(Row(words, tangent, friction, 1e-6, BRACKET))
    for foot, wall in ((0.4, 0.2), (0.3, 0.6), (0.25, 0.0)):
        height = ladder_height(foot, wall)
        found += [
            Row(f"ladder, friction {foot:g} and {wall:g}, at {share:g} of the height: stands", holds,
                stands(ladder(share * height, foot, wall)), 0.0, "yes or no")
            for share, holds in ((1.0005, 1.0), (0.9995, 0.0))
        ]  # fmt: skip
    return found
