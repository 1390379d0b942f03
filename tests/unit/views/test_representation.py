"""What objects say of themselves: a line or some, whatever they hold, and a picture in notebooks."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pytest

import concio
from concio.representation import brief, short_repr

PUSHED = """
[column]
width = 0.3
height = 1.2
blocks = 3
block = { E = "20 GPa", unit_weight = 20 }
friction = 0.9
horizontal = 1.0
mesh_size = 0.15
"""

LINES, SIGNS = 16, 1600
"""No object says more than this."""


@pytest.fixture(scope="module")
def held() -> dict[str, object]:
    """What a user gets from the public functions."""
    model = concio.loads(PUSHED)
    stages = [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})]
    return {
        "model": model,
        "assembly": concio.assemble(model),
        "problem": concio.assemble(model).problem(),
        "result": concio.solve(model, factors={"live": 0.1}),
        "failed": concio.solve(model, on_failure="return"),
        "path": concio.run_path(model, stages),
        "limit": concio.limit(model, path=True, friction=True),
        "load margin": concio.load_margin(model),
        "friction": concio.friction_margin(model, factor=0.1),
        "thrust": concio.thrust_line(
            concio.solve(concio.loads("[arch]\nspan = 2\nring = 0.3\nvoussoirs = 7\nfriction = 0.7\nunit_weight = 20"))
        ),
        "space": concio.extrude(model, 0.4),
    }


def reached(thing: object, name: str, seen: dict[int, tuple[str, object]]) -> None:
    """Collect what hangs on an object by its fields and properties: all that is of the project."""
    if id(thing) in seen or sum(type(other) is type(thing) for _, other in seen.values()) > 4:
        return
    if isinstance(thing, tuple | list) and thing and type(thing[0]).__module__.startswith("concio"):
        reached(thing[0], f"{name}[0]", seen)
        return
    if not type(thing).__module__.startswith("concio") or isinstance(thing, type):
        return
    seen[id(thing)] = (name, thing)
    if dataclasses.is_dataclass(thing):
        for f in dataclasses.fields(thing):
            reached(getattr(thing, f.name), f"{name}.{f.name}", seen)
    for key in dir(type(thing)):
        if not key.startswith("_") and isinstance(getattr(type(thing), key), property | cached_property):
            try:
                value = getattr(thing, key)
            except concio.ConcioError:
                continue
            reached(value, f"{name}.{key}", seen)


@pytest.mark.long
def test_nothing_that_a_user_holds_prints_its_arrays(held: dict[str, object]) -> None:
    seen: dict[int, tuple[str, object]] = {}
    for name, thing in held.items():
        reached(thing, name, seen)
    kinds = {type(thing).__name__ for _, thing in seen.values()}
    assert kinds >= {
        "Model",
        "Result",
        "PathResult",
        "LimitResult",
        "Assembly",
        "Contacts",
        "ContactProblem",
        "Solution",
    }
    long = [
        (name, len(repr(thing)), repr(thing).count("\n") + 1)
        for name, thing in seen.values()
        if len(repr(thing)) > SIGNS or repr(thing).count("\n") >= LINES
    ]
    assert not long
    numbers = {type(thing).__name__ for _, thing in seen.values() if "array(" in repr(thing) or " at 0x" in repr(thing)}
    assert not numbers


@pytest.mark.long
def test_the_texts_say_what_matters(held: dict[str, object]) -> None:
    for name, words in {
        "model": ("Model: column", "3 bodies (3 elastic), 1 fixed; ", "E = 20 GPa", "friction 0.9", "load group live"),
        "result": ("Result: SOLVED.", "load factors dead = 1, live = 0.1", "reaction of ground: ", "certificate"),
        "failed": ("Result: ", "mechanism"),
        "path": ("PathResult: Collapses in stage 'push'", "live = 0.2"),
        "limit": ("LimitResult: column", "associated bound     0.25 times", "checked from both sides"),
    }.items():
        for word in words:
            assert word in repr(held[name]), (name, word, repr(held[name]))


@pytest.mark.parametrize("name", ["model", "result", "failed", "path", "limit", "space"])
def test_notebooks_show_words_and_a_picture(held: dict[str, object], name: str) -> None:
    html = held[name]._repr_html_()
    assert html.startswith("<div>")
    assert "<img" in html
    assert html.count("<div>") == html.count("</div>")


def test_short_texts_of_values() -> None:
    @short_repr
    @dataclass(frozen=True, eq=False)
    class Thing:
        a: object
        b: int = 3
        c: dict[str, int] = field(default_factory=dict)

    assert repr(Thing(np.arange(20.0).reshape(4, 5))) == "Thing(a=<(4, 5) from 0 to 19>)"
    assert repr(Thing(np.array([1.5, 2.0]), b=4, c={"x": 1})) == "Thing(a=[1.5, 2], b=4, c={'x': 1})"
    assert brief(Thing(np.zeros(9))) == "Thing(...)"
    assert brief(tuple(range(50))) == "(50 int)"
    assert brief("x" * 200) == repr("x" * 200)[:57] + "..."
    assert brief(concio.Status.SOLVED) == "SOLVED"
    assert brief(np.array(["a"] * 9)) == "<<U1 (9,)>"
    assert brief(np.full(9, np.nan)) == "<(9,) from nan to nan>"
    assert brief(np.zeros((0, 3))) == "[]"
