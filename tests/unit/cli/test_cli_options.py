"""Options mean one thing in every command, every help names the exit codes, and ``--json`` keeps to its schema."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import jsonschema
import pytest
import typer.main
from typer.testing import CliRunner

import concio
from commands import run
from concio.cli.main import EXIT_CODES, app
from concio.cli.options import measured
from concio.errors import InputError
from pillars import pillar, sideways

COMMANDS = typer.main.get_command(app).commands
WALL = """
[wall]
length = 0.9
height = 0.6
block_size = [0.3, 0.2]
block = "rigid"
unit_weight = 20
friction = 0.6
horizontal = 0.1
"""
CELL = """
[cell]
bond = "running"
block_size = [250, 55]
block = "rigid"
friction = 0.6
"""


@pytest.fixture
def wall(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "wall.toml"
    path.write_text(WALL)
    return path


def test_a_short_option_stands_for_one_long_one() -> None:
    long = defaultdict(set)
    for command in COMMANDS.values():
        for option in command.params:
            names = [n for n in option.opts if n.startswith("--")]
            for short in (n for n in option.opts if not n.startswith("--") and n.startswith("-")):
                long[short].add(names[0])
    assert {short: names for short, names in long.items() if len(names) > 1} == {}


def test_options_of_one_name_say_the_same() -> None:
    said = defaultdict(set)
    for command in COMMANDS.values():
        for option in command.params:
            said[option.opts[0]].add((option.help, *option.opts[1:]))
    said["file"] = {(p.help,) for name, c in COMMANDS.items() if name not in ("new", "window") for p in c.params
                    if p.opts[0] == "file"}  # fmt: skip
    for name in ("--json", "--quiet", "--units", "--engine", "file"):
        assert len(said[name]) == 1, said[name]


def test_commands_that_print_json_can_be_quiet_and_those_that_solve_take_units() -> None:
    for name, command in COMMANDS.items():
        options = {o for p in command.params for o in p.opts}
        assert ("--json" in options) == ("--quiet" in options), name
        if name in ("run", "path", "limit", "push", "shake", "cell", "continuum", "assess", "compare", "check"):
            assert "--units" in options, name


@pytest.mark.long
def test_every_help_names_the_exit_codes() -> None:
    for name in COMMANDS:
        code, out, _ = run(name, "--help")
        assert code == 0
        assert "Exit codes" in out
    assert "3 it is shown not to hold" in EXIT_CODES


def test_a_model_comes_from_standard_input(wall: Path) -> None:
    found = CliRunner().invoke(app, ["run", "-", "--json"], input=WALL)
    assert found.exit_code == 0
    told, same = json.loads(found.stdout), json.loads(run("run", wall, "--json")[1])
    assert told["verdict"] == same["verdict"]
    for text, word in (("", "empty"), ("[wall", "standard input, last line")):
        found = CliRunner().invoke(app, ["run", "-"], input=text)
        assert found.exit_code == 2
        assert word in found.stderr
    faulty = CliRunner().invoke(app, ["check", "-"], input=WALL + "\n[site]\nsoil = 'F'\nhazard.SLV = {a_g = 0.2}\n")
    assert faulty.exit_code == 2
    assert "no soil 'F'" in faulty.stderr
    found = CliRunner().invoke(app, ["study", "-"], input=WALL)
    assert found.exit_code == 2
    assert "--out" in found.stderr


def test_quiet_prints_nothing(wall: Path) -> None:
    for command in (("run",), ("check",), ("compare", "--methods", "lemke,interior-point")):
        code, out, err = run(command[0], wall, *command[1:], "--quiet")
        assert (code, out, err) == (0, "", "")
    code, out, _ = run("run", wall)
    assert code == 0
    assert out, "the next command prints again"


def test_the_quick_limit_is_the_bound_alone(wall: Path) -> None:
    code, out, err = run("limit", wall, "--quick", "--json")
    assert code in (0, 4), err
    told = json.loads(out)
    assert told["associated_multiplier"] > 0
    assert told["verdict"]["outcome"] == "holds"
    assert "neither a path nor load steps" in " ".join(told["verdict"]["unchecked"])
    assert "contact states" not in " ".join(told["verdict"]["limits"]), "none were sought"


@pytest.mark.parametrize(
    "arguments",
    [("run",), ("check",), ("compare", "--methods", "lemke,interior-point"), ("run", "--factor", "dead=0"), ("path",),
     pytest.param(("compare",), marks=pytest.mark.long)],
)
def test_output_keeps_to_its_schema(arguments: tuple[str, ...], wall: Path) -> None:
    schema = json.loads(run("schema", "output")[1])
    told = json.loads(run(arguments[0], wall, *arguments[1:], "--json")[1])
    jsonschema.validate(told, schema)
    assert told["format_version"] == 1


def test_an_error_keeps_to_the_schema_too(wall: Path) -> None:
    schema = json.loads(run("schema", "output")[1])
    told = json.loads(run("run", "missing.toml", "--json")[1])
    jsonschema.validate(told, schema)
    assert told["status"] == "error"
    for name in ("what", "kind", "exit_code"):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({k: v for k, v in told.items() if k != name}, schema)


@pytest.mark.long
@pytest.mark.parametrize("asked", [("prove", "--force"), ("run", "--method", "exhaustive"), ("limit",)])
def test_a_process_that_prints_json_prints_nothing_else(asked: tuple[str, ...], tmp_path: Path) -> None:
    """A linear programming code of its own printed its name first, which a runner inside Python does not see."""
    file = tmp_path / "pillar.toml"
    file.write_text(pillar(sideways(0.1)))
    command = [sys.executable, "-m", "concio", asked[0], str(file), "--json", *asked[1:]]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["verdict"]["outcome"] == "holds"
    assert not done.stderr


def test_numbers_of_a_limit_are_printed_as_they_are_found_where_there_is_no_terminal(wall: Path) -> None:
    code, out, err = run("limit", wall, "--quick")
    assert code == 0
    size, first = err.splitlines()[:2]
    assert size.startswith("so far:  model")
    assert f" {len(concio.assemble(concio.load(wall)).pairs)} contact pairs" in size, "the size of the task comes first"
    assert first.startswith("so far:  associated bound")
    number = first.split()[4]
    assert float(number) > 0
    assert first.removeprefix("so far:") in out.splitlines(), "the answer repeats it"
    assert run("limit", wall, "--quick", "--quiet")[1:] == ("", "")
    assert run("limit", wall, "--quick", "--json")[2] == ""


LENGTHS = [
    ("push wall.toml --until 20", "--until", "20 mm"),
    ("push wall.toml --step 20", "--step", "20 mm"),
    ("push wall.toml --point 'c02-b01,450,500 mm'", "--point", "450 mm"),
    ("path wall.toml --point 'c02-b01,450 mm,500 mm' --until 3", "--until", "3 mm"),
    ("continuum wall.toml --mesh-size 300", "--mesh-size", "300 mm"),
    ("cell wall.toml --stress yy=-1", "--stress", "-1 N/mm2"),
]


@pytest.mark.parametrize(("command", "where", "write"), LENGTHS)
def test_a_bare_length_of_the_command_line_is_not_read_in_metres_beside_a_file_in_millimetres(
    wall: Path, command: str, where: str, write: str
) -> None:
    body = CELL if command.startswith("cell") else WALL
    wall.write_text('[units]\nlength = "mm"\nforce = "N"\n' + body)
    answer = CliRunner().invoke(app, shlex.split(command))
    assert answer.exit_code == 2
    assert f"{where}: '{write.split()[0]}' has no unit" in answer.stderr
    assert f"write '{write}'" in answer.stderr
    assert measured("0", "length", where, wall) == 0.0
    assert measured("2 cm", "length", where, wall) == 0.02
    assert measured("20", "number", where, wall) == 20.0
    wall.write_text(body)
    assert measured("20", "length", where, wall) == 20.0
    with pytest.raises(InputError, match="standard input"):
        measured("20", "length", where, Path("-"))
