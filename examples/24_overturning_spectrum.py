"""Pulses of the ground that overturn a free-standing block.

A study draws 300 half-sine pulses of many amplitudes and frequencies and shakes a block 0.2 x 1.5 m with each. The full
line is the closed form of the linear equation of rocking, in which a block overturns without an impact if and only if
its state lies above a ray when the pulse ends; the dotted one is Housner's well-known shortcut, up to 55 % higher;
below an amplitude of g alpha nothing lifts. The program has no model of rocking: it knows two corners with
friction.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import concio

WIDTH, HEIGHT, G = 0.2, 1.5, 9.81
ALPHA = float(np.arctan(WIDTH / HEIGHT))
P = float(np.sqrt(3 * G / (2 * np.hypot(WIDTH, HEIGHT))))


def shaken(row: dict[str, float]) -> dict[str, float]:
    """Return the largest rotation over alpha under a half sine of amplitude A g alpha and frequency W p."""
    floor = concio.Body("floor", ((-4, -0.3), (4, -0.3), (4, 0), (-4, 0)), kind="fixed")
    block = concio.Body("block", ((0, 0), (WIDTH, 0), (WIDTH, HEIGHT), (0, HEIGHT)), material="stone", kind="rigid")
    model = concio.Model(
        bodies=(floor, block),
        materials={"stone": concio.Rigid(unit_weight=22.0)},
        laws={"dry": concio.JointLaw(friction=0.7)},
        rules=(concio.JointRule("dry"),),
        loads=(concio.Load("weight", (0, -1)),),
    )
    length = np.pi / (row["frequency"] * P)
    pulse = concio.Pulse("half sine", row["amplitude"] * G * ALPHA, length)
    found = concio.dynamics(model, pulse, length + 1.5, length / 60, gravity=G, every=0.01)
    return dict(rotation=found.largest_rotation[1] / ALPHA)


def threshold(frequency: float) -> float:
    """Least amplitude that overturns without an impact, of the linear equation."""

    def left_over(s: float) -> float:
        late = np.exp(-(np.pi - np.arcsin(s)) / frequency)
        return s + frequency * np.sqrt(1 - s * s) + frequency * late - s * (1 + frequency**2)

    return 1.0 / brentq(left_over, 1e-6, 1 - 1e-12)


def main(figure: Path | None = None, size: int = 300) -> dict[str, float]:
    """Run the study, print, draw into ``figure`` where given; return the numbers that the tests look at."""
    variables = [
        concio.variable("frequency", "uniform", low=0.8, high=5.0),
        concio.variable("amplitude", "uniform", low=0.8, high=3.5),
    ]
    found = concio.study(shaken, variables, "rotation", size=size, seed=3)
    frequency, amplitude = found.values("frequency"), found.values("amplitude")
    overturned = found.values("rotation") > 1.0
    ratio = amplitude / np.array([threshold(w) for w in frequency])
    clear = np.abs(ratio - 1) > 0.02
    wrong = int((overturned != (ratio > 1))[clear].sum())
    print(f"{len(found)} pulses, {overturned.sum()} overturn the block")
    print(f"{wrong} of {clear.sum()} further than 2 % from the closed form are on the wrong side of it")
    if figure:
        import matplotlib.pyplot as plt

        drawn, ax = plt.subplots(figsize=(7.6, 4.8), layout="constrained")
        line = np.linspace(0.8, 5.0, 200)
        ax.plot(line, [threshold(w) for w in line], color="#333333", label="closed form, no impact")
        ax.plot(line, np.sqrt(1 + line**2), color="#333333", ls=":", label="Housner's shortcut")
        ax.axhline(1.0, color="#999999", lw=0.8, label="uplift")
        for fallen, marker, word in ((True, "x", "overturns"), (False, "o", "stays")):
            ax.plot(frequency[overturned == fallen], amplitude[overturned == fallen], marker, ms=4, label=word)
        ax.set_ylim(0.7, 3.6)
        ax.set_xlabel("frequency of the pulse over p")
        ax.set_ylabel("amplitude over g alpha")
        ax.legend(loc="upper left")
        drawn.savefig(figure)
    return {"wrong": wrong, "overturned": int(overturned.sum()), "runs": len(found)}


if __name__ == "__main__":
    main()
