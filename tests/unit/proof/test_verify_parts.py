"""The parts of the program that checks certificates, each against its definition: what it must refuse, and its sums.

Numbers are whole and of no symmetry; normals are not of length one.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands import run
from concio.proof import verify, verify_equilibrium
from concio.proof.exact_certificate import sealed

MOTION2 = [[["0", "0"], ["0"]], [["3", "-2"], ["5"]]]
MOTION3 = [[["0", "0", "0"], ["0", "0", "0"]], [["3", "-2", "7"], ["5", "-4", "2"]]]


def body(d: int, *, fixed: bool = False, **more: Any) -> dict[str, Any]:
    pieces = [[["1", "0"], ["4", "1"], ["2", "6"]], [["2", "6"], ["4", "1"], ["5", "8"]]]
    if d == 3:
        pieces = [[["1", "0", "2"], ["4", "1", "2"], ["2", "6", "3"]]]
        pieces += [[["2", "6", "3"], ["4", "1", "2"], ["5", "8", "9"]]]
    return {"name": "B", "fixed": fixed, "pieces": pieces, "thickness": "3", "unit_weight": "20", **more}


def joint(d: int, **more: str) -> dict[str, Any]:
    normal, at = (["3", "-4"], ["2", "7"]) if d == 2 else (["2", "-1", "2"], ["2", "7", "-3"])
    return {"a": 0, "b": 1, "normal": normal, "at": at, **more}


def floats(texts: Any) -> np.ndarray:
    return np.array([[float(x) for x in row] for row in texts]) if isinstance(texts[0], list) else np.array(
        [float(x) for x in texts]
    )  # fmt: skip


def crossed(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the moment of b at a: one number in the plane."""
    return np.array([a[0] * b[1] - a[1] * b[0]]) if len(a) == 2 else np.cross(a, b)


def velocities(motion: Any, at: np.ndarray) -> np.ndarray:
    """Return that of the second body less that of the first."""
    found = []
    for v, turn in motion:
        w = floats(turn)
        swept = w[0] * np.array([-at[1], at[0]]) if len(at) == 2 else np.cross(w, at)
        found.append(floats(v) + swept)
    moved: np.ndarray = found[1] - found[0]
    return moved


@pytest.mark.parametrize(("d", "motion"), [(2, MOTION2), (3, MOTION3)])
@pytest.mark.parametrize("laws", [
    {"friction": "1/2", "cohesion": "3", "tension": "2", "cap": "11"}, {"cohesion": "3", "tension": "2", "cap": "11"},
    {"friction": "3/4", "tension": "1/2", "cap": "40"}, {"friction": "10", "cap": "7"},
    {"friction": "1/9", "cohesion": "8", "tension": "30", "cap": "1/5"},
])  # fmt: skip
@pytest.mark.parametrize("sense", [1, -1])
def test_what_joints_take_is_the_largest_work_of_a_force_within_their_strength(
    d: int, motion: Any, laws: dict[str, str], sense: int
) -> None:
    """Of all p between -tension and cap and all s square to n with |s| <= (cohesion + friction p) |n|."""
    moved = [[[str(sense * int(x)) for x in part] for part in one] for one in motion]
    moved[0] = [["-1", "4", "2"][:d], ["-2"] if d == 2 else ["1", "-2", "3"]]
    data = {"bodies": [body(d), body(d)], "joints": [joint(d, **laws)]}
    n, at = floats(data["joints"][0]["normal"]), floats(data["joints"][0]["at"])
    w = velocities(moved, at)
    mu, cohesion, tension, cap = (float(Fraction(laws.get(k, "0"))) for k in ("friction", "cohesion", "tension", "cap"))
    size = float(np.linalg.norm(n))
    aside = w - (w @ n) / size**2 * n
    aside /= np.linalg.norm(aside)
    most = -np.inf
    for p in (-tension, cap):  # linear in p: at an end
        if cohesion + mu * p >= 0:
            most = max(most, -(p * n + -(cohesion + mu * p) * size * aside) @ w)
    lowest = -cohesion / mu if mu else -np.inf
    if -tension < lowest < cap:
        most = max(most, -(lowest * n) @ w)
    found = float(verify.taken(data, moved))
    assert found >= most - 1e-12 * abs(most)
    if mu == 0 or cohesion >= mu * tension:  # else the verifier takes an upper bound, beyond the tip of the cone
        assert found == pytest.approx(most, rel=1e-12)


@pytest.mark.parametrize(("d", "motion"), [(2, MOTION2), (3, MOTION3)])
def test_a_fixed_body_that_moves_or_turns_proves_nothing(d: int, motion: Any) -> None:
    rest = [["0"] * d, ["0"] * (1 if d == 2 else 3)]
    data = {"bodies": [body(d, fixed=True), body(d)], "joints": [joint(d, cohesion="1", tension="1", cap="1")]}
    assert verify.taken(data, [rest, motion[1]]) > 0
    for k in range(d):
        shifted = [["0"] * k + ["1"] + ["0"] * (d - k - 1), rest[1]]
        with pytest.raises(ValueError, match="'B' is fixed and moves"):
            verify.taken(data, [shifted, motion[1]])
    for k in range(len(rest[1])):
        turned = [rest[0], ["0"] * k + ["-1/7"] + ["0"] * (len(rest[1]) - k - 1)]
        with pytest.raises(ValueError, match="'B' is fixed and moves"):
            verify.taken(data, [turned, motion[1]])


@pytest.mark.parametrize("d", [2, 3])
def test_a_joint_without_an_end_of_its_strength_resists(d: int) -> None:
    """It closes against a cap of inf, or opens against a tension of inf; along it friction closes it, too."""
    n = floats(joint(d)["normal"])
    turn = ["0"] * (1 if d == 2 else 3)
    closing, opening = ([str(int(s * x)) for x in n] for s in (-1, 1))
    rest = [["0"] * d, turn]
    bodies = [body(d, fixed=True), body(d)]
    for way, laws, ends in (
        (closing, {}, False), (closing, {"cap": "2"}, True), (opening, {}, True), (opening, {"tension": "inf"}, False),
        (closing, {"tension": "inf", "cap": "3"}, True),
    ):  # fmt: skip
        data = {"bodies": bodies, "joints": [joint(d, **laws)]}
        if ends:
            wanted = float(n @ n) * float(laws.get("cap", 0)) if way is closing else 0.0
            assert float(verify.taken(data, [rest, [way, turn]])) == pytest.approx(wanted)
        else:
            with pytest.raises(ValueError, match="at point 0 resists the motion"):
                verify.taken(data, [rest, [way, turn]])
    along = ["4", "3"] if d == 2 else ["1", "2", "0"]
    assert verify.taken({"bodies": bodies, "joints": [joint(d)]}, [rest, [along, turn]]) == 0
    with pytest.raises(ValueError, match="resists"):
        verify.taken({"bodies": bodies, "joints": [joint(d, friction="1/100")]}, [rest, [along, turn]])


@pytest.mark.parametrize("d", [2, 3])
def test_forces_are_refused_just_outside_their_strength(d: int) -> None:
    """F = p n + s with n of length 5 or 3: a millionth more of p or s is too much on every side."""
    n = floats(joint(d)["normal"])
    size = int(np.linalg.norm(n))
    aside = np.array([4.0, 3.0]) if d == 2 else np.array([1.0, 0.0, -1.0])
    length = Fraction(5) if d == 2 else None
    laws = {"friction": "1/2", "cohesion": "3", "tension": "2", "cap": "11"}
    bodies = [body(d, fixed=True), body(d, fixed=True)]
    data = {"bodies": bodies, "joints": [joint(d, **laws)], "loads": []}

    def force(p: Fraction, share: Fraction) -> list[str]:
        """Return p n and a shear of a share of what may be."""
        most = (3 + Fraction(1, 2) * p) * size
        unit = most / length if length else most * Fraction(985, 1393)  # just below one over the root of two
        return [str(p * int(x) + share * unit * int(y)) for x, y in zip(n, aside, strict=True)]

    tiny = Fraction(1, 100_000)
    for p in (Fraction(-2), Fraction(0), Fraction(11)):
        for sign in (1, -1):
            verify.check_forces(data, [force(p, Fraction(sign) * (1 - tiny))], {})
            with pytest.raises(ValueError, match="at joint point 0 is outside its strength"):
                verify.check_forces(data, [force(p, Fraction(sign) * (1 + tiny))], {})
    for p in (Fraction(-2) - tiny, Fraction(11) + tiny):
        with pytest.raises(ValueError, match="outside its strength"):
            verify.check_forces(data, [force(p, Fraction(0))], {})
    weak = {"bodies": bodies, "joints": [joint(d, friction="1/2", tension="inf")], "loads": []}
    verify.check_forces(weak, [force(Fraction(0), Fraction(0))], {})
    with pytest.raises(ValueError, match="outside its strength"):
        verify.check_forces(weak, [[str(-int(x)) for x in n]], {})


@pytest.mark.parametrize("wrong", [
    {"friction": "-1/2"}, {"cohesion": "-3"}, {"tension": "-1"}, {"cap": "-1"}, {"friction": "inf"},
    {"cohesion": "inf"},
])  # fmt: skip
def test_no_strength_is_negative_and_friction_and_cohesion_are_finite(wrong: dict[str, str]) -> None:
    with pytest.raises(ValueError, match="a strength is negative"):
        verify.strength({"friction": "1", **wrong})
    assert verify.strength({"friction": "1/2"}) == [Fraction(1, 2), 0, 0, -1]
    assert verify.strength({"tension": "inf", "cap": "5"}) == [0, 0, -1, 5]


def test_weights_moments_and_work_are_those_of_the_pieces() -> None:
    """Areas and centroids of two triangles, volumes of two tetrahedra from the origin, against NumPy."""
    for d in (2, 3):
        pieces = [floats(p) for p in body(d)["pieces"]]
        if d == 2:
            sizes = [3.0 * 0.5 * float(crossed(p[0], p[1])[0]) for p in pieces]
            corners = [(np.zeros(2), p[0], p[1]) for p in pieces]
        else:
            sizes = [float(np.linalg.det(p)) / 6 for p in pieces]
            corners = [(np.zeros(3), *p) for p in pieces]
        if d == 2:
            given = [[[str(int(x)) for x in p] for p in one[:2]] for one in pieces]
        else:
            given = body(d)["pieces"]
        block = body(d, pieces=given)
        volume, first = verify.solid(block)
        assert float(volume) == pytest.approx(sum(sizes))
        moments = sum(s * np.mean(c, axis=0) for s, c in zip(sizes, corners, strict=True))
        assert [float(x) for x in first] == pytest.approx(moments)
        down = ["1", "-2"] if d == 2 else ["1", "-2", "3"]
        turning = ["7"] if d == 2 else ["7", "-1", "2"]
        data = {
            "bodies": [body(d, pieces=given, fixed=True), block],
            "loads": [
                {"group": "dead", "kind": "weight", "body": 1, "value": down},
                {"group": "live", "kind": "point", "body": 1, "force": ["4", "-3", "2"][:d], "at": ["5", "1", "-2"][:d],
                 "moment": turning},
                {"group": "none", "kind": "weight", "body": 1, "value": down},
            ],
        }  # fmt: skip
        dead, live = 2.0, 0.25
        weight = 20.0 * dead * sum(sizes) * floats(down)
        force = weight + live * floats(["4", "-3", "2"][:d])
        arm, push = floats(["5", "1", "-2"][:d]), floats(["4", "-3", "2"][:d])
        moment = crossed(20.0 * dead * moments, floats(down)) + live * (crossed(arm, push) + floats(turning))
        factors = {"dead": Fraction(2), "live": Fraction(1, 4)}
        (still, moved) = verify.loads(data, factors)
        assert not any(x for part in still for x in part)
        assert [float(x) for x in moved[0]] == pytest.approx(force)
        assert [float(x) for x in moved[1]] == pytest.approx(moment)
        motion = MOTION2 if d == 2 else MOTION3
        power = force @ floats(motion[1][0]) + moment @ floats(motion[1][1])
        assert float(verify.work(data, motion, factors)) == pytest.approx(power)


@pytest.mark.parametrize("square", ["0", "1", "9/4", "2", "1/3", f"{10**30 + 1}", "1/7000000000000000000"])
def test_roots_are_enclosed_and_exact_where_they_are_fractions(square: str) -> None:
    low, high = verify.roots(Fraction(square))
    assert low * low <= Fraction(square) <= high * high
    assert 0 <= high - low <= Fraction(1, 10**39)
    assert (low == high) == (square in ("0", "1", "9/4"))


@pytest.mark.parametrize("d", [2, 3])
def test_what_is_taken_is_never_less_than_exact(d: int) -> None:
    """A slip of the root of 2 n . n, which is no fraction, against cohesion alone, friction alone, and both."""
    turn = ["0"] * (1 if d == 2 else 3)
    normal, way = (["1", "1"], ["1", "-1"]) if d == 2 else (["1", "1", "1"], ["1", "-1", "0"])
    square = Fraction(4 if d == 2 else 6)
    bodies = [body(d, fixed=True), body(d)]
    cases = ({"cohesion": "3"}, 3), ({"friction": "1/2", "cap": "4"}, 2), ({"cohesion": "1", "cap": "9"}, 1)
    for laws, factor in cases:
        data = {"bodies": bodies, "joints": [{**joint(d, **laws), "normal": normal}]}
        found = verify.taken(data, [[["0"] * d, turn], [way, turn]])
        assert factor**2 * square <= found**2 <= factor**2 * square * (1 + Fraction(1, 10**30))


@pytest.mark.parametrize("d", [2, 3])
def test_a_block_on_which_a_moment_or_a_force_is_left_is_not_in_balance(d: int) -> None:
    """Equal and opposite forces beside each other; a force through the origin; both together with their opposites."""
    at, aside = (["2", "7"], ["3", "7"]) if d == 2 else (["2", "7", "-3"], ["3", "7", "-3"])
    n = joint(d)["normal"]
    back = [str(-int(x)) for x in n]
    strong = {"friction": "9", "tension": "inf", "cohesion": "99"}
    bodies = [body(d, fixed=True), body(d)]
    for places, forces, balanced in (
        ([at, aside], [n, back], False), ([["0"] * d], [n], False), ([at, at], [n, back], True),
        ([at], [["0"] * d], True),
    ):  # fmt: skip
        data = {"bodies": bodies, "joints": [{**joint(d, **strong), "at": p} for p in places], "loads": []}
        if balanced:
            verify.check_forces(data, forces, {})
        else:
            with pytest.raises(ValueError, match="'B' is not in balance"):
                verify.check_forces(data, forces, {})


@pytest.mark.parametrize("d", [2, 3])
def test_a_joint_presses_both_of_its_bodies(d: int) -> None:
    """Loads on each of two free blocks that a joint force balances: its moment is that about the origin, on both."""
    one = joint(d, friction="9", tension="inf", cohesion="99")
    force = ["3", "1", "-2"][:d]
    F, at = floats(force), floats(one["at"])
    moment = crossed(at, F)
    still = [str(0)] * d

    def load(b: int, sense: int, turned: int = 0) -> dict[str, Any]:
        turning = [str(int(sense * m) + turned) for m in moment]
        return {"group": "dead", "kind": "point", "body": b, "force": [str(int(sense * x)) for x in F], "at": still,
                "moment": turning}  # fmt: skip

    bodies = [body(d), body(d)]
    data = {"bodies": bodies, "joints": [one], "loads": [load(0, 1), load(1, -1)]}
    verify.check_forces(data, [force], {"dead": Fraction(1)})
    for wrong in ([load(0, -1), load(1, -1)], [load(0, 1, 1), load(1, -1)], [load(0, 1), load(1, 1)], [load(0, 1)]):
        with pytest.raises(ValueError, match="is not in balance"):
            verify.check_forces({**data, "loads": wrong}, [force], {"dead": Fraction(1)})
    with pytest.raises(ValueError, match="is not in balance"):
        verify.check_forces(data, [force], {"dead": Fraction(2)})


def test_groups_are_constant_or_multiplied_and_not_both() -> None:
    data = {"claim": "limit", "bodies": [], "joints": [], "loads": [], "constant": {"g": "1"}, "multiplied": {"g": "1"}}
    with pytest.raises(ValueError, match="both constant and multiplied"):
        verify.check(sealed(data))



@pytest.mark.parametrize("wrong", ["constant", "joints"])
@pytest.mark.parametrize("claim", ["balance", "equilibrium"])
def test_an_entry_of_another_kind_is_refused_and_no_bug(
    claim: str, wrong: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A list for a table ended in a traceback of the program, and "a bug in concio" of the command."""
    one = {"format": "", "claim": claim, "bodies": [body(2)], "joints": [joint(2)], "loads": [], "forces": [["0", "0"]],
           "shapes": [], "states": [["open", "free"]], "solution": [], "constant": {"dead": "1"}}  # fmt: skip
    one["loads"] = [{"kind": "weight", "body": 0, "group": "dead", "value": ["0", "-1"]}]
    place = tmp_path / "wrong.json"
    place.write_text(json.dumps(sealed({**one, wrong: ["dead"]})))
    program = verify if claim == "balance" else verify_equilibrium
    assert program.main(str(place)) == 1
    assert capsys.readouterr().out.startswith("REFUSED")
    code, _, err = run("verify", place)
    assert code == 2
    assert "refused" in err
