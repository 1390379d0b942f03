r"""Strength of a cell: how much macroscopic stress it carries in a direction, and the whole domain.

For a stress that grows in proportion, Sigma_0 + lambda D, the numbers are those of :mod:`concio.analysis.limit`, of a
cell in place of a wall: the *associated* multiplier, with forces and mechanism, above which no equilibrium exists;
beside it the multiplier that the *Coulomb path* of the cell reaches under growing stress, and that of a certified
Coulomb *collapse state*. Friction is not associated, and the cell, like a wall, may collapse before the associated
bound.

The associated domain as a whole is a polyhedron, found exactly (:mod:`concio.analysis.cells.strength_faces`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.cells.periodic_cell import PeriodicCell, three
from concio.analysis.cells.strength_faces import StrengthFaces, strength_faces
from concio.analysis.entry_point import entry_point
from concio.analysis.lent_compliance import with_compliance
from concio.analysis.limit import coulomb_path, search_collapse
from concio.arguments import strict
from concio.contact.assembly import Assembly
from concio.contact.macroscopic_strain import COMPONENTS
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Progress, ProgressCallback
from concio.read_only import locked, read_only
from concio.representation import short_repr
from concio.solvers.statics.associated_limit import LimitLoad, associated_limit
from concio.solvers.statics.collapse_state import CollapseState
from concio.solvers.statics.existence import find_mechanism
from concio.verdict.cell_verdict import cell_verdict
from concio.verdict.not_standing import BY_A_MECHANISM
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.cell_accessor import StrengthPlots

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class StrengthRay:
    """Strength in one direction of stress.

    Parameters
    ----------
    direction : (3,) array
        D: components xx, yy, xy.
    base : (3,) array
        Stress that acts from the beginning [kN/m2].
    associated : LimitLoad
        Multiplier of the direction with forces and mechanism; above it there is no equilibrium.
    carried : float
        Largest multiplier met on the Coulomb path; ``nan`` where none was followed.
    collapse_shown : bool
        Whether the path is shown to collapse at it; a path that was lost shows only what is carried.
    collapse_state : CollapseState or None
        Certified state in which the cell can begin to move under Coulomb friction, the least found.
    search : str
        What the search for it did.
    """

    direction: Array
    base: Array
    associated: LimitLoad
    carried: float = float("nan")
    collapse_shown: bool = False
    collapse_state: CollapseState | None = None
    search: str = "not asked for"

    @property
    def multiplier(self) -> float:
        """Associated multiplier of the direction."""
        return self.associated.multiplier

    @property
    def stress(self) -> Array:
        """Stress (3,) at the associated multiplier [kN/m2]."""
        acts = self.direction != 0  # an infinite multiple of nothing is nothing
        found: Array = self.base.copy()
        found[acts] += self.multiplier * self.direction[acts]
        return locked(found)

    @property
    def coulomb(self) -> float:
        """Least Coulomb multiplier found: that of the path or of the collapse state; ``nan`` without either."""
        state = self.collapse_state.multiplier if self.collapse_state is not None else np.inf
        low = min(state, self.carried if np.isfinite(self.carried) else np.inf)
        return low if np.isfinite(low) else float("nan")


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class StrengthDomain(Shown):
    """Strength of a cell in some directions, and as a domain.

    Parameters
    ----------
    cell : PeriodicCell
    base : (3,) array
        Stress from which the directions begin [kN/m2].
    rays : tuple of StrengthRay
    domain : StrengthFaces or None
        Half-spaces of the associated domain; None where it was not asked for or has no inside.
    """

    cell: PeriodicCell
    base: Array
    rays: tuple[StrengthRay, ...]
    domain: StrengthFaces | None

    @property
    def faces(self) -> HalfSpaces:
        """Half-spaces D . Sigma <= h around the domain [kN/m2].

        Raises
        ------
        InputError
            They were not asked for, or the domain has no inside.
        """
        if self.domain is None:
            msg = "the half-spaces of the strength domain are not there"
            raise InputError(msg, hint="ask for them with faces=True; without friction the domain has no inside")
        return self.domain.faces

    @property
    def worst(self) -> float:
        """Largest residual, violation or duality gap of all directions."""
        return max((ray.associated.worst for ray in self.rays), default=0.0)

    @property
    def checked(self) -> bool:
        """Whether forces and mechanism prove the multiplier of every direction from both sides."""
        return all(ray.associated.checked for ray in self.rays)

    def strain_rate(self, ray: StrengthRay) -> Array | None:
        """Return the macroscopic strain rate (3,) of the mechanism of a direction, largest entry 1; None without."""
        if ray.associated.mechanism is None:
            return None
        rate = ray.associated.mechanism.velocity[-3:]
        return np.asarray(rate / (float(np.abs(rate).max()) or 1.0))

    @property
    def verdict(self) -> Verdict:
        """What was asked of the cell, what came out, and what was not checked."""
        return cell_verdict(self.cell, None, self, None)

    @property
    def plot(self) -> StrengthPlots:
        """Figures by name; matplotlib is loaded here."""
        plots: StrengthPlots = view(self, "plot")
        return plots

    def table(self) -> dict[str, Array]:
        """Return the directions as columns: direction, multipliers, stress at the bound, strain rate, checks."""
        rays = self.rays
        states = [r.collapse_state for r in rays]
        stress = np.array([r.stress for r in rays]).reshape(-1, 3)
        rates = [self.strain_rate(r) for r in rays]
        rate = np.array([np.full(3, np.nan) if v is None else v for v in rates]).reshape(-1, 3)
        direction = np.array([r.direction for r in rays]).reshape(-1, 3)
        columns = {f"direction_{name}": direction[:, k] for k, name in enumerate(COMPONENTS)}
        columns |= {
            "associated": np.array([r.multiplier for r in rays]),
            "associated_upper": np.array([r.associated.upper for r in rays]),
            "coulomb_carried": np.array([r.carried for r in rays]),
            "coulomb_collapse_shown": np.array([r.collapse_shown for r in rays], dtype=bool),
            "collapse_state": np.array([np.nan if s is None else s.multiplier for s in states]),
        }
        columns |= {f"stress_{name}": stress[:, k] for k, name in enumerate(COMPONENTS)}
        columns |= {f"strain_rate_{name}": rate[:, k] for k, name in enumerate(COMPONENTS)}
        columns["worst_residual"] = np.array([r.associated.worst for r in rays])
        return columns

    def face_table(self) -> dict[str, Array]:
        """Return the half-spaces as columns: a_xx s_xx + a_yy s_yy + a_xy s_xy <= h, the largest |a| being one."""
        faces = self.faces
        size = np.abs(faces.normals).max(axis=1)
        columns = {f"a_{name}": faces.normals[:, k] / size + 0.0 for k, name in enumerate(COMPONENTS)}
        columns["h"] = faces.offsets / size + 0.0
        return columns

    def summary(self) -> dict[str, Any]:
        """Return the numbers as plain types."""
        domain = self.domain
        return {
            "title": self.cell.model.title,
            "engine": self.cell.model.engine,
            "base": self.base.tolist(),
            "directions": [
                {
                    "direction": r.direction.tolist(),
                    "associated": r.multiplier,
                    "associated_upper": r.associated.upper,
                    "checked": r.associated.checked,
                    "coulomb_carried": r.carried,
                    "coulomb_collapse_shown": r.collapse_shown,
                    "collapse_state": None if r.collapse_state is None else r.collapse_state.multiplier,
                }
                for r in self.rays
            ],
            "faces": None if domain is None else {name: v.tolist() for name, v in self.face_table().items()},
            "faces_exact": None if domain is None else domain.exact,
            "faces_shortfall": None if domain is None else domain.shortfall,
            "worst": self.worst,
        }


@strict
@entry_point
def strength(
    cell: Model | Assembly | PeriodicCell,
    directions: Sequence[Sequence[float]] | Array | int = (),
    *,
    stress: Sequence[float] = (0.0, 0.0, 0.0),
    coulomb: bool = True,
    faces: bool = True,
    programmes: int = 400,
    progress: ProgressCallback | None = None,
) -> StrengthDomain:
    """Find the strength of a periodic cell, in directions of stress and as a domain.

    Parameters
    ----------
    cell : Model or Assembly
        With periods.
    directions : sequence of (3,), or int
        Directions of stress xx, yy, xy; a number stands for as many all around, evenly spread.
    stress : (3,)
        Stress from which they begin, such as a vertical pressure (0, -100, 0) [kN/m2].
    coulomb : bool
        Whether the Coulomb path is followed and collapse states are searched for in each direction.
    faces : bool
        Whether the half-spaces of the domain are found.
    programmes : int
        Linear programmes spent on them at most. Bonds need some thirty to be exact; rubble may have hundreds of
        half-spaces, and the result says how much was left open.
    progress : callable, optional

    Raises
    ------
    InputError
        The model is not a cell, or a direction is none.
    NoEquilibriumError
        The initial stress cannot be carried.

    Examples
    --------
    Blocks in running bond are 0.25 m long and 0.125 m high. Under a vertical pressure of 100 kN/m2 and none along
    the beds they carry a shear stress of 0.6 * 100 / (1 + 0.6 * 2 * 0.125 / 0.25) = 37.5 kN/m2:

    >>> import concio
    >>> cell = concio.cell(bond="running", block_size=(0.25, 0.125), friction=0.6, block="rigid")
    >>> found = concio.strength(cell, [(0.0, 0.0, 1.0)], stress=(0.0, -100.0, 0.0), coulomb=False, faces=False)
    >>> round(found.rays[0].associated.multiplier, 6)
    37.5
    """
    own = PeriodicCell.of(cell)
    base = three(stress, "stress")
    wanted = _directions(directions)
    dead = own.problem(stress=base)
    if base.any() and find_mechanism(dead) is not None:
        msg = f"the stress ({base[0]:g}, {base[1]:g}, {base[2]:g}) kN/m2 alone is beyond the strength: {BY_A_MECHANISM}"
        raise NoEquilibriumError(msg, hint="begin from another stress")
    rays = []
    for k, direction in enumerate(wanted):
        if progress is not None and progress(Progress("strength", k, 0.0, f"direction {k + 1} of {len(wanted)}")):
            break
        rays.append(_ray(own, dead, base, direction, coulomb=coulomb, progress=progress))
    known = [ray.associated for ray in rays]
    found = strength_faces(own, known, most=programmes, progress=progress) if faces else None
    return StrengthDomain(own, base, tuple(rays), found)


def _ray(
    cell: PeriodicCell,
    dead: ContactProblem,
    base: Array,
    direction: Array,
    *,
    coulomb: bool,
    progress: ProgressCallback | None,
) -> StrengthRay:
    live = cell.load(direction)
    bound = associated_limit(dead, live)
    if not coulomb or not 0 < bound.multiplier < np.inf:
        none = "not asked for" if not coulomb else "not tried: no stress is the last, or none is within the strength"
        return StrengthRay(direction, base, bound, search=none)
    problem, _ = with_compliance(dead, live)
    path, shown = coulomb_path(problem, live, progress=progress)
    state, said = search_collapse(dead, live)
    return StrengthRay(direction, base, bound, path.peak, shown, state, said)


def _directions(given: Sequence[Sequence[float]] | Array | int) -> Array:
    """Return directions (k, 3).

    Raises
    ------
    InputError
        One of them is not three finite numbers, or zero.
    """
    if isinstance(given, int | np.integer) and not isinstance(given, bool):
        if given < 1:
            msg = f"directions = {given} must be at least 1"
            raise InputError(msg)
        return spread(int(given))
    if isinstance(given, str | bool | float):
        msg = f"directions = {given!r} are not directions"
        raise InputError(msg, hint="give a list of (xx, yy, xy), or how many")
    found = [three(d, f"direction {k}") for k, d in enumerate(given, 1)]
    for k, d in enumerate(found, 1):
        if not d.any():
            msg = f"direction {k} is zero"
            raise InputError(msg, hint="give a stress that can grow, for example (0, 0, 1)")
    return np.array(found).reshape(-1, 3)


def spread(count: int) -> Array:
    """Return directions (count, 3) of length one, evenly spread over the sphere (golden spiral)."""
    k = np.arange(count) + 0.5
    height, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    around = np.sqrt(1.0 - height**2)
    return np.column_stack([around * np.cos(turn), around * np.sin(turn), height])
