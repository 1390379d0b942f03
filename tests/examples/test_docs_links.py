"""Links between pages lead somewhere, every page is in a table of contents, every decision has a status."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
OF_DOCS = sorted(p for p in DOCS.rglob("*.md") if "_build" not in p.parts)
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *OF_DOCS]
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")


def prose(page: Path) -> str:
    """Return a page without its code."""
    return re.sub(r"```.*?```|`[^`]*`|\$[^$]*\$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for target in LINK.findall(prose(page)):
        if not re.match(r"[a-z]+:", target):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_every_page_is_in_a_table_of_contents() -> None:
    """But for the two that begin dated records, which are read by links alone."""
    listed = {DOCS / "decisions.md", DOCS / "research.md"}
    assert all(page.read_text(encoding="utf-8").startswith("---\norphan: true\n") for page in listed)
    for page in DOCS.rglob("*.md"):
        for block in re.findall(r"```\{toctree\}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
            for line in block.splitlines():
                if line and not line.startswith(":"):
                    listed |= {p.resolve() for p in page.parent.glob(f"{line}.md")}
    assert not set(OF_DOCS) - listed - {DOCS / "index.md"}


@pytest.mark.parametrize("page", sorted((DOCS / "decisions").glob("*.md")), ids=lambda p: p.stem[:4])
def test_every_decision_has_a_status(page: Path) -> None:
    assert re.search(r"^Status: \w+", page.read_text(encoding="utf-8"), re.MULTILINE)


def test_links_of_the_built_site_are_checked(tmp_path: Path) -> None:
    check = runpy.run_path(str(DOCS / "check_links.py"))["broken"]
    (tmp_path / "deep").mkdir()
    (tmp_path / "index.html").write_text('<h1 id="top"></h1><a href="deep/a.html#here"></a><img src="x.png">')
    text = '<p id="here"></p><a href="../index.html#gone"></a><a href="https://x.y"></a>'
    (tmp_path / "deep" / "a.html").write_text(text)
    assert check(tmp_path) == [
        "deep/a.html: ../index.html#gone: there is no such heading", "index.html: x.png: there is no such file"
    ]  # fmt: skip
