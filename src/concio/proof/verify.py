"""Check an exact certificate of concio with nothing but Python's own fractions: ``python verify.py FILE``.

This file shares no code with the rest and runs alone. It reads the numbers of a structure of blocks, recomputes weights
and the balance of every block as fractions, and checks the claim without any rounding. Signs: a force F acts on block b
of a joint, -F on block a; n points from a to b.

limit       Loads that are constant plus x times loads that are multiplied. Given are joint forces that balance the
            loads at x = lower, each within the cone of friction, and a motion of the blocks at x = upper that no joint
            resists: no joint can open against it or hold it by friction, and the loads do more work on it at any x
            above. So x = lower is balanced within friction, and no x above upper is, whatever the joint forces.
collapse    Such a motion on which the loads as they are do work: nothing balances them.
"""

import hashlib
import json
import sys
from fractions import Fraction
from typing import Any

Vector = list[Fraction]
Texts = list[str]
Motion = list[list[Texts]]
Factors = dict[str, Fraction]
Data = dict[str, Any]


def exact(text: str) -> Fraction:
    """Return the fraction that a text says: binary "0x1.8p-1", decimal "0.75" or "3/4"."""
    return Fraction(float.fromhex(text)) if "0x" in text else Fraction(text)


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
    for load in data["loads"]:
        factor = factors.get(load["group"], Fraction(0))
        b = load["body"]
        if load["kind"] == "weight":
            volume, first = solid(data["bodies"][b])
            weight = exact(data["bodies"][b]["unit_weight"]) * factor
            force = [weight * volume * x for x in vector(load["value"])]
            moment = cross([weight * m for m in first], vector(load["value"]))
        else:
            force = [factor * x for x in vector(load["force"])]
            turning = [factor * x for x in vector(load["moment"])]
            moment = [a + b for a, b in zip(cross(vector(load["at"]), force), turning, strict=True)]
        add(total[b], force, moment)
    return total


def check_forces(data: Data, forces: list[Texts], factors: Factors) -> None:
    """Raise unless joint forces lie in their cones and balance the loads on every free block."""
    total = loads(data, factors)
    for k, (joint, text) in enumerate(zip(data["joints"], forces, strict=True)):
        F, n, mu, at = vector(text), vector(joint["normal"]), exact(joint["friction"]), vector(joint["at"])
        pressed = dot(F, n)
        if pressed < 0 or dot(F, F) * dot(n, n) > (1 + mu * mu) * pressed * pressed:
            raise ValueError(f"the force at joint point {k} is outside its cone of friction")
        add(total[joint["b"]], F, cross(at, F))
        add(total[joint["a"]], [-x for x in F], [-x for x in cross(at, F)])
    for body, (force, moment) in zip(data["bodies"], total, strict=True):
        if not body["fixed"] and (any(force) or any(moment)):
            raise ValueError(f"block {body['name']!r} is not in balance")


def check_motion(data: Data, motion: Motion) -> None:
    """Raise unless a motion is one that no joint resists: w.n >= mu |w_t| at every point, in squares."""
    for body, (v, turn) in zip(data["bodies"], motion, strict=True):
        if body["fixed"] and (any(vector(v)) or any(vector(turn))):
            raise ValueError(f"block {body['name']!r} is fixed and moves")
    for k, joint in enumerate(data["joints"]):
        n, mu, at = vector(joint["normal"]), exact(joint["friction"]), vector(joint["at"])
        b, a = (velocity(motion[joint[side]], at) for side in "ba")
        w = [p - q for p, q in zip(b, a, strict=True)]
        opening = dot(w, n)
        if opening < 0 or (1 + mu * mu) * opening * opening < mu * mu * dot(w, w) * dot(n, n):
            raise ValueError(f"the joint at point {k} resists the motion")


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
    points = f"with friction at the {len(data['joints'])} joint points stated"
    acting = ", ".join([f"{g} x {float(x):g}" for g, x in constant.items()] + [f"{g} multiplied" for g in growing])
    if data["claim"] == "collapse":
        check_motion(data, data["motion"])
        if not work(data, data["motion"], constant) > 0:
            raise ValueError("the loads do no work on the motion")
        return f"no forces {points} balance {acting}: proved exactly"
    if data["claim"] != "limit":
        raise ValueError(f"unknown claim {data['claim']!r}")
    found = []
    if "forces" in data:
        lower = exact(data["lower"])
        check_forces(data, data["forces"], {**constant, **{g: lower * x for g, x in growing.items()}})
        found.append(f"{data['lower']} = {float(lower):.12g} is balanced")
    if "motion" in data:
        upper = exact(data["upper"])
        check_motion(data, data["motion"])
        rate = work(data, data["motion"], growing)
        if not rate > 0 or work(data, data["motion"], constant) + upper * rate < 0:
            raise ValueError("the loads need not do work on the motion above the upper bound")
        found.append(f"nothing above {data['upper']} = {float(upper):.12g} is")
    if not found:
        raise ValueError("neither forces nor a motion are given")
    return f"{acting}, {points}: {'; '.join(found)}: proved exactly"


def read(path: str) -> str:
    """Return what a certificate file proves in a sentence; raise ValueError where it proves nothing."""
    with open(path, encoding="ascii") as file:
        data = json.load(file)
    if not isinstance(data, dict):
        raise ValueError("this is no certificate")
    return check(data)


def main(path: str) -> int:
    """Print what a certificate file proves, or why it is refused; return the exit code."""
    try:
        print(read(path))
    except (ValueError, KeyError, IndexError, TypeError, ArithmeticError, OSError) as error:
        print(f"REFUSED: {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:2]))
