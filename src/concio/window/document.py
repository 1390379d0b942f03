"""The document: the TOML text of a model, with undo, redo, a journal, and the file it belongs to.

The file itself is written on request only. Until then every change is in the journal, and opening the file again brings
it back. Where another program has changed the file, both texts are kept until the user has chosen one.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from concio.errors import InputError
from concio.files import read_text, whole_file
from concio.window.journal import Journal, Lock, folder_of, hash_of
from concio.window.toml_edits import Patch, difference

LARGEST_TEXT = 20_000_000
"""A model text of more letters is not edited in the window."""

READ_ONLY = "this window is read-only: the file is open in another window"


@dataclass(frozen=True)
class Change:
    """A patch with the name of the command that made it."""

    patch: Patch
    label: str


class Document:
    """A model file that is open for editing.

    Parameters
    ----------
    file : Path
        The file; it exists.

    Raises
    ------
    InputError
        The file cannot be read, or its changes cannot be kept.
    """

    def __init__(self, file: Path) -> None:
        self.file = file.resolve()
        self.folder = folder_of(self.file)
        self._guard = threading.RLock()
        self._lock, self._journal = Lock(self.folder), Journal(self.folder)
        on_disk = self._read()
        raw = self.file.read_bytes()[:200_000]
        self._bom, self._crlf = raw.startswith(b"\xef\xbb\xbf"), b"\r\n" in raw
        self.text, self.saved = on_disk, on_disk
        self.undone: list[Change] = []
        self.done: list[Change] = []
        self.recovered = 0
        self.conflict: str | None = None
        self.version = 1
        try:
            self.read_only = "" if self._lock.take() else READ_ONLY
        except OSError as error:
            self.read_only = f"this window is read-only: nothing can be written beside the file ({error.strerror})"
        if not self.read_only:
            self._recover(on_disk)

    def _read(self) -> str:
        text = read_text(self.file, hint="start one with: concio new panel")
        if len(text) > LARGEST_TEXT:
            msg = f"the text has more than {LARGEST_TEXT / 1e6:.0f} million letters"
            raise InputError(msg, where=str(self.file), hint="put the blocks into a table: blocks_file = 'blocks.csv'")
        return text

    def _recover(self, on_disk: str) -> None:
        """Take up the changes of the journal, where they lead from or to the text on the disk."""
        entries = self._journal.read()
        try:
            text, done, undone, count, saved = _replayed(entries)
        except (InputError, KeyError, TypeError, ValueError):
            entries = []
        if not entries:
            self._journal.begin(on_disk)
            return
        self._journal.go_on(len(entries))
        self.text, self.done, self.undone, self.saved = text, done, undone, saved
        if text == on_disk:
            self.saved = on_disk
        elif on_disk == saved:
            self.recovered = count
        else:
            self.conflict = on_disk

    @property
    def hash(self) -> str:
        """Hash of the text."""
        return hash_of(self.text)

    @property
    def is_saved(self) -> bool:
        """Whether the file holds the text."""
        return self.text == self.saved

    def change(self, patch: Patch, label: str) -> None:
        """Apply a patch and keep it.

        Raises
        ------
        InputError
            The window is read-only, the patch does not fit, or it cannot be kept.
        """
        with self._guard:
            self._writable()
            if patch.removed == patch.inserted:
                return
            text = patch.applied(self.text)
            if len(text) > LARGEST_TEXT:
                msg = "the text would be too long"
                raise InputError(msg, hint="put the blocks into a table: blocks_file = 'blocks.csv'")
            self._keep("do", patch, label)
            self.text, self.undone = text, []
            self.done.append(Change(patch, label))

    def undo(self) -> str:
        """Take the last change back; return its name, empty where there is none."""
        with self._guard:
            self._writable()
            if not self.done:
                return ""
            change = self.done[-1]
            text = change.patch.inverse.applied(self.text)
            self._keep("undo", change.patch.inverse, change.label)
            self.text = text
            self.undone.append(self.done.pop())
            return change.label

    def redo(self) -> str:
        """Make the change again that was taken back last; return its name, empty where there is none."""
        with self._guard:
            self._writable()
            if not self.undone:
                return ""
            change = self.undone[-1]
            text = change.patch.applied(self.text)
            self._keep("redo", change.patch, change.label)
            self.text = text
            self.done.append(self.undone.pop())
            return change.label

    def save(self) -> None:
        """Write the text to the file.

        Raises
        ------
        InputError
            The window is read-only, another program has changed the file, or it cannot be written.
        """
        with self._guard:
            self._writable()
            self.look()
            if self.conflict is not None:
                msg = "another program has changed the file"
                raise InputError(msg, where=self.file.name, hint="choose which text to keep")
            self._write()

    def look(self) -> None:
        """Look whether another program has changed the file; take its text where nothing was changed here."""
        with self._guard:
            try:
                on_disk = self._read()
            except InputError:
                return  # removed or moved for a moment: saving writes it again
            if on_disk in (self.saved, self.text):
                self.conflict = None
                self.saved = on_disk
            elif self.read_only or self.is_saved:
                self._take(on_disk)
            elif on_disk != self.conflict:
                self.conflict = on_disk
                self.version += 1

    def resolve(self, keep: Literal["mine", "theirs"]) -> None:
        """Choose between the text here and that of another program; the choice can be undone."""
        with self._guard:
            self._writable()
            if self.conflict is None:
                return
            theirs, self.conflict = self.conflict, None
            if keep == "theirs":
                self._take(theirs)
            else:
                self._write()

    def _take(self, on_disk: str) -> None:
        """Take the text of the file as a change of its own."""
        if self.read_only:
            self.text = self.saved = on_disk
            self.version += 1
            return
        self.change(difference(self.text, on_disk), "text of the file")
        self.saved = on_disk
        self._journal.add({"kind": "save", "hash": hash_of(on_disk)})

    def close(self) -> None:
        """Give the file back; what was not saved stays in the journal."""
        with self._guard:
            self._journal.close()
            self._lock.release()
            self.read_only = "the file was closed"

    def _write(self) -> None:
        text = ("\ufeff" if self._bom else "") + (self.text.replace("\n", "\r\n") if self._crlf else self.text)
        try:
            with whole_file(self.file) as fresh:
                fresh.write_bytes(text.encode("utf-8"))
        except OSError as error:
            msg = f"cannot be written: {error.strerror or error}"
            raise InputError(msg, where=str(self.file), hint="the changes stay in the journal") from None
        self.saved, self.recovered = self.text, 0
        self.version += 1
        self._journal.add({"kind": "save", "hash": hash_of(self.text)})

    def _keep(self, kind: str, patch: Patch, label: str) -> None:
        self._journal.add({"kind": kind, "patch": [patch.start, patch.removed, patch.inserted], "label": label})
        self.version += 1

    def _writable(self) -> None:
        if self.read_only:
            raise InputError(self.read_only, where=self.file.name, hint="close the other window, then open it again")


def _replayed(entries: list[dict[str, Any]]) -> tuple[str, list[Change], list[Change], int, str]:
    """Return text, changes to undo and to redo, how many came after the last saving, and the text saved last."""
    if not entries:
        return "", [], [], 0, ""
    text: str = entries[0]["text"]
    saved, count = text, 0
    done: list[Change] = []
    undone: list[Change] = []
    for entry in entries[1:]:
        if entry["kind"] == "save":
            if entry["hash"] == hash_of(text):
                saved, count = text, 0
            continue
        start, removed, inserted = entry["patch"]
        patch = Patch(int(start), str(removed), str(inserted))
        text = patch.applied(text)
        count += 1
        label = str(entry["label"])
        if entry["kind"] == "undo":
            undone.append(Change(patch.inverse, label))
            done.pop()
        else:
            done.append(Change(patch, label))
            if entry["kind"] == "redo":
                undone.pop()
            else:
                undone = []
    return text, done, undone, count, saved
