"""Exceptions say what, where and what to do, and carry the exit code of the command line."""

from __future__ import annotations

import inspect

import pytest

import concio
from concio import errors
from concio.problem.solution import Status

ALL = [c for _, c in inspect.getmembers(errors, inspect.isclass) if issubclass(c, Exception)]


@pytest.mark.parametrize("kind", ALL)
def test_what_where_and_hint(kind: type[errors.ConcioError]) -> None:
    error = kind("E = -1 must be positive", where="panel.toml", hint="give E in kN/m2")
    assert str(error) == "panel.toml: E = -1 must be positive (give E in kN/m2)"
    assert (error.what, error.where, error.hint) == ("E = -1 must be positive", "panel.toml", "give E in kN/m2")
    assert str(kind("short")) == "short"
    assert isinstance(error, concio.ConcioError)


def test_exit_codes() -> None:
    codes = {c.__name__: c.exit_code for c in ALL}
    assert codes == {
        "ConcioError": 1, "InputError": 2, "ArgumentError": 2, "GeometryError": 2, "MethodError": 2,
        "NoEquilibriumError": 3, "SolverError": 4,
    }  # fmt: skip
    assert {s.name: s.exit_code for s in Status} == {
        "SOLVED": 0, "NO_EQUILIBRIUM": 3, "COLLAPSES": 3, "NO_COULOMB_STATE": 3,
        "UNDECIDED": 4, "GAVE_UP": 4, "CANCELLED": 4,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"block": {"E": -1.0}}, "E = -1 must be positive"),
        ({"block": {"E": 0.0}}, "E = 0 must be positive"),
        ({"block": {"E": float("nan")}}, "NaN"),
        ({"block": {"E": float("inf")}}, "finite"),
        ({"block": {"E": "5 m"}}, "'5 m' is not a stress"),
        ({"block": {"E": 1.0, "nu": 0.5}}, "nu = 0.5 must lie between -1 and 0.5"),
        ({"friction": -0.1}, "friction = -0.1 must be zero or positive"),
        ({"courses": 0}, "courses = 0"),
        ({"blocks": 2.5}, "blocks"),
        ({"block_size": (0.2,)}, "block_size"),
        ({"joint": -0.01}, "joint = -0.01 must be zero or positive"),
        ({"joint": 0.3}, "not thinner than a block"),
        ({"base": "half"}, "base 'half' is not one of"),
        ({"base": "none", "side_walls": False}, "nothing holds the panel"),
        ({"top_pressure": float("nan")}, "NaN"),
    ],
)
def test_bad_arguments_of_the_panel(options: dict[str, object], said: str) -> None:
    block = options.pop("block", None)
    with pytest.raises(concio.InputError) as caught:
        concio.running_bond_panel(**({"block": concio.Elastic(**block)} if isinstance(block, dict) else {}), **options)  # type: ignore[arg-type]
    assert said in str(caught.value)


def test_failures_raise_unless_they_are_asked_for() -> None:
    falling = concio.running_bond_panel(side_walls=False, friction=0.5, unit_weight=20, horizontal=1.0)
    with pytest.raises(concio.NoEquilibriumError):
        concio.solve(falling)
    assert concio.solve(falling, on_failure="return").status is Status.NO_EQUILIBRIUM
    with pytest.raises(concio.MethodError, match="unknown method 'magic'"):
        concio.solve(falling, method="magic")
    with pytest.raises(concio.InputError, match="there is no load group 'snow'"):
        concio.solve(falling, factors={"snow": 1.0})
