"""The result of one load step: an immutable value with named parts, and the numbers people ask for first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.analysis.contacts import Contacts, JointResultants, joint_resultants
from concio.analysis.joint_motion import JointMotion
from concio.analysis.joints_in_space import SpaceResultants, joint_resultants_in_space
from concio.analysis.step_numbers import step_numbers
from concio.analysis.stress import Stress
from concio.analysis.tie_forces import TieForces, tie_forces
from concio.arguments import closest
from concio.contact.assembly import Assembly
from concio.contact.factors import load_factor
from concio.contact.outline_gaps import WEIGHTED, outline_gaps
from concio.display import Units
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.rigid import rigid_operator, swept
from concio.model.model import Model
from concio.problem.certificate import Certificate
from concio.problem.solution import Mechanism, Solution, Status, pair_states
from concio.read_only import locked
from concio.solvers.statics.self_stress import SelfStress
from concio.solvers.statics.sufficient import SufficientCondition, sufficient_condition
from concio.verdict.step_verdict import result_lines, self_stress, step_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.accessor import Plots
    from concio.post.result_tables import Tables

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Result(Shown):
    """Answer of one load step, with what it was computed from.

    Parameters
    ----------
    assembly : Assembly
        The discretised model.
    factors : mapping of str to float
        Load factors of this step; groups not named have 1.
    solution : Solution
        What the solver found, judged against the original equations.
    seconds : mapping
        ``total``, ``assemble``, ``solve`` [s].
    lent_compliance : float
        Normal compliance with which hard joints between rigid bodies were solved, a pair of mean area [m/kN]; 0 where
        there are none. The answer of a solved step is its limit for stiff joints; where there is none, ``assembly``
        holds the compliance.
    engine : str
        What factorised the linear systems ("superlu", "pardiso"), where the method leaves the choice; else empty.
    broken_ties : tuple of (str, float)
        Ties that were stretched to where they break, with how far they would be [m]; ``assembly`` is without them.
    """

    assembly: Assembly
    factors: Mapping[str, float]
    solution: Solution
    seconds: Mapping[str, float]
    lent_compliance: float = 0.0
    engine: str = ""
    broken_ties: tuple[tuple[str, float], ...] = ()

    def __repr__(self) -> str:
        return "\n".join(result_lines(self))

    @property
    def model(self) -> Model:
        """The model that was solved."""
        return self.assembly.model

    @property
    def status(self) -> Status:
        """Outcome; its value is a sentence."""
        return self.solution.status

    @property
    def solved(self) -> bool:
        """True for a certified equilibrium."""
        return self.solution.solved

    @property
    def certificate(self) -> Certificate:
        """Residuals of the answer, computed from the original equations."""
        return self.solution.certificate

    @property
    def method(self) -> str:
        """Name of the method that produced the answer."""
        return self.solution.method

    @property
    def solved_by(self) -> str:
        """The method, and the engine of its linear systems where that is not the usual one."""
        return f"{self.method} with {self.engine}" if self.engine not in ("", "superlu") else self.method

    @property
    def mechanism(self) -> Mechanism | None:
        """The motion that proves that the loads are not carried; None for other outcomes and proofs."""
        return self.solution.mechanism

    @cached_property
    def displacement(self) -> Array:
        """Displacements of all unknowns (N_all,), body after body [m].

        Node by node in the order of the axes; of a rigid body the displacement of its centroid and its rotation times
        its reach (:mod:`concio.kinematics.rigid`).
        """
        return locked(self.assembly.displacement(self.solution.displacement, self.factors))

    @cached_property
    def mechanism_velocity(self) -> Array | None:
        """Velocity of the mechanism on all unknowns (N_all,), largest entry 1; None where there is none."""
        if self.mechanism is None:
            return None
        return locked(self.assembly.supported.T @ self.mechanism.velocity)

    @cached_property
    def contacts(self) -> Contacts:
        """State of every contact pair."""
        s = self.solution
        state = pair_states(self.assembly.problem(self.factors), s)
        return Contacts(self.assembly.pairs, s.normal_force, s.friction_force, s.gap, s.slip, state)

    @cached_property
    def outline_gap_difference(self) -> float:
        """Largest difference between a gap and that of the displaced outlines at the same place [m].

        Zero where meshes match; else gaps are means weighted along the joint, see :mod:`concio.contact.outline_gaps`.
        Not worked out in space: nan where meshes there do not match.
        """
        pairs = self.assembly.pairs
        if self.model.dim == 3:
            return float("nan") if (pairs.rule == WEIGHTED).any() else 0.0
        chosen, apart = outline_gaps(self.assembly.disc, self.assembly.detection.segments, pairs)
        difference = apart @ self.displacement - pairs.C_n[chosen] @ self.displacement
        return float(np.abs(difference).max(initial=0.0))

    @cached_property
    def joint_motion(self) -> JointMotion:
        """The joint that opens or slides most beside its own length."""
        pairs, interfaces = self.assembly.pairs, self.assembly.detection.interfaces
        real = np.flatnonzero(pairs.interface >= 0)
        if not real.size:
            return JointMotion("", 0.0, 0.0)
        contacts = self.contacts
        motion = np.maximum(contacts.gap - pairs.gap, np.linalg.norm(contacts.slip, axis=1))[real]
        length = np.array([face.width for face in interfaces])[pairs.interface[real]]
        worst = int(np.argmax(motion / length))
        face = interfaces[int(pairs.interface[real[worst]])]
        names = [self.model.bodies[b].name for b in (face.a, face.b)]
        return JointMotion("|".join(names), float(motion[worst]), float(motion[worst] / length[worst]))

    @cached_property
    def joints(self) -> JointResultants:
        """Resultants of each interface of a plane model.

        Raises
        ------
        InputError
            The model is in space, where shear and moments are vectors.
        """
        if self.model.dim != 2:
            msg = "the joints of a model in space have shear forces and moments of three components"
            raise InputError(msg, hint="they are in result.joints_in_space; concio.thrust_surface draws their thrust")
        return joint_resultants(self.contacts)

    @cached_property
    def joints_in_space(self) -> SpaceResultants:
        """Resultants of each interface of a model in space."""
        if self.model.dim != 3:
            msg = "the joints of a plane model have no resultants in space"
            raise InputError(msg, hint="they are in result.joints")
        return joint_resultants_in_space(self.contacts, self.assembly.detection.interfaces)

    @cached_property
    def stress(self) -> Stress:
        """Stresses of the bodies, tension positive."""
        return Stress(self.assembly.disc, self.displacement - self.assembly.expansion(self.factors))

    def in_units(self, units: Units | str) -> Result:
        """Return the same result, reported in other units; arrays stay in kN and m.

        Parameters
        ----------
        units : Units or str
            Such as ``"N, mm, MPa"``, see :class:`concio.Units`.
        """
        chosen = Units.parse(units) if isinstance(units, str) else units
        model = replace(self.assembly.model, report=chosen)
        return replace(self, assembly=replace(self.assembly, model=model))

    def body_index(self, body: int | str) -> int:
        """Return the number of a body given by number or name."""
        if isinstance(body, str):
            for i, b in enumerate(self.model.bodies):
                if b.name == body:
                    return i
            msg = f"there is no body called '{body}'"
            hint = closest(body, (b.name for b in self.model.bodies), otherwise="see the names with 'concio check'")
            raise InputError(msg, hint=hint)
        if not 0 <= body < len(self.model.bodies):
            msg = f"there is no body {body}: there are {len(self.model.bodies)}, counted from 0"
            raise InputError(msg)
        return body

    def nodes(self, body: int | str) -> Array:
        """Return node coordinates (n, d) of a body; vertices of a rigid or fixed one [m]."""
        return self.assembly.disc.nodes(self.body_index(body))

    def node_displacement(self, body: int | str, u: Array | None = None) -> Array:
        """Return the displacements (n, d) of :meth:`nodes` [m]; ``u`` (N_all,) may be given, such as a mechanism."""
        b = self.body_index(body)
        disc = self.assembly.disc
        u = self.displacement if u is None else u
        own = u[disc.offsets[b] : disc.offsets[b + 1]]
        if disc.shape_of[b] == FIXED:
            return self._obstacle_displacement(b)
        if disc.shape_of[b] == RIGID:
            moved: Array = rigid_operator(disc.nodes(b) - disc.centroids[b], disc.reach[b]) @ own
            return moved
        return own.reshape(-1, disc.dim)

    def _obstacle_displacement(self, b: int) -> Array:
        nodes = self.assembly.disc.nodes(b)
        total = np.zeros_like(nodes)
        arm = nodes - self.assembly.disc.centroids[b]
        for s in self.model.supports:
            if s.body == self.model.bodies[b].name:
                factor = load_factor(self.factors, s.group)
                total = total + factor * (np.array(s.displacement) + swept(np.asarray(s.rotation), arm))
        return total

    @cached_property
    def max_settlement(self) -> float:
        """Largest downward displacement of any point of a free body [m]; zero if everything rises."""
        lowest, dust = 0.0, np.finfo(float).eps * self.model.size
        disc = self.assembly.disc
        elastic = np.concatenate([np.repeat(disc.shape_of >= 0, np.diff(disc.offsets)), np.zeros(1, dtype=bool)])[:-1]
        if elastic.any():
            lowest = min(lowest, float(self.displacement[elastic].reshape(-1, disc.dim)[:, -1].min()))
        for b in np.flatnonzero(disc.shape_of == RIGID).tolist():
            lowest = min(lowest, float(self.node_displacement(b)[:, -1].min()))
        return -lowest if -lowest > dust else 0.0

    @cached_property
    def ties(self) -> TieForces:
        """The ties with their tension, elongation and state; those that broke are not among them."""
        return tie_forces(self.assembly, self.solution.displacement, self.contacts.normal_force, self.factors)

    @property
    def reactions(self) -> dict[str, tuple[float, ...]]:
        """Force of each fixed body and each support on the structure, (x, y) or (x, y, z) [kN]; a copy."""
        return dict(self._reactions)

    @cached_property
    def _reactions(self) -> dict[str, tuple[float, ...]]:
        pairs, disc = self.assembly.pairs, self.assembly.disc
        force = self.contacts.force_on_b
        found: dict[str, tuple[float, ...]] = {}
        for b in np.flatnonzero(disc.shape_of == FIXED):
            total = force[pairs.body_a == b].sum(0) - force[pairs.body_b == b].sum(0)
            found[self.model.bodies[b].name] = tuple(total.tolist())
        if self.assembly.supported.held:
            s = self.solution
            strained = self.displacement - self.assembly.expansion(self.factors)
            rest = self.assembly.K @ strained - self.assembly.load(self.factors)
            rest -= pairs.C_n.T @ s.normal_force + pairs.C_t.T @ s.friction_force.ravel()
            found.update(self.assembly.supported.reactions(disc, rest))
        return found

    @property
    def total_load(self) -> tuple[float, ...]:
        """Resultant of the loads (x, y) or (x, y, z) [kN]."""
        f = self.assembly.load(self.factors)
        disc = self.assembly.disc
        total = np.zeros(disc.dim)
        for b, s in enumerate(disc.shape_of):
            own = f[disc.offsets[b] : disc.offsets[b + 1]]
            if s == RIGID:
                total += own[: disc.dim]
            elif s != FIXED:
                total += own.reshape(-1, disc.dim).sum(0)
        return tuple(total.tolist())

    @property
    def plot(self) -> Plots:
        """Figures by name: ``result.plot.deformed()``; matplotlib is loaded here."""
        plots: Plots = view(self, "plot")
        return plots

    def viewer(self, height: int = 640) -> Shown:
        """Return the interactive report, which a notebook shows in a frame of a height [pixel].

        Examples
        --------
        >>> import concio
        >>> found = concio.solve(concio.column(width=0.5, height=2.0, blocks=2, block="rigid")).viewer(height=400)
        >>> found._repr_html_().startswith("<iframe srcdoc=")
        True
        """
        shown: Shown = view(self, "viewer", height)
        return shown

    @property
    def tables(self) -> Tables:
        """Tables by name, as dicts of arrays: ``pandas.DataFrame(result.tables.joints())``."""
        tables: Tables = view(self, "tables")
        return tables

    @cached_property
    def self_stress(self) -> SelfStress | None:
        """Forces that would hold a structure which collapses as it is loaded, least compression; None otherwise."""
        return self_stress(self)

    @cached_property
    def verdict(self) -> Verdict:
        """The answer with its question: what acts, its proof, its limits, what is suspicious about the model."""
        return step_verdict(self)

    def proof(self, numbers: Literal["binary", "decimal"] = "binary") -> dict[str, Any]:
        """Return an exact certificate of the outcome, for ``concio verify``.

        An equilibrium of a plane model is proved with its displacements: as fractions, or each number enclosed between
        two. Of rigid blocks in space it is proved that forces balance the loads, of loads that nothing balances that
        none do.

        Parameters
        ----------
        numbers : {"binary", "decimal"}
            Numbers of the model as the computer holds them, or rounded to twelve decimal digits.

        Raises
        ------
        InputError
            The model has something that is not proved exactly yet, or is too large.
        SolverError
            The outcome has no exact certificate, or joints are on the edge of two states, which it names.

        Examples
        --------
        >>> import concio
        >>> size = {"length": 1.0, "height": 0.5, "block_size": (0.5, 0.25)}
        >>> wall = concio.wall(**size, block="rigid", unit_weight=20, friction=0.6)
        >>> concio.solve(wall).proof()["claim"]
        'equilibrium'
        """
        from concio.analysis.exact_proofs import step_proof

        return step_proof(self.assembly, self.factors or None, self.solution, numbers=numbers)

    @cached_property
    def proved(self) -> str:
        """What an exact certificate of the outcome proves, in a sentence; empty where there is none or none was sought.

        One is sought where it costs little: up to a hundred rigid blocks, or a few small elastic ones.
        """
        from concio.analysis.exact_proofs import sentence_proved

        return sentence_proved(self.assembly, self.proof)

    @property
    def sentence(self) -> str:
        """The outcome in words, with the loads it is about and what it leaves out."""
        return self.verdict.sentence

    @property
    def attention(self) -> tuple[str, ...]:
        """What asks for attention, a sentence each: joints not made, implausible numbers, large motions and forces."""
        return self.verdict.attention

    @cached_property
    def existence(self) -> SufficientCondition:
        """The paper's sufficient condition: normal forces alone, all positive, balance the loads; with its margin."""
        return sufficient_condition(self.assembly.problem(self.factors))

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``: plain types, kN and m.

        Examples
        --------
        >>> import concio
        >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=4, block="rigid"))
        >>> numbers = result.summary()
        >>> numbers["status"], numbers["pairs"]["stick"]
        ('solved', 8)
        """
        return step_numbers(self)
