"""Exact certificates that something or nothing balances the loads, sought near what floating point finds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np

from concio.analysis.lent_compliance import lend
from concio.contact.assembly import Assembly, assemble
from concio.errors import InputError, SolverError
from concio.fem.discretisation import RIGID
from concio.problem.solution import Solution, Status, pair_states
from concio.proof.deformable import refuse
from concio.proof.equilibrium import prove_equilibrium
from concio.proof.exact_certificate import prove_balance, prove_collapse
from concio.proof.programs import recompute
from concio.solvers.methods import find
from concio.solvers.statics.existence import find_mechanism, statically_admissible
from concio.verdict.attention import joints_not_made

Array = np.ndarray

MOST_BLOCKS, MOST_UNKNOWNS = 100, 300
"""Blocks and unknowns up to which reports and notebooks seek an exact certificate by default."""


def collapse_proof(
    assembly: Assembly,
    factors: Mapping[str, float] | None = None,
    *,
    numbers: Literal["binary", "decimal"] = "binary",
) -> dict[str, Any]:
    """Return the exact certificate that no joint forces within friction balance the loads.

    In space round cones are cut by planes, finely near the slips of the mechanism that excludes equilibrium: a motion
    that works against the round cones may work against none of coarse cuts.

    Parameters
    ----------
    assembly : Assembly
    factors : mapping of str to float, optional
        Of the load groups.
    numbers : {"binary", "decimal"}
        Numbers of the model as the computer holds them, or rounded to twelve decimal digits.

    Raises
    ------
    InputError, SolverError
        As :func:`concio.proof.exact_certificate.prove_collapse`; or a joint was almost made, and with it the loads
        may be balanced.
    """
    almost = joints_not_made(assembly.detection)
    if almost:
        raise InputError(almost[0], hint="with it the loads may be balanced: close it, or raise gap_tolerance")
    directions = None
    if assembly.model.dim == 3:
        found = find_mechanism(assembly.problem(factors))
        directions = None if found is None else against_slips(assembly, found.velocity)
    return prove_collapse(assembly, factors, numbers=numbers, directions=directions)


def balance_proof(
    assembly: Assembly,
    factors: Mapping[str, float] | None = None,
    *,
    numbers: Literal["binary", "decimal"] = "binary",
) -> dict[str, Any]:
    """Return the exact certificate of joint forces within their strength that balance the loads.

    Parameters
    ----------
    assembly, factors, numbers
        As in :func:`collapse_proof`.

    Raises
    ------
    InputError, SolverError
        As :func:`concio.proof.exact_certificate.prove_balance`.
    """
    directions = None
    if assembly.model.dim == 3:
        found = statically_admissible(assembly.problem(factors))
        tangential = found.friction_force.reshape(len(assembly.pairs), -1)
        directions = np.einsum("ki,kij->kj", tangential, assembly.pairs.tangents)
    return prove_balance(assembly, factors, numbers=numbers, directions=directions)


def step_proof(
    assembly: Assembly,
    factors: Mapping[str, float] | None,
    solution: Solution,
    *,
    numbers: Literal["binary", "decimal"] = "binary",
) -> dict[str, Any]:
    """Return the exact certificate of the outcome of a load step, see :meth:`concio.Result.proof`.

    Parameters
    ----------
    assembly, factors, numbers
        As in :func:`collapse_proof`.
    solution : Solution
        What the solver found.
    """
    if solution.status is Status.NO_EQUILIBRIUM:
        return collapse_proof(assembly, factors, numbers=numbers)
    if not solution.solved:
        msg = f"the outcome '{solution.status.name.lower()}' has no exact certificate"
        raise SolverError(msg, hint="an equilibrium has one, and loads that no forces balance")
    if assembly.model.dim == 3 and bool((assembly.disc.shape_of <= RIGID).all()) and not assembly.model.ties:
        return balance_proof(assembly, factors, numbers=numbers)
    refuse(assembly)
    lent = lend(assemble(assembly.model) if assembly.lent_compliance else assembly)
    problem = lent.problem(factors)
    inside = find("interior-point")(problem, least=False)  # the least forces lie on the edge of what is allowed
    if inside.solved or lent.lent_compliance:  # what the result holds is the limit of stiff joints
        solution = inside if inside.solved else find("auto")(problem)
    states = pair_states(problem, solution)
    forces = np.column_stack([solution.normal_force, solution.friction_force])
    return prove_equilibrium(lent, factors, states, forces, numbers=numbers)


def sentence_proved(assembly: Assembly, make: Callable[[], dict[str, Any]]) -> str:
    """Return what a certificate proves in a sentence; empty where there is none, or where it would cost much.

    Parameters
    ----------
    assembly : Assembly
    make : callable
        Makes the certificate, or raises.
    """
    if len(assembly.model.free_bodies) > MOST_BLOCKS or assembly.disc.unknowns > MOST_UNKNOWNS:
        return ""
    try:
        return recompute(make())
    except (InputError, SolverError):
        return ""


def against_slips(assembly: Assembly, velocity: Array) -> Array:
    """Return the direction (m, d) of what would oppose the slip of each pair in a motion (N,)."""
    pairs = assembly.pairs
    slip = np.asarray(pairs.C_t @ (assembly.supported.T @ velocity)).reshape(len(pairs), -1)
    against: Array = -np.einsum("ki,kij->kj", slip, pairs.tangents)
    return against
