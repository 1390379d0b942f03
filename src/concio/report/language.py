"""Words of the reports that are written in more than one language."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from concio.arguments import closest
from concio.errors import InputError


@cache
def words_of(table: str, language: str) -> Mapping[str, str]:
    """Return the words of a report in a language.

    Parameters
    ----------
    table : str
        File of this room, without its ending.
    language : str

    Raises
    ------
    InputError
        There is no such language.
    """
    read = tomllib.loads((files("concio.report") / f"{table}.toml").read_text(encoding="utf-8"))
    if language not in read:
        msg = f"there is no report in the language '{language}'"
        raise InputError(msg, hint=closest(language, tuple(read)))
    found: Mapping[str, str] = read[language]
    return found
