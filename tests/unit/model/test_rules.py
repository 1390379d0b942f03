"""Rules of joints: one that names nothing is refused, one that decides nothing is reported."""

from __future__ import annotations

import pytest

import concio
from commands import run
from concio.errors import InputError
from concio.model.model import JointRule
from models import box, model_of

TEXT = """
[materials.stone]
E = "5 GPa"
unit_weight = 20
[joints.dry]
friction = 0.6
[joints.glued]
friction = 0.6
cohesion = 100
[[rules]]
law = "dry"
[[rules]]
law = "glued"
between = ["WORD", "pier"]
[[blocks]]
name = "base"
kind = "fixed"
role = "ground"
rectangle = [[-1, -1], [2, 0]]
[[blocks]]
name = "a"
role = "pier"
material = "stone"
rectangle = [[0, 0], [1, 1]]
[[blocks]]
name = "b"
role = "pier"
layer = "upper"
material = "stone"
rectangle = [[0, 1], [1, 2]]
[[loads]]
kind = "weight"
value = [0, -1]
"""


MISSPELT = [("gruond", "ground"), ("peir", "pier"), ("uper", "upper"), ("ston", "stone")]


@pytest.mark.parametrize(("word", "meant"), MISSPELT)
def test_a_rule_that_names_nothing_is_refused_with_what_was_meant(tmp_path, word, meant):
    path = tmp_path / "f.toml"
    path.write_text(TEXT.replace("WORD", word))
    for command in ("check", "run"):
        code, _, err = run(command, path)
        assert code == 2
        assert f"[[rules]] 2: the rule for the joint law 'glued' names '{word}'" in err
        assert f"did you mean '{meant}'" in err
    path.write_text(TEXT.replace("WORD", meant))
    code, out, _ = run("check", path)
    assert code == 0
    assert "decides no joint" not in out


@pytest.mark.parametrize("word", ["x", ""])
def test_the_same_in_python(word):
    with pytest.raises(InputError, match="but no body has that name, role, layer or material"):
        model_of(box("a", 0, 1, 0, 1), rules=(JointRule("joint"), JointRule("joint", (word, "*"))))


def test_the_material_of_a_fixed_body_is_no_word(tmp_path):
    text = TEXT.replace("WORD", "*").replace('role = "ground"', 'role = "ground"\nmaterial = "rock"')
    with pytest.raises(InputError, match="names 'rock'"):
        concio.loads(text.replace('"*", "pier"', '"rock", "pier"'))


def test_check_names_rules_without_effect(tmp_path):
    path = tmp_path / "f.toml"
    path.write_text(TEXT.replace("WORD", "ground") + '[[rules]]\nlaw = "dry"\nbetween = ["ground", "upper"]\n')
    _, out, _ = run("check", path)
    assert "rule 3, law 'dry' between 'ground' and 'upper', decides no joint" in out
    path.write_text(TEXT.replace("WORD", "ground") + '[[rules]]\nlaw = "dry"\nbetween = ["*", "pier"]\n')
    _, out, _ = run("check", path)
    assert "rule 2, law 'glued' between 'ground' and 'pier', decides no joint" in out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"side_walls": False, "wall_friction": 0.3}, "wall_friction is given, but there is no side wall"),
        ({"side_walls": False, "side_gap": 0.01}, "side_gap is given, but there is no side wall"),
        ({"base": "none", "base_friction": 0.3}, "base_friction is given, but there is no base"),
    ],
)
def test_a_panel_refuses_the_friction_of_what_it_does_not_have(options, said):
    with pytest.raises(InputError, match=said):
        concio.running_bond_panel(**options)
