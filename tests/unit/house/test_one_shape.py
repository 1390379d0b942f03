"""What has one place is not written out elsewhere: turns and cross products, strengths, load factors, states."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import concio

PACKAGE = Path(concio.__file__).parent
ONE_PLACE = {
    "kinematics/frames.py": (
        r"np\.cross\(",
        r"\[-(\w+)\[(?::, |\.\.\., )?1\], \1\[",  # (-y, x)
        r"\[(\w+)\[(?::, |\.\.\., )?1\], -\1\[",  # (y, -x)
        r"(\w+)\[(?::, )?0\] \* (\w+)\[(?::, )?1\] - \1\[(?::, )?1\] \* \2\[",
    ),
    "problem/cone.py": (r"cohesion(?:\[\w+\])? \+ [\w.]*(?:friction|mu)(?:\[\w+\])? \* ",),
    "contact/factors.py": (r"factors\.get\(",),
    "problem/pair_state.py": (r"\b(?:contact|normal)(?:\[\w+\])? [!=]= \d\b",),
}
"""What only one file of the package writes out."""
ALONE = {
    "proof/verify.py", "proof/verify_equilibrium.py", "contact/original.py", "analysis/motion/certified.py",
    "analysis/seismic/hand_check.py", "analysis/seismic/hand_forces.py", "contact/original_solids.py",
    "contact/original_joints.py",
}  # fmt: skip
"""What checks answers writes its equations again: a fault in what it shared with the solvers would pass."""


@pytest.mark.parametrize("home", ONE_PLACE)
def test_written_out_in_one_place_only(home: str) -> None:
    found = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        for pattern in ONE_PLACE[home]
        if re.search(pattern, path.read_text(encoding="utf-8"))
    }
    assert found - ALONE <= {home}


@pytest.mark.parametrize(
    ("home", "line"),
    [
        ("kinematics/frames.py", "across = np.array([-along[1], along[0]])"),
        ("kinematics/frames.py", "np.column_stack([along[:, 1], -along[:, 0]])"),
        ("kinematics/frames.py", "turn = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]"),
        ("problem/cone.py", "strength = s.cone.cohesion + s.cone.friction * t_n"),
        ("contact/factors.py", "result.factors.get(name, 1.0)"),
        ("problem/pair_state.py", "crushed = states.contact == 2"),
    ],
)
def test_such_lines_would_be_seen(home: str, line: str) -> None:
    assert any(re.search(pattern, line) for pattern in ONE_PLACE[home])
