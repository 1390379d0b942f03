"""A session of the window: folder, open document, what is being computed; what each request of the page does."""

from __future__ import annotations

import threading
import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import concio
from concio.errors import InputError
from concio.files import whole_file
from concio.plot import style
from concio.window.asking import Asked
from concio.window.commands import patch_of
from concio.window.document import Document
from concio.window.folder import SUFFIXES, named
from concio.window.lane import PATIENCE, Job, Lane
from concio.window.questions import QUESTIONS
from concio.window.starting import TO_FILL, model_text
from concio.window.toml_places import places

HOLDS = 12.0
"""A page that has not been heard of for so long has given the pen back [s]."""
LOOK_EVERY = 1.0
"""The file on the disk is examined as often as this [s]."""
MOST_NAMES = 300
Answer = dict[str, Any]


class Session:
    """What the pages of one server share.

    Parameters
    ----------
    folder : Path
        The folder of the window.
    worker : sequence of str
        Starts a process that computes.
    file : Path, optional
        The file to open at the beginning.
    look : Lane, optional
        Draws pictures, where its process has been started before; by default one is made here.
    """

    def __init__(
        self, folder: Path, worker: Sequence[str], file: Path | None = None, look: Lane | None = None
    ) -> None:
        self.folder = folder.resolve()
        self.document: Document | None = None
        self.look = look or Lane(worker, PATIENCE)
        self.asked = Asked(self.folder, worker)
        self._guard = threading.RLock()
        self._pen, self._heard = "", 0.0
        self._looked = 0.0
        self._picture: tuple[str, Job] | None = None
        self._shown: Job | None = None
        self.calls: dict[str, Callable[[Mapping[str, Any]], Answer]] = {
            "hello": self.hello, "state": self.state, "start": self.start, "open": self.open, "new": self.new,
            "do": self.do, "undo": self.undo, "redo": self.redo, "save": self.save, "resolve": self.resolve,
            "picture": self.picture, "drag": self.drag, "ask": self.ask, "cancel": self.cancel, "result": self.result,
            "layers": self.layers, "export": self.export, "bye": self.bye, "take": self.take,
            "answers": self.answers, "film": self.film, "acts": self.acts,
            "underlay": self.underlay, "trace": self.trace, "wire": self.wire,
        }  # fmt: skip
        if file is not None:
            self.document = Document(file)
            self._picture_of(self.document)
            self.asked.tidy(self.document)

    def close(self) -> None:
        """End the processes and give the file back."""
        self.look.close()
        self.asked.close()
        if self.document is not None:
            self.document.close()

    # --- who writes -------------------------------------------------------------------------------------------------

    def _holds(self, page: str) -> bool:
        """Return whether a page has the pen; it takes the pen where no page has it."""
        now = time.monotonic()
        if self._pen in ("", page) or now - self._heard > HOLDS:
            self._pen, self._heard = page, now
            return True
        return False

    def _writing(self, told: Mapping[str, Any]) -> Document:
        if not self._holds(str(told.get("page", ""))):
            msg = "this page is read-only: the model is open in another page of this window"
            raise InputError(msg, hint="close the other page, or write here instead")
        return self._there()

    def _there(self) -> Document:
        if self.document is None:
            msg = "no model is open"
            raise InputError(msg, hint="open a file, or start from a template")
        return self.document

    def take(self, told: Mapping[str, Any]) -> Answer:
        """Take the pen from another page."""
        self._pen, self._heard = str(told.get("page", "")), time.monotonic()
        return self.state(told)

    def bye(self, told: Mapping[str, Any]) -> Answer:
        """Give the pen back."""
        if self._pen == told.get("page"):
            self._pen = ""
        return {}

    # --- the document -----------------------------------------------------------------------------------------------

    def hello(self, told: Mapping[str, Any]) -> Answer:
        """Return what never changes: words, colours, questions, templates."""
        words, of_files = (
            tomllib.loads(files("concio.window").joinpath(name).read_text(encoding="utf-8"))
            for name in ("words.toml", "italian.toml")
        )
        questions = [
            {"name": q.name, "needs": list(q.needs), "plane": q.plane,
             "options": [{"name": o.name, "kind": o.kind, "choices": list(o.choices)} for o in q.options]}
            for q in QUESTIONS.values()
        ]  # fmt: skip
        kept = sorted(p.name[:-5] for p in files("concio.model").joinpath("templates").iterdir())
        return {"words": words, "of_files": of_files, "look": LOOK, "questions": questions, "templates": kept,
                "to_fill": TO_FILL, "version": concio.__version__, **self.state(told)}  # fmt: skip

    def start(self, told: Mapping[str, Any]) -> Answer:
        """Return the files of the folder that can be opened."""
        found = [p.name for p in self.folder.iterdir() if p.suffix.lower() in SUFFIXES and not p.name.startswith(".")]
        return {"folder": self.folder.name, "files": sorted(found)[:MOST_NAMES]}

    def state(self, told: Mapping[str, Any]) -> Answer:
        """Return what may have changed: the document, the picture, the question that is being answered."""
        page = str(told.get("page", ""))
        holds = self._holds(page)
        number = self.asked.number  # read before the state: the state is never older than its number
        found: Answer = {"asking": number, "asked": self.asked.state(), "mine": holds, "folder": self.folder.name}
        doc = self.document
        if doc is None:
            return {**found, "document": None}
        with self._guard:
            if time.monotonic() - self._looked > LOOK_EVERY:
                self._looked = time.monotonic()
                doc.look()
        document: Answer = {
            "name": doc.file.name, "version": doc.version, "hash": doc.hash, "saved": doc.is_saved,
            "undo": doc.done[-1].label if doc.done else "", "redo": doc.undone[-1].label if doc.undone else "",
            "read_only": doc.read_only, "conflict": doc.conflict is not None, "recovered": doc.recovered,
        }  # fmt: skip
        if told.get("version") != doc.version or told.get("name") != doc.file.name:
            document |= {"text": doc.text, **_data(doc.text)}
        return {**found, "document": document}

    def open(self, told: Mapping[str, Any]) -> Answer:
        """Open a file of the folder; of anything else the model file that names it, made if missing."""
        if not self._holds(str(told.get("page", ""))):
            self._writing(told)
        path = named(self.folder, told.get("name"))
        text = model_text(path)
        if text is not None:
            model = path.with_suffix(".toml")
            if not model.exists():
                _write(model, text)
            path = model
        self._change_to(path)
        return self.state(told)

    def new(self, told: Mapping[str, Any]) -> Answer:
        """Start a file from a template; a file that is there is not replaced."""
        if not self._holds(str(told.get("page", ""))):
            self._writing(told)
        kinds = [p.name[:-5] for p in files("concio.model").joinpath("templates").iterdir()]
        kind = told.get("kind")
        if kind not in kinds:
            msg = f"there is no template '{kind}'"
            raise InputError(msg, hint="one of " + ", ".join(sorted(kinds)))
        text = files("concio.model").joinpath("templates", f"{kind}.toml").read_text(encoding="utf-8")
        path = named(self.folder, told.get("name") or self._free(str(kind)))
        if path.suffix != ".toml" or path.exists():
            msg = "there is a file of that name already" if path.exists() else "a model file ends in .toml"
            raise InputError(msg, where=path.name, hint="give another name")
        _write(path, text)
        self._change_to(path)
        return self.state(told)

    def _free(self, kind: str) -> str:
        names = (f"{kind}{n or ''}.toml" for n in (0, *range(2, 10_000)))
        return next(name for name in names if not (self.folder / name).exists())

    def drop(self, told: Mapping[str, Any], content: bytes) -> Answer:
        """Take a file that was dropped on the page into the folder, and open it."""
        if not self._holds(str(told.get("page", ""))):
            self._writing(told)
        path = named(self.folder, told.get("name"))
        if path.exists() and path.read_bytes() != content:
            msg = "there is another file of that name in the folder"
            raise InputError(msg, where=path.name, hint="rename the file, then drop it again")
        if not path.exists():
            with whole_file(path) as fresh:
                fresh.write_bytes(content)
        return self.open(told)

    def _change_to(self, path: Path) -> None:
        with self._guard:
            if self.document is not None and self.document.file == path.resolve():
                return
            opened = Document(path)
            self.asked.forget()
            self.asked.tidy(opened)
            if self.document is not None:
                self.document.close()
            self.document, self._picture, self._shown = opened, None, None

    def do(self, told: Mapping[str, Any]) -> Answer:
        """Change the text by a command."""
        with self._guard:
            doc = self._writing(told)
            if told.get("hash", doc.hash) != doc.hash:
                msg = "the model has changed since"
                raise InputError(msg, hint="look at it again, then repeat the change")
            for command in told["commands"]:
                patch, label = patch_of(doc.text, command)
                doc.change(patch, label)
        return self.state(told)

    def undo(self, told: Mapping[str, Any]) -> Answer:
        """Take a change back."""
        self._writing(told).undo()
        return self.state(told)

    def redo(self, told: Mapping[str, Any]) -> Answer:
        """Make a change again."""
        self._writing(told).redo()
        return self.state(told)

    def save(self, told: Mapping[str, Any]) -> Answer:
        """Write the file."""
        self._writing(told).save()
        return self.state(told)

    def resolve(self, told: Mapping[str, Any]) -> Answer:
        """Choose between two texts of the file."""
        if told.get("keep") not in ("mine", "theirs"):
            msg = "keep is 'mine' or 'theirs'"
            raise InputError(msg)
        self._writing(told).resolve(told["keep"])
        return self.state(told)

    def layers(self, told: Mapping[str, Any]) -> Answer:
        """Return the layers of the drawing of the document."""
        job = self.look.ask(self._request("layers", self._there()))
        job.over.wait(60.0)
        return {"state": job.state, job.state: job.answer}

    # --- what is computed -------------------------------------------------------------------------------------------

    def _request(self, kind: str, doc: Document, **more: Any) -> dict[str, Any]:
        return {"kind": kind, "text": doc.text, "base": str(doc.file.parent), "folder": str(self.folder),
                "name": doc.file.name, **more}  # fmt: skip

    def picture(self, told: Mapping[str, Any]) -> Answer:
        """Return the picture of the text as it is; wait for it a while. With ``early`` the geometry alone will do."""
        doc = self._there()
        job = self._picture_of(doc, told.get("again", ""))
        (job.shown if told.get("early") else job.over).wait(min(float(told.get("wait", 5.0)), 20.0))
        if job.over.is_set():
            self.asked.warm()
        elif told.get("early") and job.early is not None:
            return {"hash": doc.hash, "state": "early", "early": job.early}
        return {"hash": doc.hash, "state": job.state, job.state: _without_folder(job, doc)}

    def _picture_of(self, doc: Document, again: Any = "") -> Job:
        """Return the job that draws the text as it is, begun where it is not."""
        with self._guard:
            key = f"{doc.file}:{doc.hash}:{again}"
            if self._picture is None or self._picture[0] != key or self._picture[1].state == "cancelled":
                self._picture = key, self.look.ask(self._request("picture", doc))
            return self._picture[1]

    def drag(self, told: Mapping[str, Any]) -> Answer:
        """Return a bound while a load is dragged; newer requests win."""
        doc = self._there()
        at = [float(v) for v in told["at"]]
        job = self.look.ask(self._request("drag", doc, table=int(told["table"]), at=at, body=str(told["body"])))
        job.over.wait(20.0)
        return {"state": job.state, job.state: job.answer}

    def acts(self, told: Mapping[str, Any]) -> Answer:
        """Return what will act in a question, in words."""
        named = {"question": str(told.get("question")), "options": dict(told.get("options") or {})}
        job = self.look.ask(self._request("acts", self._there(), **named))
        job.over.wait(20.0)
        return {"state": job.state, job.state: job.answer}

    def underlay(self, told: Mapping[str, Any]) -> Answer:
        """Return the picture under the model."""
        job = self.look.ask(self._request("underlay", self._there()))
        job.over.wait(60.0)
        return {"state": job.state, job.state: job.answer}

    def trace(self, told: Mapping[str, Any]) -> Answer:
        """Return the stones that are traced in the picture."""
        asked = {key: told.get(key) for key in ("method", "unit", "joint", "clicks")}
        job = self.look.ask(self._request("trace", self._there(), **asked))
        job.over.wait(300.0)
        return {"state": job.state, job.state: job.answer}

    def wire(self, told: Mapping[str, Any]) -> Answer:
        """Return the way along the joints of the picture from one click to where the pointer is; newer requests win."""
        job = self.look.ask(self._request("wire", self._there(), **{key: told.get(key) for key in ("a", "b", "joint")}))
        job.over.wait(20.0)
        return {"state": job.state, job.state: job.answer}

    def ask(self, told: Mapping[str, Any]) -> Answer:
        """Ask a question."""
        self.asked.ask(self._there(), told)
        return self.state(told)

    def cancel(self, told: Mapping[str, Any]) -> Answer:
        """Give up the question."""
        self.asked.cancel()
        return self.state(told)

    def result(self, told: Mapping[str, Any]) -> Answer:
        """Return an answer with the addresses of its files."""
        return self.asked.result(str(told.get("key", "")))

    def answers(self, told: Mapping[str, Any]) -> Answer:
        """Return the answers of the document that are kept."""
        return {"answers": self.asked.known(self._there())}

    def film(self, told: Mapping[str, Any]) -> Answer:
        """Return what an answer shows in motion, or None."""
        return {"film": self.asked.film(str(told.get("key", "")))}

    def export(self, told: Mapping[str, Any]) -> Answer:
        """Write the project folder: model, the files it names, result."""
        return self.asked.export(self._there(), str(told.get("key", "")))


def _without_folder(job: Job, doc: Document) -> Any:
    """Return an answer whose message names files as the text does."""
    if job.state != "error":
        return job.answer
    folder = f"{doc.file.parent}/"
    return {key: value.replace(folder, "") if isinstance(value, str) else value for key, value in job.answer.items()}


LOOK = {
    "block": style.BLOCK, "mortar": style.FILM, "rigid": style.RIGID, "fixed": style.OBSTACLE, "hatch": style.HATCH,
    "edge": style.EDGE, "load": style.LOAD.colour, "tie": style.TENSION.colour, "ink": style.INK,
    "stick": style.STICK.colour, "slip": style.SLIP.colour, "open": style.OPEN.colour,
    "press": style.COMPRESSION.colour,
}  # fmt: skip
"""Colours of the page, those of figures and reports."""


def _data(text: str) -> Answer:
    """Return the values of a text by their paths as they are written, and the text's own fault where it has one."""
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        return {"values": None, "syntax": str(error)}
    found = places(text)
    values = [
        {"path": list(path), "written": text[v.start : v.end], "line": text.count("\n", 0, v.key) + 1}
        for path, v in list(found.values.items())[:MOST_VALUES] if path not in found.inline_tables
    ]  # fmt: skip
    lists = {name: len(data[name]) for name in ("loads", "supports", "ties") if isinstance(data.get(name), list)}
    return {"values": values, "lists": lists, "syntax": ""}


MOST_VALUES = 3000


def _write(path: Path, text: str) -> None:
    try:
        with whole_file(path) as fresh:
            fresh.write_text(text, encoding="utf-8")
    except OSError as error:
        msg = f"cannot be written: {error.strerror or error}"
        raise InputError(msg, where=path.name, hint="choose a folder in which files may be written") from None
