"""Free-standing blocks and triliths that rock, against Housner's closed forms."""

from __future__ import annotations

import pytest
from validation_cases import rocking_block
from validation_cases.row import check


@pytest.mark.long
def test_rows():
    check(rocking_block.rows())
