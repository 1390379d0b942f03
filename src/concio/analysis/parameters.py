"""Numbers of a model that a limit multiplier depends on, each with the models that other values make."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

from concio.errors import InputError
from concio.model.materials import Elastic
from concio.model.model import Model
from concio.model.stretch import stretched, thicker


class _Named(Protocol):
    @property
    def name(self) -> str: ...


Row = TypeVar("Row", bound=_Named)


def row_named(rows: Sequence[Row], name: str) -> Row:
    """Return the row of a table of sensitivities with a name.

    Raises
    ------
    InputError
        There is none.
    """
    for row in rows:
        if row.name == name:
            return row
    msg = f"there is no sensitivity to '{name}'"
    raise InputError(msg, hint="known: " + ", ".join(row.name for row in rows))


@dataclass(frozen=True, eq=False)
class Parameter:
    """A number of a model.

    Parameters
    ----------
    kind : str
        "friction", "cohesion", "tensile strength", "compressive strength", "unit weight", "load", "tie", "length",
        "thickness" or "own".
    of : str
        The joint law, the material, the load group, the tie or the axis that it belongs to.
    value : float
        Of the model as it is.
    unit : str
        "-" where it multiplies what is in the model.
    change : callable
        Returns the model in which the number has another value.
    """

    kind: str
    of: str
    value: float
    unit: str
    change: Callable[[float], Model]

    @property
    def name(self) -> str:
        """What it is called."""
        return f"{self.kind} of {self.of}" if self.of else self.kind


LAW = {"friction": "-", "cohesion": "kN/m2", "tensile_strength": "kN/m2", "compressive_strength": "kN/m2"}


def parameters_of(model: Model, live: Sequence[str] = ()) -> tuple[Parameter, ...]:
    """Return the numbers of a model: of its joints, its weights, its other loads, its ties and its lengths.

    Parameters
    ----------
    model : Model
    live : sequence of str
        Load groups that are multiplied; they are not among the parameters.
    """
    found: list[Parameter] = []
    for law in dict.fromkeys(rule.law for rule in model.rules):
        for key, unit in LAW.items():
            value = getattr(model.laws[law], key)
            if value is not None and (value > 0 or key == "friction"):
                found.append(Parameter(key.replace("_", " "), law, float(value), unit, _law(model, law, key)))
    used = dict.fromkeys(b.material for b in model.bodies if b.kind != "fixed")
    found += [Parameter("unit weight", name, model.materials[name].unit_weight, "kN/m3", _weight(model, name))
              for name in used if model.materials[name].unit_weight > 0]  # fmt: skip
    groups = dict.fromkeys(v.group for v in model.loads if v.group not in live and v.kind != "weight")
    found += [Parameter("load", group, 1.0, "-", _load(model, group)) for group in groups]
    found += [Parameter("tie", t.name, float(t.yield_force), "kN", _tie(model, t.name))
              for t in model.ties if t.yield_force is not None]  # fmt: skip
    for k, axis in enumerate("xyz"[: model.dim]):
        found.append(Parameter("length", axis, 1.0, "-", _length(model, k)))
    if model.dim == 2:
        found.append(Parameter("thickness", "", 1.0, "-", lambda value: thicker(model, value)))
    return tuple(found)


def stiffnesses_of(model: Model) -> tuple[Parameter, ...]:
    """Return Young's moduli in use and stiffnesses of joints: a state depends on them, no multiplier does."""
    used = dict.fromkeys(b.material for b in model.bodies if b.kind == "elastic")
    found = [Parameter("stiffness", name, material.E, "kN/m2", _modulus(model, name, material))
             for name in used if isinstance(material := model.materials[name], Elastic)]  # fmt: skip
    for law in dict.fromkeys(rule.law for rule in model.rules):
        for key in ("normal_stiffness", "tangential_stiffness"):
            if value := getattr(model.laws[law], key):
                found.append(Parameter(key.replace("_", " "), law, float(value), "kN/m3", _law(model, law, key)))
    return tuple(found)


def own_parameters(changes: Mapping[str, Callable[[float], Model]]) -> tuple[Parameter, ...]:
    """Return parameters of the user's own: for each name the model that a change of it by so much makes."""
    return tuple(Parameter("own", name, 0.0, "", change) for name, change in changes.items())


def _law(model: Model, law: str, key: str) -> Callable[[float], Model]:
    def change(value: float) -> Model:
        old = model.laws[law]
        more: dict[str, Any] = {key: value}
        if key == "friction":
            more["dilatancy"] = min(old.dilatancy, value)
        return replace(model, laws={**model.laws, law: replace(old, **more)})

    return change


def _weight(model: Model, name: str) -> Callable[[float], Model]:
    def change(value: float) -> Model:
        return replace(model, materials={**model.materials, name: replace(model.materials[name], unit_weight=value)})

    return change


def _modulus(model: Model, name: str, material: Elastic) -> Callable[[float], Model]:
    return lambda value: replace(model, materials={**model.materials, name: replace(material, E=value)})


def _load(model: Model, group: str) -> Callable[[float], Model]:
    def change(value: float) -> Model:
        loads = (replace(v, value=tuple(value * x for x in v.value)) if v.group == group and v.kind != "weight" else v
                 for v in model.loads)  # fmt: skip
        return replace(model, loads=tuple(loads))

    return change


def _tie(model: Model, name: str) -> Callable[[float], Model]:
    def change(value: float) -> Model:
        return replace(model, ties=tuple(replace(t, yield_force=value) if t.name == name else t for t in model.ties))

    return change


def _length(model: Model, axis: int) -> Callable[[float], Model]:
    def change(value: float) -> Model:
        return stretched(model, [value if k == axis else 1.0 for k in range(model.dim)])

    return change
