"""Joint laws of contacts that are found as bodies move: looked up by the two bodies, times areas in every step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.joint_points import points_along
from concio.model.body import called
from concio.model.model import Model
from concio.problem.contact_problem import Laws

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class LawTable:
    """Constants of all joint laws of a model, one entry each; in space twice, see :meth:`with_bare`.

    Parameters
    ----------
    friction, cohesion, tension, dilatancy : (L,) arrays
        Strengths per area [kN/m2].
    normal, tangential : (L,) arrays
        Compliance times area, zero for hard joints [m3/kN].
    cap : (L,) array
        Compressive strength, inf where there is none [kN/m2].
    points : (L,) integer array
        Contact points of a joint between two rigid sides.
    names : tuple of str
    """

    friction: Array
    cohesion: Array
    tension: Array
    dilatancy: Array
    normal: Array
    tangential: Array
    cap: Array
    points: Array
    names: tuple[str, ...]

    @classmethod
    def of(cls, model: Model) -> LawTable:
        """Return the table of a model's laws."""
        laws = list(model.laws.values())

        def soft(stiffness: float | None) -> float:
            return 0.0 if stiffness is None else 1.0 / stiffness

        found = cls(
            friction=np.array([law.friction for law in laws]),
            cohesion=np.array([law.cohesion for law in laws]),
            tension=np.array([law.tensile_strength for law in laws]),
            dilatancy=np.array([law.dilatancy for law in laws]),
            normal=np.array([soft(law.normal_stiffness) for law in laws]),
            tangential=np.array([soft(law.tangential_stiffness) for law in laws]),
            cap=np.array([np.inf if law.compressive_strength is None else law.compressive_strength for law in laws]),
            points=np.array([points_along(law.compressive_strength, law.normal_stiffness) for law in laws]),
            names=tuple(model.laws),
        )
        return found if model.dim == 2 else found.with_bare()

    def with_bare(self) -> LawTable:
        """Return the table with a hard law of the same friction, and nothing else, behind for each of its laws.

        In space it is that of corners and edges, which have no area.
        """
        none = np.zeros_like(self.friction)
        wanted = {"friction": self.friction, "cap": none + np.inf, "points": self.points, "dilatancy": self.dilatancy}
        both = {name: np.concatenate([getattr(self, name), wanted.get(name, none)]) for name in vars(self)
                if name != "names"}  # fmt: skip
        return LawTable(**both, names=self.names)

    def laws(self, law: Array, area: Array, bonded: Array) -> Laws:
        """Return the laws of pairs (m,) as forces and lengths: strengths times area, compliance over area.

        Pairs without area are hard, and have neither cohesion nor tensile strength.

        Parameters
        ----------
        law : (m,) integer array
        area : (m,) array
            [m2].
        bonded : (m,) boolean array
            Pairs that have cohesion and tensile strength.
        """

        def compliance(per_area: Array) -> Array:
            some = (per_area[law] > 0) & (area > 0)
            found: Array = np.divide(per_area[law], area, out=np.zeros(len(law)), where=some)
            return found

        held, some = np.where(bonded, area, 0.0), area > 0
        return Laws(
            friction=self.friction[law], cohesion=self.cohesion[law] * held, tension=self.tension[law] * held,
            dilatancy=self.dilatancy[law], normal_compliance=compliance(self.normal),
            tangential_compliance=compliance(self.tangential),
            cap=np.where(some, self.cap[law] * np.where(some, area, 1.0), np.inf),
        )  # fmt: skip


class RuleBook:
    """Finds the law and the initial opening of the joint between any two bodies of a model.

    Parameters
    ----------
    model : Model

    Attributes
    ----------
    widest : float
        Largest initial opening of any rule [m].
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        words = {word for rule in model.rules for word in rule.between if word != "*"}
        patterns = [word for word in sorted(words) if "*" in word]
        known: dict[tuple[object, ...], int] = {}
        keys = [(b.kind, b.material, frozenset(words & {b.name, b.role, b.layer}), *(called(p, b) for p in patterns))
                for b in model.bodies]  # fmt: skip
        self.sort = np.array([known.setdefault(key, len(known)) for key in keys])
        self._number = {name: k for k, name in enumerate(model.laws)}
        self._found: dict[tuple[int, int], tuple[int, float]] = {}
        self.widest = max((rule.gap for rule in model.rules), default=0.0)

    def openings(self, body_a: Array, body_b: Array) -> Array:
        """Return the initial openings (i,) [m] of joints between bodies a and b (i,)."""
        return self.find(body_a, body_b)[1] if self.widest else np.zeros(len(body_a))

    def find(self, body_a: Array, body_b: Array) -> tuple[Array, Array]:
        """Return the number of the law (i,) and the opening (i,) [m] between bodies a and b (i,).

        Raises
        ------
        InputError
            No rule matches two of them.
        """
        if not len(body_a):
            return np.zeros(0, dtype=int), np.zeros(0)
        count = int(self.sort.max()) + 1
        kinds, example, group = np.unique(
            self.sort[body_a] * count + self.sort[body_b], return_index=True, return_inverse=True
        )
        found = []
        for kind, i in zip(kinds.tolist(), example.tolist(), strict=True):
            p, q = divmod(kind, count)
            if (p, q) not in self._found:
                bodies = self.model.bodies
                rule = self.model.rule_between(bodies[int(body_a[i])], bodies[int(body_b[i])])
                self._found[p, q] = self._number[rule.law], rule.gap
            found.append(self._found[p, q])
        law = np.array([f[0] for f in found])[group.ravel()]
        opening = np.array([f[1] for f in found])[group.ravel()]
        return law, opening
