"""Exact certificates: multipliers as fractions, and a program of its own that refuses whatever was changed."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from commands import run
from concio import Body, JointLaw, JointRule, Load, Model, Polyhedron, Rigid, Support, Tie
from concio.errors import InputError, SolverError
from concio.proof import verify, verify_equilibrium
from concio.proof.exact_certificate import prove_balance, prove_collapse, prove_limit, sealed
from concio.proof.exact_solve import LongFractionsError, solve_exactly
from concio.proof.statement import fraction_text
from pillars import ARCH, THIN, pillar, sideways, slot
from samples import sample


def box(mu: float, phi: float, size: tuple[float, float, float] = (1.0, 2.0, 3.0)) -> Model:
    """Return a box on a plane, pushed in the direction phi in plan."""
    ground = Polyhedron.box("ground", (-9, -9, -1), (9, 9, 0), kind="fixed")
    loads = (Load("weight", (0, 0, -1)), Load("weight", (np.cos(phi), np.sin(phi), 0), group="live"))
    block = Polyhedron.box("box", (0, 0, 0), size, kind="rigid")
    return Model((ground, block), {"block": Rigid(20.0)}, {"joint": JointLaw(mu)}, loads=loads)


def bounds(made: dict[str, Any]) -> tuple[Fraction, Fraction]:
    return Fraction(made["lower"]), Fraction(made["upper"])


@pytest.mark.parametrize("n", [1, 4, 12])
def test_systems_of_fractions_are_solved_exactly(n: int) -> None:
    """Against elimination in fractions, which shares nothing with the factor."""
    rng = np.random.default_rng(n)
    whole = rng.integers(-9, 10, (n, n)) + 12 * np.eye(n, dtype=int)
    scale = [Fraction(float(v)) for v in 10.0 ** rng.uniform(-30, 30, n)]
    rows = [{j: s * int(v) for j, v in enumerate(row) if v} for row, s in zip(whole, scale, strict=True)]
    right = [Fraction(float(v)) for v in rng.normal(size=n)]
    assert solve_exactly(rows, right) == eliminated(rows, right)


def test_fractions_with_more_digits_than_are_sought_are_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """And of a command by its size first; a step whose signs intervals decide needs none."""
    rng = np.random.default_rng(7)
    rows = [{j: Fraction(float(v)) for j, v in enumerate(row)} for row in rng.normal(size=(9, 9)) + 4 * np.eye(9)]
    right = [Fraction(float(v)) for v in rng.normal(size=9)]
    found = solve_exactly(rows, right)
    assert found == eliminated(rows, right)
    longest = max(v.denominator.bit_length() for v in found)
    assert longest > 400
    monkeypatch.setattr("concio.proof.exact_solve.MOST_BITS", longest)  # twice as many are needed to know it
    with pytest.raises(LongFractionsError, match=r"fractions of more than .* digits"):
        solve_exactly(rows, right)
    file = tmp_path / "arch.toml"
    file.write_text(ARCH)
    monkeypatch.setattr("concio.proof.exact_solve.MOST_BITS", 64)
    code, _, err = run("prove", file, "--claim", "limit")
    assert code == 4
    assert "contact pairs\nError: the exact solution has fractions of more than" in err
    assert not file.with_suffix(".proof.json").exists()


@pytest.mark.parametrize("seed", range(6))
def test_singular_systems_have_no_solution_and_regular_ones_theirs(seed: int) -> None:
    """The last row is a sum of the others, which rounding hides from the factorisation, or not."""
    rng = np.random.default_rng(seed)
    n = 5
    parts = zip(rng.integers(-9, 10, n * n).tolist(), rng.integers(1, 9, n * n).tolist(), strict=True)
    entries = [Fraction(a, b) for a, b in parts]
    matrix = [entries[n * i : n * i + n] for i in range(n)]
    weights = [Fraction(int(v), 7) for v in rng.integers(-5, 6, n - 1)]
    matrix[-1] = [sum((w * row[j] for w, row in zip(weights, matrix, strict=False)), Fraction(0)) for j in range(n)]
    known = [Fraction(int(v), 11) for v in rng.integers(-40, 40, n)]
    for singular in (True, False):
        if not singular:
            matrix[-1][seed % n] += 1
        right = [sum((a * x for a, x in zip(row, known, strict=True)), Fraction(0)) for row in matrix]
        right[-1] += singular  # no solution at all
        found = solve_exactly([{j: v for j, v in enumerate(row) if v} for row in matrix], right)
        assert found == (None if singular else known)


def eliminated(rows: list[dict[int, Fraction]], right: list[Fraction]) -> list[Fraction]:
    n = len(rows)
    table = [[row.get(j, Fraction(0)) for j in range(n)] + [b] for row, b in zip(rows, right, strict=True)]
    for j in range(n):
        pivot = next(i for i in range(j, n) if table[i][j])
        table[j], table[pivot] = table[pivot], table[j]
        for i in range(n):
            if i != j and table[i][j]:
                share = table[i][j] / table[j][j]
                table[i] = [p - share * q for p, q in zip(table[i], table[j], strict=True)]
    return [table[j][n] / table[j][j] for j in range(n)]


def test_a_singular_system_has_no_solution() -> None:
    one = Fraction(1)
    assert solve_exactly([{0: one, 1: one}, {0: one, 1: one}], [one, one]) is None


def test_closed_forms_are_fractions() -> None:
    upright = concio.assemble(concio.loads(pillar(sideways(1.0))))
    assert bounds(prove_limit(upright, numbers="decimal")) == (Fraction(1, 4), Fraction(1, 4))
    slides = concio.assemble(concio.loads(pillar(sideways(1.0), friction=0.2)))
    assert bounds(prove_limit(slides, numbers="decimal")) == (Fraction(1, 5), Fraction(1, 5))
    lean = concio.assemble(concio.loads(pillar(sideways(1.0), lean=0.1)))
    assert bounds(prove_limit(lean, numbers="decimal")) == (Fraction(3, 16), Fraction(3, 16))


@pytest.mark.parametrize("phi", [0.0, 0.3, np.arctan(0.5), 1.2])
@pytest.mark.parametrize("mu", [0.2, 0.9])
def test_in_space_fractions_bound_the_closed_form_from_both_sides(mu: float, phi: float) -> None:
    """A box tips over an edge or a corner, or slides; round cones leave a hair between the bounds."""
    right = min(mu, 1 / 3 / abs(np.cos(phi)), 2 / 3 / max(abs(np.sin(phi)), 1e-300))
    found = concio.limit(box(mu, phi), path=False, steps=False, search=False)
    low, high = bounds(found.proof())
    assert float(low) <= right * (1 + 1e-12)
    assert float(high) >= right * (1 - 1e-12)
    assert float(high - low) <= 1e-5 * right


def random_wall(number: int) -> Model:
    """Return a wall of random courses, friction and weight, pushed to a random side."""
    rng = np.random.default_rng(number)
    size = (float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.15, 0.3)))
    n, m = int(rng.integers(2, 4)), int(rng.integers(2, 5))
    return concio.wall(
        length=n * size[0], height=m * size[1], block_size=size, block="rigid", unit_weight=float(rng.uniform(15, 28)),
        friction=float(rng.uniform(0.2, 0.9)), horizontal=float(rng.choice([-1.0, 1.0])),
    )  # fmt: skip


@pytest.mark.parametrize("number", range(sample(4, 16, 60)))
def test_fractions_enclose_the_multiplier_of_the_linear_programme(number: int) -> None:
    assembly = concio.assemble(random_wall(number))
    found = concio.limit(assembly, path=False, steps=False, search=False)
    low, high = bounds(found.proof())
    assert low <= high
    assert float(low) == pytest.approx(found.associated.multiplier, rel=2e-9)
    assert float(high) == pytest.approx(found.associated.multiplier, rel=2e-9)


def test_loads_that_are_not_balanced_are_proved_so() -> None:
    made = prove_collapse(concio.assemble(concio.loads(THIN)))
    assert "no forces with friction at the 32 joint points stated balance dead x 1, live x 1" in verify.check(made)
    with pytest.raises(SolverError, match="no exact motion"):
        prove_collapse(concio.assemble(concio.loads(ARCH)))
    with pytest.raises(SolverError, match="no exact motion"):  # forces in balance exist: nothing puts them there
        prove_collapse(concio.assemble(concio.loads(slot())))


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Yield every text of a certificate with its place."""
    if isinstance(value, str):
        yield path, value
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, (*path, key))
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            yield from places(inner, (*path, k))


def changed(made: dict[str, Any], place: tuple[Any, ...], text: str) -> dict[str, Any]:
    other = deepcopy(made)
    inner: Any = other
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = text
    return other


def test_every_digit_of_a_certificate_is_looked_at() -> None:
    """Any digit changed is refused; forces and lower bound are refused even where the digest is made again."""
    made = prove_limit(concio.assemble(concio.loads(pillar(sideways(1.0)))))
    assert "is balanced" in verify.check(made)
    tried = 0
    for place, text in places(made):
        for k, letter in enumerate(text):
            if not letter.isdigit():
                continue
            other = changed(made, place, text[:k] + str((int(letter) + 1) % 10) + text[k + 1 :])
            with pytest.raises(ValueError, match="digest"):
                verify.check(other)
            if place[0] in ("forces", "lower"):
                tried += 1
                with pytest.raises((ValueError, ZeroDivisionError)):
                    verify.check(sealed(other))
    assert tried > 100


WRONG = [
    (("joints", 0, "a"), -1, "no body -1"),
    (("joints", 0, "b"), 9, "no body 9"),
    (("loads", 0, "body"), -1, "no body -1"),
    (("loads", 0, "group"), "wind", "'wind' has no factor"),
    (("joints", 0, "normal"), ["0", "0"], "no normal"),
    (("joints", 0, "cap"), "-1", "strength"),
    (("bodies", 1, "fixed"), "no", "neither fixed nor free"),
    (("bodies", 1, "thickness"), "-0.7", "no volume"),
    (("bodies", 1, "pieces", 0, 0, 0), "0.1", "not closed"),
]


@pytest.mark.parametrize(("place", "value", "words"), WRONG, ids=[words for *_, words in WRONG])
@pytest.mark.parametrize("claim", ["collapse", "equilibrium"])
def test_what_is_no_structure_proves_nothing(claim: str, place: tuple[Any, ...], value: Any, words: str) -> None:
    """A body -1 was the last one to one program and fixed to the other, and a load of another group was left out."""
    model = concio.column(width=0.5, height=0.8, blocks=2, block="rigid", friction=0.7, horizontal=1.0, thickness=0.7)
    push = {"collapse": 1.5, "equilibrium": 0.1}[claim]
    made = concio.solve(model, factors={"live": push}, on_failure="return").proof(numbers="decimal")
    reader = verify_equilibrium if claim == "equilibrium" else verify
    assert (made["claim"], bool(reader.check(made))) == (claim, True)
    wrong = deepcopy({key: entry for key, entry in made.items() if key != "digest"})
    inner: Any = wrong
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    with pytest.raises(ValueError, match=words):
        reader.check(sealed(wrong))


def test_bounds_that_are_too_good_are_refused_by_the_equations() -> None:
    made = prove_limit(concio.assemble(concio.loads(pillar(sideways(1.0)))))
    low, high = bounds(made)
    for key, value in (("lower", low + Fraction(1, 10**30)), ("upper", high - Fraction(1, 10**30))):
        with pytest.raises(ValueError, match=r"balance|work"):
            verify.check(sealed({**made, key: str(value)}))
    assert verify.check(sealed({**made, "upper": str(high + 1)})), "a larger upper bound is true as well"
    rest = [[["0"] * len(v), ["0"] * len(turn)] for v, turn in made["motion"]]
    with pytest.raises(ValueError, match="need not do more work"):
        verify.check(sealed({**made, "motion": rest}))


def test_the_program_runs_alone(tmp_path: Path) -> None:
    file = tmp_path / "proof.json"
    file.write_text(json.dumps(prove_limit(concio.assemble(concio.loads(pillar(sideways(1.0)))))))
    alone = [sys.executable, "-I", "-S", str(Path(verify.__file__)), str(file)]
    done = subprocess.run(alone, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0
    assert "proved exactly" in done.stdout
    file.write_text(file.read_text().replace("0x", "0X", 1))
    done = subprocess.run(alone, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (done.returncode, done.stdout[:8]) == (1, "REFUSED:")
    assert "concio" not in [line.split()[1].split(".")[0] for line in Path(verify.__file__).read_text().splitlines()
                            if line.startswith(("import", "from"))]  # fmt: skip


def test_commands_prove_and_verify(tmp_path: Path) -> None:
    model = tmp_path / "pillar.toml"
    model.write_text(pillar(sideways(1.0)))
    code, out, _ = run("prove", model, "--numbers", "decimal")
    assert code == 0
    assert "the multiplier 1/4 = 0.25 is balanced; no multiplier above 1/4 = 0.25 is: proved exactly" in out
    place = tmp_path / "pillar.proof.json"
    code, out, _ = run("verify", place)
    assert (code, "proved exactly" in out) == (0, True)
    assert json.loads(run("verify", place, "--json")[1])["sentence"] in out
    code, _, err = run("prove", model)
    assert (code, "--force" in err) == (2, True)
    place.write_text(place.read_text().replace("1/4", "1/3"))
    code, _, err = run("verify", place)
    assert code == 2
    assert "refused: the file was changed" in err
    place.write_text("[1, 2]")
    assert run("verify", place)[0] == 2
    assert run("verify", tmp_path / "none.json")[0] == 2


def plain(**more: Any) -> Model:
    ground = Body("ground", [(-1, -1), (3, -1), (3, 0), (-1, 0)], kind="fixed")
    block = Body("a", [(0, 0), (1, 0), (1, 1), (0, 1)], kind="rigid")
    given: dict[str, Any] = {"laws": {"joint": JointLaw(0.6)}, "loads": (Load("weight", (0, -1)),)}
    return Model((ground, block), {"block": Rigid(20.0)}, **{**given, **more})


PUSHED = (Load("weight", (0, -1)), Load("weight", (1, 0), group="live"))
TOP = Support("top", "a", edge=((0, 1), (0, 1)), directions="x")
ROD = Tie("rod", "a", (0, 0.5), "", (-2, 0.5), 1e4, prestress=1.0, yield_force=3.0)


@pytest.mark.parametrize(
    ("changes", "right"),
    [
        ({"laws": {"joint": JointLaw(0.2, cohesion=5.0)}}, Fraction(9, 20)),
        ({"laws": {"joint": JointLaw(0.9, cohesion=90.0, tensile_strength=4.0)}}, Fraction(6, 5)),
        ({"laws": {"joint": JointLaw(0.3, dilatancy=0.1)}}, Fraction(3, 10)),
        ({"laws": {"joint": JointLaw(0.3)}, "ties": (ROD,)}, Fraction(9, 20)),
        ({"laws": {"joint": JointLaw(0.3)}, "supports": (TOP,)}, Fraction(8, 5)),
    ],
    ids=["cohesion", "tension", "dilatancy", "tie", "held"],
)
def test_cohesion_tension_ties_and_held_blocks_are_fractions(changes: dict[str, Any], right: Any) -> None:
    """A block of 20 kN slides at cohesion + friction and tips at 1 + 2 T / W; held at its top, with friction below."""
    assembly = concio.assemble(plain(loads=PUSHED, **changes))
    made = prove_limit(assembly, numbers="decimal")
    assert bounds(made) == (right, right)
    assert "proved exactly" in verify.check(made)
    high = {**made, "upper": str(right - Fraction(1, 10**30))}
    with pytest.raises(ValueError, match="work"):
        verify.check(sealed(high))


def test_forces_that_balance_the_loads_are_proved_in_plane_and_space() -> None:
    for model in (plain(loads=PUSHED), box(0.5, 0.3)):
        made = prove_balance(concio.assemble(model), {"live": 0.3})
        assert "balance dead x 1, live x 0.3: proved exactly" in verify.check(made)
        with pytest.raises(ValueError, match="not in balance"):
            verify.check(sealed({**made, "constant": {**made["constant"], "dead": "2"}}))
        with pytest.raises(SolverError, match="no exact forces"):
            prove_balance(concio.assemble(model), {"live": 0.7})


@pytest.mark.parametrize("share", [1e-9, 1e-12, 2.0**-54])
def test_what_is_proved_near_a_limit_names_its_own_factor(share: float) -> None:
    """Balanced at 0.25, not above: "live x 0.25" was said to be balanced, and to be not, proved exactly both times."""
    assembly = concio.assemble(concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=1.0))
    below, above = 0.25 - share, 0.25 + 4 * share
    balanced = verify.check(prove_balance(assembly, {"live": below}))
    assert balanced.endswith(f"live x {below!r}: proved exactly")
    assert verify.check(prove_balance(assembly, {"live": 0.25})).endswith("live x 0.25: proved exactly")
    told = concio.solve(assembly, factors={"live": 0.25 + 1e-7}, on_failure="return").verdict
    assert any(line.startswith("live x 0.2500001: constant") for line in told.question.loads())
    if share > 1e-10:
        fallen = verify.check(prove_collapse(assembly, {"live": above}))
        assert fallen.endswith(f"live x {above!r}: proved exactly")
        assert "no forces" in fallen


def test_a_toe_that_crushes_is_a_fraction_near_the_plastic_hinge() -> None:
    """30 kN/m2 carry 20 kN over two thirds of the joint: 1/3, and less by what its points miss of the edge."""
    assembly = concio.assemble(plain(loads=PUSHED, laws={"joint": JointLaw(0.9, compressive_strength=30.0)}))
    low, high = bounds(prove_limit(assembly, numbers="decimal"))
    found = concio.limit(assembly, path=False, steps=False, search=False).associated.multiplier
    assert low == high
    assert float(low) == pytest.approx(found, rel=1e-9)
    assert float(low) == pytest.approx(1 / 3, rel=0.01)


@pytest.mark.parametrize("unit", [2.0**-36, 2.0**30])
def test_weights_in_any_unit_have_the_same_proof(unit: float) -> None:
    """A multiplier has no unit: those of blocks of 20 kN/m3 and of 3e-10 kN/m3 are one number."""
    wall = concio.wall(length=2.0, height=0.75, block_size=(0.5, 0.25), friction=0.5, horizontal=0.1, block="rigid")
    for model in (wall, box(0.5, 0.3)):
        stones = (dict.fromkeys(model.materials, Rigid(weight)) for weight in (20.0 * unit, 20.0))
        found, wanted = (bounds(prove_limit(concio.assemble(replace(model, materials=own)))) for own in stones)
        assert [float(v) for v in found] == pytest.approx([float(v) for v in wanted], rel=1e-9)


def test_strength_in_space_is_bounded_from_both_sides() -> None:
    """A box that slides with cohesion: 2 kN of cohesion over 2 m2 beside 0.2 of a weight of 120 kN."""
    ground = Polyhedron.box("ground", (-9, -9, -1), (9, 9, 0), kind="fixed")
    loads = (Load("weight", (0, 0, -1)), Load("weight", (0.6, 0.8, 0), group="live"))
    block = Polyhedron.box("box", (0, 0, 0), (1, 2, 3), kind="rigid")
    model = Model((ground, block), {"block": Rigid(20.0)}, {"joint": JointLaw(0.2, cohesion=2.0)}, loads=loads)
    low, high = bounds(concio.limit(model, path=False, steps=False, search=False).proof())
    right = 0.2 + 4.0 / 120.0
    assert float(low) <= right * (1 + 1e-12)
    assert float(high) >= right * (1 - 1e-12)
    assert float(high - low) <= 1e-5


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (plain(supports=(Support("sinks", "ground", displacement=(0.0, -0.1)),)), "a support that is moved"),
        (plain(rules=(JointRule("joint", gap=0.01),)), "initial gap"),
    ],
)
def test_what_is_not_proved_exactly_is_refused_by_name(model: Model, words: str) -> None:
    with pytest.raises(InputError, match=words):
        prove_collapse(concio.assemble(model))


@pytest.mark.long  # 12 blocks in space: 72 equations in fractions
def test_a_corner_in_space_is_bounded_by_long_fractions_that_the_program_reads(tmp_path: Path) -> None:
    """Fractions of more than 4,300 decimal digits were refused by Python itself, after minutes of pivots."""
    model = concio.walls(
        lines=[((0, 0), (0, 1.6)), ((0, 0), (1.2, 0))], height=0.9, block_size=(0.8, 0.3, 0.3), block="rigid",
        unit_weight=18.0, friction=0.6, horizontal=1.0,
    )  # fmt: skip
    assert len(model.free_bodies) >= 12
    found = concio.limit(model, path=False, steps=False, search=False)
    made = found.proof()
    low, high = (verify.exact(made[key]) for key in ("lower", "upper"))
    assert float(low) == pytest.approx(found.associated.multiplier, rel=1e-8)
    assert 0 <= float(high - low) <= 2e-5 * float(high)  # a motion that no joint of friction wider by 1e-5 resists
    assert verify.check(made)
    for key, change in (("lower", Fraction(1, 10**12)), ("upper", Fraction(-1, 10**3))):
        worse = verify.exact(made[key]) + change
        with pytest.raises(ValueError, match=r"not in balance|more work"):
            verify.check(sealed({**made, key: str(worse)}))


def test_whole_numbers_of_any_length_are_written_and_read() -> None:
    long = Fraction(3**20_000, 2 * 5**9_000)
    text = fraction_text(long)
    assert text.startswith("0x")
    assert verify.exact(text) == verify_equilibrium.exact(text) == long
    assert verify.exact(fraction_text(-long)) == -long
    assert [fraction_text(x) for x in (Fraction(-3, 4), Fraction(7))] == ["-3/4", "7"]
    with pytest.raises(ZeroDivisionError):
        verify.exact("0x1/0x0")


def test_without_a_claim_what_becomes_of_the_loads_is_proved(tmp_path: Path) -> None:
    """A file without a group 'live' was refused; it has an equilibrium or a collapse to prove."""
    stands, falls = tmp_path / "stands.toml", tmp_path / "falls.toml"
    stands.write_text(pillar(""))
    falls.write_text(pillar(sideways(1.0)).replace('"live"', '"wind"'))
    told = json.loads(run("prove", stands, "--json")[1])
    assert (told["claim"], told["verdict"]["outcome"]) == ("equilibrium", "holds")
    told = json.loads(run("prove", falls, "--json")[1])
    assert told["claim"] == "collapse"
    assert "no forces" in told["sentence"]
    told = json.loads(run("prove", falls, "--json", "--force", "--factor", "wind=0.2")[1])
    assert told["claim"] == "equilibrium"
    told = json.loads(run("prove", falls, "--json", "--force", "--group", "wind", "--numbers", "decimal")[1])
    assert (told["claim"], told["lower"], told["upper"]) == ("limit", "1/4", "1/4")
