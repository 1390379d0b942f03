"""Run the gallery examples and write docs/gallery.md with their pictures.

python docs/make_gallery.py
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "examples"

HEAD = """# Gallery

Written by `docs/make_gallery.py`. Each example is a script in `examples/`, and a test in
`tests/examples/test_gallery.py` that runs it and looks at its numbers.

"""


def page(path: Path) -> str:
    """Run one example; return its section."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        module.main(HERE / "gallery" / f"{path.stem}.png")
    plt.close("all")
    title, _, text = (module.__doc__ or "").strip().partition("\n\n")
    return (
        f"## {title.rstrip('.')}\n\n{text}\n\n![{title}](gallery/{path.stem}.png)\n\n"
        f"```{{literalinclude}} ../examples/{path.name}\n:language: python\n:pyobject: main\n```\n\n"
        f"It prints:\n\n```text\n{printed.getvalue().strip()}\n```\n"
    )


def main() -> None:
    """Write the gallery."""
    (HERE / "gallery").mkdir(exist_ok=True)
    plt.rcParams["savefig.dpi"] = 80
    parts = [page(path) for path in sorted(EXAMPLES.glob("[0-9]*.py"))]
    (HERE / "gallery.md").write_text(HEAD + "\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
