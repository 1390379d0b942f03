"""Masonry arch bridges: spans in a row on piers between abutments, with rings, headers and backing.

The intrados of the first span springs from (0, 0); all springings are at y = 0. Joints are normal to the intrados, at
equal lengths along it. Fill, road and vehicles are put on afterwards: :func:`concio.with_fill`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate import bridge_barrel
from concio.model.generate.bridge_barrel import Barrel, Lines, RingPlan, barrel_between, barrel_of
from concio.model.generate.generator_arguments import Common, checked, count, not_negative, positive
from concio.model.generate.masonry import Piece, assemble, numbered, rectangle
from concio.model.generate.profiles import profile_of
from concio.model.materials import JointLaw
from concio.model.model import Body, JointRule, Model
from concio.units import quantity

Array = np.ndarray
MOST_RINGS, MOST_SPANS, MOST_VOUSSOIRS = 12, 40, 1000
LONGEST = 300.0
"""No span of masonry is longer [m]; the longest reach 150 m."""


@strict_with(Common.__annotations__)
def bridge(
    *,
    voussoirs: int | Sequence[int],
    span: float | str | Sequence[float | str] | None = None,
    ring: float | str | Sequence[float | str] | None = None,
    rise: float | str | Sequence[float | str] | None = None,
    shape: Literal["segmental", "semicircular", "elliptical", "three-centred", "parabolic", "pointed"] = "segmental",
    springing_ring: float | str | Sequence[float | str] | None = None,
    ring_friction: float | str | JointLaw | None = None,
    staggered: bool = False,
    headers: int = 0,
    intrados: Sequence[Any] | None = None,
    extrados: Sequence[Any] | None = None,
    ring_lines: Sequence[Sequence[Any]] = (),
    pier_width: float | str | Sequence[float | str] | None = None,
    pier_height: float | str = 0.0,
    pier_courses: int = 1,
    abutment: float | str | None = None,
    backing: float | str = 0.0,
    width: float | str | None = None,
    chords: int | None = None,
    **common: Unpack[Common],
) -> Model:
    """Return the masonry of an arch bridge.

    Parameters
    ----------
    voussoirs : int, or sequence
        Of each ring.
    span : float or str, or sequence
        Clear span of each arch at its springings, from the left [m].
    ring : float or str, or sequence
        Thickness of the ring; several are rings from the intrados outwards [m].
    rise : float or str, or sequence
        Rise of the intrados of each span [m]; a semicircular arch needs none.
    shape : {"segmental", "semicircular", "elliptical", "three-centred", "parabolic", "pointed"}
        Of the intrados.
    springing_ring : float or str, or sequence, optional
        Thickness of each ring at the springings, where it grows with the square of the distance from the crown [m].
    ring_friction : float, str or JointLaw, optional
        Law of the joints between rings; by default that of all joints.
    staggered : bool
        Whether joints of every second ring lie half a voussoir further on.
    headers : int
        Every so many voussoirs one runs through all rings; 0 is none.
    intrados, extrados : sequences of points, optional
        Lines in place of span, rise and ring, from the left to the right springing [m]; of several spans a line for
        each span, and piers fill the room between them.
    ring_lines : sequence of lines
        Between them, where there are several rings, from the intrados outwards [m].
    pier_width : float or str, or sequence
        Of each pier between two spans, at the springings [m].
    pier_height : float or str
        From the ground to the springings [m]; 0 lets the arches spring from fixed blocks.
    pier_courses : int
        Blocks of each pier.
    abutment : float or str, optional
        Length of the abutments behind the extrados [m]; by default half of the nearest span.
    backing : float or str
        Height of masonry above the springings over piers and abutments [m].
    width : float or str, optional
        Width of the bridge: the thickness of all bodies [m].
    chords : int, optional
        Chords of each curved side of a voussoir, which keep its area; by default 2, of several rings 1: joints between
        rings are then straight from joint to joint.
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Raises
    ------
    InputError
        An argument is missing or out of range, or too large to be in metres; spans overlap; rings do not meet.

    Notes
    -----
    Voussoirs are called ``v01``, of several rings ``r1-v01`` and of several spans ``s1-v01``; piers ``pier1-p01``,
    backing over them ``backing1``. Fixed bodies are "left abutment", "right abutment" and, of piers, "pier1 ground".

    Examples
    --------
    >>> import concio
    >>> model = concio.bridge(span=6.55, rise=1.428, ring=0.22, voussoirs=40, block="rigid", width=3.8)
    >>> len(model.free_bodies)
    40
    """
    where = "bridge"
    if width is not None:
        if "thickness" in common:
            msg = "width and thickness are both given: they are one"
            raise InputError(msg, where=where)
        common["thickness"] = positive(where, "width", width)
    options = checked(where, common)
    high, back = not_negative(where, "pier_height", pier_height), not_negative(where, "backing", backing)
    if intrados is not None or extrados is not None:
        for key, value in (("span", span), ("rise", rise), ("ring", ring)):
            if value is not None:
                msg = f"{key} and the lines of the barrel are both given"
                raise InputError(msg, where=where, hint=f"the lines are what is built: leave {key} out")
        if pier_width is not None:
            msg = "pier_width and the lines of the barrel are both given"
            raise InputError(msg, where=where, hint="piers are as wide as the lines leave room: leave pier_width out")
        barrels, lines = _drawn(where, intrados, extrados, ring_lines, voussoirs)
        spans = [float(b.right[0, 0] - b.left[0, 0]) for b in barrels]
        _in_metres(where, spans, 0.0)
    else:
        if span is None or ring is None:
            msg = f"'{'span' if span is None else 'ring'}' is missing"
            raise InputError(msg, where=where, hint="give span, rise and ring, or intrados and extrados as lines")
        spans = _lengths(where, "span", span, most=MOST_SPANS)
        _in_metres(where, spans, sum(_lengths(where, "ring", ring, most=MOST_RINGS)))
        several = not isinstance(ring, int | float | str) and len(ring) > 1
        sides = count(where, "chords", (1 if several else 2) if chords is None else chords, 1, 64)
        plan = _plan(where, ring, springing_ring, voussoirs, staggered, headers, sides)
        rises = [None] * len(spans) if rise is None else _lengths(where, "rise", rise, len(spans))
        labels = [f"s{i + 1}-" if len(spans) > 1 else "" for i in range(len(spans))]
        barrels = [
            barrel_of(where, profile_of(where, shape, s, r), replace(plan, prefix=label))
            for s, r, label in zip(spans, rises, labels, strict=True)
        ]
    widths: list[float] = []
    if len(spans) > 1 and intrados is None:
        if pier_width is None:
            msg = "pier_width is missing"
            raise InputError(msg, where=where, hint="several spans stand on piers")
        widths = _lengths(where, "pier_width", pier_width, len(spans) - 1)
        starts = np.concatenate([[0.0], np.cumsum(np.array(spans[:-1]) + widths)])
        barrels = [b.moved(float(x)) for b, x in zip(barrels, starts, strict=True)]
    record_starts = [float(b.left[0, 0]) for b in barrels]
    _check_backing(where, barrels, back)
    behind = [
        0.5 * s if abutment is None else positive(where, "abutment", abutment) for s in (spans[0], spans[-1])
    ]
    pieces = [p for barrel in barrels for p in barrel.pieces]
    obstacles = _abutments(barrels, behind, back)
    for i, (left, right) in enumerate(pairwise(barrels), 1):
        _check_pier(where, i, left, right)
        own, ground = _pier(f"pier{i}", left, right, high, count(where, "pier_courses", pier_courses))
        pieces += own
        obstacles.append(ground)
        if back:
            pieces.append(Piece(f"backing{i}", _backing(where, i, left, right, back), layer="backing"))
    title = f"{shape} arch bridge, {len(spans)} span{'s' * (len(spans) > 1)} of " + ", ".join(f"{s:g}" for s in spans)
    record: dict[str, object] = {"kind": "bridge", "shape": shape, "spans": [float(s) for s in spans],
                                 "starts": record_starts, "rings": 1}  # fmt: skip
    if intrados is not None:
        record["drawn"] = {"lines": lines, "ring": bridge_barrel.thickness_of(lines), "voussoirs": voussoirs,
                           "pier_height": high, "pier_courses": pier_courses, "backing": back,
                           "abutment": behind[0] if abutment is not None else None}  # fmt: skip
    else:
        rings = _lengths(where, "ring", ring, most=MOST_RINGS)
        foot = rings if springing_ring is None else _lengths(where, "springing_ring", springing_ring, len(rings))
        numbers = [voussoirs] * len(rings) if isinstance(voussoirs, int) else list(voussoirs)
        record["rings"] = len(rings)
        record["arguments"] = {
            "span": [float(s) for s in spans], "rise": rises if rise is not None else None,
            "ring": rings, "springing_ring": foot, "voussoirs": numbers, "shape": shape, "staggered": staggered,
            "headers": headers, "pier_width": widths or None, "pier_height": high, "pier_courses": pier_courses,
            "abutment": behind[0] if abutment is not None else None, "backing": back, "chords": sides,
        }  # fmt: skip
    model = assemble(options, pieces, obstacles, title=f"{title} m", generator=record)
    return _with_ring_joints(model, ring_friction, options.law)


def rebuilt(model: Model, factor: float) -> tuple[Body, ...]:
    """Return the bodies of a bridge with its rings thicker by a factor, otherwise as they are.

    Raises
    ------
    InputError
        The model was not made by :func:`bridge`.
    """
    given, drawn = model.generator.get("arguments"), model.generator.get("drawn")
    known = given if isinstance(given, Mapping) else drawn if isinstance(drawn, Mapping) else None
    if known is None:
        msg = "the model does not know how its bridge was made"
        raise InputError(msg, hint="make it by [bridge]")
    arguments: dict[str, Any] = {key: value for key, value in known.items() if value is not None}
    if known is given:
        for key in ("ring", "springing_ring"):
            arguments[key] = [factor * v for v in arguments[key]]
    else:
        inner, *between, outer = bridge_barrel.thicker(arguments.pop("lines"), factor)
        arguments |= {"intrados": inner, "extrados": outer, "ring_lines": between, "ring": None}
        if len(inner) == 1:
            arguments |= {"intrados": inner[0], "extrados": outer[0], "ring_lines": [line[0] for line in between]}
    new = {body.name: body for body in bridge(**arguments).outlines}
    if set(new) != {b.name for b in model.bodies}:
        msg = "bodies were added to the bridge or taken away since it was made"
        raise InputError(msg, hint="only a bridge as it was made can be made again")
    return tuple(replace(b, outline=new[b.name].outline) for b in model.outlines)


def _in_metres(where: str, spans: Sequence[float], ring: float) -> None:
    """Refuse spans and rings that no bridge has: mostly millimetres.

    Raises
    ------
    InputError
    """
    hint = "a bare number is in m: give the unit with it, such as '{:g} {}'; of a drawing, unit in [bridge_drawing]"
    if not max(spans) <= LONGEST:
        msg = f"a span of {max(spans):g} m is longer than any of masonry"
        raise InputError(msg, where=where, hint=hint.format(max(spans), "mm" if max(spans) >= 1000 else "cm"))
    if not ring < min(spans):
        msg = f"a ring of {ring:g} m is thicker than the span of {min(spans):g} m is long"
        raise InputError(msg, where=where, hint=hint.format(ring, "mm" if ring >= 100 else "cm"))


def _lengths(where: str, name: str, given: Any, number: int | None = None, most: int = 100) -> list[float]:
    """Return lengths, one value standing for as many as are needed."""
    single = isinstance(given, int | float | str | np.number)
    values = [given] * (number or 1) if single else list(given)
    if not values or len(values) > most or (number is not None and len(values) != number):
        wanted = f"{number}" if number is not None else f"1 to {most}"
        msg = f"{name} has {len(values)} values, {wanted} expected"
        raise InputError(msg, where=where)
    return [positive(where, name, v) for v in values]


def _plan(
    where: str, ring: Any, springing: Any, voussoirs: Any, staggered: bool, headers: int, chords: int
) -> RingPlan:
    crown = _lengths(where, "ring", ring, most=MOST_RINGS)
    foot = crown if springing is None else _lengths(where, "springing_ring", springing, len(crown))
    numbers = [voussoirs] * len(crown) if isinstance(voussoirs, int) else list(voussoirs)
    if len(numbers) != len(crown):
        msg = f"voussoirs has {len(numbers)} values, but there are {len(crown)} rings: they would not meet"
        raise InputError(msg, where=where, hint="give one number, or one for each ring")
    counts = tuple(count(where, "voussoirs", v, 3, MOST_VOUSSOIRS) for v in numbers)
    return RingPlan(
        tuple(crown), tuple(foot), counts, staggered, count(where, "headers", headers, 0), chords, ""
    )


def _drawn(where: str, intrados: Any, extrados: Any, between: Any, voussoirs: Any) -> tuple[list[Barrel], list[Lines]]:
    """Return the barrel of each span between its lines, and the lines from the intrados outwards [m]."""
    if intrados is None or extrados is None:
        msg = "intrados and extrados belong together, and one of them is missing"
        raise InputError(msg, where=where)
    several = _nested(intrados)
    rings = [line if several else [line] for line in (intrados, *between, extrados)]
    if several and any(not _nested(line) or len(line) != len(intrados) for line in rings):
        msg = f"the intrados has {len(intrados)} lines, one for each span, and another line of the barrel has not"
        raise InputError(msg, where=where, hint="give as many lines for the extrados and between the rings")
    given = voussoirs if isinstance(voussoirs, int) else next(iter(voussoirs))
    number = count(where, "voussoirs", given, 3, MOST_VOUSSOIRS)
    own = [[[[quantity(v, "length", where=where) for v in p] for p in line] for line in lines] for lines in rings]
    found = [
        barrel_between(f"{where}, span {k}" if several else where, lines, number, f"s{k}-" * several)
        for k, lines in enumerate(zip(*own, strict=True), 1)
    ]
    return found, own


def _nested(line: Any) -> bool:
    """Return whether a line is a list of lines, and not of points."""
    first: Sequence[Any] = next(iter(line), ())
    return len(first) > 0 and not isinstance(first[0], int | float | str | np.number)


def _check_backing(where: str, barrels: Sequence[Barrel], back: float) -> None:
    low = min(float(b.extrados[:, 1].max()) for b in barrels)
    if back >= low:
        msg = f"backing = {back:g} m reaches above the crown of the extrados at {low:.4g} m"
        raise InputError(msg, where=where, hint="it is masonry between the arches, measured from the springings")


def _check_pier(where: str, number: int, left: Barrel, right: Barrel) -> None:
    a, b = left.right[-1, 0], right.left[-1, 0]
    if a > b + 1e-9:
        msg = f"spans {number} and {number + 1} overlap above pier {number}: their rings are {a - b:.4g} m too near"
        raise InputError(msg, where=where, hint=f"make pier_width at least {a - b:.4g} m larger")


def _abutments(barrels: Sequence[Barrel], behind: Sequence[float], back: float) -> list[Piece]:
    """Return fixed blocks behind the first and the last springing, as high as the backing."""
    found = []
    for word, barrel, length, side in (("left", barrels[0], behind[0], -1.0), ("right", barrels[-1], behind[1], 1.0)):
        joint = barrel.left if side < 0 else barrel.right
        line = barrel.extrados if side < 0 else barrel.extrados[::-1]
        upper = _up_to(line, max(back, float(joint[-1, 1])))
        far = upper[0, 0] + side * length
        deep = joint[0, 1] - 0.4 * length
        outline = np.vstack([joint[:-1], upper, [[far, upper[-1, 1]], [far, deep], [joint[0, 0], deep]]])
        found.append(Piece(f"{word} abutment", outline, "abutment"))
    return found


def _up_to(line: Array, height: float) -> Array:
    """Return the part of a line, from its first point upwards, that lies below a height, its end at that height."""
    above = np.flatnonzero(line[:, 1] > height + 1e-12)
    if line[0, 1] >= height or not len(above):
        return line[:1]
    k = int(above[0])
    share = (height - line[k - 1, 1]) / (line[k, 1] - line[k - 1, 1])
    end = line[k - 1] + share * (line[k] - line[k - 1])
    return line[:k] if share < 1e-9 else np.vstack([line[:k], end])


def _pier(word: str, left: Barrel, right: Barrel, high: float, courses: int) -> tuple[list[Piece], Piece]:
    """Return the blocks of a pier between two spans and the fixed block that it stands on."""
    x0, x1 = float(left.right[0, 0]), float(right.left[0, 0])
    y0 = float(left.right[0, 1])
    top = np.vstack([right.left, left.right[::-1]])
    if np.hypot(*(right.left[-1] - left.right[-1])) < 1e-9 * (x1 - x0):
        top = np.vstack([right.left, left.right[-2::-1]])
    if not high:
        deep = y0 - 0.5 * (x1 - x0)
        outline = np.vstack([[[x0, deep], [x1, deep]], top])
        return [], Piece(f"{word} ground", outline, "ground")
    levels = y0 - high + high * np.arange(courses + 1) / courses
    pieces = []
    for k, (low, upper) in enumerate(pairwise(levels.tolist())):
        last = k == courses - 1
        outline = np.vstack([[[x0, low], [x1, low]], top]) if last else rectangle(x0, x1, low, upper)
        pieces.append(Piece(f"{word}-{numbered('p', k + 1, courses)}", outline, layer="pier"))
    deep = y0 - high - 0.5 * (x1 - x0)
    return pieces, Piece(f"{word} ground", rectangle(x0, x1, deep, y0 - high), "ground")


def _backing(where: str, number: int, left: Barrel, right: Barrel, height: float) -> Array:
    """Return the outline of the masonry between two arches, from the pier up to a height."""
    a, b = _up_to(right.extrados, height), _up_to(left.extrados[::-1], height)
    line = np.vstack([a, b[::-1]])
    apart = np.hypot(*(line - np.roll(line, 1, axis=0)).T)
    outline = np.asarray(line[apart > 1e-9 * float(np.ptp(line[:, 0]))])
    if len(outline) < 3:
        least = min(float(right.extrados[0, 1]), float(left.extrados[-1, 1]))
        msg = f"backing = {height:g} m does not reach above the arches on pier {number}, which begin at {least:.4g} m"
        raise InputError(msg, where=where, hint="make it higher, or leave it out")
    return outline


def _with_ring_joints(model: Model, given: float | str | JointLaw | None, law: JointLaw) -> Model:
    """Return the model with a law of its own between rings."""
    rings = sorted({b.layer for b in model.bodies if b.layer.startswith("ring ")}, key=lambda name: int(name[5:]))
    if given is None or len(rings) < 2:
        return model
    if isinstance(given, JointLaw):
        own = given
    else:
        own = replace(law, friction=quantity(given, "friction", where="ring_friction"), dilatancy=0.0)
    rules = tuple(JointRule("ring joint", (a, b)) for a, b in pairwise(rings))
    return replace(model, laws={**model.laws, "ring joint": own}, rules=(*model.rules, *rules))
