"""Sphinx configuration; ``make docs`` treats every warning as an error."""

from __future__ import annotations

import re
from importlib.metadata import version as installed_version
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

project = "concio"
author = copyright = "The concio developers"
release = version = installed_version("concio")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["math.css"]
html_title = "concio"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = [("Keys", "params_style")]
templates_path: list[str] = []

NOTES = ("decisions", "research")
"""Dated records: read by links, outside the menu and the search."""

TAG = re.compile(r"\\tag\{([^}]*)\}")
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


def mathml(node: nodes.Element, block: bool) -> str:
    """Formula as MathML, which browsers draw by themselves: the pages need no network."""
    text = node.astext()
    tag = TAG.search(text)
    try:
        found = tex2mathml(TAG.sub("", text).strip(), as_block=block)
    except MathError as error:
        logging.getLogger(__name__).warning("formula not understood: %s (%s)", text, error, location=node)
        return f"<code>{text}</code>"
    if not block:
        return found
    number = f'<span class="number">({tag.group(1)})</span>' if tag else ""
    return f'<div class="formula">{found}{number}</div>'


def visit_math(self: Any, node: nodes.Element) -> None:
    """Write an inline formula."""
    self.body.append(mathml(node, False))
    raise nodes.SkipNode


def visit_math_block(self: Any, node: nodes.Element) -> None:
    """Write a displayed formula."""
    self.body.append(mathml(node, True))
    raise nodes.SkipNode


def skip_notes_in_search(app: Any) -> None:
    """Leave the dated records out of the search index."""
    if not hasattr(app.builder, "index_page"):
        return
    index_page = app.builder.index_page

    def index(pagename: str, doctree: Any, title: str) -> None:
        if pagename.split("/")[0] not in NOTES:
            index_page(pagename, doctree, title)

    app.builder.index_page = index


BACK = re.compile(r'<a class="viewcode-back" href="([^"#]*)#([^"]+)">\[docs\]</a>')


def back_to_the_description(app: Any, pagename: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Lead from the source of an object to its description, whether it is described by its short or its full name."""
    if not pagename.startswith("_modules/") or "body" not in context:
        return
    known = app.env.get_domain("py").objects
    module = pagename.removeprefix("_modules/").replace("/", ".")

    def link(match: re.Match[str]) -> str:
        full = module + match[2].removeprefix("concio")
        name = next((n for n in (match[2], full) if n in known), None)
        return "" if name is None else f'<a class="viewcode-back" href="{match[1]}#{name}">[docs]</a>'

    context["body"] = BACK.sub(link, context["body"])


def setup(app: Any) -> None:
    """Connect the docstring filter, the formulas and the search."""
    app.connect("html-page-context", back_to_the_description)
    app.connect("builder-inited", skip_notes_in_search)
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_math_block, None))
    app.connect("autodoc-process-docstring", protect_bars)
