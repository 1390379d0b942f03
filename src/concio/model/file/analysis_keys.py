"""Keys of [analysis] that hold for all blocks of a file, and those that mean nothing in the plane or in space."""

from __future__ import annotations

from concio.errors import InputError
from concio.model.file.acting_tables import AnalysisTable
from concio.model.file.tables import Table

IN_PLANE = ("thickness", "plane")
"""Keys that mean nothing in space."""


def thickness_of_all(analysis: AnalysisTable, name: str, table: Table) -> dict[str, float]:
    """Return the thickness that [analysis] states, for the table of a plane generator that states none."""
    own = {"thickness", "width"} if name == "bridge" else {"thickness"}
    if "thickness" not in analysis.model_fields_set or "thickness" not in type(table).model_fields:
        return {}
    return {} if own & table.model_fields_set else {"thickness": analysis.thickness}


def check_dimension(analysis: AnalysisTable, dim: int, *, extruded: bool) -> None:
    """Refuse keys that are stated and mean nothing for a model of ``dim`` dimensions.

    Parameters
    ----------
    analysis : AnalysisTable
    dim : int
        Of the model before it is extruded.
    extruded : bool
        Whether a plane model is swept into space.

    Raises
    ------
    InputError
        A key is stated that changes nothing.
    """
    stated = [key for key in IN_PLANE if dim == 3 and key in analysis.model_fields_set]
    if stated:
        msg = f"{' and '.join(stated)} mean{'s' * (len(stated) == 1)} nothing for blocks in space"
        raise InputError(msg, where="[analysis]", hint="leave it out: blocks in space have their own thickness")
    if dim == 2 and not extruded and analysis.contact_points != "auto":
        msg = f"contact_points = {analysis.contact_points!r} means nothing for blocks in the plane"
        raise InputError(msg, where="[analysis]", hint="leave it out: it places points on faces of blocks in space")
