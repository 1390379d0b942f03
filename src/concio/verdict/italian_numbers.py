"""Numbers of sentences as Italian writes them: a decimal comma, thin spaces between thousands, semicolons in points."""

from __future__ import annotations

import re

QUOTED = re.compile(r"((?<!\w)'[^']*'(?!\w))")
"""Names in sentences; an Italian apostrophe follows a letter."""
DECIMAL = re.compile(r"(?<![\w.,])(?<!concio )(\d{1,3}(?:,\d{3})+|\d+)(\.\d+)?(?=e[+-]?\d|(?!\w|\.\d))")
POINT = re.compile(r"\((-?[\d.e+-]+(?:, -?[\d.e+-]+)+)\)")


def commas(text: str) -> str:
    """Return a text with its numbers as Italian writes them, names in quotes as they are."""
    parts = QUOTED.split(text)
    return "".join(part if part.startswith("'") and k % 2 else _commas(part) for k, part in enumerate(parts))


def _commas(text: str) -> str:
    text = POINT.sub(lambda match: f"({match[1].replace(', ', '; ')})", text)
    return DECIMAL.sub(lambda match: match[1].replace(",", "\u2009") + (match[2] or "").replace(".", ","), text)
