"""Draw the pictures of the README, of the front page and of some pages: ``python docs/make_pictures.py``.

The pages show the lines that make each picture; these are run here as they stand there, so that picture and lines
cannot part. The facade of the README is ``examples/facade.toml``.
"""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import concio
from concio.report.page import report_html

HERE = Path(__file__).resolve().parent
PICTURES = HERE / "_static"
DOTS = 110
PAGES = ("index.md", "howto/cracks.md")


def page(name: str) -> list[str]:
    """Run the code blocks of a page; save the axes ``picture`` of each under the name of the image below it."""
    text = (HERE / name).read_text(encoding="utf-8")
    drawn = []
    below = r"```python\n((?:(?!```).)*?)```\n\n!\[[^\]]*\]\((?:\.\./)?_static/([\w.-]+)\)"
    for code, image in re.findall(below, text, re.DOTALL):
        names: dict[str, object] = {}
        exec(code, names)
        names["picture"].figure.savefig(PICTURES / image, dpi=DOTS)  # type: ignore[attr-defined]
        drawn.append(image)
    return drawn


def facade() -> list[str]:
    """Draw the facade of the examples: as it was read, its forces under weight and floors, and how it would fall."""
    model = concio.load(HERE.parent / "examples" / "facade.toml")
    result = concio.solve(model, factors={"live": 0.0})
    result.plot.model().figure.savefig(PICTURES / "facade_model.png", dpi=DOTS)
    result.plot.forces().figure.savefig(PICTURES / "facade.png", dpi=DOTS)
    limit = concio.limit(model, path=False, steps=False, search=False)
    limit.plot.mechanism().figure.savefig(PICTURES / "facade_limit.png", dpi=DOTS)
    return ["facade_model.png", "facade.png", "facade_limit.png"]


def report() -> list[str]:
    """Write the report of the front page: that of a cross vault on four piers, to be turned in the page."""
    vault = concio.cross_vault(span=5.0, ring=0.3, courses=8, block_length=0.7, block="rigid", friction=0.6)
    html = report_html(concio.solve(vault), figures=False)
    (PICTURES / "report.html").write_text(html, encoding="utf-8")
    return ["report.html"]


if __name__ == "__main__":
    for name in PAGES:
        print(*page(name))
    print(*facade(), *report())
