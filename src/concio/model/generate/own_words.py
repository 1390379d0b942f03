"""Words by which rules, loads and temperatures of a part find its bodies, kept to that part in the whole.

A role, a layer or a material is called alike in many models: a rule, or a load, on "ground" or "block" would reach the
bodies of other parts as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from concio.errors import InputError
from concio.model.body import Body, called
from concio.model.model import JointRule, Model
from concio.model.polyhedron import Polyhedron
from concio.model.rules import fits

EVERYTHING = ("*", "*")


def pattern_of(models: Sequence[Model], number: int) -> str | None:
    """Return the pattern of names that all bodies of a part have and no others, None where there is none."""
    names = [b.name for b in models[number].bodies]
    prefix = names[0].partition("-")[0] + "-"
    others = [b.name for k, m in enumerate(models) for b in m.bodies if k != number]
    alone = all(name.startswith(prefix) for name in names) and not any(name.startswith(prefix) for name in others)
    return prefix + "*" if alone else None


def everything_of(models: Sequence[Model], number: int) -> str:
    """Return a word that names all bodies of a part and no others."""
    pattern = pattern_of(models, number)
    if pattern is None:
        msg = f"part {number + 1} has joint laws of its own, but its blocks have no name in common"
        raise InputError(msg, where="merge", hint="give each part a name: concio.place(part, name='left')")
    return pattern


def own_words(models: Sequence[Model], number: int, words: Sequence[str]) -> tuple[str, ...]:
    """Return words that name the same bodies of a part, and none of another."""
    found: list[str] = []
    for word in words:
        if not any(called(word, b) for k, m in enumerate(models) for b in m.bodies if k != number):
            found.append(word)
            continue
        own = [b.name for b in models[number].bodies if called(word, b)]
        pattern = pattern_of(models, number) if len(own) == len(models[number].bodies) else None
        found += [pattern] if pattern else own
    return tuple(dict.fromkeys(found))


def united_rules(
    models: Sequence[Model],
    laws: Sequence[Mapping[str, str]],
    materials: Sequence[Mapping[str, str]],
    bodies: Sequence[Sequence[Body | Polyhedron]],
) -> list[JointRule]:
    """Return the rules of all parts, each of which decides the joints of its own part as it did before.

    Rules before the last one on everything decide nothing, and are left out. Rules that would decide joints of a part
    that does not have them are kept to their own.

    Parameters
    ----------
    models : sequence of Model
    laws, materials : sequence of mapping
        Names of laws and of materials that had to change, by part.
    bodies : sequence of sequence of Body or Polyhedron
        Of each part, with the names of materials that they have in the whole.
    """
    own = [
        [replace(_of_materials(r, m, stones), law=names.get(r.law, r.law)) for r in m.rules]
        for m, names, stones in zip(models, laws, materials, strict=True)
    ]
    own = [rules[max([k for k, r in enumerate(rules) if r.between == EVERYTHING], default=0) :] for rules in own]
    general = [[r for r in rules[:1] if r.between == EVERYTHING] for rules in own]
    alike = all(g == general[0] for g in general)
    found = list(general[0])
    tails = [rules[len(g) :] for rules, g in zip(own, general, strict=True)] if alike else own
    groups: dict[tuple[object, ...], list[int]] = {}
    for k, rules in enumerate(tails):
        groups.setdefault(tuple(_without_prefix(r, models, k) for r in rules), []).append(k)
    for group in groups.values():
        others = [own_bodies for k, own_bodies in enumerate(bodies) if k not in group]
        for same in zip(*(tails[k] for k in group), strict=True):  # rules that stand at one place in all of them
            made = [one for k, rule in zip(group, same, strict=True)
                    for one in _kept(rule, models, k, bodies[k], others, alike=alike)]  # fmt: skip
            found += dict.fromkeys(made)
    return found


def _of_materials(rule: JointRule, model: Model, changed: Mapping[str, str]) -> JointRule:
    """Return a rule with the new names of materials where its words are names of materials alone."""
    p, q = (changed[w] if w in changed and not any(called(w, b) for b in model.bodies) else w for w in rule.between)
    return replace(rule, between=(p, q))


def _without_prefix(rule: JointRule, models: Sequence[Model], number: int) -> tuple[object, ...]:
    """Return a rule without what the names of its part begin with: that of copies of one model is the same."""
    pattern = pattern_of(models, number)
    prefix = pattern.removesuffix("*") if pattern else ""
    return rule.law, rule.gap, tuple(word.removeprefix(prefix) for word in rule.between)


def _kept(
    rule: JointRule,
    models: Sequence[Model],
    number: int,
    own: Sequence[Body | Polyhedron],
    others: Sequence[Sequence[Body | Polyhedron]],
    *,
    alike: bool,
) -> list[JointRule]:
    """Return rules that decide what one does in its own part, and nothing between bodies of the others."""
    p, q = rule.between
    if not alike and "*" in (p, q):
        word = everything_of(models, number)
        p, q = (word if w == "*" else w for w in (p, q))
        return [replace(rule, between=(p, q))]
    if not any(_names(p, bodies) and _names(q, bodies) for bodies in others):
        return [rule]
    if "*" in (p, q):
        pattern = pattern_of(models, number)
        if pattern is not None:
            return [replace(rule, between=(p if q == "*" else q, pattern))]
    mine = [_names(word, own) for word in (p, q)]
    chosen = 0 if q == "*" or (p != "*" and len(mine[0]) <= len(mine[1])) else 1
    return [replace(rule, between=(name, (p, q)[1 - chosen])) for name in mine[chosen]]


def _names(word: str, bodies: Sequence[Body | Polyhedron]) -> list[str]:
    """Return the bodies that a word of a rule names."""
    return [b.name for b in bodies if fits(word, b)]
