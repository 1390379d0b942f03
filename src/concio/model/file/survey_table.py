"""The table ``[survey]`` of a model file: what was measured on the structure, and what may have moved.

It says nothing of the structure: ``concio.load`` checks it and leaves it at that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, StrictInt, StrictStr, ValidationError, ValidationInfo, field_validator

from concio.model.file.assessment_table import ReportTextTable
from concio.model.file.file_errors import first_fault
from concio.model.file.tables import Name, Point, Table, Vector
from concio.model.file.values import FileUnits, Number, converted, units_of

Reading = Annotated[Any, Field(description="a length, of a tilt an angle; or a text with a unit")]


class MeasurementTable(Table):
    """The arguments of :class:`concio.Measurement`.

    Keys
    ----
    name :
        Name of the measurement.
    """

    name: Name
    kind: Literal["opening", "slip", "closed", "tilt", "level", "distance"] = "opening"
    value: Reading = None
    error: Reading = None
    joint: tuple[Name, Name] | None = None
    body: StrictStr = ""
    at: Point | None = None
    other: StrictStr = ""
    to: Point | None = None
    direction: Vector | None = None

    @field_validator("value", "error", mode="after")
    @classmethod
    def _reading(cls, value: Any, info: ValidationInfo) -> float | None:
        kind = "angle" if info.data.get("kind") == "tilt" else "length"
        return None if value is None else converted(value, kind, units_of(info))


class CandidateTable(Table):
    """The arguments of :class:`concio.Candidate`.

    Keys
    ----
    name :
        Name of the possible cause.
    """

    name: Name
    body: StrictStr = ""
    direction: Vector | None = None
    rotation: Annotated[float | tuple[Number, Number, Number], Field(description="1, -1 or an axis in space")] = 0.0
    about: Point | None = None
    group: StrictStr = ""
    base: Number | None = None
    times: StrictInt = 0
    low: Annotated[Any, Field(description="smallest motion: a length, an angle, or the change of a factor")] = None
    high: Annotated[Any, Field(description="largest motion")] = None

    @field_validator("low", "high", mode="after")
    @classmethod
    def _bound(cls, value: Any, info: ValidationInfo) -> float | None:
        kind = "number" if info.data.get("group") else "length" if info.data.get("direction") else "angle"
        return None if value is None else converted(value, kind, units_of(info))


class SurveyTable(Table):
    """The arguments of :func:`concio.diagnose`, and what its report is headed with.

    Keys
    ----
    measurements :
        What was measured.
    candidates :
        What may have moved or changed.
    report :
        Head and language of the report.
    """

    measurements: list[MeasurementTable] = Field(default_factory=list)
    measurements_file: Annotated[StrictStr, Field(description="CSV table of measurements, beside the file")] = ""
    candidates: list[CandidateTable] = Field(default_factory=list)
    error: Annotated[Any, Field(description="standard deviation of measurements that give none")] = None
    error_of_tilts: Annotated[Any, Field(description="the same of tilts")] = None
    most: StrictInt | None = None
    beyond: StrictInt | None = None
    confidence: Number | None = None
    steps: StrictInt | None = None
    method: Literal["events", "steps"] | None = None
    large: StrictBool | None = None
    report: ReportTextTable = Field(default_factory=ReportTextTable)

    @field_validator("error", "error_of_tilts", mode="after")
    @classmethod
    def _error(cls, value: Any, info: ValidationInfo) -> float | None:
        kind = "angle" if info.field_name == "error_of_tilts" else "length"
        return None if value is None else converted(value, kind, units_of(info))


SurveyEntry = Annotated[SurveyTable | None, Field(description="cracks and what may have moved; see concio diagnose")]


def survey_table(data: Mapping[str, Any], units: FileUnits, where: str) -> SurveyTable | None:
    """Return the table ``[survey]`` of the tables of a file, checked; None where there is none.

    Raises
    ------
    InputError
        It holds a key that is not known, or a value that does not fit.
    """
    if "survey" not in data:
        return None
    try:
        return SurveyTable.model_validate(data["survey"], context={"units": units})
    except ValidationError as error:
        raise first_fault(error, data["survey"], SurveyTable, f"{where}, [survey]") from None
