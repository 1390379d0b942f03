"""What a model file asks of a diagnosis: ``[survey]`` with measurements and candidates, and tables of measurements."""

from __future__ import annotations

import csv
import io
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from concio.analysis.cracks.measurement import ANGLES, AT_A_JOINT, Candidate, Measurement
from concio.arguments import closest
from concio.errors import InputError
from concio.files import read_text, unguarded
from concio.model.file.reading import file_units, model_from_tables, read_tables
from concio.model.file.survey_table import CandidateTable, MeasurementTable, SurveyTable, survey_table
from concio.model.model import Model
from concio.units import HEADING, quantity

COLUMNS = (
    "name", "kind", "value", "error", "body_a", "body_b", "x", "y", "z", "to_x", "to_y", "to_z", "along_x", "along_y",
    "along_z",
)  # fmt: skip
"""Columns of a table of measurements; of a joint both bodies, else the body and that of the second point."""
NO_VALUE = "give it; a joint that was found closed is of kind 'closed', and what was not measured is left out"


@dataclass(frozen=True, eq=False)
class Survey:
    """A model with what was measured on it.

    Parameters
    ----------
    model : Model
    measurements : tuple of Measurement
    candidates : tuple of Candidate
    options : mapping
        Further arguments of :func:`concio.diagnose`.
    head : mapping of str to str
        What the report is headed with: project, place, author, date, language.
    """

    model: Model
    measurements: tuple[Measurement, ...]
    candidates: tuple[Candidate, ...]
    options: Mapping[str, Any] = field(default_factory=dict)
    head: Mapping[str, str] = field(default_factory=dict)


def read_survey(path: str | os.PathLike[str]) -> Survey:
    """Return the model of a file with its survey.

    Raises
    ------
    InputError
        As :func:`concio.load`; or there is no survey, or something in it cannot be used.
    """
    path = Path(path)
    data = read_tables(path)
    name = str(path)
    model = model_from_tables(data, folder=path.parent, name=name)
    table = survey_table(data, file_units(data, name), name)
    if table is None:
        msg = "there is no table [survey]"
        hint = "give [[survey.measurements]] and [[survey.candidates]]; see the page 'From cracks to cause'"
        raise InputError(msg, where=name, hint=hint)
    where = f"{name}, [[survey.measurements]]"
    found = [_measurement(m, table, f"{where} {k}") for k, m in enumerate(table.measurements, 1)]
    if table.measurements_file:
        errors = {"length": table.error, "angle": table.error_of_tilts}
        length = data.get("units", {}).get("length", "m")
        found += read_measurements(path.parent / table.measurements_file, errors, length=length)
    candidates = tuple(_candidate(c) for c in table.candidates)
    options = {
        key: getattr(table, key) for key in ("most", "beyond", "confidence", "steps", "method", "large")
        if getattr(table, key) is not None
    }  # fmt: skip
    return Survey(model, tuple(found), candidates, options, table.report.model_dump())


def read_measurements(
    path: str | os.PathLike[str], errors: Mapping[str, float | None] | None = None, *, length: str = "m"
) -> tuple[Measurement, ...]:
    """Return the measurements of a CSV table.

    The first line names columns among :data:`COLUMNS`, with a unit in brackets where numbers have one, such as
    ``value [mm]``; without a unit they are in m. A cell may say its own unit: ``2 mrad``.

    Parameters
    ----------
    path : str or Path
    errors : mapping, optional
        Standard deviations of ``"length"`` [m] and ``"angle"`` [rad] where a line gives none.
    length : str
        Unit of the bare lengths of the model file; those of the table have to say their own where that is not m.

    Raises
    ------
    InputError
        The file is missing or not of that form; the message names line and column.
    """
    path = Path(path)
    text = read_text(path, hint="paths in a model file are relative to it")
    return tuple(_row(row, units, errors or {}, place, length) for place, row, units in _rows(text, str(path)))


def _rows(text: str, where: str) -> Iterator[tuple[str, dict[str, str], dict[str, str]]]:
    """Yield the place, the cells that are not empty, and the units of the columns of each line."""
    reader = csv.reader(io.StringIO(text), skipinitialspace=True)
    try:
        header = next(reader, [])
        units: dict[str, str] = {}
        for cell in header:
            match = HEADING.match(unguarded(cell))
            name = match["name"] if match else cell
            if name not in COLUMNS:
                msg = f"unknown column '{cell}'"
                hint = "columns are separated by commas" if ";" in cell else closest(name, COLUMNS, names="columns")
                if cell.split("(")[0].strip() in COLUMNS:
                    hint = f"units stand in square brackets: {cell.replace('(', '[').replace(')', ']')}"
                raise InputError(msg, where=where, hint=hint)
            if name in units:
                msg = f"the column '{name}' is there twice"
                raise InputError(msg, where=where, hint="leave one of them out")
            units[name] = (match["unit"] if match else None) or ""
        if "name" not in units:
            msg = "there is no column 'name'"
            raise InputError(msg, where=where, hint="the first line names the columns: " + ",".join(COLUMNS[:8]))
        for row in reader:
            place = f"{where}, line {reader.line_num}"
            if not any(cell.strip() for cell in row):
                continue
            if len(row) != len(units):
                msg = f"{len(units)} values were expected, {len(row)} are there"
                raise InputError(msg, where=place, hint="the decimal separator is a point; values are separated by "
                "commas")
            yield place, {k: unguarded(v.strip()) for k, v in zip(units, row, strict=True) if v.strip()}, units
    except csv.Error as error:
        msg = f"line {reader.line_num} cannot be read: {error}"
        raise InputError(msg, where=where) from None


def _row(
    row: Mapping[str, str], units: Mapping[str, str], errors: Mapping[str, float | None], place: str, length: str
) -> Measurement:
    """Return the measurement of a line."""

    def read(key: str, kind: str) -> float:
        text = row[key]
        bare = re.fullmatch(r"[-+\d.eE]+", text) is not None
        if bare and not units[key] and kind == "length" and length != "m":
            msg = f"the model file counts in {length}, and the table does not say the unit of '{key}'"
            raise InputError(msg, where=f"{place}, {key}", hint=f"name the column '{key} [{length}]'")
        return quantity(f"{text} {units[key]}".strip() if bare else text, kind, where=f"{place}, {key}")

    kind = row.get("kind", "opening")
    unit = "angle" if kind in ANGLES else "length"
    error = read("error", unit) if "error" in row else errors.get(unit)
    points = {}
    for start in ("", "to_", "along_"):
        cells = [f"{start}{axis}" for axis in "xyz" if f"{start}{axis}" in row]
        given = tuple(read(c, "number" if start == "along_" else "length") for c in cells)
        points[start] = given if len(given) > 1 else None
        if len(given) == 1:
            msg = f"only {cells[0]} of a point is given"
            raise InputError(msg, where=place, hint="give all its coordinates, or none")
    if error is None:
        msg = "the error is missing"
        raise InputError(msg, where=place, hint="give a column 'error', or error = '0.5 mm' in [survey]")
    if "value" not in row and kind != "closed":
        msg = "the value is missing"
        raise InputError(msg, where=place, hint=NO_VALUE)
    bodies = tuple(row[key] for key in ("body_a", "body_b") if key in row)
    at_a_joint = kind in AT_A_JOINT
    try:
        return Measurement(
            row.get("name", ""), kind, error, read("value", unit) if "value" in row else 0.0,  # type: ignore[arg-type]
            joint=bodies if at_a_joint else (), body="" if at_a_joint else row.get("body_a", ""), at=points[""],
            other="" if at_a_joint else row.get("body_b", ""), to=points["to_"], direction=points["along_"] or (),
        )  # fmt: skip
    except InputError as fault:
        told = (fault.where or "").startswith(place)
        where = fault.where if told else ", ".join(filter(None, (place, fault.where)))
        raise InputError(fault.what, where=where, hint=fault.hint) from None


def _measurement(table: MeasurementTable, survey: SurveyTable, where: str) -> Measurement:
    error = table.error
    if error is None:
        error = survey.error_of_tilts if table.kind in ANGLES else survey.error
    if error is None:
        key = "error_of_tilts = '0.5 mrad'" if table.kind in ANGLES else "error = '0.5 mm'"
        msg = "the error is missing"
        raise InputError(msg, where=f"{where} '{table.name}'", hint=f"give error, or {key} in [survey] for all")
    if table.value is None and table.kind != "closed":
        msg = "the value is missing"
        raise InputError(msg, where=f"{where} '{table.name}'", hint=NO_VALUE)
    return Measurement(
        table.name, table.kind, error, table.value or 0.0, joint=table.joint or (), body=table.body, at=table.at,
        other=table.other, to=table.to, direction=table.direction or (),
    )  # fmt: skip


def _candidate(table: CandidateTable) -> Candidate:
    bounds = {key: getattr(table, key) for key in ("low", "high") if getattr(table, key) is not None}
    return Candidate(
        table.name, body=table.body, direction=table.direction or (), rotation=table.rotation, about=table.about,
        group=table.group, base=table.base, times=table.times, **bounds,
    )  # fmt: skip
