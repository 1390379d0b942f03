"""The process that computes: it reads requests, one a line, and writes what it finds, one a line.

The window ends the process to cancel a request. What a library prints goes to standard error, never between the lines.
"""

from __future__ import annotations

import json
import math
import os
import sys
import threading
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

from concio.errors import ConcioError

OFTEN = 1.0
"""Time between two looks whether the window lives [s]."""
Tell = Callable[[str, Any], None]
Handler = Callable[[Mapping[str, Any], Tell], Any]
"""Answers a request; ``tell`` sends what is known on the way: "progress", "found" (lines), "early" (a first answer)."""


def work(handlers: Mapping[str, Handler]) -> None:
    """Answer requests until there are no more.

    Parameters
    ----------
    handlers : mapping of kind to callable
        A request is ``{"id": 1, "kind": "picture"}``; the answers are ``{"id": 1, "progress": ...}`` and at the end
        ``{"id": 1, "done": ...}`` or ``{"id": 1, "error": {"what", "where", "hint"}}``.
    """
    threading.Thread(target=_end_with_parent, args=(os.getppid(),), daemon=True).start()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    requests = os.fdopen(os.dup(0), encoding="utf-8", newline="\n")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    for line in requests:
        request = json.loads(line)

        def tell(word: str, what: Any, number: int = request["id"]) -> None:
            answers.write(json.dumps({"id": number, word: _plain(what)}, ensure_ascii=False, allow_nan=False) + "\n")
            answers.flush()

        try:
            tell("done", handlers[request["kind"]](request, tell))
        except ConcioError as error:
            tell("error", error_of(error))
        except MemoryError:
            tell("error", {"what": "the model does not fit into memory", "where": "", "hint": "use fewer elements"})
        except Exception as error:
            what = f"this is a bug in concio: {type(error).__name__}: {error}"
            tell("error", {"what": what, "where": "", "hint": "send the model file with a report of the bug"})


def later(module: str, name: str) -> Handler:
    """Return a handler whose module is loaded at the first request."""

    def handler(request: Mapping[str, Any], tell: Tell) -> Any:
        return getattr(import_module(module), name)(request, tell)

    return handler


def _end_with_parent(parent: int) -> None:
    """End the process when the window that started it has died: nobody waits for the answer."""
    while os.getppid() == parent:
        time.sleep(OFTEN)
    os._exit(1)


def error_of(error: ConcioError) -> dict[str, Any]:
    """Return what to say of an exception of concio, with its verdict where it has one."""
    found: dict[str, Any] = {"what": error.what, "where": error.where or "", "hint": error.hint or ""}
    if error.verdict is not None:
        found["verdict"] = error.verdict.as_dict()
    return found


def _plain(value: Any) -> Any:
    """Return a value without numbers that JSON does not know."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
