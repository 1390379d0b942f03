"""What steps of a motion in space cost: walls of rigid bricks at rest and shaken; a grid of blocks that is searched.

    python benchmarks/motion_space.py [--seconds 5] [--only rest|shaken|heads|facade|grid|profile]

Bricks of 0.2 x 0.1 x 0.06 m in running bond, 15 courses of 20, stand on each other with head joints open (2,260 contact
points) or closed. Times are CPU times of this process at 2 ms a step, the averages of what was computed.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import time
from collections.abc import Callable, Mapping

import numpy as np

import concio
from concio.contact.convex_bodies import ConvexBodies, pairs_of
from concio.contact.narrow_phase import find_contacts

BRICK = np.array([0.2, 0.1, 0.06])


def bricks(courses: int = 15, along: int = 20, open_heads: float = 0.01) -> concio.Model:
    """Return a wall of bricks in running bond on a fixed floor, its head joints open by a length [m]."""
    pitch = BRICK[0] + open_heads
    bodies = [concio.Polyhedron.box("floor", (-1.0, -1.0, -0.3), (along * pitch + 1.0, 1.0, 0.0), kind="fixed")]
    for c in range(courses):
        for k in range(along):
            low = np.array([(k + 0.45 * (c % 2)) * pitch, 0.0, c * BRICK[2]])  # beyond the middle end bricks tip
            bodies.append(concio.Polyhedron.box(f"c{c:02}b{k:02}", tuple(low), tuple(low + BRICK), kind="rigid"))
    return concio.Model(
        tuple(bodies), {"block": concio.Rigid(unit_weight=18.0)}, {"joint": concio.JointLaw(0.6)},
        loads=(concio.Load("weight", (0.0, 0.0, -1.0)),),
    )  # fmt: skip


Ground = Mapping[str, concio.Pulse | concio.Record]


def shake(name: str, model: concio.Model, seconds: float, motion: Ground | None) -> None:
    """Run a motion and print what it cost."""
    begun = time.process_time()
    first = concio.dynamics(model, motion, duration=2e-3, step=2e-3, stop_overturned=False)
    before = time.process_time() - begun
    begun = time.process_time()
    found = concio.dynamics(model, motion, duration=seconds, step=2e-3, start=first.end, stop_overturned=False)
    spent = time.process_time() - begun
    steps = len(found.steps)
    shares = ", ".join(f"{word} {100 * share:.1f} %" for word, share in found.steps.shares().items())
    print(
        f"{name}: first equilibrium and step {before:.1f} s; then {steps:,} steps to {float(found.end.time):.2f} s, "
        f"{1e3 * spent / max(seconds / 2e-3, 1):.1f} ms for each 2 ms; {shares}; "
        f"{float(found.steps.factorisations.mean()):.2f} factorisations a step; energy {found.energy.error:.1e}; "
        f"moved {np.abs(found.end.centre - first.end.centre).max():.1e} m; {found.ending.name.lower()}"
    )


def grid(count: int = 22) -> None:
    """Print how long it takes to find the contacts of a grid of cubes that touch."""
    side = np.arange(count) * 0.1
    bodies = [
        concio.Polyhedron.box(f"b{i}-{j}-{k}", (x, y, z), (x + 0.1, y + 0.1, z + 0.1), kind="rigid")
        for i, x in enumerate(side) for j, y in enumerate(side) for k, z in enumerate(side)
    ]  # fmt: skip
    begun = time.process_time()
    pieces = ConvexBodies.of(bodies)
    made = time.process_time()
    i, j = pairs_of(pieces, 2e-3, np.zeros(len(bodies), dtype=bool))
    paired = time.process_time()
    found = find_contacts(pieces, (i, j), 2e-3)
    done = time.process_time()
    print(
        f"{len(bodies):,} blocks: pieces {made - begun:.1f} s, {len(i):,} pairs {paired - made:.1f} s, {len(found):,} "
        f"patches with {len(found.gap):,} points {done - paired:.1f} s"
    )


def noise(size: float, seed: int, seconds: float = 15.0) -> concio.Record:
    """Return filtered noise about 2 Hz with a beginning and an end, of a largest acceleration [m/s2]."""
    time_step, count = 0.01, round(seconds / 0.01)
    at = np.arange(count) * time_step
    frequency = np.fft.rfftfreq(count, time_step)
    band = np.exp(-((np.log(np.maximum(frequency, 1e-3) / 2.0) / 0.7) ** 2))
    raw = np.fft.irfft(np.fft.rfft(np.random.default_rng(seed).normal(size=count)) * band, count)
    raw *= np.minimum(1.0, at) * np.minimum(1.0, (seconds - at) / 5.0)
    return concio.Record(size * raw / np.abs(raw).max(), time_step)


def facade() -> concio.Model:
    """Return a facade of 6 m with two returns of 3 m, bonded at the corners."""
    lines = [{"start": (0, 3), "end": (0, 0)}, {"start": (0, 0), "end": (6, 0)}, {"start": (6, 0), "end": (6, 3)}]
    return concio.walls(
        lines=lines, height=4.25, block_size=(0.75, 0.375, 0.25), block="rigid", unit_weight=20.0, friction=0.6
    )


def main() -> None:
    """Run all cases, or one."""
    sine = concio.Pulse("sine", 0.3 * 9.81, 0.5, cycles=20.0)
    ground = {"x": concio.Pulse("sine", 0.2 * 9.81, 0.37, cycles=20.0), "y": sine}

    def profiled(seconds: float) -> None:
        with cProfile.Profile() as profile:
            shake("shaken, profiled", bricks(), seconds, ground)
        pstats.Stats(profile).sort_stats("tottime").print_stats(30)

    cases: dict[str, Callable[[float], None]] = {
        "rest": lambda seconds: shake("300 bricks at rest", bricks(), seconds, None),
        "shaken": lambda seconds: shake("300 bricks, 0.3 g in two directions", bricks(), seconds, ground),
        "heads": lambda seconds: shake("300 bricks, heads closed", bricks(open_heads=0.0), seconds, ground),
        "facade": lambda seconds: shake(
            "facade with two returns, record of three components", facade(), seconds,
            {"x": noise(2.45, 1), "y": noise(1.96, 2), "z": noise(0.98, 3)},
        ),
        "grid": lambda seconds: grid(),
        "profile": profiled,
    }
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=5.0, help="of motion")
    parser.add_argument("--only", choices=cases, help="one case")
    chosen = parser.parse_args()
    for name, case in cases.items():
        if chosen.only == name or (chosen.only is None and name != "profile"):
            case(chosen.seconds)


if __name__ == "__main__":
    main()
