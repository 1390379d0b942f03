r"""One node with two degrees of freedom over a rigid obstacle: non-uniqueness and non-existence at large friction.

Stiffness [[k_tt, k_tn], [k_tn, k_nn]] with k_tn = -c, loads (f_t, -q) with q > 0, zero gap, first load step. By hand:

* stick: u = 0, needs |f_t| <= mu q;
* slip forwards: u_t (k_tt - mu c) = f_t - mu q, needs u_t > 0 and t_n = q - c u_t >= 0;
* open: u_n = (c f_t - k_tt q) / det >= 0, that is f_t >= (k_tt / c) q;
* slip backwards: u_t (k_tt + mu c) = f_t + mu q < 0.

For mu < k_tt / c there is exactly one solution. For mu > k_tt / c and (k_tt / c) q < f_t < mu q three coexist: stick,
slip and open. All are equilibria; the certificate proves that an answer is one, not that it is the only one. Along a
path from f_t = 0 the node sticks until f_t = mu q; there the rate problem has *no* solution: slip would have to go
backwards. The structure jumps to the only state there is beyond, the open one; concio's path names the jump.

Make the stiffness singular, k_nn = c^2 / k_tt: the node floats along (c, k_tt). Then open needs k_tt q = c f_t exactly,
and for mu > k_tt / c and f_t > mu q there is *no* solution in the first step either, although forces within the cone
balance the loads (t_t = -mu t_n with t_n = (c f_t / k_tt - q) / (c mu / k_tt - 1)), so that no mechanism excludes it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from concio.problem.certificate import certify
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.solution import Solution, Status
from concio.solvers.methods import find
from concio.solvers.path.event_path import EventPath, follow
from concio.solvers.path.path_state import LinearPath, state_of
from concio.solvers.statics.existence import statically_admissible
from validation_cases.row import Row

SOURCE = (
    "A. Klarbring, Examples of non-uniqueness and non-existence of solutions to quasistatic contact problems with"
    " friction, Ingenieur-Archiv 60 (1990)."
)

K_TT, K_NN, C, Q = 1.0, 2.0, 1.0, 1.0
METHODS = ("auto", "interior-point", "alart-curnier", "lagrange", "panagiotopoulos")


def problem(mu: float, f_t: float, q: float = Q) -> ContactProblem:
    """Unknowns (u_t, u_n); the obstacle is side a, the node side b."""
    return ContactProblem(
        K=sp.csr_array(np.array([[K_TT, -C], [-C, K_NN]])),
        f=np.array([f_t, -q]),
        C_n=sp.csr_array(np.array([[0.0, 1.0]])),
        C_t=sp.csr_array(np.array([[1.0, 0.0]])),
        gap=np.zeros(1),
        laws=Laws.coulomb(mu, 1),
        R=sp.csc_array((2, 0)),
        bodies=np.array([0, 2]),
    )


def floating(mu: float, f_t: float) -> ContactProblem:
    """The same with the stiffness made singular: one rigid motion, (c, k_tt)."""
    motion = np.array([[C], [K_TT]]) / np.hypot(C, K_TT)
    K = np.array([[K_TT, -C], [-C, C * C / K_TT]])
    return replace(problem(mu, f_t), K=sp.csr_array(K), R=sp.csc_array(motion))


def floating_by_hand(mu: float, f_t: float, q: float = Q) -> int:
    """Number of the floating node's solutions that are pressed: stick, slip either way."""
    count = int(abs(f_t) <= mu * q)
    for side in (1.0, -1.0):
        u_t = (f_t - side * mu * q) / (K_TT - side * mu * C)
        count += int(side * u_t > 0 and q - C * u_t >= 0)
    return count


def by_hand(mu: float, f_t: float, q: float = Q) -> dict[str, tuple[np.ndarray, float, float]]:
    """All solutions (u, t_n, t_t) by enumerating the four states."""
    found = {}
    if abs(f_t) <= mu * q:
        found["stick"] = (np.zeros(2), q, -f_t)
    for name, side in (("slip forwards", 1.0), ("slip backwards", -1.0)):
        u_t = (f_t - side * mu * q) / (K_TT - side * mu * C)
        t_n = q - C * u_t
        if side * u_t > 0 and t_n >= 0:
            found[name] = (np.array([u_t, 0.0]), t_n, -side * mu * t_n)
    det = K_TT * K_NN - C * C
    u = np.array([K_NN * f_t - C * q, C * f_t - K_TT * q]) / det
    if u[1] >= 0:
        found["open"] = (u, 0.0, 0.0)
    return found


def worst_of(mu: float, f_t: float) -> float:
    """Worst certificate entry of the solutions by hand."""
    p = problem(mu, f_t)
    return max(certify(p, u, np.array([n]), np.array([[t]])).worst for u, n, t in by_hand(mu, f_t).values())


def answer(mu: float, f_t: float, method: str = "auto") -> Solution:
    return find(method)(problem(mu, f_t))


def distance(mu: float, f_t: float, method: str) -> float:
    """Distance of an answer from the nearest solution by hand; 0 where the method says that it has none."""
    s = answer(mu, f_t, method)
    if not s.solved:
        return 0.0
    return float(min(np.abs(s.displacement - u).max() for u, *_ in by_hand(mu, f_t).values()))


def path(mu: float, until: float) -> EventPath:
    """Grow f_t from 0 under constant q."""
    line = LinearPath(problem(mu, 0.0), np.array([1.0, 0.0]))
    first = find("auto")(problem(mu, 0.0))
    start = state_of(line, 0.0, first.displacement, first.normal_force, first.friction_force)
    return follow(line, start, until=until)


def rows() -> list[Row]:
    rough, load = 2.0, 1.5
    exact = "plain arithmetic"
    found = [
        Row("number of solutions, mu = 0.5, f_t = 1.5", 1, len(by_hand(0.5, load)), 0, exact),
        Row("number of solutions, mu = 2, f_t = 1.5", 3, len(by_hand(rough, load)), 0, exact),
        Row("worst certificate of the three solutions", 0.0, worst_of(rough, load), 1e-14, exact),
        Row(
            "displacement at mu = 0.5, f_t = 0.8",
            (0.8 - 0.5) / (K_TT - 0.5),
            float(answer(0.5, 0.8).displacement[0]),
            1e-12,
            exact,
        ),
    ]
    found += [
        Row(f"distance to the nearest solution, mu = 2, {name}", 0.0, distance(rough, load, name), 1e-12, exact)
        for name in METHODS
    ]
    walked = path(rough, 5.0)
    left = walked.states[walked.jumps[0].step - 1].parameter if walked.jumps else np.nan
    opened = float(np.abs(walked.end.displacement - by_hand(rough, 5.0)["open"][0]).max())
    found += [
        Row("load at which the path jumps, mu = 2", rough * Q, left, 1e-12, exact),
        Row("distance of the path's end at f_t = 5 from the open state", 0.0, opened, 1e-12, exact),
    ]
    none = floating(rough, 2.5)
    verdict, proof = find("auto")(none).status, find("exhaustive")(none).status
    found += [
        Row("floating node, f_t = 2.5: solutions by hand", 0, floating_by_hand(rough, 2.5), 0, exact),
        Row("floating node: forces in balance exist", 1.0, float(statically_admissible(none).exists), 0.0, "yes or no"),
        Row("floating node: auto finds it moving away", 1.0, float(verdict is Status.COLLAPSES), 0.0, "yes or no"),
        Row(
            "floating node: exhaustive proves that there is none",
            1.0,
            float(proof is Status.NO_COULOMB_STATE),
            0.0,
            "yes or no",
        ),
        Row(
            "floating node, f_t = 1.5: answered",
            1.0,
            float(find("auto")(floating(rough, 1.5)).solved),
            0.0,
            "yes or no",
        ),
    ]
    return found
