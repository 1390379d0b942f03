"""Exact certificates: made from an assembly, checked by the program that readers run, written as JSON."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from concio.contact.assembly import Assembly
from concio.contact.factors import load_factor
from concio.errors import InputError, SolverError
from concio.proof.statement import Numbers, fraction_text, statement
from concio.proof.verify import check
from concio.proof.witness import Witness, forces_below, witness

FORMAT = "concio exact certificate 1"

ASIDE = tuple(Fraction(1, 10**k) for k in (9, 8, 7, 6, 5))
"""Shares by which a bound may stay aside of the multiplier where a corner of the programme has several bases."""


def prove_limit(
    assembly: Assembly, groups: Sequence[str] = ("live",), *, factors: Mapping[str, float] | None = None,
    numbers: Numbers = "binary", directions: tuple[np.ndarray, np.ndarray] | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Return the exact certificate of the associated limit multiplier, from both sides where both are found.

    Parameters
    ----------
    assembly : Assembly
    groups : sequence of str
        Load groups that are multiplied; the others are constant.
    factors : mapping of str to float, optional
    numbers : {"binary", "decimal"}
        See :func:`concio.proof.statement.statement`.
    directions : ((m, 3), (m, 3)) arrays, optional
        In space: directions of friction forces and of slips, near which the round cones are cut finely.

    Returns
    -------
    dict
        What is written as JSON; :func:`concio.proof.verify.check` has accepted it.

    Raises
    ------
    InputError
        The model has something that is not proved exactly yet, or a group does not exist.
    SolverError
        No exact forces and no exact motion were found.
    """
    missing = [g for g in groups if g not in assembly.groups]
    if missing:
        msg = f"there is no load group '{missing[0]}' to multiply"
        raise InputError(msg, hint=f"groups are {', '.join(assembly.groups)}")
    data = statement(assembly, numbers)
    constant = {g: _factor(factors, g, numbers) for g in assembly.groups if g not in groups}
    multiplied = {g: _factor(factors, g, numbers) for g in groups}
    force_ways, slip_ways = directions if directions is not None else (None, None)
    made: dict[str, Any] = {
        "format": FORMAT, "claim": "limit", **data, "constant": _texts(constant), "multiplied": _texts(multiplied),
    }  # fmt: skip
    inside = witness(data, constant, multiplied, side="inside", directions=force_ways)
    tried = [_lower(inside)] + ([_upper(inside)] if assembly.model.dim == 2 else [])
    parts = [part for part in tried if part]
    if not _holds({**made, **{key: value for part in parts for key, value in part.items()}}):
        parts = [part for part in parts if _holds({**made, **part})]
    if inside is not None and not any("lower" in part for part in parts):
        size = max(abs(inside.multiplier), Fraction(1))
        lower = (
            _lower(forces_below(data, constant, multiplied, _short(inside.multiplier - share * size), force_ways))
            for share in ASIDE
        )
        parts += _first(made, lower)
    if not any("upper" in part for part in parts):
        upper = (
            _upper(witness(data, constant, multiplied, side="outside", directions=slip_ways, wider=share))
            for share in (Fraction(0), *ASIDE)
        )
        parts += _first(made, upper)
    if not parts:
        msg = "no exact forces and no exact motion were found for the multiplier"
        hint = "the loads may be carried in any multiple, or in none; use 'concio limit'"
        raise SolverError(msg, hint=hint)
    for part in parts:
        made.update(part)
    return sealed(made)


def prove_collapse(
    assembly: Assembly, factors: Mapping[str, float] | None = None, *, numbers: Numbers = "binary",
    directions: np.ndarray | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Return the exact certificate that no joint forces within friction balance the loads.

    Parameters
    ----------
    assembly : Assembly
    factors : mapping of str to float, optional
        Of the load groups.
    numbers, directions
        As in :func:`prove_limit`; directions of slips alone.

    Raises
    ------
    InputError, SolverError
        As :func:`prove_limit`; a structure that is balanced within friction has no such certificate.
    """
    data = statement(assembly, numbers)
    acting = factors_of(assembly, factors, numbers)
    made = {"format": FORMAT, "claim": "collapse", **data, "constant": _texts(acting)}
    for share in (Fraction(0), *ASIDE):
        found = _upper(witness(data, {}, acting, side="outside", directions=directions, wider=share))
        if found is not None and _holds({**made, "motion": found["motion"]}):
            return sealed({**made, "motion": found["motion"]})
    msg = "no exact motion was found on which the loads do work against no resistance"
    raise SolverError(msg, hint="forces in balance within friction may exist; use 'concio run' and 'concio limit'")


def prove_balance(
    assembly: Assembly, factors: Mapping[str, float] | None = None, *, numbers: Numbers = "binary",
    directions: np.ndarray | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Return the exact certificate of joint forces within their strength that balance the loads.

    They are necessary for equilibrium and not sufficient: self-stress also balances a block that nothing
    squeezes between two walls.

    Parameters
    ----------
    assembly : Assembly
    factors : mapping of str to float, optional
        Of the load groups.
    numbers, directions
        As in :func:`prove_limit`; directions of friction forces alone.

    Raises
    ------
    InputError, SolverError
        As :func:`prove_limit`.
    """
    data = statement(assembly, numbers)
    acting = factors_of(assembly, factors, numbers)
    made = {"format": FORMAT, "claim": "balance", **data, "constant": _texts(acting)}
    found = _lower(forces_below(data, acting, {}, Fraction(0), directions))
    if found is not None and _holds({**made, "forces": found["forces"]}):
        return sealed({**made, "forces": found["forces"]})
    msg = "no exact forces within friction were found that balance the loads"
    raise SolverError(msg, hint="there may be none, or they are on the edge of a round cone; 'concio run' tells")


def factors_of(
    assembly: Assembly, factors: Mapping[str, float] | None, numbers: Numbers = "binary"
) -> dict[str, Fraction]:
    """Return the factor of every load group as a fraction."""
    return {g: _factor(factors, g, numbers) for g in assembly.groups}


def sealed(made: Mapping[str, Any]) -> dict[str, Any]:
    """Return a certificate with its digest, which shows a change in transit; it proves nothing."""
    return {**made, "digest": digest(made)}


def digest(made: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a certificate without its digest, keys sorted."""
    plain = {key: value for key, value in made.items() if key != "digest"}
    text = json.dumps(plain, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def _first(made: Mapping[str, Any], parts: Iterable[dict[str, Any] | None]) -> list[dict[str, Any]]:
    """Return the first part that the checking program accepts, in a list; none where it accepts none."""
    return next(([part] for part in parts if part and _holds({**made, **part})), [])


def _holds(made: Mapping[str, Any]) -> bool:
    try:
        check(sealed(made))
    except ValueError:
        return False
    return True


def _short(value: Fraction) -> Fraction:
    """Return a fraction with a short denominator, at most 1e-12 less than a value."""
    places = 10**12
    return Fraction(value.numerator * places // value.denominator, places)


def _lower(found: Witness | None) -> dict[str, Any] | None:
    if found is None or found.forces is None:
        return None
    forces = [[fraction_text(x) for x in force] for force in found.forces]
    return {"lower": fraction_text(found.multiplier), "forces": forces}


def _upper(found: Witness | None) -> dict[str, Any] | None:
    if found is None or found.motion is None:
        return None
    return {"upper": fraction_text(found.multiplier), "motion": _motion_texts(found)}


def _motion_texts(found: Witness) -> list[list[list[str]]]:
    assert found.motion is not None
    return [[[fraction_text(x) for x in v], [fraction_text(x) for x in turn]] for v, turn in found.motion]


def _factor(factors: Mapping[str, float] | None, group: str, numbers: Numbers) -> Fraction:
    value = load_factor(factors, group)
    return Fraction(value) if numbers == "binary" else Fraction(f"{value:.12g}")


def _texts(factors: Mapping[str, Fraction]) -> dict[str, str]:
    return {group: fraction_text(value) for group, value in factors.items()}
