"""Tables ``[fill]`` and ``[vehicle]`` of a model file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StrictBool, StrictStr, Tag, ValidationInfo, field_validator

from concio.errors import InputError
from concio.model.crossing import Axle, Vehicle
from concio.model.file.file_errors import placed
from concio.model.file.tables import Name, Point, Table, word_or_table
from concio.model.file.values import (
    Degrees,
    FileUnits,
    JointStiffness,
    Length,
    Number,
    Stress,
    UnitWeight,
    converted,
    fault,
    units_of,
)
from concio.model.fill import Fill, Layer
from concio.model.model import Model
from concio.model.road.earth import with_fill, with_vehicle
from concio.model.road.spread import spread_rule
from concio.model.road.vehicles import axles_of, convoy, find_vehicle


class LayerTable(Table):
    """A layer of the road above the fill.

    Keys
    ----
    name :
        What it is, for reports.
    """

    name: Name = "surfacing"
    depth: Length
    unit_weight: UnitWeight


class SpreadTable(Table):
    """A rule of the user's by which live load spreads; see :class:`concio.model.road.spread.SpreadRule`.

    Keys
    ----
    name :
        Name under which reports give it.
    source :
        Where it is published.
    """

    name: Name = "own"
    along: Number
    across: Number
    shape: Literal["uniform", "sine", "boussinesq"] = "uniform"
    length: Length = 0.0
    width: Length = 0.0
    footprint: Length | None = None
    width_over: Length | None = None
    source: StrictStr = ""


def _width_branch(value: Any) -> str:
    return "<name>" if isinstance(value, str) and not value[:1].isdigit() else "<number>"


Spread = Annotated[
    Annotated[StrictStr, Tag("<name>")] | Annotated[SpreadTable, Tag("<table>")], Discriminator(word_or_table)
]
"""The name of a spread rule, or a rule of the user's."""
Width = Annotated[
    Annotated[Literal["full", "rule"], Tag("<name>")] | Annotated[Length, Tag("<number>")], Discriminator(_width_branch)
]
"""A width, or how it is found."""


class FillTable(Table):
    """Fill between the masonry and the road; see :class:`concio.model.fill.Fill`."""

    cover: Length | None = None
    gradient: Number = 0.0
    road: list[Point] = Field(default_factory=list)
    unit_weight: UnitWeight = 20.0
    layers: list[LayerTable] = Field(default_factory=list)
    fill_line: list[Point] = Field(default_factory=list)
    surfacing_weight: UnitWeight = 23.0
    spandrels: Length = 0.0
    spandrel_weight: UnitWeight = 22.0
    parapet: Length = 0.0
    spread: Spread = "uniform 1:2"
    width: Width = "full"
    friction_angle: Degrees | None = None
    cohesion: Stress = 0.0
    mobilised: Number = 1.0
    passive: Number | None = None
    pressure: Literal["none", "active", "at rest"] = "none"
    stiffness: JointStiffness = 20_000.0
    group: Name = "fill"
    bridge_width: Length | None = Field(None, description="of the bodies before width made them narrower")
    applied: StrictBool = Field(default=False, description="its loads and soil elements are already in the file")


class FollowerTable(Table):
    """Another vehicle, its reference point at a distance from that of the first.

    Keys
    ----
    name :
        Name of a vehicle of the library.
    """

    name: Name
    distance: Length


class VehicleTable(Table):
    """What crosses the bridge; see :class:`concio.model.crossing.Vehicle`.

    Keys
    ----
    name :
        Name of a vehicle of the library, or of one of your own.
    also :
        Further vehicles on the bridge.
    """

    name: Name = "own"
    axles: list[Any] | None = Field(None, description="[place in m, load in kN] each, or tables with at and load")
    lanes: list[list[Any]] = Field(default_factory=list, description="[from, to, kN per m] each, or texts with units")
    position: Length | None = None
    footprint: Length | None = None
    width: Length | None = None
    direction: Literal["right", "left", "both"] | None = None
    dynamic: Number | None = None
    factor: Number | None = None
    group: Name | None = None
    source: StrictStr | None = None
    assumed: StrictStr | None = None
    unfavourable: StrictBool | None = None
    loaded: list[list[Length]] | None = Field(None, description="[from, to] of uniform load on the road")
    also: list[FollowerTable] = Field(default_factory=list)
    applied: StrictBool = Field(default=False, description="its loads are already in the file")

    @field_validator("axles", "lanes", mode="after")
    @classmethod
    def _said(cls, value: list[Any] | None, info: ValidationInfo) -> list[Any] | None:
        """Refuse bare numbers, which are in m and kN, in a file of another system: either is as likely meant."""
        if units_of(info) != FileUnits():
            for k, given in enumerate(value or [], 1):
                parts = given.values() if isinstance(given, Mapping) else given if isinstance(given, list) else ()
                bare = next((v for v in parts if isinstance(v, int | float) and v != 0), None)
                if bare is not None:
                    what = "axle" if info.field_name == "axles" else "stretch"
                    msg = f"{what} {k} has a bare number, {bare:g}, and this file is not in kN and m"
                    form = "[['1.2 m', '100 kN']]" if what == "axle" else "[['0 m', '5 m', '9 kN/m']]"
                    raise fault(msg, f"write its unit, as in {form}")
        if info.field_name == "lanes":
            kinds = ("length", "length", "line load")
            return [[converted(v, kind, FileUnits()) for v, kind in zip(lane, kinds, strict=False)]
                    + lane[len(kinds) :] for lane in value or []]  # fmt: skip
        return value


def fill_of(table: FillTable) -> Fill:
    """Return the fill of a table.

    Raises
    ------
    InputError
        It says something that cannot be.
    """
    own = table.model_fields_set - {"applied", "layers", "spread"}
    given: dict[str, Any] = {key: getattr(table, key) for key in own}
    for key in {"road", "fill_line"} & given.keys():
        given[key] = tuple((p[0], p[1]) for p in given[key])
    given["layers"] = tuple(Layer(t.depth, t.unit_weight, t.name) for t in table.layers)
    given["spread"] = table.spread if isinstance(table.spread, str) else table.spread.model_dump(exclude_unset=True)
    spread_rule(given["spread"])
    return Fill(**given)


def vehicle_of(table: VehicleTable) -> Vehicle:
    """Return the vehicle of a table: one of the library, or one of the user's, and what goes with it.

    Raises
    ------
    InputError
        There is none of that name, or it says something that cannot be.
    """
    own = {f.name for f in fields(Vehicle)} - {"name", "axles"}
    given = {key: getattr(table, key) for key in table.model_fields_set & own}
    if table.axles is None and not table.lanes:
        if "name" not in table.model_fields_set:
            msg = "neither name nor axles is given"
            raise InputError(msg, where="vehicle", hint="for example name = 'single axle', or axles = [[0.0, 112.8]]")
        vehicle = replace(find_vehicle(table.name), **given)
    else:
        vehicle = Vehicle(table.name, axles_of(table.axles or [], table.lanes), **given)
    others = [(find_vehicle(t.name), t.distance) for t in table.also]
    return convoy(vehicle, others) if others else vehicle


def crossed(model: Model, fill: FillTable | None, vehicle: VehicleTable | None) -> Model:
    """Return a model with the fill and the vehicle of a file on it.

    Raises
    ------
    InputError
        They do not go with the model.
    """
    if fill is not None:
        with placed("[fill]", own="fill"):
            found = fill_of(fill)
            model = replace(model, fill=found) if fill.applied else with_fill(model, found)
    if vehicle is not None:
        with placed("[vehicle]", own="vehicle"):
            one = vehicle_of(vehicle)
            model = replace(model, vehicle=one) if vehicle.applied else with_vehicle(model, one)
    return model


def fill_table(fill: Fill) -> dict[str, Any]:
    """Return the table that :func:`fill_of` reads back, its loads standing in the file."""
    found = {f.name: getattr(fill, f.name) for f in fields(fill) if getattr(fill, f.name) is not None}
    for key in ("road", "fill_line"):
        if not found[key]:
            del found[key]
    if isinstance(fill.spread, dict):
        found["spread"] = {k: v for k, v in fill.spread.items() if v is not None}
    found["layers"] = [{"name": x.name, "depth": x.depth, "unit_weight": x.unit_weight} for x in fill.layers] or None
    return {**found, "applied": True}


def vehicle_table(vehicle: Vehicle) -> dict[str, Any]:
    """Return the table that :func:`vehicle_of` reads back, its loads standing in the file."""
    found = {f.name: getattr(vehicle, f.name) or None for f in fields(vehicle) if f.name not in ("axles", "position")}
    found["position"] = vehicle.position
    found["loaded"] = None if vehicle.loaded is None else [list(part) for part in vehicle.loaded]
    found["axles"] = [{f.name: getattr(a, f.name) for f in fields(Axle) if getattr(a, f.name) is not None}
                      for a in vehicle.axles]  # fmt: skip
    return {**found, "applied": True}
