// Numbers that do not round, to speak of: m 2^e with integers of any length, cut to 2048 bits as the program cuts them.
// What has no m (a zero of either sign, an infinity, a NaN) is a number of the language.

const exactBits = 2048;

const isSpecial = (x) => typeof x === "number";
/** Enough of x to know what an operation with a special number makes of it. */
const signOf = (x) => (isSpecial(x) ? x : x.m < 0n ? -1 : 1);
const sizeOf = (m) => (m < 0n ? -m : m);

/** Bits of a positive integer. */
function lengthOf(m) {
    const digits = m.toString(16);
    return 4 * digits.length - Math.clz32(parseInt(digits[0], 16)) + 28;
}

/** floor(log2|x|) of x that is not special. */
const exactBinade = (x) => lengthOf(sizeOf(x.m)) + x.e - 1;

function lift(x) {
    if (x === 0 || !Number.isFinite(x)) return x;
    const biased = (highOf(x) >>> 20) & 2047, fraction = (BigInt(highOf(x) & 0xfffff) << 32n) | BigInt(lowOf(x));
    const m = biased === 0 ? fraction : fraction | (1n << 52n);
    return { m: x < 0 ? -m : m, e: Math.max(biased, 1) - 1075 };
}

/** `-1a2bp-12`: an integer in hexadecimal and a power of two. A number is itself. */
function readExact(text) {
    if (typeof text === "number") return lift(text);
    if (text === "inf" || text === "-inf") return text === "inf" ? Infinity : -Infinity;
    const [digits, e] = text.split("p"), negative = digits[0] === "-",
                   m = BigInt(`0x${negative ? digits.slice(1) : digits}`);
    return m === 0n ? 0 : { m: negative ? -m : m, e: Number(e) };
}

/** m 2^e to a multiple of 2^q, to nearest, ties to even; `beyond`: there is more below m's last bit. */
function toMultiple({ m, e, beyond }, q) {
    if (e >= q) return m << BigInt(e - q);
    const by = BigInt(q - e), size = sizeOf(m), kept = size >> by, rest = size - (kept << by), half = 1n << (by - 1n);
    const up = rest > half || (rest === half && (beyond || (kept & 1n) === 1n));
    return (m < 0n ? -1n : 1n) * (kept + (up ? 1n : 0n));
}

function cut(x) {
    if (isSpecial(x)) return x;
    const q = exactBinade(x) - exactBits + 1;
    return x.e >= q ? { m: x.m, e: x.e } : { m: toMultiple(x, q), e: q };
}

/** x in a format {precision, emin, emax}, to nearest, ties to even. */
function toFormat(x, { precision, emin, emax }) {
    if (isSpecial(x)) return x;
    const q = Math.max(exactBinade(x), emin) - precision + 1, m = toMultiple(x, q);
    if (m === 0n) return x.m < 0n ? -0 : 0;
    if (lengthOf(sizeOf(m)) + q - 1 > emax) return x.m < 0n ? -Infinity : Infinity;
    return scaled(Number(m), q);
}

const binary64 = {
    precision: 53,
    emin: -1022,
    emax: 1023
},
      binary32 = {
          precision: 24,
          emin: -126,
          emax: 127
      };
const nearest = (x) => toFormat(x, binary64);

/** The operations before any cut: with `beyond` where a quotient or a root goes on below `bits` bits. */
const uncut = {
    add(a, b) {
        if (isSpecial(a)) return isSpecial(b) ? a + b : a === 0 ? b : a;
        if (isSpecial(b)) return b === 0 ? a : b;
        const e = Math.min(a.e, b.e), m = (a.m << BigInt(a.e - e)) + (b.m << BigInt(b.e - e));
        return m === 0n ? 0 : { m, e };
    },
    sub: (a, b) => uncut.add(a, negated(b)),
    mul: (a, b) => (isSpecial(a) || isSpecial(b) ? signOf(a) * signOf(b) : { m: a.m * b.m, e: a.e + b.e }),
    fma: (a, b, c) => uncut.add(uncut.mul(a, b), c),
    div(a, b, bits = exactBits) {
        if (isSpecial(a) || isSpecial(b)) return signOf(a) / signOf(b);
        const by = Math.max(0, bits + 2 + lengthOf(sizeOf(b.m)) - lengthOf(sizeOf(a.m))), whole = a.m << BigInt(by),
              m = whole / b.m;
        return { m, e: a.e - by - b.e, beyond: m * b.m !== whole };
    },
    sqrt(a, bits = exactBits) {
        if (isSpecial(a)) return Math.sqrt(a);
        if (a.m < 0n) return NaN;
        let by = Math.max(0, 2 * (bits + 2) - lengthOf(a.m));
        by += (a.e - by) & 1;
        const whole = a.m << BigInt(by), m = rootOf(whole);
        return { m, e: (a.e - by) / 2, beyond: m * m !== whole };
    },
};

const negated = (x) => (isSpecial(x) ? -x : { m: -x.m, e: x.e, beyond: x.beyond });
const magnitude = (x) => (isSpecial(x) ? Math.abs(x) : { m: sizeOf(x.m), e: x.e });

/** floor(sqrt n): Newton's steps from above, of which each doubles the bits. */
function rootOf(n) {
    const by = Math.max(0, lengthOf(n) - 104) & ~1;
    let x = BigInt(Math.ceil(Math.sqrt(Number(n >> BigInt(by)))) + 2 ** 10) << BigInt(by / 2);
    for (;;) {
        const y = (x + n / x) >> 1n;
        if (y >= x) return x;
        x = y;
    }
}

/**
 * Quotients and roots that are equal differ where they were cut: what is left of a sum below 2^-1900 of its parts is
 * taken for nothing, or the sign of an offset that is zero would be one of noise.
 */
function sumOf(a, b) {
    const s = cut(uncut.add(a, b));
    return !isSpecial(a) && !isSpecial(b) && !isSpecial(s) &&
            exactBinade(s) < Math.max(exactBinade(a), exactBinade(b)) - 1900 ?
        0 :
        s;
}

const exactly = {
    add: sumOf,
    sub: (a, b) => sumOf(a, negated(b)),
    mul: (a, b) => cut(uncut.mul(a, b)),
    fma: (a, b, c) => sumOf(exactly.mul(a, b), c),
    div: (a, b) => cut(uncut.div(a, b)),
    sqrt: (a) => cut(uncut.sqrt(a)),
};

function isLess(a, b) { return isSpecial(a) || isSpecial(b) ? signOf(a) < signOf(b) : signOf(exactly.sub(a, b)) < 0; }

function isLessOrEqual(a, b) {
    return isSpecial(a) || isSpecial(b) ? signOf(a) <= signOf(b) : signOf(exactly.sub(a, b)) <= 0;
}
