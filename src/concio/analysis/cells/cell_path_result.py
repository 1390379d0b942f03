"""What the path of a cell consists of: steps with macroscopic strain and stress, named events, tangent moduli."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cells.moduli import Moduli, homogenise
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.path_result import NamedEvent
from concio.analysis.result import Result
from concio.contact.macroscopic_strain import COMPONENTS, STRAINS
from concio.model.stages import Stage
from concio.problem.certificate import Certificate
from concio.problem.solution import Status, judge
from concio.read_only import locked, read_only
from concio.representation import short_repr
from concio.solvers.path.path_state import LinearPath, PathState, path_kinematics
from concio.solvers.path.record import Outcome
from concio.verdict.cell_verdict import cell_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.cell_accessor import CellPathPlots

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class CellStep:
    """One point of the path of a cell.

    Parameters
    ----------
    stage : int
    parameter : float
        0 at the beginning of the stage, 1 where its strains and stresses are reached.
    strain : (3,) array
        Macroscopic strain xx, yy and engineering shear xy.
    stress : (3,) array
        Macroscopic stress xx, yy, xy, from the contact forces [kN/m2].
    state : PathState
        Displacements of the bodies and states of the pairs.
    certificate : Certificate
        Of the step from the point before, macroscopic equilibrium included.
    stored : float
        Energy stored in bodies and compliant joints [kN m].
    """

    stage: int
    parameter: float
    strain: Array
    stress: Array
    state: PathState
    certificate: Certificate
    stored: float

    @property
    def counts(self) -> dict[str, int]:
        """How many pairs are open, slip or are crushed; the others are closed and stick."""
        s = self.state.states
        return {"open": int(s.open.sum()), "slip": int((s.slips & s.closed).sum()), "crushed": int(s.crushed.sum())}


@short_repr
@dataclass(frozen=True, eq=False)
class CellPath(Shown):
    """Response of a cell along a path of macroscopic strains and stresses.

    Parameters
    ----------
    cell : PeriodicCell
    stages : tuple of Stage
    steps : tuple of CellStep
        Every corner of the exact path; between two of them everything is linear.
    events : tuple of NamedEvent
    outcomes : tuple of Outcome
        How each stage ended; stages after one that did not reach its end were not begun.
    notes : tuple of str
        What the program did that was not asked for.
    """

    cell: PeriodicCell
    stages: tuple[Stage, ...]
    steps: tuple[CellStep, ...]
    events: tuple[NamedEvent, ...]
    outcomes: tuple[Outcome, ...]
    notes: tuple[str, ...]

    @cached_property
    def strain(self) -> Array:
        """Macroscopic strains (n, 3) of all steps: xx, yy and engineering shear xy."""
        return locked(np.array([s.strain for s in self.steps]))

    @cached_property
    def stress(self) -> Array:
        """Macroscopic stresses (n, 3) of all steps [kN/m2]."""
        return locked(np.array([s.stress for s in self.steps]))

    @property
    def complete(self) -> bool:
        """True when every stage reached its end."""
        return len(self.outcomes) == len(self.stages) and all(o is Outcome.REACHED for o in self.outcomes)

    @property
    def verdict(self) -> Verdict:
        """What was asked of the cell, how far its path came, and what was not begun."""
        return cell_verdict(self.cell, None, None, self)

    @property
    def certificate(self) -> float:
        """Worst certificate entry of all steps."""
        return max((s.certificate.worst for s in self.steps), default=0.0)

    @cached_property
    def energy_error(self) -> float:
        """Largest |work - stored - dissipated| of all steps, relative to the largest work or stored energy.

        Where joints open without work, to a millionth of what the displacements could store.
        """
        gap = max(abs(s.state.work - s.state.dissipation - s.stored) for s in self.steps)
        size = max(abs(s.state.work) + s.stored for s in self.steps)
        K = abs(self.cell.problem(free=(False,) * 3).K)
        could = max(float(np.abs(s.state.displacement) @ (K @ np.abs(s.state.displacement))) for s in self.steps)
        size = max(size, 1e-6 * could)
        return gap / size if size else 0.0

    def moduli(self, step: int = -1) -> Moduli:
        """Return the tangent moduli of the stretch of the path that ends at a step, joints in their states there."""
        states = self.steps[step].state.states
        return homogenise(self.cell, contact=states.normal, sliding=states.sign)

    def result(self, step: int = -1) -> Result:
        """Return one step as a :class:`concio.Result`, its strain as load factors.

        Displacements are those of the bodies of the cell, the macroscopic strain included; the certificate is that of
        the step, whose slips count from the step before.
        """
        chosen = self.steps[step]
        factors = {name: float(v) for name, v in zip(STRAINS, chosen.strain, strict=True)}
        state = chosen.state
        problem = self.cell.assembly.problem(factors)
        judged = judge(problem, state.displacement, state.normal_force, state.friction_force, method="path")
        status = Status.SOLVED if chosen.certificate.certified else Status.GAVE_UP
        moved = path_kinematics(LinearPath(problem, np.zeros(problem.unknowns)), state)
        solution = replace(judged, kinematics=moved, certificate=chosen.certificate, status=status)
        return Result(self.cell.assembly, factors, solution, {})

    @property
    def plot(self) -> CellPathPlots:
        """Figures by name; matplotlib is loaded here."""
        plots: CellPathPlots = view(self, "plot")
        return plots

    def table(self) -> dict[str, Array]:
        """Return the steps as columns: stage, parameter, strains, stresses [kN/m2], pairs by state, energies [kN m]."""
        columns = {
            "stage": np.array([self.stages[s.stage].name for s in self.steps]),
            "parameter": np.array([s.parameter for s in self.steps]),
        }
        columns |= {f"strain_{name}": self.strain[:, k] for k, name in enumerate(COMPONENTS)}
        columns |= {f"stress_{name}": self.stress[:, k] for k, name in enumerate(COMPONENTS)}
        for word in ("open", "slip", "crushed"):
            columns[f"{word}_pairs"] = np.array([s.counts[word] for s in self.steps])
        columns["work"] = np.array([s.state.work for s in self.steps])
        columns["stored"] = np.array([s.stored for s in self.steps])
        columns["dissipated"] = np.array([s.state.dissipation for s in self.steps])
        return columns

    def summary(self) -> dict[str, Any]:
        """Return the numbers of the path as plain types."""
        last = self.steps[-1]
        return {
            "title": self.cell.model.title,
            "engine": self.cell.model.engine,
            "stages": [_stage(s) for s in self.stages],
            "outcomes": [o.name.lower() for o in self.outcomes],
            "complete": self.complete,
            "steps": len(self.steps),
            "events": len(self.events),
            "strain": last.strain.tolist(),
            "stress": last.stress.tolist(),
            "pairs": last.counts,
            "certificate": self.certificate,
            "energy_error": self.energy_error,
            "notes": list(self.notes),
        }


def _stage(stage: Stage) -> Mapping[str, Any]:
    return {"name": stage.name, "factors": dict(stage.factors)}
