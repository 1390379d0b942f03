"""Ties of a result: their tension, how far they are stretched, and which would have broken."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from concio.contact.assembly import Assembly
from concio.problem.contact_problem import ContactProblem
from concio.problem.tolerances import BROKEN_TIE, SLACK_TIE
from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class TieForces:
    """Ties of one state of a model, k in all, in its order.

    Parameters
    ----------
    names : tuple of str
    bodies : tuple of (str, str)
        Blocks at both ends; "" is a fixed point.
    tension : (k,) array
        [kN].
    elongation : (k,) array
        Since the tie was fastened, without what its prestress stretched it before [m].
    state : tuple of str
        "slack", "taut" or "yields".
    pull : (k, d) array
        Force on the first block; on the second, or on the fixed point, it is the opposite [kN].
    """

    names: tuple[str, ...]
    bodies: tuple[tuple[str, str], ...]
    tension: Array
    elongation: Array
    state: tuple[str, ...]
    pull: Array

    def __len__(self) -> int:
        return len(self.names)

    def as_list(self) -> list[dict[str, float | str]]:
        """Return name, tension [kN], elongation [m] and state of each tie as plain types."""
        rows = zip(self.names, self.tension.tolist(), self.elongation.tolist(), self.state, strict=True)
        return [{"name": name, "tension": t, "elongation": e, "state": state} for name, t, e, state in rows]


def tie_forces(assembly: Assembly, q: Array, normal_force: Array, factors: Mapping[str, float] | None) -> TieForces:
    """Return the ties of a state.

    Parameters
    ----------
    assembly : Assembly
    q : (N,) array
        Free unknowns [m].
    normal_force : (m,) array
        Of all pairs; that of a tie is its tension [kN].
    factors : mapping of str to float, optional
    """
    ties, own = assembly.model.ties, assembly.ties
    dust = SLACK_TIE * float(np.abs(normal_force).max(initial=0.0))
    tension = np.where(np.abs(normal_force[own]) <= dust, 0.0, normal_force[own])
    state = tuple(_state(t.strength, float(force)) for t, force in zip(ties, tension, strict=True))
    pull = -tension[:, None] * assembly.pairs.normal[own]  # the force of the pair on its second body is along n
    names, bodies = tuple(t.name for t in ties), tuple((t.body_a, t.body_b) for t in ties)
    return TieForces(names, bodies, tension, assembly.elongations(q, factors), state, pull)


def _state(strength: float, force: float) -> str:
    if force == 0.0:
        return "slack"
    return "yields" if force >= strength * (1 - SLACK_TIE) else "taut"


def broken_ties(assembly: Assembly, elongation: Array) -> tuple[tuple[str, float], ...]:
    """Return the ties that are stretched to where they break, with how far [m], the one that is farthest first.

    Parameters
    ----------
    assembly : Assembly
    elongation : (k,) array
        Of each tie of the model [m].
    """
    limit = break_elongations(assembly)
    share = elongation / limit
    order = np.argsort(-share, kind="stable")
    ties = assembly.model.ties
    return tuple((ties[int(k)].name, float(elongation[k])) for k in order if share[k] >= 1 - BROKEN_TIE)


def without_breakable(assembly: Assembly, problem: ContactProblem) -> ContactProblem | None:
    """Return a problem of an assembly without the ties that can break; None where none can.

    Parameters
    ----------
    assembly : Assembly
    problem : ContactProblem
    """
    can = np.isfinite(break_elongations(assembly))
    if not can.any():
        return None
    keep = np.ones(problem.pairs, dtype=bool)
    keep[assembly.ties[can]] = False
    rows = np.repeat(keep, problem.dim - 1)
    return replace(
        problem, C_n=problem.C_n[keep], C_t=problem.C_t[rows], gap=problem.gap[keep], laws=problem.laws[keep],
        slip_origin=problem.slip_origin[keep], area=problem.area[keep],
    )  # fmt: skip


def break_elongations(assembly: Assembly) -> Array:
    """Return the elongation (k,) at which each tie of the model breaks, ``inf`` where it never does [m]."""
    return np.array([np.inf if t.break_elongation is None else t.break_elongation for t in assembly.model.ties])
