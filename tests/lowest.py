"""Print the lowest versions that ``pyproject.toml`` allows, one requirement a line: what ``make lowest`` installs.

``python tests/lowest.py`` prints those of the package and of its tests.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def lowest() -> list[str]:
    """Return the requirements with ``>=`` read as ``==``; those of extras of the project itself are spelt out."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found, extras = list(project["dependencies"]), ["test"]
    while extras:
        for requirement in project["optional-dependencies"][extras.pop()]:
            own = re.fullmatch(r"concio\[([\w,]+)\]", requirement)
            if own:
                extras += own.group(1).split(",")
            else:
                found.append(requirement)
    return [requirement.replace(">=", "==") for requirement in dict.fromkeys(found)]


if __name__ == "__main__":
    print(*lowest(), sep="\n")
