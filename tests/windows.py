"""A window without a browser: a server in this process, and a client that asks it as the page does."""

from __future__ import annotations

import http.client
import json
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from concio.window.server import Server
from concio.window.session import Session

WORKER = (sys.executable, "-m", "concio.cli.answering_process")
LATE = 240.0
"""What is not there after so long is missing [s]: a machine may be busy."""


class Client:
    """Asks a server as a page does."""

    def __init__(self, server: Server, page: str = "page-1") -> None:
        self.server, self.page = server, page

    def raw(
        self, method: str, path: str, body: bytes | None = None, **headers: str
    ) -> tuple[int, dict[str, str], bytes]:
        """Return status, headers and body of a request; ``headers`` replace those of the page (``_`` for ``-``)."""
        connection = http.client.HTTPConnection("127.0.0.1", self.server.server_port, timeout=LATE)
        own = {"Origin": self.server.origin, "Content-Type": "application/json"} if method == "POST" else {}
        sent = {**own, **{k.replace("_", "-"): v for k, v in headers.items()}}
        try:
            connection.request(method, path, body, {k: v for k, v in sent.items() if v})
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def call(self, name: str, /, **told: Any) -> dict[str, Any]:
        """Return what a request answers; an error as ``{"error": {...}}``."""
        body = json.dumps({"page": self.page, **told}).encode()
        return json.loads(self.raw("POST", f"/{self.server.token}/api/{name}", body)[2])

    def do(self, *commands: dict[str, Any]) -> dict[str, Any]:
        """Change the document by commands."""
        return self.call("do", commands=list(commands))

    def until(self, name: str, /, **told: Any) -> dict[str, Any]:
        """Ask again until what is computed is there."""
        end = time.monotonic() + LATE
        while time.monotonic() < end:
            found = self.call(name, **told)
            state = found["asked"]["state"] if name == "state" else found["state"]
            if state not in ("waiting", "working"):
                return found
            time.sleep(0.05)
        msg = f"{name} is still being computed"
        raise AssertionError(msg)

    def answer(self, question: str, /, **options: Any) -> dict[str, Any]:
        """Ask a question and return its answer."""
        asked = self.call("ask", question=question, options=options)
        assert "error" not in asked, asked
        key = self.until("state")["asked"]["key"]
        return self.call("result", key=key)


def known(address: str) -> Client:
    """Return a client of a window that another process has opened."""
    port, token = address.removeprefix("http://127.0.0.1:").rstrip("/").split("/")
    client = Client.__new__(Client)
    client.server = type("Known", (), {"server_port": int(port), "token": token,
                                       "origin": f"http://127.0.0.1:{port}"})()  # fmt: skip
    client.page = "page"
    return client


@contextmanager
def window(folder: Path, file: Path | None = None) -> Iterator[Client]:
    """Give a client of a window that is open."""
    session = Session(folder, WORKER, file)
    server = Server(session)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield Client(server)
    finally:
        server.shutdown()
        server.server_close()
        session.close()
