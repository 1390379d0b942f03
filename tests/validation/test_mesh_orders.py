"""Orders of convergence of displacement, contact pressure and settlement."""

from __future__ import annotations

import pytest
from validation_cases import mesh_orders
from validation_cases.row import check


@pytest.mark.long
def test_rows():
    check(mesh_orders.rows())
