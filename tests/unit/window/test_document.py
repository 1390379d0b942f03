"""The document outlives the program: journal, undo, two windows, files that others change."""

from __future__ import annotations

from pathlib import Path

import pytest

from concio.errors import InputError
from concio.window.commands import patch_of
from concio.window.document import Document
from concio.window.folder import check_files, named

TEXT = "# mine\ntitle = 'a'\n\n[column]\nwidth = 0.5\nheight = 2.0\nblocks = 4\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "pillar.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def change(doc: Document, key: str, value: object) -> None:
    doc.change(*patch_of(doc.text, {"do": "set", "path": ["column", key], "value": value}))


def killed(doc: Document) -> None:
    """End a document as a killed program does: nothing is written, the system gives the lock back."""
    doc._lock.release()


def test_the_file_is_written_on_request_only(file: Path) -> None:
    doc = Document(file)
    change(doc, "width", 0.6)
    assert file.read_text(encoding="utf-8") == TEXT
    assert not doc.is_saved
    doc.save()
    assert file.read_text(encoding="utf-8") == TEXT.replace("0.5", "0.6")
    assert doc.is_saved
    doc.close()


def test_a_killed_program_loses_nothing(file: Path) -> None:
    doc = Document(file)
    for width in (0.6, 0.7, 0.8):
        change(doc, "width", width)
    doc.undo()
    killed(doc)
    again = Document(file)
    assert (again.text, again.recovered) == (TEXT.replace("0.5", "0.7"), 4)
    assert again.redo() == "set width"
    assert again.text == TEXT.replace("0.5", "0.8")
    for _ in range(3):
        again.undo()
    assert again.text == TEXT
    assert again.undo() == ""
    again.close()


@pytest.mark.parametrize("share", [0.05, 0.5, 0.99])
def test_a_half_written_line_of_the_journal_is_left_out(file: Path, share: float) -> None:
    doc = Document(file)
    change(doc, "width", 0.6)
    whole = len(doc._journal.path.read_bytes())
    change(doc, "height", 3.0)
    raw = doc._journal.path.read_bytes()
    killed(doc)
    doc._journal.path.write_bytes(raw[: whole + max(1, int(share * (len(raw) - whole - 1)))])
    again = Document(file)
    assert again.text == TEXT.replace("0.5", "0.6")
    change(again, "blocks", 5)
    killed(again)
    third = Document(file)
    assert third.text == TEXT.replace("0.5", "0.6").replace("4", "5")
    third.close()


def test_a_journal_that_is_not_one_is_begun_again(file: Path) -> None:
    doc = Document(file)
    doc.close()
    other, strange = b'{"format": 99, "text": "x"}\n', b'{"format": 1, "text": "x"}\n{"kind": "do"}\n'
    for raw in (b"\x00\xff", b"{}\n", other, strange):
        doc._journal.path.write_bytes(raw)
        again = Document(file)
        assert again.text == TEXT
        again.close()


def test_the_second_window_reads_only_and_says_so(file: Path) -> None:
    first, second = Document(file), Document(file)
    assert first.read_only == ""
    assert "another window" in second.read_only
    with pytest.raises(InputError, match="another window"):
        change(second, "width", 0.6)
    with pytest.raises(InputError, match="another window"):
        second.save()
    change(first, "width", 0.6)
    first.save()
    second.look()
    assert second.text == first.text
    second.close()
    third = Document(file)
    assert third.read_only
    first.close()
    fourth = Document(file)
    assert not fourth.read_only
    fourth.close()


@pytest.mark.parametrize("keep", ["mine", "theirs"])
def test_a_file_that_changes_underneath_is_never_overwritten_without_being_asked(file: Path, keep: str) -> None:
    doc = Document(file)
    theirs = TEXT.replace("2.0", "9.0")
    change(doc, "width", 0.6)
    mine = doc.text
    file.write_text(theirs, encoding="utf-8")
    with pytest.raises(InputError, match="another program has changed the file"):
        doc.save()
    assert file.read_text(encoding="utf-8") == theirs
    assert doc.conflict == theirs
    doc.resolve(keep)  # type: ignore[arg-type]
    assert doc.text == file.read_text(encoding="utf-8") == (mine if keep == "mine" else theirs)
    if keep == "theirs":
        doc.undo()
        assert doc.text == mine
    doc.close()


def test_a_file_that_changed_while_no_window_was_open_leaves_both_texts(file: Path) -> None:
    doc = Document(file)
    change(doc, "width", 0.6)
    mine = doc.text
    killed(doc)
    file.write_text(TEXT + "# theirs\n", encoding="utf-8")
    again = Document(file)
    assert again.text == mine
    assert again.conflict == TEXT + "# theirs\n"
    again.close()


def test_a_file_that_nobody_changed_here_follows_the_disk(file: Path) -> None:
    doc = Document(file)
    file.write_text(TEXT + "# theirs\n", encoding="utf-8")
    doc.look()
    assert doc.text == TEXT + "# theirs\n"
    assert doc.is_saved
    doc.undo()
    assert doc.text == TEXT
    doc.close()


def test_line_ends_and_the_mark_of_the_byte_order_stay(file: Path) -> None:
    file.write_bytes(b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode())
    doc = Document(file)
    change(doc, "width", 0.6)
    doc.save()
    assert file.read_bytes() == b"\xef\xbb\xbf" + TEXT.replace("0.5", "0.6").replace("\n", "\r\n").encode()
    doc.look()
    assert doc.is_saved
    doc.close()


@pytest.mark.parametrize(
    "name",
    ["../a.toml", "/etc/passwd", "a/b.toml", "..\\a.toml", "C:\\a.toml", ".hidden.toml", "a.exe", "", " a.toml",
     "a\0.toml", "a\n.toml", "con.toml", "a" * 200 + ".toml", None, 3, ["a.toml"], "link.toml", "a:b.toml"],
)  # fmt: skip
def test_names_stay_in_the_folder(tmp_path: Path, name: object) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "secret.toml").write_text("x = 1", encoding="utf-8")
    (tmp_path / "inner" / "link.toml").symlink_to(tmp_path / "secret.toml")
    with pytest.raises(InputError):
        named(tmp_path / "inner", name)


def test_files_that_a_model_names_stay_in_the_folder(tmp_path: Path) -> None:
    inner = {"blocks_file": "a.csv", "parts": [{"file": "b.toml"}], "site": {"code": "ntc2018"}}
    check_files(inner, tmp_path, tmp_path)
    for bad in ({"blocks_file": "../a.csv"}, {"parts": [{"file": "/etc/passwd"}]}, {"site": {"code": "../c.toml"}}):
        with pytest.raises(InputError, match="outside the folder"):
            check_files(bad, tmp_path, tmp_path)
