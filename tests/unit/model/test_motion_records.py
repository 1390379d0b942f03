"""Records of ground motion: what is read, and what is said of those that cannot be used."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.model.motion.records import attention

AT2 = """PEER STRONG MOTION DATABASE RECORD
SOME EVENT, SOME PLACE
ACCELERATION TIME HISTORY IN UNITS OF G
NPTS=    7, DT=   0.0100 SEC
 0.0 0.1 0.2 0.1
 0.0 -.1E+00 0.0
"""


def test_at2_is_read_in_g(tmp_path):
    path = tmp_path / "record.at2"
    path.write_text(AT2)
    record = concio.read_record(path)
    assert record.step == 0.01
    assert record.values == pytest.approx(9.80665 * np.array([0, 0.1, 0.2, 0.1, 0, -0.1, 0]))
    assert record.duration == pytest.approx(0.06)


def test_text_of_two_columns_and_of_one(tmp_path):
    two = tmp_path / "two.csv"
    two.write_text("time;acceleration\n0.00;1.0\n0.02;2.0\n0.04;-1.0\n")
    assert concio.read_record(two, unit="m/s2").values.tolist() == [1.0, 2.0, -1.0]
    with pytest.raises(concio.InputError, match="does not say its unit; its largest value is 2 "):
        concio.read_record(two)
    one = tmp_path / "one.txt"
    one.write_text("# cm/s2\n100\n200\n-100\n")
    record = concio.read_record(one, unit="cm/s2", step=0.02)
    assert record.values.tolist() == [1.0, 2.0, -1.0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0.0 1\n0.1 2\n0.3 1\n0.4 1\n", "the record has a gap: 0.2 s between 0.1 s and 0.3 s"),
        ("0.0 1\n0.1 2\nlost\n0.2 1\n", "line 3 is not a number: the record has a gap"),
        ("1.0 0.0\n2.0 0.1\n1.5 0.2\n", "the two columns are swapped"),
        ("0.0 1\n0.2 2\n0.1 1\n", "time does not rise: after 0.2 s comes 0.1 s"),
        ("1\n2\n3\n", "the time between samples is not known"),
        ("nothing\n", "holds no numbers"),
        ("1 2 3\n4 5 6\n", "one or two columns are read"),
    ],
)
def test_what_cannot_be_used_is_said(tmp_path, text, words):
    path = tmp_path / "record.txt"
    path.write_text(text)
    with pytest.raises(concio.InputError, match=words):
        concio.read_record(path)


def test_a_cut_at2_file(tmp_path):
    path = tmp_path / "record.at2"
    path.write_text(AT2.replace("NPTS=    7", "NPTS=    9"))
    with pytest.raises(concio.InputError, match="announces 9 samples, the file holds 7"):
        concio.read_record(path)


def test_a_peak_above_five_g_gets_an_attention():
    record = concio.Record(np.array([0.0, 60.0, 0.0]), 0.01, name="el_centro")
    said = attention(record)
    assert said is not None
    assert "'el_centro' has a peak of 6.12 g" in said
    assert attention(concio.Record(np.array([0.0, 6.0, 0.0]), 0.01)) is None


@pytest.mark.parametrize("shape", ["rectangular", "half sine", "sine", "ricker"])
def test_pulses_integrate_exactly(shape):
    """Velocity and displacement against quadrature of the acceleration."""
    pulse = concio.Pulse(shape, 3.0, 0.4, 1.5 if shape == "sine" else 1.0)
    t = np.linspace(0.0, pulse.duration, 20001)
    a = pulse.acceleration(t)
    v = np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(t))])
    d = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    assert pulse.velocity(t) == pytest.approx(v, abs=2e-4)
    assert pulse.displacement(t) == pytest.approx(d, abs=2e-4)
    assert np.abs(a).max() == pytest.approx(3.0, rel=1e-3)


def test_a_record_given_as_velocity_or_displacement_is_the_same_motion():
    t = np.linspace(0.0, 2.0, 401)
    a, v, d = -np.sin(3 * t) * 9, np.cos(3 * t) * 3 - 3, np.sin(3 * t) - 3 * t
    by_a, by_v, by_d = (
        concio.Record(values, 0.005, quantity)
        for values, quantity in ((a, "acceleration"), (v, "velocity"), (d, "displacement"))
    )
    at = np.linspace(0.1, 1.9, 50)
    for record in (by_a, by_v, by_d):
        assert record.velocity(at) - record.velocity(np.array([0.1])) == pytest.approx(
            by_a.velocity(at) - by_a.velocity(np.array([0.1])), abs=1e-3
        )


@pytest.mark.parametrize(("suffix", "quantity", "unit"), [(".vt2", "velocity", 0.01), (".DT2", "displacement", 0.01)])
def test_velocities_and_displacements_of_peer_are_read_in_cm(tmp_path, suffix, quantity, unit):
    file = tmp_path / f"record{suffix}"
    head = "PEER STRONG MOTION DATABASE RECORD\nSOMEWHERE 01/01/70\nUNITS\nNPTS=    4, DT= .0100 SEC\n"
    file.write_text(head + "  .1000E+01 -.2000E+01  .3000E+01\n  .0000E+00\n")
    record = concio.read_record(file)
    assert record.quantity == quantity
    assert record.step == 0.01
    assert record.values == pytest.approx(unit * np.array([1.0, -2.0, 3.0, 0.0]))


@pytest.mark.parametrize(
    ("suffix", "units", "count", "step", "words"),
    [
        (".at2", "VELOCITY TIME SERIES IN UNITS OF CM/S", "3", "0.01", "in cm/s, the name of the file acceleration"),
        (".vt2", "VELOCITY TIME SERIES IN UNITS OF FURLONG", "3", "0.01", "'FURLONG', which is not known"),
        (".at2", "ACCELERATION TIME SERIES IN UNITS OF G", "9" * 5000, "0.01", "the header has no 'NPTS"),
        (".at2", "ACCELERATION TIME SERIES IN UNITS OF G", "3", "1e308", "at most 60 s"),
    ],
)  # fmt: skip
def test_hostile_heads_of_peer_files(tmp_path, suffix, units, count, step, words):
    path = tmp_path / f"record{suffix}"
    path.write_text(f"PEER\nevent\n{units}\nNPTS= {count}, DT= {step} SEC\n0.1 0.2 0.1\n", encoding="ascii")
    with pytest.raises(concio.InputError, match=words):
        concio.read_record(path)


def test_a_file_too_large_for_a_record(tmp_path):
    path = tmp_path / "record.txt"
    with path.open("wb") as file:
        file.truncate(300_000_000)
    with pytest.raises(concio.InputError, match="300 MB: that is not a record"):
        concio.read_record(path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"unit": "m/s2"}, "the values are in g, and the unit m/s2 is given"),
        ({"unit": "cm/s"}, "the values are in g, and the unit cm/s is given"),
        ({"step": 0.02}, "DT = 0.01 s, and a step of 0.02 s is given"),
    ],
)
def test_what_a_header_says_is_not_replaced_without_a_word(tmp_path, options, words):
    """Accelerations in g were read as m/s2, or as velocities; a step of time was left aside."""
    path = tmp_path / "record.at2"
    path.write_text(AT2)
    with pytest.raises(concio.InputError, match=words):
        concio.read_record(path, **options)
    assert concio.read_record(path, unit="g", step=0.01).values == pytest.approx(concio.read_record(path).values)


def test_a_unit_is_given_where_the_header_names_none(tmp_path):
    path = tmp_path / "record.at2"
    path.write_text(AT2.replace("UNITS OF G", "SOME UNITS"))
    assert concio.read_record(path, unit="m/s2").values.max() == pytest.approx(0.2)
    with pytest.raises(concio.InputError, match="the name of the file says acceleration, and the unit cm is given"):
        concio.read_record(path, unit="cm")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 2 3\n4 5 6\n7 8 9\n10 1 1\n", "every line holds 3 numbers, the first of which run as times do"),
        ("1 2 3\n5 5 6\n7 8 9\n", "every line holds 3 numbers: one record"),
        ("0.00 1 2 3\n0.01 5 5 6\n0.03 7 8 9\n", "every line holds 4 numbers: one record"),
        ("0.00 1 2 3 4 5 6\n0.01 5 5 6 1 2 3\n0.02 7 8 9 4 4 4\n0.03 1 2 3 4 5 6\n", "run as times do"),
        ("3 0.01\n0.1\n0.2\n0.3\n", "row 2 of numbers holds 1, the first one 2"),
    ],
)
def test_columns_are_not_read_one_after_the_other(tmp_path, text, words):
    """Three components side by side were one record of three times the length, x, y and z by turns."""
    path = tmp_path / "record.txt"
    path.write_text(text)
    with pytest.raises(concio.InputError, match=words):
        concio.read_record(path, unit="m/s2", step=0.01)


def test_values_of_one_record_may_stand_several_on_a_line(tmp_path):
    path = tmp_path / "record.txt"
    path.write_text("# five on a line\n0.1 0.3 0.2 0.1 0.5\n0.2 0.1 0.4 0.1 0.2\n0.3 0.2\n")
    assert concio.read_record(path, unit="m/s2", step=0.01).duration == pytest.approx(0.11)


def test_a_record_of_velocities_that_does_not_begin_at_rest_gets_an_attention():
    """Forces of inertia and a base that moves answer differently: one block slid right, the other left."""
    said = attention(concio.Record(np.array([0.3, 0.2, 0.0]), 0.01, "velocity", "cut"))
    assert said is not None
    assert "'cut' begins with a velocity of 0.3 m/s" in said
    assert attention(concio.Record(np.array([0.01, 0.3, 0.0]), 0.01, "velocity")) is None
