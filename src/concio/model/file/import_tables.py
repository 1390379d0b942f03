"""Tables of a model file that say how a drawing or a file of solids is read."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StrictBool, StrictStr, Tag, ValidationInfo, field_validator

from concio.model.file.acting_tables import load_value
from concio.model.file.tables import Name, Table, word_or_table
from concio.model.file.values import Force, Length, Stiffness
from concio.model.model import Face


class LayerTable(Table):
    """What a layer of a drawing means; see :mod:`concio.model.drawing.layers`.

    Keys
    ----
    use :
        What its closed lines are.
    material :
        Name of a table in ``[materials]``.
    role :
        Word by which rules find its blocks.
    thickness :
        Out of plane.
    load :
        Kind of load that its lines or points are.
    group :
        Load group; "live" by default, unlike that of ``[[loads]]``.
    face :
        Side that the loaded edge looks to.
    support :
        Directions in which its points or lines are held.
    tie :
        Stiffness of the ties that its lines are.
    yield_force, prestress :
        Of these ties.
    break_elongation :
        Of these ties.
    """

    use: Literal["block", "rigid", "fixed", "hole", "names", "ignore"] | None = None
    material: StrictStr | None = None
    role: StrictStr | None = None
    thickness: Length | None = None
    load: Literal["pressure", "traction", "point"] | None = None
    value: Annotated[Any, Field(description="a number for pressure, [x, y] otherwise")] = None
    group: Name | None = None
    face: Face | None = None
    support: Literal["x", "y", "xy"] | None = None
    tie: Stiffness | None = None
    yield_force: Force | None = None
    prestress: Force | None = None
    break_elongation: Length | None = None

    @field_validator("value", mode="after")
    @classmethod
    def _value(cls, value: Any, info: ValidationInfo) -> tuple[float, ...] | None:
        kind = info.data.get("load")
        return None if kind is None or value is None else load_value(kind, value, info)


Layer = Annotated[
    Annotated[LayerTable, Tag("<table>")] | Annotated[StrictStr, Tag("<name>")], Discriminator(word_or_table)
]
"""A table, or a word: a use or a material."""


class DrawingTable(Table):
    """How a DXF drawing is read; see :func:`concio.model.drawing.drawing.model_from_dxf`."""

    layers: dict[str, Layer] = Field(default_factory=dict)
    mend: Length = 0.0
    close: Length | None = None
    on_fault: Literal["raise", "skip"] = "raise"
    unit: StrictStr | None = None
    chord_tolerance: Length | None = None


class SolidsTable(Table):
    """How a file of solids is read; see :func:`concio.model_from_solids`."""

    layers: dict[str, StrictStr] = Field(default_factory=dict)
    unit: StrictStr | None = None
    up: Literal["y", "z"] = "z"
    mend: Length = 0.0
    on_fault: Literal["raise", "skip"] = "raise"
    ground: StrictBool = False
    gap_tolerance: Length | None = None
    split_warped: StrictBool = False
