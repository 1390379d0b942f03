"""Every package that is imported is declared: in the core by the dependencies, elsewhere by an extra of pyproject."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path

import pytest

from sources import source

ROOT = Path(__file__).parents[3]
NAMES = {
    "skfem": "scikit-fem", "mpl_toolkits": "matplotlib", "docutils": "sphinx",
    "PIL": "pillow", "vtkmodules": "vtk",
}  # fmt: skip
"""Distributions of packages of another name, or that cannot do without them."""
OPTIONAL = ("fast", "dxf", "rhino", "study", "uq", "compas")
"""Extras whose packages the core may import where it first asks whether they are there."""


def pyproject() -> dict[str, dict]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def declared(project: Mapping[str, dict], *extras: str) -> set[str]:
    """Return the distributions of the core and of some extras, extras within extras followed."""
    found, left = set(), [*project["project"]["dependencies"]]
    left += [f"{project['project']['name']}[{','.join(extras)}]"] * bool(extras)
    while left:
        name, own = re.match(r"([\w.-]+)(?:\[([\w, -]+)\])?", left.pop()).groups()
        if plain(name) == project["project"]["name"]:
            left += [r for e in own.split(",") for r in project["project"]["optional-dependencies"][e.strip()]]
        else:
            found.add(plain(name))
    return found


def imported(folder: Path) -> dict[str, str]:
    """Return the packages that the files of a folder import from outside, and one place where each is.

    What ``pytest.importorskip`` asks for may be missing.
    """
    files = sorted(folder.rglob("*.py"))
    near = [*files, *(ROOT / "benchmarks").glob("*.py")]
    own = {"concio", "validation_cases"} | {f.stem for f in near} | {f.parent.name for f in near}
    found: dict[str, str] = {}
    for file in files:
        for one in source(file).imports:
            top = one.module.split(".")[0]
            if top not in own and top not in sys.stdlib_module_names:
                found.setdefault(top, f"{file.relative_to(ROOT)}:{one.line}")
    return found


def undeclared(folder: str, *extras: str, project: Mapping[str, dict] | None = None) -> dict[str, str]:
    there = declared(project or pyproject(), *extras)
    return {k: where for k, where in imported(ROOT / folder).items() if plain(NAMES.get(k, k)) not in there}


@pytest.mark.parametrize(
    ("folder", "extras"),
    [("src", OPTIONAL), ("tests", ("test",)), ("docs", ("docs", "test")), ("examples", ("test",))],
)
def test_what_is_imported_is_declared(folder: str, extras: tuple[str, ...]) -> None:
    assert imported(ROOT / folder)
    assert undeclared(folder, *extras) == {}


def test_modules_of_the_core_need_no_extra_when_they_are_imported() -> None:
    """At the top of a module stand packages of the core alone; what an extra brings is imported where it is used."""
    core = declared(pyproject())
    for file in sorted((ROOT / "src").rglob("*.py")):
        for one in source(file).imports:
            top = one.module.split(".")[0]
            if one.place == "top" and top != "concio" and top not in sys.stdlib_module_names:
                assert plain(NAMES.get(top, top)) in core, f"{file}:{one.line}"


@pytest.mark.parametrize("package", ["trimesh", "hypothesis", "vtk"])
def test_a_package_taken_out_of_the_tests_extra_is_missed(package: str) -> None:
    project = pyproject()
    extras = project["project"]["optional-dependencies"]
    extras["test"] = [r for r in extras["test"] if not r.startswith(package)]
    assert package in {NAMES.get(k, k) for k in undeclared("tests", "test", project=project)}


def test_a_package_taken_out_of_the_core_is_missed() -> None:
    project = pyproject()
    project["project"]["dependencies"] = [d for d in project["project"]["dependencies"] if "shapely" not in d]
    assert "shapely" in undeclared("src", *OPTIONAL, project=project)
