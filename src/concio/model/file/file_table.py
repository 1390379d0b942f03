"""The table of a whole model file, generators and analyses included, and its JSON Schema."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import GenericAlias
from typing import Any

from pydantic import Field, StrictStr, create_model

from concio.model.file.acting_tables import (
    AnalysisTable,
    ExtrusionTable,
    LoadTable,
    PartTable,
    SolverTable,
    StageTable,
    SupportTable,
    TemperatureTable,
    TieTable,
)
from concio.model.file.bridge_drawing_table import BridgeDrawingTable
from concio.model.file.generator_tables import generator_table
from concio.model.file.import_tables import DrawingTable, SolidsTable
from concio.model.file.road_tables import FillTable, VehicleTable
from concio.model.file.tables import (
    BlockTable,
    JointTable,
    MaterialTable,
    Name,
    Point,
    ReportTable,
    RuleTable,
    Table,
    UnitsTable,
)
from concio.model.generate.generators import GENERATORS


class FileTable(Table):
    """A whole model file, without the tables of generators.

    Keys
    ----
    title :
        Title of the model, in reports and figures.
    materials :
        Materials by name.
    joints :
        Joint laws by name.
    rules :
        Which joint law applies between which blocks.
    blocks :
        Blocks one by one.
    blocks_file :
        CSV or JSON table of blocks, or a DXF drawing, beside the model file. Lengths of a table are in m, or in the
        unit that stands in its first line: ``name,outline [mm],thickness [mm]``.
    loads :
        Loads by group.
    supports :
        Supports, and displacements that are imposed.
    stages :
        Stages of a load path, in order.
    parts :
        Parts that the structure is put together from.
    """

    title: StrictStr = ""
    units: UnitsTable = Field(default_factory=UnitsTable)
    report: ReportTable | None = Field(None, description="units of texts, figures and reports")
    materials: dict[str, MaterialTable] = Field(default_factory=dict)
    joints: dict[str, JointTable] = Field(default_factory=dict)
    rules: list[RuleTable] | None = None
    blocks: list[BlockTable] = Field(default_factory=list)
    blocks_file: Name | None = None
    periods: tuple[Point, Point] | None = Field(None, description="the blocks are a cell that these vectors repeat")
    drawing: DrawingTable | None = None
    solids_file: Name | None = Field(None, description="blocks: OBJ, STL, PLY, OFF, IFC, 3dm, DXF, COMPAS JSON")
    solids: SolidsTable | None = None
    extrusion: ExtrusionTable | None = None
    supports: list[SupportTable] = Field(default_factory=list)
    loads: list[LoadTable] = Field(default_factory=list)
    temperatures: list[TemperatureTable] = Field(default_factory=list)
    ties: list[TieTable] = Field(default_factory=list)
    stages: list[StageTable] = Field(default_factory=list)
    analysis: AnalysisTable = Field(default_factory=AnalysisTable)
    solver: SolverTable | None = None
    bridge_drawing: BridgeDrawingTable | None = Field(None, description="lines of an existing bridge in a drawing")
    fill: FillTable | None = Field(None, description="fill and road of a bridge")
    vehicle: VehicleTable | None = Field(None, description="what crosses a bridge")
    record: dict[str, Any] = Field(default_factory=dict, description="how the model was made; not read by concio")


ANALYSES = frozenset({"study", "site", "assessment", "survey", "motion"})
"""Tables of analyses, which are not part of the model."""


def _analyses() -> dict[str, Any]:
    """Return type and default of the tables of :data:`ANALYSES`."""
    from concio.model.file.assessment_table import AssessmentEntry, SiteEntry
    from concio.model.file.motion_table import Motion
    from concio.model.file.study_table import Study
    from concio.model.file.survey_table import SurveyEntry

    types = {"study": Study, "site": SiteEntry, "assessment": AssessmentEntry, "survey": SurveyEntry, "motion": Motion}
    return {name: (kind, None) for name, kind in types.items()}


@cache
def file_table() -> type[FileTable]:
    """Return the table of a whole model file, generators included."""
    members: dict[str, Any] = {name: (generator_table(name), Field(None)) for name in GENERATORS}
    part = create_model("part", __base__=PartTable, __doc__=PartTable.__doc__, **members)
    members |= {"parts": (GenericAlias(list, (part,)), Field(default_factory=list)), **_analyses()}
    return create_model("concio model", __base__=FileTable, __doc__=FileTable.__doc__, **members)


def table_for(data: Mapping[str, Any]) -> type[FileTable]:
    """Return the table of files that state the keys of ``data`` alone, which is made sooner than that of all keys.

    Keys without a check keep their default; what this table refuses, :func:`file_table` refuses with the right words.
    """
    parts = data.get("parts")
    inside = (key for entry in parts if isinstance(entry, dict) for key in entry) if isinstance(parts, list) else ()
    return _narrow_table(frozenset(data), frozenset(inside))


@cache
def _narrow_table(stated: frozenset[str], inside: frozenset[str]) -> type[FileTable]:
    named = [name for name in GENERATORS if name in stated]
    members: dict[str, Any] = {name: (generator_table(name), Field(None)) for name in named}
    if "parts" in stated:
        own: dict[str, Any] = {name: (generator_table(name), Field(None)) for name in GENERATORS if name in inside}
        part = create_model("part", __base__=PartTable, **own)
        members["parts"] = (GenericAlias(list, (part,)), Field(default_factory=list))
    if stated & ANALYSES:
        members |= {name: entry for name, entry in _analyses().items() if name in stated}
    anything: Any = Field  # its overloads know either a default or a factory
    for name, field in FileTable.model_fields.items():
        if name not in stated:
            members[name] = (Any, anything(field.default, default_factory=field.default_factory))
    return create_model("concio model", __base__=FileTable, **members)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a model file (draft 2020-12)."""
    from concio.model.file.descriptions import described

    schema = _any_of(file_table().model_json_schema())
    schema = described(schema)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "concio model file",
        "description": "A masonry structure for concio, written in TOML.",
    }


def _any_of(schema: Any) -> Any:
    """Return a schema in which a text may be read in two ways: the angle of a coefficient and a name are both texts."""
    if isinstance(schema, dict):
        return {"anyOf" if key == "oneOf" else key: _any_of(value) for key, value in schema.items()}
    return [_any_of(value) for value in schema] if isinstance(schema, list) else schema
