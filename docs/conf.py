"""Sphinx configuration; ``make docs`` treats every warning as an error."""

from __future__ import annotations

import re
from importlib.metadata import version as installed_version
from typing import Any

project = "concio"
author = "The concio developers"
release = version = installed_version("concio")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax", "sphinx.ext.viewcode"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "concio"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = [("Keys", "params_style")]
templates_path: list[str] = []

BAR = re.compile(r"(?<![\\`])\|")
MATH = re.compile(r":math:`[^`]*`|``[^`]*``|`[^`]*`")


def protect_bars(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Keep the bars of |t_t| in docstrings from being read as substitutions; mathematics stays as it is."""
    indent: int | None = None
    for i, line in enumerate(lines):
        depth = len(line) - len(line.lstrip())
        if indent is not None and line.strip() and depth <= indent:
            indent = None
        if ".. math::" in line:
            indent = depth
        if indent is None:
            kept = MATH.findall(line)
            plain = [BAR.sub(r"\\|", part) for part in MATH.split(line)]
            lines[i] = "".join(a + b for a, b in zip(plain, [*kept, ""], strict=True))


def setup(app: Any) -> None:
    """Connect the docstring filter."""
    app.connect("autodoc-process-docstring", protect_bars)
