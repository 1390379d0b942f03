"""Vertical strips of a facade drawn in elevation, as models of their sections: how the wall can leave its plane.

The drawing gives the stones and their thickness. A strip is what lies between two vertical lines; its section is a
stack of courses, each with the weight, the loads and the least thickness of what the strip holds there. Strips are the
whole facade, each pier between two openings, each pier with half of the openings beside it, and the wall over each
column of openings. They are cut free at their sides and may crack at the edge of every course: stones that reach across
a cut are cut. What is left out, the bond with the rest and with returns, would hold the strip.

In a section x is across the wall, positive inwards, and y is the height of the drawing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from concio.analysis.seismic.layout import Opening, openings_of
from concio.contact.edge_loads import loaded_bodies, loaded_faces
from concio.contact.separate import surroundings
from concio.errors import InputError
from concio.model.actions import Load, Support
from concio.model.body import Body
from concio.model.materials import JointLaw, Rigid
from concio.model.model import Model

Array = np.ndarray

FLUSH = ("middle", "outer", "inner")
"""Which faces of stones of different thickness lie in one plane."""

MOST_COURSES = 16
"""Courses of a section, but for edges of openings and heights that are held, which are all kept."""

SHARE = 0.1
"""Stones with less than this share of a course do not set its thickness."""

APART = 1e-3
"""Heights that differ by less than this share of the facade are one."""

NARROW = 0.02
"""Strips narrower than this share of the facade are not examined."""


@dataclass(frozen=True)
class OutOfPlane:
    """How a facade drawn in elevation is held out of its plane.

    Parameters
    ----------
    held : tuple of float
        Heights at which floors or ties hold it sideways, in both senses [m]; none by default: it may overturn from
        every height. Where it is held it can bend between them.
    flush : {"middle", "outer", "inner"}
        Which faces lie in one plane where the thickness changes.
    bearing : float, optional
        Distance from the inner face at which loads act, in the drawing those of floors and roofs [m]; by default half
        the thickness.

    Raises
    ------
    InputError
        There is no such face, or a number is none.

    Examples
    --------
    >>> from concio.seismic import OutOfPlane
    >>> OutOfPlane(held=(3.2, 6.4)).flush
    'middle'
    """

    held: tuple[float, ...] = ()
    flush: str = "middle"
    bearing: float | None = None

    def __post_init__(self) -> None:
        if self.flush not in FLUSH:
            msg = f"there is no face '{self.flush}' to lie in one plane"
            raise InputError(msg, hint=f"one of {', '.join(FLUSH)}")
        object.__setattr__(self, "held", tuple(float(v) for v in self.held))
        if not np.isfinite(self.held).all():
            msg = "a height at which the facade is held is not a number"
            raise InputError(msg)
        if self.bearing is not None and not 0 < self.bearing < np.inf:
            msg = f"a bearing at {self.bearing:g} m from the inner face must lie inside the wall"
            raise InputError(msg, hint="give a distance above zero and below the thickness")


@dataclass(frozen=True, eq=False)
class Strip:
    """A strip of a facade with the model of its section.

    Parameters
    ----------
    kind : {"facade", "pier", "pier with openings", "over opening"}
    sides : (float, float)
        Along the facade [m].
    base : float
        Height from which on it is free [m].
    section : Model
    of : str
        First body of its facade, where the drawing has several.
    """

    kind: str
    sides: tuple[float, float]
    base: float
    section: Model
    of: str = ""

    @property
    def name(self) -> str:
        """What it is called."""
        whose = f" of '{self.of}'" if self.of else ""
        sides = "" if self.kind == "facade" else f", x = {self.sides[0]:.4g} to {self.sides[1]:.4g} m"
        return f"{self.kind}{whose}{sides}"

    @property
    def symmetric(self) -> bool:
        """Whether the section is its own mirror image, so that both senses are one."""
        bodies = self.section.free_bodies
        low, high = (np.array([f(b.vertices[:, 0]) for b in bodies]) for f in (np.min, np.max))
        off = [abs(q.at[0]) for q in self.section.loads if q.at is not None]
        return bool(max(np.abs(low + high).max(), *off, 0.0) <= 1e-9 * self.section.size)

    @property
    def likeness(self) -> tuple[float, ...]:
        """Numbers that are the same for strips that differ in width alone."""
        crush = any(law.compressive_strength is not None for law in self.section.laws.values())
        bodies = self.section.free_bodies
        weight = [self.section.materials[b.material].unit_weight * b.volume for b in bodies]
        total = 1.0 if crush else sum(weight) or 1.0
        depth = [float(b.volume) for b in bodies] if crush else []
        shape = [v for b in bodies for v in (*b.vertices.min(0), *b.vertices.max(0))]
        loads = [v for q in self.section.loads if q.at is not None for v in (q.value[1] / total, *q.at)]
        return tuple(float(f"{v:.9g}") for v in (*shape, *(w / total for w in weight), *depth, *loads))


def strips_of(model: Model, held: OutOfPlane, facades: Sequence[Sequence[int]]) -> tuple[Strip, ...]:
    """Return the strips of facades drawn in elevation.

    Parameters
    ----------
    model : Model
        In the plane; x along the facade, y up.
    held : OutOfPlane
    facades : sequence of sequences of int
        The bodies of each, from :func:`~concio.analysis.seismic.open_items.facades_of`: one that stands apart from
        another has strips, openings and measures of its own.

    Raises
    ------
    InputError
        No facade reaches a height at which they are held, or loads bear outside one.
    """
    drawn = [_Facade(model, held, bodies) for bodies in facades]
    _check_held(held, drawn)
    made: list[Strip] = []
    for facade in drawn:
        of = model.bodies[facade.free[0]].name if len(drawn) > 1 else ""
        for kind, a, b, base in _ranges(facade):
            section = facade.section(a, b, base)
            if section is not None:
                made.append(Strip(kind, (a, b), base, section, of))
    return tuple(made)


def _check_held(held: OutOfPlane, facades: Sequence[_Facade]) -> None:
    """Refuse a height at which no facade can be held.

    Raises
    ------
    InputError
    """
    for z in held.held if facades else ():
        if not any(facade.reaches(z) for facade in facades):
            low, high = min(f.low[1] for f in facades), max(f.high[1] for f in facades)
            msg = f"the facade is held at {z:g} m, but it reaches from {low:g} to {high:g} m"
            raise InputError(msg, where="out_of_plane", hint="heights are those of the drawing")


def _ranges(facade: _Facade) -> list[tuple[str, float, float, float]]:
    """Return kind, sides and base of the strips that there are."""
    low, high, base = facade.low[0], facade.high[0], facade.low[1]
    openings = [o for o in facade.openings if o.sides[1] > o.sides[0]]
    lines = sorted({low, high, *(float(s) for o in openings for s in o.sides)})
    bands = [(a, b, _over(openings, a, b)) for a, b in pairwise(lines)]
    found = [("facade", low, high, base)]
    for k, (a, b, over) in enumerate(bands):
        if over is not None:
            found += [("over opening", a, b, over)] if over < facade.high[1] - 1e-6 * facade.size else []
            continue
        if len(bands) == 1:
            continue
        found.append(("pier", a, b, base))
        left = _half(bands, k, -1)
        right = _half(bands, k, 1)
        if (left, right) != (a, b) and (left, right) != (low, high):
            found.append(("pier with openings", left, right, base))
    wide = NARROW * (high - low)
    return [(kind, a, b, z) for kind, a, b, z in found if b - a > wide]


def _over(openings: Sequence[Opening], a: float, b: float) -> float | None:
    """Return the height above all openings between two lines; None where there is no opening."""
    return max((o.heights[1] for o in openings if o.sides[0] < b and o.sides[1] > a), default=None)


def _half(bands: Sequence[tuple[float, float, float | None]], k: int, step: int) -> float:
    """Return the middle of the run of bands with openings beside a pier, or the side of the pier."""
    side = int(step > 0)
    ends = [band[:2][side] for band in bands]
    end = far = ends[k]
    j = k + step
    while 0 <= j < len(bands) and bands[j][2] is not None:
        far = ends[j]
        j += step
    return (end + far) / 2.0 if 0 <= j < len(bands) else far


class _Facade:
    """The stones of a facade, its openings and what acts downwards on it."""

    def __init__(self, model: Model, held: OutOfPlane, bodies: Sequence[int]) -> None:
        self.model, self.held, self.free = model, held, list(bodies)
        outlines = model.outlines
        self.shapes = {i: shapely.Polygon(outlines[i].outline, outlines[i].holes) for i in self.free}
        points = np.vstack([outlines[i].outline for i in self.free])
        self.low, self.high = points.min(0).tolist(), points.max(0).tolist()
        self.size = surroundings(model).of(self.free)
        self.openings = openings_of(model, self.free, np.array([1.0, 0.0]))
        self.weights = self._weights()
        self.loads = self._loads()

    def reaches(self, z: float) -> bool:
        """Return whether it can be held at a height."""
        return bool(self.low[1] < z <= self.high[1] + APART * self.size)

    def _weights(self) -> dict[int, float]:
        """Return the force downwards on each unit of volume of each stone [kN/m3]."""
        found = dict.fromkeys(self.free, 0.0)
        for load in self.model.loads:
            if load.kind not in ("weight", "body"):
                continue
            for b in set(loaded_bodies(self.model, load)) & found.keys():
                per = self.model.materials[self.model.bodies[b].material].unit_weight if load.kind == "weight" else 1.0
                found[b] -= per * float(load.value[1])
        return found

    def _loads(self) -> list[tuple[int, float, float, float, float]]:
        """Return body, ends along x, height and force downwards of every other load [m, kN]."""
        model, found = self.model, []
        for load in model.loads:
            if load.kind == "point":
                assert load.at is not None
                found += [(b, load.at[0], load.at[0], load.at[1], -float(load.value[1]))
                          for b in loaded_bodies(model, load) if b in self.shapes]  # fmt: skip
            elif load.kind in ("pressure", "traction"):
                for face in (face for face in loaded_faces(model, load) if face.body in self.shapes):
                    outline, thick = model.outlines[face.body].outline, model.outlines[face.body].thickness
                    p, q = outline[face.edge], outline[(face.edge + 1) % len(outline)]
                    along = (q - p) / float(np.linalg.norm(q - p))
                    vector = load.value[0] * face.inward if load.kind == "pressure" else np.array(load.value)
                    for start, stop in face.parts:
                        a, b = p + along * start, p + along * stop
                        down = -float(vector[1]) * thick * (stop - start)
                        first, last = sorted((float(a[0]), float(b[0])))
                        found.append((face.body, first, last, float(a[1] + b[1]) / 2, down))
        return [x for x in found if x[-1]]

    # -- one strip ----------------------------------------------------------------------------------------------------

    def section(self, a: float, b: float, base: float) -> Model | None:
        """Return the section of a strip from a height on; None where nothing lies on its foot, or it is in pieces."""
        heights = self._heights(a, b, base)
        courses = []
        for low, high in pairwise(heights):
            course = self._course(a, b, low, high)
            if course is None:
                break
            courses.append((low, high, *course))
        if not courses or sum(w for *_, w in courses) <= 0:
            return None
        return self._model(courses, self._down(a, b, base, courses[-1][1]))

    def _heights(self, a: float, b: float, base: float) -> list[float]:
        """Return the heights at which a strip may crack, from its foot to its top."""
        near, apart = 1e-6 * self.size, APART * self.size
        bounds = [s.bounds for s in self.shapes.values()]
        spans = np.array([v for v in bounds if v[0] < b - near and v[2] > a + near])
        top = float(spans[:, 3].max(initial=base)) if len(spans) else base
        kept = [base, top, *self.held.held, *(z for _, x0, x1, z, _ in self.loads if x0 <= b and x1 >= a),
                *(z for o in self.openings if o.sides[0] < b and o.sides[1] > a for z in o.heights)]  # fmt: skip
        every = np.sort(spans[:, [1, 3]].ravel()) if len(spans) else np.zeros(0)
        other = every[np.diff(every, prepend=-np.inf) > near]
        many = len(other)
        chosen = other if many <= MOST_COURSES else other[np.linspace(0, many - 1, MOST_COURSES).round().astype(int)]
        found: list[float] = []
        for z in kept:
            if base <= z <= top and all(abs(z - v) > apart for v in found):
                found.append(float(z))
        least = max((top - base) / (4 * MOST_COURSES), apart)
        for z in chosen:
            if base < z < top and min(abs(z - v) for v in found) > least:
                found.append(float(z))
        return sorted(found)

    def _course(self, a: float, b: float, low: float, high: float) -> tuple[float, float, float] | None:
        """Return thickness, area and weight of what a strip holds between two heights; None where that is nothing."""
        box = shapely.box(a, low, b, high)
        parts = [(i, s.intersection(box).area) for i, s in self.shapes.items() if s.intersects(box)]
        area = sum(v for _, v in parts)
        if area <= 1e-3 * (b - a) * (high - low):
            return None
        outlines = self.model.outlines
        thick = min(outlines[i].thickness for i, v in parts if v >= SHARE * area or v == max(p for _, p in parts))
        weight = sum(v * outlines[i].thickness * self.weights[i] for i, v in parts)
        return float(thick), float(area), float(weight)

    def _down(self, a: float, b: float, base: float, top: float) -> list[tuple[float, float]]:
        """Return height and force of the loads on a strip [m, kN]."""
        near = 1e-6 * self.size
        sums: dict[float, float] = {}
        for _, x0, x1, z, force in self.loads:
            if not base - near <= z <= top + near:
                continue
            if x1 - x0 > near:
                share = max(min(x1, b) - max(x0, a), 0.0) / (x1 - x0)
            else:
                last = b >= self.high[0] - near
                share = float(a <= x0 < b or (last and x0 >= a and x0 <= b))
            if share > 0:
                z = round(min(max(z, base), top), 9)
                sums[z] = sums.get(z, 0.0) + share * force
        return sorted(sums.items())

    def _model(self, courses: Sequence[tuple[float, ...]], down: Sequence[tuple[float, float]]) -> Model:
        """Return the model of a section."""
        widest = max(c[2] for c in courses)
        base = courses[0][0]
        foot = 0.1 * widest
        ground = np.array([[-widest, base - foot], [widest, base - foot], [widest, base], [-widest, base]])
        bodies = [Body("ground", ground, kind="fixed", role="ground", thickness=max(c[3] / (c[1] - c[0])
                                                                                  for c in courses))]  # fmt: skip
        materials: dict[str, Any] = {"ground": Rigid()}
        faces: list[tuple[float, float, float, float, str]] = []
        for k, (low, high, thick, area, weight) in enumerate(courses, 1):
            outer, inner = self._faces(thick, widest)
            name = f"c{k}"
            outline = np.array([[outer, low], [inner, low], [inner, high], [outer, high]])
            materials[name] = Rigid(unit_weight=weight / (area * thick))
            bodies.append(Body(name, outline, kind="rigid", material=name, thickness=area / (high - low)))
            faces.append((low, high, outer, inner, name))
        bodies[0] = replace(bodies[0], material="ground")
        loads = [Load("weight", (0.0, -1.0))]
        for z, force in down:
            _, _, outer, inner, name = next(f for f in faces if f[1] >= z - 1e-9 * self.size)
            x = (outer + inner) / 2 if self.held.bearing is None else inner - self.held.bearing
            if x <= outer:
                off, deep = f"{self.held.bearing:g} m from the inner face", f"{inner - outer:g} m thick"
                msg = f"loads at z = {z:g} m bear {off} of a wall that is {deep} there"
                raise InputError(msg, where="out_of_plane", hint="give a bearing inside the wall")
            loads.append(Load("point", (0.0, -force), bodies=(name,), at=(x, z), group="loads"))
        supports = []
        for z in self.held.held:
            own = [f for f in faces if abs(f[1] - z) <= APART * self.size]
            for _, high, outer, inner, name in own:
                at = ((outer + inner) / 2, high)
                supports.append(Support(f"held at {z:g} m", name, edge=(at, at), directions="x"))
        title = self.model.title
        return Model(
            tuple(bodies), materials, {"joint": _weakest(self.model)}, loads=tuple(loads),
            supports=tuple(supports), title=title, report=self.model.report, engine=self.model.engine,
        )  # fmt: skip

    def _faces(self, thick: float, widest: float) -> tuple[float, float]:
        """Return where the outer and the inner face of a course lie [m]."""
        if self.held.flush == "outer":
            return -widest / 2, thick - widest / 2
        if self.held.flush == "inner":
            return widest / 2 - thick, widest / 2
        return -thick / 2, thick / 2


def _weakest(model: Model) -> JointLaw:
    """Return a law with the least of all strengths of the joints of a model, and without cohesion."""
    laws: Mapping[str, JointLaw] = {rule.law: model.laws[rule.law] for rule in model.rules}
    crush = [v.compressive_strength for v in laws.values() if v.compressive_strength is not None]
    friction = min(v.friction for v in laws.values())
    return JointLaw(friction=friction, compressive_strength=min(crush, default=None))
