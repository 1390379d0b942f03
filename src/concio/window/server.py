"""The server: this machine only, a random token in every address, nothing from elsewhere.

Every request is refused unless its Host is this server's own, its Origin (where the browser sends one, and on every
request that does something) is too, and its path begins with the token. The page may load nothing but what this server
sends (content security policy). Reports are shown in a frame of their own, sandboxed, at addresses that do not hold the
token. Sizes, times and numbers of connections are limited before anything is read.
"""

from __future__ import annotations

import hmac
import json
import secrets
import socket
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any
from urllib.parse import unquote, urlsplit

from concio.errors import ConcioError, InputError
from concio.window.results import SHOWN
from concio.window.session import Session

HOST = "127.0.0.1"
LARGEST_REQUEST = 25_000_000
"""A request with more bytes is refused before it is read: commands and texts."""
LARGEST_DROP = 60_000_000
"""A dropped file with more bytes is refused before it is read."""
SLOWEST = 30.0
"""A connection on which nothing comes for so long is closed [s]."""
MOST_CONNECTIONS = 64
"""More connections at a time than this are refused."""
LAST_WORDS = 2.0
"""So long a request is waited for when the window is closed [s]."""
MOST_PARTS = 8
PAGES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
OWN = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "frame-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
REPORT = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'self'; sandbox allow-scripts allow-modals"
)


class Server(ThreadingHTTPServer):
    """Serves one session.

    Parameters
    ----------
    session : Session
    port : int
        0 takes a free one.
    """

    daemon_threads = True
    request_queue_size = 128

    def __init__(self, session: Session, port: int = 0) -> None:
        self.session = session
        self.token = secrets.token_urlsafe(24)
        self._room = threading.BoundedSemaphore(MOST_CONNECTIONS)
        self._served: set[socket.socket] = set()
        self._changed = threading.Condition()
        super().__init__((HOST, port), Handler)

    @property
    def origin(self) -> str:
        """Origin of the page."""
        return f"http://{HOST}:{self.server_port}"

    @property
    def address(self) -> str:
        """Address of the page, with the token."""
        return f"{self.origin}/{self.token}/"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Take a connection in a thread of its own, or close it where there are too many."""
        if not self._room.acquire(blocking=False):
            self.shutdown_request(request)
            return
        super().process_request(request, client_address)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Serve a connection, then make room."""
        with self._changed:
            self._served.add(request)
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()
            with self._changed:
                self._served.discard(request)
                self._changed.notify_all()

    def server_close(self) -> None:
        """Close the door, then every connection as soon as what it has asked is answered.

        A connection that stays open would be answered from a session that has ended, and a page would believe it.
        """
        super().server_close()
        end = time.monotonic() + LAST_WORDS
        with self._changed:
            for one in self._served:
                with suppress(OSError):
                    one.shutdown(socket.SHUT_RD)
            self._changed.wait_for(lambda: not self._served, end - time.monotonic())
            for one in self._served:
                with suppress(OSError):
                    one.shutdown(socket.SHUT_RDWR)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of connections that break."""


class Refused(Exception):
    """A request that is not answered, with its status."""

    def __init__(self, status: HTTPStatus, why: str) -> None:
        super().__init__(why)
        self.status, self.why = status, why


class Handler(BaseHTTPRequestHandler):
    """Answers one connection."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version = "concio"
    sys_version = ""
    timeout = SLOWEST
    disable_nagle_algorithm = True
    wbufsize = -1

    def log_message(self, *_: Any) -> None:
        """Print nothing: an address holds the token."""

    def do_GET(self) -> None:
        """Send a file of the page, or of an answer."""
        self._answered(self._get)

    def do_POST(self) -> None:
        """Do what the page asks for."""
        self._answered(self._post)

    def _answered(self, answer: Any) -> None:
        try:
            self._check_host()
            answer()
        except Refused as error:
            self.close_connection = True
            self._send(error.status, "application/json", _json({"error": {"what": error.why, "where": "", "hint": ""}}))

    def _check_host(self) -> None:
        host = self.headers.get_all("Host") or []
        if host != [f"{HOST}:{self.server.server_port}"]:
            raise Refused(HTTPStatus.FORBIDDEN, "this is not the address of this window")
        origin = self.headers.get_all("Origin") or []
        if origin not in ([], [self.server.origin]):
            raise Refused(HTTPStatus.FORBIDDEN, "another page may not ask this window")
        if self.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin") and self.command != "GET":
            raise Refused(HTTPStatus.FORBIDDEN, "another page may not ask this window")

    def _parts(self) -> list[str]:
        """Return the parts of the path behind the token."""
        path = urlsplit(self.path).path
        parts = [unquote(p) for p in path.split("/")[1:]]
        if len(parts) > MOST_PARTS or any(p in ("..", ".") or "/" in p or "\\" in p or "\0" in p for p in parts):
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        return parts

    def _behind_token(self) -> list[str]:
        token, *rest = self._parts() or [""]
        if not hmac.compare_digest(token.encode(), self.server.token.encode()):
            raise Refused(HTTPStatus.FORBIDDEN, "the token of this address is not that of this window")
        return rest

    def _get(self) -> None:
        if self._parts()[:1] == ["answer"]:
            self._send_answer()
            return
        name = "/".join(self._behind_token()) or "index.html"
        page = files("concio.window").joinpath("page")
        known = {p.name: p for p in page.iterdir()}
        suffix = name[name.rfind(".") :]
        if name not in known or suffix not in PAGES:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        self._send(HTTPStatus.OK, PAGES[suffix], known[name].read_bytes())

    def _send_answer(self) -> None:
        _, *rest = self._parts()
        found = self.server.session.asked.file(rest[0], "/".join(rest[1:])) if len(rest) > 1 else None
        if found is None:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        self._send(HTTPStatus.OK, SHOWN[found.suffix], found.read_bytes(), policy=REPORT)

    def _post(self) -> None:
        if self.headers.get("Origin") is None:
            raise Refused(HTTPStatus.FORBIDDEN, "the Origin is missing")
        rest = self._behind_token()
        drop = rest == ["drop"]
        body = self._body(LARGEST_DROP if drop else LARGEST_REQUEST)
        session = self.server.session
        try:
            if drop:
                told = {"name": unquote(self.headers.get("X-Name", "")), "page": self.headers.get("X-Page", "")}
                answer = session.drop(told, body)
            else:
                answer = session.calls[_called(session, rest)](_request(body))
        except ConcioError as error:
            found = {"what": error.what, "where": error.where or "", "hint": error.hint or ""}
            self._send(HTTPStatus.CONFLICT, "application/json", _json({"error": found}))
            return
        except OSError as error:
            raise Refused(HTTPStatus.CONFLICT, f"a file cannot be read or written: {error.strerror or error}") from None
        except (KeyError, TypeError, ValueError) as error:
            raise Refused(HTTPStatus.BAD_REQUEST, f"this request cannot be read: {error}") from None
        self._send(HTTPStatus.OK, "application/json", _json(answer))

    def _body(self, most: int) -> bytes:
        length = self.headers.get("Content-Length", "")
        if not length.isdigit() or self.headers.get("Transfer-Encoding"):
            raise Refused(HTTPStatus.LENGTH_REQUIRED, "the length is missing")
        if int(length) > most:
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {most / 1e6:.0f} MB are not taken")
        body = self.rfile.read(int(length))
        if len(body) < int(length):
            raise Refused(HTTPStatus.BAD_REQUEST, "the request ends too early")
        return body

    def _send(self, status: HTTPStatus, kind: str, body: bytes, policy: str = OWN) -> None:
        self.send_response(status)
        text = kind.startswith("text/") or kind.endswith("json")
        self.send_header("Content-Type", f"{kind}; charset=utf-8" if text else kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Content-Security-Policy", policy)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "same-origin")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.send_header("Cross-Origin-Opener-Policy", "same-origin")
        self.send_header("Cache-Control", "no-store")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(body)
        self.wfile.flush()


def _called(session: Session, rest: list[str]) -> str:
    if len(rest) != 2 or rest[0] != "api" or rest[1] not in session.calls:
        raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
    return rest[1]


def _request(body: bytes) -> Mapping[str, Any]:
    told = json.loads(body or b"{}")
    if not isinstance(told, dict):
        msg = "a request is a JSON object"
        raise InputError(msg)
    return told


def _json(value: Any) -> bytes:
    return json.dumps(value, ensure_ascii=False).encode("utf-8", "surrogatepass")
