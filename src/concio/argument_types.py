"""What arguments must be: numbers, texts, sequences, or objects of the project, as their annotations say.

``Load("pressure", 20.0)``, ``concio.solve("wall.toml")`` or ``concio.thrust_line(model)`` raise an
error that says what was expected, before they fail deep inside. Only what annotations say for sure is checked: numbers,
texts, sequences and mappings of them, and the classes in :data:`CLASSES`; an alternative not known here lets everything
pass.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from numbers import Integral, Real
from os import PathLike
from typing import Any

CLASSES = {
    name: f"an {name}" if name[0] in "AE" else f"a {name}"
    for name in (
        "Body", "ControlPoint", "Elastic", "JointLaw", "JointRule", "Load", "PathResult",
        "Polyhedron", "Result", "Rigid", "Site", "Stage", "Stop", "Support", "Temperature", "Tie", "Units",
    )
}  # fmt: skip
"""Classes of the project that are distinguished from each other by their names."""

SEQUENCES, MAPPINGS = ("Sequence", "Several", "tuple", "list", "Iterable"), ("Mapping", "dict")

Check = Callable[[Any], bool]


def checker(annotation: object, *, inside: bool = False) -> tuple[Check, str] | None:
    """Return what tells whether a value obeys an annotation (a text), and what that asks for; None where unknown."""
    if not isinstance(annotation, str):
        return None
    found = [_alternative(part) for part in _split(annotation, "|")]
    if any(part == "float" for part in _split(annotation, "|")) and not inside:
        found.append(PLAIN["str"])  # what takes a number by itself also reads it with its unit, or refuses it in words
    known = [f for f in found if f is not None]
    if len(known) < len(found):
        return None
    words = list(dict.fromkeys(word for _, word in known if word != "None"))
    checks = [check for check, _ in known]
    return (lambda value: any(check(value) for check in checks)), " or ".join(words) or "None"


def _alternative(text: str) -> tuple[Check, str] | None:
    name, _, rest = text.partition("[")
    inner = _split(rest.removesuffix("]"), ",")
    if name in PLAIN and not rest:
        return PLAIN[name]
    if name in CLASSES:
        return (lambda value: any(kind.__name__ == name for kind in type(value).__mro__)), CLASSES[name]
    if name in SEQUENCES:
        each = checker(inner[0], inside=True) if len(inner) == 1 or inner[1:] == ["..."] else None
        words = "a sequence" if each is None else f"a sequence of {_plural(each[1])}"
        return (lambda value: _is_sequence(value) and (each is None or all(map(each[0], value)))), words
    if name in MAPPINGS and len(inner) == 2:
        entry = checker(inner[1], inside=True)
        words = "a mapping" if entry is None else f"a mapping of names to {_plural(entry[1])}"
        return (lambda v: isinstance(v, Mapping) and (entry is None or all(map(entry[0], v.values())))), words
    if name == "os.PathLike":
        return PLAIN["Path"]
    if name == "Literal":
        return (lambda value: isinstance(value, str)), "a text" if "'" in rest or '"' in rest else ""
    return None


def _is_number(value: object) -> bool:
    return isinstance(value, Real) or getattr(value, "shape", None) == ()


def _is_index(value: object) -> bool:
    return hasattr(value, "__index__") and getattr(value, "shape", ()) == ()


def _is_sequence(value: object) -> bool:
    return hasattr(value, "__iter__") and not isinstance(value, str | bytes | Mapping)


PLAIN: dict[str, tuple[Check, str]] = {
    "str": (lambda value: isinstance(value, str), "a text"),
    "float": (_is_number, "a number"),
    "int": (lambda value: isinstance(value, Integral) or _is_index(value), "a whole number"),
    "bool": (lambda value: isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"), "True or False"),
    "None": (lambda value: value is None, "None"),
    "Path": (lambda value: isinstance(value, PathLike), "a path"),
}


def _plural(words: str) -> str:
    parts = [part.removeprefix("a ").removeprefix("an ") for part in words.split(" or ")]
    return " or ".join(_plural_of(part) for part in parts)


def _plural_of(word: str) -> str:
    if " of " in word:
        return word
    return f"{word[:-1]}ies" if word.endswith("y") else f"{word}s"


def _split(text: str, mark: str) -> list[str]:
    """Return the parts of a text between marks that stand outside all brackets."""
    parts, depth = [""], 0
    for sign in text:
        depth += (sign in "[(") - (sign in "])")
        if sign == mark and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return [part.strip() for part in parts]


def told(value: object) -> str:
    """Return a value as an error message tells it."""
    kind = type(value)
    if kind.__module__.startswith("concio."):
        return f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}"
    text = repr(value)
    return text if len(text) <= 40 and "\n" not in text else f"a value of type {kind.__name__}"
