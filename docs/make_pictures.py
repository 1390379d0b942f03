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
    """Draw the facade of the examples: its forces under its own weight and the floors, and how it would fall."""
    model = concio.load(HERE.parent / "examples" / "facade.toml")
    result = concio.solve(model, factors={"live": 0.0})
    result.plot.forces().figure.savefig(PICTURES / "facade.png", dpi=DOTS)
    return ["facade.png"]


if __name__ == "__main__":
    for name in PAGES:
        print(*page(name))
    print(*facade())
