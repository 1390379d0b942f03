"""Products of sparse matrices with vectors are those of SciPy's operator, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from concio.problem.products import largest_of_columns, product, product_of_sizes, transposed_product

SHAPES = [(1, 1), (7, 4), (4, 7), (60, 31), (5, 0), (0, 5)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("made", [sp.csr_array, sp.csc_array])
def test_products_are_those_of_the_operator(made, shape):
    draw = np.random.default_rng(3)
    A = made(sp.random_array(shape, density=0.3, rng=draw) - 0.5 * sp.random_array(shape, density=0.3, rng=draw))
    x, y = draw.normal(size=shape[1]), draw.normal(size=shape[0])
    assert np.array_equal(product(A, x), A @ x)
    assert np.array_equal(transposed_product(A, y), A.T @ y)
    assert np.array_equal(product_of_sizes(A, x), abs(A) @ x)
    assert np.array_equal(largest_of_columns(A), np.abs(A.toarray()).max(axis=0, initial=0.0))


def test_whole_numbers_and_strided_vectors_are_taken():
    A = sp.csr_array(np.array([[1, 0, 2], [0, 3, 0]]))
    x = np.arange(6)[::2]
    assert product(A, x).tolist() == [8.0, 6.0]
    assert transposed_product(A, np.array([1, 1])).tolist() == [1.0, 3.0, 2.0]


def test_a_vector_of_another_length_is_refused():
    A = sp.csr_array(np.eye(3))
    with pytest.raises(ValueError, match="3 entries"):
        product(A, np.ones(2))
    with pytest.raises(ValueError, match="3 entries"):
        transposed_product(A, np.ones((3, 1)))
