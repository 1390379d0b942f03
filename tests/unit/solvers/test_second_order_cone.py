"""The algebra of second-order cones, against matrices: an element a has eigenvalues a_0 - |a_t| and a_0 + |a_t|."""

from __future__ import annotations

import numpy as np
import pytest

from concio.solvers.algebra.second_order_cone import clipped, determinant


def drawn(seed: int) -> np.ndarray:
    """Return elements (40, d), inside, outside and on the axis of the cone."""
    rng = np.random.default_rng([53, seed])
    a = rng.normal(size=(40, 2 + seed % 2))
    a[:5, 1:] = 0.0
    return a


def arrow(a: np.ndarray) -> np.ndarray:
    """Return the symmetric matrix that has the two eigenvalues of an element."""
    r = float(np.linalg.norm(a[1:]))
    return np.array([[a[0], r], [r, a[0]]])


@pytest.mark.parametrize("seed", range(4))
def test_the_determinant_is_that_of_the_matrix(seed: int) -> None:
    a = drawn(seed)
    assert determinant(a) == pytest.approx([np.linalg.det(arrow(row)) for row in a], abs=1e-14)


@pytest.mark.parametrize("seed", range(4))
def test_clipped_elements_keep_their_direction_and_have_eigenvalues_between_the_bounds(seed: int) -> None:
    a = drawn(seed)
    least, most = -0.3, 0.8
    for before, after in zip(a, clipped(a, least, most), strict=True):
        wanted = np.clip(np.linalg.eigvalsh(arrow(before)), least, most)
        assert np.linalg.eigvalsh(arrow(after)) == pytest.approx(wanted, abs=1e-14)
        r, s = np.linalg.norm(before[1:]), np.linalg.norm(after[1:])
        assert s * before[1:] == pytest.approx(r * after[1:], abs=1e-14)
