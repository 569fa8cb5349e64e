"""Computes the decisions of examples/shards/ten-billion.toml in whole numbers, without any code of lostbits.

    exact_decisions.py counts BINADES.csv   compares every count of hits in a merged result with the exact one
    exact_decisions.py rays N SEED OUT.raw  writes N random rays of the sweep, with the right decision for each

Let v = o - c, A = |d|^2, B = v.d and C = |v|^2 - r^2. A ray o + t d hits the closed ball |p - c| <= r at some t >= 0 if
B^2 >= A C and the far root (-B + sqrt(B^2 - A C)) / A is not negative, that is B <= 0 or C <= 0. Every float is a whole
multiple of 2^-149, so these tests are exact.

The origins from which a ray of one direction hits a ball are the ball and all points from which the ball lies ahead.
They form a convex set, so those on the line of the eyes are consecutive. Bisection finds the first and the last.
"""
import csv
import random
import struct
import sys

UNIT = 149  # every finite float times 2^149 is a whole number
CENTRE = (0.5, -0.25, -0.25)
RADIUS = float.fromhex("0x1.3988e2p-1")
RAYS = {  # y and z of the origin, and the direction; x is the float that is tried
    "grazing": ((0.25, float.fromhex("0x1.a827a2p-4")), (-1.0, 0.0, 0.0)),
    "oblique": ((0.0, 0.0), (-1.0, -0.5, -0.25)),
    "crossing": ((0.0, 0.0), (1.0, -0.25, -2.0)),
}


def whole(x):
    numerator, denominator = x.as_integer_ratio()
    return numerator * (1 << UNIT) // denominator


SCALED_CENTRE = [whole(x) for x in CENTRE]
SCALED_RADIUS_SQUARED = whole(RADIUS) ** 2
SCALED_ORIGIN = {name: [whole(x) for x in yz] for name, (yz, _) in RAYS.items()}
FOUR_TIMES = {name: [int(4 * x) for x in d] for name, (_, d) in RAYS.items()}  # their numbers are multiples of 1/4


def hits(name, x):
    """Returns True if the ray from x, a finite float, hits the ball."""
    v = [at - c for at, c in zip([whole(x), *SCALED_ORIGIN[name]], SCALED_CENTRE)]
    d = FOUR_TIMES[name]
    a = sum(x * x for x in d)
    b = sum(x * y for x, y in zip(v, d))
    c = sum(x * x for x in v) - SCALED_RADIUS_SQUARED
    return b * b >= a * c and (b <= 0 or c <= 0)


def float_of(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def from_order(k):
    """Returns the k-th finite float counted from zero. Negative k give the negative floats."""
    return float_of(k) if k >= 0 else -float_of(-k)


def order_of(x):
    bits = struct.unpack("<I", struct.pack("<f", x))[0]
    return bits if bits < 1 << 31 else -(bits - (1 << 31))


def edge(name, inside, outside):
    """Returns the last k that hits, from `inside`, which hits, towards `outside`, which may not."""
    if hits(name, from_order(outside)):
        return outside
    while abs(outside - inside) > 1:
        middle = (inside + outside) // 2
        if hits(name, from_order(middle)):
            inside = middle
        else:
            outside = middle
    return inside


LARGEST = 0x7F7FFFFF


def hitting(name):
    """Returns the first and the last k that hit."""
    inside = [k for k in range(-LARGEST, LARGEST, 0x2000) if hits(name, from_order(k))]
    if not inside:
        raise SystemExit(f"{name}: no origin that hits was found among every 8192nd float; use a finer step")
    return edge(name, inside[0], -LARGEST), edge(name, inside[-1], LARGEST)


def count(name, span, low, high):
    """Counts the floats with low <= k <= high that hit. Zero is one float."""
    return max(0, min(span[1], high) - max(span[0], low) + 1)


def check_counts(path):
    spans = {name: hitting(name) for name in RAYS}
    rays = wrong = 0
    for row in csv.DictReader(open(path)):
        rays += int(row["floats"])
        truly = int(row["agree_hit"]) + int(row["false_miss"])
        if "nan" in row["binade"].lower() or "inf" in row["binade"].lower():
            exact = 0
        else:
            ends = sorted(order_of(float.fromhex(row[end])) for end in ("from_hex", "to_hex"))
            exact = count(row["ray"], spans[row["ray"]], *ends) if row["binade"] != "-0" else int(hits(row["ray"], 0.0))
        if truly != exact:
            wrong += 1
            print(f"{row['form']} {row['ray']} {row['binade']}: {truly} hits, but the exact count is {exact}")
    print(f"{rays} rays, {wrong} of the counts differ")
    return wrong


def write_rays(count_of_rays, seed, path):
    chance = random.Random(seed)
    names = list(RAYS)
    with open(path, "wb") as out:
        written = 0
        while written < count_of_rays:
            x = float_of(chance.getrandbits(32))
            if x != x or x in (float("inf"), float("-inf")):
                continue
            name = names[chance.randrange(3)]
            yz, d = RAYS[name]
            out.write(struct.pack("<6fB", x, *yz, *d, hits(name, x)))
            written += 1


if __name__ == "__main__":
    if sys.argv[1] == "counts":
        sys.exit(1 if check_counts(sys.argv[2]) else 0)
    write_rays(int(sys.argv[2]), int(sys.argv[3]), sys.argv[4])
