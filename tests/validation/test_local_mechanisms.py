"""Local mechanisms of walls under an earthquake: the rows of the validation book."""

from __future__ import annotations

import pytest
from validation_cases import local_mechanisms
from validation_cases.row import check


@pytest.mark.long
def test_rows() -> None:
    check(local_mechanisms.rows())
