"""Tie rods: tension only, prestress, moved anchors."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.analysis.motion.state import TieMemory
from concio.cli.check_lines import check_lines
from concio.contact.assembly import assemble
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Load, Support, Tie
from concio.post.solids import moved_ties
from models import box, on_ground, weight

STONE = {"kind": "rigid", "material": "stone"}


def hung(*ties, force=(0.0, 30.0), supports=()):
    """A rigid block of weight 20 pulled upwards at its middle; a frame above."""
    return on_ground(
        box("b", -0.5, 0.5, 0, 1, **STONE), box("frame", -1, 1, 5, 6, kind="fixed"),
        loads=(weight(), Load("point", force, bodies=("b",), at=(0.0, 0.5))), ties=ties, supports=supports,
    )  # fmt: skip


def force_of(result, k=0):
    """Tension of tie k."""
    at = [i for i, face in enumerate(result.contacts.pairs.interface) if face < 0]
    return result.contacts.normal_force[at[k]]


ROD = Tie("rod", "b", (0.0, 0.5), "", (0.0, -2.0), stiffness=1000.0)


def test_a_slack_tie_carries_nothing():
    result = concio.solve(hung(ROD, force=(0.0, -5.0)))
    assert force_of(result) == pytest.approx(0.0, abs=1e-12)
    assert result.reactions["ground"] == pytest.approx((0.0, 25.0))


def test_a_tie_holds_what_would_fly():
    result = concio.solve(hung(ROD))
    assert force_of(result) == pytest.approx(10.0)  # 30 up, 20 of weight
    assert result.node_displacement("b")[:, 1] == pytest.approx(0.01)  # T / k
    assert result.reactions["ground"] == pytest.approx((0.0, 0.0), abs=1e-9)
    with pytest.raises(NoEquilibriumError):
        concio.solve(hung())


def test_prestress_presses_the_block_down():
    rod = Tie("rod", "b", (0.0, 0.5), "ground", (0.0, -0.5), stiffness=1000.0, prestress=50.0)
    result = concio.solve(hung(rod))
    assert force_of(result) == pytest.approx(50.0)  # no elongation: the ground holds
    assert result.contacts.normal_force[:2].sum() == pytest.approx(40.0)
    assert result.reactions["ground"][1] == pytest.approx(-10.0)  # 40 on the base, 50 back through the tie
    with_more = concio.solve(hung(rod, force=(0.0, 90.0)))  # 70 of lift against 50: it opens
    assert force_of(with_more) == pytest.approx(70.0)
    assert with_more.node_displacement("b")[:, 1] == pytest.approx(0.02)


def test_tie_between_two_blocks_pulls_both():
    model = on_ground(
        box("a", -2, -1, 0, 1, **STONE), box("b", 1, 2, 0, 1, **STONE), loads=(weight(),),
        ties=(Tie("rod", "a", (-1.0, 0.2), "b", (1.0, 0.2), 500.0, prestress=6.0),),
    )  # fmt: skip
    result = concio.solve(model)  # friction 0.5 x 20 holds 6
    assert force_of(result) == pytest.approx(6.0)
    shear = {int(b): v for b, v in zip(result.joints.body_b, result.joints.V, strict=True)}
    # t_t acts on b along t; t = (-1, 0) for n = (0, 1): a is drawn to +x and held back
    assert shear == pytest.approx({1: 6.0, 2: -6.0})


def test_the_end_of_a_tie_moves_with_its_anchor():
    rod = Tie("rod", "b", (0.5, 0.5), "frame", (1.0, 5.5), stiffness=1e5)
    straight = Tie("rod", "b", (0.0, 0.5), "frame", (0.0, 5.5), stiffness=100.0)
    lifted = concio.solve(
        hung(straight, force=(0.0, -1.0), supports=(Support("lift", "frame", displacement=(0.0, 0.05)),))
    )
    assert force_of(lifted) == pytest.approx(5.0)
    # turning the frame about its centroid (0, 5.5) by -0.01 lifts the end at (-1, 5.5) by 0.01
    aside = Tie("rod", "b", (-1.0 + 0.5, 0.5), "frame", (-1.0 + 0.5, 5.5), stiffness=100.0)
    turn = (Support("turn", "frame", rotation=-0.01),)
    assert force_of(concio.solve(hung(aside, force=(0.0, -1.0), supports=turn))) == pytest.approx(100 * 0.005)
    assert force_of(concio.solve(hung(rod, force=(0.0, -1.0)))) == pytest.approx(0.0, abs=1e-12)
    # a slanted rod: the end at (1, 5.5) rises by 0.001, of which 5 parts in sqrt(25.25) lie along the rod
    turn = (Support("turn", "frame", rotation=0.001),)
    slanted = concio.solve(hung(replace(rod, stiffness=100.0), force=(0.0, -1.0), supports=turn))
    assert force_of(slanted) == pytest.approx(0.1 * 5 / 25.25**0.5)


@pytest.mark.parametrize(
    ("tie", "message"),
    [
        (Tie("rod", "b", (0.0, 0.5), "", (0.0, 0.5), 1.0), "ends coincide"),
        (Tie("rod", "b", (0.0, 0.5), "b", (0.5, 0.5), 1.0), "both of its ends are on 'b'"),
        (Tie("rod", "b", (0.0, 0.5), "", (0.0, 3.0), 0.0), "stiffness 0"),
        (Tie("rod", "b", (0.0, 0.5), "", (0.0, 3.0), 1.0, -1.0), "prestress -1"),
        (Tie("rod", "x", (0.0, 0.5), "", (0.0, 3.0), 1.0), "no body called 'x'"),
        (Tie("rod", "", (0.0, 0.5), "", (0.0, 3.0), 1.0), "neither end"),
        (Tie("rod", "ground", (0.0, 0.0), "frame", (0.0, 5.0), 1.0), "neither end"),
    ],
)
def test_refused(tie, message):
    with pytest.raises(InputError, match=rf"tie 'rod'.*{message}"):
        assemble(hung(tie))


def test_a_slack_or_broken_tie_stores_no_energy() -> None:
    """Stretched by 2 mm, slack by 3 mm, broken while stretched by 4 mm: k s^2 / 2 of the first alone."""
    ties = SimpleNamespace(stiffness=np.array([1000.0, 2000.0, 500.0]))
    memory = TieMemory(np.array([-2e-3, 3e-3, -4e-3]), np.zeros(3), np.array([False, False, True]))
    assert memory.stored(ties) == pytest.approx(0.5 * 1000.0 * 4e-6, rel=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_which_end_is_named_first_changes_nothing(dim: int) -> None:
    """The fixed end may come first, too: words and drawings once stopped there."""
    bare, ways = hung(), [Tie("rod", "b", (0.2, 0.5), "", (0.9, -2.0), 1000.0)]
    ways.append(replace(ways[0], body_a="", at_a=ways[0].at_b, body_b="b", at_b=ways[0].at_a))
    models = [replace(bare, ties=(tie,)) for tie in ways]
    one, other = (concio.solve(m if dim == 2 else concio.extrude(m, 1.0)) for m in models)
    assert one.ties.tension > 5.0
    assert other.ties.tension == pytest.approx(one.ties.tension, rel=1e-9)
    assert other.verdict.answer == one.verdict.answer
    assert other.attention == one.attention
    ends = [moved_ties(r, None, 100.0) for r in (one, other)] if dim == 3 else [np.zeros((1, 2, 3))] * 2
    assert ends[1][:, ::-1] == pytest.approx(ends[0], rel=1e-9)
    told = [check_lines(r.model, r.assembly.detection, {}, every=True) for r in (one, other)]
    (line,) = (line for line in told[1] if line.startswith("tie "))
    assert line.startswith("tie          rod: a fixed point to b;")
    assert len(told[0]) == len(told[1])
