"""Check an equilibrium certificate of concio with Python's own integers: ``python verify_equilibrium.py FILE``.

This file shares no code with the rest and runs alone. The certificate states blocks, joints and loads in the plane, the
stiffness of each elastic block, and the state of every joint point. From these this program writes down the equations
of Coulomb equilibrium as fractions and shows that they have a solution: fractions given in the file that satisfy them,
or intervals that hold one, by elimination with integers that keeps count of every rounding. Then it checks the signs.

Rigid blocks need joints with compliance: without it any forces in balance would pass for contact. Where there are
neither gaps nor elastic blocks, displacements are in proportion to it, and forces do not depend on its size.

Unknowns: displacement (v, w) of each block as a rigid body, v that of the origin; the deformation d of an elastic block
at its nodes, but for three components that are held; p along the normal n and q along t, n turned left, at each joint
point, acting on b. A point x of a block moves by v + w x (-x_2, x_1) + d. The equations:

forces and moments on every block are in balance; k d = nodal forces in an elastic one. In a joint y_n = gap + n.(u_b -
u_a) + normal_compliance p and y_t = t.(u_b - u_a) + tangential_compliance q, and its state says that it is
    open      p = -tension, y_n >= 0                 stick   y_t = 0, |q| <= cohesion + friction p
    closed    y_n = 0, -tension <= p <= cap          + or -  q = -(cohesion + friction p) where y_t >= 0, + where <= 0
    crushed   p = cap, y_n <= 0                      free    q = 0, and cohesion + friction p = 0
A joint point at an end of a joint says what two others say (where three blocks meet): such an equation may be left out
if it is shown to be a sum of others, and its force given.
"""

import hashlib
import json
import sys
from fractions import Fraction
from functools import cache
from typing import Any

Row = dict[int, Fraction]
Data = dict[str, Any]
Interval = tuple[int, int]
Condition = tuple[str, Row, Fraction]


@cache
def exact(text: str) -> Fraction:
    """Return the fraction that a text says: "0x1.8p-1", "0.75", "3/4", or "0x3/0x4" of long numbers."""
    if "p" in text:
        return Fraction(float.fromhex(text))
    if "0x" in text:
        top, _, under = text.partition("/")
        return Fraction(int(top, 16), int(under or "1", 16))
    return Fraction(text)


def weight(body: Data) -> list[Fraction]:
    """Return volume times unit weight of a block, and that times the place of its centroid."""
    found = [Fraction(0)] * 3
    for corners in body["pieces"]:
        (a, b), (c, d) = ([exact(x) for x in corner] for corner in corners)
        part = (a * d - b * c) / 2 * exact(body["thickness"]) * exact(body["unit_weight"])
        found = [f + part * x for f, x in zip(found, [Fraction(1), (a + c) / 3, (b + d) / 3], strict=True)]
    return found


def structure(data: Data) -> None:
    """Raise unless a structure is stated: bodies that are there, closed blocks with a volume, no load left out."""
    for body in data["bodies"]:
        if not isinstance(body["fixed"], bool):
            raise ValueError(f"block {body['name']!r} is neither fixed nor free")
        if not body["fixed"] and not weight({**body, "unit_weight": "1"})[0] > 0:
            raise ValueError(f"block {body['name']!r} has no volume")
        if sorted(start for start, _ in body["pieces"]) != sorted(end for _, end in body["pieces"]):
            raise ValueError(f"the outline of block {body['name']!r} is not closed")
    for k, joint in enumerate(data["joints"]):
        if not any(exact(x) for x in joint["normal"]):
            raise ValueError(f"joint point {k} has no normal")
        if joint.get("cap", "inf") != "inf" and exact(joint["cap"]) < 0:
            raise ValueError(f"joint point {k} has a strength below 0")
    for b in [joint[side] for joint in data["joints"] for side in "ab"] + [load["body"] for load in data["loads"]]:
        if not 0 <= b < len(data["bodies"]):
            raise ValueError(f"there is no body {b}")
    for load in data["loads"]:
        if load["group"] not in data["constant"]:
            raise ValueError(f"load group {load['group']!r} has no factor")


def numbering(data: Data) -> tuple[dict[int, int], dict[tuple[int, int], int], int]:
    """Return the first unknown of each free block, the unknowns of deformations, and how many there are of both."""
    free = [b for b, body in enumerate(data["bodies"]) if not body["fixed"]]
    first = {b: 3 * i for i, b in enumerate(free)}
    bent: dict[tuple[int, int], int] = {}
    for b in (b for b in free if "shape" in data["bodies"][b]):
        for component in data["shapes"][data["bodies"][b]["shape"]]["free"]:
            bent[b, component] = 3 * len(free) + len(bent)
    return first, bent, 3 * len(free) + len(bent)


def motions(data: Data, joint: Data, first: dict[int, int], bent: dict[tuple[int, int], int]) -> tuple[Row, Row]:
    """Return n.(u_b - u_a) and t.(u_b - u_a) of a joint point, as sums of unknowns."""
    n = [exact(x) for x in joint["normal"]]
    found: tuple[Row, Row] = ({}, {})
    for side, sign in (("a", -1), ("b", 1)):
        b = joint[side]
        for node, share in joint.get("nodes_" + side, [[-1, "1"]]) if b in first else []:
            x, y = (exact(v) for v in (joint["at"] if node < 0 else data["bodies"][b]["nodes"][node]))
            for row, along in zip(found, (n, [-n[1], n[0]]), strict=True):
                moved = [*enumerate([*along, x * along[1] - y * along[0]], first[b])]
                moved += [(bent[b, 2 * node + i], v) for i, v in enumerate(along) if (b, 2 * node + i) in bent]
                for unknown, value in moved:
                    row[unknown] = row.get(unknown, Fraction(0)) + sign * exact(share) * value
    return found


def law(joint: Data, name: str) -> Fraction:
    """Return a number of a joint; 0 where it is not given."""
    return exact(joint.get(name, "0"))


def loaded(data: Data, size: int) -> list[Fraction]:
    """Return the right sides of the equations of the blocks: forces, moments about the origin, nodal forces."""
    first, bent, _ = numbering(data)
    right = [Fraction(0)] * size
    for load in data["loads"]:
        b, factor = load["body"], exact(data["constant"].get(load["group"], "0"))
        if load["kind"] == "nodal":
            for component, text in zip(data["shapes"][data["bodies"][b]["shape"]]["free"], load["force"], strict=True):
                right[bent[b, component]] += factor * exact(text)
            continue
        if load["kind"] == "weight":
            (gx, gy), (total, mx, my) = [exact(x) for x in load["value"]], weight(data["bodies"][b])
            force = [gx * total, gy * total, mx * gy - my * gx]
        else:
            (x, y), (fx, fy), moment = *([exact(v) for v in load[k]] for k in ("at", "force")), exact(load["moment"][0])
            force = [fx, fy, x * fy - y * fx + moment]
        for i, value in enumerate(force):
            right[first[b] + i] += factor * value
    return right


def system(data: Data) -> tuple[list[Row], list[Fraction], list[Condition]]:
    """Return the equations of equilibrium in the joint states, their right sides, and what must not be negative."""
    first, bent, n = numbering(data)
    size = n + 2 * len(data["joints"])
    rows: list[Row] = [{} for _ in range(size)]
    right = loaded(data, size)
    signs: list[Condition] = []
    for b in (b for b in first if "shape" in data["bodies"][b]):
        shape = data["shapes"][data["bodies"][b]["shape"]]
        for i, j, text in shape["k"]:
            c, d = (bent[b, shape["free"][x]] for x in (i, j))
            rows[c][d] = rows[d][c] = exact(text)
    for k, (joint, (normal, along)) in enumerate(zip(data["joints"], data["states"], strict=True)):
        p, q, zero, one = n + 2 * k, n + 2 * k + 1, Fraction(0), Fraction(1)
        bounded = [side for side in ("tension", "cap") if joint.get(side, "inf" if side == "cap" else "0") != "inf"]
        mu, cohesion = law(joint, "friction"), law(joint, "cohesion")
        tension = law(joint, "tension") if "tension" in bounded else zero
        y_n, y_t = motions(data, joint, first, bent)
        for force, row in ((p, y_n), (q, y_t)):
            for unknown, value in row.items():
                rows[unknown][force] = -value
        y_n[p], y_t[q] = law(joint, "normal_compliance"), law(joint, "tangential_compliance")
        gap = law(joint, "gap")
        if min(mu, cohesion, tension, y_n[p], y_t[q]) < 0:
            raise ValueError(f"joint point {k} has a strength or a compliance below 0")
        rigid = not any("shape" in data["bodies"][joint[side]] for side in "ab")
        if rigid and bounded and (y_n[p] <= 0 or (y_t[q] <= 0 and max(mu, cohesion) > 0)):
            raise ValueError(f"joint point {k} of blocks that do not deform has no compliance: any forces would pass")
        if normal == "closed":
            rows[p], right[p] = y_n, -gap
            signs += [("pulled", {p: one}, tension)] if "tension" in bounded else []
            signs += [("crushed", {p: -one}, law(joint, "cap"))] if "cap" in bounded else []
        else:
            side = {"open": "tension", "crushed": "cap"}[normal]
            if side not in bounded:
                raise ValueError(f"joint point {k} cannot be {normal}")
            rows[p], right[p] = {p: one}, law(joint, "cap") if normal == "crushed" else -tension
            turn = 1 if normal == "open" else -1
            signs.append((normal, {u: turn * v for u, v in y_n.items()}, turn * gap))
        if along == "free":
            left = cohesion - mu * tension if normal == "open" else max(mu, cohesion)
            if left != 0:
                raise ValueError(f"joint point {k} has strength along itself and is not free")
            rows[q], right[q] = {q: one}, zero
        elif along == "stick":
            rows[q] = y_t
            signs += [("about to slip", {p: mu, q: s}, cohesion) for s in (one, -one)]
        else:
            s = {"+": 1, "-": -1}[along]
            rows[q], right[q] = {q: one, p: s * mu}, -s * cohesion
            signs.append(("slipping", {u: s * v for u, v in y_t.items()}, zero))
    return rows, right, signs


def leave_out(data: Data, rows: list[Row], right: list[Fraction]) -> None:
    """Put given forces in the place of equations that are sums of others; raise where one is not."""
    given = {i: (value, dict((j, exact(x)) for j, x in parts)) for i, value, parts in data.get("left_out", [])}
    first = numbering(data)[2]
    for i, (_, parts) in given.items():
        total: Row = {}
        for j, share in parts.items():
            for unknown, value in rows[j].items():
                total[unknown] = total.get(unknown, Fraction(0)) + share * value
        same = {u: v for u, v in total.items() if v} == {u: v for u, v in rows[i].items() if v}
        if i < first or set(parts) & set(given) or not same or sum(x * right[j] for j, x in parts.items()) != right[i]:
            raise ValueError(f"equation {i} is left out and no sum of others")
    for i, (value, _) in given.items():
        rows[i], right[i] = {i: Fraction(1)}, exact(value)


def near(value: Fraction, bits: int) -> Interval:
    """Return middle and radius of an interval that holds a fraction, in units of 2**-bits."""
    return (value.numerator << bits) // value.denominator, 1


def less(x: Interval, a: Interval, b: Interval, bits: int) -> Interval:
    """Return x - a b."""
    return x[0] - (a[0] * b[0] >> bits), x[1] + (abs(a[0]) * b[1] + a[1] * (abs(b[0]) + b[1]) >> bits) + 2


def over(x: Interval, pivot: Interval, bits: int) -> Interval:
    """Return x / pivot; raise where the pivot may be 0."""
    least = abs(pivot[0]) - pivot[1]
    if least <= 0:
        raise ValueError("the equations are not shown to have one solution: a pivot may be 0")
    middle = (x[0] << bits) // pivot[0]
    return middle, ((x[1] << bits) + (abs(middle) + 1) * pivot[1]) // least + 2


def enclosed(rows: list[Row], right: list[Fraction], pivots: list[list[int]], bits: int) -> list[Interval]:
    """Return intervals that hold the one solution of the equations, by elimination; raise where they show none."""
    if any(sorted(places) != list(range(len(rows))) for places in zip(*pivots, strict=True)):
        raise ValueError("the pivots are not one for each equation and unknown")
    table = [{j: near(v, bits) for j, v in row.items() if v} for row in rows]
    side = [near(v, bits) for v in right]
    holding: list[set[int]] = [set() for _ in rows]
    for i, row in enumerate(table):
        for j in row:
            holding[j].add(i)
    for i, j in pivots:
        row = table[i]
        for c in row:
            holding[c].discard(i)
        for k in sorted(holding[j]):
            other = table[k]
            share = over(other.pop(j), row[j], bits)
            for c, value in row.items():
                if c != j:
                    other[c] = less(other.get(c, (0, 0)), share, value, bits)
                    holding[c].add(k)
            side[k] = less(side[k], share, side[i], bits)
    found: list[Interval] = [(0, 0)] * len(rows)
    for i, j in reversed(pivots):
        for c, value in table[i].items():
            if c != j:
                side[i] = less(side[i], value, found[c], bits)
        found[j] = over(side[i], table[i][j], bits)
    return found


def solution(data: Data, rows: list[Row], right: list[Fraction]) -> list[tuple[Fraction, Fraction]]:
    """Return a lower and an upper bound of each unknown; raise where the equations are not shown to have a solution."""
    if "solution" in data:
        x = [exact(text) for text in data["solution"]]
        for i, (row, b) in enumerate(zip(rows, right, strict=True)):
            if len(x) != len(rows) or sum((v * x[j] for j, v in row.items()), Fraction(0)) != b:
                raise ValueError(f"the solution does not satisfy equation {i}")
        return [(v, v) for v in x]
    leave_out(data, rows, right)
    bits, unit = int(data["bits"]), Fraction(1, 1 << int(data["bits"]))
    return [((m - r) * unit, (m + r) * unit) for m, r in enclosed(rows, right, data["pivots"], bits)]


def factor(x: Fraction) -> str:
    """Return the factor of a load group in words that stand for no other number."""
    value = float(x)
    short = f"{value:g}"
    if Fraction(short) == x:
        return short
    return repr(value) if Fraction(value) == x else str(x)


def least(condition: Condition, x: list[tuple[Fraction, Fraction]]) -> Fraction:
    """Return a lower bound of what must not be negative."""
    _, row, constant = condition
    return sum((v * x[j][v < 0] for j, v in row.items()), constant)


def check(data: Data) -> str:
    """Return what a certificate proves in a sentence; raise ValueError where it proves nothing."""
    plain = json.dumps({k: v for k, v in data.items() if k != "digest"}, sort_keys=True, separators=(",", ":"))
    if hashlib.sha256(plain.encode("ascii")).hexdigest() != data["digest"]:
        raise ValueError("the file was changed after it was written: its digest is another")
    if data["claim"] != "equilibrium":
        raise ValueError(f"the claim {data['claim']!r} is not for this program (verify.py: all but 'equilibrium')")
    structure(data)
    rows, right, signs = system(data)
    x = solution(data, rows, right)
    for condition in signs:
        if least(condition, x) < 0:
            last = (max(condition[1]) - (len(rows) - 2 * len(data["joints"]))) // 2
            raise ValueError(f"joint point {last} is not shown to be in its state: it may be {condition[0]}")
    widest = max((high - low for low, high in x), default=Fraction(0))
    how = f"proved, each number enclosed within {float(widest):.0e}" if widest else "proved exactly"
    states = [state for pair in data["states"] for state in pair]
    told = ", ".join(f"{states.count(s)} {s}" for s in ("open", "closed", "crushed"))
    slips = f"{states.count('+') + states.count('-')} at the limit of friction"
    scales = not data["shapes"] and not any(law(joint, "gap") for joint in data["joints"])
    sizes = ", with these compliances or any multiple of them" if scales else ""
    acting = ", ".join(f"{group} x {factor(exact(text))}" for group, text in data["constant"].items())
    points = f"{len(data['joints'])} joint points stated ({told}, {slips})"
    return f"{acting}: a Coulomb equilibrium of the {points}{sizes}: {how}"


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
