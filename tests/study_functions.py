"""Functions of studies that workers import: a block on the ground, and rows in which something goes wrong."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

import concio

VARIABLES = (
    concio.variable("mu", "uniform", low=0.3, high=0.7),
    concio.variable("s", "uniform", low=0.2, high=0.6),
)
"""Friction, and width over height, of a block pushed by a share of its weight."""


def formula(row: dict[str, Any]) -> dict[str, float]:
    """Return the multiplier of the block: it slides, or it overturns."""
    return {"multiplier": min(row["mu"], row["s"])}


def block(row: dict[str, Any]) -> concio.Model:
    """Return the block as a model: width s, height 1, friction mu, weight 1 per area."""
    s = row["s"]
    ground = concio.Body("ground", ((-2, -1), (3, -1), (3, 0), (-2, 0)), material="stone", kind="fixed")
    return concio.Model(
        bodies=(ground, concio.Body("block", ((0, 0), (s, 0), (s, 1), (0, 1)), material="stone", kind="rigid")),
        materials={"stone": concio.Rigid(unit_weight=1.0)},
        laws={"dry": concio.JointLaw(friction=row["mu"])},
        rules=(concio.JointRule("dry"),),
        loads=(concio.Load("weight", (0, -1)), concio.Load("weight", (1, 0), group="live")),
    )


def seeded(row: dict[str, Any]) -> dict[str, float]:
    """Return a number that depends on the seed of the run alone."""
    return {"drawn": float(row["seed"] % 1000)}


def slow(row: dict[str, Any]) -> dict[str, float]:
    """Take a little while, so that a study can be interrupted."""
    time.sleep(0.02)
    return formula(row)


def raising(row: dict[str, Any]) -> dict[str, float]:
    """Raise for one value in four."""
    if row["mu"] > 0.6:
        msg = "friction beyond belief"
        raise ZeroDivisionError(msg)
    return formula(row)


def hanging(row: dict[str, Any]) -> dict[str, float]:
    """Never end for one value in four."""
    while row["mu"] > 0.6:
        time.sleep(0.05)
    return formula(row)


def deaf(row: dict[str, Any]) -> dict[str, float]:
    """Never end for one value in four, and hear no alarm."""
    if row["mu"] > 0.6:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
        time.sleep(1e6)
    return formula(row)


def dying(row: dict[str, Any]) -> dict[str, float]:
    """Take the process away for one value in four."""
    if row["mu"] > 0.6:
        os.kill(os.getpid(), signal.SIGKILL)
    return formula(row)


def dying_once(row: dict[str, Any]) -> dict[str, float]:
    """Take the process away the first time that a run is made whose friction is above 0.6."""
    mark = Path(os.environ["CONCIO_TEST_MARKS"]) / f"{row['mu']:.12f}"
    if row["mu"] > 0.6 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return formula(row)


def milankovitch(row: dict[str, Any]) -> concio.Model:
    """Return a semicircular arch of radius 1 and thickness t under its own weight, on fixed springings."""
    t = row["t"]
    return concio.arch(span=2 - t, ring=t, voussoirs=40, friction=2.0, block=concio.Rigid(unit_weight=1.0))
