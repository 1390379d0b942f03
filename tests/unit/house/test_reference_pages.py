"""The pages of keys and commands are those of the code, and every key of a model file says what it is."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

from concio.cli.main import COMMANDS
from concio.model.file.descriptions import parameters
from concio.model.file.file_table import json_schema
from concio.model.file.tables import JointTable
from concio.model.materials import JointLaw

DOCS = Path(__file__).resolve().parents[3] / "docs"


def script() -> Any:
    """Return the script that writes the pages."""
    spec = importlib.util.spec_from_file_location("make_references", DOCS / "make_references.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_pages_are_what_the_script_writes() -> None:
    for name, text in script().pages().items():
        assert (DOCS / "reference" / name).read_text(encoding="utf-8") == text, "run python docs/make_references.py"


def test_every_command_and_every_option_is_on_the_page() -> None:
    page = script().commands()
    for command in COMMANDS:
        assert f"## `concio {command.__name__}`" in page
    for option in ("--out, -o", "--units", "--quiet, -q", "--factor, -f"):
        assert f"`{option}`" in page


def test_every_key_of_a_model_file_says_what_it_is() -> None:
    schema = json_schema()
    for name, table in [("file", schema), *schema["$defs"].items()]:
        for key, entry in table.get("properties", {}).items():
            assert entry.get("description"), f"{name}: {key}"


def test_descriptions_are_those_of_the_arguments() -> None:
    told = parameters(JointLaw)
    keys = json_schema()["$defs"]["JointTable"]["properties"]
    assert set(JointTable.model_fields) <= set(told)
    for key in ("compressive_strength", "normal_stiffness"):
        assert keys[key]["description"] == told[key]


def test_arguments_that_are_those_of_another_function_are_described_by_it() -> None:
    tower, walls, rubble = (json_schema()["$defs"][name]["properties"] for name in ("tower", "walls", "rubble"))
    assert tower["headers"]["description"] == walls["headers"]["description"]
    assert not any("As in" in entry["description"] for entry in (*tower.values(), *rubble.values()))


@pytest.mark.parametrize("value", [None, [], "", {}])
def test_what_is_nothing_is_no_default(value: object) -> None:
    assert script().shown(value) == ""
