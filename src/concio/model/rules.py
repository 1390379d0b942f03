"""Rules that say which joint law holds between which bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.model.body import Body, called
from concio.model.polyhedron import Polyhedron


@strict_class
@dataclass(frozen=True)
class JointRule:
    """Chooses the law of the interfaces between two sorts of bodies.

    Parameters
    ----------
    law : str
        Key of ``Model.laws``.
    between : pair of str
        Each matches a body by name, role, layer, (unless it is fixed) material, or by a pattern of names such as
        ``"tower-*"``; "*" matches any. Order does not matter. The last rule that matches an interface wins. A word
        that names no body of a model is refused.
    gap : float
        Initial opening of these interfaces, added to what the geometry shows >= 0 [m].

    Examples
    --------
    The joint with the ground has a law of its own. The last rule that matches counts:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4)
    >>> model = concio.Model(
    ...     pillar.bodies,
    ...     pillar.materials,
    ...     {"joint": concio.JointLaw(0.7), "base": concio.JointLaw(0.4)},
    ...     rules=(concio.JointRule("joint"), concio.JointRule("base", between=("*", "ground"))),
    ... )
    >>> model.rule_between(model.body("ground"), model.body("b01")).law
    'base'
    """

    law: str
    between: tuple[str, str] = ("*", "*")
    gap: float = 0.0

    def __post_init__(self) -> None:
        if not (0 <= self.gap < math.inf):
            msg = f"initial gap = {self.gap:g} must be zero or positive and finite"
            raise InputError(msg, hint="a gap is an opening in m; overlaps are not gaps")

    def matches(self, a: Body | Polyhedron, b: Body | Polyhedron) -> bool:
        """Return whether the rule applies to interfaces between ``a`` and ``b``."""
        p, q = self.between
        return (fits(p, a) and fits(q, b)) or (fits(p, b) and fits(q, a))


def fits(word: str, body: Body | Polyhedron) -> bool:
    """Return whether a word of a rule names a body: as in loads, or by its material where it is not fixed."""
    return called(word, body) or (word == body.material != "" and body.kind != "fixed")


def check_rules(rules: Sequence[JointRule], bodies: Sequence[Body | Polyhedron]) -> None:
    """Refuse rules that name what no body is called: they would be void.

    Raises
    ------
    InputError
        With the word that was probably meant.
    """
    known = dict.fromkeys(word for place in range(4) for b in bodies for word in (_words(b)[place],) if word)
    for rule in rules:
        for word in rule.between:
            if word not in known and not any("*" in word and called(word, b) for b in bodies):
                msg = f"the rule for the joint law '{rule.law}' names '{word}', but no body has that name, role, layer "
                msg += "or material"
                hint = closest(word, known, otherwise="see the names with 'concio check --all'" * (len(known) > 30))
                raise InputError(msg, hint=hint)


def rules_of(rules: Sequence[JointRule], bodies: Sequence[Body | Polyhedron]) -> tuple[JointRule, ...]:
    """Return the rules that may apply to some bodies: each of whose words names one of them; the first if none does."""
    known = {word for b in bodies for word in _words(b) if word}

    def names(word: str) -> bool:
        return word in known or ("*" in word and any(called(word, b) for b in bodies))

    found = tuple(rule for rule in rules if all(names(word) for word in rule.between))
    return found or (JointRule(rules[0].law),)


def _words(body: Body | Polyhedron) -> tuple[str, str, str, str]:
    """Return the words by which rules find a body: role, layer, material, name."""
    return body.role, body.layer, "" if body.kind == "fixed" else body.material, body.name
