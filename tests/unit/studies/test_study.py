"""Studies: samples, rows, what is asked of them, and messages."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.model.file.keys import find_key, with_values
from concio.studies.analyses import at_factors
from concio.studies.bridges import openturns_sample, salib_problem, sample_of_openturns, variables_of_salib
from concio.studies.distributions import FAMILIES, Distribution
from concio.studies.sampling import draw
from concio.studies.statistics import fragility, probability
from concio.studies.variables import variable
from samples import sample
from study_functions import VARIABLES, block, formula, milankovitch, seeded

ARCH = """
[arch]
span = 1.89
ring = "0.11 m"
voussoirs = 12
block = { kind = "rigid", unit_weight = "20 kN/m3" }
friction = 0.8
[[loads]]
kind = "weight"
value = [0.01, 0]
group = "live"
"""


@pytest.mark.parametrize("design", ["monte-carlo", "latin-hypercube", "sobol"])
def test_minimum_of_two_uniforms(design: str) -> None:
    """mu in (.3, .7), s in (.2, .6): P(min < .4) = 0.625, mean 0.371875, variance 0.009729818."""
    n = 1024
    found = concio.study(formula, VARIABLES, "multiplier", design, size=n, seed=3)
    values = found.values("multiplier")
    sd = math.sqrt(0.009729818)
    assert values.mean() == pytest.approx(0.371875, abs=4 * sd / math.sqrt(n))
    assert values.var() == pytest.approx(0.009729818, rel=0.1)
    share = found.probability("multiplier", below=0.4)
    assert share.estimate == pytest.approx(0.625, abs=4 * math.sqrt(0.625 * 0.375 / n))
    assert share.low < share.estimate < share.high


@pytest.mark.long
def test_sobol_indices_of_the_minimum() -> None:
    """First 0.113817 (mu), 0.761526 (s); total 0.238474, 0.886183."""
    found = concio.study(formula, VARIABLES, "multiplier", "saltelli", size=512).sensitivity("multiplier")
    assert found.kind == "Sobol"
    assert found.first == pytest.approx([0.113817, 0.761526], abs=0.015)
    assert found.total == pytest.approx([0.238474, 0.886183], abs=0.015)


def test_models_of_a_function_say_the_same_as_the_formula() -> None:
    found = concio.study(block, VARIABLES, "associated_multiplier", "sobol", size=16)
    assert found.values("associated_multiplier") == pytest.approx(
        np.minimum(found.values("mu"), found.values("s")), rel=1e-9
    )


@pytest.mark.long  # the minimum of two uniforms
def test_chance_that_a_semicircular_arch_stands() -> None:
    """It stands from t/R = 0.1075 (Milankovitch): t in (.10, .12) gives 0.626; a Latin hypercube misses by 1/n."""
    n = sample(16, 32)
    thickness = concio.variable("t", low=0.10, high=0.12)
    found = concio.study(milankovitch, (thickness,), "stands", "latin-hypercube", size=n, seed=1)
    share = found.probability("stands", above=0.5)
    assert share.estimate == pytest.approx(0.626, abs=1 / n)
    stands = found.values("stands") == 1
    assert found.values("t")[stands].min() > found.values("t")[~stands].max()


def test_rank_correlation_is_that_asked_for() -> None:
    from scipy.stats import spearmanr

    made = draw(VARIABLES, "monte-carlo", 4000, correlation={("mu", "s"): -0.6})
    assert spearmanr(made.numbers).statistic == pytest.approx(-0.6, abs=0.05)
    assert made.column("mu").min() >= 0.3
    assert np.quantile(made.column("mu"), 0.25) == pytest.approx(0.4, abs=0.02)  # the marginals stay


@pytest.mark.parametrize(
    ("kind", "parameters", "mean", "sd"),
    [
        ("uniform", {"low": 1.0, "high": 4.0}, 2.5, 3 / math.sqrt(12)),
        ("normal", {"mean": 0.6, "sd": 0.06}, 0.6, 0.06),
        ("normal", {"mean": 0.6, "cov": 0.1}, 0.6, 0.06),
        ("lognormal", {"mean": 2.0, "sd": 0.5}, 2.0, 0.5),
        (
            "lognormal",
            {"median": 2.0, "beta": 0.4},
            2 * math.exp(0.08),
            2 * math.exp(0.08) * math.sqrt(math.expm1(0.16)),
        ),
        ("triangular", {"low": 0.0, "mode": 1.0, "high": 4.0}, 5 / 3, math.sqrt((16 + 1 - 4) / 18)),
        ("triangular", {"low": 1.0, "mode": 2.0, "high": 5.0}, 8 / 3, math.sqrt((16 + 1 - 4) / 18)),
        ("beta", {"low": 2.0, "high": 6.0, "alpha": 2.0, "beta": 6.0}, 3.0, 4 * math.sqrt(12 / (64 * 9))),
        ("gumbel", {"mean": 10.0, "sd": 2.0}, 10.0, 2.0),
        ("weibull", {"shape": 1.0, "scale": 3.0}, 3.0, 3.0),
    ],
)
def test_distributions_have_the_moments_they_name(
    kind: str, parameters: dict[str, float], mean: float, sd: float
) -> None:
    values = Distribution(kind, parameters).quantile((np.arange(400_000) + 0.5) / 400_000)
    assert values.mean() == pytest.approx(mean, rel=2e-3)
    assert values.std() == pytest.approx(sd, rel=2e-2)


def test_every_family_was_tried() -> None:
    assert set(FAMILIES) == {"uniform", "normal", "lognormal", "triangular", "beta", "gumbel", "weibull"}


def test_a_cut_distribution_stays_within_its_cuts() -> None:
    values = Distribution("normal", {"mean": 0.6, "sd": 0.2, "low": 0.5, "high": 0.65}).quantile(np.linspace(0, 1, 101))
    assert values.min() == pytest.approx(0.5)
    assert values.max() == pytest.approx(0.65)
    assert (np.diff(values) > 0).all()


def test_grid_takes_every_combination() -> None:
    variables = [variable("a", low=0.0, high=1.0, levels=3), variable("bond", "choice", values=("running", "english"))]
    made = draw(variables, "grid")
    rows = [tuple(made.row(i).values()) for i in range(len(made))]
    assert rows == [(a, b) for a in (0.0, 0.5, 1.0) for b in ("running", "english")]


def test_runs_have_seeds_of_their_own_that_the_size_does_not_change() -> None:
    few = concio.study(seeded, [variable("a", low=0, high=1)], "drawn", "monte-carlo", size=5, seed=7)
    many = concio.study(seeded, [variable("a", low=0, high=1)], "drawn", "monte-carlo", size=50, seed=7)
    assert few.values("drawn").tolist() == many.values("drawn")[:5].tolist()
    assert len(set(many.values("drawn"))) > 40


@pytest.mark.long
def test_keys_of_a_model_file_take_the_values(tmp_path: Path) -> None:
    path = tmp_path / "arch.toml"
    path.write_text(ARCH)
    variables = [
        variable("ring", keys="arch.ring", unit="m", low=0.10, high=0.12),
        variable("push", keys="loads[1].value[1]", low=0.001, high=0.02),
    ]
    found = concio.study(path, variables, ["stands", "friction_factor"], "monte-carlo", size=12, seed=1)
    ring = found.values("ring")
    # least thickness of the arch with 12 voussoirs of this span, pushed a little: thin rings fall, thick ones stand
    stands = found.values("stands")
    assert 0 < stands.sum() < 12
    assert ring[stands == 1].mean() > ring[stands == 0].mean()
    text = found.model_text(3)
    again = concio.loads(text)
    assert again.loads[-1].value[0] == found.values("push")[3]
    assert concio.solve(again, on_failure="return").solved == bool(stands[3])


def test_a_table_in_the_file_is_the_study(tmp_path: Path) -> None:
    path = tmp_path / "arch.toml"
    path.write_text(
        ARCH
        + """
[study]
sample = "latin-hypercube"
size = 6
seed = 4
outputs = "stands"
correlation = [{ between = ["ring", "mu"], rank = 0.5 }]
[[study.variables]]
name = "ring"
keys = "arch.ring"
unit = "cm"
low = 10
high = 12
[[study.variables]]
name = "mu"
keys = "arch.friction"
distribution = "normal"
mean = 0.7
sd = 0.05
"""
    )
    found = concio.study(path)
    assert len(found) == 6
    assert found.values("ring").min() >= 10
    assert set(found.verdicts) <= {"solved", "no_equilibrium", "collapses"}
    assert concio.load(path).title == concio.loads(ARCH).title  # the study says nothing of the structure


@pytest.mark.parametrize(
    ("path", "said", "hint"),
    [
        ("arch.fricton", "no key 'fricton'", "did you mean 'friction'"),
        ("arhc.friction", "no key 'arhc'", "did you mean 'arch'"),
        ("arch.block", "is a table", "kind"),
        ("loads[3].value", "no entry [3] among 1", "from 1 to 1"),
        ("loads.value", "no keys below a list", "brackets"),
        ("arch[1]", "there is no list", "brackets"),
        ("arch..friction", "is not a path", "write for example"),
        ("", "is not a path", "write for example"),
    ],
)
def test_wrong_paths_are_told(path: str, said: str, hint: str) -> None:
    import tomllib

    with pytest.raises(concio.InputError) as caught:
        find_key(tomllib.loads(ARCH), path)
    assert said in caught.value.what
    assert hint in (caught.value.hint or "")


def test_a_key_the_file_does_not_state_is_made() -> None:
    data = {"arch": {"span": 2.0}}
    place = find_key(data, "arch.block.E")
    assert with_values(data, {place: 5.0}) == {"arch": {"span": 2.0, "block": {"E": 5.0}}}
    assert data == {"arch": {"span": 2.0}}


def test_names_with_points_stand_in_quotation_marks() -> None:
    data = {"materials": {"old.stone": {"E": 1.0}}, "blocks": [{"name": "b1"}, {"name": "b2", "thickness": 0.3}]}
    assert find_key(data, 'materials."old.stone".E').get(data) == 1.0
    assert find_key(data, "blocks[b2].thickness").get(data) == 0.3


def test_bad_values_are_rows_and_not_the_end(tmp_path: Path) -> None:
    path = tmp_path / "arch.toml"
    path.write_text(ARCH)
    found = concio.study(path, [variable("mu", "choice", keys="arch.friction", values=(0.8, -1.0))], "stands", "grid")
    assert [row.verdict for row in found.rows][1] == "bad_input"
    assert "friction" in found.rows[1].message
    assert np.isnan(found.values("stands")[1])
    assert len(found.failures) == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"variables": []}, "needs variables"),
        ({"outputs": []}, "needs outputs"),
        ({"outputs": ["standz"]}, "there is no output 'standz'"),
        ({"sample": "sobel"}, "there is no sample 'sobel'"),
        ({"sample": "sobol", "size": 100}, "powers of two"),
        ({"size": 0}, "size = 0"),
        ({"seed": -1}, "seed = -1"),
        ({"executor": "slurm"}, "there is no executor 'slurm'"),
        ({"workers": 0}, "workers = 0"),
        ({"time_limit": -1.0}, "time_limit"),
        ({"resume": True}, "nothing to resume"),
        ({"correlation": {("mu", "nu"): 0.5}}, "no variable 'nu'"),
        ({"correlation": {("mu", "span"): 1.5}}, "must lie between"),
        ({"sample": np.ones((3, 1))}, "has as many columns"),
        ({"stop": concio.Stop("standing", 0.1)}, "not an output of the study"),
    ],
)
def test_what_does_not_fit_is_told(arguments: dict[str, object], said: str) -> None:
    import tomllib

    variables = [
        variable("mu", low=0.3, high=0.7, keys="arch.friction"),
        variable("span", low=1.0, high=2.0, keys="arch.span"),
    ]
    given: dict[str, object] = {"variables": variables, "outputs": "stands", **arguments}
    with pytest.raises(concio.InputError, match=re.escape(said)):
        concio.study(tomllib.loads(ARCH), **given)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"distribution": "gauss"}, "no distribution 'gauss'"),
        ({"low": 1.0}, "takes low and high"),
        ({"low": 1.0, "high": 1.0}, "must be less than"),
        ({"distribution": "normal", "mean": 1.0, "sd": 0.0}, "must be positive"),
        ({"distribution": "normal", "mean": 1.0, "sd": 0.1, "low": 9.0, "high": 10.0}, "nothing of the normal"),
        ({"distribution": "choice"}, "needs values"),
        ({"distribution": "choice", "values": (1, 2), "weights": (1,)}, "as many weights"),
        ({"distribution": "seed", "low": 0.0}, "takes no low"),
        ({"low": 0.0, "high": float("nan")}, "not a finite number"),
    ],
)
def test_variables_that_do_not_fit_are_told(arguments: dict[str, object], said: str) -> None:
    with pytest.raises(concio.InputError, match=said):
        variable("x", **arguments)


def test_a_unit_in_the_file_asks_for_a_unit_of_the_variable(tmp_path: Path) -> None:
    path = tmp_path / "arch.toml"
    path.write_text(ARCH)
    with pytest.raises(concio.InputError, match="with a unit"):
        concio.study(path, [variable("ring", low=0.1, high=0.2, keys="arch.ring")], "stands", size=2)


def test_two_variables_must_not_set_one_key() -> None:
    import tomllib

    both = [variable(name, low=0.1, high=0.2, keys="arch.friction") for name in ("a", "b")]
    with pytest.raises(concio.InputError, match=r"both set arch\.friction"):
        concio.study(tomllib.loads(ARCH), both, "stands", size=2)


def test_probability_counts_what_is_not_known_against_both_ends() -> None:
    event = np.array([1.0] * 30 + [0.0] * 60 + [math.nan] * 10)
    found = probability(event)
    assert found.estimate == pytest.approx(1 / 3)
    assert found.low < probability(np.array([1.0] * 30 + [0.0] * 70)).low + 1e-12
    assert found.high > probability(np.array([1.0] * 40 + [0.0] * 60)).high - 1e-12


def test_interval_of_a_probability_is_that_of_clopper_and_pearson() -> None:
    found = probability(np.array([1.0] * 8 + [0.0] * 2))  # published: 0.4439 to 0.9748
    assert (found.low, found.high) == pytest.approx((0.4439, 0.9748), abs=5e-5)
    assert probability(np.zeros(10)).high == pytest.approx(0.3085, abs=5e-5)


def test_intervals_cover_what_they_say() -> None:
    rng = np.random.default_rng(5)
    covered = sum(
        p.low <= 0.3 <= p.high for p in (probability((rng.random(40) < 0.3).astype(float)) for _ in range(400))
    )
    assert covered >= 375  # at least 95 per cent, less chance


def test_fragility_curve_is_found_again() -> None:
    from scipy.stats import norm

    rng = np.random.default_rng(2)
    x = rng.uniform(0.05, 1.0, 4000)
    failed = (rng.random(4000) < norm.cdf(np.log(x / 0.35) / 0.4)).astype(float)
    curve = fragility(x, failed)
    assert curve.median == pytest.approx(0.35, rel=0.05)
    assert curve.beta == pytest.approx(0.4, rel=0.1)
    low, high = curve.band(np.array([0.2, 0.35, 0.6]))
    true = norm.cdf(np.log(np.array([0.2, 0.35, 0.6]) / 0.35) / 0.4)
    assert ((low < true) & (true < high)).all()
    assert high[1] - low[1] < 0.08


@pytest.mark.parametrize("unit", [1e-3, 1.0, 981.0])
def test_a_fragility_curve_and_its_band_do_not_depend_on_the_unit_of_the_intensity(unit: float) -> None:
    """The covariance is the inverse of the information of the probit line, by differences of its log-likelihood."""
    from scipy.stats import norm

    x = np.array([0.1, 0.15, 0.2, 0.3, 0.35, 0.4, 0.5, 0.6, 0.8, 1.2])
    failed = np.array([0, 0, 1, 0, 0, 1, 0, 1, 1, 1], dtype=float)
    at = np.array([0.2, 0.4, 0.9])
    one, other = fragility(x, failed), fragility(unit * x, failed)
    assert other.median == pytest.approx(unit * one.median, rel=1e-5)
    assert other.beta == pytest.approx(one.beta, rel=1e-5)
    for mine, its in zip(one.band(at, 0.9), other.band(unit * at, 0.9), strict=True):
        assert mine == pytest.approx(its, rel=1e-4)
    line, logs = np.array([-math.log(other.median), 1.0]) / other.beta, np.log(unit * x)

    def expected(p: np.ndarray) -> float:  # of the log-likelihood, by the probabilities of the fit
        share = norm.cdf(line[0] + line[1] * logs)
        return float(-(share * norm.logcdf(p[0] + p[1] * logs) + (1 - share) * norm.logsf(p[0] + p[1] * logs)).sum())

    h, e = 1e-3, np.eye(2)
    information = np.array([
        [(expected(line + h * (e[i] + e[j])) - expected(line + h * (e[i] - e[j])) - expected(line - h * (e[i] - e[j]))
          + expected(line - h * (e[i] + e[j]))) / (4 * h * h) for j in range(2)] for i in range(2)
    ])  # fmt: skip
    assert other.covariance @ information == pytest.approx(np.eye(2), abs=2e-3)
    low, high = other.band(unit * at, 0.9)
    g = np.column_stack([np.ones(3), np.log(unit * at)])
    error = np.sqrt(np.einsum("ij,jk,ik->i", g, np.linalg.inv(information), g))
    assert norm.ppf(high) - norm.ppf(low) == pytest.approx(2 * 1.6448536 * error, rel=5e-3)


def test_levels_of_a_grid_without_bounds_have_equal_probability() -> None:
    levels = variable("b", "normal", mean=1.0, sd=0.2, levels=4).grid()
    assert levels == pytest.approx(1.0 + 0.2 * np.array([-1.1503494, -0.3186394, 0.3186394, 1.1503494]), rel=1e-6)


@pytest.mark.parametrize(
    ("failed", "said"),
    [([0, 0, 0, 0], "none of 4"), ([1, 1, 1, 1], "all of 4"), ([0, 0, 1, 1], "none below"), ([1, 1, 0, 0], "below an")],
)
def test_fragility_without_a_curve_is_told(failed: list[float], said: str) -> None:
    with pytest.raises(concio.InputError, match=said):
        fragility(np.array([0.1, 0.2, 0.3, 0.4]), np.array(failed, dtype=float))


def test_one_at_a_time_takes_the_middle_and_each_end_alone() -> None:
    """A twentieth and nineteen twentieths of each, the others at their medians."""
    variables = (variable("a", low=2.0, high=4.0), variable("b", "lognormal", median=3.0, beta=0.5))
    end = np.exp(0.5 * 1.6448536269514722)
    wanted = [[3.0, 3.0], [2.1, 3.0], [3.9, 3.0], [3.0, 3.0 / end], [3.0, 3.0 * end]]
    assert draw(variables, "one-at-a-time").numbers == pytest.approx(np.array(wanted), rel=1e-12)


def test_problems_of_salib_go_both_ways() -> None:
    variables = (
        variable("a", low=0.3, high=0.7),
        variable("b", "normal", mean=1.0, sd=0.2),
        variable("c", "normal", mean=1.0, cov=0.2, low=0.5, high=1.5),
        variable("d", "lognormal", mean=2.0, sd=0.5),
        variable("e", "triangular", low=0.0, mode=1.0, high=4.0),
    )
    back = variables_of_salib(salib_problem(variables))
    u = np.linspace(0.01, 0.99, 9)
    for one, other in zip(variables, back, strict=True):
        assert one.name == other.name
        assert one.quantile(u) == pytest.approx(other.quantile(u), rel=1e-12)
    for cut in ({"low": 0.5}, {"high": 1.5}):
        with pytest.raises(concio.InputError, match="no distribution like"):
            salib_problem([variable("f", "normal", mean=1.0, sd=0.2, **cut)])
        with pytest.raises(concio.InputError, match="no distribution like"):
            salib_problem([variable("f", "lognormal", mean=1.0, sd=0.2, **cut)])
    from SALib.sample import latin

    problem = {"num_vars": 2, "names": ["mu", "s"], "bounds": [[0.3, 0.7], [0.2, 0.6]]}
    table = latin.sample(problem, 32, seed=1)
    found = concio.study(formula, problem, "multiplier", table)
    assert found.values("multiplier").tolist() == table.min(axis=1).tolist()
    with pytest.raises(concio.InputError, match="no distribution 'logunif'"):
        variables_of_salib({**problem, "dists": ["unif", "logunif"]})


@pytest.mark.long
def test_samples_of_openturns_go_both_ways() -> None:
    ot = pytest.importorskip("openturns")
    made = draw(VARIABLES, "monte-carlo", 20)
    there = openturns_sample(made)
    assert list(there.getDescription()) == ["mu", "s"]
    assert np.array(there).tolist() == made.numbers.tolist()
    turned = ot.Sample(np.array(there)[:, ::-1].tolist())
    turned.setDescription(["s", "mu"])
    assert sample_of_openturns(VARIABLES, turned).numbers.tolist() == made.numbers.tolist()


@pytest.mark.long
def test_stop_at_an_interval_is_the_same_for_every_executor(tmp_path: Path) -> None:
    stop = concio.Stop("multiplier", width=0.2, below=0.4)
    serial = concio.study(formula, VARIABLES, "multiplier", "monte-carlo", size=400, stop=stop)
    assert serial.stopped
    assert len(serial) < 200
    found = serial.probability("multiplier", below=0.4)
    assert found.high - found.low <= 0.2
    less = probability(serial.event("multiplier", below=0.4)[:-1])
    assert less.high - less.low > 0.2
    two = concio.study(formula, VARIABLES, "multiplier", "monte-carlo", size=400, stop=stop, workers=2)
    assert [r.outputs for r in two.rows] == [r.outputs for r in serial.rows]


def test_figures_and_report_of_a_study(tmp_path: Path) -> None:
    from concio.report.study_page import study_html

    found = concio.study(formula, VARIABLES, "multiplier", "monte-carlo", size=40)
    found.plot.scatter("mu", "multiplier")
    bars = found.plot.tornado("multiplier")
    assert [t.get_text() for t in bars.get_yticklabels()][-1] == "s"  # matters most, on top
    page = study_html(found, title="A <b>study</b>")
    assert "<b>study" not in page
    assert "40 runs" in page
    assert found._repr_html_().startswith("<div>")
    assert len(repr(found).splitlines()) <= 12
    assert list(found.frame().columns)[:3] == ["mu", "s", "multiplier"]


def test_a_model_at_factors_has_loads_and_moved_supports_times_those_of_their_groups() -> None:
    """A group that is not named keeps what it has, and supports that only hold stay as they are."""
    column = concio.column(width=0.4, height=1.0, blocks=1, block="rigid", horizontal=0.1)
    held = concio.Support("held", "b1", edge=((-0.2, 1.0), (-0.2, 1.0)), directions="x", group="sinks")
    sinks = concio.Support("sinks", "ground", displacement=(0.0, -0.01), rotation=0.02, group="sinks")
    other = concio.Support("other", "ground", displacement=(0.03, 0.0), group="other")
    model = replace(column, supports=(held, sinks, other))
    found = at_factors(model, {"live": 3.0, "sinks": 2.0})
    for load, was in zip(found.loads, model.loads, strict=True):
        assert load.value == pytest.approx([(3.0 if was.group == "live" else 1.0) * v for v in was.value])
    assert {load.group for load in model.loads} == {"dead", "live"}
    assert found.supports[0] == model.supports[0]
    assert found.supports[1].displacement == pytest.approx((0.0, -0.02))
    assert found.supports[1].rotation == pytest.approx(0.04)
    assert found.supports[2] == model.supports[2]
