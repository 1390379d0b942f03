"""What pages and docstrings name exists: files of the project, modules, names, decisions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import concio

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = Path(concio.__file__).parent
DECISIONS = {p.stem[:4]: p.stem for p in (ROOT / "docs" / "decisions").glob("*.md")}
PAGES = sorted({*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")} - {ROOT / "CHANGELOG.md"})
TREE = {p.relative_to(PACKAGE).as_posix() for p in PACKAGE.rglob("*")}
SCRIPTS = {p.name for folder in ("src", "tests", "benchmarks", "docs") for p in (ROOT / folder).rglob("*.py")}

ROLE = re.compile(r":(?:mod|class|func|meth|data|attr|exc):`[~!]?(concio[\w.]+)`")
QUOTED = re.compile(r"`(concio\.[a-z_]\w*(?:\.\w+)*)(?:\([^`]*)?`")
FILE = re.compile(r"`([\w./-]+?(?:\.py|/))`")
NUMBER = re.compile(r"\bdecision (\d{4}|\d{1,3})\b|decisions/(\d{4})", re.IGNORECASE)
TO_BE_WRITTEN = re.compile(r"\byour_")


@cache
def text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def defined(module: str, name: str) -> bool:
    """Return whether a module of the package defines a name, or hands it on."""
    here = text(PACKAGE / module)
    forms = (rf"\s*(?:def|class) {name}\b", rf"\s*(?:self\.)?{name}\s*[:=]", rf"from .* import .*\b{name}\b")
    return re.search(rf"^(?:{'|'.join(forms)})", here, re.MULTILINE) is not None


def known(reference: str) -> bool:
    """Return whether ``concio.a.b.Name.attribute`` is there."""
    parts = reference.split(".")[1:]
    at = ""
    while parts and f"{at}{parts[0]}" in TREE:
        at += parts.pop(0) + "/"
    if parts and f"{at}{parts[0]}.py" in TREE:
        module = f"{at}{parts.pop(0)}.py"
    elif at:
        module = f"{at}__init__.py"
    else:
        return parts[0] in concio._HOME
    return all(defined(module, name) for name in parts[:2])


def missing(page: Path, pattern: re.Pattern[str]) -> Iterator[str]:
    yield from sorted({name for name in pattern.findall(text(page)) if not known(name)})


@pytest.mark.parametrize("room", sorted({p.parent for p in PACKAGE.rglob("*.py")}), ids=lambda p: p.name)
def test_names_in_docstrings_are_there(room: Path) -> None:
    assert not {path.name: found for path in room.glob("*.py") if (found := list(missing(path, ROLE)))}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_names_and_files_on_pages_are_there(page: Path) -> None:
    assert not list(missing(page, QUOTED))
    places = (ROOT, PACKAGE, PACKAGE / "solvers", ROOT / "tests", ROOT / "tests" / "validation")
    named = {name for name in FILE.findall(text(page)) if not TO_BE_WRITTEN.search(name)}
    assert not {n for n in named if n not in SCRIPTS and not any((place / n).exists() for place in places)}


def test_rooms_on_their_page_are_those_of_the_package() -> None:
    """The tree names every room of the package, and no other."""
    tree = re.search(r"```text\n(.*?)```", text(ROOT / "docs" / "contributing" / "rooms.md"), re.DOTALL)
    assert tree is not None
    told = set(re.findall(r"(\w+)/", tree[1])) - {"src", "concio"}
    outer = {p.name for p in PACKAGE.iterdir() if (p / "__init__.py").exists()}
    inner = {p.name for p in (PACKAGE / "solvers").iterdir() if (p / "__init__.py").exists()}
    assert outer | inner <= told <= {p.name for p in PACKAGE.rglob("*")}
    assert len(tree[1].splitlines()) == 17  # "src/concio/", fifteen rooms, one of them in two lines


@pytest.mark.parametrize("number", sorted(DECISIONS))
def test_decisions_name_decisions_that_are_kept(number: str) -> None:
    page = text(ROOT / "docs" / "decisions" / f"{DECISIONS[number]}.md")
    assert page.startswith(f"# {number} ")
    status = re.search(r"^Status: (.*)$", page, re.MULTILINE)
    assert status is not None
    for other in (*re.findall(r"\b(\d{4})\b", status[1]), *("".join(m) for m in NUMBER.findall(page))):
        assert other in DECISIONS
        if f"replaced by {other}" in status[1]:
            assert number in text(ROOT / "docs" / "decisions" / f"{DECISIONS[other]}.md")


def test_decisions_that_code_names_are_kept() -> None:
    for folder in ("src", "tests", "benchmarks"):
        for path in (ROOT / folder).rglob("*.py"):
            for named in NUMBER.findall(text(path)):
                assert "".join(named) in DECISIONS, path.name


def test_the_api_page_names_every_public_name_and_no_other() -> None:
    page = text(ROOT / "docs" / "api.md")
    told = set(re.findall(r"^\.\. auto\w+:: concio\.(\w+)$", page, re.MULTILINE))
    assert told == set(concio.__all__) - {"__version__"}
