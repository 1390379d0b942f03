"""Run the validation cases and write the validation book: a table of all numbers, sections and pictures.

    python docs/make_validation.py            writes docs/validation_table.md, docs/validation/book.md and its pictures

Every number in the book comes from here; the same rows are asserted by ``tests/validation``.
"""

from __future__ import annotations

import importlib
import inspect
import json
import re
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tests" / "validation"), str(HERE.parent / "tests")]

from validation_cases import CASES  # noqa: E402
from validation_cases.row import CHECKS, Row  # noqa: E402

HEAD = """# The validation book

Written by `docs/make_validation.py`; the same rows are asserted by `tests/validation`. *Difference* is relative to the
expected value unless marked "abs". *Allowed* is the tolerance of the test, with its reason in the section of the case.
*Checked by* says where the expected number comes from:

"""


TABLE_HEAD = """# All numbers in one table

Written by `docs/make_validation.py`. What each case is, why its tolerances are what they are, and its picture are in
the [validation book](validation/book.md).
"""

ROUNDING = 1e-9
"""Differences below this are rounding, which differs from machine to machine: the book says no more than that."""


def number(value: float) -> str:
    """A number as the book prints it."""
    return "0" if abs(value) < 1e-9 else f"{value:.6g}"


def difference(row: Row) -> str:
    """Difference, with its kind."""
    size = abs(row.difference)
    if size < ROUNDING:
        return "below 1e-9"
    if not row.relative:
        return f"{row.difference:+.1e} abs"
    return f"{row.difference:+.1e}" if size < 1e-3 else f"{100 * row.difference:+.2f} %"


def allowed(row: Row) -> str:
    """Tolerance, or what the number is compared with."""
    if not row.asserted:
        return row.check
    return "exact" if row.tolerance == 0 else f"{row.tolerance:.0e}"


def table(rows: list[Row]) -> str:
    """Markdown table of rows."""
    lines = ["| | expected | computed | difference | allowed | checked by |", "|---|---|---|---|---|---|"]
    for r in rows:
        unit = "" if r.unit == "-" else f" {r.unit}"
        if r.reason == "yes or no":
            shown = ["yes" if value == 1 else "no" for value in (r.expected, r.computed)]
        else:
            shown = [number(r.expected) + unit, number(r.computed) + unit]
        cells = (*shown, difference(r), allowed(r), r.check)
        lines.append(f"| {r.name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def reasons(rows: list[Row]) -> str:
    """The tolerances' reasons, each once."""
    found: dict[str, str] = {}
    for r in rows:
        if r.asserted:
            found.setdefault(r.reason, allowed(r))
    return "\n".join(f"* {size}: {reason}." for reason, size in found.items()) + "\n"


def figure(name: str, module: ModuleType) -> str:
    """Draw the case's picture where it has one; return its markdown."""
    if not hasattr(module, "figure"):
        return ""
    import matplotlib as mpl

    mpl.use("Agg")
    mpl.rcParams["svg.hashsalt"] = name
    import matplotlib.pyplot as plt

    picture, axes = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
    module.figure(axes)
    picture.savefig(HERE / "validation" / f"{name}.svg", metadata={"Date": None})
    plt.close(picture)
    return f"\n![{CASES[name]}]({name}.svg)\n"


def section(name: str, title: str) -> tuple[str, list[Row]]:
    """Run one case; return its section and its rows."""
    module = importlib.import_module(f"validation_cases.{name}")
    rows = module.rows()
    text = re.sub(r"(?<!\\)\|", r"\\|", inspect.cleandoc(module.__doc__ or ""))
    parts = [
        f"## {title}",
        f"```{{eval-rst}}\n{text}\n```",
        f"Source: {module.SOURCE}",
        table(rows),
        "Tolerances:",
        reasons(rows),
    ]
    return "\n\n".join(parts) + figure(name, module), rows


IN_REPORTS = (
    "local_mechanisms", "ferris_tin_loi", "semicircular_arch", "block_on_base", "blocks_in_space", "corner_walls",
)  # fmt: skip
"""Cases whose rows stand in the annex of assessment reports."""


def report_rows() -> str:
    """Run the cases of the annex of reports; return their rows as the package carries them."""
    found = {}
    for name in IN_REPORTS:
        module = importlib.import_module(f"validation_cases.{name}")
        rows = [
            {"name": r.name, "expected": r.expected, "computed": float(f"{r.computed:.9g}"),
             "difference": float(f"{abs(r.difference):.1e}") if abs(r.difference) >= ROUNDING else 0.0,
             "tolerance": r.tolerance, "unit": r.unit, "check": r.check}
            for r in module.rows() if r.asserted
        ]  # fmt: skip
        found[name] = {"source": module.SOURCE.removesuffix("."), "rows": rows}
    return json.dumps(found, indent=1, ensure_ascii=False) + "\n"


def counted(kinds: Counter[str]) -> str:
    """What each word of the column "checked by" means, and how many rows have it."""
    lines = ["| checked by | rows | the expected number is |", "|---|---|---|"]
    lines += [f"| {word} | {kinds[word]} | {meaning} |" for word, meaning in CHECKS.items()]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the book; return 1 where a row is outside its tolerance."""
    parts, wrong, count = [], [], 0
    kinds: Counter[str] = Counter()
    every = [TABLE_HEAD]
    for name, title in CASES.items():
        text, rows = section(name, title)
        parts.append(text)
        count += len(rows)
        kinds.update(r.check for r in rows)
        source = importlib.import_module(f"validation_cases.{name}").SOURCE
        every += [f"## {title}\n", f"Source: {source}\n", table(rows)]
        wrong += [f"{name}: {r.name}" for r in rows if not r.passes and r.asserted]
        print(f"{name}: {len(rows)} rows")
    summary = f"{count} rows in {len(CASES)} cases; {len(wrong)} outside their tolerance.\n\n"
    head = HEAD + counted(kinds) + "\n" + summary
    (HERE / "validation" / "book.md").write_text(head + "\n".join(parts), encoding="utf-8")
    (HERE / "validation_table.md").write_text("\n".join(every), encoding="utf-8")
    (HERE.parent / "src" / "concio" / "report" / "validation_rows.json").write_text(report_rows(), encoding="utf-8")
    for line in wrong:
        print("outside its tolerance:", line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
