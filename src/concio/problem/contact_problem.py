r"""The discrete contact problem: plain arrays, nothing of masonry.

Every body has its own unknowns; ``K`` is block diagonal, one block for each body, singular for a body that
floats. A contact pair ``k`` joins a point of side *a* to a point of side *b*; ``n`` is the unit normal from *a* to
*b*, ``t`` the tangent. With the shifts that cohesion and tension bring (all zero for plain Coulomb friction), the
problem in one load step is (numbers: equations of Ercolano's paper)

.. math::

    K u &= f + C_n^T t_n + C_t^T t_t                                              &(12)\\
    y_n &= x_n + C_n u + a_n t_n - \tan\psi\,|y_t| + p, \qquad
            0 \le y_n \perp t_n + T \ge 0                                          &(5, 13)\\
    0 &\le p \perp N - t_n \ge 0                                                   &\text{(cap)}\\
    y_t &= C_t u - s + a_t t_t, \qquad |t_t| \le c + \mu t_n                       &(6, 14)\\
    t_t &= -(c + \mu t_n)\, y_t/|y_t| \quad\text{where } y_t \ne 0, \qquad -t_t y_t \ge 0   &(7)

Forces are nodal forces (kN), already integrated over the tributary area of the pair; ``t_n >= 0`` is compression and
acts on side *b* along ``+n``; ``t_t`` acts on side *b* along ``+t``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError
from concio.problem.cone import Cone
from concio.problem.once import once
from concio.problem.tolerances import SMOOTH
from concio.representation import short_repr

Array = np.ndarray
Engine = Literal["superlu", "pardiso"]
"""Names of the libraries that factorise sparse matrices."""


@short_repr
@dataclass(frozen=True, eq=False)
class Laws:
    """Joint laws of ``m`` pairs, as forces and lengths of each pair (tributary area already multiplied in).

    Parameters
    ----------
    friction : (m,) array
        Coulomb coefficient mu >= 0.
    cohesion : (m,) array
        Force c >= 0 added to the sliding strength [kN].
    tension : (m,) array
        Tensile strength T >= 0 of the pair [kN]; needs ``friction * tension <= cohesion``.
    dilatancy : (m,) array
        tan(psi) >= 0: opening for each unit of slip; ``dilatancy == friction`` is associated flow.
    normal_compliance, tangential_compliance : (m,) array
        a_n = 1/k_n and a_t = 1/k_t of a compliant joint [m/kN]; 0 is a hard joint.
    cap : (m,) array
        Largest compression N of the pair [kN]; ``inf`` where there is none.
    """

    friction: Array
    cohesion: Array
    tension: Array
    dilatancy: Array
    normal_compliance: Array
    tangential_compliance: Array
    cap: Array

    @classmethod
    def coulomb(cls, friction: Array | float, m: int | None = None) -> Laws:
        """Plain Coulomb friction for ``m`` pairs."""
        mu = np.asarray(friction, dtype=float)
        mu = np.full(m, float(mu)) if mu.ndim == 0 and m is not None else mu.copy()
        z = np.zeros_like(mu)
        return cls(mu, z, z.copy(), z.copy(), z.copy(), z.copy(), np.full_like(mu, np.inf))

    @cached_property
    def cone(self) -> Cone:
        """The forces each pair may carry."""
        return Cone(self.friction, self.cohesion, self.tension, self.cap)

    def __getitem__(self, pick: Array | slice) -> Laws:
        return Laws(*(getattr(self, name)[pick] for name in self.__dataclass_fields__))


@short_repr
@dataclass(frozen=True, eq=False)
class ContactProblem:
    """One load step of elastic or rigid bodies in unilateral frictional contact.

    Parameters
    ----------
    K : (N, N) CSR array
        Stiffness, block diagonal body by body, symmetric positive semidefinite [kN/m]. Zero for rigid bodies, whose
        unknowns are their rigid motions.
    f : (N,) array
        Loads [kN].
    C_n : (m, N) CSR array
        Normal relative displacement b - a of each pair along n.
    C_t : (m (d-1), N) CSR array
        Tangential relative displacement; rows ``k (d-1) ... (k+1)(d-1) - 1`` belong to pair k.
    gap : (m,) array
        Initial gaps x_n [m]; may be negative where a support is pushed into the structure.
    laws : Laws
        Joint laws of the pairs.
    R : (N, r) CSC array
        Rigid motions, K R = 0, the columns of each body orthonormal; bodies that do not float bring none.
    bodies : (B+1,) integer array
        Unknowns of body k are ``bodies[k]:bodies[k+1]``.
    slip_origin : (m, d-1) array, optional
        s: tangential position from which this step's slip is measured [m]; default zero.
    area : (m,) array, optional
        Tributary areas, or anything in proportion to them [m2]; default all equal. They matter only where forces are
        not unique (corners): there the forces of least weighted norm, sum t^2 / area, are reported.
    inertia : (N, N) CSR array, optional
        Mass matrix, symmetric positive definite [t]; a vector (N,) stands for its diagonal, default all one. It does
        not enter any equilibrium: it tells how a structure that has none moves away.
    load : float or (N,) array, optional
        The loads by which certificates measure forces [kN], where f holds more than loads: forces -K u0 of imposed
        displacements. An array tells of each connected part what it carries, a number is the total of every part.
        Default 0: the sum of |f|.
    engine : {"superlu", "pardiso"}
        What factorises the sparse matrices of whatever solves the problem.
    """

    K: sp.csr_array
    f: Array
    C_n: sp.csr_array
    C_t: sp.csr_array
    gap: Array
    laws: Laws
    R: sp.csc_array
    bodies: Array
    slip_origin: Array = field(default_factory=lambda: np.zeros((0, 0)))
    area: Array = field(default_factory=lambda: np.zeros(0))
    inertia: sp.csr_array = field(default_factory=lambda: sp.csr_array((0, 0)))
    load: float | Array = 0.0
    engine: Engine = "superlu"

    def __post_init__(self) -> None:
        m, n = self.C_n.shape
        if self.slip_origin.shape[0] != m or self.slip_origin.ndim != 2:
            if self.slip_origin.size:
                msg = f"slip_origin has shape {self.slip_origin.shape}, expected ({m}, {self.dim - 1})"
                raise InputError(msg)
            object.__setattr__(self, "slip_origin", np.zeros((m, max(1, self.C_t.shape[0] // max(m, 1)))))
        if not self.area.size:
            object.__setattr__(self, "area", np.ones(m))
        object.__setattr__(self, "inertia", _mass_matrix(self.inertia, n))
        wanted_shapes = {"K": (n, n), "f": (n,), "gap": (m,), "area": (m,), "inertia": (n, n)}
        if isinstance(self.load, np.ndarray):
            wanted_shapes["load"] = (n,)
        for name, wanted in wanted_shapes.items():
            found = getattr(self, name).shape
            if found != wanted:
                msg = f"{name} has shape {found}, expected {wanted}"
                raise InputError(msg)
        for name in Laws.__dataclass_fields__:
            if (found := np.shape(getattr(self.laws, name))) != (m,):
                msg = f"{name} of the joint laws has shape {found}, expected {(m,)}"
                raise InputError(msg, hint="one value for each pair")
        for name in ("f", "gap", "slip_origin"):
            if not np.isfinite(getattr(self, name)).all():
                msg = f"{name} holds a value that is not finite"
                raise InputError(msg)
        if fault := _motions_fault(self.K, self.R):
            raise InputError(fault[0], hint=fault[1])
        bound = self.laws.friction * self.laws.tension - self.laws.cohesion
        if (bound > SMOOTH * self.laws.cohesion).any():
            k = int(np.argmax(bound))
            msg = f"pair {k}: tensile strength needs cohesion >= friction x tension"
            raise InputError(msg, hint="lower the tensile strength or raise the cohesion")

    @property
    def pairs(self) -> int:
        """Number m of contact pairs."""
        return int(self.C_n.shape[0])

    @property
    def unknowns(self) -> int:
        """Number N of displacement unknowns."""
        return int(self.C_n.shape[1])

    @property
    def dim(self) -> int:
        """Space dimension d, 2 or 3."""
        m = self.C_n.shape[0]
        return int(self.C_t.shape[0] // m) + 1 if m else max(self.slip_origin.shape[1] + 1, 2)

    @property
    def rigid_motions(self) -> int:
        """Number r of rigid motions."""
        return int(self.R.shape[1])

    @property
    def total_load(self) -> float:
        """Total load by which forces are measured [kN]: that of ``load`` if given, else the sum of |f|."""
        return float(np.abs(self.load).sum()) or float(np.abs(self.f).sum())

    @property
    def applied(self) -> float | Array:
        """The loads by which forces are measured: ``load`` if given, else f (N,) [kN]."""
        return self.load if np.any(self.load) else self.f

    @property
    def cone(self) -> Cone:
        """The forces each pair may carry."""
        return self.laws.cone

    @cached_property
    def C(self) -> sp.csr_array:
        """C_n over C_t, shape (m d, N)."""
        return sp.csr_array(sp.vstack([self.C_n, self.C_t]))

    @cached_property
    def area_share(self) -> Array:
        """Area of each pair over the mean, kept between 0.05 and 20: weighs forces where these are not unique (m,).

        Pairs without area count as one of mean area.
        """
        some = self.area > 0
        mean = float(self.area[some].mean()) if some.any() else 1.0
        return np.asarray(np.where(some, np.clip(self.area / mean, 0.05, 20.0), 1.0))

    def by(self, engine: Engine | None) -> ContactProblem:
        """Return the problem with another engine; None leaves it as it is."""
        return self if engine is None or engine == self.engine else replace(self, engine=engine)

    def with_loads(self, f: Array) -> ContactProblem:
        """Return the same problem under other loads, all of them loads."""
        return replace(self, f=np.asarray(f, dtype=float), load=0.0)

    def with_friction(self, factor: float) -> ContactProblem:
        """Return the problem with its friction coefficients times ``factor``; dilatancy and tension stay within them.

        Dilatancy is kept at most mu, and the tensile strength at most c / mu.
        """
        law = self.laws
        mu = factor * law.friction
        tension = np.where(mu * law.tension > law.cohesion, law.cohesion / np.where(mu > 0, mu, 1.0), law.tension)
        laws = replace(law, friction=mu, tension=tension, dilatancy=np.minimum(law.dilatancy, mu))
        return replace(self, laws=laws)


def _mass_matrix(given: sp.csr_array | Array, n: int) -> sp.csr_array:
    """Return a mass matrix of n unknowns, of one, of its diagonal, or of nothing: ones."""
    if isinstance(given, np.ndarray):
        return sp.csr_array(sp.diags_array(given if given.size else np.ones(n)))
    if given.shape[0] and isinstance(given, sp.csr_array):
        return given
    return sp.csr_array(given if given.shape[0] else sp.eye_array(n))


@once
def _motions_fault(K: sp.csr_array, R: sp.csc_array) -> tuple[str, str] | None:
    """Return what is wrong with rigid motions R for the stiffness K, with a hint; None where nothing is."""
    if (np.abs(R.multiply(R).sum(axis=0) - 1.0) > 1e-6).any():
        return "the rigid motions R are not of length one", "make the columns of each body orthonormal"
    moved = R @ np.cos(np.arange(R.shape[1]) + 1.0)  # some mixture of all rigid motions
    if (np.abs(K @ moved) > 1e-6 * (abs(K) @ np.abs(moved))).any():
        return "R holds motions that deform a body: K R is not zero", (
            "leave the motions out that supports or springs resist"
        )
    return None
