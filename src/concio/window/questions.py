"""The questions of the page: each is a command, with the options that a button and a few fields give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from concio.errors import InputError

LONGEST_OPTION = 200


@dataclass(frozen=True)
class Option:
    """A field of a question.

    Parameters
    ----------
    name : str
    flag : str
        Option of the command.
    kind : {"groups", "moved", "text", "flag", "choice"}
        "groups" are load groups, "moved" is one that moves supports.
    choices : tuple of str
    """

    name: str
    flag: str
    kind: str = "text"
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class Asking:
    """A question that the page offers.

    Parameters
    ----------
    name : str
        The command.
    needs : tuple of str
        Tables of the file of which one must be there, or "moved" for a support that moves; none for every model.
    options : tuple of Option
    fixed : tuple of str
        Arguments that are always given.
    python : str
        The same from Python; ``{groups}`` stands for the groups that are multiplied.
    plane : bool
        Whether it is for models in the plane only.
    """

    name: str
    needs: tuple[str, ...] = ()
    options: tuple[Option, ...] = ()
    fixed: tuple[str, ...] = ()
    python: str = ""
    plane: bool = False


GROUPS = Option("groups", "--group", "groups")
LANGUAGE = Option("language", "--language", "choice", ("en", "it"))
QUESTIONS = {
    q.name: q
    for q in (
        Asking("run", (), (Option("factor", "--factor"), LANGUAGE), ("--no-figures",), "concio.solve(model)"),
        Asking("limit", (), (GROUPS, Option("quick", "--quick", "flag"), LANGUAGE), (),
               "concio.limit(model, {groups})"),
        Asking("path", (), (Option("stage", "--stage"), Option("point", "--point"), Option("until", "--until"),
                            LANGUAGE), (),
               "concio.run_path(model)"),
        Asking("settle", ("moved",), (Option("moving", "--group", "moved"), Option("amount", "--amount"), LANGUAGE), (),
               "concio.settle(model)"),
        Asking("push", (), (GROUPS, Option("weights", "--weights", "flag"),
                            Option("direction", "--direction", "choice", ("x", "-x", "y", "-y")), LANGUAGE), (),
               "concio.push(model, live={groups})"),
        Asking("shake", (), (Option("pulse", "--pulse"), Option("duration", "--duration"), LANGUAGE), (), "",
               plane=True),
        Asking("assess", ("site",), (LANGUAGE,)),
        Asking("bridge", ("vehicle",), (Option("required", "--required"), Option("second", "--second"),
                                        LANGUAGE), (),
               "concio.assess_bridge(model)"),
        Asking("diagnose", ("survey",), (LANGUAGE,)),
        Asking("study", ("study",), (LANGUAGE,)),
    )
}  # fmt: skip
"""Every question, in the order of its button."""


def arguments(name: object, options: Mapping[str, Any]) -> list[str]:
    """Return the arguments of a question's command, without the file and ``--out``.

    Raises
    ------
    InputError
        There is no such question or option, or a value is not of its kind.
    """
    asking = QUESTIONS.get(str(name))
    if asking is None:
        msg = f"unknown question '{name}'"
        raise InputError(msg, hint="one of " + ", ".join(QUESTIONS))
    known = {o.name: o for o in asking.options}
    found = list(asking.fixed)
    for key, value in options.items():
        if key not in known:
            msg = f"'{key}' is not an option of {asking.name}"
            raise InputError(msg, hint="one of " + (", ".join(known) or "none"))
        found += _given(known[key], value)
    return found


def _given(option: Option, value: Any) -> list[str]:
    if option.kind == "flag":
        return [option.flag] if value is True else []
    texts = value if isinstance(value, list) else [value]
    if not all(isinstance(t, str) and len(t) <= LONGEST_OPTION and t.isprintable() for t in texts):
        msg = f"{option.name} is not a text"
        raise InputError(msg, hint="write one line")
    if option.kind == "choice" and any(t and t not in option.choices for t in texts):
        msg = f"{option.name} is one of {', '.join(option.choices)}"
        raise InputError(msg, hint="choose one")
    return [f"{option.flag}={t.strip()}" for t in texts if t.strip()]


def command_text(name: str, options: Mapping[str, Any], file: str) -> str:
    """Return the question as a line of the terminal."""
    import shlex

    words = [w for w in arguments(name, options) if w != "--no-figures"]
    return shlex.join(["concio", name, file, *words, "--out", "result"])


def python_text(name: str, options: Mapping[str, Any], file: str) -> str:
    """Return the question as a short program; a question without a function of its own as the command."""
    asking = QUESTIONS[name]
    groups: Sequence[str] = options.get("groups") or ["live"]
    if not asking.python or set(options) - {"groups", "language"}:
        words = [name, file, *(w for w in arguments(name, options) if w != "--no-figures"), "--out", "result"]
        return f'import subprocess\nimport sys\n\nsubprocess.run([sys.executable, "-m", "concio", *{words!r}])\n'
    call = asking.python.format(groups=repr(list(groups)))
    return f"import concio\n\nmodel = concio.load({file!r})\nresult = {call}\nprint(result.verdict)\n"
