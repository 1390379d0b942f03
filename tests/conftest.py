"""Shared by all tests. Its place also puts this directory on the import path, for helpers such as ``rigid_walls``."""

from __future__ import annotations

import functools
import gc
import importlib
import importlib.util
import io
import os
from pathlib import Path
from typing import Any

import pytest
import typer.testing
from hypothesis import settings

import samples


def pytest_configure(config: pytest.Config) -> None:
    """Draw fewer cases where the long tests are left out, and the same ones in every run unless fresh ones are wanted.

    A run then judges the code, not the draw, and what passed here passes elsewhere; ``make fresh`` looks for new cases.
    ``make test-ensembles`` draws all that were ever drawn of each property, the same ones every time.
    """
    cases = os.environ.get("CONCIO_CASES", "same")
    quick = "not long" in config.getoption("markexpr").replace("long or not long", "")
    samples.level = samples.QUICK if quick else samples.WHOLE if cases == "same" else samples.EVERY
    # The runner of typer makes all commands anew at every call, which took six parts in a hundred of all tests.
    typer.testing._get_command = functools.cache(typer.testing._get_command)
    # No deadline: a busy machine is not a fault of what is tested.
    settings.register_profile("same", deadline=None, derandomize=True)
    settings.register_profile("all", deadline=None, derandomize=True)
    settings.register_profile("fresh", deadline=None, print_blob=True)
    settings.load_profile(cases)
    # Hypothesis also draws constants that it reads in the modules loaded so far: with them, the draws of a test would
    # depend on the tests that the same worker ran before it. (Releases that draw none have no such module or function.)
    if importlib.util.find_spec("hypothesis.internal.conjecture.providers") is not None:
        providers: Any = importlib.import_module("hypothesis.internal.conjecture.providers")
        if hasattr(providers, "is_local_module_file"):
            providers.is_local_module_file = lambda path: False


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the validation book, whose tests are the longest: workers that share them out end together."""
    items.sort(key=lambda item: "validation" not in item.path.parts)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Spare the collector of garbage the thousands of tests it would look at again and again: a tenth of the time."""
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


@pytest.fixture
def blank_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compose figures, but leave their files empty: for tests that look at the places of files, not at figures."""

    def savefig(_: object, place: Path | str | io.BytesIO, **options: Any) -> None:
        if not isinstance(place, io.BytesIO):
            Path(place).write_bytes(b"")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", savefig)
