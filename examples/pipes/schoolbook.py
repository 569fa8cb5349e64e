#!/usr/bin/env python3
"""A ray/sphere intersector in Python behind a pipe: lostbits map near-benign --pipe examples/pipes/schoolbook.py -o out

Replace `schoolbook` by your own function. With numpy a batch is computed at once, in float32 and float64. Without
numpy, rays are computed one by one in Python's floats, which are doubles. Print only to standard error.
"""
import array
import math
import struct
import sys

try:
    import numpy
except ImportError:
    numpy = None


def schoolbook(rays, sphere):
    """rays: n x 6 (origin, direction). sphere: x, y, z, radius, or n x 4. Returns near, far and hit, n items each."""
    sphere = numpy.atleast_2d(sphere)
    f, d = rays[:, :3] - sphere[:, :3], rays[:, 3:]
    a, b = (d * d).sum(1), 2 * (f * d).sum(1)
    c = (f * f).sum(1) - sphere[:, 3] * sphere[:, 3]
    disc = b * b - 4 * a * c
    with numpy.errstate(all="ignore"):
        root = numpy.sqrt(disc)
        return (-b - root) / (2 * a), (-b + root) / (2 * a), disc >= 0


def schoolbook_of_one(ray, sphere):
    """Does the same for one ray. Returns (near, far), or None for a miss."""
    f, d = [ray[k] - sphere[k] for k in range(3)], ray[3:]
    a, b = sum(x * x for x in d), 2 * sum(x * y for x, y in zip(f, d))
    disc = b * b - 4 * a * (sum(x * x for x in f) - sphere[3] * sphere[3])
    if not disc >= 0 or a == 0:
        return None
    return (-b - math.sqrt(disc)) / (2 * a), (-b + math.sqrt(disc)) / (2 * a)


# The forms that this program offers, in the order of the header: format, and type code of the numbers.
FORMS = [("f32", "f"), ("f64", "d")] if numpy else [("f64", "d")]


def header():
    lines = ["lostbits-pipe/1"]
    for form, _ in FORMS:
        lines += ["name=python.schoolbook", "shape=sphere", f"format={form}", "roots=both", "flags=line",
                  "title=the schoolbook formula in Python"]
    return "\n".join(lines) + "\n\n"


def answer(kind, rays, primitives, n):
    """Returns the bytes of an answer: near and far of every ray, then a byte per ray, 1 for a hit."""
    if numpy:
        kind = numpy.dtype(kind)
        all_rays = numpy.frombuffer(rays, kind).reshape(n, 6)
        near, far, hit = schoolbook(all_rays, numpy.frombuffer(primitives, kind).reshape(-1, 4))
        return numpy.stack([near, far], 1).astype(kind).tobytes() + hit.astype(numpy.uint8).tobytes()
    numbers, spheres = memoryview(rays).cast(kind), memoryview(primitives).cast(kind)
    near_far, hits = array.array(kind), bytearray()
    for i in range(n):
        place = 4 * i if len(spheres) > 4 else 0
        found = schoolbook_of_one(numbers[6 * i:6 * i + 6].tolist(), spheres[place:place + 4].tolist())
        near_far.extend(found or (0.0, 0.0))
        hits.append(found is not None)
    return near_far.tobytes() + bytes(hits)


def main():
    read, write = sys.stdin.buffer.read, sys.stdout.buffer
    write.write(header().encode())
    write.flush()
    while request := read(20):  # magic, form, rays, primitives, ends
        _, form, n, primitives, ends = struct.unpack("<4s4I", request)
        kind = FORMS[form][1]
        width = struct.calcsize(kind)
        rays = read(6 * n * width)
        read(ends * width)  # ends of the rays, not used here
        spheres = read(4 * primitives * width)
        write.write(struct.pack("<4sI", b"LBA1", 0) + answer(kind, rays, spheres, n))
        write.flush()


main()
