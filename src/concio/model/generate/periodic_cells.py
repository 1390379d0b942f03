"""Periodic cells of masonry: the smallest piece of a bond that repeats itself, or of rubble without courses.

The courses of a bond (:mod:`concio.model.generate.bonds`) run on for ever: what a course begins with at its left quoin
only says where its head joints stand. The length of the cell is the shortest that holds a whole number of the repeating
units of all courses, its height that of the courses that repeat. Blocks are whole: one that the edge of the cell would
cut stands over it.

With mortar, films fill the joints: one in every head joint, and bed films cut at the middle of every head joint above
and below, as in the panel with ``bed_mortar = "cut"``. A film that ran on for ever could not be cut by a cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import lcm
from typing import Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.bonds import Course, bond_courses
from concio.model.generate.generator_arguments import Checked, Common, checked, count, positive, two
from concio.model.generate.masonry import numbered, rectangle
from concio.model.generate.periodic_rubble import rubble_cell
from concio.model.generate.spacing import subdivided
from concio.model.generate.wall_panels import Bond
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Array, Body, JointRule, Model
from concio.units import quantity

LONGEST = 60
"""Longest cell of courses that do not fit together, in block lengths."""

LARGEST_CELL = 100_000
"""More blocks than this are taken for a typing error."""


@strict_with(Common.__annotations__)
def cell(
    *,
    bond: Bond = "running",
    block_size: Sequence[float | str] = (0.25, 0.125),
    lap: float = 0.5,
    joint: float | str = 0.0,
    mortar: Elastic | None = None,
    head: float | JointLaw | None = None,
    repeat: Sequence[int] = (1, 1),
    length: float | str | None = None,
    height: float | str | None = None,
    stone: float | str | None = None,
    seed: int = 0,
    aspect: float = 1.5,
    evenness: int = 3,
    shortest_edge: float = 0.2,
    **common: Unpack[Common],
) -> Model:
    """Return a periodic cell of masonry, for :func:`concio.homogenise`, :func:`concio.strain_path` and others.

    Parameters
    ----------
    bond : str or sequence
        "running", "stack", "english", "flemish", courses of one's own
        (:func:`concio.model.generate.bonds.bond_courses`), or "rubble": stones without courses.
    block_size : (length, height)
        Of a whole block in the face of the wall [m].
    lap : float
        Lap of running bond in block lengths.
    joint : float or str
        Thickness of head and bed joints filled with mortar [m]; 0: blocks touch.
    mortar : Elastic, optional
        Its material, where there is any.
    head : float or JointLaw, optional
        Law of the head joints, where it is another than ``friction``; without mortar films only.
    repeat : (int, int)
        How many of the smallest cells stand side by side and on each other; answers do not depend on it.
    length, height : float or str
        Size of a rubble cell; a bond has its own [m].
    stone : float or str
        Mean size of the stones of rubble, the root of their area [m].
    seed, aspect, evenness, shortest_edge
        Of rubble, as in :func:`concio.rubble`.
    **common
        See :class:`concio.model.generate.generator_arguments.Common`; a cell has no base and no horizontal load, and
        the weight of its materials does not act.

    Raises
    ------
    InputError
        An argument is out of range or does not go with the bond.

    Examples
    --------
    Two blocks repeat: the second course is shifted by half a block.

    >>> import concio
    >>> model = concio.cell(bond="running", block_size=(0.25, 0.125), friction=0.6)
    >>> len(model.bodies), model.periods
    (2, ((0.25, 0.0), (0.0, 0.25)))
    """
    where = "cell"
    options = checked(where, common)
    for key in ("base_friction", "horizontal"):
        if common.get(key):
            msg = f"{key} is given, but a cell has neither base nor loads"
            raise InputError(msg, where=where, hint="leave it out")
    nx, ny = (count(where, "repeat", n) for n in two(where, "repeat", repeat))
    thick = quantity(joint, "length", where=f"{where}, joint")
    if not 0 <= thick < np.inf:
        msg = f"joint = {thick:g} must be zero or positive and finite"
        raise InputError(msg, where=where)
    if thick and mortar is None:
        msg = f"joints of {1e3 * thick:g} mm need a mortar"
        raise InputError(msg, where=where, hint="for example mortar = Elastic(E=1e6, nu=0.2), or joint = 0")
    if mortar is not None and not thick:
        msg = "a mortar is given, but the joints have no thickness"
        raise InputError(msg, where=where, hint="give joint, for example '10 mm', or leave mortar out")
    if head is not None and (thick or bond == "rubble"):
        msg = "head is the law of head joints between blocks, and there are none"
        raise InputError(msg, where=where, hint="it goes with the bonds of blocks, without mortar films")
    if bond == "rubble":
        if thick:
            msg = "a rubble cell has joints without thickness"
            raise InputError(msg, where=where, hint="thin mortar is a joint law with stiffness and strength")
        for name, value in (("length", length), ("height", height), ("stone", stone)):
            if value is None:
                msg = f"a rubble cell needs {name}"
                raise InputError(msg, where=where, hint="give length and height of the cell and the size of stones")
        assert length is not None
        assert height is not None
        assert stone is not None
        outlines, periods, words, record = rubble_cell(
            length=length, height=height, stone=stone, seed=seed, aspect=aspect, evenness=evenness,
            shortest_edge=shortest_edge, repeat=(nx, ny),
        )  # fmt: skip
        bodies = [_body(options, numbered("s", k, len(outlines)), o, "stone") for k, o in enumerate(outlines, 1)]
        return _model(options, bodies, periods, words, record)
    if length is not None or height is not None or stone is not None:
        msg = "length, height and stone are of rubble cells"
        raise InputError(msg, where=where, hint="the bond and block_size give a cell its size; repeat makes it larger")
    size = positive(where, "block_size", two(where, "block_size", block_size)[0])
    tall = positive(where, "block_size", two(where, "block_size", block_size)[1])
    courses = tuple(bond_courses(bond, lap)) * ny
    if head is not None and len(courses) == 1:
        courses *= 2  # a block that stands on itself: head and bed joints could not be distinguished
    units = shortest_length(courses) * nx
    if sum(len(c.unit) * units / sum(c.unit) for c in courses) > LARGEST_CELL:
        msg = f"the cell has more than {LARGEST_CELL:,} blocks"
        raise InputError(msg, where=where, hint="lower repeat")
    bodies, periods = _masonry(options, courses, float(units), size, tall, thick)
    word = bond if isinstance(bond, str) else "own"
    films = f"mortar {1e3 * thick:g} mm" if thick else "no mortar films"
    blocks = sum(b.role == "block" for b in bodies)
    words = f"cell of {word} bond, {blocks} block{'s' if blocks > 1 else ''}, {films}"
    record = {
        "kind": "cell", "bond": word, "block_size": [size, tall], "joint": thick, "repeat": [nx, ny], "lap": float(lap),
    }  # fmt: skip
    return _model(options, bodies, periods, words, record, mortar=mortar, head=head, courses=len(courses))


def shortest_length(courses: Sequence[Course]) -> Fraction:
    """Return the shortest length in block lengths that is a whole number of the repeating units of all courses.

    Raises
    ------
    InputError
        There is none below :data:`LONGEST`.
    """
    sums = [Fraction(sum(c.unit)).limit_denominator(1000) for c in courses]
    whole = all(abs(float(s) - sum(c.unit)) <= 1e-9 for s, c in zip(sums, courses, strict=True))
    length = Fraction(lcm(*(s.numerator for s in sums)), 1)
    for step in sorted({s.denominator for s in sums} | {lcm(*(s.denominator for s in sums))}, reverse=True):
        shorter = length / step
        if all((shorter / s).denominator == 1 for s in sums):
            length = shorter
            break
    if not whole or length > LONGEST:
        lengths = ", ".join(f"{sum(c.unit):g}" for c in courses)
        msg = f"the courses repeat after {lengths} block lengths, which have no common multiple up to {LONGEST}"
        raise InputError(msg, where="bond", hint="give units whose lengths fit together")
    return length


def _masonry(
    options: Checked, courses: Sequence[Course], units: float, size: float, tall: float, joint: float
) -> tuple[list[Body], tuple[tuple[float, float], tuple[float, float]]]:
    """Return blocks and films of a cell, and its periods."""
    pitch, length = size + joint, units * (size + joint)
    heads = [_heads(course, units) * pitch for course in courses]
    heights = [course.height * tall for course in courses]
    cuts = [np.zeros(0)] * len(courses)
    if joint:  # above each course
        cuts = [_distinct(np.concatenate([a, b]), length) for a, b in zip(heads, [*heads[1:], heads[0]], strict=True)]
    ends = [np.concatenate([h - joint / 2, h + joint / 2]) for h in heads]
    mesh = options.mesh_size or min(size / 4, tall / 2)
    lines = subdivided(_closed(_distinct(np.concatenate([*ends, *cuts]), length), length), mesh)
    bodies: list[Body] = []

    def add(name: str, x: tuple[float, float], y: Array, role: str, layer: str) -> None:
        elastic = role == "mortar" or options.kind == "elastic"
        tiny = 1e-9 * length
        xs = np.concatenate([lines, lines + length, lines + 2 * length])
        xs = xs[(xs > x[0] + tiny) & (xs < x[1] - tiny)]
        xs = np.array([x[0], *xs[np.concatenate([[True], np.diff(xs) > tiny])[: len(xs)]], x[1]])
        grid = (xs, y) if elastic else None
        outline = rectangle(x[0], x[1], y[0], y[-1])
        kind: Literal["elastic", "rigid"] = "elastic" if elastic else "rigid"
        bodies.append(Body(name, outline, role, kind, role, layer, options.thickness, grid))

    at = 0.0
    for c, course_heads in enumerate(heads):
        ys = subdivided(np.array([at, at + heights[c]]), mesh)
        layer, stem = f"course {c + 1}", numbered("c", c + 1, len(heads))
        for k, (a, b) in enumerate(pairwise([*course_heads, course_heads[0] + length]), 1):
            label = numbered("b", k, len(course_heads))
            add(f"{stem}-{label}", (a + joint / 2, b - joint / 2), ys, "block", layer)
            if joint:
                add(f"{stem}-{label.replace('b', 'h')}", (b - joint / 2, b + joint / 2), ys, "mortar", layer)
        at = float(ys[-1])
        if joint:
            ys = subdivided(np.array([at, at + joint]), mesh)
            for k, (a, b) in enumerate(pairwise([*cuts[c], cuts[c][0] + length]), 1):
                name = f"{numbered('bed', c + 1, len(heads))}-{k}"
                add(name, (float(a), float(b)), ys, "mortar", f"bed {c + 1}")
            at = float(ys[-1])
    return bodies, ((length, 0.0), (0.0, at))


def _heads(course: Course, units: float) -> Array:
    """Return where head joints stand (k,) within [0, units), in block lengths."""
    lengths = np.cumsum([0.0, *course.unit])
    times = round(units / float(lengths[-1]))
    joints = np.concatenate([lengths[:-1] + n * lengths[-1] for n in range(times)]) + sum(course.left)
    return _distinct(joints, units)


def _distinct(places: Array, length: float) -> Array:
    """Return places brought into [0, length) by whole periods, in order, each once."""
    tiny = 1e-9 * length
    places = places - length * np.floor((places + tiny) / length)
    places = np.sort(np.maximum(places, 0.0))
    found: Array = places[np.concatenate([[True], np.diff(places) > tiny])]
    return found


def _closed(places: Array, length: float) -> Array:
    """Return the places with the first one repeated a period on."""
    return np.concatenate([places, [places[0] + length]])


def _body(options: Checked, name: str, outline: Array, layer: str) -> Body:
    return Body(name, outline, "block", options.kind, "block", layer, options.thickness)


def _model(
    options: Checked,
    bodies: Sequence[Body],
    periods: tuple[tuple[float, float], tuple[float, float]],
    title: str,
    record: dict[str, object],
    *,
    mortar: Elastic | None = None,
    head: float | JointLaw | None = None,
    courses: int = 0,
) -> Model:
    materials: dict[str, Elastic | Rigid] = {"block": options.block}
    if mortar is not None:
        materials["mortar"] = mortar
    laws, rules = {"joint": options.law}, [JointRule("joint")]
    if head is not None:
        laws["head"] = head if isinstance(head, JointLaw) else JointLaw(friction=head)
        rules += [JointRule("head", (f"course {c}", f"course {c}")) for c in range(1, courses + 1)]
    return Model(
        bodies=tuple(bodies),
        materials=materials,
        laws=laws,
        rules=tuple(rules),
        plane=options.plane,
        element=options.element,
        mesh_size=options.mesh_size,
        refinement=options.refinement,
        title=options.title or title,
        generator=record,
        periods=periods,
    )
