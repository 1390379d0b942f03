"""A lane: one worker process with one request at a time; the newest request wins, cancelling ends the process."""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Literal

PATIENCE = 1.5
"""A picture that takes longer is given up when the text has changed again [s]."""
CRASHED = "the process that computes was ended from outside"
State = Literal["waiting", "working", "done", "error", "cancelled"]


@dataclass
class Job:
    """A request and what is known of it.

    Parameters
    ----------
    number : int
    request : mapping
    state : str
    progress : mapping
        What was reported last.
    found : list of str
        Lines that are known so far.
    early : Any
        What can be shown before the answer is there, or None.
    answer : Any
        What was found, or what went wrong.
    begun, ended : float
        Times [s].
    """

    number: int
    request: dict[str, Any]
    state: State = "waiting"
    progress: dict[str, Any] = field(default_factory=dict)
    found: list[str] = field(default_factory=list)
    early: Any = None
    answer: Any = None
    begun: float = field(default_factory=time.monotonic)
    ended: float = 0.0
    over: threading.Event = field(default_factory=threading.Event)
    shown: threading.Event = field(default_factory=threading.Event)
    """Set as soon as there is anything to show: an early answer, or the end."""
    _guard: threading.Lock = field(default_factory=threading.Lock)

    def start(self) -> bool:
        """Put down that the request is being computed; return False where it was given up before."""
        with self._guard:
            if self.over.is_set():
                return False
            self.state = "working"
            return True

    def end(self, state: State, answer: Any = None) -> None:
        """Put down how the request ended, once."""
        with self._guard:
            if not self.over.is_set():
                self.state, self.answer, self.ended = state, answer, time.monotonic()
                self.over.set()
                self.shown.set()

    def show(self, early: Any) -> None:
        """Put down what can be shown before the answer is there."""
        self.early = early
        self.shown.set()


class Lane:
    """Runs requests in a process of its own.

    Parameters
    ----------
    command : sequence of str
        Starts the worker process.
    patience : float
        A request that is older than this is ended when a newer one comes; a younger one is waited for [s].
    """

    def __init__(self, command: Sequence[str], patience: float = 0.0) -> None:
        self._command, self._patience = list(command), patience
        self._guard = threading.Condition()
        self._process: subprocess.Popen[bytes] | None = None
        self._next: Job | None = None
        self.job: Job | None = None
        self._numbers = itertools.count(1)
        self._open = True
        threading.Thread(target=self._run, name="lane", daemon=True).start()

    def start(self) -> None:
        """Start the process before anything is asked: it loads what it needs meanwhile."""
        with self._guard:
            if self._open:
                self._started()

    def warm(self) -> None:
        """Load what questions need before one is asked."""
        self.ask({"kind": "warm"})

    def ask(self, request: dict[str, Any]) -> Job:
        """Ask something; what was asked before and is not answered is given up."""
        job = Job(next(self._numbers), request)
        with self._guard:
            if not self._open:
                job.end("cancelled")
                return job
            if self._next is not None:
                self._next.end("cancelled")
            self._next = job
            busy = self.job
            if busy is not None and busy.request["kind"] != "warm" and _age(busy) >= self._patience:
                self._kill(busy)
            self._guard.notify_all()
        return job

    def cancel(self) -> None:
        """Give up what is being computed, by ending its process."""
        with self._guard:
            if self._next is not None:
                self._next.end("cancelled")
                self._next = None
            if self.job is not None:
                self._kill(self.job)

    def close(self) -> None:
        """End the process for good."""
        with self._guard:
            self._open = False
            self.cancel()
            self._end_process()
            self._guard.notify_all()

    @property
    def pid(self) -> int | None:
        """Number of the process, for tests that end it."""
        return self._process.pid if self._process is not None else None

    def _kill(self, job: Job) -> None:
        job.end("cancelled")
        self._end_process()

    def _end_process(self) -> None:
        if self._process is not None:
            with suppress(OSError):
                self._process.kill()
            self._process.wait()
            self._process = None

    def _run(self) -> None:
        while True:
            with self._guard:
                while self._open and self._next is None:
                    self._guard.wait()
                if not self._open:
                    return
                job = self.job = self._next
                self._next = None
                assert job is not None
                process, lives = self._started(), True
            if process is None:
                job.end("error", {"what": "no process could be started to compute", "where": "", "hint": "try again"})
            elif job.start():
                lives = _exchange(process, job)
            with self._guard:
                self.job = None
                if process is not None and process is self._process and not lives:
                    self._end_process()

    def _started(self) -> subprocess.Popen[bytes] | None:
        """Return the process, started where there is none that lives."""
        if self._process is None or self._process.poll() is not None:
            try:
                self._process = subprocess.Popen(
                    self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                    env={**os.environ, "PYTHONUTF8": "1"},
                )  # fmt: skip
            except OSError:
                self._process = None
        return self._process


def _age(job: Job) -> float:
    return time.monotonic() - job.begun


def _exchange(process: subprocess.Popen[bytes], job: Job) -> bool:
    """Send a request and read its answers until the last; return whether the process lives."""
    assert process.stdin is not None
    assert process.stdout is not None
    line = json.dumps({"id": job.number, **job.request}).encode() + b"\n"
    try:
        process.stdin.write(line)
        process.stdin.flush()
        for raw in process.stdout:
            answer = json.loads(raw)
            if answer["id"] != job.number:
                continue
            if "progress" in answer:
                job.progress = answer["progress"]
            elif "found" in answer:
                job.found = answer["found"]
            elif "early" in answer:
                job.show(answer["early"])
            else:
                word: State = "done" if "done" in answer else "error"
                job.end(word, answer[word])
                return True
    except (OSError, ValueError):
        pass
    job.end("error", {"what": CRASHED, "where": "", "hint": "ask again"})
    return False
