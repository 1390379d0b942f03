"""A report as a document of a word processor (docx), made of its HTML: headings, text, lists, tables, pictures.

It needs python-docx (MIT), which comes with ``pip install "concio[docx]"``. What only a screen shows stays out.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from typing import Any

from concio.errors import InputError

WIDTH, HALF = 17.0, 8.0
"""Width of the text on A4, and of pictures that stand in pairs [cm]."""

SMALL = 8
"""Size of the letters in tables [pt]."""

SKIPPED = ("style", "script", "head", "button", "canvas")
LINES = ("p", "li", "h1", "h2", "h3", "figcaption", "div", "header", "section", "footer", "main", "span")


def write_docx(html: str, path: Path | str) -> Path:
    """Write the HTML of a report, with pictures of dots, as a docx file.

    Parameters
    ----------
    html : str
    path : str or Path

    Raises
    ------
    InputError
        python-docx is not installed.
    """
    reader = _Reader(docx_library())
    reader.feed(html)
    reader.close()
    path = Path(path)
    reader.document.save(str(path))
    return path


def docx_library() -> Any:
    """Return the library that writes docx files.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        return import_module("docx")
    except ImportError:
        msg = "docx files need the package python-docx"
        raise InputError(msg, hint='pip install "concio[docx]", or write the report as HTML and print it') from None


class _Reader(HTMLParser):
    """Reads HTML and writes a document."""

    def __init__(self, docx: Any) -> None:
        super().__init__(convert_charrefs=True)
        self.docx, self.document = docx, docx.Document()
        self.centimetres, self.points = import_module("docx.shared").Cm, import_module("docx.shared").Pt
        page = self.document.sections[0]
        page.page_width, page.page_height = self.centimetres(21.0), self.centimetres(29.7)
        page.left_margin = page.right_margin = self.centimetres(2.0)
        page.top_margin = page.bottom_margin = self.centimetres(1.8)
        style = self.document.styles["Normal"]
        style.font.size, style.font.name = self.points(10), "Calibri"
        self.skipped, self.half = 0, False
        self.line: Any = None
        self.marks: list[str] = []
        self.rows: list[list[list[tuple[str, tuple[str, ...]]]]] | None = None
        self.header_rows = 0

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        """Begin what a tag begins."""
        given = dict(attrs)
        if tag in SKIPPED:
            self.skipped += 1
        elif tag == "table":
            self.rows, self.header_rows = [], 0
        elif self.rows is not None:
            if tag == "tr":
                self.rows.append([])
            elif tag in ("td", "th"):
                self.rows[-1].append([])
            elif tag == "br":
                self.handle_data("\n")
            elif tag in ("b", "sub", "sup"):
                self.marks.append(tag)
        elif tag in ("h1", "h2", "h3"):
            self.line = self.document.add_heading(level=int(tag[1]))
        elif tag == "li":
            self.line = self.document.add_paragraph(style="List Bullet")
        elif tag == "figure":
            self.half = given.get("class") == "half"
        elif tag == "img":
            self._picture(given.get("src") or "")
        elif tag in ("b", "sub", "sup"):
            self.marks.append(tag)
        elif tag in LINES:
            self.line = None

    def handle_endtag(self, tag: str) -> None:
        """End what a tag ends."""
        if tag in SKIPPED:
            self.skipped -= 1
        elif tag == "thead" and self.rows is not None:
            self.header_rows = len(self.rows)
        elif tag == "table" and self.rows is not None:
            self._table(self.rows)
            self.rows, self.line = None, None
        elif tag in ("b", "sub", "sup") and self.marks:
            self.marks.pop()
        elif tag in LINES and tag != "span":
            self.line = None

    def handle_data(self, data: str) -> None:
        """Add text to the cell or the line that is open."""
        if self.skipped:
            return
        if self.rows is not None:
            if self.rows and self.rows[-1]:
                self.rows[-1][-1].append((data, tuple(self.marks)))
            return
        if self.line is None:
            if not data.strip():
                return
            self.line = self.document.add_paragraph()
        self._run(self.line, data, self.marks)

    def _run(self, line: Any, text: str, marks: Sequence[str], size: int | None = None) -> None:
        run = line.add_run(text)
        run.bold = "b" in marks or None
        run.font.subscript, run.font.superscript = "sub" in marks or None, "sup" in marks or None
        if size:
            run.font.size = self.points(size)

    def _table(self, rows: list[list[list[tuple[str, tuple[str, ...]]]]]) -> None:
        """Add a table; its head is repeated on every page, and no row is broken."""
        width = max((len(row) for row in rows), default=0)
        if not width:
            return
        table = self.document.add_table(rows=len(rows), cols=width)
        table.style = "Table Grid" if self.header_rows else "Normal Table"
        tags = import_module("docx.oxml").OxmlElement
        for k, (row, made) in enumerate(zip(rows, table.rows, strict=True)):
            properties = made._tr.get_or_add_trPr()
            properties.append(tags("w:cantSplit"))
            if k < self.header_rows:
                properties.append(tags("w:tblHeader"))
            for cell, place in zip(row, made.cells, strict=False):
                line = place.paragraphs[0]
                line.paragraph_format.space_after = self.points(0)
                for text, marks in cell:
                    self._run(line, text, (*marks, "b") if k < self.header_rows else marks, SMALL)
        self.document.add_paragraph().paragraph_format.space_after = self.points(0)

    def _picture(self, source: str) -> None:
        """Add a picture of dots that keeps with the line under it."""
        head, _, data = source.partition(",")
        if "png" not in head:
            msg = "a picture of this report is a drawing of lines, which a docx file cannot hold"
            raise InputError(msg, hint="make the report with pictures = 'png'")
        line = self.document.add_paragraph()
        line.alignment = 1
        line.paragraph_format.keep_with_next = True
        shape = line.add_run().add_picture(io.BytesIO(base64.b64decode(data)))
        wide, high = self.centimetres(HALF if self.half else WIDTH), self.centimetres(9.0)
        share = min(wide / shape.width, high / shape.height, 1.0)
        shape.width, shape.height = int(shape.width * share), int(shape.height * share)
        self.line = None
