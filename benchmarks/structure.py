"""How the package is built, in numbers: of this checkout, and of others beside it.

    python benchmarks/structure.py [CHECKOUT ...] [--doors]

Read from the code as text; nothing is imported. ``lines`` count all of a file. ``chain``: files of the longest chain of
imports at the head of files, each needing the next. ``names twice``: names that two files or more have, ``__init__.py``
aside. ``doors`` of a room: its files that files of other rooms import. ``solves``: functions called ``solve``, any of
which a reader of a call may think of; ``names of five``: names that so many functions have or more. ``long``: functions
of more than sixty lines.
"""

from __future__ import annotations

import argparse
import ast
from collections import Counter, defaultdict
from functools import cache
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
LONG = 60
MANY = 5


class House:
    """The files of a package and what they import.

    Parameters
    ----------
    root : Path
        A checkout.
    """

    def __init__(self, root: Path) -> None:
        self.package = root / "src" / "concio"
        self.trees = {
            path.relative_to(self.package).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
            for path in sorted(self.package.rglob("*.py"))
        }
        self.texts = {name: (self.package / name).read_text(encoding="utf-8").count("\n") for name in self.trees}
        self.imports = {name: self._imports(tree) for name, tree in self.trees.items()}

    def _imports(self, tree: ast.Module) -> set[str]:
        found = set()
        for node in tree.body:
            if isinstance(node, ast.Import):
                found |= {name for alias in node.names if (name := self._file(alias.name))}
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                for alias in node.names:
                    name = self._file(f"{node.module}.{alias.name}") or self._file(node.module)
                    found |= {name} if name else set()
        return found

    def _file(self, module: str) -> str | None:
        """Return the file of a module of the package, None of others and of mere packages."""
        if not module.startswith("concio."):
            return None
        path = module.removeprefix("concio.").replace(".", "/") + ".py"
        return path if path in self.trees else None

    def chain(self) -> int:
        """Return how many files the longest chain of imports has."""

        @cache
        def depth(name: str) -> int:
            return 1 + max((depth(other) for other in self.imports[name] if other != name), default=0)

        return max(depth(name) for name in self.trees)

    def functions(self) -> list[ast.FunctionDef]:
        """Return all functions and methods."""
        return [node for tree in self.trees.values() for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]

    def doors(self) -> dict[str, tuple[int, int]]:
        """Return of each room how many of its files others import, and how many it has."""
        rooms: dict[str, set[str]] = defaultdict(set)
        for name, others in self.imports.items():
            for other in others:
                if room(other) != room(name):
                    rooms[room(other)].add(other)
        sizes = Counter(room(name) for name in self.trees if not name.endswith("__init__.py"))
        return {place: (len(rooms[place]), size) for place, size in sorted(sizes.items())}

    def numbers(self) -> dict[str, int]:
        """Return the numbers of the table."""
        functions = self.functions()
        names = Counter(Path(name).name for name in self.trees if not name.endswith("__init__.py"))
        meant = Counter(f.name for f in functions if not f.name.startswith("_"))
        classes = sum(isinstance(node, ast.ClassDef) for tree in self.trees.values() for node in ast.walk(tree))
        doors = self.doors()
        return {
            "lines": sum(self.texts.values()),
            "files": len(self.trees),
            "classes": classes,
            "functions": len(functions),
            "largest file": max(self.texts.values()),
            "long": sum((f.end_lineno or 0) - f.lineno + 1 > LONG for f in functions),
            "chain": self.chain(),
            "names twice": sum(count > 1 for count in names.values()),
            "doors": sum(found for found, _ in doors.values()),
            "solves": meant["solve"],
            "names of five": sum(count >= MANY for count in meant.values()),
        }


def room(name: str) -> str:
    """Return the room of a file: its directory."""
    return Path(name).parent.as_posix()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkouts", nargs="*", type=Path, help="others, printed before this one")
    parser.add_argument("--doors", action="store_true", help="lines, files and doors of each room")
    asked = parser.parse_args()
    houses = [House(place) for place in (*asked.checkouts, HERE)]
    every = [house.numbers() for house in houses]
    for name in every[0]:
        print(f"{name:16s}" + "".join(f"{numbers[name]:10,d}" for numbers in every))
    if not asked.doors:
        return
    print(f"\n{'room':28s}" + "".join(f"{'lines':>9s}{'files':>7s}{'doors':>7s}" for _ in houses))
    doors = [house.doors() for house in houses]
    lines = [Counter[str]() for _ in houses]
    for count, house in zip(lines, houses, strict=True):
        for name, size in house.texts.items():
            count[room(name)] += size
    for place in sorted({place for found in doors for place in found}):
        row = [(count[place], *reversed(found.get(place, (0, 0)))) for count, found in zip(lines, doors, strict=True)]
        print(f"{place:28s}" + "".join(f"{a:9,d}{b:7d}{c:7d}" for a, b, c in row))


if __name__ == "__main__":
    main()
