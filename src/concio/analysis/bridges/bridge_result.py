"""What is known of a vehicle on a bridge: an immutable result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from concio.analysis.bridges.mexe import Mexe
from concio.analysis.bridges.service import ServiceState
from concio.analysis.bridges.sweep import FINE, Standing, least
from concio.analysis.bridges.variants import PASSIVE, SPREAD, WEIGHT, Change
from concio.analysis.limit_result import LimitResult
from concio.contact.assembly import Assembly
from concio.model.crossing import Vehicle
from concio.model.model import Model
from concio.model.road.earth import width_used
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.representation import short_repr
from concio.verdict.bridge_verdict import bridge_lines, bridge_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class Bracket:
    """A position with its associated bound and what Coulomb friction carries there."""

    standing: Standing
    limit: LimitResult


@short_repr
@dataclass(frozen=True)
class Coulomb:
    """What became of the required multiple of the vehicle at a position, in one step with Coulomb friction."""

    position: float
    direction: str
    status: Status


@dataclass(frozen=True, eq=False)
class BridgeResult(Shown):
    """Load factors of a vehicle on a bridge.

    Parameters
    ----------
    model : Model
        With the vehicle where it is worst.
    required : float
        Load factor that was asked for.
    standings : tuple of Standing
        Every position that was examined, by direction and from left to right.
    brackets : tuple of Bracket
        Of the worst positions, the worst first.
    coulomb : tuple of Coulomb
        Coulomb states under ``required`` times the vehicle.
    parts : mapping of str to float
        Associated multiplier at the worst position of the ring alone, with the weight of the fill, with the spread of
        the load, and with the pressure of the soil.
    without_soil : Standing or None
        Worst position where soil presses nothing; None where the bridge does not stand then.
    changes : tuple of Change
        Sensitivities, the largest first.
    others : mapping of str to Standing or None
        Worst position of further vehicles.
    service : ServiceState
        Under the vehicle at its own weight, at its worst position.
    settled : ServiceState or None
        The same with settlements.
    settlements : mapping of str to float
        [m].
    mexe : Mexe or None
        What the formula gives, where it applies.
    fine : float
        Distance to which the worst positions were refined [m].
    apart : mapping of float to float
        Of two vehicles, the least multiplier for each distance between them that was examined [m].
    """

    model: Model
    required: float
    standings: tuple[Standing, ...]
    brackets: tuple[Bracket, ...]
    coulomb: tuple[Coulomb, ...]
    parts: Mapping[str, float]
    without_soil: Standing | None
    changes: tuple[Change, ...]
    others: Mapping[str, Standing | None]
    service: ServiceState
    settled: ServiceState | None = None
    settlements: Mapping[str, float] = field(default_factory=dict)
    mexe: Mexe | None = None
    fine: float = FINE
    apart: Mapping[float, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        return "\n".join(bridge_lines(self))

    @property
    def verdict(self) -> Verdict:
        """The answer with its question."""
        return bridge_verdict(self)

    @property
    def plot(self) -> Any:
        """Figures by name: ``found.plot.curve()``."""
        return view(self, "plot")

    @property
    def assembly(self) -> Assembly:
        """The bridge with the vehicle where it is worst."""
        return self.service.result.assembly

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle, where it is worst."""
        assert self.model.vehicle is not None
        return self.model.vehicle

    @property
    def worst(self) -> Standing:
        """The position of the least multiplier."""
        return least(self.standings, 1, 0.0)[0]

    @property
    def design(self) -> float:
        """Least multiplier that Coulomb friction was shown to carry at the worst positions; nan where none was."""
        known = [b.limit.design for b in self.brackets if not np.isnan(b.limit.design)]
        return min(known) if known else float("nan")

    @property
    def axle(self) -> float:
        """Weight of the heaviest axle at the design multiplier, with all of its factors [kN]; nan without axles."""
        vehicle = self.vehicle
        if not vehicle.points:
            return float("nan")
        return self.design * vehicle.heaviest.load * vehicle.dynamic * vehicle.factor

    @property
    def permissible_axle(self) -> float:
        """Heaviest axle that keeps the required load factor, without dynamic and partial factors [kN]; or nan."""
        if not self.vehicle.points:
            return float("nan")
        return self.design / self.required * self.vehicle.heaviest.load

    @property
    def refuted(self) -> tuple[Coulomb, ...]:
        """Positions at which the required multiple is shown not to be in equilibrium."""
        return tuple(c for c in self.coulomb if c.status in PROVEN_FAILURES)

    @property
    def open(self) -> tuple[Coulomb, ...]:
        """Positions at which neither was shown."""
        return tuple(c for c in self.coulomb if c.status is not Status.SOLVED and c.status not in PROVEN_FAILURES)

    @property
    def owed_to_soil(self) -> float:
        """Share of the associated multiplier that is owed to the pressure of the soil, at the worst position."""
        return 1.0 - self.parts[SPREAD] / self.parts[PASSIVE]

    @property
    def owed_to_spread(self) -> float:
        """Share that is owed to the spread of the load through the fill, at the worst position."""
        return (self.parts[SPREAD] - self.parts[WEIGHT]) / self.parts[PASSIVE]

    @property
    def width(self) -> tuple[float, str]:
        """Width that was computed [m], and by which rule."""
        assert self.model.fill is not None
        return width_used(self.model, self.model.fill, self.model.vehicle)

    def curve(self) -> dict[str, Array]:
        """Return position, direction, multiplier and load on the masonry of every standing."""
        return {
            "direction": np.array([s.direction for s in self.standings]),
            "position [m]": np.array([s.position for s in self.standings]),
            "load factor": np.array([s.multiplier for s in self.standings]),
            "upper bound": np.array([s.limit.upper for s in self.standings]),
            "load on the masonry [kN]": np.array([s.on_masonry for s in self.standings]),
            "load on fixed blocks [kN]": np.array([s.elsewhere for s in self.standings]),
        }

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        worst, vehicle = self.worst, self.vehicle
        width, by = self.width
        state, times = self.service, vehicle.dynamic * vehicle.factor
        return {
            "verdict": self.verdict.as_dict(),
            "vehicle": {"name": vehicle.name,
                        "heaviest_axle": times * vehicle.heaviest.load if vehicle.points else None,
                        "uniform_load": times * max(vehicle.uniform) if vehicle.uniform else None,
                        "total": vehicle.total,
                        "dynamic": vehicle.dynamic, "factor": vehicle.factor, "source": vehicle.source},
            "required": self.required,
            "load_factor": {"design": _finite(self.design), "associated": _finite(worst.multiplier),
                            "checked": worst.limit.checked},
            "worst": {"position": worst.position, "direction": worst.direction, "on_masonry": worst.on_masonry,
                      "loaded": None if worst.loaded is None else [list(part) for part in worst.loaded]},
            "axle": _finite(self.axle),
            "permissible_axle": _finite(self.permissible_axle),
            "brackets": [
                {"position": b.standing.position, "direction": b.standing.direction,
                 "associated": _finite(b.standing.multiplier), "design": _finite(b.limit.design)}
                for b in self.brackets
            ],
            "coulomb_states": {"asked": len(self.coulomb), "refuted": [c.position for c in self.refuted],
                               "open": [c.position for c in self.open]},
            "parts": {name: _finite(v) for name, v in self.parts.items()},
            "without_soil": None if self.without_soil is None else _finite(self.without_soil.multiplier),
            "owed_to_soil": _finite(self.owed_to_soil),
            "owed_to_spread": _finite(self.owed_to_spread),
            "width": {"width": width, "by": by},
            "sensitivity": [
                {"name": c.name, "unit": c.unit, "low": c.low, "high": c.high, "at_low": _finite(c.at_low),
                 "at_high": _finite(c.at_high)} for c in self.changes
            ],
            "others": {n: None if s is None else {"load_factor": _finite(s.multiplier), "position": s.position}
                       for n, s in self.others.items()},
            "apart": [{"distance": d, "load_factor": _finite(m)} for d, m in self.apart.items()],
            "service": _state(state),
            "settled": None if self.settled is None else {**_state(self.settled), "by": dict(self.settlements)},
            "mexe": None if self.mexe is None else {"axle": _finite(self.mexe.axle), "limits": list(self.mexe.limits)},
            "positions": len(self.standings),
        }  # fmt: skip


def _state(state: ServiceState) -> dict[str, Any]:
    return {
        "status": state.status.name.lower(), "open_joints": state.open_joints, "slipping": state.slipping,
        "crushed": state.crushed, "largest_pressure": _finite(state.largest_pressure),
        "deflection": _finite(state.deflection), "soil": _finite(state.soil),
    }  # fmt: skip


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
