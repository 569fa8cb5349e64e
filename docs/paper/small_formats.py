"""The worst padding of slabs in formats of few bits, by trying every significand: a check of three theorems of paper.tex,
and of the theorem about division in docs/bounds.md.

    python3 docs/paper/small_formats.py 4 9     # the worst rays for each number of bits from 4 to 9

A ray that hits a box enters through a plane of one axis no later than it leaves through one of another. Let such an
axis have the direction d and the rounded difference S, both with significands from 2^(p-1) to 2^p - 1. The true
difference may be anything that rounds to S. So the true time lies between (S - 1/2)/d and (S + 1/2)/d, and the computed
one is fl(S fl(1/d)), or fl(S/d) by division. Powers of two change nothing.
"""
import sys
from fractions import Fraction


def rounded(n, d):
    """n/d to the nearest whole number, ties to even."""
    q, rest = divmod(n, d)
    return q + (2 * rest > d or (2 * rest == d and q % 2))


def times(p, divides=False):
    """For the significand of each computed time: the earliest and the latest true time, in units of its last place."""
    half, earliest, latest = 2**(p - 1), {}, {}
    for d in range(half, 2 * half):
        reciprocal = rounded(2**(2 * p - 1), d)
        for s in range(half, 2 * half):
            # n/q is the number that is rounded last, times 2^(2p - 1).
            n, q = (s * 2**(2 * p - 1), d) if divides else (s * reciprocal, 1)
            shift = (n // q).bit_length() - p
            m = rounded(n, q * 2**shift)
            if m == 2 * half:
                m, shift = half, shift + 1
            unit = Fraction(2**(2 * p - 1), d * 2**shift)
            below = Fraction(1, 4 if s == half else 2)  # the numbers below a power of two are twice as dense
            earliest[m] = min(earliest.get(m, (s - below) * unit), (s - below) * unit)
            latest[m] = max(latest.get(m, (s + Fraction(1, 2)) * unit), (s + Fraction(1, 2)) * unit)
    return earliest, latest


def parted(p, divides=False):
    """(tmax, tmin) of all rays that hit, where tmin > tmax, as numbers of last places of tmax."""
    half = 2**(p - 1)
    earliest, latest = times(p, divides)
    for exit in sorted(latest):
        for steps in range(1, 9):
            entry, scale = exit + steps, 1
            if entry >= 2 * half:
                entry, scale = half + entry - 2 * half, 2
            if entry in earliest and earliest[entry] * scale <= latest[exit]:
                yield exit, entry * scale


def padded(tmax, k, p):
    """fl(tmax (1 + 2k u)), in last places of tmax."""
    product = tmax * (2**(p - 1) + k)
    shift = p - 1 if product < 2**(2 * p - 1) else p
    return rounded(product, 2**shift) * 2**(shift - p + 1)


def worst(p, divides=False):
    """The largest padding (tmin - tmax)/tmax in u, and its tmax and tmin."""
    return max((Fraction((entry - exit) * 2**p, exit), exit, entry) for exit, entry in parted(p, divides))


if __name__ == "__main__":
    for bits in range(int(sys.argv[1]), int(sys.argv[2]) + 1):
        for name, divides in (("by 1/d", False), ("divided", True)):
            padding, exit, entry = worst(bits, divides)
            print(f"{bits} bits, {name}: {float(padding):.4f} u, {entry - exit} last places at a significand of "
                  f"{exit / 2**(bits - 1):.4f}")
