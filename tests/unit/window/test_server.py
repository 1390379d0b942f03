"""The server of the window answers its own page only, within limits, and survives what is done to it."""

from __future__ import annotations

import http.client
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Iterator
from contextlib import suppress
from http.client import HTTPException
from pathlib import Path
from typing import Any

import pytest

import concio
from concio.cli.answering_process import ask
from concio.cli.main import COMMANDS
from concio.window.document import Document
from concio.window.lane import Lane
from concio.window.questions import QUESTIONS, arguments, python_text
from concio.window.results import Results
from concio.window.server import LARGEST_DROP, LARGEST_REQUEST
from samples import sample
from windows import LATE, WORKER, Client, known, window

TEMPLATES = Path(concio.__file__).parent / "model" / "templates"
PILLAR = "[column]\nwidth = 0.5\nheight = 2.0\nblocks = 4\nblock = 'rigid'\nunit_weight = 20.0\nhorizontal = 0.1\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "open" / "pillar.toml"
    path.parent.mkdir()
    path.write_text(PILLAR, encoding="utf-8")
    (tmp_path / "secret.toml").write_text("secret = 1\n", encoding="utf-8")
    return path


@pytest.fixture
def client(file: Path) -> Iterator[Client]:
    with window(file.parent, file) as found:
        yield found


def test_the_page_is_sent_with_a_policy_that_lets_nothing_else_in(client: Client) -> None:
    status, headers, body = client.raw("GET", f"/{client.server.token}/")
    assert status == 200
    assert b"<!doctype html>" in body.lower()
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "script-src 'self'" in policy
    assert "unsafe" not in policy
    assert "http" not in policy
    assert headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    "headers",
    [{"Host": "evil.example"}, {"Host": "localhost:80"}, {"Host": "127.0.0.1"}, {"Origin": "http://evil.example"},
     {"Origin": "null"}],
)  # fmt: skip
def test_foreign_hosts_and_origins_are_refused(client: Client, method: str, headers: dict[str, str]) -> None:
    path = f"/{client.server.token}/" + ("api/state" if method == "POST" else "")
    status, _, body = client.raw(method, path, b"{}", **headers)
    assert status == 403
    assert b"pillar" not in body


def test_a_request_that_does_something_needs_the_origin_of_the_page(client: Client) -> None:
    path = f"/{client.server.token}/api/state"
    assert client.raw("POST", path, b"{}", Origin="")[0] == 403
    assert client.raw("POST", path, b"{}", Sec_Fetch_Site="cross-site")[0] == 403
    assert client.raw("POST", path, b"{}")[0] == 200


@pytest.mark.parametrize("token", ["", "x", "wrong-token-of-some-length-000000", "%00", "\u00e9".encode().hex()])
def test_a_wrong_token_is_refused(client: Client, token: str) -> None:
    for method, rest in (("GET", "index.html"), ("POST", "api/state"), ("POST", "drop"), ("GET", "")):
        status, _, body = client.raw(method, f"/{token}/{rest}", b"{}")
        assert status in (403, 404)
        assert client.server.token.encode() not in body


@pytest.mark.parametrize("tail", ["../session.py", "..%2fsession.py", "%2e%2e/session.py", "page/../../session.py",
                                  "index.html%00", "words.toml", "C:%5cx", "/etc/passwd", "a/" * 30])  # fmt: skip
def test_no_address_leads_out_of_the_page(client: Client, tail: str) -> None:
    status, _, body = client.raw("GET", f"/{client.server.token}/{tail}")
    assert status in (403, 404)
    assert b"def " not in body


def test_no_name_leads_out_of_the_folder(client: Client, file: Path) -> None:
    drop = f"/{client.server.token}/drop"
    assert "error" in client.call("open", name="missing.toml")
    for name in ("../secret.toml", str(file.parent.parent / "secret.toml"), "..\\secret.toml"):
        for call in ("open", "new"):
            answer = client.call(call, name=name, kind="wall")
            assert "error" in answer
            assert "secret = 1" not in json.dumps(answer)
        assert client.raw("POST", drop, b"x = 1", X_Name=name, X_Page=client.page)[0] == 409
    assert client.call("state")["document"]["name"] == "pillar.toml"
    assert (file.parent.parent / "secret.toml").read_text(encoding="utf-8") == "secret = 1\n"


@pytest.mark.parametrize(
    "body", [b"", b"[]", b"x", b"null", b'{"commands": 3}', b'{"commands": [{}]}', b"\xff", b"{" * 9000]
)
def test_requests_that_say_nothing_are_refused_and_change_nothing(client: Client, body: bytes) -> None:
    status, _, answer = client.raw("POST", f"/{client.server.token}/api/do", body)
    assert status in (400, 409)
    assert b"Traceback" not in answer
    assert client.call("state")["document"]["text"] == PILLAR


def test_what_is_too_large_is_refused_before_it_is_read(client: Client) -> None:
    for path, most in (("api/do", LARGEST_REQUEST), ("drop", LARGEST_DROP)):
        for size in (most + 1, 200_000_000, 10**18):
            with socket.create_connection(("127.0.0.1", client.server.server_port), timeout=LATE) as raw:
                head = f"POST /{client.server.token}/{path} HTTP/1.1\r\nContent-Length: {size}\r\n"
                head += f"Host: 127.0.0.1:{client.server.server_port}\r\nOrigin: {client.server.origin}\r\n\r\n"
                raw.sendall(head.encode())
                assert raw.recv(4096).startswith(b"HTTP/1.1 413")
    for length in ("-1", "x", "1e3"):
        assert client.raw("POST", f"/{client.server.token}/api/state", None, Content_Length=length)[0] in (400, 411)
    assert client.call("state")["document"]["name"] == "pillar.toml"


@pytest.mark.long
def test_many_requests_and_connections_leave_it_answering(client: Client) -> None:
    begun = threading.active_count()
    idle = [socket.create_connection(("127.0.0.1", client.server.server_port), timeout=LATE) for _ in range(200)]
    for connection in idle:
        connection.close()
    # more than 64 at a time are refused: these end first
    end = time.monotonic() + LATE
    while threading.active_count() > begun + 3 and time.monotonic() < end:
        time.sleep(0.05)
    for k in range(sample(300, 1000, 3000)):
        assert client.raw("POST", f"/{'wrong' if k % 3 else client.server.token}/api/state", b"{}")[0] in (200, 403)
    end = time.monotonic() + LATE
    while threading.active_count() > begun + 3 and time.monotonic() < end:
        time.sleep(0.05)
    assert threading.active_count() <= begun + 3
    assert client.call("state")["document"]["text"] == PILLAR


def test_commands_change_the_text_and_are_taken_back(client: Client) -> None:
    first = client.call("state")["document"]
    changed = client.do({"do": "set", "path": ["column", "width"], "written": "'60 cm'"})["document"]
    assert "width = \"60 cm\"" in changed["text"]
    assert (changed["saved"], changed["undo"]) == (False, "set width")
    stale = client.call("do", hash=first["hash"], commands=[{"do": "set", "path": ["column", "blocks"], "value": 5}])
    assert "has changed since" in stale["error"]["what"]
    assert client.call("undo")["document"]["text"] == PILLAR
    assert client.call("redo")["document"]["text"] == changed["text"]
    assert client.call("save")["document"]["saved"]


def test_the_second_page_reads_only_until_it_takes_the_pen(client: Client) -> None:
    assert client.call("state")["mine"]
    other = Client(client.server, "page-2")
    assert not other.call("state")["mine"]
    refused = other.do({"do": "set", "path": ["column", "width"], "value": 0.7})
    assert "read-only" in refused["error"]["what"]
    assert other.call("take")["mine"]
    assert not client.call("state")["mine"]
    assert "text" in other.do({"do": "set", "path": ["column", "width"], "value": 0.7})["document"]
    other.call("bye")
    assert client.call("state")["mine"]


def test_a_second_window_on_the_file_says_that_it_reads_only(client: Client, file: Path) -> None:
    with window(file.parent, file) as other:
        assert "another window" in other.call("state")["document"]["read_only"]
        assert "another window" in other.do({"do": "set", "path": ["column", "width"], "value": 1})["error"]["what"]


def test_a_dropped_file_never_replaces_another(client: Client, file: Path) -> None:
    path = f"/{client.server.token}/drop"
    status, _, body = client.raw("POST", path, b"[column]\nwidth = 9\n", X_Name="pillar.toml", X_Page=client.page)
    assert status == 409
    assert b"another file of that name" in body
    assert file.read_text(encoding="utf-8") == PILLAR
    status, _, body = client.raw("POST", path, b"title = 'new'\n", X_Name="new.toml", X_Page=client.page)
    assert json.loads(body)["document"]["text"] == "title = 'new'\n"


def test_a_file_starts_from_every_template_of_the_command_line(client: Client, file: Path) -> None:
    for kind in client.call("hello")["templates"]:
        document = client.call("new", kind=kind)["document"]
        assert document["text"] == (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")
    assert client.call("new", kind="wall")["document"]["name"] == "wall2.toml"
    assert (file.parent / "wall2.toml").exists()
    assert "error" in client.call("new", kind="../wall")


def test_questions_are_commands_and_their_options_are_not_other_options() -> None:
    assert set(QUESTIONS) <= {command.__name__ for command in COMMANDS}
    given = arguments("push", {"direction": "-x", "groups": ["--out=/tmp/x"]})
    assert given == ["--direction=-x", "--group=--out=/tmp/x"]
    for bad in ({"out": "x"}, {"direction": "z"}, {"groups": [3]}, {"groups": ["a\n"]}):
        with pytest.raises(concio.InputError):
            arguments("push", bad)
    for name in QUESTIONS:
        compile(python_text(name, {}, "it's.toml"), name, "exec")


def test_a_lane_answers_the_newest_and_ends_what_is_cancelled() -> None:
    code = ("import sys, json, time\nfor line in sys.stdin:\n r = json.loads(line)\n time.sleep(r['sleep'])\n"
            " print(json.dumps({'id': r['id'], 'done': r['sleep']}), flush=True)\n")  # fmt: skip
    lane = Lane([sys.executable, "-c", code])
    try:
        slow = lane.ask({"kind": "x", "sleep": 600})
        newest = lane.ask({"kind": "x", "sleep": 0})
        assert slow.over.wait(LATE)
        assert newest.over.wait(LATE)
        assert (slow.state, newest.state, newest.answer) == ("cancelled", "done", 0)
        again = lane.ask({"kind": "x", "sleep": 600})
        while lane.pid is None or again.state != "working":
            time.sleep(0.01)
        lane.cancel()
        assert again.over.wait(LATE)
        assert again.state == "cancelled"
        killed = lane.ask({"kind": "x", "sleep": 600})
        while lane.pid is None or killed.state != "working":
            time.sleep(0.01)
        os.kill(lane.pid, signal.SIGKILL)
        assert killed.over.wait(LATE)
        assert "ended from outside" in killed.answer["what"]
        last = lane.ask({"kind": "x", "sleep": 0})
        assert last.over.wait(LATE)
        assert last.state == "done"
    finally:
        lane.close()


class GivenUpWhileItStarts(Lane):
    """A lane whose first request is given up in the moment in which its process starts."""

    given_up = False

    def _started(self) -> Any:
        process = super()._started()
        if not self.given_up:
            self.given_up = True
            self.cancel()
        return process


def test_a_request_that_is_given_up_while_its_process_starts_stays_given_up() -> None:
    code = ("import sys, json\nfor line in sys.stdin:\n r = json.loads(line)\n"
            " print(json.dumps({'id': r['id'], 'done': 1}), flush=True)\n")  # fmt: skip
    lane = GivenUpWhileItStarts([sys.executable, "-c", code])
    try:
        first = lane.ask({"kind": "x"})
        assert first.over.wait(LATE)
        last = lane.ask({"kind": "x"})
        assert last.over.wait(LATE)
        assert (first.state, last.state) == ("cancelled", "done")
    finally:
        lane.close()


def test_a_question_that_cannot_be_asked_is_refused_and_not_waited_for(
    client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = client.server.session.document
    assert document is not None
    results = document.folder / "results"
    results.write_text("in the way\n", encoding="utf-8")
    refused = client.call("ask", question="run")
    assert "cannot write there" in refused["error"]["what"]
    assert client.call("state")["asked"] is None
    assert [p.name for p in document.file.parent.glob(".*.toml")] == []
    results.unlink()
    client.call("ask", question="run")
    number = client.call("state")["asking"]
    monkeypatch.setattr(Results, "place", lambda *_: (results / "missing" / "place").mkdir())
    assert "error" in client.call("ask", question="limit")
    state = client.call("state")
    assert state["asking"] == number
    assert state["asked"]["question"] == "run"
    assert state["asked"]["state"] == "cancelled"


def test_a_question_has_a_number_and_so_has_what_is_told_of_it(client: Client) -> None:
    before = client.call("state")["asking"]
    asked = client.call("ask", question="run")
    assert asked["asking"] == before + 1
    assert client.call("cancel")["asking"] == before + 1
    assert client.call("ask", question="run")["asking"] == before + 2
    assert client.call("new", kind="column")["asking"] > before + 2


def test_a_file_that_cannot_be_written_is_told(client: Client, file: Path) -> None:
    path = f"/{client.server.token}/drop"
    (file.parent / "wall.toml").mkdir()
    status, _, body = client.raw("POST", path, b"x = 1\n", X_Name="wall.toml", X_Page=client.page)
    assert status == 409
    assert "cannot be read or written" in json.loads(body)["error"]["what"]


@pytest.mark.long
def test_the_picture_and_the_answers_are_those_of_the_commands(client: Client, file: Path) -> None:
    found = client.until("picture")["done"]
    model = concio.load(file)
    assert [b["name"] for b in found["bodies"]] == [b.name for b in model.bodies]
    assert found["attention"] == list(concio.solve(model).verdict.attention)
    told = client.until("acts", question="limit", options={"groups": ["live"]})["done"]["lines"]
    assert [line.partition(":")[0] for line in told[:2]] == ["dead", "live"]
    answer = client.answer("run")
    verdict = concio.solve(model).verdict
    assert answer["verdict"] == json.loads(json.dumps(verdict.as_dict()))
    assert verdict.sentence in answer["lines"]
    assert (answer["code"], answer["files"][0].endswith("report.html")) == (0, True)
    status, headers, report = client.raw("GET", "/" + answer["files"][0])
    assert (status, verdict.sentence.encode() in report) == (200, True)
    assert "sandbox" in headers["Content-Security-Policy"]
    assert client.server.token.encode() not in report
    assert client.answer("run")["kept"]
    client.do({"do": "set", "path": ["column", "unit_weight"], "value": 21.0})
    assert "kept" not in client.answer("run")
    limit = client.answer("limit", groups=["live"])
    now = concio.loads(client.call("state")["document"]["text"])
    assert limit["verdict"]["sentence"] == concio.limit(now).verdict.sentence
    exported = Path(client.call("export", key=limit["key"])["folder"])
    assert {p.name for p in exported.iterdir()} == {"pillar.toml", "limit", "question.txt", "question.py"}
    run = subprocess.run([sys.executable, "question.py"], cwd=exported, capture_output=True, text=True, check=True)
    assert limit["verdict"]["sentence"] in run.stdout
    assert [p.name for p in file.parent.iterdir() if p.name.startswith(".") and p.suffix == ".toml"] == []


@pytest.mark.long
def test_a_killed_worker_is_reported_and_the_next_question_answered(client: Client) -> None:
    client.until("picture")
    client.call("ask", question="run")
    lane, end = client.server.session.asked.lane, time.monotonic() + LATE
    while lane.job is None or lane.job.request["kind"] != "ask" or lane.job.state != "working":
        assert time.monotonic() < end
        time.sleep(0.002)
    pid = lane.pid
    assert pid is not None
    os.kill(pid, signal.SIGKILL)
    asked = client.until("state")["asked"]
    assert "ended from outside" in client.call("result", key=asked["key"])["message"]
    assert client.answer("run")["code"] == 0
    client.call("ask", question="limit", options={"groups": ["live"]})
    assert client.call("cancel")["asked"]["state"] == "cancelled"


@pytest.mark.long
def test_mistakes_are_told_in_the_words_of_the_commands(client: Client) -> None:
    client.do({"do": "set", "path": ["column", "width"], "value": -1})
    fault = client.until("picture")["error"]
    assert "width" in fault["what"] + fault["where"]
    answer = client.answer("run")
    assert answer["code"] == 2
    assert "pillar.toml" in answer["message"]
    assert "width" in answer["message"]
    assert "Traceback" not in answer["message"]
    client.do({"do": "text", "text": "blocks_file = '../secret.toml'\n"})
    assert "outside the folder" in client.until("picture")["error"]["what"]
    assert "outside the folder" in client.call("ask", question="run")["error"]["what"]


@pytest.mark.long
def test_a_dragged_load_is_shown_with_certified_bounds(client: Client) -> None:
    load = {"kind": "point", "value": [1.0, 0.0], "bodies": ["b04"], "at": [0.0, 2.0], "group": "push"}
    client.do({"do": "add", "to": "loads", "table": load})
    text = client.call("state")["document"]["text"]
    for y in (2.0, 1.75, 1.5):
        found = client.call("drag", table=0, at=[0.0, y], body="b04")["done"]
        assert 0.0 < found["seconds"] < 120.0
        moved = concio.loads(text.replace("[0.0, 2.0]", f"[0.0, {y}]"))
        bound = concio.limit(moved, "push", path=False, search=False, steps=False).associated.multiplier
        assert found["multiplier"] == pytest.approx(bound, rel=1e-9)
        assert "no equilibrium beyond it" in found["lines"][0]
    assert "error" in client.call("drag", table=0, at=[9.0, 9.0], body="b04")
    assert client.call("state")["document"]["text"] == text


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_window_that_is_closed_answers_nobody_any_more(file: Path) -> None:
    """A connection that the page keeps open ends with the window; a request that waits for a picture does too."""
    with window(file.parent, file) as client:
        server = client.server
        kept = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=LATE)
        path, own = f"/{server.token}/api/state", {"Origin": server.origin}
        kept.request("POST", path, b'{"page": "page-1"}', own)
        assert json.loads(kept.getresponse().read())["document"]["name"] == file.name
        assert kept.sock is not None
    assert kept.sock.recv(1) == b"", "the connection is over"


@pytest.mark.long
def test_a_request_that_is_being_answered_ends_with_its_window(file: Path) -> None:
    with window(file.parent, file) as client:
        client.until("picture")
        lane, ended = client.server.session.look, []
        lane.close()
        late = Lane([sys.executable, "-c", "import time; time.sleep(1000)"], 100.0)
        client.server.session.look = late

        def waiting() -> None:
            with suppress(OSError, HTTPException, ValueError):
                ended.append(client.call("acts", question="run", options={}))
            ended.append("over")

        thread = threading.Thread(target=waiting)
        thread.start()
        end = time.monotonic() + LATE
        while late.job is None:
            assert time.monotonic() < end
            time.sleep(0.01)
    thread.join(LATE)
    assert ended[-1] == "over"
    assert late.ask({"kind": "picture"}).state == "cancelled", "a lane that is closed keeps nobody waiting"


def test_a_killed_server_loses_nothing(file: Path) -> None:
    command = [sys.executable, "-m", "concio", "window", str(file), "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        client = known(process.stdout.readline().split()[-1])
        for width in (0.6, 0.7):
            client.do({"do": "set", "path": ["column", "width"], "value": width})
        process.kill()
    doc = Document(file)
    assert doc.text == PILLAR.replace("0.5", "0.7")
    assert doc.recovered == 2
    doc.close()
    shutil.rmtree(doc.folder)


@pytest.mark.long
@pytest.mark.parametrize("delay", [0.05, 0.11, 0.23])
def test_a_server_that_is_killed_in_the_middle_of_a_command_loses_no_command_it_has_answered(
    file: Path, delay: float
) -> None:
    command = [sys.executable, "-m", "concio", "window", str(file), "--no-open"]
    answered: list[float] = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        client = known(process.stdout.readline().split()[-1])
        client.call("ask", question="run")

        def hands() -> None:
            for k in range(100_000):
                try:
                    client.do({"do": "set", "path": ["column", "width"], "value": 0.5 + 1e-5 * (k + 1)})
                except (OSError, ValueError, HTTPException):
                    return
                answered.append(0.5 + 1e-5 * (k + 1))

        thread = threading.Thread(target=hands)
        thread.start()
        while not answered:
            time.sleep(0.001)
        time.sleep(delay)
        process.kill()
        thread.join(LATE)
    doc = Document(file)
    width = tomllib.loads(doc.text)["column"]["width"]
    assert width in (pytest.approx(answered[-1], abs=1e-9), pytest.approx(answered[-1] + 1e-5, abs=1e-9))
    assert doc.recovered in (len(answered), len(answered) + 1)
    assert file.read_text(encoding="utf-8") == PILLAR
    while doc.done:
        doc.undo()
    assert doc.text == PILLAR
    doc.close()


def test_copies_that_a_killed_program_left_are_removed_and_nothing_else(file: Path) -> None:
    left = file.parent / ".pillar.0123456789ab.toml"
    others = [file.parent / name for name in (".pillar.mine.toml", ".pillar.toml", ".wall.0123456789ab.toml")]
    for path in (left, *others):
        path.write_text("x = 1\n", encoding="utf-8")
    with window(file.parent, file):
        assert not left.exists()
        assert all(path.exists() for path in others)


@pytest.mark.long
def test_the_command_refuses_what_it_cannot_open(tmp_path: Path) -> None:
    (tmp_path / "a.exe").write_text("x", encoding="utf-8")
    for arguments_ in (["missing.toml"], ["--folder", "missing"], ["a.exe"]):
        done = subprocess.run([sys.executable, "-m", "concio", "window", "--no-open", *arguments_], cwd=tmp_path,
                              capture_output=True, text=True, timeout=LATE, check=False)  # fmt: skip
        assert done.returncode == 2, done.stderr
        assert "Traceback" not in done.stderr
        assert "->" in done.stderr


def test_the_worker_answers_in_lines_of_its_own() -> None:
    asked = '{"id": 1, "kind": "nothing"}\n'
    done = subprocess.run(WORKER, input=asked, capture_output=True, text=True, timeout=LATE, check=True)
    assert json.loads(done.stdout)["error"]["what"].startswith("this is a bug")


def test_a_verdict_is_told_before_its_report_is_written(file: Path, tmp_path: Path) -> None:
    out, told = tmp_path / "out", []

    def tell(word: str, what: Any) -> None:
        if word == "early":
            told.append((what, out.exists()))

    argv = ["run", str(file), "--out", str(out), "--no-figures"]
    answer = ask({"argv": argv, "out": str(out), "file": str(file), "name": file.name}, tell)
    [(early, written)] = told
    assert not written
    assert json.loads(json.dumps(early)) == {key: answer[key] for key in ("code", "verdict", "italian")}


def test_a_lane_shows_what_is_early_before_the_end() -> None:
    code = ("import sys, json\nfor line in sys.stdin:\n r = json.loads(line)\n"
            " print(json.dumps({'id': r['id'], 'early': 'soon'}), flush=True)\n"
            " sys.stdin.readline()\n print(json.dumps({'id': r['id'], 'done': 1}), flush=True)\n")  # fmt: skip
    lane = Lane([sys.executable, "-c", code])
    try:
        lane.start()
        job = lane.ask({"kind": "x"})
        assert job.shown.wait(LATE)
        assert (job.early, job.answer, job.over.is_set()) == ("soon", None, False)
    finally:
        lane.close()
    assert job.state == "cancelled"
