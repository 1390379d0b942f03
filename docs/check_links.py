"""Check the links inside the built documentation: every page, picture, file and heading that a page names is there.

python docs/check_links.py docs/_build/html
"""

from __future__ import annotations

import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LINKS = {"a": "href", "link": "href", "img": "src", "script": "src", "iframe": "src", "source": "src"}


class Page(HTMLParser):
    """The links and the anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what a tag names and is named."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if LINKS.get(tag) in given:
            self.links.append(given[LINKS[tag]])


@cache
def page(path: Path) -> Page:
    """Read a page."""
    return Page(path.read_text(encoding="utf-8"))


def broken(root: Path) -> list[str]:
    """Return the links of all pages under ``root`` that lead nowhere, each with its page."""
    found = []
    for path in sorted(root.rglob("*.html")):
        if "_static" in path.relative_to(root).parts:  # reports: one file, without links to others
            continue
        for link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or not (parts.path or parts.fragment):
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file():
                found.append(f"{path.relative_to(root)}: {link}: there is no such file")
            elif parts.fragment and target.suffix == ".html" and unquote(parts.fragment) not in page(target).anchors:
                found.append(f"{path.relative_to(root)}: {link}: there is no such heading")
    return found


def main() -> int:
    """Print what is broken; return 1 where something is."""
    root = Path(sys.argv[1]).resolve()
    if not (root / "index.html").is_file():
        print(f"{root} holds no built documentation", file=sys.stderr)
        return 1
    wrong = broken(root)
    print(*wrong, f"{len(wrong)} broken links", sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
