"""A load along a line in a joint acts on one of its two faces: the lower one, or the one that is asked for."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from commands import run
from concio.contact.assembly import assemble
from concio.contact.edge_loads import covered, loaded_faces
from concio.errors import InputError
from concio.model.model import Load
from models import box, on_ground


def two_courses(load, **options):
    """A lower course of two blocks, an upper one of two that are staggered, the right one of which overhangs."""
    return on_ground(
        box("left", 0, 1.3, 0, 1, **options),
        box("right", 1.3, 3, 0, 1, **options),
        box("upper left", 0, 2, 1, 2, **options),
        box("upper right", 2, 3.5, 1, 2, **options),
        loads=(load,),
    )


def pushed(model):
    """Resultant on each body that is loaded [kN]."""
    assembly = assemble(model)
    (f,) = assembly.loads.values()
    found = {}
    for b, body in enumerate(model.bodies):
        own = f[assembly.disc.offsets[b] : assembly.disc.offsets[b + 1]]
        total = own[:2] if body.kind == "rigid" else own.reshape(-1, 2).sum(0) if len(own) else np.zeros(2)
        if np.abs(total).max() > 1e-12:
            found[body.name] = total.round(12).tolist()
    return found


FLOOR = {"edge": ((0.5, 1.0), (3.5, 1.0))}


@pytest.mark.parametrize("options", [{}, {"kind": "rigid", "material": "stone"}])
def test_a_floor_in_a_bed_joint_acts_on_the_lower_face(options):
    found = pushed(two_courses(Load("traction", (0.0, -10.0), **FLOOR), **options))
    # beyond the lower course the line lies on the underside of the upper one, which is the only face there
    assert found == {"left": [0, -8], "right": [0, -17], "upper right": [0, -5]}


def test_the_other_face_or_both_when_asked():
    upper = pushed(two_courses(Load("traction", (0.0, -10.0), face="upper", **FLOOR)))
    assert upper == {"upper left": [0, -15], "upper right": [0, -15]}
    jack = pushed(two_courses(Load("pressure", (10.0,), face="both", **FLOOR)))
    assert jack == {"left": [0, -8], "right": [0, -17], "upper left": [0, 15], "upper right": [0, 15]}


def test_naming_one_side_is_asking_too():
    found = pushed(two_courses(Load("pressure", (10.0,), bodies=("upper left",), **FLOOR)))
    assert found == {"upper left": [0, 15]}


def test_an_upright_joint_has_no_lower_face():
    edge = ((1.3, 0.0), (1.3, 1.0))
    with pytest.raises(InputError, match=r"in a vertical joint, which has two faces .*'left', 'right' or 'both'"):
        assemble(two_courses(Load("pressure", (4.0,), edge=edge)))
    assert pushed(two_courses(Load("pressure", (4.0,), edge=edge, face="left"))) == {"left": [-4, 0]}
    assert pushed(two_courses(Load("pressure", (4.0,), edge=edge, face="right"))) == {"right": [4, 0]}
    with pytest.raises(InputError, match="no lower face"):
        assemble(two_courses(Load("pressure", (4.0,), edge=edge, face="lower")))
    with pytest.raises(InputError, match="no left face"):
        assemble(two_courses(Load("pressure", (4.0,), face="left", **FLOOR)))


def test_an_inclined_joint_has_all_four_faces():
    corners = np.array([(0, 0), (2, 0), (2, 2), (0, 1.0)])
    above = np.array([(0, 1), (2, 2), (2, 3), (0, 3.0)])
    edge = ((0.0, 1.0), (2.0, 2.0))

    def loaded(**options):
        load = Load("traction", (0.0, -3.0), edge=edge, **options)
        return set(pushed(on_ground(concio.Body("low", corners), concio.Body("high", above), loads=(load,))))

    assert loaded() == loaded(face="lower") == loaded(face="right") == {"low"}
    assert loaded(face="upper") == loaded(face="left") == {"high"}


def test_what_is_covered_is_measured_once():
    model = two_courses(Load("traction", (0.0, -10.0), edge=((-1.0, 1.0), (3.5, 1.0)), face="both"))
    assert covered(loaded_faces(model, model.loads[0])) == pytest.approx(3.5)


TEXT = """
[joints.dry]
friction = 0.6
[materials.block]
E = "5 GPa"
[[blocks]]
name = "ground"
rectangle = [[-1, -1], [3, 0]]
kind = "fixed"
[[blocks]]
name = "a"
rectangle = [[0, 0], [2, 1]]
[[blocks]]
name = "b"
rectangle = [[0, 1], [2, 2]]
[[loads]]
kind = "traction"
value = [0, -6]
edge = [[0, 1], [FAR, 1]]
"""


def test_check_states_the_choice_and_what_lies_on_nothing(tmp_path):
    path = tmp_path / "f.toml"
    path.write_text(TEXT.replace("FAR", "2"))
    _, out, _ = run("check", path)
    assert "-12 kN along y in all" in out
    assert "in a joint, on its lower face only (face = 'upper' or 'both' says otherwise)" in out
    path.write_text(TEXT.replace("FAR", "3") + "face = 'both'\n")
    _, out, _ = run("check", path)
    assert "-24 kN along y in all" in out
    assert "in a joint, on both of its faces, as asked" in out
    assert "only 2 m of its 3 m lie on edges of its blocks" in out
    model = concio.load(path)
    assert concio.loads(concio.dumps(model)).loads == model.loads


def test_an_unknown_body_of_a_load_is_told_with_the_one_that_was_meant():
    with pytest.raises(InputError, match="did you mean 'upper left'"):
        assemble(two_courses(Load("pressure", (1.0,), bodies=("uper left",), **FLOOR)))
