"""What a study says of all its runs: those that fail, have no end, or have no answer count where they belong."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from commands import run
from concio.studies.outputs import KNOWN, Output
from concio.studies.sampling import draw
from concio.studies.statistics import Spread
from concio.studies.study_result import StudyResult
from concio.studies.study_rows import Row
from concio.verdict.study_verdict import output_words
from concio.verdict.verdict import Outcome
from samples import sample

PILLAR = """
[materials.stone]
kind = "rigid"
unit_weight = "20 kN/m3"
[joints.dry]
friction = 0.7
[[blocks]]
name = "floor"
rectangle = [[-3.0, -0.5], [3.0, 0.0]]
kind = "fixed"
[[blocks]]
name = "pillar"
rectangle = [[-0.2, 0.0], [0.2, 1.6]]
kind = "rigid"
material = "stone"
[[loads]]
kind = "weight"
value = [0.0, -1.0]
group = "dead"
[[loads]]
kind = "point"
value = [1.0, 0.0]
bodies = ["pillar"]
at = [0.0, 1.6]
group = "wind"
[[loads]]
kind = "weight"
value = [1.0, 0.0]
group = "live"
"""
"""A pillar of 0.4 x 1.6 m, 12.8 kN: wind of H kN at its top turns it from H = 1.6 kN on, alone; with a share a of its
weight from H = 1.6 - 6.4 a on."""
WIND = {"H": {"keys": "loads[2].value[1]", "distribution": "uniform", "low": 0.0, "high": 3.2}}


def pillar(outputs: Any, size: int = 6, **options: Any) -> StudyResult:
    import tomllib

    return concio.study(tomllib.loads(PILLAR), WIND, outputs, "grid" if size == 5 else "latin-hypercube",
                        **({} if size == 5 else {"size": size, "seed": 1}), **options)  # fmt: skip


def made_up(kinds: list[str], numbers: np.ndarray, output: Output) -> StudyResult:
    """Return a study with rows of these kinds: "number", "endless", "fails", "open"."""
    variables = [concio.variable("x", low=0.0, high=1.0)]
    rows = []
    for k, (kind, x) in enumerate(zip(kinds, numbers, strict=True)):
        value = {"number": float(x), "endless": math.inf}.get(kind, math.nan)
        fails = (output.name,) if kind == "fails" else ()
        rows.append(Row(k, "done", "", {output.name: value}, 0.0, fails))
    return StudyResult(draw(variables, "monte-carlo", len(rows)), (output,), tuple(rows))


@pytest.mark.parametrize("seed", range(sample(60, 200, 1000)))
def test_quantiles_are_those_of_the_whole_ordered_sample(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 60))
    weights = rng.dirichlet(np.ones(4)) if seed % 3 else np.array([1.0, 1.0, 1.0, 0.0]) / 3
    kinds = list(rng.choice(["number", "endless", "fails", "open"], n, p=weights))
    numbers = rng.normal(size=n)
    end = rng.choice(["low", "high"])
    output = Output("o", "-", "", lambda _: math.nan, str(end))
    found = made_up(kinds, numbers, output).spread("o")
    assert (found.fails, found.endless, found.unanswered, found.counted) == (
        kinds.count("fails"), kinds.count("endless"), kinds.count("open"), n,
    )  # fmt: skip
    far = {"fails": -1e6 if end == "low" else 2e6, "endless": 1e6}  # an independent ordering: far away, but finite
    for share in (0.0, 0.05, 0.31, 0.5, 0.95, 1.0):
        for got, unknown in zip(found.quantile(share), (-3e6, 3e6), strict=True):
            stand_in = [{"number": x, "open": unknown, **far}[kind] for kind, x in zip(kinds, numbers, strict=True)]
            low, high = (float(np.quantile(stand_in, share, method=m)) for m in ("lower", "higher"))
            if abs(low) < 1e5 and abs(high) < 1e5:
                assert got == pytest.approx(float(np.quantile(stand_in, share)), abs=1e-12)
            else:
                worse = low if end == "low" else high
                assert (got if math.isfinite(got) else math.copysign(2e6, got)) == pytest.approx(
                    worse if abs(worse) < 1e5 else math.copysign(2e6, worse)
                )
    if kinds.count("open") == 0:
        assert found.quantile(0.5)[0] == found.quantile(0.5)[1]


@pytest.mark.parametrize("seed", range(sample(20, 60, 200)))
def test_failures_count_in_probabilities_ranks_and_words(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 20
    kinds = list(rng.choice(["number", "fails", "open"], n))
    numbers = rng.uniform(0.1, 1.0, n)
    multiplier, settlement = KNOWN["load_margin"], KNOWN["max_settlement"]
    less = made_up(kinds, numbers, multiplier)
    share = less.probability("load_margin", below=0.05)  # no number is that small: failures alone are
    assert (share.yes, share.undecided) == (kinds.count("fails"), kinds.count("open"))
    told = less.probability(lambda row: row["load_margin"] < 0.05)
    assert (told.yes, told.undecided) == (share.yes, share.undecided)
    assert less.probability(lambda row: row["x"] >= 0).yes == n, "an event that does not look at it is known"
    more = made_up(kinds, numbers, settlement)
    assert more.probability("max_settlement", above=2.0).yes == kinds.count("fails")
    for found, output in ((less, multiplier), (more, settlement)):
        words = output_words(found, output)
        if kinds.count("open"):
            assert "no answer" in words
            assert found.verdict.outcome is Outcome.INCOMPLETE
        if kinds.count("fails") > 0 and kinds.count("number"):
            assert f"{kinds.count('fails')} of 20 do not stand" in words
    ranked = less.sensitivity("load_margin")
    assert ranked.left_out == kinds.count("open")


def test_an_output_without_an_order_is_told_of_the_runs_that_stand() -> None:
    output = Output("reaction.floor.y", "kN", "", lambda _: math.nan)
    found = made_up(["number", "fails", "number", "fails"], np.array([1.0, 2.0, 3.0, 4.0]), output)
    spread = found.spread(output.name)
    assert (spread.counted, spread.fails, spread.unanswered) == (2, 2, 0)
    assert spread.quantile(0.5) == (2.0, 2.0)
    assert output_words(found, output).startswith("of the 2 runs that stand: median 2 kN")
    assert found.verdict.outcome is Outcome.HOLDS


def test_settlements_of_zero_are_no_probability() -> None:
    found = made_up(["number"] * 5, np.zeros(5), KNOWN["max_settlement"])
    assert "probability" not in output_words(found, KNOWN["max_settlement"])
    assert "probability" in output_words(made_up(["number"] * 5, np.zeros(5), KNOWN["stands"]), KNOWN["stands"])


def test_empty_and_single() -> None:
    assert math.isnan(Spread(np.array([])).quantile(0.5)[0])
    assert Spread(np.array([math.inf])).quantile(0.5) == (math.inf, math.inf)


@pytest.mark.long
def test_half_of_the_pillars_cannot_carry_their_wind() -> None:
    """Multiplier 0.25 - H / 6.4 of the weight; from H = 1.6 on nothing is left to multiply."""
    found = pillar(["associated_multiplier", "load_margin"], 16)
    H = found.values("H")
    assert (found.spread("associated_multiplier").fails, found.spread("load_margin").fails) == (8, 8)
    assert found.placed("associated_multiplier") == pytest.approx(np.where(H > 1.6, -np.inf, 0.25 - H / 6.4), rel=1e-6)
    assert found.spread("associated_multiplier").quantile(0.5) == (-math.inf, -math.inf)
    words = output_words(found, KNOWN["associated_multiplier"])
    assert "median not standing" in words
    assert "8 of 16 do not stand" in words
    assert any("upper bound" in line for line in found.verdict.limits)
    assert found.verdict.exit_code == 0


@pytest.mark.long
def test_what_multiplies_and_what_acts_is_told_and_chosen() -> None:
    both = pillar(["stands", "friction_factor", "load_margin"])
    assert both.values("stands").max() == 0.0
    told = "'live' acts with factor 1 in stands, friction_factor, and is multiplied"
    assert any(told in line for line in both.verdict.attention)
    without = pillar(["stands", "friction_factor", "load_margin"], factors={"live": 0.0})
    stands = without.values("stands")
    assert stands.tolist() == (without.values("H") < 1.6).tolist()
    assert np.isfinite(without.values("friction_factor")).tolist() == stands.astype(bool).tolist()
    assert ((without.placed("load_margin") > 0) == (stands == 1)).all()
    roles = {a.group: (a.role, a.factor) for a in without.verdict.question.acting}
    assert roles == {"dead": ("constant", 1.0), "wind": ("constant", 1.0), "live": ("not applied", 0.0)}


def test_factors_of_other_groups_count_in_multipliers_too() -> None:
    found = pillar("associated_multiplier", factors={"wind": 0.5})
    assert found.values("associated_multiplier") == pytest.approx(0.25 - found.values("H") / 12.8, rel=1e-6)


@pytest.mark.long  # the live group is asked for below
def test_friction_is_asked_without_a_live_group(tmp_path: Path) -> None:
    path = tmp_path / "arch.toml"
    table = '[study]\nsize = 6\noutputs = ["stands", "friction_factor"]\n[[study.variables]]\nname = "t"\n'
    path.write_text(
        '[arch]\nspan = 1.89\nring = 0.11\nvoussoirs = 8\nblock = { kind = "rigid", unit_weight = 20 }\n'
        + table
        + 'keys = "arch.ring"\nlow = 0.09\nhigh = 0.13\n'
    )
    code, out, _ = run("study", path, "--out", tmp_path / "s", "--no-figures", "--json")
    told = json.loads(out)
    assert (code, told["status"], told["verdict"]["outcome"]) == (0, "done", "holds")
    assert set(told["verdicts"]) == {"solved", "no_equilibrium"}, "collapses that are shown are not missing answers"
    again = concio.load_study(tmp_path / "s")
    assert again.verdict == concio.study(path).verdict
    assert again.spread("friction_factor").endless == told["verdicts"]["no_equilibrium"]


def failing(analyses: Any) -> float:
    """Raise of wind from the left half of its range."""
    if analyses.model.loads[1].value[0] < 1.6:
        msg = "no"
        raise ZeroDivisionError(msg)
    return 1.0


def test_one_output_that_fails_takes_nothing_from_the_others() -> None:
    outputs = ["stands", Output("mine", "-", "", failing), "load_margin"]
    found = pillar(outputs, factors={"live": 0.0})
    assert not np.isnan(found.values("stands")).any()
    low = found.values("H") < 1.6
    assert np.isnan(found.values("mine")).tolist() == low.tolist()
    assert [row.verdict == "solved" for row in found.rows] == low.tolist()
    assert len(found.failures) == low.sum()
    assert "ZeroDivisionError: no" in found.failures[0].message
    assert found.verdict.outcome is Outcome.INCOMPLETE
    assert f"mine in {low.sum()} of 6 runs: raised: ZeroDivisionError: no" in found.verdict.unchecked


def test_a_row_survives_being_stored() -> None:
    row = Row(3, "solved", "x", {"a": math.nan, "b": math.inf}, 0.5, ("a",), {"b": "raised: x"},
              {"dead": {"what": "self-weight", "force": [0.0, -1.0], "size": 1.0}}, ("odd",))  # fmt: skip
    again = Row.from_dict(json.loads(json.dumps(row.as_dict())))
    assert repr(again) == repr(row)


@pytest.mark.parametrize(
    "given", [np.array([[1.0, -0.6], [-0.6, 1.0]]), [[1.0, -0.6], [-0.6, 1.0]], {("a", "b"): -0.6}]
)
def test_a_correlation_may_be_a_matrix(given: Any) -> None:
    variables = [concio.variable("a", low=0, high=1), concio.variable("b", low=0, high=1)]
    made = draw(variables, "monte-carlo", 200, correlation=given)
    assert made.numbers.tolist() == draw(variables, "monte-carlo", 200, correlation={("b", "a"): -0.6}).numbers.tolist()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (np.eye(3), "has the shape (2, 2), not (3, 3)"),
        ([[1.0, 0.5], [0.4, 1.0]], "symmetric"),
        ([[2.0, 0.5], [0.5, 1.0]], "ones on its diagonal"),
        ([[1.0, math.nan], [math.nan, 1.0]], "finite"),
        ("mu", "is not a mapping of pairs"),
        ({"mu": 0.5}, "is not a pair"),
        ([[1.0, 1.5], [1.5, 1.0]], "must lie between"),
    ],
)
def test_a_correlation_that_is_none_is_told(given: Any, said: str) -> None:
    variables = [concio.variable("a", low=0, high=1), concio.variable("b", low=0, high=1)]
    with pytest.raises(concio.InputError) as caught:
        concio.study(lambda row: row, variables, "a", "monte-carlo", size=4, correlation=given)
    assert said in str(caught.value)


@pytest.mark.parametrize("name", ["table.csv", "report.html", "sample.csv"])
def test_a_study_replaces_nothing_of_the_user(name: str, tmp_path: Path) -> None:
    path, out = tmp_path / "p.toml", tmp_path / "s"
    text = '[study]\nsize = 2\noutputs = ["associated_multiplier"]\n[[study.variables]]\nname = "H"\n'
    path.write_text(PILLAR + text + 'keys = "loads[2].value[1]"\nlow = 0.0\nhigh = 1.0\n')
    out.mkdir()
    (out / name).write_text("mine")
    code, _, err = run("study", path, "--out", out, "--no-figures")
    assert (code, (out / name).read_text()) == (2, "mine")
    assert name in err
    (out / name).unlink()
    assert run("study", path, "--out", out, "--no-figures")[0] == 0
    (out / "sample.csv").unlink()  # as if killed before it was written
    assert run("study", path, "--out", out, "--no-figures", "--resume")[0] == 0, "its own files are replaced"
    assert len(concio.load_study(out)) == 2
    (out / "table.csv").write_text("with my notes")
    assert run("study", path, "--out", out, "--no-figures", "--resume")[0] == 2
    assert (out / "table.csv").read_text() == "with my notes"
