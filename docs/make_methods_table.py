"""Write ``docs/methods_table.md``: all methods on five standard problems, as ``benchmarks/method_family.py`` prints it.

    python docs/make_methods_table.py [--limit SECONDS]

Takes some minutes. Times are in units of the engine's, measured in the same run.
"""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent


def main() -> None:
    """Run the benchmark and write the page."""
    limit = sys.argv[sys.argv.index("--limit") + 1] if "--limit" in sys.argv else "6"
    command = [sys.executable, str(HERE.parent / "benchmarks" / "method_family.py"), "--limit", limit]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    write(printed, limit)


def write(printed: str, limit: str) -> None:
    """Write the page around the benchmark's tables."""
    head = f"""# The family on five standard problems

Written by `docs/make_methods_table.py` from `benchmarks/method_family.py --limit {limit}`: a method that needs more
than {limit} s on a problem is stopped as too slow. Time is in units of the engine's own on that problem, measured in
the same run; small ratios vary by a factor of two from run to run. "Difference" is that of the displacements from the
engine's, relative to the largest; where more than one equilibrium exists methods may find different ones.

"""
    (HERE / "methods_table.md").write_text(head + "```text\n" + printed.strip() + "\n```\n", encoding="utf-8")


if __name__ == "__main__":
    main()
