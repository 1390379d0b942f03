"""Symbols and units in the text of a page as print has them: indices, Greek letters, squares and powers of ten."""

from __future__ import annotations

import re

GREEK = {"alpha": "α", "zeta": "ζ", "kappa": "κ", "lambda": "λ", "gamma": "γ", "psi": "ψ"}

INDICES = "SLO|SLD|SLV|SLC|C0|C1|0|1|C|B|D|R|E|g|y|s|v|m|S|De|eZ"
"""What stands below in a symbol of a code, and only there."""

MADE = (
    (re.compile(r"(?<![\w_])([FTS])_C\*"), r"\1*<sub>C</sub>"),
    (re.compile(rf"(?<![\w&_])({'|'.join(GREEK)})_({INDICES})(?![\w_])"), lambda m: f"{GREEK[m[1]]}<sub>{m[2]}</sub>"),
    (re.compile(r"(?<![\w&_])alpha(?![\w_])"), "α"),
    (re.compile(rf"(?<![\w_])([adfATFSV])_({INDICES})(?![\w_])"), r"\1<sub>\2</sub>"),
    (re.compile(r"(?<=[A-Za-z])/(m|s)([23])(?!\w)"), lambda m: f"/{m[1]}{'²³'[int(m[2]) - 2]}"),
    (re.compile(r"(?<![\w.,])(\d+(?:[.,]\d+)?)e(-?)0*(\d+)(?!\w)"),
     lambda m: f"{m[1]}·10<sup>{'−' if m[2] else ''}{m[3]}</sup>"),
)  # fmt: skip
"""What is looked for in a text, and what it becomes."""

PLACES = re.compile(r"(<[^>]*>)")


def typeset(html: str) -> str:
    """Return HTML with the symbols of its text as print has them; tags and their attributes stay.

    Parameters
    ----------
    html : str
        Of a main part: no styles, no scripts.
    """
    parts = PLACES.split(html)
    return "".join(part if part.startswith("<") else _typeset(part) for part in parts)


def _typeset(text: str) -> str:
    for pattern, made in MADE:
        text = pattern.sub(made, text)
    return text
