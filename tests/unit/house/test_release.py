"""What a release rests on: one version everywhere, and a source distribution with every file of the repository."""

from __future__ import annotations

import re
import subprocess
import tomllib
from datetime import date
from fnmatch import fnmatch
from pathlib import Path

import pytest

import concio

ROOT = Path(__file__).resolve().parents[3]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_version_is_one() -> None:
    declared = tomllib.loads(text("pyproject.toml"))["project"]["version"]
    cited = re.search(r"^version: (\S+)$", text("CITATION.cff"), re.MULTILINE)
    assert cited is not None
    assert concio.__version__ == declared == cited[1]


def test_the_changelog_has_the_version_and_its_day() -> None:
    headings = re.findall(r"^## \[(.+?)\](?: - (\S+))?$", text("CHANGELOG.md"), re.MULTILINE)
    assert headings[0] == ("Unreleased", "")
    assert headings[1][0] == concio.__version__
    assert date.fromisoformat(headings[1][1]) >= date(2026, 1, 1)


def taken(name: str) -> bool:
    """Return whether the source distribution takes a file of the repository along."""
    always = ("pyproject.toml", "README.md", "LICENSE", "MANIFEST.in")
    if name in always or name.startswith("src/concio/"):
        return True
    for line in text("MANIFEST.in").splitlines():
        word, *patterns = line.split()
        if word == "include" and any(fnmatch(name, pattern) for pattern in patterns):
            return True
        if word == "graft" and any(name.startswith(f"{folder}/") for folder in patterns):
            return True
    return False


def test_the_source_distribution_has_every_file_of_the_repository() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("this is not a clone")
    assert not [name for name in listed.stdout.splitlines() if not taken(name)]
