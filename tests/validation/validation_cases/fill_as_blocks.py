r"""The fill on one side of an arch as Coulomb blocks, beside the rule that caps its horizontal pressure.

An arch of 3 m under an axle at a quarter of the span moves into the fill on the other side. There the fill above the
voussoirs is cut into columns, one on each, and ends in a wedge that can slide up a fixed plane at 45 - phi/2 degrees
from the springing: the passive mechanism of a smooth wall. Its weight is that of the fill; surfacing and the fill on
the loaded side are those of the rule. Beside it stands the rule: weight alone (k = 0), and weight with a pressure of
at most :math:`K_p(\varphi) \gamma z` on each voussoir.

The load that the columns carry depends on the friction of joints that cannot be measured. If the joint between fill and
arch is rough and the joints between columns are smooth, the blocks carry more than the rule: columns transfer pressure
from voussoir to voussoir, and the rule caps the pressure on each voussoir. If the arch is smooth, the columns slip off
and the blocks carry less than the rule. If the columns are rough as well, they form an arch of their own. Without
friction and with k = 1 both models are a fluid; they differ by the pressure that columns transfer. The results with
blocks cover a wide range, and the rule lies within it. The contribution of the soil has that uncertainty.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import concio
from concio.analysis.bridges.sweep import Sweep
from concio.model.model import Body, JointRule, Model
from concio.model.road.surface import Surface
from validation_cases.row import Row

SOURCE = "One model beside another; Rankine's passive pressure of a smooth wall."
OTHER = "two models of one fill"
SPAN, RISE, RING, COVER, SURFACING, GAMMA = 3.0, 0.75, 0.215, 0.30, 0.10, 20.0
PLACE = SPAN / 4
ANGLES = (10.0, 20.0, 30.0, 40.0)


def barrel(voussoirs: int = 16) -> Model:
    """Return the arch, 1 m wide."""
    return concio.bridge(span=SPAN, rise=RISE, ring=RING, voussoirs=voussoirs, width=1.0, block="rigid", friction=0.6,
                         unit_weight=22.0, abutment=4.0)  # fmt: skip


def _under_an_axle(model: Model, cover: float, passive: float) -> Model:
    filled = concio.with_fill(model, concio.Fill(cover=cover, unit_weight=GAMMA, passive=passive))
    return concio.with_vehicle(filled, concio.Vehicle("axle", (concio.Axle(0.0, 1.0),)))


def by_rule(passive: float, voussoirs: int = 16) -> Model:
    """Return the arch with fill by the rule."""
    return _under_an_axle(barrel(voussoirs), COVER, passive)


def by_blocks(angle: float, *, columns: float, arch: float, voussoirs: int = 16) -> Model:
    """Return the arch with blocks of fill on its right half.

    Parameters
    ----------
    angle : float
        Friction angle of the fill [degrees].
    columns, arch : float
        Friction between columns, and between fill and arch, as shares of that of the fill.
    voussoirs : int
    """
    bare = barrel(voussoirs)
    surface = Surface.of(bare)
    crown = surface.crown
    top = float(crown[1]) + COVER - SURFACING
    faces: dict[str, list[np.ndarray]] = {}
    for body, start, end in zip(surface.body.tolist(), surface.start, surface.end, strict=True):
        if bare.bodies[body].kind != "fixed" and start[0] >= crown[0] - 1e-9:
            faces.setdefault(bare.bodies[body].name, [start]).append(end)
    made = []
    for name, line in faces.items():
        above = np.array([[line[-1][0], top], [line[0][0], top]])
        made.append(Body(f"fill on {name}", np.vstack([np.array(line), above]), "soil", "rigid", layer="column"))
    foot, edge = max((line[-1] for line in faces.values()), key=lambda p: float(p[0])), surface.reach[1]
    far = float(foot[0]) + (top - float(foot[1])) / math.tan(math.radians(45 - angle / 2))
    wedge = np.array([foot, [far, top], [foot[0], top]])
    made.append(Body("wedge", wedge, "soil", "rigid", layer="wedge"))
    solid = np.array([foot, [edge, foot[1]], [edge, top], [far, top]])
    made.append(Body("behind the wedge", solid, kind="fixed", role="obstacle"))
    slope = math.tan(math.radians(angle))
    laws = {name: concio.JointLaw(share * slope)
            for name, share in (("fill on arch", arch), ("columns", columns), ("plane", 1.0))}  # fmt: skip
    rules = (JointRule("fill on arch", ("column", "voussoir")), JointRule("columns", ("column", "column")),
             JointRule("columns", ("column", "wedge")), JointRule("plane", ("wedge", "behind the wedge")))  # fmt: skip
    model = replace(
        bare, bodies=(*bare.bodies, *made), laws={**bare.laws, **laws}, rules=(*bare.rules, *rules),
        materials={**bare.materials, "soil": concio.Rigid(unit_weight=GAMMA)},
    )  # fmt: skip
    return _under_an_axle(model, SURFACING, rankine(angle))


def rankine(angle: float) -> float:
    """Return K_p of a friction angle in degrees."""
    return math.tan(math.radians(45 + angle / 2)) ** 2


@cache
def bound(kind: str, angle: float = 0.0, columns: float = 0.0, arch: float = 1.0) -> float:
    """Return the axle load beyond which nothing is in equilibrium [kN]: of "weight", "rule" or "blocks"."""
    if kind == "blocks":
        model = by_blocks(angle, columns=columns, arch=arch)
    else:
        model = by_rule(0.0 if kind == "weight" else rankine(angle))
    found = Sweep(model).at(PLACE)
    assert found is not None
    assert found.limit.checked
    return found.multiplier


@cache
def coulomb(angle: float, columns: float, arch: float) -> float:
    """Return the axle load that certified Coulomb states carry as it grows on the blocks [kN]."""
    model = by_blocks(angle, columns=columns, arch=arch)
    assert model.vehicle is not None
    placed = concio.with_vehicle(model, replace(model.vehicle, position=PLACE))
    return concio.limit(placed, "live", path=False, steps=True, search=False).design


JOINTS = (
    ("smooth columns, rough arch", 0.0, 1.0), ("smooth columns, smooth arch", 0.0, 0.0),
    ("rough columns, smooth arch", 1.0, 0.0), ("rough columns, rough arch", 1.0, 1.0),
)  # fmt: skip


def fluid() -> Row:
    """Return blocks without friction beside the rule with k = 1."""
    handed = "columns hand pressure on, the rule caps it on each voussoir"
    return Row("no friction, k = 1: rule and blocks", bound("rule", 0.0), bound("blocks", 0.01, 0.0, 0.0), 0.05, handed,
               "kN", check="second method")  # fmt: skip


def rows() -> list[Row]:
    found = [fluid()]
    found += [
        Row(f"phi = {angle:g} degrees, blocks with {text}, beside the rule", bound("rule", angle),
            bound("blocks", angle, columns, arch), 0, OTHER, "kN", check="other model")
        for angle in ANGLES for text, columns, arch in JOINTS
    ]  # fmt: skip
    for text, columns, arch in JOINTS:
        above = float(coulomb(30.0, columns, arch) <= bound("blocks", 30.0, columns, arch) * (1 + 1e-9))
        found.append(Row(f"phi = 30 degrees, {text}: Coulomb states at or below the bound", 1.0, above, 0, "yes or no"))
    return found


def figure(axes: Any) -> None:
    angles = (0.01, *ANGLES)
    for (text, columns, arch), dash in zip(JOINTS, ("-", ":", "-.", "--"), strict=True):
        loads = [bound("blocks", a, columns, arch) for a in angles]
        axes.plot(angles, loads, dash, color="#222222", lw=1.0, label=text)
    axes.plot(angles, [bound("rule", a) for a in angles], "-", color="#D55E00", label="rule")
    axes.axhline(bound("weight"), color="#888888", lw=0.8)
    axes.annotate("weight alone", (40.0, bound("weight")), (0, 3), textcoords="offset points", ha="right", fontsize=8)
    axes.set_xlabel("friction angle of the fill [degrees]")
    axes.set_ylabel("axle load [kN]")
    axes.set_ylim(0, None)
    axes.legend(frameon=False, fontsize=7)
    axes.set_title("Fill as blocks and as a rule, bound at a quarter of the span", fontsize=9, loc="left")
