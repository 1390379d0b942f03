"""What a push and a motion say of themselves: falls, rests, what moves on, what does not stand, and what was asked."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.motion import dynamics as dynamics_module
from concio.analysis.motion import push as push_module
from concio.analysis.motion import push_apart
from concio.analysis.motion.fate import tilted
from concio.errors import NoEquilibriumError, SolverError
from concio.model.motion.records import attention
from concio.verdict.italian import italian
from concio.verdict.not_standing import FOLLOWED_AWAY
from concio.verdict.verdict import Outcome
from models import box, model_of, weight
from motion_models import G, standing

HEAD = """
[materials.stone]
kind = "rigid"
unit_weight = "20 kN/m3"
[joints.dry]
friction = {friction}
[[loads]]
kind = "weight"
value = [0.0, -1.0]
[[blocks]]
name = "floor"
rectangle = [[-3.0, -0.5], [{end}, 0.0]]
kind = "fixed"
[[blocks]]
name = "block"
outline = {outline}
kind = "rigid"
material = "stone"
"""
PILLAR = "[[-0.2, 0.0], [0.2, 0.0], [0.2, 1.6], [-0.2, 1.6]]"
LOW = "[[-0.4, 0.0], [0.4, 0.0], [0.4, 0.4], [-0.4, 0.4]]"
LEANS = "[[-0.2, 0.0], [0.2, 0.0], [0.9, 2.0], [0.5, 2.0]]"


def file_of(folder, outline=PILLAR, friction=0.7, end=3.0, more=""):
    path = folder / "model.toml"
    path.write_text(HEAD.format(outline=outline, friction=friction, end=end) + more)
    return path


def shaken(path, *options):
    code, out, _ = run("shake", path, "--json", *options)
    return code, json.loads(out)


@pytest.mark.long
def test_a_block_that_slides_off_its_shelf_has_fallen(tmp_path):
    path = file_of(tmp_path, LOW, friction=0.2, end=0.4)
    code, told = shaken(path, "--pulse", "rectangular,-1 g,0.5 s", "--duration", "1.3 s")
    assert (code, told["verdict"]["outcome"]) == (3, "fails")
    assert "sunk" in told["sentence"] or "turned by" in told["sentence"]


@pytest.mark.long
def test_a_block_between_walls_that_nothing_presses_does_not_stand_and_falls():
    walls = [box("left", -1.0, 0.0, -0.5, 1.5, kind="fixed"), box("right", 1.0, 2.0, -0.5, 1.5, kind="fixed")]
    blocks = [box(f"b{k}", 0.5 * k, 0.5 * k + 0.5, 0.0, 1.0, kind="rigid", material="stone") for k in (0, 1)]
    push = concio.Load("pressure", (10.0,), bodies=("b0", "b1"), edge=((0.0, 1.0), (1.0, 1.0)), group="live")
    found = concio.dynamics(model_of(*walls, *blocks, law=0.6, loads=(weight(), push)), duration=0.5, gravity=G)
    assert found.stands is False
    assert len(found.fallen) == 2
    assert found.verdict.outcome is Outcome.FAILS, "what fell has fallen, whether or not it is followed further"
    assert found.energy.error < 1e-9  # the pressure turns with the blocks: what it works is put in


def test_a_column_that_leans_too_far_does_not_stand(tmp_path):
    code, told = shaken(file_of(tmp_path, LEANS), "--pulse", "sine,0.01 g,0.1 s", "--duration", "0.2 s")
    assert (code, told["status"]) == (3, "does_not_stand")
    assert "does not stand before the ground moves" in told["sentence"]


def test_a_start_that_nothing_refutes_is_not_said_to_fall(tmp_path, monkeypatch):
    """Where no equilibrium was found and nothing proves that there is none, a fall has to be seen."""
    path = file_of(tmp_path, LEANS)
    proven = concio.dynamics(concio.load(path), duration=0.1)
    assert proven.refuted.startswith("Proven")
    assert proven.verdict.outcome is Outcome.FAILS
    monkeypatch.setattr(dynamics_module, "proof_at_rest", lambda *_: "")
    found = concio.dynamics(concio.load(path), duration=0.1)
    assert found.fallen, "it leans beyond its own equilibrium, which is seen in the plane"
    found = replace(found, fallen=())
    assert (found.stands, found.refuted) == (False, "")
    assert (found.verdict.outcome, found.verdict.status) == (Outcome.MOVING, "moving")
    assert "nothing shows that there is none" in found.verdict.sentence
    assert "does not stand" not in f"{found.verdict.sentence} {found.verdict.headline}"
    rests = replace(found, rests=True)
    assert rests.verdict.outcome is Outcome.INCOMPLETE
    assert "the motion from an equilibrium under the loads: none was found" in rests.verdict.sentence
    falls = replace(found, fallen=("'block' has turned by 60.1 degrees",))
    assert (falls.verdict.outcome, falls.verdict.status) == (Outcome.FAILS, "fallen")
    assert falls.verdict.headline == "The structure falls."


@pytest.mark.long
def test_a_motion_goes_on_after_the_signal_until_rest_or_a_fall(tmp_path):
    """The same pillar under two rectangular pulses: one rocks it, one turns it over long after its end."""
    path = file_of(tmp_path)
    code, told = shaken(path, "--pulse", "rectangular,0.30 g,0.3 s", "--step", "4 ms")
    assert (code, told["status"]) == (0, "at_rest")
    assert told["time"] > 0.35
    code, told = shaken(path, "--pulse", "rectangular,0.45 g,0.5 s", "--step", "4 ms")
    assert (code, told["status"]) == (3, "overturned")
    assert told["time"] > 0.6
    assert "0.45 g" in told["verdict"]["question"]["asked"]


def test_what_still_moves_at_the_time_asked_for_is_said_to_move():
    found = concio.dynamics(standing(), concio.Pulse("rectangular", 0.5 * G, 0.3), 0.35, 2e-3, gravity=G)
    assert found.verdict.outcome is Outcome.MOVING
    assert found.verdict.exit_code == 4
    assert "still moves at 0.35 s" in found.verdict.sentence


@pytest.mark.long
@pytest.mark.parametrize(("share", "passed"), [(1.3, True), (0.7, False)])
def test_a_block_past_its_own_equilibrium_has_fallen_though_it_has_not_yet_arrived(share, passed):
    """Pushed by hand to a share of its critical angle of 0.32 and let go: 1.3 falls, 0.7 comes back."""
    alpha = np.arctan(1 / 3)
    half = concio.dynamics(
        standing(), None, 1.0, 2e-3, gravity=G, velocities={"block": (0.0, 0.0, 0.0)}, start="as described",
    )  # fmt: skip
    state = half.end
    foot, centre = np.array([0.2, 0.0]), np.array([0.0, 0.6])
    c, s = np.cos(-share * alpha), np.sin(-share * alpha)
    placed, turned = state.centre.copy(), state.rotation.copy()
    placed[1] = foot + np.array([[c, -s], [s, c]]) @ (centre - foot)
    turned[1] = -share * alpha
    begun = replace(state, centre=placed, rotation=turned)
    found = concio.dynamics(standing(), None, 0.05, 1e-3, gravity=G, start=begun)
    assert bool(found.fallen) is passed
    assert found.verdict.outcome is (Outcome.FAILS if passed else Outcome.MOVING)
    assert found.largest_rotation[1] >= np.abs(found.shots.rotation[:, 1]).max() - 1e-12  # from where it was described


def test_a_restart_counts_rotation_from_the_first_start():
    pulse = concio.Pulse("rectangular", 0.6 * G, 0.3)
    one = concio.dynamics(standing(), pulse, 0.45, 2e-3, gravity=G)
    two = concio.dynamics(standing(), None, 0.1, 2e-3, gravity=G, start=one.end)
    assert two.largest_rotation[1] > 1.05 * one.largest_rotation[1]
    assert two.largest_rotation[1] == pytest.approx(np.abs(two.end.rotation[1]), rel=1e-12)


@pytest.mark.long
def test_a_floor_that_has_turned_is_the_floor_that_shakes():
    """On a floor turned by 8 degrees the pillar leans: a pulse that does nothing to it elsewhere turns it over."""
    pulse = concio.Pulse("rectangular", 0.20 * G, 0.6)
    upright = standing(height=1.6)
    turned = replace(upright, supports=(concio.Support("turn", "floor", rotation=np.deg2rad(8.0)),))
    assert concio.dynamics(upright, pulse, 0.8, 4e-3, gravity=G).verdict.outcome is Outcome.HOLDS
    assert concio.dynamics(turned, pulse, step=4e-3, gravity=G).verdict.outcome is Outcome.FAILS


def test_a_text_record_without_a_unit_is_asked_about(tmp_path):
    record = tmp_path / "rec.txt"
    record.write_text("0.00 0.0\n0.01 0.3\n0.02 0.0\n")
    code, _, err = run("shake", file_of(tmp_path), "--motion", record)
    assert code == 2
    assert "does not say its unit" in err
    assert "--record-unit" in err


def test_the_scale_of_the_file_is_not_that_of_a_pulse_given_beside_it(tmp_path):
    pulse = 'pulse = { shape = "sine", amplitude = "0.4 g", length = "0.2 s" }'
    more = f'[motion]\n{pulse}\nscale = 0.1\nduration = "0.2 s"\n'
    path = file_of(tmp_path, more=more)
    _, told = shaken(path)
    assert told["ground_peak"] == pytest.approx(0.04 * 9.80665, rel=1e-3)
    assert "times 0.1" in told["verdict"]["question"]["asked"]
    _, told = shaken(path, "--pulse", "sine,0.2 g,0.2 s")
    assert told["ground_peak"] == pytest.approx(0.2 * 9.80665, rel=1e-3)
    assert any("was not applied: --scale" in line for line in told["verdict"]["attention"])


def test_a_pulse_above_any_earthquake_asks_for_attention():
    found = concio.dynamics(standing(), concio.Pulse("sine", 60.0, 0.02), 0.02, 2e-3, gravity=G)
    assert any("more than any earthquake" in line for line in found.verdict.attention)


@pytest.mark.parametrize(("factor", "told"), [(1 / 981, "less than any damaging"), (1.0, ""), (981, "more than any")])
def test_a_record_read_in_another_unit_asks_for_attention(factor, told):
    """Values in g that are read as cm/s2, as they are, and values in cm/s2 that are read as g."""
    time = np.arange(0.0, 0.2, 0.01)
    record = concio.Record(0.3 * factor * G * np.sin(30.0 * time), 0.01, name="x.txt")
    odd = attention(record)
    assert (told in odd) if told else odd is None
    if odd:
        assert [piece.language for piece in italian(odd)] == ["it"]


def test_a_motion_says_which_loads_have_no_mass():
    """A roof of 10 kN at a factor of 2 is a force; what pushes sideways or lifts stands for no mass."""
    loads = [concio.Load("point", force, bodies=("block",), at=(0.0, 1.0), group=group)
             for group, force in (("roof", (0.0, -10.0)), ("wind", (1.0, 0.0)), ("lift", (0.0, 1.0)))]  # fmt: skip
    bare = standing()
    model = replace(bare, loads=(*bare.loads, *loads))
    told = concio.dynamics(model, None, 4e-3, 2e-3, gravity=G, factors={"roof": 2.0}).verdict.limits
    line = next(line for line in told if "have no mass" in line)
    assert "20 kN of 'roof'" in line
    assert "wind" not in line
    assert "lift" not in line
    assert not any("have no mass" in t for t in concio.dynamics(bare, None, 4e-3, 2e-3, gravity=G).verdict.limits)


def test_a_push_that_ends_before_its_peak_shows_no_peak(tmp_path):
    path = file_of(tmp_path)
    code, out, _ = run("push", path, "--until", "0.001 mm")
    assert code == 0
    assert "peak  " not in out
    assert "no peak was reached" in out
    code, out, _ = run("push", path)
    assert code == 0
    assert "peak         0.2499" in out


def test_a_push_says_what_it_multiplies_and_what_acts_beside():
    """Weights are multiplied, loads from above too; a group called live acts as it is, sideways it is not a weight."""
    live = concio.Load("point", (-0.5, -3.0), bodies=("block",), at=(0.0, 1.2), group="live")
    model = standing()
    model = replace(model, loads=(*model.loads, live))
    found = concio.push(model, live=())
    acting = {a.group: a for a in found.verdict.question.acting}
    assert acting["live"].role == "constant"
    assert acting["weights"].role == "multiplied"
    assert acting["live"].force == pytest.approx((-0.5, -3.0))
    assert acting["weights"].force == pytest.approx((3.0 - acting["dead"].force[1], 0.0))
    assert acting["weights"].factor == pytest.approx(found.peak)


@pytest.mark.long
def test_every_place_says_what_the_verdict_says(tmp_path):
    path = file_of(tmp_path)
    for command, options in (("push", ()), ("shake", ("--pulse", "sine,0.1 g,0.1 s", "--duration", "0.3 s"))):
        code, out, _ = run(command, path, *options, "--out", tmp_path / command)
        _, told, _ = run(command, path, *options, "--json")
        summary = json.loads((tmp_path / command / "summary.json").read_text())
        again = json.loads(told)
        assert out.splitlines()[0] == summary["sentence"] == again["sentence"] == again["verdict"]["sentence"]
        assert summary["verdict"]["exit_code"] == code
        assert summary["sentence"].split(". ")[0] in (tmp_path / command / "report.html").read_text()


@pytest.mark.long
def test_elastic_blocks_that_slide_past_the_end_of_a_wall_fall_on():
    """Faces that have slid past each other share no length: that ended in an index error."""
    walls = [box("left", -1.0, 0.0, 0.5, 1.5, kind="fixed"), box("right", 1.0, 2.0, 0.5, 1.5, kind="fixed")]
    stiff = concio.Elastic(E=5e6, nu=0.2, unit_weight=20.0)
    blocks = [box(name, x, x + 0.5, 0.4, 1.4, material="stiff") for name, x in (("a", 0.0), ("b", 0.5))]
    model = model_of(*walls, *blocks, law=0.6, loads=(weight(),), materials={"stiff": stiff})
    found = concio.dynamics(model, gravity=G, duration=0.55)
    assert len(found.fallen) == 2
    assert found.verdict.outcome is Outcome.FAILS, "what fell has fallen, whether or not it is followed further"


def test_a_push_that_does_not_begin_says_what_shows_it(tmp_path, monkeypatch):
    """A mechanism proves it at rest; what is followed away is told as that; what was merely not found shows nothing."""
    with pytest.raises(NoEquilibriumError, match="does not stand") as proven:
        concio.push(concio.load(file_of(tmp_path, LEANS)))
    told = proven.value.verdict
    assert told.outcome is Outcome.FAILS
    assert told.proof == concio.solve(concio.load(file_of(tmp_path, LEANS)), on_failure="return").verdict.proof
    monkeypatch.setattr(push_module, "proof_at_rest", lambda *_: "")
    with pytest.raises(NoEquilibriumError) as seen:
        concio.push(concio.load(file_of(tmp_path, LEANS)))
    assert seen.value.verdict.proof == FOLLOWED_AWAY

    def not_found(statics, state):
        found = statics.balance(state, 0.0)
        return replace(found, found=False, moved=0.0 * found.moved), 1.0, state

    monkeypatch.setattr(push_apart, "begun", not_found)
    with pytest.raises(SolverError) as lost:
        concio.push(standing())
    assert lost.value.verdict.outcome is Outcome.UNDECIDED
    assert lost.value.verdict.exit_code == 4


def on_knife_edges(dim, law=None):
    """A beam across two knife edges, in the plane and in space."""
    joints = {"joint": law or concio.JointLaw(0.6)}
    rigid = {"block": concio.Rigid(unit_weight=20.0)}
    if dim == 2:
        place = (("g", 0), ("k", 4))
        ends = [concio.Body(n, [(x - 0.2, 0.5), (x + 0.2, 0.5), (x, 1.0)], kind="fixed") for n, x in place]
        beam = concio.Body("beam", [(-0.5, 1), (4.5, 1), (4.5, 1.3), (-0.5, 1.3)], kind="rigid")
        return concio.Model((*ends, beam), rigid, joints, loads=(concio.Load("weight", (0, -1)),))
    faces = [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)]
    ends = [
        concio.Polyhedron(n, [(x + dx, y, z) for y in (-1, 2) for dx, z in ((-0.2, 0.5), (0.2, 0.5), (0, 1))], faces,
                          kind="fixed") for n, x in (("g", 0), ("k", 4))
    ]  # fmt: skip
    beam = concio.Polyhedron.box("beam", (-0.5, 0, 1), (4.5, 1, 1.3), kind="rigid")
    return concio.Model((*ends, beam), rigid, joints, loads=(concio.Load("weight", (0, 0, -1)),))


@pytest.mark.parametrize("dim", [2, 3])
def test_a_beam_at_rest_has_no_energy_balance_to_be_off_and_a_wrong_balance_is_told(dim, tmp_path):
    found = concio.dynamics(on_knife_edges(dim), duration=0.1)
    assert found.energy.still
    assert not any("energy balance" in told for told in found.verdict.attention), "rounding was told as an error"
    again = concio.load_motion(concio.save_motion(found, tmp_path / "motion.npz"))
    assert again.energy.error == found.energy.error, "a file keeps what exchanges are measured by"
    moved = concio.dynamics(on_knife_edges(dim), duration=0.05, velocities={"beam": (0.1, 0.0, 0.0)})
    assert not moved.energy.still
    assert not any("energy balance" in told for told in moved.verdict.attention)
    friction = moved.energy["friction"] * 1.01
    wrong = replace(moved, energy=replace(moved.energy, values={**moved.energy.values, "friction": friction}))
    assert any("energy balance" in told for told in wrong.verdict.attention)


def test_a_corner_with_a_compressive_strength_holds_in_no_command(tmp_path):
    crushes = concio.JointLaw(0.6, compressive_strength=5000.0)
    model = on_knife_edges(2, crushes)
    with pytest.raises(concio.ConcioError, match="compressive strength"):
        concio.solve(model)
    pulse = concio.Pulse("sine", 0.1, 0.1)
    found = concio.dynamics(model, pulse, duration=0.2)
    assert found.rests
    assert (found.verdict.outcome, found.verdict.exit_code) == (Outcome.INCOMPLETE, 4), "it was said to come to rest"
    (told,) = found.verdict.unchecked
    assert "'joint' at 2 contacts" in told
    assert not any("almost made" in line for line in (*found.verdict.limits, *found.verdict.attention))
    pushed = concio.push(model, until=1e-5)
    assert (pushed.ending.name, pushed.verdict.outcome) == ("REACHED", Outcome.INCOMPLETE)
    assert any("'joint' at 2 contacts" in told for told in pushed.verdict.unchecked)
    without = concio.dynamics(on_knife_edges(2), pulse, duration=0.2)
    assert without.verdict.outcome is Outcome.HOLDS
    on_a_face = concio.dynamics(standing(friction=crushes), duration=0.2, gravity=G)
    assert on_a_face.verdict.outcome is Outcome.HOLDS, "a joint with a length has its strength"


def test_a_body_that_stands_upright_to_rounding_is_not_tilted() -> None:
    """Products of rotations leave cosines above one by a rounding, where no angle exists."""
    turned = np.eye(3)[None] * (1 + np.array([0.0, 4e-16, -4e-16]))[:, None, None]
    assert tilted(turned) == pytest.approx(0.0, abs=1e-7)
    assert tilted(np.array([[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]])) == pytest.approx(np.pi / 2)
