"""Rooms import only from earlier rooms, and ``import concio`` loads nothing heavy."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import concio
from concio.views import VIEWS, view
from sources import source

ROOT = Path(concio.__file__).parent
ORDER = (
    "__version__", "representation", "read_only", "views", "argument_types", "errors", "files", "synonyms", "arguments",
    "units", "display",
    "kinematics", "model", "model/motion", "model/road", "model/interfaces", "model/generate", "model/drawing",
    "model/picture",
    "model/solids", "model/file",
    "fem", "problem", "contact",
    "solvers/algebra", "solvers/lcp", "solvers/states", "solvers/statics", "solvers/interior", "solvers/pivoting",
    "solvers/relaxation", "solvers/stepping", "solvers/auto", "solvers/path", "solvers",
    "solvers/methods/forms", "solvers/methods/iterative", "solvers/methods/exhaustive", "solvers/methods",
    "proof", "verdict", "analysis", "analysis/motion", "analysis/cells", "analysis/continuum",
    "analysis/seismic", "analysis/bridges", "analysis/cracks", "post", "plot", "report", "io",
    "studies", "bridges", "cells", "cracks", "generate", "motion", "seismic", "trace", "window", "cli", "__main__",
)  # fmt: skip
"""Rooms in the order in which things flow: each imports from itself and from those before it."""
MODULES = sorted(ROOT.rglob("*.py"))


def place(module: str) -> str:
    """Return the path in the package of a module such as ``concio.fem.mesh``, or of a name such as ``concio.solve``."""
    word = module.removeprefix("concio.")
    word = concio._HOME.get(word, module).removeprefix("concio.")
    path = word.replace(".", "/")
    return path + ".py" if (ROOT / f"{path}.py").exists() else path


def room_of(path: str) -> str:
    """Return the room of a path in the package: its directories, or the name of a file that stands alone."""
    return str(Path(path).parent) if "/" in path and path.endswith(".py") else path.removesuffix(".py")


@cache
def imports(path: Path, *, lazy: bool) -> tuple[str, ...]:
    """Return the modules of concio that a file imports; with ``lazy`` also those inside functions."""
    return tuple(_imports(path, lazy))


def _imports(path: Path, lazy: bool) -> Iterator[str]:
    for one in source(path).imports:
        if one.place == "typing" or (one.place == "function" and not lazy):
            continue
        if one.module == "concio":  # names that are taken from the package count as what they are
            yield from (
                f"concio.{name}" for name in one.names or sorted(n for o, n in source(path).attributes if o == "concio")
            )
        elif one.module.startswith("concio."):
            own = [f"{one.module}.{name}" for name in one.names]
            yield from [n for n in own if (ROOT.parent / f"{n.replace('.', '/')}.py").exists()] or [one.module]


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_rooms_import_only_from_earlier_rooms(path: Path) -> None:
    here = path.relative_to(ROOT).as_posix()
    if here == "__init__.py":
        assert not list(imports(path, lazy=True)), "the package itself imports nothing"
        return
    own = room_of(here)
    assert own in ORDER, f"there is no room '{own}' in the architecture"
    for module in imports(path, lazy=True):
        other = room_of(place(module))
        assert ORDER.index(other) <= ORDER.index(own), f"{own} imports {module}"


def test_every_view_is_of_a_class_that_there_is_and_made_by_what_there_is() -> None:
    classes = [re.match(r"class (\w+)", line) for path in MODULES for line in path.read_text().splitlines()]
    names = [found[1] for found in classes if found]
    for name, makers in VIEWS.items():
        for cls, maker in makers.items():
            assert names.count(cls) == 1, f"{name} of {cls}"
            module, _, function = maker.partition(":")
            assert callable(getattr(import_module(module), function))


def test_what_has_no_view_says_so() -> None:
    with pytest.raises(TypeError, match="float has no view 'plot'"):
        view(1.0, "plot")


def test_no_module_imports_itself_by_a_detour() -> None:
    graph = {path.relative_to(ROOT).as_posix(): sorted(place(m) for m in imports(path, lazy=True)) for path in MODULES}
    done: set[str] = set()

    def follow(at: str, trail: list[str]) -> None:
        assert at not in trail, "import cycle: " + " -> ".join([*trail[trail.index(at) :], at])
        if at not in done:
            for other in graph.get(at, []):
                follow(other, [*trail, at])
            done.add(at)

    for at in graph:
        follow(at, [])


@pytest.mark.parametrize("path", sorted((ROOT / "solvers").rglob("*.py")), ids=lambda p: f"{p.parent.name}/{p.name}")
def test_solvers_know_nothing_of_masonry(path: Path) -> None:
    allowed = tuple(
        f"concio.{room}" for room in ("problem", "errors", "arguments", "representation", "read_only", "solvers")
    )
    for module in imports(path, lazy=True):
        assert module.startswith(allowed), f"{path.name} imports {module}"


@pytest.mark.parametrize("path", sorted((ROOT / "kinematics").rglob("*.py")), ids=lambda p: p.name)
def test_kinematics_knows_numpy_and_errors_only(path: Path) -> None:
    for module in imports(path, lazy=True):
        known = ("concio.errors", "concio.kinematics", "concio.representation")
        assert module.startswith(known), f"{path.name} imports {module}"
    packages = {one.module for one in source(path).imports if not one.names}
    assert packages - {*sys.stdlib_module_names} <= {"numpy"}


def loaded_after(code: str) -> set[str]:
    """Return the names of the modules that are loaded after ``code`` in a fresh interpreter."""
    run = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    return set(run.stdout.split())


HEAVY = {"matplotlib", "vtk", "vtkmodules", "typer", "rich", "numpy", "scipy", "skfem", "pydantic", "ezdxf", "shapely"}


def test_importing_concio_loads_nothing_heavy() -> None:
    assert not loaded_after("import concio") & HEAVY
    assert not {m for m in loaded_after("import concio") if m.startswith("concio.")}


def test_the_command_line_starts_without_the_numerics() -> None:
    assert not loaded_after("import concio.cli.main") & (HEAVY - {"typer", "rich"})


def test_solving_loads_neither_figures_nor_the_command_line() -> None:
    code = "import concio\nconcio.solve(concio.running_bond_panel(courses=1, blocks=1, top_pressure=1.0)).summary()"
    loaded = loaded_after(code)
    assert not loaded & {"matplotlib", "vtk", "vtkmodules", "typer", "ezdxf"}
    assert not loaded & {"scipy.optimize", "scipy.spatial"}, "they take as long to load as a small model to solve"


def test_rigid_blocks_are_solved_without_finite_elements(tmp_path: Path) -> None:
    """Nor does the command line look for plugins of pydantic in the metadata of every installed package."""
    file = tmp_path / "column.toml"
    file.write_text('[column]\nwidth = 1.0\nheight = 2.0\nblocks = 2\nblock = "rigid"\n', encoding="utf-8")
    code = "import sys\nfrom concio.cli.main import main\nfrom contextlib import suppress\n"
    code += f"sys.argv = ['concio', 'run', '--quiet', {str(file)!r}]\nwith suppress(SystemExit):\n    main()\n"
    code += "import os\nassert os.environ['PYDANTIC_DISABLE_PLUGINS']"
    loaded = loaded_after(code)
    assert "concio.analysis.result" in loaded, "it was solved"
    assert "skfem" not in loaded


def test_every_public_name_has_a_home() -> None:
    for name in concio.__all__:
        assert getattr(concio, name) is not None
    homes = {name for names in concio._HOMES.values() for name in names}
    assert homes | {"__version__"} == set(concio.__all__)
    assert set(dir(concio)) >= homes | set(concio._NAMESPACES)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = concio.nothing


def test_files_have_names_of_their_own() -> None:
    """A file that is looked for is found by its name: only modules whose names are public may share theirs."""
    names = [path.name for path in MODULES if path.name != "__init__.py"]
    assert {name for name in names if names.count(name) > 1} <= {"bridges.py"}
