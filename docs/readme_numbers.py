"""Write the table of numbers in the README: ``python docs/readme_numbers.py``; with ``--check`` only compare.

Every number in the README comes from here, and a test runs the comparison.
"""

from __future__ import annotations

import sys
from pathlib import Path

import concio

ROOT = Path(__file__).resolve().parent.parent
README = ROOT / "README.md"
BEGIN, END = "<!-- numbers: written by docs/readme_numbers.py -->", "<!-- end of numbers -->"
PANELS = {"none, hung between the walls": "ercolano_panel.toml", "full": "ercolano_panel_full_base.toml"}


def table() -> str:
    """Return the table of the two demo panels as Markdown."""
    lines = [
        "| base | load [kN] | carried by the base [kN] | by each wall [kN] | thrust on each wall [kN] "
        "| settlement [mm] | certificate below |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, file in PANELS.items():
        result = concio.solve(concio.load(ROOT / "examples" / file))
        base = result.reactions.get("base", (0.0, 0.0))[1]
        thrust, shear = result.reactions["left wall"]
        bound = "1e-10" if result.certificate.worst < 1e-10 else "not certified"
        lines.append(
            f"| {name} | {-result.total_load[1]:.3f} | {base:.3f} | {shear:.3f} | {thrust:.3f} "
            f"| {1e3 * result.max_settlement:.3f} | {bound} |"
        )
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Write or compare; return the exit code."""
    text = README.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    old, tail = rest.split(END)
    new = f"\n{table()}\n"
    if "--check" in arguments:
        if new != old:
            print(f"the numbers in README.md are out of date; they should be\n{new}")
            return 1
        return 0
    README.write_text(f"{head}{BEGIN}{new}{END}{tail}", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
