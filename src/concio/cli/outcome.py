"""How a command ends: exit code, message on standard error, one JSON object on standard output where asked for."""

from __future__ import annotations

import errno
import functools
import json as json_text
import math
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec

import typer

if TYPE_CHECKING:
    from concio.verdict.verdict import Verdict

P = ParamSpec("P")

_GLYPH = re.compile(r"Glyph (?P<code>\d+) ")

INTERRUPTED = 130
INTERNAL = 1
STDOUT = "standard output"
JSON_VERSION = 1
"""Version of what ``--json`` prints: it grows when an entry changes its meaning or goes; new entries leave it."""
QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
"""Whether the command that runs prints no text."""
DEBUG = "CONCIO_DEBUG"
"""Environment variable that makes commands show tracebacks."""


def guarded(command: Callable[P, int]) -> Callable[P, None]:
    """Return a command that ends with an exit code and a message for a person, whatever happens in it.

    Parameters
    ----------
    command : callable
        Returns its exit code; an argument called ``json`` says whether failures are printed as JSON too, one called
        ``quiet`` that no text is printed.
    """

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        as_json = bool(kwargs.get("json"))
        QUIET.set(bool(kwargs.get("quiet")))
        try:
            with _letters_told():
                code = command(*args, **kwargs)
            flush()
        except KeyboardInterrupt:
            fail({"kind": "Interrupted", "what": "stopped on request; nothing was written"}, INTERRUPTED, as_json)
        except (typer.Exit, typer.Abort):
            raise
        except Exception as error:
            if os.environ.get(DEBUG):
                raise
            told, code = _told(error)
            fail(_with_attention(told, kwargs.get("file")) if as_json else told, code, as_json)
        raise typer.Exit(code)

    run.__annotations__ = {**command.__annotations__, "return": None}
    return run


def _with_attention(told: dict[str, Any], file: object) -> dict[str, Any]:
    """Return what to say of an exception with what is suspicious about its model, where the file holds one."""
    from concio.errors import ConcioError

    if "verdict" in told or not isinstance(file, Path):
        return told
    import concio
    from concio.contact.detection import detect
    from concio.verdict.attention import attention_of

    with suppress(ConcioError, OSError, MemoryError):
        model = concio.load(file)
        return {**told, "attention": list(attention_of(model, detect(model)))}
    return told


@contextmanager
def _letters_told() -> Iterator[None]:
    """Say once which letters of names the font of figures lacks, where matplotlib warns of each at each drawing."""
    missing: dict[str, None] = {}
    show = warnings.showwarning

    def told(message: Warning | str, *rest: Any, **more: Any) -> None:
        found = _GLYPH.match(str(message))
        if found is None:
            show(message, *rest, **more)
        else:
            missing[chr(int(found["code"]))] = None

    with warnings.catch_warnings():
        warnings.filterwarnings("always", message="Glyph ", category=UserWarning)
        warnings.showwarning = told
        try:
            yield
        finally:
            if missing:
                letters = "".join(c if c.isprintable() else f"(U+{ord(c):04X})" for c in list(missing)[:20])
                note(f"Note: the font of the figures has no letter for {letters}: PNG and PDF show boxes there")


def _told(error: Exception) -> tuple[dict[str, Any], int]:
    """Return what to say about an exception, and the exit code."""
    from concio.errors import ConcioError

    if isinstance(error, ConcioError):
        told: dict[str, Any] = {"kind": type(error).__name__, "what": error.what}
        told |= {"where": error.where, "hint": error.hint}
        if error.verdict is not None:
            told["verdict"] = error.verdict.as_dict()
        return told, error.exit_code
    if isinstance(error, MemoryError):
        hint = "use fewer elements per block, or a machine with more memory"
        return {"kind": "MemoryError", "what": "the model does not fit into memory", "hint": hint}, 4
    if isinstance(error, OSError):
        reason = "the disk is full" if error.errno == errno.ENOSPC else error.strerror or str(error)
        where = str(error.filename) if error.filename else None
        hint = "nothing was left half written"
        return {"kind": "OutputError", "what": f"cannot write: {reason}", "where": where, "hint": hint}, INTERNAL
    where = None
    if error.__traceback__ is not None:
        frame = error.__traceback__
        while frame.tb_next is not None:
            frame = frame.tb_next
        where = f"{frame.tb_frame.f_code.co_filename}, line {frame.tb_lineno}"
    what = f"this is a bug in concio: {type(error).__name__}: {error}"
    return {"kind": "InternalError", "what": what, "where": where, "hint": f"{DEBUG}=1 shows the traceback"}, INTERNAL


def fail(told: Mapping[str, Any], code: int, as_json: bool) -> NoReturn:
    """Write a message to standard error, and to standard output as JSON where asked for; leave with ``code``."""
    text = f"{told['where']}: {told['what']}" if told.get("where") else told["what"]
    sys.stderr.write(f"Error: {text.rstrip()}\n")
    if told.get("hint"):
        sys.stderr.write(f"  -> {told['hint']}\n")
    if as_json and told.get("where") != STDOUT:
        from concio.errors import InputError

        with suppress(OSError, InputError):
            print_json({"status": "error", "exit_code": code, **{k: v for k, v in told.items() if v is not None}})
    raise typer.Exit(code)


def _print(text: str) -> None:
    with _writable():
        sys.stdout.write(text)


def flush() -> None:
    """Send what was printed on its way; raises as printing does."""
    with _writable():
        sys.stdout.flush()


@contextmanager
def _writable() -> Iterator[None]:
    """Turn a failure to write to standard output into an InputError.

    Where the reader has gone, the rest goes to nowhere: files and exit code are those of the whole command.
    """
    from concio.errors import InputError

    try:
        yield
    except BrokenPipeError:
        silence()
    except OSError as error:
        silence()
        msg = f"cannot be written to: {error.strerror or error}"
        raise InputError(msg, where=STDOUT, hint="send it somewhere else, or use --quiet") from None


def silence() -> None:
    """Send what is still to be printed, and what Python prints when it ends, to nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def print_json(data: Mapping[str, Any]) -> None:
    """Print one JSON object on standard output, with its format first; numbers that JSON does not know become null.

    What is suspicious about the model is listed under ``attention``, whatever the command.
    """
    from concio import __version__

    if "verdict" in data and "attention" not in data:
        data = {**data, "attention": data["verdict"]["attention"]}
    told = {"format_version": JSON_VERSION, "concio": __version__, **plain(data)}
    _print(json_text.dumps(told, allow_nan=False, ensure_ascii=False) + "\n")
    flush()


def plain(value: Any) -> Any:
    """Return a value with numbers that JSON does not know as None, and mappings and sequences of its own."""
    if isinstance(value, Mapping):
        return {str(key): plain(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def say(text: str = "") -> None:
    """Print a line on standard output, unless the command is quiet."""
    if not QUIET.get():
        _print(text + "\n")


def answer(lines: Iterable[str]) -> None:
    """Print what was found before reports and figures are written, which may take longer than finding it."""
    for line in lines:
        say(line)
    flush()


def note(text: str) -> None:
    """Print a line on standard error."""
    sys.stderr.write(text + "\n")


def write_verdict(place: Path, verdict: Verdict, language: str) -> list[str]:
    """Write a verdict in another language than that of ``summary.json`` beside it; return the names of the files."""
    name = f"verdict.{language}.json"
    (place / name).write_text(json_text.dumps(verdict.as_dict(), ensure_ascii=False, indent=2) + "\n", encoding="utf-8")
    return [name]
