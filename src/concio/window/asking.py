"""Questions that are asked of a document: one at a time, the newest wins, answers kept."""

from __future__ import annotations

import glob
import re
import secrets
import shutil
import tempfile
import threading
import time
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import concio
from concio.errors import InputError
from concio.window.document import Document
from concio.window.folder import check_files, inside
from concio.window.lane import Job, Lane
from concio.window.questions import QUESTIONS, arguments, command_text, python_text
from concio.window.results import Results, key_of, named_files

Answer = dict[str, Any]
KEY = re.compile(r"[0-9a-f]{32}")
COPY = re.compile(r"\.[0-9a-f]{12}\.toml")
"""How the name of a copy of the text ends."""


class Asked:
    """The question that was asked last, and the answers there are.

    Parameters
    ----------
    folder : Path
        The folder of the window.
    worker : sequence of str
        Starts the process that computes.

    Attributes
    ----------
    number : int
        How many questions were asked: a page recognises by it what was sent before the last one.
    """

    def __init__(self, folder: Path, worker: Sequence[str]) -> None:
        self.folder = folder
        self.lane = Lane(worker)
        self.number = 0
        self._warm = False
        self._guard = threading.RLock()
        self._now: Answer | None = None
        self._job: Job | None = None
        self._results: Results | None = None
        self._answers: dict[str, Answer] = {}
        self._spare = tempfile.TemporaryDirectory(prefix="concio-window-")

    def close(self) -> None:
        """End the process."""
        self.lane.close()
        self._spare.cleanup()

    def warm(self) -> None:
        """Load what questions need, once, when the picture is there: the first answer then comes sooner."""
        with self._guard:
            if not self._warm:
                self._warm = True
                self.lane.warm()

    def forget(self) -> None:
        """Give up the question: another document is opened."""
        with self._guard:
            self.cancel()
            self.number += 1
            self._now, self._job, self._results, self._answers = None, None, None, {}

    def ask(self, doc: Document, told: Mapping[str, Any]) -> None:
        """Ask a question of a document; what is being computed is given up.

        Raises
        ------
        InputError
            There is no such question or option, or the text is not a model that may be asked.
        """
        name, options = str(told.get("question")), dict(told.get("options") or {})
        words = arguments(name, options)
        try:
            data = tomllib.loads(doc.text)
        except (ValueError, RecursionError) as error:
            msg = f"the text is not valid TOML: {error}"
            raise InputError(msg, where=doc.file.name, hint="mend the text first, or undo") from None
        check_files(data, doc.file.parent, self.folder)
        results = self._results_of(doc)
        key = key_of(doc.text, data, doc.file.parent, [name, *words], concio.__version__)
        now = {"key": key, "question": name, "options": options, "hash": doc.hash,
               "command": command_text(name, options, doc.file.name),
               "python": python_text(name, options, doc.file.name)}  # fmt: skip
        with self._guard:
            self.cancel()
            self._warm = True
            kept = results.kept(key)
            job = None if kept is not None else self._sent(doc, name, words, results, key)
            self.number += 1
            self._now, self._job = now, job
            self._answers.pop(key, None)
            if kept is not None:
                self._answers[key] = {**kept, "kept": True}
        if job is not None:
            threading.Thread(target=self._wait, args=(job, now, results), daemon=True).start()

    def tidy(self, doc: Document) -> None:
        """Remove copies of the text that a killed program has left beside the file."""
        if not doc.read_only:
            for left in doc.file.parent.glob(f".{glob.escape(doc.file.stem[:60])}.*.toml"):
                if COPY.fullmatch(left.name[-18:]):
                    with suppress(OSError):
                        left.unlink()

    def _sent(self, doc: Document, name: str, words: list[str], results: Results, key: str) -> Job:
        """Send a question with a copy of the text beside the file: what it names is relative to that."""
        copy = doc.file.with_name(f".{doc.file.stem[:60]}.{secrets.token_hex(6)}.toml")
        try:
            out = results.place(key)
            copy.write_text(doc.text, encoding="utf-8")
        except OSError as error:
            with suppress(OSError):
                copy.unlink()
            msg = f"cannot write there: {error.strerror or error}"
            hint = "questions need a copy of the text there, and their answers a folder"
            raise InputError(msg, where=str(doc.file.parent), hint=hint) from None
        argv = [name, str(copy), *words, "--out", str(out)]
        return self.lane.ask(
            {"kind": "ask", "argv": argv, "out": str(out), "file": str(copy), "name": doc.file.name}
        )  # fmt: skip

    def _wait(self, job: Job, now: Answer, results: Results) -> None:
        job.over.wait()
        with suppress(OSError):
            Path(job.request["file"]).unlink()
        with self._guard:
            again = self._now is not now and self._now is not None and self._now["key"] == now["key"]
            if again or job.state == "cancelled":  # what is asked again is computed into the same directory
                return
            if job.state == "done":
                answer = {**job.answer, **now}
                if answer["code"] in (0, 3, 4):
                    with suppress(OSError):
                        results.keep(now["key"], answer)
            else:
                message = "\n".join(filter(None, map(job.answer.get, ("what", "hint"))))
                answer = {**now, "code": 1, "lines": [], "verdict": None, "message": message}
            self._answers[now["key"]] = answer

    def _results_of(self, doc: Document) -> Results:
        if self._results is None:
            self._results = Results(Path(self._spare.name) if doc.read_only else doc.folder / "results")
        return self._results

    def cancel(self) -> None:
        """Stop the computation; what was found so far is kept."""
        with self._guard:
            if self._job is not None and not self._job.over.is_set():
                self.lane.cancel()

    def state(self) -> Answer | None:
        """Return what is known of the question that was asked last."""
        with self._guard:
            now, job = self._now, self._job
            if now is None:
                return None
            if now["key"] in self._answers:
                return {**now, "state": "done"}
            if job is None:
                return {**now, "state": "waiting"}
            state = "working" if job.state in ("done", "error") else job.state  # its files are being put down
            return {**now, "state": state, "progress": job.progress, "found": job.found, "early": job.early,
                    "seconds": (job.ended or time.monotonic()) - job.begun}  # fmt: skip

    def result(self, key: str) -> Answer:
        """Return an answer with the addresses of its files.

        Raises
        ------
        InputError
            There is no such answer.
        """
        answer = self._answer(key)
        assert self._results is not None
        door = self._results.door(key)
        return {**answer, "files": [f"answer/{door}/{name}" for name in self._results.files(key)]}

    def _answer(self, key: str) -> Answer:
        found = self._answers.get(key)
        if found is None and self._results is not None and KEY.fullmatch(key):
            found = self._results.kept(key)
        if found is None or self._results is None:
            msg = "there is no such answer"
            raise InputError(msg, hint="ask again")
        return found

    def known(self, doc: Document) -> list[Answer]:
        """Return the answers of a document that are kept, the newest first, in a few words each."""
        found = self._results_of(doc).known()
        return [
            {"key": one["key"], "command": one["command"], "hash": one["hash"], "question": one["question"],
             "headline": (one.get("verdict") or {}).get("headline", ""),
             "italian": (one.get("italian") or {}).get("headline")}
            for one in found if one.get("name", doc.file.name) == doc.file.name
        ]  # fmt: skip

    def film(self, key: str) -> Any:
        """Return what the answer of a key shows in motion, or None.

        Raises
        ------
        InputError
            There is no such answer.
        """
        self._answer(key)
        assert self._results is not None
        return self._results.film(key)

    def file(self, door: str, name: str) -> Path | None:
        """Return a file of an answer by its address, or None."""
        return self._results.behind(door, name) if self._results is not None else None

    def export(self, doc: Document, key: str) -> Answer:
        """Write a project folder beside the file: the text that was asked, files that it names, the answer's files.

        Raises
        ------
        InputError
            There is no such answer, or the folder cannot be written.
        """
        answer = self.result(key)
        assert self._results is not None
        if answer["hash"] != doc.hash:
            msg = "the model has changed since this answer"
            raise InputError(msg, hint="ask again, then export")
        target = _free(doc.file.parent / f"{doc.file.stem}-project")
        try:
            shutil.copytree(self._results.root / key, target / answer["question"],
                            ignore=shutil.ignore_patterns(".answer*"))  # fmt: skip
            (target / doc.file.name).write_text(doc.text, encoding="utf-8")
            (target / "question.txt").write_text(answer["command"] + "\n", encoding="utf-8")
            (target / "question.py").write_text(answer["python"], encoding="utf-8")
            for name in named_files(tomllib.loads(doc.text)):
                source = doc.file.parent / name
                if source.is_file() and inside(doc.file.parent, source):
                    (target / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(source, target / name)
        except OSError as error:
            msg = f"cannot be written: {error.strerror or error}"
            raise InputError(msg, where=str(target), hint="make room, or allow writing there") from None
        return {"folder": str(target), "question": QUESTIONS[answer["question"]].name}


def _free(path: Path) -> Path:
    names = (path.with_name(f"{path.name}{f'-{n}' if n else ''}") for n in (0, *range(2, 10_000)))
    return next(p for p in names if not p.exists())
