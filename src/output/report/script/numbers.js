"use strict";
// Numbers as the CSVs write them, and the metrics that are functions of t, t* and kappa alone.

const word = new DataView(new ArrayBuffer(8));

function highOf(x) {
    word.setFloat64(0, x);
    return word.getUint32(0);
}

function lowOf(x) {
    word.setFloat64(0, x);
    return word.getUint32(4);
}

/**
 * The shortest decimal that reads back to x, in the notation of the CSVs: the shorter of 100000 and 1e+05, and the
 * plain notation if both are equally long.
 */
function decimal(x) {
    if (Number.isNaN(x)) return "nan";
    if (!Number.isFinite(x)) return x < 0 ? "-inf" : "inf";
    if (x === 0) return Object.is(x, -0) ? "-0" : "0";
    const [mantissa, exponent] = Math.abs(x).toExponential().split("e");
    const digits = mantissa.replace(".", ""), e = Number(exponent), sign = x < 0 ? "-" : "";
    const scientific = mantissa + "e" + (e < 0 ? "-" : "+") + String(Math.abs(e)).padStart(2, "0");
    let plain;
    if (e < 0)
        plain = "0." +
            "0".repeat(-e - 1) + digits;
    else if (digits.length <= e + 1) plain = BigInt(Math.abs(x)).toString();  // all digits, as std::to_chars
    else plain = digits.slice(0, e + 1) + "." + digits.slice(e + 1);
    return sign + (plain.length <= scientific.length ? plain : scientific);
}

/** x exactly, as a C hexadecimal float. */
function hex(x) {
    if (!Number.isFinite(x)) return decimal(x);
    const high = highOf(x), biased = (high >>> 20) & 2047, sign = high >>> 31 ? "-" : "";
    if (x === 0) return sign + "0x0p+0";
    const fraction =
        ((high & 0xfffff).toString(16).padStart(5, "0") + lowOf(x).toString(16).padStart(8, "0")).replace(/0+$/, "");
    if (biased === 0) return `${sign}0x0.${fraction}p-1022`;
    const e = biased - 1023;
    return `${sign}0x1${fraction ? "." + fraction : ""}p${e < 0 ? "" : "+"}${e}`;
}

/** A short decimal for display; `decimal` is the exact one. */
function rounded(x) {
    if (!Number.isFinite(x)) return decimal(x);
    const size = Math.abs(x);
    if (x === Math.floor(x) && size < 1e7) return String(x);
    return size < 1e-3 || size >= 1e7 ? x.toExponential(2) : String(Number(x.toPrecision(4)));
}

/** floor(log2|x|) of a finite x other than 0. */
function binade(x) {
    const biased = (highOf(x) >>> 20) & 2047;
    if (biased !== 0) return biased - 1023;
    return ((highOf(x * 2 ** 1022) >>> 20) & 2047) - 1023 - 1022;
}

/** x 2^e, exact unless the result overflows or underflows. */
function scaled(x, e) {
    const half = Math.trunc(e / 2);
    return x * 2 ** half * 2 ** (e - half);
}

/**
 * The metrics of a hit on which form and truth agree. Inputs: t, t* = truth + rest, kappa, and the format's p and emin.
 * ulp_error has the precision of a float, because rest is a float, and t - truth is exact if the two are within a
 * factor of two.
 */
const derived = {
    ulp_error(s) {
        const overflow = 2 ** (1 - s.row.emin) * (2 - 2 ** -s.row.precision);  // from here on t* rounds to infinity
        if (!Number.isFinite(s.t)) return Math.sign(s.t) * s.truth >= overflow ? 0 : s.t;
        const e = Math.max(s.truth === 0 ? -Infinity : binade(s.truth), s.row.emin) - s.row.precision + 1;
        return scaled(s.t - s.truth, -e) - scaled(s.rest, -e);
    },
    lost_bits(s) {
        const size = Math.abs(derived.ulp_error(s));
        return size > 0.5 ? Math.min(Math.log2(size) + 1, s.row.precision) : 0;
    },
    correct_bits: (s) => s.row.precision - derived.lost_bits(s),
    absolute_error: (s) => (Number.isFinite(s.t) ? Math.abs(s.t - s.truth - s.rest) : Infinity),
    relative_error(s) {
        if (!Number.isFinite(s.t)) return Infinity;
        if (s.truth === 0) return s.t === 0 ? 0 : Infinity;
        return Math.abs((s.t - s.truth - s.rest) / s.truth);
    },
};
