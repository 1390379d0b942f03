"""Stacks of blocks at rest in concio, MuJoCo and PyBullet: how far they sink and creep, in one run; writes its page.

    python benchmarks/motion_games.py [--python PYTHON] [--seconds 10] [--write]

MuJoCo and PyBullet (``pip install mujoco pybullet`` into an environment of its own, whose Python is given with
``--python``) run as processes of their own; MuJoCo with its contact parameters as they come and with the stiffest that
its step allows. What is missing is said. Times are processor times of the stepping, one thread.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import numpy as np  # noqa: E402

PAGE = Path(__file__).resolve().parents[1] / "docs" / "research" / "stacks-beside-game-engines.md"
SIDE, WIDE, WEIGHT, FRICTION, GRAVITY = 0.1, 0.2, 20.0, 0.6, 9.81
CASES = (("level", 0.0, 10), ("level", 0.0, 100), ("tilted to 0.95 of friction", 0.95, 1))
"""Floor, tangent of its slope over friction, blocks on each other."""


def by_concio(blocks: int, share: float, seconds: float, step: float) -> dict[str, float]:
    """Return how far blocks of a stack have moved, and processor seconds."""
    import concio

    bodies = [concio.Polyhedron.box("floor", (-2.0, -2.0, -0.5), (2.0, 2.0, 0.0), kind="fixed")]
    for k in range(blocks):
        low = (-WIDE / 2, -WIDE / 2, k * SIDE)
        bodies.append(concio.Polyhedron.box(f"b{k}", low, (WIDE / 2, WIDE / 2, (k + 1) * SIDE), kind="rigid"))
    angle = np.arctan(share * FRICTION)
    load = concio.Load("weight", (float(np.sin(angle)), 0.0, -float(np.cos(angle))))
    model = concio.Model(
        tuple(bodies), {"block": concio.Rigid(unit_weight=WEIGHT)}, {"joint": concio.JointLaw(FRICTION)}, loads=(load,)
    )
    begun = time.process_time()
    found = concio.dynamics(model, None, seconds, step, gravity=GRAVITY, stop_at_rest=False, stop_overturned=False)
    spent = time.process_time() - begun
    moved = found.end.centre - found.reference.disc.centroids
    late = found.end.centre - found.shots.centre[len(found.shots.centre) // 2]
    return {
        "sinks": float(-moved[:, 2].min()), "creeps": float(np.abs(moved[:, 0]).max()),
        "rate": float(np.abs(late).max() / (0.5 * seconds)), "seconds": spent, "steps": len(found.steps),
    }  # fmt: skip


def by_mujoco(blocks: int, share: float, seconds: float, step: float, stiff: bool) -> dict[str, float]:
    """Return the same of MuJoCo; run by its own Python."""
    import mujoco

    angle = float(np.arctan(share * FRICTION))
    gravity = f"{GRAVITY * np.sin(angle)} 0 {-GRAVITY * np.cos(angle)}"
    density = WEIGHT * 1e3 / GRAVITY
    contact = f'solref="{2 * step} 1" solimp="0.99 0.9999 1e-5"' if stiff else ""
    geom = f'friction="{FRICTION} 0.005 0.0001" condim="3" {contact}'
    text = f'<mujoco><option timestep="{step}" gravity="{gravity}" cone="elliptic"/><worldbody>'
    text += f'<geom name="floor" type="box" size="2 2 0.25" pos="0 0 -0.25" {geom}/>'
    for k in range(blocks):
        text += f'<body pos="0 0 {(k + 0.5) * SIDE}"><freejoint/>'
        text += f'<geom type="box" size="{WIDE / 2} {WIDE / 2} {SIDE / 2}" density="{density}" {geom}/></body>'
    model = mujoco.MjModel.from_xml_string(text + "</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    first = np.array(data.xpos[1:])
    steps = round(seconds / step)
    begun, half = time.process_time(), first
    for k in range(steps):
        mujoco.mj_step(model, data)
        if k == steps // 2:
            half = np.array(data.xpos[1:])
    spent = time.process_time() - begun
    moved, late = data.xpos[1:] - first, data.xpos[1:] - half
    return {
        "sinks": float(-moved[:, 2].min()), "creeps": float(np.abs(moved[:, 0]).max()),
        "rate": float(np.abs(late).max() / (0.5 * seconds)), "seconds": spent, "steps": steps,
        "version": mujoco.__version__,
    }  # fmt: skip


def by_pybullet(blocks: int, share: float, seconds: float, step: float) -> dict[str, float]:
    """Return the same of PyBullet; run by the Python that has it."""
    import pybullet as p

    p.connect(p.DIRECT)
    angle = float(np.arctan(share * FRICTION))
    p.setGravity(GRAVITY * np.sin(angle), 0.0, -GRAVITY * np.cos(angle))
    p.setTimeStep(step)
    floor = p.createMultiBody(0.0, p.createCollisionShape(p.GEOM_BOX, halfExtents=[2, 2, 0.25]), -1, [0, 0, -0.25])
    shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=[WIDE / 2, WIDE / 2, SIDE / 2])
    mass = WEIGHT * 1e3 / GRAVITY * WIDE * WIDE * SIDE
    bodies = [p.createMultiBody(mass, shape, -1, [0, 0, (k + 0.5) * SIDE]) for k in range(blocks)]
    for body in (floor, *bodies):  # it multiplies the two numbers of a contact
        p.changeDynamics(body, -1, lateralFriction=FRICTION**0.5, restitution=0.0)

    def places() -> np.ndarray:
        return np.array([p.getBasePositionAndOrientation(body)[0] for body in bodies])

    first = half = places()
    steps = round(seconds / step)
    begun = time.process_time()
    for k in range(steps):
        p.stepSimulation()
        if k == steps // 2:
            half = places()
    spent = time.process_time() - begun
    moved, late = places() - first, places() - half
    return {
        "sinks": float(-moved[:, 2].min()), "creeps": float(np.abs(moved[:, 0]).max()),
        "rate": float(np.abs(late).max() / (0.5 * seconds)), "seconds": spent, "steps": steps,
        "version": p.getAPIVersion(),
    }  # fmt: skip


def asked(python: str, function: str, arguments: list[object]) -> dict[str, float] | str:
    """Return what a peer does, in a process of its Python; or why not."""
    code = "import sys, json; sys.path.insert(0, sys.argv[1]); import motion_games as m; "
    code += f"print(json.dumps(m.{function}(*json.loads(sys.argv[2]))))"
    here = str(Path(__file__).resolve().parent)
    run = subprocess.run([python, "-c", code, here, json.dumps(arguments)], capture_output=True, text=True, check=False)
    if run.returncode:
        return run.stderr.strip().splitlines()[-1] if run.stderr.strip() else "it ended without a word"
    found: dict[str, float] = json.loads(run.stdout.splitlines()[-1])
    return found


def row(who: str, case: str, blocks: int, step: float, found: dict[str, float]) -> str:
    """Return a line of the table."""
    return (
        f"| {case} | {blocks} | {1e3 * step:g} | {who} | {found['sinks']:.1e} | {found['creeps']:.1e} | "
        f"{1e3 * found['rate']:.1e} | {1e3 * found['seconds'] / found['steps']:.2f} |"
    )


def main() -> None:
    """Run all cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", default=sys.executable, help="that has mujoco")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--write", action="store_true", help="write the page")
    chosen = parser.parse_args()
    lines = ["| floor | blocks | step [ms] | | sinks [m] | slides [m] | at the end [mm/s] | ms a step |",
             "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    step, version = 2e-3, ""
    peers: tuple[tuple[str, str, list[object]], ...] = (
        ("MuJoCo", "by_mujoco", [False]), ("MuJoCo, stiffest", "by_mujoco", [True]), ("PyBullet", "by_pybullet", []),
    )  # fmt: skip
    for case, share, blocks in CASES:
        lines.append(row("concio", case, blocks, step, by_concio(blocks, share, chosen.seconds, step)))
        print(lines[-1], flush=True)
        for who, function, more in peers:
            found = asked(chosen.python, function, [blocks, share, chosen.seconds, step, *more])
            if isinstance(found, str):
                print(f"{who}: {found} (pip install mujoco pybullet into an environment of its own, --python)")
                continue
            version = str(found["version"]) if who == "MuJoCo" else version
            lines.append(row(who, case, blocks, step, found))
            print(lines[-1], flush=True)
    if chosen.write and version:
        write(lines, version, chosen.seconds)


def write(lines: list[str], version: str, seconds: float) -> None:
    """Write the page of what was measured."""
    size = f"{WIDE:g} x {WIDE:g} x {SIDE:g} m"
    head = f"""# Stacks beside game engines

Written by `benchmarks/motion_games.py --write`. Blocks of {size} on a floor, friction {FRICTION:g}, stand for
{seconds:g} s: nothing should move. MuJoCo {version} (elliptic cones, its solver as it comes) lets bodies sink into each
other by its contact parameters and lets what sticks creep; "stiffest" are the parameters that its step allows
(`solref` of two steps, `solimp` 0.99 to 0.9999 over 0.01 mm). PyBullet has its own parameters as they come. Columns:
how far a block has sunk and how far one has moved along the floor at most, and the largest mean speed of the second
half; above a metre the stack has fallen over, and off the floor. A stack of a hundred blocks sinks in concio
by what its joints are lent, before the motion begins. Every step of concio is certified. Processor time, one
thread, on a machine with other work.

"""
    PAGE.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")
    print(f"written: {PAGE}")


if __name__ == "__main__":
    main()
