"""Pictures of a report as docx fit between the margins and keep their shape."""

from __future__ import annotations

import base64
import io
from pathlib import Path

import pytest

from concio.report.docx_file import WIDTH, write_docx


@pytest.mark.parametrize(("wide", "high"), [(100, 1000), (3000, 500), (60, 40), (1500, 1500)])
def test_a_picture_fits_and_keeps_its_shape(tmp_path: Path, wide: int, high: int) -> None:
    docx = pytest.importorskip("docx")
    image = pytest.importorskip("PIL.Image")
    dots = io.BytesIO()
    image.new("RGB", (wide, high), "white").save(dots, "png", dpi=(96, 96))
    data = base64.b64encode(dots.getvalue()).decode()
    path = write_docx(f'<main><h1>Wall</h1><p><img src="data:image/png;base64,{data}"></p></main>', tmp_path / "r.docx")
    (shape,) = docx.Document(str(path)).inline_shapes
    natural = wide / 96 * 2.54, high / 96 * 2.54
    share = min(WIDTH / natural[0], 9.0 / natural[1], 1.0)
    assert shape.width.cm == pytest.approx(share * natural[0], rel=5e-3)
    assert shape.height.cm == pytest.approx(share * natural[1], rel=5e-3)
