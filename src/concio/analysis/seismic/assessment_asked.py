"""What a model file asks of an assessment: its site, its arguments, its anchors, the head of its report."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from concio.analysis.seismic.anchors import Anchor
from concio.analysis.seismic.hazard_grid import hazard_at
from concio.analysis.seismic.site import Site
from concio.analysis.seismic.strengthening import Measure
from concio.errors import InputError
from concio.model.file.assessment_table import (
    AssessmentTable,
    HeightsTable,
    SiteTable,
    StrengthenTable,
    assessment_tables,
)
from concio.model.file.reading import file_units, model_from_tables, read_tables
from concio.model.model import Model


@dataclass(frozen=True)
class Head:
    """What a report is headed with.

    Parameters
    ----------
    project, place, author, date, revision : str
    knowledge : str
        Why the level of knowledge is what it is.
    judgement : str
        Whether and why the author accepts the results; printed in the annex.
    reasons : mapping of str to str
        Why the author decided as he did, by the key of the decision.
    full : bool
        Whether everything is printed: all mechanisms in detail, all blocks of the check by hand.
    language : {"en", "it"}
    """

    project: str = ""
    place: str = ""
    author: str = ""
    date: str = ""
    revision: str = ""
    knowledge: str = ""
    judgement: str = ""
    full: bool = False
    language: str = "en"
    reasons: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Asked:
    """A model with what is asked of it.

    Parameters
    ----------
    model : Model
    arguments : mapping
        Of :func:`concio.assess`, the site included.
    size_tie : str
        Tie whose force is to be found; empty for none.
    largest_tie : float or None
        Where to stop looking [kN].
    sensitivity : bool
    anchors : tuple of Anchor
    strengthen : mapping or None
        ``measure``, ``zeta`` and ``largest`` of :func:`concio.seismic.strengthen`.
    head : Head
    """

    model: Model
    arguments: Mapping[str, Any]
    size_tie: str = ""
    largest_tie: float | None = None
    sensitivity: bool = True
    anchors: tuple[Anchor, ...] = ()
    strengthen: Mapping[str, Any] | None = None
    head: Head = field(default_factory=Head)


def read_asked(path: str | os.PathLike[str]) -> Asked:
    """Return the model of a file and what the file asks of its assessment.

    Raises
    ------
    InputError
        As :func:`concio.load`; or there is no site, or something in it is not known to its code.
    """
    path = Path(path)
    data = read_tables(path)
    name = str(path)
    model = model_from_tables(data, folder=path.parent, name=name)
    site, asked = assessment_tables(data, file_units(data, name), name)
    if site is None:
        msg = "there is no table [site]"
        hint = "give the hazard and the soil, for example [site] soil = 'B' and [site.hazard.SLV] a_g = 0.20"
        raise InputError(msg, where=name, hint=hint)
    anchors = tuple(Anchor(**a.model_dump(exclude_unset=True)) for a in asked.anchors)
    for k, anchor in enumerate(anchors, 1):
        anchor.check(model, f"{name}, [[assessment.anchors]] {k}")
    return Asked(
        model, _arguments(asked, _placed(site, path)), asked.size_tie, asked.largest_tie, asked.sensitivity, anchors,
        _strengthen(asked.strengthen), Head(**asked.report.model_dump(), reasons=asked.reasons),
    )  # fmt: skip


def check_site(data: dict[str, Any], path: Path) -> None:
    """Check ``[site]`` and ``[assessment]`` among the tables of a file, where it has them, without assessing anything.

    Raises
    ------
    InputError
        As :func:`read_asked`.
    """
    site, _ = assessment_tables(data, file_units(data, str(path)), str(path))
    if site is not None:
        _placed(site, path)


def _placed(table: SiteTable, path: Path) -> Site:
    """Return the site of a file; its faults name the table."""
    try:
        return _site(table, path.parent)
    except InputError as error:
        where = ", ".join(filter(None, (f"{path}, [site]", error.where)))
        raise InputError(error.what, where=where, hint=error.hint) from None


ASSUMED = ("soil", "topography", "nominal_life", "use_class")
"""What of a site has a value where none is given, which reports then say."""


def _site(table: SiteTable, folder: Path) -> Site:
    given = table.model_dump(exclude_none=True)
    grid, place = given.pop("grid"), given.pop("coordinates", None)
    if bool(grid) == ("hazard" in given) or (grid and place is None):
        msg = "the hazard is not given" if not grid else "the hazard is given twice, or the grid has no place"
        raise InputError(msg, hint="give [site.hazard], or grid = 'grid.csv' with coordinates = [longitude, latitude]")
    if grid:
        given["hazard"] = hazard_at(folder / grid, place)
        given["source"] = given["source"] or f"{grid}, longitude {place[0]:g}, latitude {place[1]:g}"
    given["assumed"] = tuple(key for key in ASSUMED if key not in table.model_fields_set)
    if given["code"].endswith(".toml"):
        given["code"] = str(folder / given["code"])
    return Site(**given)


def _strengthen(table: StrengthenTable | None) -> dict[str, Any] | None:
    if table is None:
        return None
    given = table.model_dump()
    zeta, largest = given.pop("zeta"), given.pop("largest")
    return {"measure": Measure(**given | {"of": tuple(table.of)}), "zeta": zeta, "largest": largest}


def _arguments(table: AssessmentTable, site: Site) -> dict[str, Any]:
    mechanisms = {
        name: words.model_dump(exclude_none=True) if isinstance(words, HeightsTable) else tuple(words)
        for name, words in table.mechanisms.items()
    }
    control = None if table.control is None else (table.control.body, table.control.at)
    return {
        "site": site, "levels": table.levels, "mechanisms": mechanisms, "direction": table.direction,
        "live": table.live, "knowledge": table.knowledge, "confidence": table.confidence, "control": control,
        "limits": table.limits, "curve": table.curve, "elsewhere": tuple(table.elsewhere),
        "accept_linear": table.accept_linear, "q": table.q, "participation": table.participation,
        "out_of_plane": None if table.out_of_plane is None else table.out_of_plane.model_dump(exclude_none=True),
        "free_standing": {k: v.model_dump(exclude_none=True) for k, v in table.free_standing.items()},
    }  # fmt: skip
