"""What the files of the project import, each read once."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path


@dataclass(frozen=True)
class Import:
    """One import statement.

    Parameters
    ----------
    module : str
        The module, of ``from module import names`` or ``import module``.
    names : tuple of str
        What is taken from it; empty where it is imported whole.
    line : int
    place : str
        "top" of the module or of a class, inside a "function", or under a condition on types alone: "typing".
    """

    module: str
    names: tuple[str, ...]
    line: int
    place: str


@dataclass(frozen=True)
class Source:
    """Import statements of a file, and the attributes it takes from names such as ``concio``."""

    imports: tuple[Import, ...]
    attributes: frozenset[tuple[str, str]]


@cache
def source(path: Path) -> Source:
    """Return what a file imports."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found = frozenset(
        (node.value.id, node.attr)
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    )
    return Source(tuple(_imports(path, tree, "top")), found)


def _imports(path: Path, node: ast.AST, place: str) -> Iterator[Import]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            yield from (Import(alias.name, (), child.lineno, place) for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            assert child.level == 0, f"{path}: relative import"
            yield Import(child.module or "", tuple(alias.name for alias in child.names), child.lineno, place)
        elif isinstance(child, ast.stmt | ast.excepthandler | ast.match_case):
            inner = place
            if place == "top" or isinstance(child, ast.If):
                if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
                    inner = "function"
                elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test):
                    inner = "typing"
            yield from _imports(path, child, inner)
