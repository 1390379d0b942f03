"""Bonds of brickwork: where the head joints of each course stand.

A course is described in lengths of a whole block: what begins it at the left quoin, the unit that repeats, and what
ends it at the right quoin. The face of a wall shows

* *running* (stretcher) bond: stretchers, every second course begun with half a block, or with ``lap`` of a block;
* *stack* bond: no lap;
* *English* bond: a course of stretchers, then one of headers (half a block in face) with a closer (a quarter) beside
  the quoin header;
* *Flemish* bond: stretcher and header in turn, headers centred on stretchers, a closer beside the quoin header.

Where the length does not fit, the last block before the right quoin is cut; a piece shorter than a quarter of a block
is joined to its neighbour, or both are cut to equal lengths where together they would be longer than a block.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.model.model import Array

SHORTEST = 0.25
"""Shortest piece a mason would lay, in block lengths."""
FINEST, LONGEST = 0.01, 100.0
"""Pieces of a bond lie between these, in block lengths or heights."""


@strict_class
@dataclass(frozen=True)
class Course:
    """One course of a bond, in block lengths.

    Parameters
    ----------
    unit : tuple of float
        Lengths that repeat between the quoins.
    left, right : tuple of float
        Lengths at the two ends, each read from left to right.
    height : float
        Height of the course in block heights.
    """

    unit: tuple[float, ...]
    left: tuple[float, ...] = ()
    right: tuple[float, ...] = ()
    height: float = 1.0

    def __post_init__(self) -> None:
        for name in ("unit", "left", "right"):
            lengths = tuple(float(v) for v in getattr(self, name))
            object.__setattr__(self, name, lengths)
            if any(not FINEST <= v <= LONGEST for v in lengths):
                msg = f"course with {name} = {lengths}: lengths must lie between {FINEST:g} and {LONGEST:g}"
                raise InputError(msg, where="bond", hint="give them in block lengths: 1 a whole block, 0.5 half a one")
        if not self.unit:
            msg = "a course has no repeating unit"
            raise InputError(msg, where="bond", hint="give at least one length, for example unit = (1,)")
        if not FINEST <= self.height <= LONGEST:
            msg = f"a course has height = {self.height:g}, which must lie between {FINEST:g} and {LONGEST:g}"
            raise InputError(msg, where="bond", hint="give it in block heights")


def _is_list(value: object) -> bool:
    return isinstance(value, Sequence | np.ndarray) and not isinstance(value, str | bytes)


def bond_courses(bond: str | Sequence[Course | Sequence[float]], lap: float = 0.5) -> tuple[Course, ...]:
    """Return the courses that repeat, from below.

    Parameters
    ----------
    bond : str or sequence
        "running", "stack", "english", "flemish", or courses of one's own: :class:`Course` objects, or lengths that
        repeat from the left end on.
    lap : float
        Lap of running bond in block lengths, 0 < lap < 1.

    Raises
    ------
    InputError
        Unknown bond, or a lap out of range.
    """
    if not isinstance(bond, str):
        if not (_is_list(bond) and all(isinstance(c, Course) or _is_list(c) for c in bond)):
            msg = f"{bond!r} is neither the name of a bond nor a list of courses"
            raise InputError(msg, where="bond", hint="'running', or [(0.5, 1.0), (1.0,)] in block lengths")
        courses = tuple(c if isinstance(c, Course) else Course(tuple(c)) for c in bond)
        if not courses:
            msg = "the bond has no courses"
            raise InputError(msg, where="bond")
        return courses
    if not 0 < lap < 1:
        msg = f"lap = {lap:g} must lie between 0 and 1 block lengths"
        raise InputError(msg, where="bond", hint="0.5 is half a block; for no lap take bond = 'stack'")
    stretcher, header, closer = 1.0, 0.5, 0.25
    table = {
        "running": (Course((stretcher,)), Course((stretcher,), (lap,), (1 - lap,))),
        "stack": (Course((stretcher,)),),
        "english": (Course((stretcher,)), Course((header,), (header, closer), (closer, header))),
        "flemish": (
            Course((header, stretcher), (stretcher,), (stretcher,)),
            Course((stretcher, header), (header, closer), (closer, header)),
        ),
    }
    if bond not in table:
        msg = f"bond '{bond}' is not known"
        raise InputError(msg, where="bond", hint=closest(bond, table) + ", or a list of courses")
    return table[bond]


def head_joints(course: Course, length: float) -> Array:
    """Return the head joints (k,) of a course, ends included, in block lengths.

    Parameters
    ----------
    course : Course
    length : float
        Length of the wall in block lengths.
    """
    tiny = 1e-9
    left, right = list(np.cumsum(course.left)), list(length - np.cumsum(course.right[::-1]))
    start, stop = (left[-1] if left else 0.0), (right[-1] if right else length)
    if stop - start < -tiny:  # the wall is shorter than the quoins: the unit from the left end, cut
        left, right, start, stop = [], [], 0.0, length
    lines = [0.0, *left]
    at, k = start, 0
    while at + course.unit[k % len(course.unit)] < stop - tiny:
        at += course.unit[k % len(course.unit)]
        lines.append(at)
        k += 1
    lines += [*right[::-1]] if stop - start >= tiny or not left else [*right[::-1]][1:]
    return without_short_pieces(np.array([*lines, length]))


def without_short_pieces(lines: Array, longest: float = 1.0) -> Array:
    """Return the lines (k,) with pieces shorter than :data:`SHORTEST` joined to a neighbour, the ends kept.

    Where the two together are longer than ``longest`` the line between them moves to their middle.
    """
    lines = np.unique(np.asarray(lines, dtype=float))
    lines = lines[np.concatenate([[True], np.diff(lines) > 1e-9])]
    tiny = 1e-9
    while len(lines) > 2:
        pieces = np.diff(lines)
        k = int(np.argmin(pieces))
        if pieces[k] >= SHORTEST - tiny:
            break
        # the inner line to remove: towards the shorter neighbour
        before = pieces[k - 1] if k else np.inf
        after = pieces[k + 1] if k + 1 < len(pieces) else np.inf
        line = k if before <= after else k + 1
        if min(before, after) + pieces[k] > longest + tiny and min(before, after) >= 2 * SHORTEST:
            lines[line] = 0.5 * (lines[line - 1] + lines[line + 1])
        else:
            lines = np.delete(lines, line)
    return lines


def sort_of_piece(length: float) -> str:
    """Return the mason's word for a piece of this length in block lengths."""
    for word, value in (("closer", 0.25), ("half", 0.5), ("three-quarter", 0.75), ("whole", 1.0)):
        if abs(length - value) <= 1e-6:
            return word
    return "cut"
