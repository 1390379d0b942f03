"""Dense kernels are serial while concio solves, unless the environment names a number of threads."""

from __future__ import annotations

import threading

import pytest
from threadpoolctl import ThreadpoolController

import concio
from concio.problem.solution import Progress
from concio.solvers.algebra.threads import VARIABLES, one_thread

BLAS = ThreadpoolController().select(internal_api="openblas")
needs_blas = pytest.mark.skipif(not BLAS.lib_controllers, reason="NumPy and SciPy were built with another library")


def threads() -> set[int]:
    return {library.get_num_threads() for library in BLAS.lib_controllers}


@pytest.fixture
def chosen_by_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


@needs_blas
def test_a_solve_works_with_one_thread_and_gives_them_back(chosen_by_nobody: None) -> None:
    seen: list[set[int]] = []

    def look(progress: Progress) -> None:
        seen.append(threads())

    with BLAS.limit(limits=2):
        concio.solve(
            concio.wall(length=1.0, height=0.5, block_size=(0.5, 0.25), unit_weight=20, friction=0.6), progress=look
        )
        assert threads() == {2}
    assert seen
    assert set().union(*seen) == {1}


@needs_blas
def test_contexts_within_each_other_and_other_threads_leave_the_number_as_it_was(chosen_by_nobody: None) -> None:
    def inside() -> None:
        with one_thread():
            seen.append(threads())

    seen: list[set[int]] = []
    with BLAS.limit(limits=2):
        with one_thread():
            inside()
            assert threads() == {1}
        assert threads() == {2}
        other = threading.Thread(target=inside)
        other.start()
        other.join()
        assert threads() == {2}
    assert seen == [{1}, {2}]


@needs_blas
def test_who_names_a_number_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    with BLAS.limit(limits=2), one_thread():
        assert threads() == {2}
