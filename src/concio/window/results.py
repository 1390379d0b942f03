"""Answers, kept by the hash of the model and the question: asking the same again costs nothing."""

from __future__ import annotations

import hashlib
import json
import re
import secrets
import shutil
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from concio.window.folder import FILE_KEYS

MOST = 40
"""More answers than this are not kept; the oldest goes first."""
SHOWN = {".html": "text/html", ".svg": "image/svg+xml", ".png": "image/png"}
"""Files of an answer that the page shows."""

DATA = re.compile(r'<script[^>]*\bid="?data"?[^>]*>(.*?)</script>', re.DOTALL)
"""What a report draws from."""


class Results:
    """Directories of answers.

    Parameters
    ----------
    root : Path
        Where they are; made where it is missing.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._doors: dict[str, str] = {}

    def place(self, key: str) -> Path:
        """Return the directory of an answer that is to be computed, empty."""
        place = self.root / key
        shutil.rmtree(place, ignore_errors=True)
        self.root.mkdir(parents=True, exist_ok=True)
        return place

    def keep(self, key: str, answer: dict[str, Any]) -> None:
        """Keep an answer beside its files."""
        place = self.root / key
        place.mkdir(parents=True, exist_ok=True)
        fresh = place / ".answer.new"
        fresh.write_text(json.dumps(answer), encoding="utf-8")
        fresh.replace(place / ".answer.json")
        self._forget()

    def kept(self, key: str) -> dict[str, Any] | None:
        """Return an answer that is kept, or None."""
        try:
            found = json.loads((self.root / key / ".answer.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found if isinstance(found, dict) else None

    def known(self) -> list[dict[str, Any]]:
        """Return the answers that are kept, the newest first."""
        with suppress(OSError):
            found = sorted((p for p in self.root.iterdir() if p.is_dir()), key=lambda p: -p.stat().st_mtime)
            return [one for place in found if (one := self.kept(place.name)) is not None]
        return []

    def film(self, key: str) -> Any:
        """Return what an answer shows in motion: the data of its report or its ``motions.json``, or None."""
        place = self.root / key
        with suppress(OSError, ValueError):
            if (place / "motions.json").is_file():
                return json.loads((place / "motions.json").read_text(encoding="utf-8"))
            found = DATA.search((place / "report.html").read_text(encoding="utf-8"))
            return json.loads(found[1]) if found else None
        return None

    def files(self, key: str) -> list[str]:
        """Return the files of an answer that can be shown, the report first."""
        place = self.root / key
        if not place.is_dir():
            return []
        found = [p for p in place.rglob("*") if p.suffix in SHOWN and p.is_file()]
        names = sorted(p.relative_to(place).as_posix() for p in found)
        pictures = [n for n in names if not (n.endswith(".png") and n[:-4] + ".svg" in names)]
        return sorted(pictures, key=lambda n: n != "report.html")

    def door(self, key: str) -> str:
        """Return a random word that opens the files of this answer: a report does not see the token."""
        for word, known in self._doors.items():
            if known == key:
                return word
        word = secrets.token_urlsafe(16)
        self._doors[word] = key
        return word

    def behind(self, word: str, name: str) -> Path | None:
        """Return the file of an answer that a door opens, or None."""
        key = self._doors.get(word)
        return self.root / key / name if key is not None and name in self.files(key) else None

    def _forget(self) -> None:
        with suppress(OSError):
            found = sorted((p for p in self.root.iterdir() if p.is_dir()), key=lambda p: p.stat().st_mtime)
            for old in found[:-MOST]:
                shutil.rmtree(old, ignore_errors=True)


def key_of(text: str, data: Any, base: Path, argv: Sequence[str], version: str) -> str:
    """Return the key of an answer: text, files that the text names, question and version of the program."""
    told = hashlib.sha256(json.dumps([text, list(argv), version]).encode())
    for name in sorted(named_files(data)):
        with suppress(OSError, ValueError):
            told.update(name.encode() + b"\0" + (base / name).read_bytes())
    return told.hexdigest()[:32]


def named_files(data: Any, key: str = "") -> set[str]:
    """Return the texts in the tables of a model file that may name files."""
    if isinstance(data, dict):
        return set().union(*(named_files(v, k) for k, v in data.items()))
    if isinstance(data, list):
        return set().union(*(named_files(v, key) for v in data))
    return {data} if isinstance(data, str) and key in FILE_KEYS else set()
