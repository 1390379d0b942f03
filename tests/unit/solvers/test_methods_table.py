"""What methods can treat is a table; what they cannot is refused in a sentence; methods of one's own join it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.solution import ProgressCallback, Solution, Status, failed
from concio.solvers.methods import LAWS, METHODS, find, laws_of, names_for, register
from space_problems import wall

SPACE = [name for name, method in METHODS.items() if 3 in method.dimensions]
PLANE_ONLY = [name for name, method in METHODS.items() if 3 not in method.dimensions]


def silent(
    problem: ContactProblem, *, progress: ProgressCallback | None = None, patience: int = 1
) -> Solution:
    """Give up at once."""
    return failed(problem, Status.GAVE_UP, method="silent", iterations=patience)


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    before = dict(METHODS)
    yield
    METHODS.clear()
    METHODS.update(before)


def test_there_are_methods_of_both_kinds() -> None:
    assert {"auto", "interior-point", "alart-curnier", "de-saxce"} <= set(SPACE)
    assert {"lemke", "exhaustive", "lagrange"} <= set(PLANE_ONLY)


@pytest.mark.parametrize("name", PLANE_ONLY)
def test_methods_of_the_plane_refuse_space_in_one_sentence(name: str) -> None:
    problem = wall(2, 1, kn=1e3).problem
    with pytest.raises(MethodError, match=rf"method '{name}' does not treat problems in space .*auto, interior-point"):
        find(name)(problem)


@cache
def on_a_wall(name: str) -> Solution:
    """Return what a method says of a small wall in space."""
    options = {"limit": 300} if name == "gauss-seidel" else {}  # it needs far more than others would wait for
    return find(name)(wall(2, 2, kn=10.0, mesh=(2, 1, 1)).at(0.2), **options)


@pytest.mark.parametrize("name", SPACE)
def test_methods_of_space_are_certified_there_or_say_that_they_stopped(name: str) -> None:
    found, reference = on_a_wall(name), on_a_wall("auto")
    assert found.solved or found.status is Status.GAVE_UP
    assert reference.solved
    if found.solved:
        assert np.abs(found.normal_force - reference.normal_force).max() < 1e-6


def test_most_methods_of_space_solve_a_small_wall() -> None:
    for name in ("auto", "interior-point", "alart-curnier", "simo-laursen", "de-saxce", "admm"):
        assert on_a_wall(name).solved


def test_a_method_of_ones_own() -> None:
    register("silent", silent, dimensions=(2, 3), laws=("friction", "stiffness"))
    assert find("silent").options == ("patience",)
    problem = wall(2, 1, kn=1e3).problem
    assert find("silent")(problem, patience=3).iterations == 3
    assert "silent" in names_for(problem)
    model = concio.column(width=0.5, height=1.0, blocks=2, block="rigid")
    assert concio.solve(model, "silent", on_failure="return").status is Status.GAVE_UP
    with pytest.raises(concio.InputError, match="did you mean 'patience'"):
        concio.solve(model, "silent", patince=2)


def test_a_method_may_be_another_function_in_space_and_wait_to_be_imported() -> None:
    register("two", {2: silent, 3: "concio.solvers.auto.chain"}, dimensions=(2, 3), laws=LAWS)
    assert find("two").options == ("patience", "engine")
    problem = wall(2, 1, kn=1e3).problem
    assert find("two")(problem).solved
    with pytest.raises(MethodError, match="no option 'patience' for problems in space"):
        find("two")(problem, patience=3)
    register("later", "no.such.module", load=False)
    with pytest.raises(MethodError, match="cannot be imported"):
        find("later").solver(2)


def test_what_it_does_not_treat_never_reaches_it() -> None:
    register("silent", silent, dimensions=(2,))
    problem = wall(2, 1, kn=1e3).problem
    with pytest.raises(MethodError, match="does not treat problems in space"):
        find("silent")(problem)
    with pytest.raises(MethodError, match="method 'silent' does not treat stiffness"):
        concio.solve(concio.column(width=0.5, height=1.0, blocks=2, block="rigid"), "silent")
    assert laws_of(problem) == ("friction", "stiffness")


LAWED = {
    "friction": {"friction": 0.5},
    "cohesion": {"cohesion": 0.3},
    "tension": {"tension": 0.2},
    "dilatancy": {"friction": 0.5, "dilatancy": 0.2},
    "cap": {"cap": 0.9},
    "stiffness": {"normal_compliance": 0.1, "tangential_compliance": 0.2},
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", [name for name, method in METHODS.items() if 2 in method.dimensions])
def test_the_table_says_which_joint_laws_a_method_refuses(name: str, law: str) -> None:
    """Asked without the table, a method refuses exactly those problems that the table would not have let through."""
    none, some = np.zeros(2), {key: np.full(2, value) for key, value in LAWED[law].items()}
    problem = ContactProblem(
        K=sp.csr_array(np.diag([2.0, 1.0, 3.0, 1.5])), f=np.array([-1.0, 0.1, -2.0, 0.4]),
        C_n=sp.csr_array(np.eye(4)[[0, 2]]), C_t=sp.csr_array(np.eye(4)[[1, 3]]), gap=none,
        laws=replace(Laws.coulomb(none), **some), R=sp.csc_array((4, 0)), bodies=np.array([0, 2, 4]),
    )  # fmt: skip
    method = METHODS[name]
    assert law in laws_of(problem)
    if method.laws.issuperset(laws_of(problem)):
        assert method(problem).status in (Status.SOLVED, Status.GAVE_UP)
    else:
        for solve in (method, method.solver(2)):
            with pytest.raises(MethodError):
                solve(problem)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: register("auto", silent), "there is a method 'auto' already"),
        (lambda: register("mine", silent, laws=("frction",)), "did you mean 'friction'"),
        (lambda: register("mine", silent, dimensions=(4,)), "dimension 2, 3 or both"),
        (lambda: register("mine", "no.such.module"), "cannot be imported"),
        (lambda: register("mine", "concio.errors"), "has no function 'solve'"),
        (lambda: register("mine", lambda problem: problem), "does not take progress"),
    ],
)
def test_calls_that_cannot_be_meant(call: object, said: str) -> None:
    with pytest.raises(MethodError, match=said):
        call()  # type: ignore[operator]


def test_a_method_of_ones_own_that_returns_no_solution_is_refused_with_what_to_return() -> None:
    wall = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", friction=0.6)
    register("returns nothing", lambda problem, *, progress=None: None, laws=["friction", "stiffness"])
    try:
        with pytest.raises(concio.MethodError, match="returned NoneType instead of a Solution"):
            concio.solve(wall, method="returns nothing")
    finally:
        del METHODS["returns nothing"]
