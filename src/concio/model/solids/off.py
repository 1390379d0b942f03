"""OFF (Object File Format), text: vertices and faces; the blocks of one file are the closed parts of its surface."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from concio.errors import InputError
from concio.files import read_text
from concio.model.solids.shapes import Scene, Shape, check_size


def read_off(path: Path) -> Scene:
    """Return the surface of an OFF file; colours and normals are passed over.

    Raises
    ------
    InputError
        The file is missing, cut off, or not OFF; the message names the line.
    """
    where = str(path)
    lines = [(k, line.split("#", 1)[0].split()) for k, line in enumerate(read_text(path).split("\n"), 1)]
    lines = [(k, words) for k, words in lines if words]
    head = lines[0][1] if lines else [""]
    if re.fullmatch(r"(ST)?C?N?OFF", head[0]) is None or "BINARY" in head:
        msg = f"the file is not OFF as text: it begins with '{' '.join(head)[:40]}'"
        raise InputError(msg, where=where, hint="save it as OFF (text, three coordinates)")
    counts, start = (head[1:], 1) if len(head) > 1 else (lines[1][1] if len(lines) > 1 else [], 2)
    if len(counts) < 2 or not all(c.isdigit() and len(c) < 16 for c in counts[:2]):
        msg = "the numbers of vertices and faces do not follow the word OFF"
        raise InputError(msg, where=where, hint="write 'OFF', then '8 6 0'")
    vertices, faces = int(counts[0]), int(counts[1])
    check_size(vertices, where)
    if len(lines) < start + vertices + faces:
        msg = f"the file ends before its {vertices:,} vertices and {faces:,} faces"
        raise InputError(msg, where=where, hint="was it cut off? Save it once more")
    points, loops = [], []
    for k, (number, words) in enumerate(lines[start : start + vertices + faces]):
        try:
            if k < vertices:
                x, y, z = map(float, words[:3])
                points.append((x, y, z))
                continue
            length = int(words[0])
            loop = [int(w) for w in words[1 : 1 + length]]
        except ValueError:
            msg = f"line {number} cannot be read: '{' '.join(words)[:60]}'"
            raise InputError(msg, where=where, hint="write 'x y z' for vertices, '3 0 1 2' for faces") from None
        if length < 3 or len(loop) < length:
            msg = f"line {number}: a face of {length} vertices lists {len(loop)}"
            raise InputError(msg, where=where, hint="a face needs three vertices or more")
        if any(not 0 <= v < vertices for v in loop):
            msg = f"line {number}: a face uses a vertex that is not there: there are {vertices}"
            raise InputError(msg, where=where, hint="vertices are numbered from 0")
        loops.append(loop)
    return Scene((Shape(path.stem, "", np.array(points, dtype=float).reshape(-1, 3), loops),) if loops else ())
