"""The largest first-order backward error of sphere forms, over all roundings, for rays that a search moves about.

    python3 tests/exact/theorems/backward.py 20000     # rays a search; prints the worst ray of each form and root

Each form is recorded as a tape, a list of its operations. Each operation multiplies its result by 1 + δ, |δ| ≤ u. To
first order the δ move the residual R = |f + t d|² − r² by at most u Σ |∂R/∂t ∂t/∂v v| over the results v. Changes of
all inputs by ε move it by 2ε (Σ |Pᵢ| (|fᵢ| + t |dᵢ|) + r²) at most, P = f + t d. The quotient bounds the backward
error, and roundings of these signs and sizes attain it. The proof in docs/stability.md uses simpler and larger bounds.
"""
import math
import random
import sys


class Tape:
    """Results of operations, with the derivative by each operand, and a mark on the results that are rounded."""

    def __init__(self):
        self.values, self.operands, self.rounds = [], [], []

    def put(self, value, operands, rounds=True):
        self.values.append(value)
        self.operands.append(operands)
        self.rounds.append(rounds)
        return len(self.values) - 1

    def number(self, x):
        return self.put(x, [], False)

    def rounded(self, i):
        return self.put(self.values[i], [(i, 1)])

    def add(self, i, j, sign=1):
        return self.put(self.values[i] + sign * self.values[j], [(i, 1), (j, sign)])

    def mul(self, i, j):
        x, y = self.values[i], self.values[j]
        return self.put(x * y, [(i, y), (j, x)])

    def div(self, i, j):
        x, y = self.values[i], self.values[j]
        return self.put(x / y, [(i, 1 / y), (j, -x / y**2)])

    def sqrt(self, i):
        root = math.sqrt(self.values[i])
        return self.put(root, [(i, 1 / (2 * root))])

    def scale(self, i, power_of_two):
        return self.put(power_of_two * self.values[i], [(i, power_of_two)], False)

    def dot(self, a, b):
        return self.add(self.add(self.mul(a[0], b[0]), self.mul(a[1], b[1])), self.mul(a[2], b[2]))

    def adjoints(self, output):
        by = [0.0] * len(self.values)
        by[output] = 1.0
        for k in range(output, -1, -1):
            for i, derivative in self.operands[k]:
                by[i] += derivative * by[k]
        return by


def roots_of_unified(t, a, minus_b, c, root):
    ahead = t.values[minus_b] >= 0
    q = t.add(minus_b, root, 1 if ahead else -1)
    pair = t.div(c, q), t.div(q, a)
    return pair if ahead else pair[::-1]


def unified(t, f, d, r):
    a, minus_b, r2 = t.dot(d, d), t.scale(t.dot(f, d), -1), t.mul(r, r)
    foot = t.div(minus_b, a)
    line = [t.add(f[i], t.mul(foot, d[i])) for i in range(3)]
    delta = t.add(r2, t.dot(line, line), -1)
    if t.values[delta] <= 0:
        return None
    return roots_of_unified(t, a, minus_b, t.add(t.dot(f, f), r2, -1), t.sqrt(t.mul(a, delta)))


def cross_product(t, f, d, r):
    a, minus_b, r2 = t.dot(d, d), t.scale(t.dot(f, d), -1), t.mul(r, r)
    m = [t.add(t.mul(f[j], d[k]), t.mul(d[j], f[k]), -1) for j, k in ((1, 2), (2, 0), (0, 1))]
    disc = t.add(t.mul(a, r2), t.dot(m, m), -1)
    if t.values[disc] <= 0:
        return None
    return roots_of_unified(t, a, minus_b, t.add(t.dot(f, f), r2, -1), t.sqrt(disc))


def hearn_baker(t, f, d, r):
    a, b = t.dot(d, d), t.scale(t.dot(f, d), 2)
    length = t.sqrt(a)
    unit = [t.div(x, length) for x in d]
    along = t.dot(f, unit)
    line = [t.add(f[i], t.mul(along, unit[i]), -1) for i in range(3)]
    delta = t.add(t.mul(r, r), t.dot(line, line), -1)
    if t.values[delta] <= 0:
        return None
    root, minus_b, two_a = t.sqrt(t.mul(t.scale(a, 4), delta)), t.scale(b, -1), t.scale(a, 2)
    return t.div(t.add(minus_b, root, -1), two_a), t.div(t.add(minus_b, root), two_a)


def embree_point(t, f, d, r):
    inverse = t.div(t.number(1.0), t.dot(d, d))
    g = [t.scale(x, -1) for x in f]
    foot = t.mul(t.dot(g, d), inverse)
    across = [t.add(g[i], t.mul(foot, d[i]), -1) for i in range(3)]
    delta = t.add(t.mul(r, r), t.dot(across, across), -1)
    if t.values[delta] <= 0:
        return None
    half = t.sqrt(t.mul(delta, inverse))
    return t.add(foot, half, -1), t.add(foot, half)


def bound(form, f, d, r, near):
    """The largest first-order backward error in u, or None for a miss. f is o − g, which the form rounds."""
    t = Tape()
    roots = form(t, [t.rounded(t.number(x)) for x in f], [t.number(x) for x in d], t.number(r))
    if roots is None:
        return None
    root = roots[0 if near else 1]
    time, by = t.values[root], t.adjoints(root)
    p = [f[i] + time * d[i] for i in range(3)]
    slope = 2 * sum(p[i] * d[i] for i in range(3))
    moved = sum(abs(slope * by[i] * t.values[i]) for i in range(len(by)) if t.rounds[i])
    return moved / (2 * (sum(abs(p[i]) * (abs(f[i]) + abs(time * d[i])) for i in range(3)) + r * r))


def length(v):
    return math.sqrt(sum(x * x for x in v))


def across(l, d, most):
    """The part of l across d, shortened to less than a radius."""
    along = sum(l[i] * d[i] for i in range(3)) / sum(x * x for x in d)
    l = [l[i] - along * d[i] for i in range(3)]
    size = length(l)
    return [x * most / size for x in l] if size > most else l


def search(form, near, rays, seed, least=1.0, most=1e4):
    """The largest bound, how far the origin is from the centre and the line, in radii. The sphere has radius 1."""
    draw, worst, kept = random.Random(seed), (0,), None
    for _ in range(rays):
        if kept is None or draw.random() < 0.3:
            d, l = ([draw.choice((-1, 1)) * 2**draw.uniform(-8, 0) for _ in range(3)] for _ in range(2))
            l, size = across(l, d, 1e-9), draw.random()**0.3
            l = [x * size * 1e9 for x in l]
            foot = (2**draw.uniform(-1, 12) if near else draw.uniform(-1, 1)) / length(d)
        else:
            d, l, foot = kept
            d = [x * (1 + 0.2 * draw.gauss(0, 1)) for x in d]
            l = [x * (1 + 0.1 * draw.gauss(0, 1)) for x in l]
            foot = foot * 2**(0.5 * draw.gauss(0, 1)) if near else foot + 0.1 * draw.gauss(0, 1)
        l = across(l, d, 0.9999)
        f = [l[i] - foot * d[i] for i in range(3)]
        distance = length(f)
        if (foot < 0 or not max(1.0, least) < distance < most) if near else distance > 1 - 2**-7:
            continue
        found = bound(form, f, d, 1.0, near)
        if found is not None and found > worst[0]:
            worst, kept = (found, distance, length(l)), (d, l, foot)
    return worst


FORMS = {unified: 6, cross_product: 6, hearn_baker: 6.5, embree_point: 6}  # with the constants that are proved

if __name__ == "__main__":
    for tried in FORMS:
        for root in (True, False):
            worst = max(search(tried, root, int(sys.argv[1]), seed, 1 + 2**-7) for seed in range(2))
            print(f"{tried.__name__}, {'near' if root else 'far'} root: {worst[0]:.3f} u, {worst[1]:.4g} radii away, "
                  f"{worst[2]:.4g} radii off the centre")
