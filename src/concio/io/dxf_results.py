"""A plane result as a DXF drawing: the model as it was, and what was found on layers of its own.

Blocks keep their layers and names (:mod:`concio.io.dxf_out`). What was found has layers that begin with
``CONCIO_RESULT_``; :mod:`concio.model.drawing.dxf` leaves them out, so that the drawing reads back as the model.

``JOINTS``
    Every joint.
``OPEN``, ``SLIPS``
    Joints that are open, and that slip; where the structure is not in equilibrium, in its mechanism.
``FORCES``, ``FORCE_VALUES``
    The resultant of each joint, a line through the point where it acts; the largest is a twelfth of the drawing. Its
    size in numbers.
``HINGES``
    A circle where a resultant crosses a joint at its edge.
``DEFORMED``
    Outlines with displacements, and their scale.
``MECHANISM``
    Outlines moved by the mechanism.
``LOADS``, ``TIES``
    Loads on edges and at points, with their values; ties, with their forces.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.thrust import hinges
from concio.contact.factors import load_factor
from concio.io.dxf_out import Drawn, layer_of, unit_of, write_dxf
from concio.kinematics.frames import turned_left
from concio.plot.model_figure import load_arrows
from concio.post.force_lines import joint_forces
from concio.post.joint_lines import JointLines, joint_lines
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import STILL, Outlines, anything_moves, display_scale, outlines
from concio.problem.pair_state import PairState

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

HEAD = "CONCIO_RESULT_"
COLOURS = {
    "JOINTS": 8, "OPEN": 30, "SLIPS": 6, "FORCES": 5, "FORCE_VALUES": 5, "HINGES": 1, "DEFORMED": 9, "MECHANISM": 1,
    "LOADS": 3, "TIES": 4,
}  # fmt: skip
"""Layers of results with the AutoCAD colour index of each."""
LONGEST, MOVED, TEXT, RADIUS = 1 / 12, 0.05, 0.012, 0.008
"""Longest force, largest displacement, height of texts and radius of hinges, as shares of the drawing."""


def write_results_dxf(path: str | Path, result: Result, *, scale: float | None = None, unit: str | None = None) -> None:
    """Write a plane result as a DXF drawing with what was found on layers of its own.

    Parameters
    ----------
    path : str or Path
    result : Result
    scale : float, optional
        Of the displacements of the deformed outlines; by default a round one.
    unit : str, optional
        Of the drawing; by default that of the drawing the model was read from, else m.

    Raises
    ------
    InputError
        ezdxf is not installed, or the unit is unknown.
    """
    bodies = result.model.outlines
    write_dxf(
        path, [b.name for b in bodies], [b.rings[0] for b in bodies],
        layers=[layer_of(result.model, b) for b in bodies], holes=[b.rings[1:] for b in bodies],
        unit=unit or unit_of(result.model), colours={HEAD + name: colour for name, colour in COLOURS.items()},
        more=list(_drawn(result, scale)),
    )  # fmt: skip


def _drawn(result: Result, scale: float | None) -> Iterator[Drawn]:
    """Return what was found, piece by piece."""
    rest = outlines(result)
    moves = None if result.solved or result.mechanism is None else result.mechanism_velocity
    shown = rest if moves is None else outlines(result, moves)
    pieces = joint_lines(result, shown)
    for ends in pieces.ends:
        yield Drawn(HEAD + "JOINTS", ends)
    yield from _loads(result, rest.size)
    if moves is not None:
        yield from _states(pieces, mechanism_states(result, pieces))
        speed = float(np.hypot(*shown.displacement.T).max(initial=0.0))
        yield from _moved("MECHANISM", shown, MOVED * shown.size / (speed or 1.0))
    if result.solved:
        yield from _states(pieces, result.contacts.state)
        yield from _forces(result, rest.size)
        largest = float(np.hypot(*rest.displacement.T).max(initial=0.0))
        factor = display_scale(largest, rest.size, MOVED) if scale is None else scale
        yield from _moved("DEFORMED", rest, factor)
        note = f"displacements x {factor:g}; largest {result.model.report.text('motion', largest)}"
        note = note if anything_moves(largest, rest.size) else STILL
        corner = rest.points.min(axis=0) - [0.0, 4 * TEXT * rest.size]
        yield Drawn(HEAD + "DEFORMED", corner[None], text=note, size=TEXT * rest.size)
        yield from _ties(result, rest.size)


def _states(pieces: JointLines, state: Array) -> Iterator[Drawn]:
    """Return the joints that are open and that slip; ``state`` is that of each piece, or of each pair."""
    own = state if len(state) == len(pieces.pair) else state[pieces.pair]
    for name, code in (("OPEN", PairState.OPEN), ("SLIPS", PairState.SLIP)):
        for ends in pieces.ends[own == code]:
            yield Drawn(HEAD + name, ends)


def _moved(name: str, shown: Outlines, scale: float) -> Iterator[Drawn]:
    for rings in shown.moved(scale):
        for ring in rings:
            yield Drawn(HEAD + name, ring[:-1], closed=True)


def _forces(result: Result, size: float) -> Iterator[Drawn]:
    """Return the resultants of the joints with their values, and circles at hinges."""
    found, units = joint_forces(result), result.model.report
    largest = float(found.size.max(initial=0.0))
    for point, force, value in zip(found.point, found.force, found.size.tolist(), strict=True):
        half = 0.5 * LONGEST * size * force / largest
        yield Drawn(HEAD + "FORCES", np.array([point - half, point + half]))
        yield Drawn(HEAD + "FORCE_VALUES", (point + half)[None], text=units.text("force", value), size=TEXT * size)
    for hinge in hinges(result):
        yield Drawn(HEAD + "HINGES", np.array([hinge.at]), size=RADIUS * size)


def _loads(result: Result, size: float) -> Iterator[Drawn]:
    """Return arrows of the loads on edges and at points, with the load factors of their groups."""
    for load in result.model.loads:
        arrows = load_arrows(load, result.model.report)
        if arrows is None:
            continue
        tips, way, words = arrows
        tails = tips - LONGEST * size * way
        across = turned_left(way)
        barb = 0.2 * LONGEST * size
        for tip, tail, w, c in zip(tips, tails, way, across, strict=True):
            yield Drawn(HEAD + "LOADS", np.array([tail, tip]))
            yield Drawn(HEAD + "LOADS", np.array([tip - barb * (w - 0.4 * c), tip, tip - barb * (w + 0.4 * c)]))
        factor = load_factor(result.factors, load.group)
        note = f"{load.group}: {words}" if factor == 1.0 else f"{load.group}: {factor:g} x {words}"
        yield Drawn(HEAD + "LOADS", tails.mean(axis=0)[None], text=note, size=TEXT * size)


def _ties(result: Result, size: float) -> Iterator[Drawn]:
    """Return the ties with their forces and states."""
    found, units = result.ties, result.model.report
    for name, tension, state in zip(found.names, found.tension.tolist(), found.state, strict=True):
        tie = next(t for t in result.model.ties if t.name == name)
        ends = np.array([tie.at_a, tie.at_b], dtype=float)
        yield Drawn(HEAD + "TIES", ends)
        words = f"{name}: {units.text('force', tension)}, {state}"
        yield Drawn(HEAD + "TIES", ends.mean(axis=0)[None], text=words, size=TEXT * size)
