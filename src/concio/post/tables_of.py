"""The tables of a result, whatever its dimension."""

from __future__ import annotations

from typing import TYPE_CHECKING

from concio.post.result_tables import Tables
from concio.post.space_tables import SpaceTables

if TYPE_CHECKING:
    from concio.analysis.result import Result


def tables_of(result: Result) -> Tables:
    """Return the tables of a result, in the plane or in space."""
    return Tables(result) if result.model.dim == 2 else SpaceTables(result)
