"""Distances of computed points from their surface in binary32, as shares of the bounds of docs/offsets-proof.md.

    python3 tests/exact/theorems/offsets.py 20000     # points a search; prints the largest share of each bound

A point is put back onto a sphere as g + f (r/|f|), or is the sum of the vertices of a triangle by its weights. Numbers
are floats that are held in doubles: sums and products of two of them round once more, quotients and roots too. (A
double has more than 2 · 24 + 2 bits, so rounding to it first changes nothing.) Distances are computed in doubles.
"""
import math
import random
import struct
import sys

U = 2.0**-24


def fl(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def half_ulp(x):
    return 2.0**(math.frexp(x)[1] - 25) if x else 0.0


def dot(a, b):
    return fl(fl(fl(a[0] * b[0]) + fl(a[1] * b[1])) + fl(a[2] * b[2]))


def length(v):
    return math.sqrt(sum(x * x for x in v))


def share_of_sphere(centre, radius, near):
    """|distance to the sphere| over 9/2 u r + Σ |nᵢ| ½ulp(pᵢ), for a point p that is put back onto it."""
    f = [fl(near[i] - centre[i]) for i in range(3)]
    size = fl(math.sqrt(dot(f, f)))
    if size == 0:
        return 0
    scale = fl(radius / size)
    p = [fl(centre[i] + fl(f[i] * scale)) for i in range(3)]
    off = [p[i] - centre[i] for i in range(3)]
    distance = abs(sum(x * x for x in off) - radius * radius) / (length(off) + radius)
    n = [abs(x) / length(off) for x in off]
    return distance / (4.5 * U * radius + sum(n[i] * half_ulp(p[i]) for i in range(3)))


def share_of_triangle(a, b, c, weights):
    """Distance to the plane over 4u max over the vertices of Σ |nᵢ vᵢ|. The third weight is 1 − (w₀ + w₁)."""
    w = [*weights, fl(1 - fl(weights[0] + weights[1]))]
    if w[2] < 0:
        return 0
    p = [fl(fl(fl(w[0] * a[i]) + fl(w[1] * b[i])) + fl(w[2] * c[i])) for i in range(3)]
    u, v = ([q[i] - a[i] for i in range(3)] for q in (b, c))
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    size = length(n)
    if size < 1e-3:
        return 0
    n = [x / size for x in n]
    distance = abs(sum(n[i] * (p[i] - a[i]) for i in range(3)))
    return distance / (4 * U * max(sum(abs(n[i] * q[i]) for i in range(3)) for q in (a, b, c)))


def nudged(draw, x):
    """x changed by some last places, up to 2^12 of them."""
    return fl(x + draw.choice((-1, 1)) * 2 * half_ulp(x) * int(2**draw.uniform(0, 12)))


def search(share, start, points, seed):
    """The largest share that hill climbing over all numbers finds. `start` draws the arguments, as one list."""
    draw, best = random.Random(seed), 0
    now, value = None, 0
    for i in range(points):
        if i % 500 == 0:
            now = max((start(draw) for _ in range(20)), key=share)
            value = share(now)
        moved = list(now)
        for _ in range(draw.choice((1, 1, 2, 3))):
            k = draw.randrange(len(moved))
            moved[k] = nudged(draw, moved[k])
        found = share(moved)
        if found >= value:
            now, value = moved, found
        best = max(best, value)
    return best


def sphere(x):
    return share_of_sphere(x[:3], abs(x[3]), x[4:])


def some_sphere(draw):
    """A centre from next to the origin to 2^8 radii away, and a point near the sphere."""
    away = 2.0**draw.uniform(-6, 8)
    centre = [fl(draw.uniform(-1, 1) * away) for _ in range(3)]
    n = [draw.gauss(0, 1) for _ in range(3)]
    return centre + [1.0] + [fl(centre[i] + n[i] / length(n)) for i in range(3)]


def triangle(x):
    return share_of_triangle(x[:3], x[3:6], x[6:9], [abs(w) for w in x[9:]])


def some_triangle(draw):
    """Vertices from next to one another to across the origin, and weights."""
    away = 2.0**draw.uniform(-4, 8)
    at = [draw.uniform(-1, 1) * away for _ in range(3)]
    vertices = [fl(at[i] + draw.uniform(-1, 1)) for _ in range(3) for i in range(3)]
    w = draw.random()
    return vertices + [fl(w), fl(draw.random() * (1 - w))]


SEARCHES = (("sphere", sphere, some_sphere), ("triangle", triangle, some_triangle))

if __name__ == "__main__":
    for name, share, start in SEARCHES:
        print(f"{name}: {max(search(share, start, int(sys.argv[1]), seed) for seed in range(3)):.3f} of the bound")
