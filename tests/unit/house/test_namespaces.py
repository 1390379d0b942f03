"""Sub-namespaces hold the flat names of their subject, each once, and are imported when they are asked for."""

from __future__ import annotations

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import concio

CORE = {
    "Assembly", "Body", "ConcioError", "ControlPoint", "Elastic", "GeometryError", "InputError", "JointLaw",
    "JointRule", "Load", "MethodError", "Model", "NoEquilibriumError", "Outcome", "PathResult", "Polyhedron",
    "Reliability", "Result", "Rigid", "SolverError", "Stage", "StateSensitivity", "Status", "Stop", "StudyResult",
    "Support", "Temperature", "Tie", "Units", "Variable", "Verdict",
    "__version__", "assemble", "cycles", "dumps", "extrude", "friction_by_solving", "friction_margin", "limit",
    "load", "load_margin", "load_study", "loads", "merge", "model_from_dxf", "model_from_solids", "multiplier_over",
    "place", "reliability", "run_path", "save", "settle", "solve", "state_sensitivity", "study", "thrust_line",
    "thrust_surface", "variable", "write_solids",
}  # fmt: skip
"""Flat names that are of no single subject: models, files, one step, paths, limits, studies, results."""


def names_of(space: str) -> set[str]:
    return set(import_module(f"concio.{space}").__all__)


@pytest.mark.parametrize("space", concio._NAMESPACES)
def test_a_namespace_hands_on_the_same_objects(space: str) -> None:
    module = getattr(concio, space)
    assert module is sys.modules[f"concio.{space}"]
    assert names_of(space) & set(concio.__all__)
    for name in names_of(space):
        made = getattr(module, name)
        assert callable(made)
        assert made is getattr(import_module(made.__module__), name)
        if name in concio.__all__:
            assert made is getattr(concio, name)


def test_every_flat_name_is_of_one_namespace_or_of_the_core() -> None:
    for name in concio.__all__:
        spaces = [space for space in concio._NAMESPACES if name in names_of(space)]
        assert len(spaces) + (name in CORE) == 1, f"{name} is in {spaces}"
    assert set(concio.__all__) >= CORE


def test_no_name_of_a_namespace_means_two_things() -> None:
    everywhere = [(name, space) for space in concio._NAMESPACES for name in names_of(space)]
    assert len({name for name, _ in everywhere}) == len(everywhere)
    assert not {name for name, _ in everywhere} & set(concio._NAMESPACES)


@pytest.mark.parametrize("space", concio._NAMESPACES)
def test_a_namespace_holds_imports_alone_and_all_of_them(space: str) -> None:
    tree = ast.parse((Path(concio.__file__).parent / f"{space}.py").read_text(encoding="utf-8"))
    _, future, *imports, last = tree.body
    assert isinstance(future, ast.ImportFrom)
    assert future.module == "__future__"
    assert all(isinstance(one, ast.ImportFrom) for one in imports)
    assert isinstance(last, ast.Assign)
    found = {alias.name for one in imports if isinstance(one, ast.ImportFrom) for alias in one.names}
    assert found == names_of(space)


@pytest.mark.long
def test_a_namespace_is_an_attribute_before_anyone_imports_it() -> None:
    code = "import concio; print(concio.generate.arch is concio.arch, concio.seismic.Site is concio.Site)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["True", "True"]
