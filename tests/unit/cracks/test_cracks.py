"""From cracks to cause: forms of measurements and candidates, closed forms, ambiguity, mistakes, bad input."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import concio
from concio import Candidate, InputError, Measurement
from concio.analysis.cracks import forward, search
from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.diagnose import expected
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.moved import moved_model
from concio.analysis.cracks.observed import readings
from concio.verdict.diagnosis_verdict import diagnosis_verdict
from concio.verdict.diagnosis_words import EN, IT
from models import box, model_of, weight
from samples import first

SPAN, RING, SKEW = 1.2, 0.3, 70.0
TOP = (-SPAN / 2 - RING / np.tan(np.deg2rad(SKEW)), RING)
"""Upper end of the left springer joint of the flat arch."""
ERROR = 0.2e-3
GIVES = Candidate("left gives way", body="left abutment", direction=(-1, 0), low=0.0)
OTHER = Candidate("right gives way", body="right abutment", direction=(1, 0), low=0.0)
SINKS = Candidate("left sinks", body="left abutment", direction=(0, -1), low=0.0)
TURNS = Candidate("left turns", body="left abutment", rotation=1.0)


def flat_arch(**options):
    return concio.arch(
        shape="flat", span=SPAN, ring=RING, voussoirs=6, skew=SKEW, block="rigid", friction=2.0, **options
    )


def spread_cracks(spread, error=ERROR):
    """What the flat arch shows by closed form where its abutments spread: hinges at the springers and above the crown.

    Each half turns by spread / (2 ring) about the lower end of its springer joint.
    """
    turn = spread / (2 * RING)
    return [
        Measurement("crown", "opening", error, turn * 2 * RING, ("v03", "v04"), at=(0.0, 0.0)),
        Measurement("springer", "opening", error, turn * float(np.hypot(TOP[0] + SPAN / 2, RING)),
                    ("left abutment", "v01"), at=TOP),
        Measurement("between", "closed", error, joint=("v02", "v03")),
        Measurement("crown sinks", "level", error, -turn * SPAN / 2, body="v03", at=(0.0, RING)),
        Measurement("half turns", "tilt", error / RING, -turn, body="v02"),
    ]  # fmt: skip


def diagnosed(model, measurements, candidates, **options):
    return concio.diagnose(model, measurements, candidates, **{"large": False, **options})


def predicted(model, measurements, candidates, motions, **options):
    """What the measurements would read after some motions."""
    moved = moved_model(model, candidates, expected(model, measurements, candidates))
    assembly = concio.assemble(moved.model)
    forward = Forward.of(assembly, moved, readings(assembly, measurements), options.get("method"), 1)
    found = forward.predict(np.array(motions, dtype=float))
    assert found.reached
    return found.values


def with_values(measurements, values):
    return [dataclasses.replace(m, value=float(v)) for m, v in zip(measurements, values, strict=True)]


def test_a_flat_arch_that_spreads_shows_what_three_hinges_do() -> None:
    values = predicted(flat_arch(), spread_cracks(0.0), [GIVES], [0.01])
    exact = [m.value for m in spread_cracks(0.01)]
    np.testing.assert_allclose(values, exact, rtol=1e-3, atol=1e-5)


def test_the_spreading_of_a_flat_arch_is_found_from_its_cracks() -> None:
    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES, SINKS, TURNS])
    assert [c.names for c in found.causes] == [("left gives way",)]
    cause = found.causes[0]
    assert cause.motion[0] == pytest.approx(0.01, rel=2e-3)
    assert cause.low[0] < 0.01 < cause.high[0]
    assert cause.certificate < 1e-9
    assert found.verdict.exit_code == 0
    assert found.verdict.status == "one_cause"
    assert "left gives way" in found.verdict.sentence


def test_an_interval_is_that_of_least_squares_where_the_model_is_linear() -> None:
    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES])
    slopes = np.array([m.value / m.error for m in spread_cracks(0.1)]) / 0.1
    deviation = 1 / np.linalg.norm(slopes)
    cause = found.causes[0]
    np.testing.assert_allclose(np.sqrt(cause.covariance), [[deviation]], rtol=1e-2)
    np.testing.assert_allclose([cause.high[0] - cause.low[0]], [2 * 1.959964 * deviation], rtol=2e-2)


def test_a_small_motion_beside_a_large_one_is_told_where_it_fits_clearly_better() -> None:
    cracks = spread_cracks(0.0, error=0.4e-3)
    values = predicted(flat_arch(), cracks, [GIVES, TURNS], [0.01, -3e-3])
    values[[m.kind == "closed" for m in cracks]] = 0.0
    found = diagnosed(flat_arch(), with_values(cracks, values), [GIVES, TURNS, SINKS])
    assert [c.names for c in found.causes] == [("left gives way",)]
    first = found.additions[0]
    assert first.name == "left turns"
    np.testing.assert_allclose(first.motions, [0.01, -3e-3], rtol=1e-2)
    np.testing.assert_array_equal(first.cause.motion, first.motions)
    assert (first.cause.low < [0.01, -3e-3]).all()
    assert (first.cause.high > [0.01, -3e-3]).all()
    assert found.shown == (*found.causes, first.cause)
    assert [a.cause for a in found.additions[1:]] == [None] * (len(found.additions) - 1)
    assert found.causes[0].misfit - first.misfit > 3.84
    for language, words in (("en", "clearly better"), ("it", "nettamente migliore")):
        assert words in diagnosis_verdict(found, language).sentence
    assert found.summary()["additions"][0]["motions"].keys() == {"left gives way", "left turns"}


def test_a_cause_that_explains_all_that_was_measured_has_nothing_added() -> None:
    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES, TURNS, SINKS])
    assert found.additions == ()
    assert "clearly better" not in found.verdict.sentence


def test_which_abutment_gave_way_is_told_as_ambiguous() -> None:
    found = diagnosed(flat_arch(), spread_cracks(0.01)[:3], [GIVES, OTHER, SINKS])
    assert {c.names for c in found.causes} == {("left gives way",), ("right gives way",)}
    assert found.verdict.status == "several_causes"
    assert found.verdict.exit_code == 4
    assert any({"left gives way", "right gives way"} <= {*u.names} for u in found.unseen)
    np.testing.assert_allclose([c.motion for c in found.causes], 0.01, rtol=5e-3)


def test_structures_that_moved_by_no_more_than_the_errors_need_no_cause() -> None:
    found = diagnosed(flat_arch(), spread_cracks(0.0), [GIVES])
    assert [c.names for c in found.causes] == [()]
    assert found.verdict.status == "no_motion"


def test_what_no_candidate_explains_is_told() -> None:
    cracks = spread_cracks(0.01)
    found = diagnosed(flat_arch(), cracks, [SINKS])
    assert found.causes == ()
    assert found.verdict.status == "no_cause"
    assert found.verdict.exit_code == 3
    assert found.nearest is not None
    assert "explains the measurements (at most 1 together)" in found.verdict.sentence
    assert any("may have been missed" in line for line in found.verdict.limits)


@pytest.mark.long
def test_that_there_is_no_cause_is_told_of_fine_paths_alone() -> None:
    cracks = spread_cracks(0.01)
    none = diagnosed(flat_arch(), cracks, [SINKS], method="steps")
    assert none.verdict.status == "no_cause"
    assert none.forward.steps == 64
    one = diagnosed(flat_arch(), cracks, [GIVES], method="steps")
    assert one.verdict.status == "one_cause"
    assert one.forward.steps == 4


def test_measurements_are_left_out_of_choices_that_are_simpler_than_a_cause_alone(monkeypatch) -> None:
    asked = []

    def without(fitter, fit, confidence):
        asked.append(fit.chosen)
        return []

    monkeypatch.setattr(search, "without_one", without)
    one = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES, SINKS, TURNS])
    assert [c.names for c in one.causes] == [("left gives way",)]
    assert asked == [()]
    asked.clear()
    cracks = spread_cracks(0.01)
    cracks[1] = dataclasses.replace(cracks[1], value=10 * cracks[1].value)
    none = diagnosed(flat_arch(), cracks, [GIVES], most=1)
    assert none.causes == ()
    assert asked[:2] == [(), (0,)]


def test_paths_in_steps_lead_to_the_same_readings_by_either_solver(monkeypatch) -> None:
    options = {"method": "steps"}
    quick = predicted(flat_arch(), spread_cracks(0.0), [GIVES, SINKS], [0.01, 0.002], **options)
    monkeypatch.setattr(Forward, "_solvers", ("auto",))
    sure = predicted(flat_arch(), spread_cracks(0.0), [GIVES, SINKS], [0.01, 0.002], **options)
    np.testing.assert_allclose(quick, sure, rtol=1e-6, atol=1e-9)


def test_a_path_that_the_quick_solver_loses_is_followed_by_the_sure_one(monkeypatch) -> None:
    tried = []
    follow = forward.run_path

    def lost(assembly, stages, *, solver="auto", **options):
        tried.append(solver)
        if solver == "interior-point":
            raise concio.SolverError("lost")
        return follow(assembly, stages, solver=solver, **options)

    monkeypatch.setattr(forward, "run_path", lost)
    predicted(flat_arch(), spread_cracks(0.0), [GIVES], [0.01], method="steps")
    assert tried[-2:] == ["interior-point", "auto"]


@pytest.mark.parametrize(
    ("number", "wrong", "mistake"),
    first(1, [(1, lambda v: 10 * v, "unit"), (3, lambda v: -v, "sign"), (1, lambda v: 1.7 * v, "unknown")]),
)
def test_a_wrong_measurement_is_named_with_its_mistake(number, wrong, mistake) -> None:
    cracks = spread_cracks(0.01)
    cracks[number] = dataclasses.replace(cracks[number], value=wrong(cracks[number].value))
    found = diagnosed(flat_arch(), cracks, [GIVES, SINKS], most=1)
    assert found.causes == ()
    assert [d.measurement for d in found.doubts] == [cracks[number].name]
    assert found.doubts[0].mistake == mistake
    assert found.doubts[0].cause.motion[0] == pytest.approx(0.01, rel=1e-2)
    assert found.verdict.status == "measurement_in_doubt"
    assert found.verdict.exit_code == 4


def test_a_measurement_at_the_wrong_place_is_found_where_it_belongs() -> None:
    cracks = spread_cracks(0.01)
    cracks.append(Measurement("displaced", "opening", ERROR, cracks[0].value, ("v02", "v03"), at=(-0.2, 0.0)))
    found = diagnosed(flat_arch(), cracks, [GIVES], most=1)
    assert [(d.measurement, d.mistake, d.place) for d in found.doubts] == [("displaced", "place", ("v03", "v04"))]


def test_a_simple_bar_of_two_blocks_turns_with_its_ground() -> None:
    stone = {"kind": "rigid", "material": "stone"}
    model = model_of(
        box("left", -1, 0, -1, 0, kind="fixed"), box("right", 0, 1, -1, 0, kind="fixed"),
        box("a", -1, 0, 0, 1, **stone), box("b", 0, 1, 0, 1, **stone), loads=(weight(),),
    )  # fmt: skip
    about = Candidate("right turns about its corner", body="right", rotation=1.0, about=(0.0, 0.0))
    measured = [
        Measurement("tilt", "tilt", 1e-4, body="b"),
        Measurement("level", "level", 1e-4, body="b", at=(1.0, 1.0)),
        Measurement("between", "level", 1e-4, body="b", at=(1.0, 1.0), other="a", to=(-1.0, 1.0)),
        Measurement("ground", "tilt", 1e-4, body="right"),
        Measurement("width", "distance", 1e-4, body="a", at=(-1.0, 1.0), other="b", to=(1.0, 1.0)),
        Measurement("crack", "opening", 1e-4, at=(0.0, 1.0)),
        Measurement("slid", "slip", 1e-4, joint=("b", "a"), at=(0.0, 0.0)),
    ]
    values = predicted(model, measured, [about], [-2e-3])
    np.testing.assert_allclose(values, [-2e-3, -2e-3, -2e-3, -2e-3, 2e-3, 2e-3, 0.0], atol=5e-6)


def test_slip_has_one_sign_whichever_body_is_named_first() -> None:
    joints = [("v01", "v02"), ("v02", "v01")]
    measured = [Measurement(str(k), "slip", ERROR, joint=joint) for k, joint in enumerate(joints)]
    values = predicted(flat_arch(), measured, [SINKS, GIVES], [0.002, 0.004])
    assert values[0] == values[1]


def test_a_mirrored_structure_has_the_mirrored_cause() -> None:
    def cracks(side):
        top = (-side * TOP[0], TOP[1])
        springer = ("left abutment", "v01") if side < 0 else ("right abutment", "v06")
        return [
            Measurement("springer", "opening", ERROR, 4e-3, springer, at=top),
            Measurement("crown", "opening", ERROR, 7.5e-3, ("v03", "v04"), at=(0.0, 0.0)),
            Measurement("level", "level", ERROR, -7.3e-3, body="v03" if side < 0 else "v04", at=(0.0, RING)),
        ]

    left, right = (
        diagnosed(flat_arch(), cracks(side), [Candidate("gives way", body=f"{word} abutment", direction=(side, 0))])
        for side, word in ((-1, "left"), (1, "right"))
    )
    assert left.trials[-1].fit.misfit == pytest.approx(right.trials[-1].fit.misfit, rel=1e-6)
    np.testing.assert_allclose(left.best.motion, right.best.motion, rtol=1e-6)


def test_a_load_that_grew_is_a_candidate() -> None:
    model = model_of(
        box("ground", -1, 1, -1, 0, kind="fixed"), box("a", -0.5, 0.5, 0, 1),
        loads=(weight(), concio.Load("pressure", (5.0,), ("a",), edge=((-0.5, 1.0), (0.5, 1.0)), group="roof")),
    )  # fmt: skip
    grew = Candidate("roof is heavier", group="roof")
    measured = [
        Measurement(name, "level", 1e-6, body="a", at=(x, 1.0)) for name, x in (("l", -0.5), ("m", 0.0), ("r", 0.5))
    ]
    values = predicted(model, measured, [grew], [1.0])
    assert (values < 0).all()
    found = diagnosed(model, with_values(measured, 2.5 * values), [grew])
    np.testing.assert_allclose(found.best.motion, [2.5], rtol=1e-3)
    assert found.best.names == ("roof is heavier",)
    assert "factor" in found.verdict.sentence


def test_a_cause_that_forces_rigid_blocks_together_is_told_as_such() -> None:
    pressed = dataclasses.replace(GIVES, low=-np.inf)
    asked = [
        Measurement("span", "distance", 1e-3, body="left abutment", at=(-SPAN / 2, 0.0), other="right abutment",
                    to=(SPAN / 2, 0.0)),
        Measurement("ground", "level", 1e-3, body="left abutment", at=(-0.8, 0.0), direction=(-1.0, 0.0)),
        Measurement("sinks", "level", 1e-3, body="v01", at=(-SPAN / 2, 0.0)),
    ]  # fmt: skip
    values = predicted(flat_arch(), asked, [pressed], [-0.02])
    np.testing.assert_allclose(values[:2], -0.02, rtol=1e-6)
    found = diagnosed(flat_arch(), with_values(asked, values), [pressed])
    assert [c.names for c in found.causes] == [("left gives way",)]
    # seven joints of the chain share what the abutment takes away, and nothing else makes room for it
    assert 0.02 / 7 / 2 < found.closing < 0.02
    assert (found.verdict.status, found.verdict.exit_code) == ("forced_together", 4)
    for language, words in (("en", "forced together"), ("it", "forzati insieme")):
        assert any(words in line for line in diagnosis_verdict(found, language).attention)
    spread = diagnosed(flat_arch(), spread_cracks(0.01), [pressed])
    assert (spread.verdict.status, spread.forced) == ("one_cause", False)
    assert spread.closing < 1e-5
    assert any("were given a compliance" in line for line in spread.verdict.limits)


def test_joints_with_a_stiffness_are_lent_nothing() -> None:
    law = concio.JointLaw(2.0, normal_stiffness=1e7, tangential_stiffness=4e6)
    soft = dataclasses.replace(flat_arch(), laws=dict.fromkeys(flat_arch().laws, law))
    found = diagnosed(soft, spread_cracks(0.01), [GIVES])
    assert (found.lent, found.closing) == (0.0, 0.0)
    assert not any("were given a compliance" in line for line in found.verdict.limits)


def test_places_that_were_measured_are_not_to_be_measured_next() -> None:
    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES, SINKS, TURNS])
    assert found.verdict.status == "one_cause"
    told = [(p.kind, {*p.joint}, p.at) for p in found.places]
    assert told
    for m in spread_cracks(0.01)[:2]:
        assert not [at for kind, joint, at in told
                    if kind == "opening" and joint == {*m.joint} and np.allclose(at, m.at, atol=1e-3)]  # fmt: skip


def test_what_one_cause_leaves_open_at_a_place_is_twice_its_deviation() -> None:
    """An abutment is where its motion says: two standard deviations of the motion are those of its place."""
    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES])
    (cause,) = found.causes
    first = found.places[0]
    assert (first.kind, first.joint, first.direction) == ("displacement", ("left abutment",), (1.0, 0.0))
    np.testing.assert_allclose(first.spread, 2.0 * np.sqrt(cause.covariance[0, 0]), rtol=1e-6)


def test_a_measurement_in_doubt_is_to_be_measured_again() -> None:
    cracks = spread_cracks(0.01)
    cracks[1] = dataclasses.replace(cracks[1], value=10 * cracks[1].value)
    found = diagnosed(flat_arch(), cracks, [GIVES], most=1)
    assert [d.measurement for d in found.doubts] == ["springer"]
    assert any(p.kind == "opening" and {*p.joint} == {"left abutment", "v01"} for p in found.places)


def test_what_is_measured_next_tells_what_these_measurements_do_not() -> None:
    turns = Candidate("right turns", body="right abutment", rotation=1.0)
    error = 0.4e-3
    cracks = spread_cracks(0.01, error)[:4]
    found = diagnosed(flat_arch(), cracks, [GIVES, turns])
    assert [c.names for c in found.causes] == [("left gives way",)]
    assert any("right turns" in u.names for u in found.unseen)
    first = found.places[0]
    assert {*first.joint} == {"right abutment", "v06"}
    assert first.spread > 5 * error
    more = Measurement("told", "opening", error, first.predicted[0], first.joint, at=first.at)
    again = diagnosed(flat_arch(), [*cracks, more], [GIVES, turns])
    assert not again.unseen
    assert max((p.spread for p in again.places), default=0.0) < 0.2 * first.spread


def test_the_next_place_is_where_two_causes_differ_most() -> None:
    both = diagnosed(flat_arch(), spread_cracks(0.01)[:3], [GIVES, OTHER], most=1)
    first = both.places[0]
    told = np.ptp([c.motions for c in both.causes], axis=0)
    assert told.min() > 0.009
    # every joint opens by the same, whichever abutment moved: only how far something has moved tells them apart
    assert (first.kind, first.direction) == ("displacement", (1.0, 0.0))
    assert first.spread == pytest.approx(0.01, rel=5e-3)
    assert first.spread == pytest.approx(np.ptp(first.predicted))
    assert "displacement of" in both.verdict.sentence
    assert "spostamento di" in diagnosis_verdict(both, "it").sentence
    body = next(b for b in flat_arch().bodies if b.name == first.joint[0])
    more = Measurement("told", "level", ERROR, first.predicted[0], body=body.name, at=body.centroid, direction=(1, 0))
    one = diagnosed(flat_arch(), [*spread_cracks(0.01)[:3], more], [GIVES, OTHER], most=1)
    assert [c.names for c in one.causes] == [both.causes[0].names]


def test_the_next_openings_are_those_in_which_two_causes_differ_most() -> None:
    both = diagnosed(flat_arch(), spread_cracks(0.01)[1:3], [GIVES, TURNS], most=1)
    assert len(both.causes) == 2
    first = both.places[0]
    assert first.kind in {"opening", "slip"}
    assert first.spread == pytest.approx(np.ptp(first.predicted))
    assert first.spread > ERROR
    assert all(a.spread >= b.spread for a, b in zip(both.places, both.places[1:], strict=False))


def test_both_languages_say_the_same_numbers() -> None:
    assert {*EN} == {*IT}
    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES, SINKS])
    for language in ("en", "it"):
        verdict = diagnosis_verdict(found, language)
        assert "'left gives way'" in verdict.sentence
        assert " 10 mm (" in verdict.sentence
        assert "9.75 mm" in verdict.sentence
        assert ("Not checked: " in verdict.sentence) == (language == "en")
    for key, text in EN.items():
        names = {w.split("}")[0] for w in text.split("{")[1:]}
        assert names == {w.split("}")[0] for w in IT[key].split("{")[1:]}, key


def test_a_summary_is_plain_and_complete() -> None:
    import json

    found = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES])
    told = json.loads(json.dumps(found.summary(), allow_nan=False))
    assert told["causes"][0]["motions"][0]["name"] == "left gives way"
    assert told["verdict"]["exit_code"] == 0
    assert len(told["causes"][0]["predicted"]) == len(told["measurements"])
    assert isinstance(found.best, Cause)


GOOD = {"name": "m", "kind": "opening", "error": 1e-4, "joint": ("v01", "v02")}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "crack"}, "unknown kind"),
        ({"error": 0.0}, "must be positive"),
        ({"error": 0.5}, "give the unit, such as '0.5 mm'"),
        ({"kind": "tilt", "joint": (), "body": "v01", "error": 0.1}, "a bare number is in rad"),
        ({"value": float("nan")}, "not a number"),
        ({"value": -1e-3}, "less than nothing"),
        ({"kind": "closed", "value": 1e-3}, "closed joint has no value"),
        ({"joint": ()}, "joint is not given"),
        ({"joint": ("v01",)}, "joint is not given"),
        ({"body": "v01"}, "belongs to a joint"),
        ({"kind": "tilt"}, "belongs to a body"),
        ({"kind": "tilt", "joint": ()}, "body is not given"),
        ({"kind": "level", "joint": (), "body": "v01"}, "point is not given"),
        ({"kind": "distance", "joint": (), "body": "v01", "at": (0, 0)}, "between two points"),
        ({"kind": "tilt", "joint": (), "body": "v01", "at": (0, 0)}, "one of them is missing"),
        ({"error": "2 kN"}, "is not a length"),
    ],
)
def test_a_measurement_that_cannot_be_meant_is_refused(change, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        Measurement(**{**GOOD, **change})
    assert "measurement 'm'" in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, "exactly one"),
        ({"body": "a"}, "exactly one"),
        ({"body": "a", "direction": (0, -1), "rotation": 1.0}, "exactly one"),
        ({"body": "a", "group": "live"}, "exactly one"),
        ({"group": "live", "direction": (0, -1)}, "no direction"),
        ({"group": "live", "low": 1.0}, "allowed to be zero"),
        ({"body": "a", "direction": (0, -1), "base": 1.0}, "base is"),
    ],
)
def test_a_candidate_that_cannot_be_meant_is_refused(change, words) -> None:
    with pytest.raises(InputError, match=words):
        Candidate("c", **change)


@pytest.mark.parametrize(
    ("measured", "candidates", "words"),
    [
        ([Measurement(**{**GOOD, "joint": ("v01", "v99")})], [GIVES], "no body called 'v99'"),
        ([Measurement(**{**GOOD, "joint": ("v01", "v04")})], [GIVES], "no joint between"),
        ([Measurement(**GOOD, at=(3.0, 3.0))], [GIVES], "away from the nearest joint"),
        ([Measurement(**GOOD, at=(3.0, 3.0, 1.0))], [GIVES], "2 coordinates"),
        ([], [GIVES], "0 measurements"),
        ([Measurement(**GOOD), Measurement(**GOOD)], [GIVES], "two measurements"),
        ([Measurement(**GOOD)], [], "no candidate"),
        ([Measurement(**GOOD)], [GIVES, GIVES], "two candidates"),
        ([Measurement(**GOOD)], [Candidate("c", body="v01", direction=(0, -1))], "is not fixed"),
        ([Measurement(**GOOD)], [Candidate("c", body="nothing", direction=(0, -1))], "no body called"),
        ([Measurement(**GOOD)], [Candidate("c", group="nothing")], "no load group"),
        ([Measurement(**GOOD)], [Candidate("c", body="left abutment", direction=(0, -1, 0))], "not a direction"),
        (["K1", "K2"], [GIVES], "Measurement is needed"),
    ],
)
def test_what_does_not_fit_the_model_is_refused_with_its_name(measured, candidates, words) -> None:
    also = [Measurement("also", "closed", 1e-4, joint=("v01", "v02"))] if measured else []
    with pytest.raises(InputError, match=words):
        diagnosed(flat_arch(), [*measured, *also], candidates)


def test_a_structure_that_does_not_stand_is_told_before_anything_is_sought() -> None:
    thin = concio.arch(span=1.91, ring=0.09, voussoirs=21, block="rigid", friction=1.0)
    measured = [Measurement(n, "closed", 1e-4, joint=j) for n, j in (("a", ("v01", "v02")), ("b", ("v02", "v03")))]
    with pytest.raises(concio.NoEquilibriumError, match="does not stand") as caught:
        diagnosed(thin, measured, [GIVES])
    assert caught.value.verdict.exit_code == 3


def test_how_many_motions_were_looked_at_together_is_told_where_there_are_more() -> None:
    few = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES])
    assert not [line for line in few.verdict.limits if "were not examined" in line]
    many = diagnosed(flat_arch(), spread_cracks(0.01), [GIVES, OTHER, SINKS, TURNS])
    looked = max(len(t.chosen) for t in many.trials)
    assert 0 < looked < 4
    assert f"causes of more motions than {looked} were not examined" in many.verdict.limits
