"""Fixed bodies that supports move: the equilibrium that follows them from where they were described.

Gaps are those of the floor where it then stands, and what it moved along a joint has slipped unless friction takes the
blocks along: a pillar on a floor that has turned leans, and goes with a floor that is moved aside.
The motion is applied in parts, each followed to equilibrium, at factor times displacement and rotation of each support.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.joints import SAG
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Balanced, Statics
from concio.analysis.motion.structures import Structure
from concio.contact.factors import load_factor
from concio.errors import InputError
from concio.fem.discretisation import FIXED
from concio.problem.contact_problem import Engine
from concio.verdict.dynamics_verdict import supports_short

Array = np.ndarray

PART = 0.02
"""Largest motion of a part over the median width of the bodies."""

GROWTH = 2.0
"""Factor by which parts grow after one was followed."""

SMALLEST = 1e-3
"""Part of the first one below which nothing can be followed."""


@dataclass(frozen=True, eq=False)
class MovedSupports:
    """How fixed bodies are moved before anything else acts.

    Parameters
    ----------
    shift : (B, d) array
        Of their centroids [m].
    turn : (B,) array in the plane, (B, 3) in space
        [rad].
    """

    shift: Array
    turn: Array

    @classmethod
    def of(cls, statics: Statics) -> MovedSupports:
        """Return the motions of the supports of a model at the factors of its loads.

        Raises
        ------
        InputError
            The load that grows moves a support.
        """
        reference = statics.reference
        model, number = reference.model, {b.name: i for i, b in enumerate(reference.model.bodies)}
        shift, turn = np.zeros_like(reference.disc.centroids), reference.at_rest().placement.no_spin
        for support in model.supports:
            b = number[support.body]
            if reference.disc.shape_of[b] != FIXED or not support.moves:
                continue
            if support.group in statics.live:
                msg = f"the load group '{support.group}' that grows moves support '{support.name}'"
                raise InputError(msg, hint="give the support a group of its own, which then acts as it is")
            factor = load_factor(statics.factors, support.group)
            shift[b] += factor * np.asarray(support.displacement, dtype=float)
            turn[b] += factor * np.asarray(support.rotation, dtype=float)
        return cls(shift, turn)

    @property
    def any(self) -> bool:
        """Whether anything is moved."""
        return bool(self.shift.any() or self.turn.any())

    def applied(self, state: MotionState, share: float) -> MotionState:
        """Return a state with fixed bodies moved on by a share."""
        there = state.placement.moved(share * self.shift, share * self.turn)
        return replace(state, centre=there.centre, rotation=there.rotation)

    def largest(self, statics: Statics) -> float:
        """Return how far anything on the moved bodies is moved at most, roughly [m]."""
        centre = statics.reference.disc.centroids
        corners = np.concatenate([b.vertices for i, b in enumerate(statics.reference.model.bodies)
                                  if i in set(statics.reference.free.tolist())])  # fmt: skip
        arm = np.linalg.norm(corners[None] - centre[:, None], axis=2).max(axis=1)
        turn = np.linalg.norm(self.turn.reshape(len(arm), -1), axis=1)
        return float((np.linalg.norm(self.shift, axis=1) + turn * arm).max())


def begun(statics: Statics, state: MotionState) -> tuple[Balanced, float, Balanced]:
    """Return the equilibrium under the loads that do not grow, or the attempt that failed.

    With it come the share of the motion of supports that the structure stands, and the last equilibrium in which it
    does; where there is none, the attempt that failed once more.

    Parameters
    ----------
    statics : Statics
    state : MotionState
        Of the bodies as described.
    """
    moved = MovedSupports.of(statics)
    found = statics.balance(state, 0.0)
    if not moved.any or not found.found:
        return found, 0.0 if moved.any else 1.0, found
    part = first = min(1.0, PART * statics.width / moved.largest(statics))
    done, lost = 0.0, found
    while done < 1.0:
        part = min(part, 1.0 - done)
        trial = statics.balance(moved.applied(found.state, part), 0.0, since=found.state)
        if not trial.found:
            lost = max(lost, trial, key=_reach) if not lost.found else trial
            part *= 0.5
            if part < SMALLEST * first:
                return lost, done, found
            continue
        found, lost, done = trial, trial, done + part
        if 1.0 - done < 1e-12:
            done = 1.0
        part = min(GROWTH * part, first)
    return found, 1.0, found


def first_state(
    structure: Structure, scheme: Scheme, factors: Mapping[str, float], engine: Engine | None
) -> tuple[MotionState, bool, str]:
    """Return where a structure begins, whether that is the equilibrium under its loads, and if not what there is."""
    reference = structure.reference
    state = MotionState.at_rest(reference)
    balanced, share, last = begun(Statics(reference, scheme, factors, engine=engine, sag=SAG), state)
    if balanced.found:
        return balanced.state, True, ""
    if 0.0 < share < 1.0:
        return last.state, False, supports_short(share)
    what = "the motion begins as described" if structure.alone else f"'{structure.name}' begins as described"
    begins = last.state if last.found else state
    return begins, False, f"no equilibrium under the loads was found at the start: {what}"


def _reach(found: Balanced) -> float:
    """Return how far an attempt went: the smallest steps of supports end before anything has moved far."""
    return float(np.abs(found.moved).max(initial=0.0))
