"""First-order reliability beside closed forms and beside samples."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.special import ndtr

import concio
from concio.errors import InputError, SolverError
from concio.studies.distributions import Distribution
from concio.studies.reliability import multiplier_over
from samples import sample

SIZES = st.floats(0.2, 5.0)


@settings(max_examples=sample(30, 100), deadline=None)
@given(st.lists(SIZES, min_size=2, max_size=5), st.lists(SIZES, min_size=5, max_size=5), st.floats(-6.0, 9.0))
@example([1.0, 1.0, 1.0], [0.2, 0.5, 0.2, 1.0, 1.0], 0.2)  # 0 at the means but for rounding: no design point was found
def test_a_linear_limit_state_of_normal_variables_is_exact(sds: list[float], factors: list[float], c: float) -> None:
    variables = [concio.variable(f"x{k}", "normal", mean=1.0 + k, sd=sd) for k, sd in enumerate(sds)]
    a = np.array(factors[: len(sds)]) * (-1.0) ** np.arange(len(sds))
    means = 1.0 + np.arange(len(sds))
    found = concio.reliability(lambda x: c + sum(f * x[f"x{k}"] for k, f in enumerate(a)), variables)
    spread = float(np.linalg.norm(a * sds))
    assert found.beta == pytest.approx((c + a @ means) / spread, abs=1e-7)
    assert found.probability == pytest.approx(float(ndtr(-(c + a @ means) / spread)), rel=1e-5)
    shares = (a * sds) ** 2 / spread**2
    assert list(found.importance.values()) == pytest.approx(shares, abs=1e-8)
    point = means - found.beta * a * np.array(sds) ** 2 / spread
    assert list(found.point.values()) == pytest.approx(point, abs=1e-6)


@pytest.mark.long
@settings(max_examples=sample(20, 40, 100), deadline=None)
@given(st.floats(0.05, 0.6), st.floats(0.05, 0.6), st.floats(0.3, 8.0))
def test_resistance_over_load_both_lognormal_is_exact(of_r: float, of_s: float, ratio: float) -> None:
    r = concio.variable("r", "lognormal", median=ratio, beta=of_r)
    s = concio.variable("s", "lognormal", median=1.0, beta=of_s)
    wanted = math.log(ratio) / math.hypot(of_r, of_s)
    for state in (lambda x: x["r"] - x["s"], lambda x: (x["r"] - x["s"], {"r": 1.0, "s": -1.0})):
        assert concio.reliability(state, [r, s]).beta == pytest.approx(wanted, abs=1e-6)


@pytest.mark.long
def test_a_curved_limit_state_on_which_whole_steps_go_to_and_fro() -> None:
    """a^3 + b^3 = 18: the distance of the curve from the means in standard deviations, sampled, is the index."""
    variables = [concio.variable("a", "normal", mean=10.0, sd=5.0), concio.variable("b", "normal", mean=9.9, sd=5.0)]
    found, *others = (
        concio.reliability(lambda x, unit=unit: unit * (x["a"] ** 3 + x["b"] ** 3 - 18.0), variables)
        for unit in (1.0, 2.0**-30, 2.0**30)
    )
    assert {(other.beta, other.evaluations) for other in others} == {(found.beta, found.evaluations)}
    a = np.linspace(-5.0, 5.0, 200_001)
    away = np.hypot((a - 10.0) / 5.0, (np.cbrt(18.0 - a**3) - 9.9) / 5.0)
    assert found.beta == pytest.approx(float(away.min()), abs=1e-8)
    assert found.point["a"] == pytest.approx(float(a[away.argmin()]), abs=1e-3)


def slender(x: dict[str, float]) -> concio.Model:
    return concio.column(width=x["b"], height=x["h"], blocks=1, block="rigid", unit_weight=20.0, horizontal=1.0)


@pytest.mark.long
@pytest.mark.parametrize("required", [0.12, 0.15, 0.3])
def test_a_pillar_tips_at_width_over_height_with_derivatives_by_duality(required: float) -> None:
    variables = [concio.variable("b", "lognormal", median=0.5, beta=0.1),
                 concio.variable("h", "lognormal", median=2.0, beta=0.15)]  # fmt: skip
    found = concio.reliability(multiplier_over(slender, required), variables)
    assert found.beta == pytest.approx(math.log(0.25 / required) / math.hypot(0.1, 0.15), abs=1e-8)
    assert found.importance["h"] == pytest.approx(0.15**2 / (0.1**2 + 0.15**2), abs=1e-8)
    assert found.point["b"] / found.point["h"] == pytest.approx(required, rel=1e-8)


def test_the_probability_is_that_of_a_sample_where_the_limit_state_is_plane() -> None:
    b = concio.variable("b", "normal", mean=0.5, sd=0.05)
    found = concio.reliability(lambda x: x["b"] / 2.0 - 0.22, [b])
    u = (np.arange(20_000) + 0.5) / 20_000
    share = float((b.quantile(u) / 2.0 < 0.22).mean())
    assert found.probability == pytest.approx(share, abs=1e-4)


@pytest.mark.long
@pytest.mark.parametrize("radius", [0.05, 0.005])
def test_the_nearest_point_of_a_sharp_surface(radius: float) -> None:
    """A needle that fails: the steps of Hasofer and Lind go back and forth beside it, the programmes end at it."""
    x, y = (concio.variable(name, "normal", mean=0.0, sd=1.0) for name in "xy")
    found = concio.reliability(lambda v: (v["x"] - 4.0) ** 2 + (v["y"] - 1.2) ** 2 - radius**2, [x, y])
    away = math.hypot(4.0, 1.2)
    assert found.beta == pytest.approx(away - radius, rel=1e-9)
    assert found.point == pytest.approx({"x": 4.0 * (1 - radius / away), "y": 1.2 * (1 - radius / away)}, abs=1e-6)


def test_a_curved_limit_state_has_the_nearest_point() -> None:
    variables = [concio.variable(name, "normal", mean=0.0, sd=1.0) for name in "xy"]
    found = concio.reliability(lambda v: 9.0 - (v["x"] + 1.0) ** 2 - 4.0 * (v["y"] + 0.3) ** 2, variables)
    angles = np.linspace(0.0, 2 * np.pi, 200_001)
    nearest = np.hypot(3.0 * np.cos(angles) - 1.0, 1.5 * np.sin(angles) - 0.3).min()
    assert found.beta == pytest.approx(nearest, abs=1e-7)


def test_a_structure_that_fails_at_the_medians_has_a_negative_index() -> None:
    x = concio.variable("x", "normal", mean=1.0, sd=0.5)
    found = concio.reliability(lambda v: v["x"] - 2.0, [x])
    assert found.beta == pytest.approx(-2.0, abs=1e-9)
    assert found.probability == pytest.approx(float(ndtr(2.0)))
    assert found.direction["x"] == pytest.approx(1.0)


@settings(max_examples=sample(30, 100), deadline=None)
@given(st.floats(-7.0, 7.0))
def test_standard_numbers_stand_for_values_in_both_tails(u: float) -> None:
    for made in (Distribution("normal", {"mean": 3.0, "sd": 2.0}), Distribution("gumbel", {"mean": 3.0, "sd": 2.0}),
                 Distribution("normal", {"mean": 0.0, "sd": 1.0, "low": -1.0, "high": 2.0})):  # fmt: skip
        value, rate = made.standard(u)
        h = 1e-4
        assert rate == pytest.approx((made.standard(u + h)[0] - made.standard(u - h)[0]) / (2 * h), rel=1e-5, abs=1e-9)
        if abs(u) < 4:
            assert value == pytest.approx(float(made.quantile(np.array([ndtr(u)]))[0]), rel=1e-9)
    assert Distribution("normal", {"mean": 3.0, "sd": 2.0}).standard(u)[0] == pytest.approx(3.0 + 2.0 * u, abs=1e-9)


def test_what_is_no_question_of_first_order_is_refused() -> None:
    kind = concio.variable("bond", "choice", values=("running", "english"))
    with pytest.raises(InputError, match="takes continuous ones"):
        concio.reliability(lambda _: 1.0, [kind])
    x = concio.variable("x", "normal", mean=1.0, sd=0.5)
    with pytest.raises(InputError, match="does not depend on any"):
        concio.reliability(lambda _: 1.0, [x])
    with pytest.raises(InputError, match="no variables"):
        concio.reliability(lambda _: 1.0, [])
    with pytest.raises(SolverError, match="no design point"):
        concio.reliability(lambda v: 1.0 + v["x"] ** 2 + v["x"], [x], most=20)
