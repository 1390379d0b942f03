"""concio in space beside compas_cra, Clarabel and Siconos, in one run, where they are installed; writes their page.

    python benchmarks/space_peers.py [--compas PYTHON] [--limit SECONDS] [--only compas,clarabel,siconos] [--write]

compas_cra (``pip install compas_cra`` into an environment of its own, whose Python is given with ``--compas``) and
Siconos (Debian's ``python3-siconos``, under ``/usr/bin/python3``) run as processes of their own, each stopped after
``--limit`` CPU seconds; Clarabel is a package of this environment. What is missing is said, with what to install.
Nothing of this belongs to concio or to what it needs. CPU seconds, one thread, reading and writing not included.

What is compared is reported on the page that ``--write`` makes, ``docs/research/peers-in-space.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import numpy as np  # noqa: E402
import scipy.sparse as sp  # noqa: E402

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]

from space_family import clarabel_limit  # noqa: E402

from concio.analysis.lent_compliance import with_compliance  # noqa: E402
from concio.kinematics.rigid import rotation_matrix  # noqa: E402
from concio.problem.certificate import certify  # noqa: E402
from concio.problem.contact_problem import Array, ContactProblem, Laws  # noqa: E402
from concio.solvers.methods import find  # noqa: E402
from concio.solvers.statics.associated_limit import associated_limit  # noqa: E402
from space_problems import Built, barrel, dome, stretchers, wall  # noqa: E402

SYSTEM_PYTHON = "/usr/bin/python3"
SICONOS_WAYS = (("admm", "1e-6"), ("admm", "1e-10"), ("newton", "1e-10"), ("gauss-seidel", "1e-6"))
PAGE = HERE.parent / "docs" / "research" / "peers-in-space.md"
BOX_FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
COARSE, FINE = {"amin": 1e-2, "tmax": 1e-2, "nmax": 10}, {"amin": 1e-6, "tmax": 1e-4, "nmax": 10}
CRA = {"method": "cra", "mu": 0.84, "d_bnd": 1e-3, "eps": 1e-4}
Y, X, XY = [0, 1, 0], [1, 0, 0], [3**0.5, 1, 0]

SAMPLES: dict[str, dict[str, Any]] = {
    "A": {"sample": "A", **COARSE, **CRA, "supports": [0, 1]},
    "A, rbe": {"sample": "A", **COARSE, **CRA, "supports": [0, 1], "method": "rbe"},
    "H": {"sample": "H", **COARSE, **CRA, "supports": [0, 1]},
    "H, rbe": {"sample": "H", **COARSE, **CRA, "supports": [0, 1], "method": "rbe"},
    **{
        f"type-{k}, turned about {word}": {
            "sample": f"type-{k}", **COARSE, **CRA, "supports": [0, 1], "turned": axis, "d_bnd": 1e-2,
        }
        for k in "abcd" for word, axis in (("y", Y), ("x", X))
    },
    "type-b, turned about y, rbe": {
        "sample": "type-b", **COARSE, **CRA, "supports": [0, 1], "turned": Y, "method": "rbe"
    },
    "cubes": {"sample": "cubes", **COARSE, **CRA, "supports": [0]},
    "concave-short": {"sample": "concave-short", **COARSE, **CRA, "supports": [0], "eps": 1e-3, "d_bnd": 1e-2},
    "concave-long": {"sample": "concave-long", **COARSE, **CRA, "supports": [0], "eps": 1e-3, "d_bnd": 1e-2},
    "cube-curve-short": {"sample": "cube-curve-short", **COARSE, **CRA, "supports": [0]},
    "cube-curve-tall": {"sample": "cube-curve-tall", **COARSE, **CRA, "supports": [0]},
    "curve-3-blocks": {"sample": "curve-3-blocks", **COARSE, **CRA, "supports": [0]},
    "shelf": {
        "sample": "shelf", **FINE, **CRA, "supports": [0], "mu": 0.9, "d_bnd": 0.1, "eps": 1e-3, "method": "penalty"
    },
    "shelf-stable": {
        "sample": "shelf-stable", **FINE, **CRA, "supports": [0], "mu": 0.9, "d_bnd": 0.1, "eps": 1e-3,
        "method": "penalty",
    },
    "snake": {
        "sample": "snake", **COARSE, **CRA, "supports": [0], "mu": 0.7, "amin": 1e-4, "d_bnd": 0.1, "eps": 0.0,
        "method": "penalty",
    },
    "bridge": {
        "sample": "bridge", **FINE, **CRA, "supports": [0, 1], "mu": 0.9, "d_bnd": 0.1, "eps": 0.0,
        "method": "penalty", "heavy": [11, 12, 13, 14, 15], "heavy_density": 3.51,
    },
    "armadillo": {"sample": "armadillo_cra", **CRA, "supports": [], "amin": 1e-4, "tmax": 0.05, "nmax": 10},
}  # fmt: skip
"""compas_cra's samples with supports, friction and options as its own examples have them."""


def boxes(blocks: int, courses: int, tilt: float) -> list[tuple[list[list[float]], list[list[int]]]]:
    """Return a running-bond wall of boxes 1 x 1/2 x 1/2, turned about y by ``tilt`` [rad]: its lowest course first."""
    turn = rotation_matrix(np.array([0.0, tilt, 0.0]))
    found = []
    for c in range(courses):
        for x, dx in stretchers(c, blocks):
            corners = [[x + i * dx, 0.5 * j, 0.5 * (c + k)] for k in (0, 1) for j in (0, 1) for i in (0, 1)]
            found.append(((np.array(corners) @ turn.T).tolist(), BOX_FACES))
    return found


def wall_cases() -> dict[str, dict[str, Any]]:
    """Return walls of about 50, 200 and 800 blocks: upright, tilted within the limit, and tilted beyond it."""
    found = {}
    for blocks, courses in ((8, 6), (16, 12), (32, 25)):
        limit = associated_limit(
            problem := of_blocks(boxes(blocks, courses, 0.0), blocks, 0.6), push(problem, (1.0, 0.0, 0.0))
        ).multiplier
        count = sum(len(stretchers(c, blocks)) for c in range(courses))
        for word, share in (("upright", 0.0), ("at half its tilt", 0.5), ("at 1.2 times its tilt", 1.2)):
            found[f"wall of {count}, {word}"] = {
                "blocks": boxes(blocks, courses, float(np.arctan(share * limit))), "supports": list(range(blocks)),
                **CRA, "mu": 0.6, "amin": 1e-3, "tmax": 1e-6, "nmax": 12, "share": share,
            }  # fmt: skip
    return found


def solid(vertices: Array, faces: list[list[int]]) -> tuple[float, Array, float]:
    """Return volume, centroid and radius of a block by the theorem of divergence over fans of its faces."""
    volume, moment, middle = 0.0, np.zeros(3), vertices.mean(axis=0)
    for face in faces:
        for second, third in pairwise(face[1:]):
            a, b, c = (vertices[k] - middle for k in (face[0], second, third))
            part = float(a @ np.cross(b, c)) / 6
            volume, moment = volume + part, moment + part * (a + b + c) / 4
    radius = float(np.sqrt(((vertices - middle) ** 2).sum(axis=1).mean()))
    return volume, middle + moment / volume, radius


def contact(
    blocks: list[dict[str, Any]], joints: list[dict[str, Any]], mu: float, gap: float
) -> tuple[ContactProblem, Array, Array, Array]:
    """Return the contact problem of rigid blocks that meet at corners of interfaces, and compas_cra's (u, t_n, t_t).

    Weights and centres are computed here from vertices and faces; normals, the first axes of joints, point from a to b.
    """
    size = [solid(np.array(b["vertices"]), b["faces"]) for b in blocks]
    free = {k: i for i, k in enumerate(k for k, b in enumerate(blocks) if not b["support"])}
    f, u = np.zeros(6 * len(free)), np.zeros(6 * len(free))
    for k, i in free.items():
        volume, centre, radius = size[k]
        f[6 * i + 2] = -volume * blocks[k]["density"]
        q = np.array(blocks[k].get("displacement", np.zeros(6)))
        own = np.array(blocks[k].get("centre", centre))
        u[6 * i : 6 * i + 3] = q[:3] + np.cross(q[3:], centre - own)
        u[6 * i + 3 : 6 * i + 6] = radius * q[3:]
    row, column, value, area, forces = [], [], [], [], []
    pair = 0
    for joint in joints:
        axes = np.array(joint["axes"])
        points = np.array(joint["points"])
        spanned = sum(np.cross(p - points[0], q - points[0]) for p, q in pairwise(points[1:]))
        for p, t in zip(points, joint["forces"] or np.zeros_like(points), strict=True):
            for k, sign in ((joint["a"], -1.0), (joint["b"], 1.0)):
                if k in free:
                    _, centre, radius = size[k]
                    for r, axis in enumerate(axes):
                        row += [3 * pair + r] * 6
                        column += list(range(6 * free[k], 6 * free[k] + 6))
                        value += list(sign * np.concatenate([axis, np.cross(p - centre, axis) / radius]))
            forces.append(t)
            area.append(float(np.linalg.norm(spanned)) / 2 / len(points))
            pair += 1
    C = sp.csr_array((value, (row, column)), shape=(3 * pair, len(f)))
    tangential = np.delete(np.arange(3 * pair), np.arange(0, 3 * pair, 3))
    problem = ContactProblem(
        K=sp.csr_array((len(f), len(f))), f=f, C_n=sp.csr_array(C[::3]), C_t=sp.csr_array(C[tangential]),
        gap=np.full(pair, gap), laws=Laws.coulomb(mu, pair), R=sp.csc_array(sp.eye_array(len(f))),
        bodies=np.arange(0, len(f) + 1, 6), area=np.array(area),
    )  # fmt: skip
    t = np.array(forces)
    return problem, u, t[:, 0], t[:, 1:]


def of_blocks(shapes: list[tuple[Any, Any]], supports: int, mu: float) -> ContactProblem:
    """Return the contact problem of boxes, their common rectangles found here (axis-parallel boxes only)."""
    blocks = [
        {"vertices": v, "faces": f, "support": k < supports, "density": 1.0} for k, (v, f) in enumerate(shapes)
    ]
    ends = [(np.min(v, axis=0), np.max(v, axis=0)) for v, _ in shapes]
    joints = []
    for a in range(len(blocks)):
        for b in range(a + 1, len(blocks)):
            low, high = np.maximum(ends[a][0], ends[b][0]), np.minimum(ends[a][1], ends[b][1])
            flat = np.abs(high - low) < 1e-9
            if flat.sum() != 1 or (high < low - 1e-9).any() or (blocks[a]["support"] and blocks[b]["support"]):
                continue
            n = int(np.argmax(flat))
            p, q = (n + 1) % 3, (n + 2) % 3
            points = np.array([low] * 4)
            points[1, p], points[2, [p, q]], points[3, q] = high[p], high[[p, q]], high[q]
            axes = np.eye(3)[[n, p, q]].tolist()
            joints.append({"a": a, "b": b, "points": points.tolist(), "axes": axes, "forces": []})
    return contact(blocks, joints, mu, 0.0)[0]


def push(problem: ContactProblem, direction: tuple[float, float, float]) -> Array:
    """Return a load in proportion to the weights."""
    load = np.zeros(problem.unknowns)
    for k in range(3):
        load[k::6] = -direction[k] * problem.f[2::6]
    return load


def run(command: list[str], limit: float) -> tuple[int | None, str]:
    """Return (exit code or None at the limit, last line of output) of a process that may take ``limit`` CPU seconds."""

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit) + 5))

    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, preexec_fn=limited
    )
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return None, f"stopped after {limit:.0f} s"
    said = [line.strip() for line in done.stdout.splitlines() if line.strip()]
    return done.returncode, said[-1] if said else ""


def balance(problem: ContactProblem, t_n: Array, t_t: Array) -> float:
    """Return the largest resultant that forces leave on a block, over the total load."""
    left = problem.f + problem.C_n.T @ t_n + problem.C_t.T @ t_t.ravel()
    return float(np.abs(left).max() / problem.total_load)


def compas_rows(python: str, limit: float, cases: dict[str, dict[str, Any]]) -> list[list[str]]:
    """Return rows of the table of compas_cra: its verdict beside that on the same contact points."""
    rows = []
    for name, case in cases.items():
        with tempfile.TemporaryDirectory() as folder:
            given, got = Path(folder) / "case.json", Path(folder) / "answer.json"
            given.write_text(json.dumps(case))
            code, said = run([python, str(HERE / "space_peers_compas.py"), str(given), str(got)], limit)
            answer = json.loads(got.read_text()) if got.exists() else None
        if answer is None:
            rows.append([name, "-", "-", said[:60] or "crashed", *["-"] * 7])
            print(" | ".join(rows[-1]), flush=True)
            continue
        if code != 0:
            answer["verdict"] = said[:60] or "crashed"
        rbe = case["method"] == "rbe"
        gap = 0.0 if rbe else case["eps"]
        problem, u, t_n, t_t = contact(answer["blocks"], answer["interfaces"], case["mu"], gap)
        said = answer["verdict"].replace("solve failed: ", "")[:60]
        spent = f"{answer['seconds']:.2f}" if answer["seconds"] else "-"
        cells = [str(len(answer["blocks"])), str(problem.pairs), said, spent]
        if answer["verdict"] == "ok":
            mark = certify(problem, u, t_n, t_t)
            cells += [f"{balance(problem, t_n, t_t):.0e}", f"{mark.cone:.0e}", "-" if rbe else
                      f"{max(mark.penetration, mark.complementarity, mark.slip_direction):.0e}"]
        else:
            cells += ["-", "-", "-"]
        rows.append([name, *cells, *own_verdict(replace(problem, gap=np.zeros(problem.pairs)))])
        print(" | ".join(rows[-1]), flush=True)
    return rows


def own_verdict(problem: ContactProblem) -> list[str]:
    """Return verdict, CPU seconds and worst entry of the certificate of ``auto``."""
    begin = time.process_time()
    found = find("auto")(with_compliance(problem, problem.f)[0])
    seconds = time.process_time() - begin
    word = found.status.name.lower().replace("_", " ")
    worst = f"{found.certificate.worst:.0e}" if found.solved else "-"
    if found.mechanism is not None:
        worst = f"{found.mechanism.violation:.0e}"
    return [word, f"{seconds:.2f}", worst]


def clarabel_rows() -> list[list[str]]:
    """Return rows of the associated limit by the own cone programme and by Clarabel, with both proofs rechecked."""
    cases: dict[str, Built] = {
        "wall 8 x 6": wall(8, 6), "wall 16 x 12": wall(16, 12),
        "wall 32 x 25": wall(32, 25),
        "wall 32 x 25 out of plane": wall(32, 25, direction=(0.0, 1.0, 0.0)),
        "barrel 19 x 20": barrel(19, 20), "barrel 24 x 40": barrel(24, 40), "dome 6 x 16": dome(6, 16),
        "dome 12 x 32": dome(12, 32),
    }  # fmt: skip
    rows = []
    for name, built in cases.items():
        problem = built.problem
        begin = time.process_time()
        own = associated_limit(problem, built.live)
        seconds = time.process_time() - begin
        violation = np.nan if own.mechanism is None else own.mechanism.violation
        head = [name, str(len(problem.bodies) - 1), str(problem.pairs)]
        rows.append([*head, "concio", f"{own.multiplier:.9f}", f"{own.residual:.0e}", f"{violation:.0e}",
                     f"{own.gap:.0e}", f"{seconds:.2f}"])  # fmt: skip
        print(" | ".join(rows[-1]), flush=True)
        if find_spec("clarabel"):
            other = clarabel_limit(problem, built.live)
            label = f"Clarabel, '{other.status}'"
            rows.append([*head, label, f"{other.multiplier:.9f}", f"{other.forces:.0e}", f"{other.violation:.0e}",
                         f"{other.gap:.0e}", f"{other.seconds:.2f}"])  # fmt: skip
            print(" | ".join(rows[-1]), flush=True)
    return rows


def siconos_rows(limit: float) -> list[list[str]]:
    """Return rows of elastic walls, every unknown on a soft spring, by the engine and by three solvers of Siconos."""
    rows = []
    installed = Path(SYSTEM_PYTHON).exists() and run([SYSTEM_PYTHON, "-c", "import siconos.numerics"], limit)[0] == 0
    for name, built in {"wall 4 x 4": wall(4, 4, elastic=True), "wall 10 x 10": wall(10, 10, elastic=True),
                        "dome 4 x 12": dome(4, 12, elastic=True)}.items():  # fmt: skip
        share = 0.5 * min(associated_limit(built.problem, built.live).multiplier, 2.0)
        step = built.at(share)
        K = sp.csr_array(step.K + 1e-6 * float(step.K.diagonal().mean()) * sp.eye_array(step.unknowns))
        problem = replace(step, K=K, R=sp.csc_array((step.unknowns, 0)))
        begin = time.process_time()
        own = find("interior-point")(problem)
        seconds = time.process_time() - begin
        head = [name, str(problem.pairs)]
        rows.append([*head, "concio", own.status.name.lower(), f"{seconds:.2f}", f"{own.certificate.worst:.0e}", "-",
                     f"{own.iterations} iterations"])  # fmt: skip
        print(" | ".join(rows[-1]), flush=True)
        if not installed:
            continue
        m = problem.pairs
        order = np.argsort(np.concatenate([3 * np.arange(m), np.delete(np.arange(3 * m), np.arange(0, 3 * m, 3))]))
        C = sp.csr_array(problem.C[order])
        data: dict[str, Any] = {"f": problem.f, "gap": problem.gap, "friction": problem.laws.friction}
        for key, matrix in (("K", problem.K), ("C", C)):
            data |= {f"{key}_{part}": getattr(matrix, part) for part in ("data", "indices", "indptr", "shape")}
        for way, tolerance in SICONOS_WAYS:
            with tempfile.TemporaryDirectory() as folder:
                given, got = Path(folder) / "problem.npz", Path(folder) / "answer.npz"
                np.savez(given, **data)
                script = str(HERE / "space_peers_siconos.py")
                code, said = run([SYSTEM_PYTHON, script, str(given), str(got), way, tolerance], limit)
                label = f"Siconos {way}, {tolerance}"
                if code != 0:
                    rows.append([*head, label, said[:60], "-", "-", "-", "-"])
                else:
                    answer = np.load(got)
                    t = answer["t"].reshape(m, 3)
                    mark = certify(problem, answer["u"], t[:, 0], t[:, 1:])
                    off = np.abs(answer["u"] - own.displacement).max() / np.abs(own.displacement).max()
                    word = "converged" if answer["converged"] else "not converged"
                    rows.append([*head, label, word, f"{float(answer['seconds']):.2f}", f"{mark.worst:.0e}",
                                 f"{off:.0e}", str(answer["note"])])  # fmt: skip
            print(" | ".join(rows[-1]), flush=True)
    return rows


def table(heads: list[str], rows: list[list[str]]) -> str:
    """Return a table in Markdown."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def page(parts: dict[str, tuple[str, list[str], list[list[str]]]], missing: list[str], limit: float) -> str:
    """Return the page."""
    said = f"Not installed in this run: {'; '.join(missing)}." if missing else "All three were installed in this run."
    head = f"""# Other codes beside concio in space

Written by `benchmarks/space_peers.py --write`; CPU seconds on one core of a small shared machine, each process stopped
after {limit:.0f} of them. {said}
"""
    texts = [f"## {title}\n\n{text}\n\n{table(heads, rows)}\n" for title, (text, heads, rows) in parts.items()]
    return "\n".join([head, *texts])


COMPAS = """compas_cra {version} (MIT, with IPOPT in its wheel) on its own samples, with supports, friction and options
of its examples, and on walls of boxes 1 x 1/2 x 1/2 in running bond, friction 0.6, the lowest course fixed: upright,
and tilted in their plane to shares of what the associated limit allows (beyond it no equilibrium exists). It finds its
interfaces itself (not counted in its seconds), and its answer is checked here from interfaces, forces and
displacements, blocks weighed again: what the forces leave of the weights, how far they lie outside the round cones
(those of the package have eight sides, whose corners lie outside), both over the total load, and "law": the worst of
penetration, complementarity and the rule that friction opposes slip and is full where there is slip, at its
displacements and its contact distance. Beside it are the verdict of `auto` on the very same contact points (rigid
blocks, vanishing compliance), its seconds, and the worst entry of the certificate, or of the mechanism that proves the
verdict. `rbe` is the method without displacements; its forces may pull, and those that do are outside the cone.

"ok" is all that compas_cra says: it asks for forces that some small displacements explain, not for full friction where
there is slip, so that "law" is not met by design and says how far its answers are from Coulomb's. A failure of its
solver proves nothing either way."""
CLARABEL = """The largest multiplier of a horizontal load in proportion to the weights, rigid blocks, friction 0.6,
corner points: concio's programme on the graph of the blocks and Clarabel on the same arrays. Forces and motion of both
are rechecked from these: what the forces leave, how far the motion is from admissible, and how far apart the bounds
are."""
SICONOS = """Elastic walls and a dome of hexahedra under half of their associated limit. Siconos wants a definite
stiffness, so every unknown has a spring of 1e-6 of the mean diagonal of K, for the engine too. "Certificate" is the
worst entry for the tool's own displacements and forces, "du" the largest difference of a displacement from the
engine's, over the largest. Its Newton and Gauss-Seidel methods (the second condenses first) run with their defaults;
other settings were not sought."""


def main() -> None:
    """Print the tables, and write the page if asked to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--compas", default=sys.executable, help="a Python that has compas_cra")
    parser.add_argument("--limit", type=float, default=120.0, help="CPU seconds for each process")
    parser.add_argument("--only", default="compas,clarabel,siconos", help="names with commas")
    parser.add_argument("--cases", default="", help="of compas_cra: only names that contain this")
    parser.add_argument("--write", action="store_true", help=f"write {PAGE.name}")
    arguments = parser.parse_args()
    asked, missing = arguments.only.split(","), []
    parts: dict[str, tuple[str, list[str], list[list[str]]]] = {}
    if "compas" in asked:
        if run([arguments.compas, "-c", "import compas_cra"], arguments.limit)[0] != 0:
            missing.append("compas_cra (pip install compas_cra, then --compas PYTHON)")
        else:
            cases = {k: c for k, c in (SAMPLES | wall_cases()).items() if arguments.cases in k}
            heads = ["case", "blocks", "points", "compas_cra", "s", "balance", "cone", "law", "concio", "s", "proof"]
            about = "from importlib.metadata import version; print(version('compas_cra'))"
            text = COMPAS.replace("{version}", run([arguments.compas, "-c", about], arguments.limit)[1])
            parts["compas_cra"] = (text, heads, compas_rows(arguments.compas, arguments.limit, cases))
    if "clarabel" in asked:
        if not find_spec("clarabel"):
            missing.append("Clarabel (pip install clarabel)")
        heads = ["structure", "blocks", "points", "by", "multiplier", "forces", "motion", "gap", "s"]
        parts["Associated limits and Clarabel"] = (CLARABEL, heads, clarabel_rows())
    if "siconos" in asked:
        if run([SYSTEM_PYTHON, "-c", "import siconos.numerics"], arguments.limit)[0] != 0:
            missing.append("Siconos (apt install python3-siconos python3-scipy)")
        heads = ["structure", "pairs", "by", "outcome", "s", "certificate", "du", "note"]
        parts["Siconos"] = (SICONOS, heads, siconos_rows(arguments.limit))
    for what in missing:
        print("not installed: " + what)
    if arguments.write:
        PAGE.write_text(page(parts, missing, arguments.limit), encoding="utf-8")


if __name__ == "__main__":
    main()
