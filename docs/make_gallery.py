"""Run the gallery examples and write docs/gallery.md with their pictures.

python docs/make_gallery.py
"""

from __future__ import annotations

import ast
import contextlib
import importlib.util
import io
import re
import textwrap
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


def as_typed(path: Path) -> str:
    """Return the code of an example as one would type it: the body of its ``main``, without what serves the tests.

    What only tests need is its last statement, the numbers returned; figures are drawn, not saved into a name given,
    and the other arguments of ``main`` are what they are unless stated otherwise.
    """
    source = path.read_text(encoding="utf-8")
    tree = ast.parse(source)
    main = next(node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "main")
    lines = source.splitlines()
    heads = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom | ast.Assign | ast.FunctionDef)]
    kept = [
        ast.get_source_segment(source, node) or "" for node in heads
        if node is not main and "__future__" not in ast.dump(node) and "pathlib" not in ast.dump(node)
    ]  # fmt: skip
    body: list[str] = []
    for node in main.body:
        if isinstance(node, ast.Return) or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            continue
        if isinstance(node, ast.If) and ast.unparse(node.test) == "figure":
            for inner in node.body:
                body += textwrap.dedent("\n".join(lines[inner.lineno - 1 : inner.end_lineno])).splitlines()
            continue
        body += textwrap.dedent("\n".join(lines[node.lineno - 1 : node.end_lineno])).splitlines()
    given = dict(zip([a.arg for a in reversed(main.args.args)], reversed(main.args.defaults), strict=False))
    typed = "\n".join(body)
    typed = re.sub(r'Path\(__file__\)\.with_name\(("[^"]*")\)', r"\1", typed)
    for name, default in given.items():
        if name != "figure":
            typed = re.sub(rf"(?<![.\w]){name}\b(?!=)", ast.unparse(default), typed)
    text = "\n".join([*kept, "", typed])
    return text.replace("savefig(figure", f'savefig("{path.stem[3:]}.png"')


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
        f"```py\n{as_typed(path)}\n```\n\n"
        f"It prints:\n\n```text\n{printed.getvalue().strip()}\n```\n"
    )


def anchor(title: str) -> str:
    """Return the address of a heading in its page, as the documentation makes it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def thumbnails(parts: list[str]) -> str:
    """Return a small picture of every section, each of which leads to it."""
    found = [re.search(r"## (.+)\n[\s\S]*?!\[[^\]]*\]\((\S+)\)", part) for part in parts]
    lines = "```{{image}} {1}\n:alt: \"{0}\"\n:target: \"#{2}\"\n:class: thumbnail\n```\n"
    return "".join(lines.format(m[1], m[2], anchor(m[1])) for m in found if m)


def main() -> None:
    """Write the gallery."""
    (HERE / "gallery").mkdir(exist_ok=True)
    plt.rcParams["savefig.dpi"] = 80
    parts = [page(path) for path in sorted(EXAMPLES.glob("[0-9]*.py"))]
    (HERE / "gallery.md").write_text(HEAD + thumbnails(parts) + "\n" + "\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
