"""Serves a function of one ray behind a pipe (docs/pipe.md), in Python:

    from lostbits_pipe import serve
    serve(mine, name="mylib.sphere", roots="first")

serve calls mine(origin, direction, primitive, end), or with flags="range" mine(origin, direction, primitive, end,
start). The function returns t, (near, far) or True for a hit, and None or False for a miss. Print only to standard
error.
"""
import array
import math
import struct
import sys
from types import SimpleNamespace


def primitive_of(shape, n):
    if shape == "box":
        return SimpleNamespace(lo=n[:3], hi=n[3:])
    if shape == "triangle":
        return SimpleNamespace(a=n[:3], b=n[3:6], c=n[6:])
    if shape == "ellipsoid":
        return SimpleNamespace(centre=n[:3], radii=n[3:], radius=max(n[3:]))
    if shape == "cylinder":
        return SimpleNamespace(base=n[:3], top=n[3:6], radius=n[6])
    if shape == "tube":
        return SimpleNamespace(bottom=n[:3], top=n[3:6], radius=n[6])
    if shape == "cone":
        return SimpleNamespace(base=n[:3], top=n[3:6], base_radius=n[6], top_radius=n[7], radius=max(n[6:8]))
    if shape == "disc":
        return SimpleNamespace(centre=n[:3], normal=n[3:6], outer_radius=n[6], inner_radius=n[7], radius=n[6])
    if shape == "plane":
        return SimpleNamespace(through=n[:3], normal=n[3:])
    if shape == "torus":
        return SimpleNamespace(centre=n[:3], axis=n[3:6], major_radius=n[6], minor_radius=n[7], radius=n[6] + n[7])
    if shape == "capsule":
        return SimpleNamespace(start=n[:3], end=n[3:6], radius=n[6])
    return SimpleNamespace(centre=n[:3], radius=n[3])


def reach(origin, primitive, end):
    """Distance from the origin to a point behind the primitive: the distance of its middle plus its diameter or
    diagonal, or `end` if that is nearer."""
    pairs = (("centre", "centre"), ("lo", "hi"), ("base", "top"), ("start", "end"), ("bottom", "top"))
    low, high = next((getattr(primitive, a), getattr(primitive, b)) for a, b in pairs if hasattr(primitive, a))
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    return min(end, math.dist(middle, origin) + math.dist(low, high) + 2 * getattr(primitive, "radius", 0))


def roots_of(answer, kind, origin, direction, length):
    """Converts the answer of a function to (near, far) in t. Numbers are multiplied by `length`; points are not."""
    if kind == "thickness":
        return answer[0] * length, (answer[0] + answer[1]) * length
    if kind == "point":
        k = max(range(3), key=lambda i: abs(direction[i]))
        points = answer if hasattr(answer[0], "__len__") else (answer, answer)
        return tuple((p[k] - origin[k]) / direction[k] for p in points)
    return tuple(t * length for t in answer) if hasattr(answer, "__len__") else (answer * length, answer * length)


def serve(mine, name, takes="ray", answers="t", shape="sphere", **words):
    """Answers batches with `mine` until the input ends.

    If `takes` is "segment", calls mine(from, to, primitive), and t and thickness are fractions of the segment's length.
    `answers` says what `mine` returns: "t", "point" or "thickness". `words` are keys of the header. Numbers are floats
    of Python, which are doubles. Raises ValueError for a segment with a triangle or a plane.
    """
    if takes == "segment" and shape in ("triangle", "plane"):
        raise ValueError(f"a {shape} gives a segment no end behind it; use takes=\"ray\"")
    words.setdefault("direction", "unit" if takes == "segment" else "any")
    lines = ["lostbits-pipe/1", f"name={name}", f"shape={shape}", *(f"{k}={v}" for k, v in words.items()), "format=f64"]
    out = sys.stdout.buffer
    width = {"sphere": 4, "box": 6, "triangle": 9, "ellipsoid": 6, "cylinder": 7, "capsule": 7, "tube": 7, "cone": 8,
             "disc": 8, "plane": 6, "torus": 8}[shape]
    ranged = "range" in words.get("flags", "").split(",")
    out.write(("\n".join(lines) + "\n\n").encode())
    out.flush()

    def numbers(count):
        return memoryview(sys.stdin.buffer.read(8 * count)).cast("d").tolist()

    while request := sys.stdin.buffer.read(20):
        _, _, n, primitives, ended = struct.unpack("<4s4I", request)  # magic, form, rays, primitives, ends
        rays, starts = numbers(6 * n), numbers(ended if ranged else 0)
        ends, held = numbers(ended), numbers(width * primitives)
        near_far, hits = array.array("d", bytes(16 * n)), bytearray(n)
        for i in range(n):
            origin, direction = rays[6 * i:6 * i + 3], rays[6 * i + 3:6 * i + 6]
            place = 0 if primitives == 1 else width * i
            primitive, end = primitive_of(shape, held[place:place + width]), ends[i] if ended else math.inf
            length = reach(origin, primitive, end) if takes == "segment" else 1.0
            if takes == "segment":
                answer = mine(origin, [o + length * d for o, d in zip(origin, direction)], primitive)
            else:
                begin = [starts[i] if ended else 0.0] if ranged else []
                answer = mine(origin, direction, primitive, end, *begin)
            if answer is None or answer is False:
                continue
            hits[i] = 1
            if answer is not True:
                near_far[2 * i], near_far[2 * i + 1] = roots_of(answer, answers, origin, direction, length)
        out.write(struct.pack("<4sI", b"LBA1", 0) + near_far.tobytes() + bytes(hits))
        out.flush()
