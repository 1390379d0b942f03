"""A rocking stack beside Siconos: the same blocks, pulse, step and scheme in both, compared and timed in one run.

    python benchmarks/motion_peer.py [--figure FILE]

Siconos is run by the system's Python (``apt install python3-siconos``); without it, the script says so and shows
concio alone. Times are CPU times of the stepping.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import concio

PYTHON = "/usr/bin/python3"
WIDTHS, HEIGHT, FRICTION, GRAVITY = (1.0, 0.8, 0.6), 0.9, 0.7, 9.81
PULSE = concio.Pulse("sine", 0.5 * GRAVITY, 1.5, cycles=1.0)
DURATION, EVERY = 2.5, 1e-2


def stack() -> concio.Model:
    """Return three blocks on each other, narrower upwards."""
    floor = [(-5.0, -1.0), (5.0, -1.0), (5.0, 0.0), (-5.0, 0.0)]
    bodies, y = [concio.Body("floor", floor, kind="fixed")], 0.0
    for k, width in enumerate(WIDTHS):
        b = width / 2
        outline = [(-b, y), (b, y), (b, y + HEIGHT), (-b, y + HEIGHT)]
        bodies.append(concio.Body(f"block {k + 1}", outline, kind="rigid"))
        y += HEIGHT
    material = {"block": concio.Rigid(unit_weight=20.0)}
    loads = (concio.Load("weight", (0.0, -1.0)),)
    return concio.Model(tuple(bodies), material, {"joint": concio.JointLaw(FRICTION)}, loads=loads)


def by_concio(step: float) -> tuple[np.ndarray, np.ndarray, float, concio.DynamicsResult]:
    """Return times (n,), angles (n, 3), CPU seconds and the result."""
    begun = time.process_time()
    found = concio.dynamics(
        stack(), PULSE, DURATION, step, gravity=GRAVITY, start="as described", adaptive=False, every=EVERY,
        stop_overturned=False,
    )  # fmt: skip
    return found.shots.time[1:], found.shots.rotation[1:, 1:], time.process_time() - begun, found


def by_siconos(step: float) -> tuple[np.ndarray, float] | None:
    """Return angles (n, 3) and CPU seconds; None where Siconos is not installed."""
    if subprocess.run([PYTHON, "-c", "import siconos.kernel"], capture_output=True, check=False).returncode:
        return None
    middle = (np.arange(round(DURATION / step)) + 0.5) * step
    b, h = np.array(WIDTHS) / 2, np.full(len(WIDTHS), HEIGHT / 2)
    mass = 4 * b * h * 20.0 / GRAVITY
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder, "problem.npz"), Path(folder, "answer.npz")
        np.savez(
            given, b=b, h=h, mass=mass, moment=mass * (b**2 + h**2) / 3, friction=FRICTION, gravity=GRAVITY, step=step,
            ground=PULSE.acceleration(middle),
        )  # fmt: skip
        script = Path(__file__).with_name("external_siconos_motion.py")
        subprocess.run([PYTHON, str(script), str(given), str(answer)], check=True, stdout=subprocess.DEVNULL)
        found = np.load(answer)
        own = np.arange(1, round(DURATION / EVERY) + 1) * round(EVERY / step) - 1
        return found["path"][own, :, 2], float(found["seconds"])


def told(what: str, times: np.ndarray, apart: np.ndarray) -> None:
    """Print the largest difference of any angle until some times."""
    largest = [np.rad2deg(np.abs(apart[times <= end + 1e-9]).max()) for end in (0.8, 1.0, 2.2, DURATION)]
    print(f"{what}, degrees until 0.8, 1, 2.2 and {DURATION:g} s:", ", ".join(f"{v:.4f}" for v in largest), flush=True)


def main() -> None:
    """Run both at several steps and compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figure", type=Path, help="draw the angles of the smallest step here")
    parser.add_argument("--steps", type=float, nargs="+", default=[2e-3, 1e-3, 5e-4], help="[s]")
    chosen = parser.parse_args()
    curves: list[tuple[np.ndarray, np.ndarray, str]] = []
    before: list[np.ndarray] = []
    for step in chosen.steps:
        times, ours, seconds, found = by_concio(step)
        line = f"h = {1e3 * step:g} ms: largest angle {np.rad2deg(np.abs(ours).max()):.3f} degrees, "
        line += f"energy {found.energy.error:.1e}; concio {seconds:.2f} s"
        theirs = by_siconos(step)
        if theirs is None:
            print(line + "; Siconos is not installed (Debian package python3-siconos)")
            continue
        print(line + f", Siconos {theirs[1]:.2f} s", flush=True)
        told("  between the two", times, theirs[0] - ours)
        for name, now, then in zip(("concio", "Siconos"), (ours, theirs[0]), before, strict=False):
            told(f"  {name} from itself at the step before", times, now - then)
        before = [ours, theirs[0]]
        curves = [(times, ours, "concio"), (times, theirs[0], "Siconos")]
    if chosen.figure and curves:
        draw(chosen.figure, curves)


def draw(target: Path, curves: list[tuple[np.ndarray, np.ndarray, str]]) -> None:
    """Draw the angles of the blocks by both."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
    for k in range(len(WIDTHS)):
        (times, ours, _), (_, theirs, _) = curves
        axes.plot(times, np.rad2deg(ours[:, k]), color=f"C{k}", lw=2.5, alpha=0.5, label=f"block {k + 1}, concio")
        axes.plot(times, np.rad2deg(theirs[:, k]), color=f"C{k}", lw=1.0, ls="--", label=f"block {k + 1}, Siconos")
    axes.set(xlabel="time [s]", ylabel="rotation, anticlockwise [degrees]")
    axes.legend(fontsize=8, ncols=3)
    figure.savefig(target, metadata={"Date": None} if target.suffix == ".svg" else None)


if __name__ == "__main__":
    main()
