"""Arrays of results refuse to be written to; tables are copies and may be."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping

import numpy as np
import pytest

import concio

PILLAR = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", horizontal=0.1)
ELASTIC = concio.column(width=0.5, height=1.0, blocks=2, horizontal=0.1)
FOOT = concio.Support("foot", "ground", displacement=(0.0, -1e-3))
LIVE = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", horizontal=1.0)
CELL = concio.cell(
    block="rigid",
    friction=concio.JointLaw(0.6, cohesion=20.0, tensile_strength=10.0, normal_stiffness=1e6, tangential_stiffness=4e5),
)
WEIGHT = [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})]

MADE = {
    "plane": lambda: concio.solve(PILLAR),
    "elastic": lambda: concio.solve(ELASTIC),
    "space": lambda: concio.solve(concio.extrude(PILLAR)),
    "mechanism": lambda: concio.solve(PILLAR, factors={"live": 10.0}, on_failure="return"),
    "path": lambda: concio.run_path(PILLAR, WEIGHT),
    "settlement": lambda: concio.settle(dataclasses.replace(PILLAR, supports=(FOOT,))),
    "push": lambda: concio.push(PILLAR),
    "motion": lambda: concio.dynamics(PILLAR, velocities={"b01": (0.1, 0.0, 0.0)}, duration=0.02),
    "limit": lambda: concio.limit(LIVE),
    "rocking": lambda: concio.rock(concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=0.0)),
    "thrust line": lambda: concio.thrust_line(concio.solve(concio.arch(span=3.0, ring=0.4, voussoirs=7, friction=0.8))),
    "thrust surface": lambda: concio.thrust_surface(concio.solve(concio.extrude(PILLAR))),
    "sensitivity": lambda: concio.state_sensitivity(concio.solve(ELASTIC)),
    "moduli": lambda: concio.homogenise(CELL),
    "strength": lambda: concio.strength(CELL, [(1, 0, 0)], stress=(0, -50, 0)),
    "cell path": lambda: concio.strain_path(CELL, [{"stress yy": -100.0}, {"strain xy": 1e-3}]),
}

COMPUTED = (
    "displacement", "mechanism_velocity", "contacts", "joints", "joints_in_space", "ties", "stress", "strain", "mean",
    "principal",
)  # fmt: skip
LEFT_OUT = ("assembly", "model", "disc", "info", "end", "stages", "points", "control")
"""What a result was computed from, and the state from which a motion goes on."""


def arrays(value: object, name: str, deep: int = 0) -> Iterator[tuple[str, np.ndarray]]:
    """Every array that is reached through fields and properties, with its name."""
    if isinstance(value, np.ndarray):
        yield name, value
    elif dataclasses.is_dataclass(value) and deep < 4:
        for field in (*(f.name for f in dataclasses.fields(value)), *COMPUTED):
            if field not in LEFT_OUT:
                try:
                    found = getattr(value, field, None)
                except concio.InputError:  # of the other dimension
                    continue
                yield from arrays(found, f"{name}.{field}", deep + 1)
    elif isinstance(value, Mapping | tuple | list):
        for k, entry in (value.items() if isinstance(value, Mapping) else enumerate(value)):
            yield from arrays(entry, f"{name}[{k}]", deep)


@pytest.mark.parametrize("kind", list(MADE))
def test_no_array_of_a_result_can_be_written_to(kind):
    found = dict(arrays(MADE[kind](), "result"))
    assert len(found) > 3
    assert [name for name, values in found.items() if values.flags.writeable] == []


def test_a_number_that_is_changed_is_refused_and_a_table_is_a_copy():
    result = concio.solve(PILLAR)
    with pytest.raises(ValueError, match="read-only"):
        result.contacts.normal_force[0] += 1.0
    result.reactions["ground"] = (0.0, 0.0)
    assert result.reactions["ground"][1] == pytest.approx(result.total_load[1] * -1.0)
    for name, table in result.tables.all().items():
        for values in table.values():
            values[:] = values[0]
        again = result.tables.all()[name]
        assert name == "reactions" or (again["y"] != table["y"]).any()


def test_what_made_an_array_can_still_write_to_it():
    values = np.zeros(3)
    mechanism = concio.problem.solution.Mechanism(values, 0.0, 0.0)
    values[0] = 1.0
    assert mechanism.velocity[0] == 1.0
