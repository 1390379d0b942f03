"""Two facades with cracks: three bays whose pier 3 sinks and turns, and 182 stones of which half the ground sinks.

    python benchmarks/cracks_facades.py [--only "three bays" | "182 stones" | "182 stones, two motions"]

The three bays are the portal of ``benchmarks/cracks.py``: pier 3 sinks by 20 mm and turns by 2 mrad, read at eight
openings. The other is the facade of the examples on two grounds, its stones rigid, its joints of mortar: the right
ground sinks by 15 mm, read at six openings and two joints that are closed; then the left ground also gives way by
10 mm. Readings come from a path of 64 steps, with Gaussian errors of 0.5 mm. Six motions may have caused either.
Printed are the causes with their intervals, and processor seconds.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from cracks import ERROR, TRUE_STEPS, Array, at_of, portal, structure

import concio
from concio import Candidate, Measurement
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.moved import moved_model
from concio.analysis.cracks.places import all_places

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "facade.toml"


def three_bays(rng: np.random.Generator) -> tuple[concio.Model, list[Candidate], Array]:
    """Return the portal, its candidates, and the motions of pier 3."""
    candidates = structure("portal", rng)[1]
    motion = {"pier 3 sinks": 20e-3, "pier 3 turns": -2e-3}
    return portal(rng), candidates, np.array([motion.get(c.name, 0.0) for c in candidates])


def stones(rng: np.random.Generator) -> tuple[concio.Model, list[Candidate], Array]:
    """Return the facade of the examples on two grounds, of which the right one sinks."""
    del rng
    model = concio.load(EXAMPLE)
    base = next(np.asarray(b.vertices) for b in model.bodies if b.kind == "fixed")
    (left, low), (right, top) = base.min(axis=0), base.max(axis=0)
    middle = 0.5 * (left + right)
    ground = [
        concio.Body(name, np.array([(a, low), (b, low), (b, top), (a, top)]), kind="fixed", role="ground")
        for name, a, b in (("left", left, middle), ("right", middle, right))
    ]
    blocks = [replace(b, kind="rigid") for b in model.bodies if b.kind != "fixed"]
    facade = replace(
        model, bodies=(*blocks, *ground), loads=tuple(load for load in model.loads if load.group == "dead"),
        materials={k: concio.Rigid(m.unit_weight) for k, m in model.materials.items()},
        laws={k: replace(law, normal_stiffness=2e6, tangential_stiffness=8e5) for k, law in model.laws.items()},
    )  # fmt: skip
    candidates = [
        c for name, way in (("left", -1), ("right", 1)) for c in (
            Candidate(f"{name} sinks", body=name, direction=(0, -1), low=0.0),
            Candidate(f"{name} gives way", body=name, direction=(way, 0), low=0.0),
            Candidate(f"{name} turns", body=name, rotation=1),
        )
    ]  # fmt: skip
    return facade, candidates, np.array([15e-3 if c.name == "right sinks" else 0.0 for c in candidates])


def stones_twice(rng: np.random.Generator) -> tuple[concio.Model, list[Candidate], Array]:
    """Return the same facade, whose right ground sinks and whose left ground gives way."""
    facade, candidates, truth = stones(rng)
    return facade, candidates, truth + np.array([10e-3 if c.name == "left gives way" else 0.0 for c in candidates])


def read(
    model: concio.Model, candidates: list[Candidate], truth: Array, closed: int, rng: np.random.Generator
) -> list[Measurement]:
    """Return eight readings, ``closed`` of them at joints that are closed."""
    scale = np.array([0.02 if c.direction else 0.01 for c in candidates])
    moved = moved_model(model, candidates, scale)
    forward = Forward.of(concio.assemble(moved.model), moved, (), "steps", TRUE_STEPS)
    state = forward.predict(truth)
    places = [r for kind, r in all_places(forward) if kind == "opening"]
    values = forward.read(places, state.displacement, state.factors)
    wide, shut = np.flatnonzero(values > 4 * ERROR), np.flatnonzero(np.abs(values) < 0.2 * ERROR)
    names = [b.name for b in model.bodies]
    found = []
    for k, i in enumerate([*rng.choice(wide, 8 - closed, replace=False), *rng.choice(shut, closed, replace=False)]):
        kind = "opening" if k < 8 - closed else "closed"
        value = max(0.0, float(values[i] + rng.normal(0, ERROR))) if kind == "opening" else 0.0
        joint = (names[places[i].bodies[0]], names[places[i].bodies[1]])
        found.append(Measurement(f"K{k + 1}", kind, ERROR, value, joint, at=at_of(places[i])))
    return found


def main() -> None:
    """Diagnose and print."""
    cases = {"three bays": (three_bays, 0), "182 stones": (stones, 2), "182 stones, two motions": (stones_twice, 2)}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=tuple(cases))
    only = parser.parse_args().only
    for name, (make, closed) in cases.items():
        if only not in (None, name):
            continue
        rng = np.random.default_rng(1)
        model, candidates, truth = make(rng)
        measured = read(model, candidates, truth, closed, rng)
        begun = time.process_time()
        found = concio.diagnose(model, measured, candidates, most=2)
        seconds = time.process_time() - begun
        told = ", ".join(f"{c.name} {1e3 * s:g}" for c, s in zip(candidates, truth.tolist(), strict=True) if s)
        print(f"{name}: {len(model.bodies) - sum(b.kind == 'fixed' for b in model.bodies)} stones, "
              f"{len(found.forward.assembly.pairs)} contact pairs; true: {told} (mm, mrad)")  # fmt: skip
        added = [a.cause for a in found.additions if a.cause is not None]
        for word, cause in [*(("cause", c) for c in found.causes), *(("clearly better", c) for c in added)]:
            parts = zip(cause.names, 1e3 * cause.motion, 1e3 * cause.low, 1e3 * cause.high, strict=True)
            print(f"  {word}: " + "; ".join(f"{n} {s:.2f} ({a:.2f} to {b:.2f})" for n, s, a, b in parts)
                  + f"; misfit {cause.misfit:.1f}")  # fmt: skip
        print(f"  {found.verdict.status}; {len(found.trials)} choices, {found.forward.runs} paths of "
              f"{found.forward.steps} steps, {seconds:.0f} processor seconds", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
