"""From a model to its contact problem: detect interfaces, mesh, couple, load, support."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.arguments import closest, strict
from concio.contact.expansion import add_expansions, free_strains
from concio.contact.factors import load_factor
from concio.contact.geometry import GEOMETRIES
from concio.contact.inertia import masses
from concio.contact.loads import load_vectors
from concio.contact.macroscopic_strain import strain_groups
from concio.contact.pairs import CONTACT_MODELS, Pairs, pair_laws
from concio.contact.point_pairs import add_point_pairs
from concio.contact.reference import Reference
from concio.contact.separate import surroundings
from concio.contact.supports import Supported, apply_supports, moved_obstacles
from concio.contact.ties import add_ties
from concio.errors import InputError
from concio.fem.discretisation import Discretisation
from concio.model.interfaces.detect import Detection
from concio.model.model import Load, Model, require_model
from concio.problem.contact_problem import ContactProblem, Laws
from concio.representation import short_repr

Array = np.ndarray

PRESTRESS = "prestress"
"""Name of the factor of the prestress of ties, which is not a load group: 1 but where a path puts it on."""

ROUNDED = 1e-12
"""Share of the size of a model up to which an initial gap is rounding of coordinates, and none."""

TIE = CONTACT_MODELS.index("tie")


@short_repr
@dataclass(frozen=True, eq=False)
class Assembly:
    """A model turned into arrays; load factors give :class:`ContactProblem` objects.

    Parameters
    ----------
    model : Model
    detection : Detection
        Interfaces, and what was noticed while looking for them.
    disc : Discretisation
    pairs : Pairs
    laws : Laws
    supported : Supported
    K : (N_all, N_all) CSR array
        Stiffness of all bodies before supports.
    loads : dict of (N_all,) arrays
        Nodal forces of each load group [kN].
    moved : dict of ((m,), (m, d-1)) arrays
        Change of gap and of tangential position by moved obstacles and rigid bodies that expand, for each group [m].
    expands : dict of (N_all,) arrays
        Displacements of elastic bodies that expand freely, for each group that changes temperatures [m].
    lent_compliance : float
        Normal compliance added to hard joints between bodies that do not deform, a pair of mean area [m/kN]; 0 where
        none was (:mod:`concio.analysis.lent_compliance`).
    first_laws : Laws, optional
        Where joint laws have changed with what joints underwent, what they were at first.
    """

    model: Model
    detection: Detection
    disc: Discretisation
    pairs: Pairs
    laws: Laws
    supported: Supported
    K: sp.csr_array
    loads: Mapping[str, Array]
    moved: Mapping[str, tuple[Array, Array]]
    lent_compliance: float = 0.0
    expands: Mapping[str, Array] = field(default_factory=dict)
    first_laws: Laws | None = None

    def with_loads(self, loads: Sequence[Load]) -> Assembly:
        """Return the same structure under other loads; meshes, joints and stiffness, which no load changes, are shared.

        Parameters
        ----------
        loads : sequence of Load
            In place of those of the model.

        Raises
        ------
        InputError
            A load names a body that does not exist, or loads nothing; or a compliance was given to hard joints, which
            depends on the loads.

        Examples
        --------
        >>> import concio
        >>> pillar = concio.assemble(concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=1.0))
        >>> twice = pillar.with_loads([*pillar.model.loads, *pillar.model.loads])
        >>> twice.K is pillar.K, float(twice.load().max() / pillar.load().max())
        (True, 2.0)
        """
        if self.lent_compliance:
            msg = "this assembly has a compliance that was chosen for its loads"
            raise InputError(msg, hint="take the assembly that concio.assemble returns")
        model = replace(self.model, loads=tuple(loads))
        disc = replace(self.disc, model=model)
        return replace(self, model=model, disc=disc, loads=load_vectors(disc))

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups that load factors scale."""
        return tuple(dict.fromkeys([*self.loads, *self.moved, *self.supported.imposed, *self.expands]))

    @cached_property
    def _free(self) -> tuple[sp.csr_array, sp.csr_array, sp.csr_array]:
        """K (N, N), C_n (m, N) and C_t (m (d-1), N) of the free unknowns."""
        T = self.supported.T
        return sp.csr_array(T.T @ self.K @ T), sp.csr_array(self.pairs.C_n @ T), sp.csr_array(self.pairs.C_t @ T)

    @cached_property
    def prestress(self) -> Array:
        """Part of the initial gap of each pair (m,) that the prestress of ties makes, none positive [m]."""
        shortened = np.zeros(len(self.pairs))
        shortened[self.ties] = [-t.prestress / t.stiffness for t in self.model.ties]
        return shortened

    @cached_property
    def ties(self) -> Array:
        """Numbers (k,) of the pairs that stand for the ties of the model, in its order."""
        return np.flatnonzero(self.pairs.rule == TIE)

    def elongations(self, q: Array, factors: Mapping[str, float] | None = None) -> Array:
        """Return how far the ties (k,) are stretched, of the free unknowns q (N,), prestress not counted [m]."""
        closing = self.pairs.C_n @ self.displacement(q, factors)
        for group, (normal, _) in self.moved.items():
            closing = closing + load_factor(factors, group) * normal
        found: Array = -closing[self.ties]
        return found

    def imposed(self, factors: Mapping[str, float] | None = None) -> Array:
        """Return the imposed part u0 (N_all,) of the displacements under load factors [m]."""
        u0 = np.zeros(self.disc.unknowns)
        for group, vector in self.supported.imposed.items():
            u0 += load_factor(factors, group) * vector
        return u0

    def expansion(self, factors: Mapping[str, float] | None = None) -> Array:
        """Return the displacements (N_all,) without stress under load factors, by changes of temperature [m]."""
        u = np.zeros(self.disc.unknowns)
        for group, vector in self.expands.items():
            u += load_factor(factors, group) * vector
        return u

    def load(self, factors: Mapping[str, float] | None = None) -> Array:
        """Return the nodal forces (N_all,) under load factors [kN]."""
        f = np.zeros(self.disc.unknowns)
        for group, vector in self.loads.items():
            f += load_factor(factors, group) * vector
        return f

    def problem(
        self, factors: Mapping[str, float] | None = None, *, like: ContactProblem | None = None
    ) -> ContactProblem:
        """Return the contact problem under load factors; a group that is not named has factor 1 (a strain 0).

        Parameters
        ----------
        factors : mapping of str to float, optional
            That of :data:`PRESTRESS` multiplies the prestress of ties, besides loads of that group.
        like : ContactProblem, optional
            A problem of this assembly under other factors: its matrices are shared, which no factor changes.

        Raises
        ------
        InputError
            A factor names a group that does not exist.
        """
        for group in factors or {}:
            if group not in self.groups and group != PRESTRESS:
                msg = f"there is no load group '{group}'"
                raise InputError(msg, hint=closest(group, self.groups, names="groups"))
        T = self.supported.T
        u0 = self.imposed(factors)
        C_n, C_t = self.pairs.C_n, self.pairs.C_t
        gap = self.pairs.gap + (load_factor(factors, PRESTRESS) - 1.0) * self.prestress + C_n @ u0
        origin = -(C_t @ u0).reshape(len(gap), self.model.dim - 1)
        for group, (normal, tangential) in self.moved.items():
            gap = gap + load_factor(factors, group) * normal
            origin = origin - load_factor(factors, group) * tangential
        loads = T.T @ self.load(factors)
        f = loads - T.T @ (self.K @ (u0 - self.expansion(factors)))
        if like is not None:
            return replace(like, f=f, load=loads, gap=gap, slip_origin=origin)
        return ContactProblem(
            K=self._free[0],
            f=f,
            load=loads,
            C_n=self._free[1],
            C_t=self._free[2],
            gap=gap,
            laws=self.laws,
            R=self.supported.R,
            bodies=self.supported.bodies,
            slip_origin=origin,
            area=self.pairs.area,
            inertia=self.inertia,
            engine=self.model.engine,
        )

    @cached_property
    def inertia(self) -> sp.csr_array:
        """Mass matrix of the free unknowns (N, N) [t]."""
        T = self.supported.T
        return sp.csr_array(T.T @ masses(self.disc) @ T)

    def displacement(self, q: Array, factors: Mapping[str, float] | None = None) -> Array:
        """Return the displacements (N_all,) of all bodies from the free unknowns q (N,) [m]."""
        u: Array = self.supported.T @ q + self.imposed(factors)
        return u


def _without_rounding(model: Model, pairs: Pairs) -> Pairs:
    """Return pairs of which none is apart by what rounding of coordinates leaves: such a pair would not be bonded."""
    around = surroundings(model)
    largest = np.maximum(np.abs(around.low), np.abs(around.high)).max(axis=1)
    bodies = np.column_stack([pairs.body_a, pairs.body_b])
    rounding = ROUNDED * around.size[bodies].min(axis=1) + 4 * np.finfo(float).eps * largest[bodies].max(axis=1)
    return replace(pairs, gap=np.where(np.abs(pairs.gap) <= rounding, 0.0, pairs.gap))


def _no_pairs(disc: Discretisation) -> Pairs:
    """Return the pairs of a model in which no two bodies touch and supports or ties hold the blocks: none."""
    d = disc.dim
    number, value, vector = np.zeros(0, dtype=int), np.zeros(0), np.zeros((0, d))
    operator = sp.csr_array((0, disc.unknowns))
    return Pairs(
        body_a=number, body_b=number, interface=number, point=vector, normal=vector, tangents=np.zeros((0, d - 1, d)),
        length=value, area=value, gap=value, law=number, law_names=tuple(disc.model.laws), C_n=operator, C_t=operator,
        rule=number,
    )  # fmt: skip


def as_assembly(model: Model | Assembly, *, jointless: bool = False, periodic: bool = False) -> Assembly:
    """Return the assembly of a model; an assembly as it is.

    Parameters
    ----------
    model : Model or Assembly
    jointless : bool
        Whether a model in which nothing can open, slip or go slack will do.
    periodic : bool
        Whether a periodic cell will do, which has no loads of its own.

    Raises
    ------
    GeometryError, InputError
        As :func:`assemble`; or there is no joint and no tie; or the model is a periodic cell.
    """
    assembly = model if isinstance(model, Assembly) else assemble(model)
    if assembly.model.periods is not None and not periodic:
        msg = "this is a periodic cell, which has no loads of its own"
        hint = "use 'concio cell', or concio.homogenise, concio.strength and concio.strain_path"
        raise InputError(msg, hint=hint)
    if not jointless and not len(assembly.pairs):
        msg = "there is no joint and no tie: nothing can open or slip, and the answer is linear in the loads"
        raise InputError(msg, hint="solve one load step, with concio.solve or 'concio run'")
    return assembly


@strict
def assemble(model: Model) -> Assembly:
    """Return the arrays of a model.

    Raises
    ------
    GeometryError
        Bodies overlap.
    InputError
        What is given is not a model (the name of a file, for example); nothing holds the model; no two bodies touch and
        no support or tie holds a block; a load or support is not usable.

    Examples
    --------
    A pillar of 4 rigid blocks has 3 unknowns a block and 2 contact pairs a joint. The assembly is meshed once and
    solved for several loads:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=1.0)
    >>> assembly = concio.assemble(pillar)
    >>> assembly.K.shape, len(assembly.pairs)
    ((12, 12), 8)
    >>> for factor in (0.24, 0.26):
    ...     print(factor, concio.solve(assembly, factors={"live": factor}, on_failure="return").status.name)
    0.24 SOLVED
    0.26 NO_EQUILIBRIUM
    """
    require_model(model)
    fixed = {"", *(b.name for b in model.bodies if b.kind == "fixed")}  # a tie without a body ends at a fixed point
    periodic = model.periods is not None
    tied = any({t.body_a, t.body_b} & fixed for t in model.ties)
    if not periodic and len(fixed) == 1 and not model.supports and not tied:
        msg = "nothing holds the structure: there is no fixed body, no support and no tie to a fixed point"
        raise InputError(msg, hint="add a fixed body such as the ground, or a [[supports]] entry")
    if not model.free_bodies:
        msg = "every body is fixed: there is nothing to compute"
        raise InputError(msg, hint="make the blocks elastic or rigid")
    return _arrays(model, Reference.described(model))


def assemble_beside(known: Assembly, model: Model) -> Assembly:
    """Return the arrays of a model that may differ from one that was assembled in loads, materials, ties and laws.

    Interfaces are found once: most of the time of an assembly in space. Where the bodies, the distances within which
    they touch or what is asked of points without area are others, this is :func:`assemble`.

    Raises
    ------
    GeometryError, InputError
        As :func:`assemble`.
    """
    old = known.model
    if model.bodies is not old.bodies or _found_by(model) != _found_by(old) or model.periods is not None:
        return assemble(model)
    disc = known.disc.of_same_meshes(model)
    if disc is None:
        return _arrays(model, Reference.described(model, detection=known.detection))
    return _arrays(model, Reference(model, known.detection, disc))


def _found_by(model: Model) -> tuple[object, ...]:
    """Return what interfaces are found by beside the bodies."""
    areal = {name: (law.compressive_strength is None, bool(law.changes)) for name, law in model.laws.items()}
    return model.gap_tolerance, model.gap_reach, model.rules, areal


def _arrays(model: Model, reference: Reference) -> Assembly:
    """Return the arrays of a model whose interfaces and meshes are known."""
    periodic = model.periods is not None
    detection, disc, geometry = reference.detection, reference.disc, GEOMETRIES[model.dim]
    held = bool(model.ties) or bool({s.body for s in model.supports} & {b.name for b in model.free_bodies})
    if not detection.interfaces and not held:
        msg = "no two bodies touch: there is no interface at all"
        if detection.near_misses:
            first = detection.near_misses[0].sentence
            others = len(detection.near_misses) - 1
            msg = f"no joint was made at all: {first}" + (f"; {others} more such places" if others else "")
        raise InputError(msg, hint="look at the model with 'concio check'; raise gap_tolerance if the drawing has gaps")
    pairs = geometry.pairs(disc, detection) if detection.faces else _no_pairs(disc)
    pairs = _without_rounding(model, add_point_pairs(disc, pairs, detection.point_contacts, len(detection.faces)))
    laws = pair_laws(model, pairs)
    pairs, laws = add_ties(reference, pairs, laws)
    supported = apply_supports(disc)
    moved = strain_groups(pairs, detection.segments) if periodic else moved_obstacles(disc, pairs)
    add_expansions(disc, pairs, moved)
    return Assembly(
        model=model,
        detection=detection,
        disc=disc,
        pairs=pairs,
        laws=laws,
        supported=supported,
        K=disc.stiffness(),
        loads=load_vectors(disc),
        moved=moved,
        expands=free_strains(disc),
    )
