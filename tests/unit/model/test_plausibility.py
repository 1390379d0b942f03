"""Numbers that are implausible are reported by check, run and the report, with what to write; others are not."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import concio
from commands import run
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Load, Support
from concio.model.plausibility import implausible
from concio.model.stages import Stage
from models import box, model_of

GROUND = box("ground", -5, 5, -1, 0, kind="fixed", role="ground")


def told(*, law=0.6, material=None, size=1.0, support=None):
    material = material or Elastic(E=5e6, unit_weight=22.0)
    kind = "rigid" if isinstance(material, Rigid) else "elastic"
    block = box("b", 0, size, 0, size, kind=kind, material="m")
    supports = (support,) if support else ()
    return implausible(model_of(GROUND, block, law=law, materials={"m": material}, supports=supports))


def moved(by, body="ground", rotation=0.0):
    return Support("s", body, displacement=(0.0, -by), rotation=rotation)


WRONG = {
    "friction in degrees": ({"law": 31.0}, "friction 31 is an angle of 88.2 degrees.*'31 deg'"),
    "a modulus in MPa": ({"material": Elastic(E=5000.0)}, "E = 5 MPa is below 50 MPa"),
    "a modulus in kPa": ({"material": Elastic(E=5e9)}, "E = 5000 GPa is above 200 GPa"),
    "a mass": ({"material": Elastic(E=5e6, unit_weight=2100)}, "2100 kN/m3 is more than that of steel.*'2100 kg/m3'"),
    "a mass of a rigid block": ({"material": Rigid(2100)}, "'2100 kg/m3'"),
    "millimetres": ({"size": 400.0}, "block 'b' is 400 m long, more than 50 m"),
    "a settlement in mm": ({"support": moved(5.0)}, "moves 'ground' by 5,000 mm, more than a tenth of a block of 1 m"),
    "of a small block": ({"support": moved(0.03, "b"), "size": 0.2}, "by 30 mm, more than a tenth of a block of 0.2 m"),
    "a rotation in degrees": ({"support": moved(0.0, rotation=0.5)}, "by 0.5 rad.*'0.5 deg'"),
}
RIGHT = {
    "steep": {"law": 1.5},
    "soft": {"material": Elastic(E=5e4)},
    "stiff": {"material": Elastic(E=2.1e8 / 1.06)},
    "steel": {"material": Elastic(E=2e8, unit_weight=78.5)},
    "long": {"size": 50.0},
    "settled": {"support": moved(0.1)},
}


CUBE = concio.Polyhedron.box("cube", (0, 0, 0), (1, 1, 1), material="m", kind="rigid")
FAR_OFF = {
    "a point load": ({"loads": (Load("point", (1.0, 0, 0), ("cube",), at=(9.0, 0, 0)),)},
                     r"a point load of group 'dead' acts at \(9, 0, 0\) m, 8 m outside 'cube'"),
    "a support": ({"supports": (Support("s", "cube", polygon=((0, 0, 3.0), (1, 0, 3.0), (1, 1, 3.0))),)},
                  r"support 's' holds at \(0, 0, 3\) m, 2 m outside 'cube'"),
    "gravity of the plane": ({"loads": (Load("weight", (0, -1.0, 0)),)}, "acts along -y.*gravity is \\[0, 0, -1\\]"),
    "a stage": ({"stages": (Stage("s", {"dad": 1.0}),), "loads": (Load("weight", (0, 0, -1.0)),)},
                "stage 's' names the load group 'dad'.*groups are dead"),
}  # fmt: skip
IN_PLACE = {
    "turned gravity": {"loads": (Load("weight", (0, -1.0, 0)), Load("weight", (0, 0, -1.0)))},
    "a bracket": {"loads": (Load("point", (1.0, 0, 0), ("cube",), at=(1.4, 0, 0)),)},
    "a stage": {"stages": (Stage("s", {"dead": 1.0}),), "loads": (Load("weight", (0, 0, -1.0)),)},
}


def of_cube(**fields):
    floor = concio.Polyhedron.box("floor", (-1, -1, -1), (2, 2, 0), kind="fixed")
    return implausible(concio.Model((floor, CUBE), {"m": Rigid(20.0)}, {"joint": JointLaw(0.6)}, **fields))


@pytest.mark.parametrize("case", FAR_OFF)
def test_what_is_hardly_meant_in_space(case):
    fields, sentence = FAR_OFF[case]
    (found,) = of_cube(**fields)
    assert re.search(sentence, found)


@pytest.mark.parametrize("case", IN_PLACE)
def test_what_may_be_meant_in_space(case):
    assert of_cube(**IN_PLACE[case]) == ()


@pytest.mark.parametrize("case", WRONG)
def test_what_is_hardly_meant(case):
    options, sentence = WRONG[case]
    (found,) = told(**options)
    assert re.search(sentence, found)


@pytest.mark.parametrize("case", RIGHT)
def test_what_may_well_be_meant(case):
    assert told(**RIGHT[case]) == ()


def test_laws_and_materials_that_nothing_uses_are_not_judged():
    model = model_of(
        GROUND, box("b", 0, 1, 0, 1, material="m"), materials={"m": Elastic(E=5e6), "other": Elastic(E=1.0)},
    )  # fmt: skip
    assert implausible(concio.Model(**{**vars(model), "laws": {**model.laws, "spare": JointLaw(40.0)}})) == ()


def test_examples_are_plausible():
    for path in sorted((Path(__file__).resolve().parents[3] / "examples").glob("*.toml")):
        assert implausible(concio.load(path)) == (), path.name


def test_check_run_and_the_report_tell(tmp_path):
    path = tmp_path / "f.toml"
    path.write_text("[column]\nwidth = 1\nheight = 1\nblocks = 1\nfriction = 31\n")
    said = "friction 31 is an angle of 88.2 degrees"
    for command in ("check", "run"):
        code, out, _ = run(command, path)
        assert (code, said in out) == (0, True)
        code, out, _ = run(command, path, "--json")
        assert (code, said in json.loads(out)["attention"][0]) == (0, True)
    assert "no near misses" in run("check", path)[1]
    from concio.report.page import report_html

    assert said in report_html(concio.solve(concio.load(path)), figures=False)


def test_a_block_is_as_long_as_its_longest_side():
    """A beam of 60 m, one of 0.3 m that is 1 mm thick: the thin side tells nothing about the unit."""
    beam, lath = box("beam", 0, 60, 0, 0.4, material="m"), box("lath", 0, 0.3, 1, 1.001, material="m")
    found = implausible(model_of(GROUND, beam, lath, materials={"m": Elastic(E=5e6, unit_weight=22.0)}))
    assert any("block 'beam' is 60 m long" in said for said in found)
    assert not any("lath" in said for said in found)
