"""Arches of voussoirs between fixed abutments: semicircular, segmental, pointed and flat.

The intrados is described by clear span ``s`` and rise ``r`` above the springing line y = 0, the crown at x = 0.

* semicircular: one arc, r = s/2;
* segmental: one arc of radius ``R = (s^2/4 + r^2) / (2 r)``, r < s/2;
* pointed: two arcs with centres on the springing line at x = +c and -c, ``c = (r^2 - s^2/4) / s``, radius
  ``R = s/2 + c``; the equilateral arch has r = s sqrt(3)/2;
* flat: straight intrados and extrados; the joints point to a centre below that leaves the springings at ``skew``.

Joints of an arc divide the angle of the intrados into equal parts and lie on its radii, so voussoirs are sectors of a
ring; at the crown of a pointed arch the two rings meet on the axis. Curved edges are chords within a tolerance of the
arc, which keep the area under it (:mod:`concio.model.arcs`), or one chord for each voussoir ("straight").
"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.kinematics.frames import turned_left, turned_right
from concio.model.arcs import arc as _arc
from concio.model.arcs import chords_of
from concio.model.generate.generator_arguments import Common, checked, choice, count, finite, positive
from concio.model.generate.masonry import Piece, assemble, numbered
from concio.model.model import Array, Load, Model

Shape = Literal["semicircular", "segmental", "pointed", "flat"]


@strict_with(Common.__annotations__)
def arch(
    *,
    span: float | str,
    ring: float | str,
    voussoirs: int,
    shape: Shape = "semicircular",
    rise: float | str | None = None,
    skew: float = 60.0,
    edges: Literal["curved", "straight"] = "curved",
    chord_tolerance: float | str | None = None,
    crown_load: float | str = 0.0,
    load_at: float = 0.5,
    **common: Unpack[Common],
) -> Model:
    """Return an arch of voussoirs between two fixed abutments.

    Parameters
    ----------
    span : float or str
        Clear span at the springings [m].
    ring : float or str
        Thickness of the ring, of a flat arch its height [m].
    voussoirs : int
        Number of voussoirs; an odd number has a keystone.
    shape : {"semicircular", "segmental", "pointed", "flat"}
        Of the intrados.
    rise : float or str, optional
        Rise of the intrados [m]; needed for a segmental arch, of a pointed one by default that of the equilateral arch.
    skew : float
        Angle of the springings of a flat arch with the horizontal [degrees].
    edges : {"curved", "straight"}
        Curved: chords within ``chord_tolerance`` of the arc. Straight: one chord for each voussoir.
    chord_tolerance : float or str, optional
        Largest distance of a chord from its arc [m]; by default a thousandth of the ring.
    crown_load : float or str
        Vertical force on the extrados, downwards positive [kN], load group "live".
    load_at : float
        Its place as a share of the span from the left springing.
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Raises
    ------
    InputError
        An argument is missing or out of range.

    Notes
    -----
    Voussoirs are called ``v01``, ``v02``... from the left springing; the fixed bodies are "left abutment" and
    "right abutment", with the role "abutment".

    Examples
    --------
    A semicircular arch carries its own weight from a thickness of 0.1075 mean radii on (Milankovitch, 1907). The mean
    radius is 1 m here:

    >>> import concio
    >>> for ring in (0.10, 0.12):
    ...     model = concio.arch(span=2 - ring, ring=ring, voussoirs=21, block="rigid", friction=2.0)
    ...     print(ring, concio.solve(model, on_failure="return").status.name)
    0.1 NO_EQUILIBRIUM
    0.12 SOLVED
    """
    where = "arch"
    options = checked(where, common)
    s, t, n = positive(where, "span", span), positive(where, "ring", ring), count(where, "voussoirs", voussoirs, 2)
    choice(where, "edges", edges, ("curved", "straight"))
    tolerance = 1e-3 * t if chord_tolerance is None else positive(where, "chord_tolerance", chord_tolerance)
    force = finite(where, "crown_load", crown_load, "force")
    given = None if rise is None else positive(where, "rise", rise)
    outlines, joints = ring_outlines(where, shape, s, given, t, n, tolerance if edges == "curved" else None, skew)
    pieces = [Piece(numbered("v", k + 1, n), outline, layer="voussoir") for k, outline in enumerate(outlines)]
    if n % 2:
        pieces[n // 2] = Piece(pieces[n // 2].name, outlines[n // 2], layer="keystone")
    obstacles = [
        Piece(f"{side} abutment", abutment_outline(joint, t), "abutment")
        for side, joint in zip(("left", "right"), joints, strict=True)
    ]
    loads = []
    if force:
        loads = [_load_on_extrados(where, pieces, s, load_at, force)]
    title = f"{shape} arch, span {s:g} m, ring {t:g} m, {n} voussoirs"
    record = {"kind": "arch", "shape": shape, "span": s, "ring": t, "voussoirs": n}
    return assemble(options, pieces, obstacles, loads=loads, title=title, generator=record)


def ring_outlines(
    where: str, shape: str, s: float, rise: float | None, t: float, n: int, tolerance: float | None, skew: float = 60.0
) -> tuple[list[Array], list[Array]]:
    """Return the outlines of voussoirs and the two springing joints, each from intrados to extrados.

    Parameters
    ----------
    where : str
        For messages.
    shape : str
    s, t : float
        Clear span and thickness of the ring [m].
    rise : float or None
    n : int
        Number of voussoirs.
    tolerance : float or None
        Of chords [m]; None for one chord a voussoir.
    skew : float
        Angle of the springings of a flat arch with the horizontal [degrees].
    """
    choice(where, "shape", shape, ("semicircular", "segmental", "pointed", "flat"))
    if shape == "flat":
        if rise is not None:
            msg = "a flat arch has no rise"
            raise InputError(msg, where=where, hint="leave rise out, or take shape = 'segmental'")
        return _flat(where, s, t, n, skew)
    if shape == "pointed":
        return _pointed(where, s, rise, t, n, tolerance)
    return _one_arc(where, shape, s, rise, t, n, tolerance)


def _chords(radius: float, angle: float, tolerance: float | None) -> int:
    """Return how many chords keep within ``tolerance`` of an arc; None asks for one."""
    return 1 if tolerance is None else chords_of(radius, angle, tolerance)


def _one_arc(
    where: str, shape: str, s: float, rise: float | None, t: float, n: int, tolerance: float | None
) -> tuple[list[Array], list[Array]]:
    """Return voussoirs and the two springing joints of a semicircular or segmental arch."""
    if shape == "semicircular":
        if rise is not None and abs(rise - s / 2) > 1e-9 * s:
            msg = f"a semicircular arch of span {s:g} m rises {s / 2:g} m, not {rise:g} m"
            raise InputError(msg, where=where, hint="leave rise out, or take shape = 'segmental' or 'pointed'")
        rise = s / 2
    if rise is None:
        msg = "rise is missing"
        raise InputError(msg, where=where, hint="a segmental arch needs the rise of its intrados in m")
    if rise > s / 2 * (1 + 1e-9):
        msg = f"a segmental arch of span {s:g} m rises at most {s / 2:g} m, not {rise:g} m"
        raise InputError(msg, where=where, hint="take shape = 'pointed' for a higher arch")
    radius = (s * s / 4 + rise * rise) / (2 * rise)
    half = np.pi / 2 if shape == "semicircular" else np.arcsin(min(s / 2 / radius, 1.0))
    centre = np.array([0.0, rise - radius])
    angles = np.pi / 2 + half * (1 - 2 * np.arange(n + 1) / n)
    chords = _chords(radius + t, angles[0] - angles[1], tolerance)
    outlines = [
        np.concatenate([_arc(centre, radius, a, b, chords), _arc(centre, radius + t, b, a, chords)])[::-1]
        for a, b in pairwise(angles.tolist())
    ]
    ends = [np.concatenate([_arc(centre, q, a, a, 1)[:1] for q in (radius, radius + t)]) for a in angles[[0, -1]]]
    return outlines, ends


def _pointed(
    where: str, s: float, rise: float | None, t: float, n: int, tolerance: float | None
) -> tuple[list[Array], list[Array]]:
    """Return voussoirs and the two springing joints of a pointed arch."""
    rise = s * np.sqrt(3) / 2 if rise is None else rise
    if rise <= s / 2 * (1 + 1e-9):
        msg = f"a pointed arch of span {s:g} m rises more than {s / 2:g} m, not {rise:g} m"
        raise InputError(msg, where=where, hint="take shape = 'semicircular' or 'segmental'")
    c = (rise * rise - s * s / 4) / s
    radius, centre = s / 2 + c, np.array([c, 0.0])
    inner, outer = np.pi - np.arccos(c / radius), np.pi - np.arccos(c / (radius + t))  # where each arc meets x = 0
    angles = np.pi - (np.pi - inner) * 2 * np.arange(n // 2 + 1) / n
    left = []
    for a, b in pairwise(angles.tolist()):
        last = n % 2 == 0 and b == float(angles[-1])
        stop = outer if last else b
        chords = _chords(radius + t, a - min(b, stop), tolerance)
        left.append(
            np.concatenate([_arc(centre, radius, a, b, chords), _arc(centre, radius + t, stop, a, chords)])[::-1]
        )
    flip = np.array([-1.0, 1.0])
    right = [(outline * flip)[::-1] for outline in left[::-1]]
    key = []
    if n % 2:
        a = angles[-1]
        chords = _chords(radius + t, a - outer, tolerance)
        lower, upper = _arc(centre, radius, a, inner, chords), _arc(centre, radius + t, a, outer, chords)
        for line in (lower, upper):
            line[-1, 0] = 0.0
        ring = [lower, (lower * flip)[::-1][1:], upper * flip, upper[::-1][1:]]
        key = [np.concatenate(ring)]
    else:
        for outline in (left[-1], right[0]):
            outline[np.abs(outline[:, 0]) < 1e-9 * s, 0] = 0.0
    end = np.array([[-s / 2, 0.0], [-s / 2 - t, 0.0]])
    return [*left, *key, *right], [end, end * flip]


def _flat(where: str, s: float, t: float, n: int, skew: float) -> tuple[list[Array], list[Array]]:
    """Return voussoirs and the two springing joints of a flat arch."""
    if not 0 < skew < 90:
        msg = f"skew = {skew:g} must lie between 0 and 90 degrees"
        raise InputError(msg, where=where, hint="60 degrees is usual; 90 would be vertical joints")
    depth = s / 2 * np.tan(np.deg2rad(skew))
    low = s * (np.arange(n + 1) / n - 0.5)
    high = low * (depth + t) / depth
    outlines = [np.array([[low[k], 0.0], [low[k + 1], 0.0], [high[k + 1], t], [high[k], t]]) for k in range(n)]
    return outlines, [np.array([[low[k], 0.0], [high[k], t]]) for k in (0, -1)]


def abutment_outline(joint: Array, t: float) -> Array:
    """Return a fixed block (4, 2) behind a springing joint, given from intrados to extrados."""
    along = joint[1] - joint[0]
    outward = turned_right(along) if along[0] > 0 else turned_left(along)
    behind = outward / np.hypot(*outward) * 0.5 * t
    return np.array([joint[0], joint[1], joint[1] + behind, joint[0] + behind])


def _load_on_extrados(where: str, pieces: list[Piece], s: float, share: float, force: float) -> Load:
    """Return a vertical force on the highest point of the ring at a share of the span."""
    if not 0 <= share <= 1:
        msg = f"load_at = {share:g} must lie between 0 and 1"
        raise InputError(msg, where=where, hint="it is a share of the span, 0.5 the crown")
    x = s * (share - 0.5)
    best: tuple[float, str] | None = None
    for piece in pieces:
        p, q = piece.outline, np.roll(piece.outline, 1, axis=0)
        low, high = np.minimum(p[:, 0], q[:, 0]), np.maximum(p[:, 0], q[:, 0])
        for e in np.flatnonzero((low <= x) & (x <= high) & (high > low)):
            y = float(p[e, 1] + (q[e, 1] - p[e, 1]) * (x - p[e, 0]) / (q[e, 0] - p[e, 0]))
            if best is None or y > best[0]:
                best = (y, piece.name)
    if best is None:
        msg = f"no voussoir stands at x = {x:g} m"
        raise InputError(msg, where=where)
    return Load("point", (0.0, -force), bodies=(best[1],), at=(x, best[0]), group="live")
