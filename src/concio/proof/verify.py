"""Check an exact certificate of concio with nothing but Python's own fractions: ``python verify.py FILE``.

This file shares no code with the rest and runs alone. It reads the numbers of a structure of blocks, recomputes weights
and the balance of every block as fractions, and checks the claim without any rounding. Signs: a force F acts on block b
of a joint, -F on block a; n points from a to b.

limit       Loads that are constant plus x times loads that are multiplied. Given are joint forces that balance the
            loads at x = lower, each within the strength of its joint, and a motion of the blocks at x = upper on which
            the loads do more work at any x above than joint forces within their strength can take. So x = lower is
            balanced, and no x above upper is, whatever the joint forces.
balance     Joint forces that balance the loads as they are.
collapse    Such a motion on which the loads as they are do more work than that: nothing balances them.

A joint force F = p n + s has strength where -tension <= p <= cap and |s| <= (cohesion + friction p) |n|. What is not
given is 0, and a cap inf. A tie is a joint without friction along its line, a support that holds a point one with
tension and cap inf.
"""

import hashlib
import json
import sys
from fractions import Fraction
from functools import cache
from math import isqrt
from typing import Any

Vector = list[Fraction]
Texts = list[str]
Motion = list[list[Texts]]
Factors = dict[str, Fraction]
Data = dict[str, Any]


@cache
def exact(text: str) -> Fraction:
    """Return the fraction that a text says: binary "0x1.8p-1", decimal "0.75", "3/4" or, of long numbers, "0x3/0x4"."""
    if "p" in text:
        return Fraction(float.fromhex(text))
    if "0x" in text:
        top, _, under = text.partition("/")
        return Fraction(int(top, 16), int(under or "1", 16))
    return Fraction(text)


def said(text: str) -> str:
    """Return a bound in words: its fraction, unless that is long, and its value."""
    value = f"{float(exact(text)):.12g}"
    return f"{text} = {value}" if len(text) <= 200 else f"{value} (a fraction of {len(text)} characters)"


def factor(x: Fraction) -> str:
    """Return the factor of a load group in words that stand for no other number: it may be as near as 1e-16 to one."""
    value = float(x)
    short = f"{value:g}"
    if Fraction(short) == x:
        return short
    return repr(value) if Fraction(value) == x else str(x)


def vector(texts: Texts) -> Vector:
    """Return the fractions of a list of texts."""
    return [exact(text) for text in texts]


def dot(a: Vector, b: Vector) -> Fraction:
    """Return the scalar product."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def cross(a: Vector, b: Vector) -> Vector:
    """Return the moment of b at a: one number in the plane, three in space."""
    if len(a) == 2:
        return [a[0] * b[1] - a[1] * b[0]]
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def solid(body: Data) -> tuple[Fraction, Vector]:
    """Return volume [m3] and first moments of a body: triangles from the origin, in space tetrahedra."""
    volume, first = Fraction(0), [Fraction(0)] * len(body["pieces"][0][0])
    for corners in body["pieces"]:
        points = [vector(p) for p in corners]
        if len(points[0]) == 2:
            part = cross(points[0], points[1])[0] / 2 * exact(body["thickness"])
        else:
            part = dot(points[0], cross(points[1], points[2])) / 6
        volume += part
        middle = [sum(xs) / (len(points[0]) + 1) for xs in zip(*points, strict=True)]
        first = [f + part * m for f, m in zip(first, middle, strict=True)]
    return volume, first


def add(total: list[Vector], force: Vector, moment: Vector) -> None:
    """Add a force and a moment to those of a block."""
    total[0] = [a + b for a, b in zip(total[0], force, strict=True)]
    total[1] = [a + b for a, b in zip(total[1], moment, strict=True)]


def loads(data: Data, factors: Factors) -> list[list[Vector]]:
    """Return force and moment about the origin on each block, of all loads times the factor of their group."""
    d = len(data["bodies"][0]["pieces"][0][0])
    total = [[[Fraction(0)] * d, [Fraction(0)] * (1 if d == 2 else 3)] for _ in data["bodies"]]
    solids: dict[int, tuple[Fraction, Vector]] = {}
    for load in data["loads"]:
        factor = factors.get(load["group"], Fraction(0))
        b = load["body"]
        if not factor:
            continue
        if load["kind"] == "weight":
            volume, first = solids[b] = solids.get(b) or solid(data["bodies"][b])
            weight = exact(data["bodies"][b]["unit_weight"]) * factor
            force = [weight * volume * x for x in vector(load["value"])]
            moment = cross([weight * m for m in first], vector(load["value"]))
        else:
            force = [factor * x for x in vector(load["force"])]
            turning = [factor * x for x in vector(load["moment"])]
            moment = [a + b for a, b in zip(cross(vector(load["at"]), force), turning, strict=True)]
        add(total[b], force, moment)
    return total


def structure(data: Data, factors: Factors) -> None:
    """Raise unless a structure is stated: bodies that are there, closed blocks with a volume, no load left out."""
    for body in data["bodies"]:
        if not isinstance(body["fixed"], bool):
            raise ValueError(f"block {body['name']!r} is neither fixed nor free")
        if not body["fixed"] and not solid(body)[0] > 0:
            raise ValueError(f"block {body['name']!r} has no volume")
        ends = [sorted(corners[k] for corners in body["pieces"]) for k in range(2)]
        if len(body["pieces"][0]) == 2 and ends[0] != ends[1]:
            raise ValueError(f"the outline of block {body['name']!r} is not closed")
    for k, joint in enumerate(data["joints"]):
        if not any(vector(joint["normal"])):
            raise ValueError(f"joint point {k} has no normal")
    for b in [joint[side] for joint in data["joints"] for side in "ab"] + [load["body"] for load in data["loads"]]:
        if not 0 <= b < len(data["bodies"]):
            raise ValueError(f"there is no body {b}")
    if left := {load["group"] for load in data["loads"]} - set(factors):
        raise ValueError(f"load group {min(left)!r} has no factor")


def strength(joint: Data) -> list[Fraction]:
    """Return friction, cohesion, tension and cap of a joint point; -1 stands for inf."""
    texts = [joint.get(name, "inf" if name == "cap" else "0") for name in ("friction", "cohesion", "tension", "cap")]
    found = [Fraction(-1) if text == "inf" else exact(text) for text in texts]
    if min(found[:2]) < 0 or any(x < 0 for x, text in zip(found, texts, strict=True) if text != "inf"):
        raise ValueError("a strength is negative, or friction or cohesion is inf")
    return found


def check_forces(data: Data, forces: list[Texts], factors: Factors) -> None:
    """Raise unless joint forces lie within the strength of their joints and balance the loads on every free block."""
    total = loads(data, factors)
    for k, (joint, text) in enumerate(zip(data["joints"], forces, strict=True)):
        F, n, at = vector(text), vector(joint["normal"]), vector(joint["at"])
        mu, cohesion, tension, cap = strength(joint)
        size = dot(n, n)
        pressed = dot(F, n) / size
        sheared, most = dot(F, F) - pressed * pressed * size, cohesion + mu * pressed
        if 0 <= tension < -pressed or 0 <= cap < pressed or most < 0 or sheared > most * most * size:
            raise ValueError(f"the force at joint point {k} is outside its strength")
        add(total[joint["b"]], F, cross(at, F))
        add(total[joint["a"]], [-x for x in F], [-x for x in cross(at, F)])
    for body, (force, moment) in zip(data["bodies"], total, strict=True):
        if not body["fixed"] and (any(force) or any(moment)):
            raise ValueError(f"block {body['name']!r} is not in balance")


def roots(square: Fraction) -> tuple[Fraction, Fraction]:
    """Return fractions on both sides of a square root, equal where it is a fraction."""
    below = isqrt(square.numerator * square.denominator * 10**80)
    unit = square.denominator * 10**40
    low = Fraction(below, unit)
    return low, low if low * low == square else Fraction(below + 1, unit)


def taken(data: Data, motion: Motion) -> Fraction:
    """Return the most work that joint forces within their strength take in a motion; raise where it has no end."""
    for body, (v, turn) in zip(data["bodies"], motion, strict=True):
        if body["fixed"] and (any(vector(v)) or any(vector(turn))):
            raise ValueError(f"block {body['name']!r} is fixed and moves")
    total = Fraction(0)
    for k, joint in enumerate(data["joints"]):
        n, at = vector(joint["normal"]), vector(joint["at"])
        mu, cohesion, tension, cap = strength(joint)
        b, a = (velocity(motion[joint[side]], at) for side in "ba")
        w = [p - q for p, q in zip(b, a, strict=True)]
        opening = dot(w, n)
        most = []
        for slip in roots(dot(w, w) * dot(n, n) - opening * opening):
            closing = mu * slip - opening  # a normal force p takes p times as much, and cohesion its part
            limit = cap if closing > 0 else tension
            if closing and limit < 0:
                raise ValueError(f"the joint at point {k} resists the motion")
            most.append(cohesion * slip + abs(closing) * limit)
        total += max(most)
    return total


def velocity(motion: list[Texts], at: Vector) -> Vector:
    """Return the velocity of a point of a body from that of the origin and its rotation."""
    v, turn = vector(motion[0]), vector(motion[1])
    swept = [-turn[0] * at[1], turn[0] * at[0]] if len(at) == 2 else cross(turn, at)
    return [p + q for p, q in zip(v, swept, strict=True)]


def work(data: Data, motion: Motion, factors: Factors) -> Fraction:
    """Return the work of the loads on a motion."""
    parts = (
        dot(force, vector(v)) + dot(moment, vector(turn))
        for (force, moment), (v, turn) in zip(loads(data, factors), motion, strict=True)
    )
    return sum(parts, Fraction(0))


def check(data: Data) -> str:
    """Return what a certificate proves in a sentence; raise ValueError where it proves nothing."""
    plain = json.dumps({k: v for k, v in data.items() if k != "digest"}, sort_keys=True, separators=(",", ":"))
    if hashlib.sha256(plain.encode("ascii")).hexdigest() != data["digest"]:
        raise ValueError("the file was changed after it was written: its digest is another")
    constant = {group: exact(x) for group, x in data["constant"].items()}
    growing = {group: exact(x) for group, x in data.get("multiplied", {}).items()}
    if set(constant) & set(growing):
        raise ValueError("a load group is both constant and multiplied")
    structure(data, {**constant, **growing})
    more = any(set(joint) & {"cohesion", "tension", "cap"} for joint in data["joints"])
    points = f"with friction{' and strength' if more else ''} at the {len(data['joints'])} joint points stated"
    grow = [f"{g}{'' if x == 1 else f' x {factor(x)}'} multiplied" for g, x in growing.items()]
    acting = ", ".join([f"{g} x {factor(x)}" for g, x in constant.items()] + grow)
    if data["claim"] == "collapse":
        if not work(data, data["motion"], constant) > taken(data, data["motion"]):
            raise ValueError("the loads do no work on the motion that joints could not take")
        return f"no forces {points} balance {acting}: proved exactly"
    if data["claim"] == "balance":
        check_forces(data, data["forces"], constant)
        return f"forces {points} balance {acting}: proved exactly"
    if data["claim"] != "limit":
        raise ValueError(f"the claim {data['claim']!r} is not for this program (verify_equilibrium.py: 'equilibrium')")
    found = []
    if "forces" in data:
        lower = exact(data["lower"])
        check_forces(data, data["forces"], {**constant, **{g: lower * x for g, x in growing.items()}})
        found.append(f"the multiplier {said(data['lower'])} is balanced")
    if "motion" in data:
        upper = exact(data["upper"])
        rate = work(data, data["motion"], growing)
        if not rate > 0 or work(data, data["motion"], constant) + upper * rate < taken(data, data["motion"]):
            raise ValueError("the loads need not do more work on the motion above the upper bound than joints take")
        found.append(f"no multiplier above {said(data['upper'])} is")
    if not found:
        raise ValueError("neither forces nor a motion are given")
    return f"{acting}, {points}: {'; '.join(found)}: proved exactly"


def main(path: str) -> int:
    """Print what a certificate file proves, or why it is refused; return the exit code."""
    try:
        with open(path, encoding="ascii") as file:
            print(check(json.load(file)))
    except KeyError as error:
        print(f"REFUSED: an entry {error} is missing")
        return 1
    except (ValueError, IndexError, TypeError, AttributeError, ArithmeticError, RecursionError, OSError) as error:
        print(f"REFUSED: {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else "give one certificate file")
