"""concio's engine beside Siconos, GetFEM and CalculiX on the same problems, in one run, where they are installed.

    python benchmarks/external.py [problem ...] [--tools a,b] [--limit SECONDS]

The tools come from Debian packages (python3-siconos, python3-getfem, calculix-ccx) and run as processes of their own,
Python ones under the system's ``/usr/bin/python3``; one that is not found is reported with the package to install.
Nothing of this belongs to concio or to what it needs.

What is the same. Siconos and GetFEM get concio's own matrices K, C_n, C_t, gaps, friction and loads, so that a right
answer agrees to the accuracy of the tool (GetFEM needs a tiny compliance of the joints, see its script).
CalculiX gets the same blocks, meshes and nodal loads, but has contact of its own (penalty, surface to surface), also at
the ends of head joints where the walls of the family have no pair: it can only be close; see ``external_calculix.py``.

What is changed. The blocks float, and these tools want a definite stiffness: every unknown gets a soft spring of
``SPRING`` times the mean diagonal entry of K, for every tool and for the engine alike. The engine's answer without
springs is printed too, with what they change.

What is timed. The engine, Siconos and GetFEM: the solve of a problem in memory, after start and reading, without
assembly (for Siconos' Lemke with the condensation it needs). CalculiX: the whole process, which reads, assembles and
writes. Each process is stopped after ``--limit`` seconds. One thread each.

"difference": of the largest settlement, relative to the engine's; "du": largest difference of any displacement,
relative to the engine's largest.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from shutil import which

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import numpy as np  # noqa: E402
import scipy.sparse as sp  # noqa: E402
from external_calculix import read_displacements, write_input  # noqa: E402
from wall_family import panel, wall, wall_model  # noqa: E402

import concio  # noqa: E402
from concio.contact.assembly import Assembly  # noqa: E402
from concio.problem.contact_problem import Array, ContactProblem  # noqa: E402
from concio.solvers.methods import find  # noqa: E402

SPRING = 1e-6
SYSTEM_PYTHON = "/usr/bin/python3"
HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Case:
    """A problem of the family, and the assembly it comes from (for its meshes)."""

    name: str
    problem: ContactProblem
    assembly: Assembly


@dataclass(frozen=True)
class Answer:
    """What a tool said: displacements (None where there are none), seconds, an outcome in a word, a note."""

    u: Array | None
    seconds: float
    outcome: str
    note: str = ""


def wall_case(units: int, courses: int, alpha: float) -> Case:
    """Return a wall; its meshes are assembled again and compared with the problem's stiffness and loads."""
    problem = wall(units, courses, alpha)
    assembly = concio.assemble(wall_model(units, courses, alpha))
    return checked(Case(f"wall {units} x {courses}, {alpha:g}", problem, assembly))


def panel_case(courses: int, blocks: int, joint: float, friction: float) -> Case:
    """Return a panel between walls."""
    problem = panel(courses, blocks, joint, friction)
    model = concio.running_bond_panel(courses=courses, blocks=blocks, joint=joint, friction=friction, top_pressure=10.0)
    return checked(Case(f"panel {courses} x {blocks}, {joint:g}, {friction:g}", problem, concio.assemble(model)))


def checked(case: Case) -> Case:
    """Return the case if its assembly is that of its problem."""
    again = case.assembly.problem()
    same = again.K.shape == case.problem.K.shape and not np.abs(again.K - case.problem.K).max()
    if not same or np.abs(again.f - case.problem.f).max():
        msg = f"{case.name}: wall_family.py builds another model than external.py"
        raise SystemExit(msg)
    return case


CASES: dict[str, Callable[[], Case]] = {
    "wall-6x7": lambda: wall_case(6, 7, 0.15),
    "wall-10x10": lambda: wall_case(10, 10, 0.15),
    "wall-30x14": lambda: wall_case(30, 14, 0.43),
    "panel-dry": lambda: panel_case(10, 10, 0.0, 1.0),
    "panel-mortar": lambda: panel_case(10, 10, 0.02, 1.0),
}


def with_springs(problem: ContactProblem) -> tuple[ContactProblem, float]:
    """Return the problem with a spring under every unknown, and its stiffness [kN/m]."""
    spring = SPRING * float(problem.K.diagonal().mean())
    K = sp.csr_array(problem.K + spring * sp.eye_array(problem.unknowns))
    none = sp.csc_array((problem.unknowns, 0))
    return replace(problem, K=K, R=none), spring


def engine(problem: ContactProblem) -> Answer:
    """Return the engine's answer, the faster of two runs."""
    seconds = np.inf
    for _ in range(2):
        begin = time.perf_counter()
        solution = find("auto")(problem)
        seconds = min(seconds, time.perf_counter() - begin)
    u = solution.displacement if solution.solved else None
    by = solution.info["strategy"]
    note = f"certificate {solution.certificate.worst:.0e}, {by}, {solution.factorisations} factorisations"
    return Answer(u, seconds, "converged" if solution.solved else "FAILED", note)


def run(command: list[str], folder: Path, limit: float) -> tuple[int | None, float, str]:
    """Return (exit code or None at the limit, seconds, last line of output) of a process."""
    begin = time.perf_counter()
    try:
        done = subprocess.run(
            command, cwd=folder, timeout=limit, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
    except subprocess.TimeoutExpired:
        return None, time.perf_counter() - begin, ""
    said = [line.strip() for line in done.stdout.splitlines() if line.strip()]
    return done.returncode, time.perf_counter() - begin, said[-1] if said else ""


def system_python(module: str, package: str, script: str, *options: str) -> Callable[[Case, float, float], Answer]:
    """Return a tool that runs a script under the system's Python with the problem as a file."""

    def tool(case: Case, spring: float, limit: float) -> Answer:
        probe = [SYSTEM_PYTHON, "-c", f"import numpy, scipy, {module}"]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            if not Path(SYSTEM_PYTHON).exists() or run(probe, folder, limit)[0] != 0:
                return Answer(None, np.nan, "not installed", f"apt install {package} python3-scipy")
            problem = case.problem
            data = {"f": problem.f, "gap": problem.gap, "friction": problem.laws.friction}
            for key, matrix in (("K", problem.K), ("C_n", problem.C_n), ("C_t", problem.C_t)):
                data |= {f"{key}_{part}": getattr(matrix, part) for part in ("data", "indices", "indptr")}
                data[f"{key}_shape"] = np.array(matrix.shape)
            np.savez(folder / "problem.npz", **data)
            command = [SYSTEM_PYTHON, str(HERE / script), "problem.npz", "answer.npz", *options]
            code, seconds, said = run(command, folder, limit)
            if code is None:
                return Answer(None, seconds, f"> {limit:.0f} s")
            if code or not (folder / "answer.npz").exists():
                return Answer(None, seconds, "crashed", said)
            answer = np.load(folder / "answer.npz")
            outcome = "converged" if answer["converged"] else "NOT converged"
            return Answer(answer["u"], float(answer["seconds"]), outcome, str(answer["note"]))

    return tool


def calculix(case: Case, spring: float, limit: float) -> Answer:
    """Run CalculiX on the case's meshes."""
    program = which("ccx")
    if program is None:
        return Answer(None, np.nan, "not installed", "apt install calculix-ccx")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        friction = float(case.problem.laws.friction.max())
        write_input(folder / "case.inp", case.assembly, case.problem.f, friction, spring)
        code, seconds, said = run([program, "case"], folder, limit)
        status = folder / "case.sta"
        lines = status.read_text().splitlines()[2:] if status.exists() else []
        steps = [line.split() for line in lines if line.strip()]
        if code is None:
            given_up = f"{len(steps)} attempts ended without convergence" if steps else "within the first increment"
            return Answer(None, seconds, f"> {limit:.0f} s", given_up)
        u = read_displacements(folder / "case.dat", case.assembly)
        note = f"{len(steps)} increments, {sum(int(s[3]) for s in steps)} iterations" if steps else said
        return Answer(u, seconds, "NOT converged" if u is None else "converged", note)


NEAR_COLLAPSE = "wall-30x14"
"""Takes minutes, so only on demand: 0.97 of the associated limit."""

TOOLS: dict[str, Callable[[Case, float, float], Answer]] = {
    "siconos-lemke": system_python("siconos.numerics", "python3-siconos", "external_siconos.py", "lemke"),
    "siconos-admm": system_python("siconos.numerics", "python3-siconos", "external_siconos.py", "admm"),
    "siconos-admm-1e-10": system_python("siconos.numerics", "python3-siconos", "external_siconos.py", "admm-tight"),
    "getfem": system_python("getfem", "python3-getfem", "external_getfem.py"),
    "calculix": calculix,
}


def row(case: Case, label: str, answer: Answer, reference: Answer) -> None:
    """Print a line of the table."""
    cells = f"{answer.seconds / reference.seconds:9.1f}" if np.isfinite(answer.seconds) else f"{'-':>9s}"
    if answer.u is not None and reference.u is not None and np.isfinite(answer.u).all():
        settlement, own = -reference.u[1::2].min(), -answer.u[1::2].min()
        largest = np.abs(answer.u - reference.u).max() / np.abs(reference.u).max()
        cells += f"{own:13.6e}{own / settlement - 1.0:12.1e}{largest:10.1e}"
    else:
        cells += f"{'-':>13s}{'-':>12s}{'-':>10s}"
    print(f"{case.name:24s}{case.problem.pairs:6d}  {label:19s}{answer.outcome:15s}{cells}  {answer.note}", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "cases", nargs="*", metavar="problem", help="of: " + ", ".join(CASES) + " (default: all but wall-30x14)"
    )
    parser.add_argument("--tools", default=",".join(TOOLS), help="names with commas (default: all)")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for each tool and problem")
    arguments = parser.parse_args()
    tools = arguments.tools.split(",")
    for given, known in ((arguments.cases, CASES), (tools, TOOLS)):
        for name in given:
            if name not in known:
                parser.error(f"unknown name '{name}'; there are: {', '.join(known)}")
    print(f"{'problem':24s}{'pairs':>6s}  {'tool':19s}{'outcome':15s}{'x engine':>9s}{'settlement m':>13s}"
          f"{'difference':>12s}{'du':>10s}  note")  # fmt: skip
    for name in arguments.cases or (c for c in CASES if c != NEAR_COLLAPSE):
        case = CASES[name]()
        loose = engine(case.problem)
        problem, spring = with_springs(case.problem)
        sprung = replace(case, problem=problem)
        reference = engine(problem)
        row(case, "engine", reference, reference)
        row(case, "engine, no springs", loose, reference)
        for tool in tools:
            row(case, tool, TOOLS[tool](sprung, spring, arguments.limit), reference)


if __name__ == "__main__":
    sys.exit(main())
