"""The question of a verdict: which loads act, with how many kN, what is multiplied, and what was asked for."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Protocol

import numpy as np

from concio.contact.factors import load_factor
from concio.display import DEFAULT, Units, number
from concio.fem.discretisation import RIGID, Discretisation
from concio.model.actions import Support
from concio.model.body import Body
from concio.model.model import Model
from concio.model.stages import Stage

Role = Literal["constant", "multiplied", "not applied"]

DEFAULT_THICKNESS = 1.0
"""Thickness of a plane body where none is given [m]."""
MOST_THICKNESSES = 3
MOST_STAGES = 4
"""More stages than this are not named where they are not followed."""

GIVEN = 15
"""Digits of a factor that was given: near a limit the seventh decides between two answers."""


@dataclass(frozen=True)
class Acting:
    """A load group in a question.

    Parameters
    ----------
    group : str
    what : str
        What belongs to it, such as ``"self-weight of 12 blocks, 1 pressure"``.
    force : tuple of float
        Resultant at factor 1 [kN].
    size : float
        Sum over the bodies of the magnitude of the force on each, at factor 1 [kN]: not zero where forces cancel.
    factor : float
        The factor that the answer is for: of a constant group its factor, of a multiplied one the factor reached; nan
        where the answer is about no single one.
    role : {"constant", "multiplied", "not applied"}
    asked : float or None
        Of a multiplied group, the factor that was asked for.
    """

    group: str
    what: str
    force: tuple[float, ...]
    size: float
    factor: float = 1.0
    role: Role = "constant"
    asked: float | None = None

    def sentence(self, units: Units = DEFAULT) -> str:
        """Return the group with its factor and its forces in words."""
        loads = self._loads(units)
        if self.role == "not applied":
            return f"{self.group}: not applied ({loads})"
        if self.role == "multiplied":
            reached = "" if math.isnan(self.factor) else f", reached {number(self.factor, 6)}"
            asked = "" if self.asked is None else f", asked for {number(self.asked, 6)}"
            return f"{self.group}: multiplied{asked}{reached}; at factor 1 {loads}"
        factor = "" if self.factor == 1.0 else f" x {number(self.factor, GIVEN)}"
        return f"{self.group}{factor}: constant; {'at factor 1 ' if factor else ''}{loads}"

    def _loads(self, units: Units) -> str:
        if not self.size:
            return f"{self.what}, 0 kN"
        resultant = float(np.linalg.norm(self.force))
        if resultant < 1e-9 * self.size:
            return f"{self.what}, {units.text('force', self.size, 4)} in forces that balance"
        return f"{self.what}, {self._resultant(units)}"

    def _resultant(self, units: Units) -> str:
        """Return the components of the resultant that are not zero, in words."""
        size = float(np.linalg.norm(self.force))
        told = units.force_vector(_without_dust(self.force), size=size).split(", ")
        return ", ".join(text for text, value in zip(told, _without_dust(self.force), strict=True) if value)

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain types [kN]."""
        return {
            "group": self.group, "what": self.what, "force": list(self.force), "size": self.size,
            "factor": None if math.isnan(self.factor) else self.factor, "role": self.role, "asked": self.asked,
        }  # fmt: skip


def _without_dust(force: tuple[float, ...]) -> tuple[float, ...]:
    most = max(map(abs, force))
    return tuple(0.0 if abs(v) < 1e-9 * most else v for v in force)


@dataclass(frozen=True)
class Question:
    """What was asked.

    Parameters
    ----------
    asked : str
        A phrase, such as ``"equilibrium under the loads that act"``.
    acting : tuple of Acting
        Every load group of the model, applied or not.
    assumptions : tuple of str
        What the model leaves to a default and the answer rests on, such as the thickness.
    """

    asked: str
    acting: tuple[Acting, ...] = ()
    assumptions: tuple[str, ...] = field(default=())

    @property
    def nothing_acts(self) -> bool:
        """Whether no group applies a force or moves a support."""
        return all(a.role == "not applied" or not (a.size or "moved" in a.what) for a in self.acting)

    def loads(self, units: Units = DEFAULT) -> tuple[str, ...]:
        """Return what acts, a sentence a group."""
        if not self.acting:
            return ("nothing: the model has no loads and no support is moved",)
        return tuple(a.sentence(units) for a in self.acting)

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain types [kN]."""
        return {
            "asked": self.asked,
            "acting": [a.as_dict() for a in self.acting],
            "assumptions": list(self.assumptions),
        }


class Loaded(Protocol):
    """An assembly, or anything else whose loads can be reported."""

    @property
    def model(self) -> Model:
        """The model."""

    @property
    def disc(self) -> Discretisation:
        """Its bodies with their unknowns."""

    @property
    def groups(self) -> tuple[str, ...]:
        """The load groups."""

    @property
    def loads(self) -> Mapping[str, np.ndarray]:
        """The forces of each load group (N,) [kN]."""


def question_of(
    asked: str,
    assembly: Loaded,
    factors: Mapping[str, float] | None = None,
    *,
    multiplied: Mapping[str, float] | Iterable[str] = (),
    wanted: Mapping[str, float] | None = None,
    applied: Iterable[str] | None = None,
    stages: Iterable[Stage] = (),
) -> Question:
    """Return a question about an assembly, with the forces of every load group.

    Parameters
    ----------
    asked : str
    assembly : Assembly
    factors : mapping of str to float, optional
        Factors of the constant groups; a group that is not named has 1.
    multiplied : mapping of str to float, or names
        Groups that are multiplied, with the factor that was reached where one was.
    wanted : mapping of str to float, optional
        Factors that were asked for of multiplied groups.
    applied : names, optional
        Groups that are applied at all; by default every one.
    stages : iterable of Stage, optional
        Stages that are followed; by default none.
    """
    reached = dict(multiplied) if isinstance(multiplied, Mapping) else dict.fromkeys(multiplied, math.nan)
    named = None if applied is None else {*applied, *reached}
    acting = []
    for one in acting_groups(assembly):
        group = one.group
        if named is not None and group not in named:
            acting.append(replace(one, factor=0.0, role="not applied"))
        elif group in reached:
            acting.append(replace(one, factor=reached[group], role="multiplied", asked=(wanted or {}).get(group)))
        else:
            factor = load_factor(factors, group)
            acting.append(replace(one, factor=factor, role="constant" if factor else "not applied"))
    assumptions = (*assumed_words(assembly.model), *other_stages(assembly.model, stages))
    return Question(asked, tuple(acting), assumptions)


def acting_groups(assembly: Loaded) -> tuple[Acting, ...]:
    """Return every load group of an assembly at factor 1."""
    forces, sizes, none = resultants(assembly), _sizes(assembly), (0.0,) * assembly.disc.dim
    return tuple(
        Acting(group, group_words(assembly.model, group), tuple(forces.get(group, none)), sizes.get(group, 0.0))
        for group in assembly.groups
    )


def group_words(model: Model, group: str) -> str:
    """Return what belongs to a load group, such as ``"self-weight, 2 pressures, 1 support moved"``."""
    kinds = Counter(load.kind for load in model.loads if load.group == group)
    words = ["self-weight"] if kinds.pop("weight", 0) else []
    words += [f"{count} {kind} load{'s' * (count > 1)}" for kind, count in kinds.items()]
    moved = sum(s.moves for s in model.supports if s.group == group)
    words += [f"{moved} support{'s' * (moved > 1)} moved"] if moved else []
    warmed = sum(change.group == group for change in model.temperatures)
    words += [f"{warmed} change{'s' * (warmed > 1)} of temperature"] if warmed else []
    return ", ".join(words) or "nothing"


def movement_words(model: Model, group: str, amount: float = 1.0) -> tuple[str, ...]:
    """Return each movement that a load group imposes, such as ``"'left wall' moves by 4 mm along x (support 'push')"``.

    Parameters
    ----------
    model : Model
    group : str
    amount : float
        Factor of the group.
    """
    return tuple(
        f"'{s.body}' moves by {', '.join(_movements(s, amount, model.report))} (support '{s.name}')"
        for s in model.supports if s.group == group and s.moves
    )  # fmt: skip


def _movements(support: Support, amount: float, units: Units) -> list[str]:
    """Return the components of a movement that are not zero, in words."""
    turns = np.ravel(support.rotation)
    shifts = [("motion", v, f"along {axis}") for v, axis in zip(support.displacement, "xyz", strict=False)]
    axes = "xyz" if len(turns) > 1 else "z"
    shifts += [("rotation", v, f"about {axis}") for v, axis in zip(turns, axes, strict=True)]
    return [f"{units.text(kind, amount * float(v), 4)} {way}" for kind, v, way in shifts if v]


def assumed_words(model: Model) -> tuple[str, ...]:
    """Return what a model leaves to a default: its thickness, and that no block has a weight where none has."""
    free = [b for b in model.bodies if b.kind != "fixed"]
    light = bool(free) and model.periods is None and not any(model.materials[b.material].unit_weight for b in free)
    return (*thickness_words(model), *(("no block has a unit weight: there is no self-weight",) if light else ()))


def thickness_words(model: Model) -> tuple[str, ...]:
    """Return the thickness of a plane model in a sentence, with a word where it is the default; none in space."""
    depths = sorted({b.thickness for b in model.bodies if isinstance(b, Body) and b.kind != "fixed"})
    if not depths:
        return ()
    if depths == [DEFAULT_THICKNESS]:
        return (f"thickness {DEFAULT_THICKNESS:g} m, the default where none is given",)
    shown = ", ".join(f"{v:g}" for v in depths[:MOST_THICKNESSES]) + (" ..." if len(depths) > MOST_THICKNESSES else "")
    return (f"thickness {shown} m",)


def other_stages(model: Model, followed: Iterable[Stage] = ()) -> tuple[str, ...]:
    """Return in a sentence that stages of a model are not those that are followed; none where they are, or of a cell.

    Stages of the same names and factors are those of the model, with a control or with steps of their own.

    Parameters
    ----------
    model : Model
    followed : iterable of Stage, optional
    """
    own = model.stages
    asked, stated = ([(stage.name, dict(stage.factors)) for stage in stages] for stages in (followed, own))
    if not own or model.periods is not None or asked == stated:
        return ()
    names = ", ".join(f"'{stage.name}'" for stage in own[:MOST_STAGES]) + (" ..." if len(own) > MOST_STAGES else "")
    return (f"the stages of the model are not followed, nor do their factors act: {names}; 'concio path' follows them",)


def resultants(assembly: Loaded) -> dict[str, list[float]]:
    """Return the resultant (x, y) or (x, y, z) of each load group [kN]."""
    return {group: body_forces(assembly, f).sum(0).tolist() for group, f in assembly.loads.items()}


def _sizes(assembly: Loaded) -> dict[str, float]:
    return {group: float(np.linalg.norm(body_forces(assembly, f), axis=1).sum()) for group, f in assembly.loads.items()}


def body_forces(assembly: Loaded, f: np.ndarray) -> np.ndarray:
    """Return the resultant (bodies, d) of the loads on each body [kN]."""
    disc = assembly.disc
    d = disc.dim
    found = np.zeros((len(disc.shape_of), d))
    for b, free in enumerate(np.diff(disc.offsets)):
        own = f[disc.offsets[b] : disc.offsets[b + 1]]
        if disc.shape_of[b] == RIGID:
            found[b] = own[:d]
        elif free:
            found[b] = own.reshape(-1, d).sum(0)
    return found
