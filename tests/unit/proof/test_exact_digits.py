"""Every digit of every kind of certificate, changed in turn: refused, and no false claim passes with a new digest."""

from __future__ import annotations

import json
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from typing import Any

import pytest

import concio
from concio import Body, Elastic, JointLaw, Load, Model, Polyhedron, Rigid
from concio.proof import equilibrium
from concio.proof.exact_certificate import prove_balance, prove_collapse, sealed
from concio.proof.programs import recompute
from samples import first

REFUSED = (ValueError, KeyError, IndexError, TypeError, ArithmeticError)
KINDS = ("limit", "collapse", "balance", "equilibrium in fractions", "equilibrium enclosed", "limit in space")


def model(kind: str = "rigid", mu: float = 0.6, stiffness: float | None = None) -> Model:
    ground = Body("ground", [(-1, -1), (2, -1), (2, 0), (-1, 0)], kind="fixed")
    block = Body("a", [(0, 0), (1, 0), (1, 1), (0, 1)], kind=kind, material="stone")
    law = {"joint": JointLaw(mu, normal_stiffness=stiffness, tangential_stiffness=stiffness)}
    stone: Any = Rigid(20.0) if kind == "rigid" else Elastic(E=1e5, nu=0.2, unit_weight=20.0)
    loads = (Load("weight", (0, -1)), Load("weight", (1, 0), group="live"))
    return Model((ground, block), {"stone": stone}, law, loads=loads, mesh_size=1.0)


def box() -> Model:
    ground = Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
    block = Polyhedron.box("a", (0, 0, 0), (1, 1, 1), kind="rigid")
    loads = (Load("weight", (0, 0, -1)), Load("weight", (0.6, 0.8, 0), group="live"))
    return Model((ground, block), {"block": Rigid(20.0)}, {"joint": JointLaw(0.4)}, loads=loads)


@cache
def certificate(kind: str) -> dict[str, Any]:
    if kind.startswith("limit"):
        found = concio.limit(box() if "space" in kind else model(), path=False, steps=False, search=False)
        return found.proof()
    if kind == "collapse":
        return prove_collapse(concio.assemble(model(mu=0.2)))
    if kind == "balance":
        return prove_balance(concio.assemble(model()), {"live": 0.3})
    stands = model() if "fractions" in kind else model("elastic", stiffness=1e5)
    made = concio.solve(stands, factors={"live": 0.3}).proof()
    if "enclosed" in kind and "solution" in made:  # small ones are given in fractions: ask for intervals
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(equilibrium, "ALWAYS_EXACT", 0)
            made = concio.solve(stands, factors={"live": 0.3}).proof()
        assert "bits" in made
    return made


def digits(text: str) -> Iterator[str]:
    """Yield a text with each of its digits changed in turn, hexadecimal ones too where they are digits."""
    for k, letter in enumerate(text):
        if letter.isdigit():
            yield text[:k] + str((int(letter) + 1) % 10) + text[k + 1 :]


@pytest.mark.parametrize("kind", first(5, KINDS))
def test_every_digit_changed_in_the_file_is_refused(kind: str) -> None:
    made = certificate(kind)
    assert "proved" in recompute(made)
    count = 0
    for text in digits(json.dumps(made)):
        count += 1
        try:
            other = json.loads(text)
        except ValueError:  # no JSON any more: a number that begins with 0
            continue
        with pytest.raises(REFUSED):
            recompute(other)
    assert count > 500


@pytest.mark.parametrize(
    ("kind", "names"),
    [("limit", ("forces", "lower")), ("balance", ("forces",)), ("equilibrium in fractions", ("solution",))],
)
def test_what_must_be_equal_is_refused_with_a_new_digest_too(kind: str, names: tuple[str, ...]) -> None:
    made = certificate(kind)
    count = 0
    for name in names:
        for text in digits(json.dumps(made[name])):
            try:
                changed = sealed({**made, name: json.loads(text)})
            except ValueError:
                continue
            count += 1
            with pytest.raises(REFUSED):
                recompute(changed)
    assert count > 20


@pytest.mark.parametrize("name", ["motion", "upper"])
def test_a_changed_motion_or_bound_passes_only_where_it_is_true(name: str) -> None:
    """With a new digest: a bound above the multiplier is true, and no motion that passes puts one below it."""
    made = certificate("limit")
    tried = passed = 0
    for text in digits(json.dumps(made[name])):
        tried += 1
        try:
            other = sealed({**made, name: json.loads(text)})
            recompute(other)
        except REFUSED:
            continue
        passed += 1
        assert Fraction(other["upper"]) >= Fraction(made["lower"])
    assert passed < tried
