"""``[[parts]]`` of a model file: other files or generators, placed and put together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.model.compose import place
from concio.model.file.file_errors import placed
from concio.model.generate.generators import GENERATORS
from concio.model.generate.merging import merge, merged
from concio.model.model import Model

Made = Callable[[Any, str], Model | None]


def assembled_parts(
    tables: list[Any], made: Made, read: Callable[[str], Model], title: str, *, ruled: bool
) -> Model | None:
    """Return the model of all parts of a file, None where there are none.

    Parameters
    ----------
    tables : list of PartTable
    made : function of a table and its place in the file
        Runs the generator of a part.
    read : function of the name of a file
        Reads the model of a part.
    title : str
        Of the whole.
    ruled : bool
        Whether the file has rules of its own, which then say what holds between parts.

    Raises
    ------
    InputError
        A part is neither a file nor a generator, or cannot be placed or merged.
    """
    found: list[Model] = []
    for number, table in enumerate(tables, 1):
        label = f"[[parts]] {number}" + (f" '{table.name}'" if table.name else "")
        named = [name for name in GENERATORS if getattr(table, name, None) is not None]
        if len(named) + (table.file is not None) != 1:
            msg = "a part is a file or one generator" + (f", not {len(named)} generators" if len(named) > 1 else "")
            raise InputError(msg, where=label, hint="file = 'arch.toml', or a table such as [parts.arch]")
        with placed(label):
            model = read(table.file) if table.file is not None else made(table, label)
        assert model is not None
        with placed(label, own="place"):
            found += _placed(table, model, len(tables))
    if not found:
        return None
    if len(found) == 1:
        return found[0]
    with placed("[[parts]]", own="merge"):
        whole = merged(found) if ruled else merge(*found)
        return replace(whole, title=title or f"{len(found)} parts")


def _placed(table: Any, model: Model, parts: int) -> list[Model]:
    """Return the copies of one part."""
    if table.repeat > 1 and table.step is None:
        msg = f"repeat = {table.repeat} needs a step"
        raise InputError(msg, hint="step = [x, y] or [x, y, z] from one copy to the next")
    if table.name is None and (table.repeat > 1 or parts > 1):
        msg = "the part has no name"
        raise InputError(msg, hint="name = 'left arch': it stands before the names of the blocks")
    at = np.array(table.at or np.zeros(model.dim), dtype=float)
    step = np.array(table.step or np.zeros(model.dim), dtype=float)
    for word, vector in (("at", at), ("step", step)):
        if vector.shape != (model.dim,):
            what = "in the plane" if model.dim == 2 else "in space"
            msg = f"{word} has {len(vector)} coordinates, the part is {what}"
            raise InputError(msg, hint=f"give {model.dim}")
    copies = []
    for k in range(table.repeat):
        name = (table.name or "") + (f"{k + 1}" if table.repeat > 1 else "")
        copies.append(
            place(
                model, (at + k * step).tolist(), turn=table.turn, axis=table.axis or (), mirror=table.mirror,
                name=name.replace("-", "_"), without=table.without or (), loads=table.loads,
            )
        )  # fmt: skip
    return copies
