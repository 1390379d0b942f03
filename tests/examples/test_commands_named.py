"""Every example and every template does what its first lines say: the commands named there are read and run."""

from __future__ import annotations

import ast
import re
import runpy
import shlex
import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest

import concio
import samples
from commands import run

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TEMPLATES = Path(concio.__file__).parent / "model" / "templates"
COMMAND = re.compile(r"^#\s+concio (?P<words>[a-z]+ \S+\.toml(?: \S+)*?)(?:\s{2,}.*)?$", re.MULTILINE)
DRAWN = {"facade.toml", "gate_from_a_drawing.toml"}
"""Files that need ezdxf."""
CODES = {"pushed_too_hard.toml": 3}
"""Exit codes that the files themselves announce; of all others 0."""
OPEN = {"assess": (0, 3, 4), "limit": (0, 4), "shake": (0, 4)}
"""Commands whose answer is one of several: an assessment may be not verified, or name what it could not check; a motion
that is asked for until a stated time may still go on there."""
QUICK_EXAMPLES = {
    "blocks_from_a_table.toml", "buttress.toml", "cracked_arch.toml", "eccentric_column.toml",
    "gate_from_a_drawing.toml", "flat_arch.toml",
    "leaning_stones_with_tie.toml", "pushed_too_hard.toml", "spreading_arch.toml", "semicircular_arch.toml",
}  # fmt: skip
QUICK_TEMPLATES = {"column", "blocks"}
DEAR = {"tower.toml", "walls.toml", "wall.toml", "cross_vault.toml", "facade_with_return.toml"}
"""Files whose limit, or whose assessment, takes longer than all else: asked for where every case is."""


def commands(text: str) -> list[str]:
    """Return the commands that the comments of a model file name."""
    return [found["words"] for found in COMMAND.finditer(text)]


def asked_for(command: str) -> bool:
    """Return whether a command is run: what takes long only where every case is drawn."""
    name, path, *_ = shlex.split(command)
    return samples.level == samples.EVERY or Path(path).name not in DEAR or name not in ("limit", "assess")


def follow(command: str) -> None:
    """Run a command that a file names, in the directory that holds the file."""
    name, *rest = shlex.split(command)
    file = Path(rest[0]).name
    if not asked_for(command):
        return
    code, out, err = run(name, *(file if word == rest[0] else word for word in rest))
    assert code in OPEN.get(name, (CODES.get(file, 0),)), f"{command}: exit code {code}\n{err}"
    assert "Error" not in err
    assert out.strip()


def marked(names: list[str], quick: set[str]) -> list[object]:
    return [pytest.param(n, marks=[] if n in quick else [pytest.mark.long]) for n in names]


@pytest.mark.usefixtures("blank_figures")
@pytest.mark.parametrize("name", marked(sorted(p.name for p in EXAMPLES.glob("*.toml")), QUICK_EXAMPLES))
def test_an_example_does_what_its_first_lines_name(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if name in DRAWN and not find_spec("ezdxf"):
        pytest.skip("drawings need ezdxf")
    place = tmp_path / "examples"
    shutil.copytree(EXAMPLES, place)
    monkeypatch.chdir(place)
    named = commands((place / name).read_text(encoding="utf-8"))
    assert named, "the file names no command"
    if not any(asked_for(command) for command in named):
        pytest.skip("its one command takes half a minute: make test-ensembles runs it")
    for command in named:
        assert Path(command.split()[1]).name == name
        follow(command)


@pytest.mark.usefixtures("blank_figures")
@pytest.mark.parametrize("kind", marked(sorted(p.stem for p in TEMPLATES.glob("*.toml")), QUICK_TEMPLATES))
def test_a_template_does_what_its_first_lines_name(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("new", kind)[0] == 0
    named = commands((tmp_path / f"{kind}.toml").read_text(encoding="utf-8"))
    assert len(named) >= 2
    for command in named:
        follow(command)


@pytest.mark.parametrize("name", sorted(p.name for p in EXAMPLES.glob("[0-9]*.py")))
def test_a_script_of_the_gallery_does_by_its_name_what_its_test_runs(name: str) -> None:
    """Each is run once, by test_gallery: ``main`` with its defaults, or a smaller study where that says the same."""
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    assert text.endswith('\n\n\nif __name__ == "__main__":\n    main()\n')
    (main,) = (node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name == "main")
    assert len(main.args.defaults) == len(main.args.args), "called without arguments"
    assert not main.args.kwonlyargs


@pytest.mark.skipif(not find_spec("ezdxf"), reason="drawings need ezdxf")
def test_the_script_that_draws_the_facade_runs_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    drawing = tmp_path / "examples" / "facade.dxf"
    drawing.unlink()
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(tmp_path / "examples" / "draw_facade.py"), run_name="__main__")
    assert drawing.stat().st_size > 0
    assert [p.stem for p in EXAMPLES.glob("[!0-9]*.py")] == ["draw_facade"], "another script would not be run"
