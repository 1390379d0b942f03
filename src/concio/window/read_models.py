"""Models of texts, the last few kept: a picture and the drags on it ask for the same one."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from concio.model.file.reading import model_from_tables, parse
from concio.model.model import Model
from concio.window.folder import check_files
from concio.window.journal import hash_of

KEPT = 4
DIGITS = 9
"""Coordinates are sent with so many decimals [m]."""
_MODELS: OrderedDict[str, tuple[dict[str, Any], Model]] = OrderedDict()


def read(request: Mapping[str, Any], *, fresh: bool = False) -> tuple[dict[str, Any], Model]:
    """Return the tables of the text of a request, and the model that they describe.

    Parameters
    ----------
    request : mapping
        ``text``; ``base``, the folder of the file; ``folder``, the folder of the window; ``name`` for messages.
    fresh : bool
        Whether to read again even where the text has been read: a drawing beside it may have changed.

    Raises
    ------
    InputError
        The text is not a model, or names a file outside the folder.
    """
    key = hash_of(request["text"] + "\0" + request["base"])
    if fresh or key not in _MODELS:
        data = parse(request["text"], request["name"])
        check_files(data, Path(request["base"]), Path(request["folder"]))
        model = model_from_tables(data, folder=request["base"], name=request["name"])
        _MODELS[key] = data, model
        while len(_MODELS) > KEPT:
            _MODELS.popitem(last=False)
    return _MODELS[key]


def own_loads(data: Mapping[str, Any], model: Model) -> dict[int, int]:
    """Return, for each ``[[loads]]`` of a file from 0, its number among the loads of the model.

    Empty where the file puts a structure together from parts, sweeps it into space or adds a road: the loads of the
    model are then not those of the file in their order.
    """
    tables = data.get("loads", [])
    if any(key in data for key in ("parts", "extrusion", "fill", "vehicle", "bridge")):
        return {}
    first = len(model.loads) - len(tables)
    return {k: first + k for k in range(len(tables)) if first >= 0}
