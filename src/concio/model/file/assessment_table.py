"""The tables ``[site]`` and ``[assessment]`` of a model file: what a seismic assessment asks.

They say nothing of the structure: ``concio.load`` checks them and leaves it at that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field, StrictInt, StrictStr, ValidationError, ValidationInfo, field_validator

from concio.model.file.acting_tables import ControlTable
from concio.model.file.file_errors import first_fault
from concio.model.file.tables import Name, Table
from concio.model.file.values import (
    Area,
    FileUnits,
    Force,
    Length,
    Number,
    Stress,
    UnitWeight,
    converted,
    units_of,
)

Acceleration = Annotated[StrictStr | float, Field(description="in g, or a text with m/s2")]
Seconds = Annotated[StrictStr | float, Field(description="in s")]
Kind = TypeVar("Kind", bound=Table)


class HazardTable(Table):
    """What one limit state or one return period brings.

    Keys
    ----
    F0 :
        Largest spectral amplification.
    Tc :
        Period T*_C of the code.
    """

    a_g: Acceleration
    F0: Number | None = None
    Tc: Seconds | None = None
    T_R: Annotated[StrictStr | float | None, Field(description="return period in years")] = None


class BuildingTable(Table):
    """A mode of the building: of a regular one by height and storeys, or by period, participation and shape.

    Keys
    ----
    height :
        Of the building.
    storeys :
        Number of storeys.
    T1 :
        First period, in s; estimated from the height where it is not given.
    base :
        Height of the foundation.
    T :
        Period of a mode, in s.
    participation :
        Participation factor of the mode.
    shape :
        Displacement of the mode at the height of the mechanism.
    xi :
        Damping ratio; 0.05 where it is not given.
    """

    height: Length | None = None
    storeys: StrictInt | None = None
    T1: Number | None = None
    base: Length | None = None
    T: Number | None = None
    participation: Number | None = None
    shape: Number | None = None
    xi: Number | None = None


class SiteTable(Table):
    """The arguments of :class:`concio.Site`, or the place in a grid that gives the hazard.

    Keys
    ----
    hazard :
        By limit state, or a row for each return period.
    grid :
        File of a grid of hazards, with columns ``lon``, ``lat``, and ``ag475``, ``F0475``, ``Tc475`` and so on.
    coordinates :
        Longitude and latitude of the place in degrees, as the grid has them.
    source :
        Where the hazard comes from; printed in the report.
    """

    hazard: dict[str, HazardTable] | list[HazardTable] | None = None
    grid: StrictStr = ""
    coordinates: tuple[Number, Number] | None = None
    source: StrictStr = ""
    soil: Name = "A"
    topography: Name = "T1"
    nominal_life: Number = 50.0
    use_class: Name = "II"
    code: Name = "ntc2018"
    spectrum_type: Name = "1"
    building: BuildingTable | list[BuildingTable] = Field(default_factory=list)


class HeightsTable(Table):
    """Bodies by the height of their centroid.

    Keys
    ----
    above, below :
        Bodies whose centroid lies above, or below, this height.
    """

    above: Length | None = None
    below: Length | None = None


class AnchorTable(Table):
    """The anchor of a tie; strengths are design values, already divided by their factors.

    Keys
    ----
    tie :
        Name of the tie.
    steel_area :
        Area of the steel.
    steel_strength :
        Design strength of the steel.
    plate :
        Width and height of the anchor plate.
    wall_thickness :
        Thickness of the wall behind the plate.
    shear_strength :
        Design shear strength of the masonry.
    bearing_strength :
        Design strength of the masonry under the plate.
    depth :
        Depth of a bonded anchor.
    hole :
        Diameter of the hole of a bonded anchor.
    """

    tie: Name
    steel_area: Area | None = None
    steel_strength: Stress | None = None
    plate: tuple[Length, Length] | None = None
    wall_thickness: Length | None = None
    shear_strength: Stress | None = None
    bearing_strength: Stress | None = None
    depth: Length | None = None
    hole: Length | None = None


class FreeStandingTable(Table):
    """An element that is free to vibrate; the arguments of ``FreeStanding``.

    Keys
    ----
    kind :
        Which closed formula gives its period; see the how-to on assessment.
    length :
        Free height of the element.
    thickness :
        Its thickness.
    unit_weight :
        Its weight per volume.
    """

    kind: Name
    E: Stress
    length: Length | None = None
    thickness: Length | None = None
    unit_weight: UnitWeight | None = None


class OutOfPlaneTable(Table):
    """How a facade drawn in elevation is held out of its plane; the arguments of ``OutOfPlane``.

    Keys
    ----
    held :
        Heights at which floors or ties hold the facade sideways, in both senses.
    flush :
        Which faces of stones of different thickness lie in one plane.
    bearing :
        Distance from the inner face at which loads act; by default half the thickness.
    """

    held: list[Length] = Field(default_factory=list)
    flush: Literal["middle", "outer", "inner"] = "middle"
    bearing: Length | None = None


class StrengthenTable(Table):
    """A strengthening whose least amount is found; the arguments of ``Measure``.

    Keys
    ----
    kind :
        What is done: force of a tie, weight on bodies, width of a buttress, cohesion in the joints of a zone.
    of :
        Name of the tie, or bodies by name, role, layer or pattern.
    zeta :
        Value that zeta_E is to reach.
    largest :
        Largest amount that is tried: a force, a weight, a width or a cohesion.
    side :
        Of a buttress: at which side of these bodies it stands; along y in space alone.
    height :
        Of a buttress; by default that of these bodies.
    unit_weight :
        Of a buttress.
    heights :
        Of a tie: heights at which it could be; the one where it needs the least force is found.
    """

    kind: Literal["tie", "mass", "buttress", "grout"]
    of: list[Name]
    zeta: Number = 1.0
    largest: Annotated[Any, Field(description="a number in the file's system, or a text with a unit")] = None
    side: Literal["left", "right", "-x", "+x", "-y", "+y"] = "left"
    height: Length | None = None
    unit_weight: UnitWeight = 20.0
    heights: list[Length] = Field(default_factory=list)

    @field_validator("largest", mode="after")
    @classmethod
    def _largest(cls, value: Any, info: ValidationInfo) -> float | None:
        kind = {"buttress": "length", "grout": "stress"}.get(info.data.get("kind", ""), "force")
        return None if value is None else converted(value, kind, units_of(info))


class ReportTextTable(Table):
    """What stands in the head of the report, and its language.

    Keys
    ----
    project, place, author, date, revision :
        Printed in the head of the report.
    knowledge :
        What is known of the structure, and from where.
    judgement :
        Whether and why the author accepts the results; printed in the annex, where a place is left for it otherwise.
    full :
        Whether everything is printed: all mechanisms in detail, all blocks of the check by hand.
    language :
        Language of the report.
    """

    project: StrictStr = ""
    place: StrictStr = ""
    author: StrictStr = ""
    date: StrictStr = ""
    revision: StrictStr = ""
    knowledge: StrictStr = ""
    judgement: StrictStr = ""
    full: bool = False
    language: Literal["en", "it"] = "en"


class AssessmentTable(Table):
    """The arguments of :func:`concio.assess`, ties to dimension, anchors, and what the report is headed with.

    Keys
    ----
    largest_tie :
        Largest force that is tried for ``size_tie``.
    sensitivity :
        Whether the report says how the answer changes with what was assumed.
    anchors :
        Anchors of ties that are checked.
    report :
        Head and language of the report.
    """

    levels: list[Name] | None = None
    mechanisms: dict[str, list[StrictStr] | HeightsTable] = Field(default_factory=dict)
    direction: StrictStr | tuple[Number, Number] | None = None
    live: list[Name] | None = None
    knowledge: Name = "LC1"
    confidence: Number | None = None
    control: ControlTable | None = None
    limits: dict[str, Length] = Field(default_factory=dict)
    curve: Literal["followed", "straight"] = "followed"
    free_standing: Annotated[
        dict[str, FreeStandingTable], Field(description="by mechanism: parapets, chimneys, gables; see the how-to")
    ] = Field(default_factory=dict)
    accept_linear: Annotated[
        bool, Field(description="whether a limit state is met where the linear check is")
    ] = False
    q: Annotated[Number | None, Field(description="behaviour factor of the linear check; by default the code's")] = None
    participation: Annotated[
        Number | None, Field(description="share of the mass that takes part, e*; by default that of each mechanism")
    ] = None
    out_of_plane: Annotated[
        OutOfPlaneTable | None, Field(description="of a facade drawn in elevation: what holds it out of its plane")
    ] = None
    reasons: Annotated[
        dict[str, StrictStr],
        Field(description="why the author decided so: of levels, direction, knowledge, accept_linear, q, ..."),
    ] = Field(default_factory=dict)
    elsewhere: Annotated[
        list[StrictStr], Field(description="what the author answers for: out of plane, height, ties")
    ] = Field(default_factory=list)
    size_tie: Annotated[StrictStr, Field(description="tie whose force is found that brings zeta_E to one")] = ""
    largest_tie: Force | None = None
    strengthen: Annotated[
        StrengthenTable | None, Field(description="a strengthening whose least amount is found")
    ] = None
    sensitivity: bool = True
    anchors: list[AnchorTable] = Field(default_factory=list)
    report: ReportTextTable = Field(default_factory=ReportTextTable)


SiteEntry = Annotated[SiteTable | None, Field(description="seismic hazard and soil; see concio assess")]
AssessmentEntry = Annotated[AssessmentTable | None, Field(description="what concio assess looks for")]


def assessment_tables(
    data: Mapping[str, Any], units: FileUnits, where: str
) -> tuple[SiteTable | None, AssessmentTable]:
    """Return the tables ``[site]`` and ``[assessment]`` of the tables of a file, checked.

    Raises
    ------
    InputError
        One holds a key that is not known, or a value that does not fit.
    """
    site = _checked(data, "site", SiteTable, units, where) if "site" in data else None
    given = _checked(data, "assessment", AssessmentTable, units, where) if "assessment" in data else AssessmentTable()
    return site, given


def _checked(data: Mapping[str, Any], key: str, kind: type[Kind], units: FileUnits, where: str) -> Kind:
    try:
        return kind.model_validate(data[key], context={"units": units})
    except ValidationError as error:
        raise first_fault(error, data[key], kind, f"{where}, [{key}]") from None
