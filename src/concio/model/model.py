"""The model: bodies, joints, supports and loads. Frozen dataclasses; everything else is derived from them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property
from os import PathLike, fspath
from typing import ClassVar, Literal, get_args

import numpy as np

from concio.arguments import closest, strict_class
from concio.display import DEFAULT, Units
from concio.errors import InputError
from concio.kinematics.mass import Moments, polygon_moments
from concio.model.described import model_lines
from concio.model.dimensions import WORDS, resolved
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.polyhedron import Polyhedron
from concio.model.rings import check_holes, checked_ring, following
from concio.model.stages import Stage
from concio.representation import short_repr

Array = np.ndarray
Periods = tuple[tuple[float, float], tuple[float, float]]
Kind = Literal["elastic", "rigid", "fixed"]
Face = Literal["lower", "upper", "left", "right", "both"]
FACES: tuple[str, ...] = get_args(Face)
"""Faces of a joint that a load along it may act on."""
Point = tuple[float, ...]
"""A point or a vector with as many coordinates as the model has dimensions."""


@strict_class
@short_repr
@dataclass(frozen=True, eq=False)
class Body:
    """A block, a mortar film or an obstacle: a polygon, with holes or without.

    Parameters
    ----------
    name : str
        Unique in the model.
    outline : (n, 2) array
        Vertices [m]; stored counter-clockwise without the closing repetition.
    material : str
        Key of ``Model.materials``; ignored for fixed bodies.
    kind : {"elastic", "rigid", "fixed"}
        A fixed body has no unknowns: it is an obstacle (ground, wall, bearing).
    role : str
        "block", "mortar", "obstacle"...: chooses joint laws and colours.
    layer : str
        Free label, for instance the layer of a drawing.
    thickness : float
        Out-of-plane thickness [m].
    grid : (xs, ys) or None
        Mesh lines of a rectangle with sides along x and y; None lets concio mesh.
    mesh_size : float or None
        Target element size [m]; None takes the model's.
    holes : sequence of (k, 2) arrays
        Interior rings, inside the outline and clear of it and of each other [m]; stored clockwise. Other bodies may
        stand in them, as a shelf in a frame.
    """

    name: str
    outline: Array
    material: str = "block"
    kind: Kind = "elastic"
    role: str = "block"
    layer: str = ""
    thickness: float = 1.0
    grid: tuple[Array, Array] | None = None
    mesh_size: float | None = None
    holes: Sequence[Array] = ()

    dim: ClassVar[int] = 2

    def __post_init__(self) -> None:
        where = f"block '{self.name}'"
        object.__setattr__(self, "outline", checked_ring(self.outline, "outline", where))
        holes = tuple(checked_ring(h, f"hole {k}", where, clockwise=True) for k, h in enumerate(self.holes, 1))
        object.__setattr__(self, "holes", holes)
        if holes:
            check_holes(self.outline, holes, where)
            if self.grid is not None:
                msg = "a body with holes has no grid of mesh lines"
                raise InputError(msg, where=where, hint="leave grid out; mesh_size says how fine its mesh is")
        if not (0 < self.thickness < math.inf):
            msg = f"thickness = {self.thickness:g} must be positive and finite"
            raise InputError(msg, where=where)
        if self.kind not in ("elastic", "rigid", "fixed"):
            msg = f"kind '{self.kind}' is not one of elastic, rigid, fixed"
            raise InputError(msg, where=where)

    @cached_property
    def moments(self) -> Moments:
        """Area, centroid and second moments."""
        return polygon_moments(self.outline, self.holes)

    @property
    def area(self) -> float:
        """Area [m2]."""
        return self.moments.measure

    @property
    def centroid(self) -> Array:
        """Centroid (2,) [m]."""
        return self.moments.centroid

    @property
    def rings(self) -> tuple[Array, ...]:
        """The outline, counter-clockwise, and the holes, clockwise: the body lies to the left of every side [m]."""
        return self.outline, *self.holes

    @cached_property
    def vertices(self) -> Array:
        """Vertices (n, 2) of the outline, then of the holes [m]; edge k runs from vertex k to ``following[k]``."""
        return np.concatenate(self.rings) if self.holes else self.outline

    @cached_property
    def following(self) -> Array:
        """Number (n,) of the vertex that comes after each on its ring."""
        return following([len(ring) for ring in self.rings])

    @property
    def volume(self) -> float:
        """Area times thickness [m3]."""
        return self.area * self.thickness


def called(word: str, body: Body | Polyhedron) -> bool:
    """Return whether a word is the name, role or layer of a body, or a pattern (with ``*``) of its name."""
    if "*" in word:
        return word == "*" or fnmatchcase(body.name, word)
    return word != "" and word in (body.name, body.role, body.layer)


@strict_class
@dataclass(frozen=True)
class JointRule:
    """Chooses the law of the interfaces between two sorts of bodies.

    Parameters
    ----------
    law : str
        Key of ``Model.laws``.
    between : pair of str
        Each matches a body by name, role, layer, (unless it is fixed) material, or by a pattern of names such as
        ``"tower-*"``; "*" matches any. Order does not matter. The last rule that matches an interface wins. A word
        that names no body of a model is refused.
    gap : float
        Initial opening of these interfaces, added to what the geometry shows >= 0 [m].
    """

    law: str
    between: tuple[str, str] = ("*", "*")
    gap: float = 0.0

    def __post_init__(self) -> None:
        if not (0 <= self.gap < math.inf):
            msg = f"initial gap = {self.gap:g} must be zero or positive and finite"
            raise InputError(msg, hint="a gap is an opening in m; overlaps are not gaps")

    def matches(self, a: Body | Polyhedron, b: Body | Polyhedron) -> bool:
        """Return whether the rule speaks of interfaces between ``a`` and ``b``."""

        def fits(word: str, body: Body | Polyhedron) -> bool:
            return called(word, body) or (word == body.material != "" and body.kind != "fixed")

        p, q = self.between
        return (fits(p, a) and fits(q, b)) or (fits(p, b) and fits(q, a))


def check_rules(rules: Sequence[JointRule], bodies: Sequence[Body | Polyhedron], where: str = "") -> None:
    """Refuse rules that name what no body is called: they would be void.

    Raises
    ------
    InputError
        With the word that was probably meant.
    """
    known = dict.fromkeys(word for place in range(4) for b in bodies for word in (_words(b)[place],) if word)
    for rule in rules:
        for word in rule.between:
            if word not in known and not any("*" in word and called(word, b) for b in bodies):
                msg = f"the rule for the joint law '{rule.law}' names '{word}', but no body has that name, role, layer "
                msg += "or material"
                hint = closest(word, known, otherwise="see the names with 'concio check --all'" * (len(known) > 30))
                raise InputError(msg, where=where or None, hint=hint)


def _words(body: Body | Polyhedron) -> tuple[str, str, str, str]:
    """Return the words by which rules find a body: role, layer, material, name."""
    return body.role, body.layer, "" if body.kind == "fixed" else body.material, body.name


ENGINES = ("superlu", "pardiso")
"""What factorises linear systems."""


@strict_class
@short_repr
@dataclass(frozen=True)
class Support:
    """Holds unknowns of elastic or rigid bodies, with or without an imposed displacement.

    Parameters
    ----------
    name : str
    body : str
        Body by name; a fixed body may be moved, which pushes or drags what touches it.
    edge : (point, point) or None
        Segment of the outline that is held, in space a line; a point is a segment of length zero. Without edge and
        polygon the whole body is held.
    directions : str
        Any of "x", "y" and, in space, "z"; or "all".
    displacement : (ux, uy) or (ux, uy, uz)
        Imposed displacement [m]; empty is none.
    rotation : float, or (rx, ry, rz) in space
        Imposed rotation about the body's centroid, fixed and rigid bodies only [rad].
    group : str
        Load group that scales the imposed displacement.
    polygon : tuple of points, or None
        In space: the part of the body's faces that is held, as a planar polygon [m].
    """

    name: str
    body: str
    edge: tuple[Point, Point] | None = None
    directions: str = "all"
    displacement: Point = ()
    rotation: float | Point = 0.0
    group: str = "settlement"
    polygon: tuple[Point, ...] | None = None

    @property
    def moves(self) -> bool:
        """Whether a displacement or a rotation is imposed."""
        return bool(np.any(self.displacement) or np.any(self.rotation))


@strict_class
@short_repr
@dataclass(frozen=True)
class Load:
    """A load on the bodies it names.

    Parameters
    ----------
    kind : {"weight", "pressure", "traction", "point", "body"}
        weight: unit weight times volume, times the vector ``value``: (0, -1) is gravity, in space (0, 0, -1);
        (0.1, 0) a horizontal share of a tenth. pressure: ``value[0]`` [kN/m2], positive pushes against the face.
        traction: vector [kN/m2] on an edge or polygon. point: vector [kN] at ``at``. body: vector per volume [kN/m3].
    value : tuple of float
    bodies : tuple of str
        Names, roles, layers, or patterns of names such as ``"tower-*"``; empty means every body that is not fixed.
    edge : (point, point) or None
        Segment for pressure and traction in the plane; only outline parts that lie on it are loaded.
    at : point or None
        Point of a point load [m].
    group : str
        Load group; groups are scaled by load factors.
    face : {"lower", "upper", "left", "right", "both"} or None
        Which of the two faces of a joint a pressure or traction acts on that lies in a joint between two of the
        bodies; None is the lower one, the top of the body below. Where the edge lies on one face only, it is that one.
    polygon : tuple of points, or None
        Planar polygon for pressure and traction in space; only parts of faces that lie in it are loaded [m].
    """

    kind: Literal["weight", "pressure", "traction", "point", "body"]
    value: tuple[float, ...]
    bodies: tuple[str, ...] = ()
    edge: tuple[Point, Point] | None = None
    at: Point | None = None
    group: str = "dead"
    face: Face | None = None
    polygon: tuple[Point, ...] | None = None


@strict_class
@short_repr
@dataclass(frozen=True)
class Tie:
    """A straight bar that takes tension only, with prestress, between two bodies or a body and a fixed point.

    Parameters
    ----------
    name : str
    body_a, body_b : str
        Body names; ``body_b`` may be "" for a fixed point in space.
    at_a, at_b : points
        Ends [m].
    stiffness : float
        E A / L > 0 [kN/m].
    prestress : float
        Tension at zero elongation >= 0 [kN].
    yield_force : float or None
        Largest tension, of the bar or of its anchors [kN]; None is unlimited.
    break_elongation : float or None
        Elongation at which it breaks [m], which counts where a mechanism is followed far; None is never.
    """

    name: str
    body_a: str
    at_a: Point
    body_b: str
    at_b: Point
    stiffness: float
    prestress: float = 0.0
    yield_force: float | None = None
    break_elongation: float | None = None

    @property
    def most(self) -> float:
        """Largest tension [kN]; ``inf`` where it is unlimited."""
        return math.inf if self.yield_force is None else self.yield_force

    def force(self, elongation: float) -> float:
        """Return the tension [kN] at an elongation [m] that was never larger: elastic, then plastic, then broken."""
        if self.break_elongation is not None and elongation >= self.break_elongation:
            return 0.0
        return min(max(self.prestress + self.stiffness * elongation, 0.0), self.most)


@strict_class
@dataclass(frozen=True, eq=False)
class Model:
    """A masonry structure in the plane or in space.

    Parameters
    ----------
    bodies : tuple of Body, or of Polyhedron
        Outlines make a model in the plane, polyhedra one in space.
    materials : mapping of str to Elastic or Rigid
    laws : mapping of str to JointLaw
    rules : tuple of JointRule
        The last rule that matches an interface gives its law.
    supports, loads, ties : tuples
    plane : {"stress", "strain"}
        Of plane models.
    element : str
        In the plane "Q4", "Q4I" (incompatible modes), "Q8", "Q9", "T3", "T6"; in space "H8I" (hexahedra with
        incompatible modes), "H8", "H27", "T4", "T10". Empty takes the first.
    mesh_size : float or None
        Target element size [m]; None takes a quarter of each body's longer side.
    refinement : int
        Every element is split ``refinement`` times more (1: as described).
    gap_tolerance : float or None
        Edges or faces closer than this touch [m]; None takes 1e-6 of the size of the model.
    gap_reach : float
        Edges further apart than the tolerance but within this become pairs with an initial gap [m].
    title : str
    generator : mapping
        How the model was made, for the record.
    stages : tuple of Stage
        Load path that comes with the model; :func:`concio.run_path` takes it where it is given no stages.
    periods : ((x1, y1), (x2, y2)) or None
        The model is a *cell* that these two vectors repeat in the plane without end [m]: its interfaces wrap round, and
        nothing else may hold or load it. See :mod:`concio.model.periodic`.
    contact_points : {"auto", "corners"} or int
        Where contact is stated between two blocks in space that are not meshed: at the corners of each patch, or at
        n x n points over it, which distribute pressure. "auto" takes corners for hard joints, 4 x 4 points for joints
        with stiffness, 6 x 6 for joints that crush.
    report : Units
        Units in which texts, figures and reports tell what was found; arrays and files are in kN and m.
    engine : {"superlu", "pardiso"}
        What factorises linear systems, in the methods that leave the choice; "pardiso" comes with ``concio[fast]``.
    """

    bodies: tuple[Body | Polyhedron, ...]
    materials: Mapping[str, Elastic | Rigid]
    laws: Mapping[str, JointLaw]
    rules: tuple[JointRule, ...] = (JointRule("joint"),)
    supports: tuple[Support, ...] = ()
    loads: tuple[Load, ...] = ()
    ties: tuple[Tie, ...] = ()
    plane: Literal["stress", "strain"] = "stress"
    element: str = ""
    mesh_size: float | None = None
    refinement: int = 1
    gap_tolerance: float | None = None
    gap_reach: float = 0.0
    title: str = ""
    generator: Mapping[str, object] = field(default_factory=dict)
    stages: tuple[Stage, ...] = ()
    periods: Periods | None = None
    contact_points: str | int = "auto"
    report: Units = DEFAULT
    engine: Literal["superlu", "pardiso"] = "superlu"

    def __repr__(self) -> str:
        return "\n".join(model_lines(self))

    def _repr_html_(self) -> str:
        from concio.report.notebook import model_html

        return model_html(self)

    def __post_init__(self) -> None:
        if not self.bodies:
            msg = "the model has no bodies"
            raise InputError(msg, hint="describe at least one block")
        for name, value in resolved(self).items():
            object.__setattr__(self, name, value)
        if self.engine not in ENGINES:
            msg = f"unknown factorisation engine '{self.engine}'"
            raise InputError(msg, hint=closest(str(self.engine), ENGINES))
        points = self.contact_points
        if points not in ("auto", "corners") and not (isinstance(points, int) and 2 <= points <= 20):
            msg = f"contact_points = {points!r} is not 'auto', 'corners' or a whole number from 2 to 20"
            raise InputError(msg, hint="4 means 4 x 4 points on each patch")
        names = [b.name for b in self.bodies]
        if len(set(names)) != len(names):
            twice = next(n for n in names if names.count(n) > 1)
            msg = f"two bodies are called '{twice}'"
            raise InputError(msg, hint="give each body a name of its own")
        for body in self.bodies:
            if body.kind == "fixed":
                continue
            if body.material not in self.materials:
                msg = f"material '{body.material}' is not defined"
                raise InputError(msg, where=f"block '{body.name}'", hint=closest(body.material, self.materials))
            material = self.materials[body.material]
            if (body.kind == "rigid") != isinstance(material, Rigid):
                msg = f"a body of kind '{body.kind}' has the material '{body.material}' ({type(material).__name__})"
                raise InputError(msg, where=f"block '{body.name}'", hint="rigid bodies take a Rigid material")
        for rule in self.rules:
            if rule.law not in self.laws:
                msg = f"joint law '{rule.law}' is not defined"
                raise InputError(msg, hint=closest(rule.law, self.laws))
        check_rules(self.rules, self.bodies)
        if self.periods is not None:
            check_cell(self)

    @property
    def dim(self) -> int:
        """Dimension: 2 in the plane, 3 in space."""
        return int(self.bodies[0].dim)

    @cached_property
    def outlines(self) -> tuple[Body, ...]:
        """The bodies of a plane model.

        Raises
        ------
        InputError
            The model is in space.
        """
        found = tuple(b for b in self.bodies if isinstance(b, Body))
        self._require(len(found) == len(self.bodies), 2)
        return found

    @cached_property
    def polyhedra(self) -> tuple[Polyhedron, ...]:
        """The bodies of a model in space.

        Raises
        ------
        InputError
            The model is plane.
        """
        found = tuple(b for b in self.bodies if isinstance(b, Polyhedron))
        self._require(len(found) == len(self.bodies), 3)
        return found

    def _require(self, right: bool, dim: int) -> None:
        if not right:
            msg = f"this is for models {WORDS[dim]}; the model is {WORDS[self.dim]}"
            raise InputError(msg, hint="concio.extrude makes a model in space of a plane one" if dim == 3 else None)

    @cached_property
    def size(self) -> float:
        """Longest side of the box around all bodies [m]; it does not depend on where the origin is."""
        low, high = (np.array([f(b.vertices, axis=0) for b in self.bodies]) for f in (np.min, np.max))
        return float((high.max(0) - low.min(0)).max())

    @property
    def free_bodies(self) -> tuple[Body | Polyhedron, ...]:
        """Bodies that have unknowns."""
        return tuple(b for b in self.bodies if b.kind != "fixed")

    @property
    def load_groups(self) -> tuple[str, ...]:
        """Names of the load groups, in order of appearance."""
        return tuple(dict.fromkeys([load.group for load in self.loads] + [s.group for s in self.supports]))

    def body(self, name: str) -> Body | Polyhedron:
        """Return the body called ``name``."""
        for body in self.bodies:
            if body.name == name:
                return body
        msg = f"there is no body called '{name}'"
        hint = closest(name, (b.name for b in self.bodies), otherwise="see the names with 'concio check'")
        raise InputError(msg, hint=hint)

    def rule_between(self, a: Body | Polyhedron, b: Body | Polyhedron) -> JointRule:
        """Return the rule of an interface between two bodies: the last that matches.

        Raises
        ------
        InputError
            No rule matches.
        """
        for rule in reversed(self.rules):
            if rule.matches(a, b):
                return rule
        msg = f"no joint law for the interface between '{a.name}' and '{b.name}'"
        raise InputError(msg, hint="add a rule between '*' and '*'")


def check_cell(model: Model) -> None:
    """Refuse a periodic cell that is held or loaded by anything but its neighbours, or whose periods span no area.

    Raises
    ------
    InputError
    """
    assert model.periods is not None
    periods = np.asarray(model.periods, dtype=float)
    if periods.shape != (2, 2) or not np.isfinite(periods).all():
        msg = f"periods = {model.periods!r} must be two vectors (x, y)"
        raise InputError(msg, hint="for example ((0.25, 0.0), (0.0, 0.12))")
    if abs(float(np.linalg.det(periods))) <= 1e-9 * float(np.abs(periods).max()) ** 2:
        msg = "the two periods are parallel: they span no cell"
        raise InputError(msg, hint="give for example the length and the height of the cell")
    fixed = [b.name for b in model.bodies if b.kind == "fixed"]
    for what, found in (
        (f"a fixed body ('{fixed[0]}')" if fixed else "", fixed), ("supports", model.supports),
        ("loads", model.loads), ("ties", model.ties), ("a gap_reach", model.gap_reach),
    ):  # fmt: skip
        if found:
            msg = f"a periodic cell has {what}"
            hint = "a cell is held and loaded by its neighbours alone: macroscopic strains and stresses act on it"
            raise InputError(msg, hint=hint)
    depths = {b.thickness for b in model.bodies}
    if len(depths) > 1:
        msg = f"the bodies of a periodic cell have {len(depths)} thicknesses"
        raise InputError(msg, hint="macroscopic stress is force over length and thickness: give them all one")


def require_model(thing: object) -> None:
    """Refuse anything that is not a model.

    Raises
    ------
    InputError
        It is something else, the name of a file for example.
    """
    if not isinstance(thing, Model):
        what = f"the name '{fspath(thing)}'" if isinstance(thing, str | PathLike) else type(thing).__name__
        msg = f"a model is needed, {what} was given"
        raise InputError(msg, hint="concio.load reads a model from a file")
