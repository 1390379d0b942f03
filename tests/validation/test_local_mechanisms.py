"""Local mechanisms of walls under an earthquake: the rows of the validation book."""

from __future__ import annotations

import pytest
from validation_cases import local_mechanisms
from validation_cases.row import Row


@pytest.mark.parametrize("row", local_mechanisms.rows(), ids=lambda row: row.name)
def test_row(row: Row) -> None:
    assert row.passes, f"{row.name}: {row.computed} for {row.expected}"
