"""Answers that follow from matrices alone: the same objects have the same answer, other objects their own."""

from __future__ import annotations

import weakref
from dataclasses import replace

import numpy as np

import concio
from concio.problem.once import KEPT, once
from concio.problem.parts import connected_parts


def test_the_same_objects_are_answered_once_and_equal_ones_again() -> None:
    calls = []
    total = once(lambda a, b: calls.append(1) or float(a @ b))
    a, b = np.ones(3), np.arange(3.0)
    assert [total(a, b), total(a, b), total(a, b.copy()), total(b, a)] == [3.0] * 4
    assert len(calls) == 3


def test_answers_of_arrays_that_are_gone_are_not_given_to_others() -> None:
    size = once(lambda a: len(a))
    for k in range(3 * KEPT):
        array = np.zeros(k)
        assert size(array) == k
        gone = weakref.ref(array)
        del array  # the last reference: what keeps the array in a cycle, or at all, is seen at once
        assert gone() is None


def test_answers_of_arrays_that_are_gone_are_not_kept() -> None:
    once_made = once(lambda a: np.ones_like(a))
    array = np.zeros(3)
    answer = weakref.ref(once_made(array))
    assert answer() is not None
    del array
    assert answer() is None


def test_problems_that_share_their_matrices_share_their_parts() -> None:
    assembly = concio.assemble(concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), friction=0.6))
    problem = assembly.problem()
    other = assembly.problem({"dead": 2.0})
    assert connected_parts(problem) is connected_parts(other)
    apart = replace(problem, C_t=problem.C_t.copy())
    assert connected_parts(apart) is not connected_parts(problem)
    np.testing.assert_array_equal(connected_parts(apart).of_pair, connected_parts(problem).of_pair)
