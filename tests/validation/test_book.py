"""The validation book knows every case, and every case has a test."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest
from validation_cases import CASES

HERE = Path(__file__).resolve().parent
BOOK = (HERE.parents[1] / "docs" / "validation" / "book.md").read_text(encoding="utf-8")


def test_every_module_is_a_case():
    modules = {p.stem for p in (HERE / "validation_cases").glob("*.py")} - {"__init__", "row"}
    assert modules == set(CASES)


@pytest.mark.parametrize("name", CASES)
def test_case_is_in_the_book_and_has_a_test(name):
    module = importlib.import_module(f"validation_cases.{name}")
    assert f"## {CASES[name]}\n" in BOOK
    assert module.SOURCE in BOOK
    assert hasattr(module, "figure") == (f"]({name}.svg)" in BOOK)
    assert any(
        f"from validation_cases import {name}\n" in p.read_text(encoding="utf-8") for p in HERE.glob("test_*.py")
    )
