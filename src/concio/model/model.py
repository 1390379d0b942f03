"""The model: bodies, joints, supports and loads. Frozen dataclasses; everything else is derived from them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike, fspath
from typing import Literal

import numpy as np

from concio.arguments import closest, strict_class
from concio.display import DEFAULT, Units
from concio.errors import InputError
from concio.model.actions import FACES, Face, Load, Point, Support, Temperature, Tie
from concio.model.body import Body, Kind, called
from concio.model.crossing import Vehicle
from concio.model.described import model_lines
from concio.model.dimensions import WORDS, resolved
from concio.model.fill import Fill
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.polyhedron import Polyhedron
from concio.model.rules import JointRule, check_rules
from concio.model.stages import Stage
from concio.views import Shown

__all__ = [
    "ENGINES", "FACES", "Array", "Body", "Face", "JointRule", "Kind", "Load", "Model", "Periods", "Point", "Support",
    "Temperature", "Tie", "called", "check_cell", "check_rules", "require_model",
]  # fmt: skip

Array = np.ndarray
CONTROL = re.compile("[\\x00-\\x1f\\x7f-\\x9f\\u2028-\\u202e\\u2066-\\u2069]")
"""Characters that no name holds: they move the cursor, break lines or turn the direction of writing."""
Periods = tuple[tuple[float, float], tuple[float, float]]
ENGINES = ("superlu", "pardiso")
"""What factorises linear systems."""


@strict_class
@dataclass(frozen=True, eq=False)
class Model(Shown):
    """A masonry structure in the plane or in space.

    Parameters
    ----------
    bodies : tuple of Body, or of Polyhedron
        Outlines make a model in the plane, polyhedra one in space.
    materials : mapping of str to Elastic or Rigid
    laws : mapping of str to JointLaw
    rules : tuple of JointRule
        The last rule that matches an interface gives its law.
    supports, loads, ties, temperatures : tuples
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
    gap_reach : float or None
        Faces further apart than the tolerance but within this become pairs with an initial gap, 0 joins only what
        touches [m]. None joins faces that come nearer than a thousandth of the smaller block's size anywhere, over all
        of their common part: a block on a tilted foot gets the gap that is there.
    title : str
    generator : mapping
        How the model was made, for the record.
    stages : tuple of Stage
        Load path that comes with the model; :func:`concio.run_path` takes it where it is given no stages.
    periods : ((x1, y1), (x2, y2)) or None
        The model is a *cell* that these two vectors repeat periodically in the plane [m]: its interfaces wrap round,
        and nothing else may hold or load it. See :mod:`concio.model.interfaces.periodic`.
    contact_points : {"auto", "corners"} or int
        Where contact is stated between two blocks in space that are not meshed: at the corners of each patch, or at
        n x n points over it, which distribute pressure. "auto" takes corners for hard joints, 4 x 4 points for joints
        with stiffness, 14 x 14 for joints that crush.
    report : Units
        Units in which texts, figures and reports tell what was found; arrays and files are in kN and m.
    engine : {"superlu", "pardiso"}
        What factorises linear systems, in the methods that leave the choice; "pardiso" comes with ``concio[fast]``.
    fill : Fill or None
        Fill and road of a bridge, whose loads and soil elements are among ``loads`` and ``ties`` already:
        :func:`concio.with_fill` puts them there.
    vehicle : Vehicle or None
        What crosses it: :func:`concio.with_vehicle`.

    Examples
    --------
    A block on the ground, 1 m wide and 2 m high. A horizontal share of its weight overturns it at width over height:

    >>> import concio
    >>> ground = concio.Body("ground", [(-1.0, -0.5), (2.0, -0.5), (2.0, 0.0), (-1.0, 0.0)], kind="fixed")
    >>> block = concio.Body("block", [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)], "stone", kind="rigid")
    >>> model = concio.Model(
    ...     bodies=(ground, block),
    ...     materials={"stone": concio.Rigid(unit_weight=20.0)},
    ...     laws={"joint": concio.JointLaw(friction=0.7)},
    ...     loads=(concio.Load("weight", (0.0, -1.0)), concio.Load("weight", (1.0, 0.0), group="live")),
    ... )
    >>> round(concio.limit(model).design, 6)
    0.5
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
    gap_reach: float | None = None
    title: str = ""
    generator: Mapping[str, object] = field(default_factory=dict)
    stages: tuple[Stage, ...] = ()
    periods: Periods | None = None
    contact_points: str | int = "auto"
    report: Units = DEFAULT
    engine: Literal["superlu", "pardiso"] = "superlu"
    fill: Fill | None = None
    vehicle: Vehicle | None = None
    temperatures: tuple[Temperature, ...] = ()

    def __repr__(self) -> str:
        return "\n".join(model_lines(self))

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
        _check_names(self)
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
        own: tuple[Load | Support | Temperature, ...] = (*self.loads, *self.supports, *self.temperatures)
        return tuple(dict.fromkeys(action.group for action in own))

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


def _check_names(model: Model) -> None:
    """Refuse names with control characters, which no terminal, table or file would show as they are.

    Raises
    ------
    InputError
    """
    words = {word for b in model.bodies for word in (b.name, b.role, b.layer)}
    words |= {word for s in model.supports for word in (s.name, s.group)} | {t.name for t in model.ties}
    words |= {*model.load_groups, *model.materials, *model.laws}
    bad = sorted(word for word in words if CONTROL.search(word))
    if bad:
        msg = f"the name {bad[0]!r} holds a control character"
        raise InputError(msg, hint="leave it out: names stand in tables, files and on the terminal")


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
        ("loads", model.loads), ("ties", model.ties),
        ("changes of temperature", model.temperatures), ("a gap_reach", model.gap_reach),
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
