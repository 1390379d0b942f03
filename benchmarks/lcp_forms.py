"""Unknowns, condition, pivots and outcome of Lemke's method on every form of a family of panels.

    python benchmarks/lcp_forms.py             # small panels, half a minute
    python benchmarks/lcp_forms.py --large     # adds 6 x 6 with mortar (770 pairs)

Three tables from one run: the forms (the paper's claim: two unknowns saved for each rigid motion, six for each free
body); what the covering vector does to them; how the basis is kept (dense inverse or product form). Ratios are to the
sparse method on the same panel.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

from concio.contact.assembly import assemble
from concio.errors import MethodError
from concio.model.generate.panel import running_bond_panel
from concio.problem.contact_problem import ContactProblem
from concio.solvers.lcp.lemke_method import LemkeResult, Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity
from concio.solvers.methods.forms.force_method import force_method
from concio.solvers.methods.forms.forms import MixedForm, mixed_form
from concio.solvers.methods.forms.reduction import reduce
from concio.solvers.methods.forms.split_motions import split
from concio.solvers.pivoting.sparse_lemke import solve

PANELS: dict[str, dict[str, Any]] = {
    "2 x 2 dry": {"courses": 2, "blocks": 2, "joint": 0.0, "friction": 1.0, "base": "full"},
    "2 x 2 mortar": {"courses": 2, "blocks": 2, "joint": 0.02, "friction": 1.0, "base": "full"},
    "3 x 3 dry": {"courses": 3, "blocks": 3, "joint": 0.0, "friction": 0.6, "base": "full"},
    "3 x 3 mortar": {"courses": 3, "blocks": 3, "joint": 0.02, "friction": 1.0, "base": "full"},
    "3 x 6 dry, no base, mu 0.6": {"courses": 3, "blocks": 6, "joint": 0.0, "friction": 0.6, "base": "none"},
    "3 x 6 dry, no base, mu 1": {"courses": 3, "blocks": 6, "joint": 0.0, "friction": 1.0, "base": "none"},
}
LARGE = {"6 x 6 mortar": {"courses": 6, "blocks": 6, "joint": 0.02, "friction": 1.0, "base": "full"}}


def panel(options: dict[str, Any]) -> ContactProblem:
    """Return the contact problem of a panel between side walls under 10 kN/m2."""
    model = running_bond_panel(side_walls=True, top_pressure=10.0, elements_per_block=(4, 2), **options)
    return assemble(model).problem()


def standard(form: MixedForm, elimination: str) -> tuple[LinearComplementarity, float, str]:
    """Return the standard problem, its condition number and the kind of rigid coordinates."""
    if elimination == "split":
        return split(form), float("nan"), ""
    chosen = force_method(form, normal_only=True if elimination == "normals" else None)
    return chosen.standard()[0], chosen.condition, "normal" if chosen.normal_only else "mixed"


def outcome(lcp: LinearComplementarity, result: LemkeResult) -> str:
    """Return a word for what came out, judged by the residual of the problem."""
    if result.outcome is Outcome.SOLVED:
        return f"solved {result.residual / (1 + np.abs(lcp.q).max()):.0e}"
    return {Outcome.RAY: "ray", Outcome.LIMIT: "limit", Outcome.LOST: "lost"}.get(result.outcome, "broken")


def covers(form: MixedForm, lcp: LinearComplementarity) -> dict[str, np.ndarray | None]:
    """Return the covering vectors compared."""
    rest = np.ones(lcp.size - form.size)
    return {
        "work-free": np.concatenate([form.cover(), rest]),
        "ones": np.ones(lcp.size),
        "ones, scaled rows": None,
    }


def forms_table(panels: dict[str, dict[str, Any]]) -> None:
    """Print the table of forms."""
    print("| panel | pairs | bodies | form | rigid motions | unknowns | condition | pivots | outcome | time / sparse |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, options in panels.items():
        problem = panel(options)
        start = time.perf_counter()
        answer = solve(problem)
        base = time.perf_counter() - start
        bodies = problem.rigid_motions // 3
        head = f"| {name} | {problem.pairs} | {bodies}"
        word = f"{answer.status.name.lower()} {answer.certificate.worst:.0e}"
        print(
            f"{head} | sparse, by states | kept | {problem.unknowns} | | {answer.iterations} | {word} | 1 |", flush=True
        )
        reduction = reduce(problem)
        for form_name in ("3m", "4m"):
            form = mixed_form(reduction, form_name)  # type: ignore[arg-type]
            for elimination in ("force method", "split"):
                if elimination == "force method" and problem.pairs > 400:
                    continue  # dense: minutes
                try:
                    lcp, condition, kind = standard(form, elimination)
                except MethodError as error:
                    print(f"{head} | {form_name} | {elimination} | | | | {error} | |")
                    continue
                start = time.perf_counter()
                result = lemke(lcp, cover=covers(form, lcp)["work-free"])
                ratio = (time.perf_counter() - start) / base
                shown = "" if np.isnan(condition) else f"{condition:.0f} ({kind})"
                print(
                    f"{head} | {form_name} | {elimination} | {lcp.size} | {shown} | {result.pivots} | "
                    f"{outcome(lcp, result)} | {ratio:.1f} |",
                    flush=True,
                )


def covers_table(panels: dict[str, dict[str, Any]]) -> None:
    """Print, for each form and cover, how many panels are solved, and the pivots."""
    print("\n| form | rigid motions | cover | solved | pivots where solved |")
    print("|---|---|---|---|---|")
    reductions = [reduce(panel(options)) for options in panels.values()]
    for form_name in ("3m", "4m"):
        for elimination in ("force method", "split"):
            lines: dict[str, list[LemkeResult]] = {}
            for reduction in reductions:
                form = mixed_form(reduction, form_name)  # type: ignore[arg-type]
                lcp = standard(form, elimination)[0]
                for cover_name, cover in covers(form, lcp).items():
                    lines.setdefault(cover_name, []).append(lemke(lcp, cover=cover, limit=10 * lcp.size))
            for cover_name, results in lines.items():
                good = [r.pivots for r in results if r.outcome is Outcome.SOLVED]
                print(
                    f"| {form_name} | {elimination} | {cover_name} | {len(good)} of {len(results)} | "
                    f"{', '.join(map(str, good))} |",
                    flush=True,
                )


def basis_table(panels: dict[str, dict[str, Any]]) -> None:
    """Print the time of each way to keep the basis, as a ratio to the product form."""
    print("\n| panel | unknowns | entries of M | pivots | dense inverse / product form |")
    print("|---|---|---|---|---|")
    for name, options in panels.items():
        form = mixed_form(reduce(panel(options)), "3m")
        for elimination in ("split", "force method"):
            lcp = standard(form, elimination)[0]
            if lcp.size > 1500:
                continue
            cover = covers(form, lcp)["work-free"]
            seconds, result = {}, None
            for kind in ("inverse", "product"):
                start = time.perf_counter()
                result = lemke(lcp, cover=cover, basis=kind)  # type: ignore[arg-type]
                seconds[kind] = time.perf_counter() - start
            assert result is not None
            share = np.count_nonzero(lcp.M if isinstance(lcp.M, np.ndarray) else lcp.M.toarray()) / lcp.size**2
            print(
                f"| {name}, {elimination} | {lcp.size} | {share:.0%} | {result.pivots} | "
                f"{seconds['inverse'] / seconds['product']:.2f} |",
                flush=True,
            )


def main() -> None:
    """Run and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--large", action="store_true", help="add 6 x 6 with mortar")
    large = parser.parse_args().large
    forms_table({**PANELS, **(LARGE if large else {})})
    covers_table(PANELS)
    basis_table(PANELS)


if __name__ == "__main__":
    main()
