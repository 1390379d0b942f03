"""Equilibrium certificates: the joint states of an answer, and what shows that an exact solution has them.

The checking program :mod:`concio.proof.verify_equilibrium` writes the equations down; here is found what it needs
beside the model's numbers. The states of the joint points are read off the answer; the equations of states are linear.
Hard joints of rigid blocks have the compliance that is added to them: without it any forces in balance would pass.
Their solution is enclosed by elimination in the order of a factor in floating point, with as many bits as it takes.
Where a sign is not strict an enclosure cannot show it, and small models are solved in fractions.

Where three blocks meet, joint points repeat each other: their equations are sums of others. These are found by
elimination in fractions of the rows of hard joint points alone, and their forces are those of the answer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import scipy.sparse.linalg as sla

from concio.contact.assembly import Assembly
from concio.errors import InputError, SolverError
from concio.problem.pair_state import Normal, PairStates
from concio.proof import verify_equilibrium as checker
from concio.proof.deformable import deformable_statement
from concio.proof.exact_certificate import FORMAT, factors_of, sealed
from concio.proof.exact_solve import LongFractionsError, Row, scaled, solve_exactly
from concio.proof.statement import Numbers, fraction_text, statement, text_of

BITS = (384, 768, 1536, 3072)
"""Bits of an enclosure, tried in turn."""
SHARP = 64
"""Bits of a unit to which every number is enclosed at least."""
ALWAYS_EXACT = 120
"""Equations up to which the solution is given in fractions, which are short then."""
LARGEST_EXACT = 1_200
"""Equations up to which a solution is sought in fractions where an enclosure does not decide a sign."""
LARGEST_ENCLOSED = 12_000
"""Equations up to which a solution is enclosed: the checking program runs in Python alone."""


def prove_equilibrium(
    assembly: Assembly, factors: Mapping[str, float] | None, states: PairStates, forces: np.ndarray, *,
    numbers: Numbers = "binary",
) -> dict[str, Any]:  # fmt: skip
    """Return the certificate of a Coulomb equilibrium of a plane model in one step from rest.

    Parameters
    ----------
    assembly : Assembly
        Hard joints of rigid blocks with the compliance added to them (:mod:`concio.analysis.lent_compliance`).
    factors : mapping of str to float, optional
        Of the load groups.
    states : PairStates
        States of the pairs in an answer.
    forces : (m, 2) array
        Normal and friction forces of the answer [kN]; they count where joint points repeat each other.
    numbers : {"binary", "decimal"}

    Raises
    ------
    InputError
        The model has something that such certificates do not state, or is too large.
    SolverError
        The states are not those of an exact solution, or joints are on the edge of two states, which it names.
    """
    data = statement(assembly, numbers, gaps=True)
    constant = {g: fraction_text(x) for g, x in factors_of(assembly, factors, numbers).items()}
    made = {"format": FORMAT, "claim": "equilibrium", **deformable_statement(assembly, data, numbers)}
    made = {**made, "constant": constant}
    if assembly.lent_compliance:
        made["lent"] = text_of(assembly.lent_compliance, numbers)
    made["states"] = _words(assembly, states, len(made["joints"]))
    try:
        rows, right, signs = checker.system(made)
    except ValueError as refused:
        hint = "the certificate of 'concio run' holds for it, in floating point"
        raise SolverError(str(refused), hint=hint) from None
    if len(rows) > LARGEST_ENCLOSED:
        msg = f"the model has {len(rows):,} equations, more than the {LARGEST_ENCLOSED:,} that a proof may have"
        raise InputError(msg, hint="the certificate of 'concio run' holds for it, in floating point")
    n = checker.numbering(made)[2]
    made["left_out"] = _left_out(rows, right, n, forces, made)
    checker.leave_out(made, rows, right)
    made["pivots"] = _pivots(rows, right)
    return _enclosed(made, rows, right, signs)


def _words(assembly: Assembly, states: PairStates, count: int) -> list[list[str]]:
    """Return the states of all joint points in the words of the checking program; what supports hold is closed."""
    normal = {Normal.OPEN: "open", Normal.CLOSED: "closed", Normal.CRUSHED: "crushed"}
    law, found = assembly.laws, []
    for k in range(len(states)):
        name = normal[Normal(int(states.normal[k]))]
        mu, cohesion, tension = (float(getattr(law, x)[k]) for x in ("friction", "cohesion", "tension"))
        strong = cohesion > mu * tension if name == "open" else max(mu, cohesion) > 0
        sign = int(states.sign[k])
        found.append([name, ("+" if sign > 0 else "-" if sign < 0 else "stick") if strong else "free"])
    return found + [["closed", "free"]] * (count - len(found))


def _left_out(
    rows: Sequence[Row], right: Sequence[Fraction], n: int, forces: np.ndarray, made: Mapping[str, Any]
) -> list[list[Any]]:
    """Return equations of hard joint points that are sums of others: number, force, and the others with shares.

    Raises
    ------
    SolverError
        Such an equation contradicts the others: the joint is on the edge.
    """
    reduced: dict[int, tuple[Row, Row]] = {}  # by pivot: row without it, and the equations it is made of
    found: list[list[Any]] = []
    for i in range(n, len(rows)):
        row, parts = {j: v for j, v in rows[i].items() if v}, {i: Fraction(1)}
        if not row or max(row) >= n:
            continue  # it has a compliance, or is about forces
        while row:
            column = max(row)
            if column not in reduced:
                break
            other, made_of = reduced[column]
            share = row.pop(column)
            _take(row, other, share)
            _take(parts, made_of, share)
        if row:
            column = max(row)
            size = row.pop(column)
            reduced[column] = {j: v / size for j, v in row.items()}, {j: v / size for j, v in parts.items()}
            continue
        del parts[i]
        if sum((-v * right[j] for j, v in parts.items()), Fraction(0)) != right[i]:
            msg = f"{_joint(made, (i - n) // 2)} is on the edge: held shut with others to rounding, not exactly"
            raise SolverError(msg, hint="equal meshes on both sides of a joint, or a joint stiffness, avoid it")
        k, side = divmod(i - n, 2)
        value = float(forces[k, side]) if k < len(forces) else 0.0
        found.append([i, value.hex(), [[j, fraction_text(-v)] for j, v in parts.items() if v]])
    return found


def _take(row: Row, other: Mapping[int, Fraction], share: Fraction) -> None:
    """Subtract a share of another row; zeros go."""
    for j, v in other.items():
        value = row.get(j, Fraction(0)) - share * v
        if value:
            row[j] = value
        else:
            row.pop(j, None)


def _pivots(rows: Sequence[Row], right: Sequence[Fraction]) -> list[list[int]]:
    """Return the order of elimination of a factor in floating point: equation and unknown of each pivot."""
    try:
        factor = sla.splu(scaled(rows, right), permc_spec="COLAMD")
    except RuntimeError:
        msg = "the joint states leave blocks free to move: their place is not determined"
        raise SolverError(msg, hint="blocks that nothing presses, or that all joints let slip, have no place") from None
    order = np.empty((2, len(rows)), dtype=int)
    order[0, factor.perm_r], order[1, factor.perm_c] = np.arange(len(rows)), np.arange(len(rows))
    pivots: list[list[int]] = order.T.tolist()
    return pivots


def _enclosed(
    made: dict[str, Any], rows: Sequence[Row], right: Sequence[Fraction], signs: Sequence[checker.Condition]
) -> dict[str, Any]:
    """Return the certificate with as many bits as it takes, or the exact solution; raise with joints on the edge."""
    n = checker.numbering(made)[2]
    small = _in_fractions(made, rows, right) if len(rows) <= ALWAYS_EXACT else None
    if small is not None:
        return small
    for bits in BITS:
        try:
            found = checker.enclosed(list(rows), list(right), made["pivots"], bits)
        except ValueError:
            continue
        x = [(Fraction(m - r, 1 << bits), Fraction(m + r, 1 << bits)) for m, r in found]
        if max(r for _, r in found).bit_length() > bits - SHARP:
            continue
        open_ = [c for c in signs if checker.least(c, x) < 0]
        wrong = [c for c in open_ if -checker.least((c[0], {j: -v for j, v in c[1].items()}, -c[2]), x) < 0]
        if wrong:
            msg = f"{_joint(made, (max(wrong[0][1]) - n) // 2)} is not in the state that was read: it is {wrong[0][0]}"
            raise SolverError(msg, hint="the answer is right to rounding only; there may be another state nearby")
        if not open_:
            return sealed({**made, "bits": bits})
        return _exact(made, rows, right, [_joint(made, (max(c[1]) - n) // 2) for c in open_])
    msg = "the equations of these joint states are not shown to have one solution"
    raise SolverError(msg, hint="blocks that nothing presses, or that all joints let slip, have no place")


def _exact(
    made: dict[str, Any], rows: Sequence[Row], right: Sequence[Fraction], edge: Sequence[str]
) -> dict[str, Any]:
    """Return the certificate with the solution in fractions; raise with the joints on the edge."""
    found = _in_fractions(made, rows, right) if len(rows) <= LARGEST_EXACT else None
    if found is not None:
        return found
    named = list(dict.fromkeys(edge))
    more = f" and {len(named) - 3} more" if len(named) > 3 else ""
    msg = f"on the edge of two states: {'; '.join(named[:3])}{more}"
    raise SolverError(msg, hint="intervals decide no sign that is exactly zero, and the model is large for fractions")


def _in_fractions(made: dict[str, Any], rows: Sequence[Row], right: Sequence[Fraction]) -> dict[str, Any] | None:
    """Return the certificate with the solution in fractions; None where it is not accepted."""
    try:
        x = solve_exactly(rows, right)
    except LongFractionsError:
        x = None
    if x is None:
        return None
    whole = {k: v for k, v in made.items() if k not in ("left_out", "pivots")}
    done = sealed({**whole, "solution": [fraction_text(v) for v in x]})
    try:
        checker.check(done)
    except ValueError:
        return None
    return done


def _joint(made: Mapping[str, Any], k: int) -> str:
    """Return a joint point in words."""
    joint = made["joints"][k]
    a, b = (made["bodies"][joint[side]]["name"] for side in "ab")
    at = ", ".join(f"{float(checker.exact(x)):g}" for x in joint["at"])
    return f"the joint of '{a}' and '{b}' at ({at})"
