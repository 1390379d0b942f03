"""Whatever is done in whatever order, text, picture and program describe one model."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from concio.window.toml_edits import literal
from samples import sample
from windows import Client, window

PILLAR = """title = "pillar"   # a comment that stays
[column]
width = 0.5
height = 2.0
blocks = 4
block = "rigid"
unit_weight = 20.0
[[loads]]
kind = "point"
value = [1.0, 0.0]
bodies = ["b04"]
at = [-0.25, 2.0]
group = "live"
"""


def edit(client: Client, rng: random.Random, text: str) -> dict[str, Any]:
    """Do one thing that a person may do; return the answer of the window."""
    kind = rng.choice(["undo", "redo", "undo", "drag", "drag", "value", "load", "remove", "text", "wrong", "save"])
    if kind in ("undo", "redo", "save"):
        return client.call(kind)
    if kind == "drag":
        at = [-0.25, round(rng.uniform(1.5, 2.0), 3)]
        return client.do({"do": "set", "path": ["loads", 0, "at"], "value": at})
    if kind == "value":
        return client.do({"do": "set", "path": ["column", "width"], "value": rng.choice([0.5, "55 cm", 0.6])})
    if kind == "load":
        table = {"kind": "weight", "value": [round(rng.uniform(0.0, 0.2), 3), 0.0], "group": f"g{rng.randrange(3)}"}
        return client.do({"do": "add", "to": "loads", "table": table})
    if kind == "remove":
        return client.do({"do": "remove", "path": ["loads", rng.randrange(3)]})
    blocks = "" if kind == "wrong" else str(rng.randrange(4, 7))
    lines = [f"blocks = {blocks}" if line.startswith("blocks") else line for line in text.splitlines()]
    return client.do({"do": "text", "text": "\n".join([*lines, f"# {literal(str(rng.random()))}", ""])})


def read(text: str) -> tuple[concio.Model | None, str]:
    """Return the model of a text, or None and what is wrong with it."""
    try:
        return concio.loads(text), ""
    except concio.ConcioError as error:
        return None, error.what


def check(client: Client) -> bool:
    """Hold the picture beside the model of the text; return whether the text is a model."""
    document = client.call("state", version=-1)["document"]
    found = client.until("picture")
    assert found["hash"] == document["hash"]
    model, fault = read(document["text"])
    if model is None:
        assert found["state"] == "error"
        assert fault.splitlines()[0][:40] in found["error"]["what"] + document["syntax"]
        return False
    shown = found["done"]
    assert [b["name"] for b in shown["bodies"]] == [b.name for b in model.bodies]
    for body, own in zip(shown["bodies"], model.bodies, strict=True):
        assert np.allclose(body["rings"][0], own.outline, atol=1e-8)  # type: ignore[union-attr]
    assert [(one["kind"], one["group"], one["value"], one["at"] and tuple(one["at"])) for one in shown["loads"]] == [
        (one.kind, one.group, list(one.value), one.at and tuple(one.at)) for one in model.loads
    ]
    return True


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 1, 3)))
def test_text_picture_and_program_describe_one_model_after_random_commands(tmp_path: Path, seed: int) -> None:
    rng, file = random.Random(seed), tmp_path / "pillar.toml"
    file.write_text(PILLAR, encoding="utf-8")
    models = 0
    with window(tmp_path, file) as client:
        for _ in range(40):
            edit(client, rng, client.call("state", version=-1)["document"]["text"])
            models += check(client)
        while not check(client):
            client.call("undo")
        told = client.answer("run")
        assert not client.call("save")["document"]["conflict"]
        code = f"{told['python']}\nprint([b.name for b in model.bodies], model.loads)\n"
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
        model = concio.loads(client.call("state", version=-1)["document"]["text"])
        assert done.stdout.splitlines()[-1] == f"{[b.name for b in model.bodies]} {model.loads}"
        assert told["verdict"]["sentence"] in done.stdout
        while client.call("state")["document"]["undo"]:
            client.call("undo")
        assert client.call("state", version=-1)["document"]["text"] == PILLAR
    assert models > 20
