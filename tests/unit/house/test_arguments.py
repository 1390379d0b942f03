"""No public function loses a misspelt argument: each refuses what it does not know and says what was meant."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import concio
from concio.arguments import closest, strict, strict_class, strict_with
from concio.errors import ArgumentError
from concio.model.file.file_table import json_schema
from concio.solvers.methods import METHODS, find
from concio.studies.compare import compare
from concio.synonyms import SAME, meant
from models import box, on_ground, weight

PASSES_ON = {"variable"}
"""Further keywords are the parameters of a distribution, which knows its own."""
BUILT_BY_CONCIO = {
    "Assembly", "Assessment", "BridgeResult", "Diagnosis", "DynamicsResult", "Outcome", "PathResult", "PushResult",
    "Reliability", "Result", "StateSensitivity", "Status", "StudyResult", "Verdict",
}  # fmt: skip
CALLED = sorted(
    name
    for name in concio.__all__
    if name not in {*BUILT_BY_CONCIO, *PASSES_ON, "__version__"}
    and not (inspect.isclass(getattr(concio, name)) and issubclass(getattr(concio, name), Exception))
)


def stack(blocks: int) -> concio.Model:
    bodies = [box(f"b{k}", 0.0, 1.0, k * 0.5, (k + 1) * 0.5) for k in range(blocks)]
    return on_ground(*bodies, loads=(weight(),))


def all_arguments(function: Callable[..., Any]) -> list[str]:
    return [p.name for p in inspect.signature(function).parameters.values() if p.kind not in (p.VAR_KEYWORD,)]


@pytest.mark.parametrize("name", CALLED)
def test_every_public_function_and_class_refuses_what_it_does_not_know(name: str) -> None:
    """Before anything else, whatever its other arguments are: a misspelt name is found without a valid call."""
    function = getattr(concio, name)
    meant = all_arguments(function)[-1]
    needed = {
        p.name: None for p in inspect.signature(function).parameters.values()
        if p.default is p.empty and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)
    }  # fmt: skip
    given = {"model": stack(2)} if "model" in needed else {}
    with pytest.raises(concio.InputError, match=rf"has no argument '{meant}_'.*did you mean '{meant}'\?"):
        function(**{**needed, **given, f"{meant}_": 1.0})


def test_the_misspelt_load_factor() -> None:
    """``factor=`` for ``factors=`` used to give a certified answer to another question."""
    model = stack(2)
    with pytest.raises(concio.InputError, match=r"solve\(\) has no argument 'factor' \(did you mean 'factors'\?\)"):
        concio.solve(model, factor={"live": 0.5})
    with pytest.raises(TypeError):  # what a Python programmer expects
        concio.solve(model, factor={"live": 0.5})


@pytest.mark.parametrize("method", METHODS)
def test_every_method_refuses_options_it_does_not_have(method: str) -> None:
    parameters = inspect.signature(find(method)).parameters.values()
    assert not any(p.kind is p.VAR_KEYWORD for p in parameters), "an option would be swallowed"
    option = [p.name for p in parameters if p.kind is p.KEYWORD_ONLY][-1]
    with pytest.raises(concio.InputError, match=rf"has no argument '{option}x' \(did you mean '{option}'\?\)"):
        concio.solve(stack(2), method, **{f"{option}x": 1})
    problem = concio.assemble(stack(2)).problem()
    with pytest.raises(concio.InputError, match=rf"method '{method}' has no argument '{option}x'"):
        compare(problem, [method], options={method: {f"{option}x": 1}})


def test_options_of_methods_that_are_not_compared() -> None:
    problem = concio.assemble(stack(2)).problem()
    with pytest.raises(concio.MethodError, match="did you mean 'lemke'"):
        compare(problem, ["lemke"], options={"lemkes": {}})


def test_options_of_common_keywords() -> None:
    with pytest.raises(concio.InputError, match=r"wall\(\) has no argument 'frction' \(did you mean 'friction'\?\)"):
        concio.wall(length=1.0, height=1.0, frction=0.3)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: concio.solve(), r"solve\(\) needs the argument 'model'"),
        (lambda: concio.solve(stack(2), "auto", {"live": 1.0}), r"takes 2 arguments by place, 3 were given"),
        (lambda: concio.solve(stack(2), "auto", method="auto"), r"given 'method' twice"),
        (lambda: concio.Body("a"), r"Body\(\) needs the argument 'outline'"),
        (lambda: concio.Load("weight"), r"Load\(\) needs the argument 'value'"),
        (lambda: concio.solve(stack(2), "lemk"), "did you mean 'lemke'"),
        (lambda: concio.solve(stack(2), factors={"daed": 1.0}), "no load group 'daed' .did you mean 'dead'"),
        (lambda: concio.run_path(stack(2), [concio.Stage("a", {"daed": 1.0})]), "did you mean 'dead'"),
        (lambda: concio.limit(stack(2), "daed"), "did you mean 'dead'"),
        (lambda: concio.wall(length=1.0, height=1.0, bond="flemmish"), "did you mean 'flemish'"),
        (lambda: concio.variable("mu", "normal", mean=0.6, sdd=0.1), "sd"),
        (lambda: concio.solve(stack(2)).plot.deformed(scal=3.0), "did you mean 'scale'"),
    ],
)
def test_calls_that_cannot_be_meant(call: Callable[[], object], said: str) -> None:
    with pytest.raises(concio.InputError, match=said):
        call()


def test_strict_keeps_what_a_function_says_of_itself() -> None:
    @strict
    def area(width: float, height: float = 1.0) -> float:
        """Say it."""
        return width * height

    assert area(2.0) == 2.0
    assert area(height=3.0, width=2.0) == 6.0
    assert area.__doc__ == "Say it."
    assert list(inspect.signature(area).parameters) == ["width", "height"]
    with pytest.raises(ArgumentError, match="did you mean 'height'"):
        area(1.0, hight=2.0)

    @strict_with(["colour"])
    def draw(**common: object) -> object:
        return common["colour"]

    assert draw(colour="red") == "red"
    with pytest.raises(ArgumentError, match="did you mean 'colour'"):
        draw(color="red")

    @strict_class
    class Point:
        def __init__(self, x: float) -> None:
            self.x = x

    assert Point(1.0).x == 1.0
    with pytest.raises(ArgumentError, match=r"Point\(\) has no argument 'y' \(known: x\)"):
        Point(1.0, y=2.0)


def test_closest() -> None:
    assert closest("fricton", ["cohesion", "friction"]) == "did you mean 'friction'?"
    assert closest("Friction", ["cohesion", "friction"]) == "did you mean 'friction'?"
    assert closest("bodies", ["loads", "ties", "blocks"]) == "did you mean 'blocks'?"
    assert closest("bodies", ["loads", "ties"]) == "did you mean 'ties'?"  # by its letters
    assert closest("zzz", ["a", "b"], names="groups") == "groups: a, b"
    assert closest("zzz", []) == "known: none"
    assert closest("zzz", ["a"], otherwise="look") == "look"


def keys_of(schema: Any) -> set[str]:
    """Return the keys of all tables of a JSON Schema."""
    if isinstance(schema, list):
        return set().union(*map(keys_of, schema))
    if not isinstance(schema, dict):
        return set()
    return set(schema.get("properties", ())).union(*map(keys_of, schema.values()))


def test_other_words_lead_to_keys_that_there_are() -> None:
    assert set(SAME) - keys_of(json_schema()) == set()
    for name, others in SAME.items():
        assert len({name.casefold(), *others}) == 1 + len(others)
        assert all(word == word.casefold() and " " not in word for word in others)
    assert meant("Poisson ratio", ["E", "nu"]) == "nu"
    assert meant("peso specifico", ["E", "unit_weight"]) == "unit_weight"
    assert meant("nodes", ["vertices", "outline"]) == "outline"
    assert meant("nodes", ["span"]) is None


COLUMN = "[column]\nwidth = 0.3\nheight = 1.2\nblocks = 3\nfriction = 0.9\nhorizontal = 1.0\n"


def pushed(model: concio.Model) -> concio.Result:
    return concio.solve(model, factors={"live": 0.1})


WRONG_KINDS: dict[str, tuple[Callable[[concio.Model], object], str]] = {
    "a number for a vector": (lambda _: concio.Load("pressure", 20.0), r"value = 20.0 must be a sequence of numbers "
                              r"\(write \(20.0,\)\)"),
    "a text for a vector": (lambda _: concio.Load("pressure", "20 kPa"), "must be a sequence of numbers"),
    "texts in a vector": (lambda _: concio.Load("weight", ("0", "-1")), "must be a sequence of numbers"),
    "a file for a model": (lambda _: concio.solve("wall.toml"), "a model is needed, .*'wall.toml' was given"),
    "a result for a model": (lambda m: concio.limit(pushed(m)), "a model is needed, Result was given"),
    "a result to write": (lambda m: concio.dumps(pushed(m)), "a model is needed, Result was given"),
    "a model for a result": (lambda m: concio.thrust_line(m), "must be a Result, not a Model .solve the model first"),
    "one stage": (lambda m: concio.run_path(m, concio.Stage("a", {})), "must be a sequence of Stage"),
    "stages as tuples": (lambda m: concio.run_path(m, [("a", {"dead": 1.0})]), "must be a sequence of Stage"),
    "a factor for factors": (lambda m: concio.solve(m, factors=0.5), "0.5 must be a mapping of names to numbers"),
    "a text for a factor": (lambda m: concio.solve(m, factors={"live": "x"}), "must be a mapping of names to numbers"),
    "a number for a method": (lambda m: concio.solve(m, method=3), "method = 3 must be a text"),
    "a text for an outline": (lambda _: concio.Body("a", "square"), "is not a list of points"),
    "a body that is not there": (lambda m: pushed(m).nodes(99), "there is no body 99"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG_KINDS)
def test_arguments_of_the_wrong_kind_are_told_in_words(case: str) -> None:
    call, said = WRONG_KINDS[case]
    with pytest.raises(concio.InputError, match=said):
        call(concio.loads(COLUMN))


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
BOX = concio.Polyhedron.box("b", (0, 0, 0), (1, 1, 1))
MADE: dict[str, dict[str, Any]] = {
    "Axle": {"at": 0.0, "load": 10.0},
    "Body": {"name": "a", "outline": SQUARE},
    "Candidate": {"name": "c", "body": "a", "direction": (0.0, -1.0)},
    "ControlPoint": {"body": "a", "at": (0.0, 0.0)},
    "Elastic": {"E": 1e6, "nu": 0.2, "unit_weight": 20.0},
    "Fill": {"cover": 0.3},
    "JointLaw": {"friction": 0.5},
    "JointRule": {"law": "j"},
    "Layer": {"depth": 0.1, "unit_weight": 20.0},
    "Load": {"kind": "point", "value": (0.0, -1.0), "bodies": ("a",), "at": (0.5, 1.0)},
    "Measurement": {"name": "m", "kind": "opening", "error": 0.001, "joint": ("a", "b"), "at": (0.0, 0.0)},
    "Polyhedron": {"name": "a", "vertices": BOX.vertices, "faces": BOX.faces},
    "Pulse": {"shape": "sine", "amplitude": 1.0, "length": 0.5},
    "Record": {"values": np.full(10, 0.1), "step": 0.01},
    "Rigid": {"unit_weight": 20.0},
    "Site": {"hazard": {"SLV": {"a_g": 0.2, "F0": 2.45, "Tc": 0.32}}},
    "Stage": {"name": "s", "factors": {"dead": 1.0}},
    "Support": {"name": "s", "body": "a", "edge": ((0, 0), (1, 0))},
    "Temperature": {"change": 10.0},
    "Tie": {"name": "t", "body_a": "a", "at_a": (0.5, 0.5), "body_b": "", "at_b": (3.0, 0.5), "stiffness": 100.0},
    "Units": {},
    "Variable": {"name": "v", "distribution": "normal", "keys": ("friction",), "parameters": {"mean": 1.0, "sd": 0.1}},
    "Vehicle": {"name": "v", "axles": ((0.0, 10.0),)},
}
ANYTHING = (
    None, 5, -1.0, "x", "", [], {}, object(), float("nan"), float("inf"), np.array([1.0, 2.0]), True, [None], ["x"],
    {"x": 1}, (1, 2, 3, 4), b"x", 1e308, len,
)  # fmt: skip


@pytest.mark.parametrize("name", sorted(MADE))
def test_whatever_is_given_is_taken_or_refused_in_a_sentence(name: str) -> None:
    """Each argument in turn is nothing, a number, a text, a list, an object, a function: never a traceback."""
    made = getattr(concio, name)
    made(**MADE[name])
    said = []
    for argument in all_arguments(made):
        for value in ANYTHING:
            try:
                made(**{**MADE[name], argument: value})
            except concio.ConcioError as error:
                said.append(str(error))
    assert all(text.strip() for text in said)
    assert len(said) > len(ANYTHING)


def test_a_text_for_a_number_is_named() -> None:
    """Some functions read numbers with their units, others do not; what goes wrong inside for another reason stays."""
    model = stack(1)
    with pytest.raises(ArgumentError, match=r"dynamics\(\): duration = '10 s' cannot be used"):
        concio.dynamics(model, duration="10 s")  # type: ignore[arg-type]
    with pytest.raises(ArgumentError, match=r"Site\(\): nominal_life = '50' cannot be used"):
        concio.Site({"SLV": {"a_g": 0.2}}, nominal_life="50")  # type: ignore[arg-type]

    @strict
    def broken(name: str, size: float = 1.0) -> float:
        raise TypeError(name)

    with pytest.raises(TypeError, match=r"^within$"):
        broken("within", 2.0)
    with pytest.raises(ArgumentError, match=r"size = '2 m' cannot be used: within"):
        broken("within", "2 m")  # type: ignore[arg-type]


@pytest.mark.parametrize("bond", [None, 5, [None], (1, 2), True])
def test_what_is_no_bond_is_told(bond: Any) -> None:
    with pytest.raises(concio.InputError, match="neither the name of a bond nor a list of courses"):
        concio.wall(length=1.0, height=0.5, bond=bond)
    with pytest.raises(concio.InputError, match="a model is needed"):
        concio.place(bond)
