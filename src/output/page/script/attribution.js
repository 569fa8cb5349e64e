// The operations of one ray: a form's tape run again in its format and without rounding, and the error of t shared out
// among them. What src/measure/blame/attribution.cpp and operation_error.cpp do, over integers of any length where
// those have MPFR; the browser test holds the two against each other.

const comparisons = ["less", "less_equal", "greater", "greater_equal"];
const isComparison = (n) => comparisons.includes(n.op);
const isDecision = (n) => isComparison(n) || ["both", "either", "opposite", "any"].includes(n.op);
const isOperation = (n) => !isDecision(n) && n.op !== "input" && n.op !== "constant";
const isChoice = (n) => n.op === "select" || n.op === "min" || n.op === "max";
const signBit = (x) => x < 0 || Object.is(x, -0);

/** The neighbour above, IEEE 754's nextUp. */
function nextUp(a, format) {
    const { precision, emin, emax } = format;
    if (Number.isNaN(a) || a === Infinity) return a;
    if (a === 0) return 2 ** (emin - precision + 1);
    if (a === -Infinity) return -scaled(2 - 2 ** (1 - precision), emax);
    const e = binade(a), onPower = Math.abs(a) === scaled(1, e);
    let q = Math.max(e, emin) - precision + 1;
    if (a < 0 && e > emin && onPower) --q;
    const next = toFormat(uncut.add(lift(a), { m: 1n, e: q }), format);
    return next === 0 && a < 0 ? -0 : next;
}

/** What an operation makes of numbers of a format; of a decision, whether it holds. */
function computed(op, [a, b, c], format) {
    switch (op) {
        case "neg":
            return -a;
        case "abs":
            return Math.abs(a);
        case "copysign":
            return signBit(a) === signBit(b) ? a : -a;
        case "min":
            return a < b ? a : b;
        case "max":
            return a > b ? a : b;
        case "select":
            return a ? b : c;
        case "next_up":
            return nextUp(a, format);
        case "next_down":
            return -nextUp(-a, format);
        case "constant":
        case "convert":
            return toFormat(lift(a), format);
        case "less":
            return a < b;
        case "less_equal":
            return a <= b;
        case "greater":
            return a > b;
        case "greater_equal":
            return a >= b;
        case "both":
            return a && b;
        case "either":
            return a || b;
        case "opposite":
            return !a;
        case "any":
            return a;
    }
    return toFormat(inFull(op, [a, b, c].map((x) => (x === undefined ? x : lift(x)))), format);
}

/** One of + - * / sqrt fma; of a quotient or a root so many bits that it rounds rightly to any format. */
function inFull(op, [a, b, c]) {
    if (op === "sqrt") return uncut.sqrt(a, 64);
    return op === "div" ? uncut.div(a, b, 64) : uncut[op](a, b, c);
}

/** computed - the exact operation on the operands as computed. */
function roundingOf(n, x) {
    if (n.op === "constant") return n.value - n.operands[0];
    if (!isOperation(n) || x.some((v) => typeof v === "number" && !Number.isFinite(v))) return 0;
    if (["next_up", "next_down", "convert"].includes(n.op)) return n.value - x[0];
    if (!["add", "sub", "mul", "div", "sqrt", "fma"].includes(n.op)) return 0;
    if (Number.isNaN(n.value) || (n.op === "div" && x[1] === 0)) return 0;
    if (!Number.isFinite(n.value)) return n.value;
    const [a, b, c] = x.map(lift);
    return nearest(uncut.sub(lift(n.value), exactly[n.op](a, b, c)));
}

/** max(exponent of operands) - exponent of result of a sum. */
function cancellationOf(n, x) {
    if (n.op !== "add" && n.op !== "sub" && n.op !== "fma") return 0;
    const [a, b] = n.op === "fma" ? [x[0] * x[1], x[2]] : x, largest = Math.max(Math.abs(a), Math.abs(b));
    if (!Number.isFinite(a) || !Number.isFinite(b) || !Number.isFinite(n.value) || largest === 0) return 0;
    return n.value === 0 ? n.format.precision : Math.max(0, binade(largest) - binade(n.value));
}

/**
 * By how much each operand's error is multiplied: the quotients between operands as computed (1) and exact (0); null:
 * not at all.
 */
function quotients(n, now, exact, chosen) {
    const [a1, b1] = now, [a0, b0] = exact;
    const unsigned = () =>
        (signBit(a1) === signBit(a0) ? (signBit(a1) ? -1 : 1) : (Math.abs(a1) - Math.abs(a0)) / (a1 - a0));
    switch (n.op) {
        case "add":
            return [1, 1];
        case "sub":
            return [1, -1];
        case "mul":
            return [b0 / 2 + b1 / 2, a0 / 2 + a1 / 2];
        case "fma":
            return [b0 / 2 + b1 / 2, a0 / 2 + a1 / 2, 1];
        case "div":
            return [(1 / b0 + 1 / b1) / 2, -(a0 / b0 / b1 + a1 / b0 / b1) / 2];
        case "sqrt": {
            const sum = Math.sqrt(a0) + Math.sqrt(a1);
            return [sum === 0 ? 0 : 1 / sum];
        }
        case "neg":
            return [-1];
        case "abs":
            return [unsigned()];
        case "copysign":
            return [signBit(b1) ? -unsigned() : unsigned(), null];
        case "next_up":
        case "next_down":
        case "convert":
            return [1];
    }
    if (isComparison(n)) return [1, -1];
    const first = isChoice(n) ? n.operands.findIndex((o, k) => o === chosen && (n.op !== "select" || k > 0)) : -1;
    return n.operands.map((_, k) => (k === first ? 1 : null));
}

/**
 * A tape as the page holds it and the inputs of a ray; see `Attribution` and `OperationError` in
 * src/measure/blame/attribution.hpp.
 */
class Walk {
    constructor(tape, inputs) {
        this.nodes = tape.nodes.map(([op, format, ...operands]) => ({
                                        op,
                                        operands,
                                        format: tape.formats[format],
                                        error: 0,
                                        rounding: 0,
                                        adjoint: 0,
                                        contribution: 0,
                                        cancelled: 0,
                                        local: 0,
                                        carried: false,
                                        live: false,
                                        turned: false
                                    }));
        this.inputs = inputs;
        [this.hit, this.t] = tape.outputs;
        for (const n of this.nodes) this.forward(n);
        this.subject = this.at(this.hit).turned ? this.turnedComparison(this.hit) : this.t;
        this.explained = 0;
        this.culprit = -1;
        if (this.subject >= 0) this.attribute(this.subject);
        // The t of a miss is not an answer, so no operation is its culprit.
        this.plainMiss = !this.at(this.hit).value && !this.at(this.hit).turned;
        if (this.plainMiss) this.culprit = -1;
    }
    at(i) { return this.nodes[i]; }
    valuesOf(n) { return n.op === "constant" ? n.operands : n.operands.map((o) => this.at(o).value); }

    forward(n) {
        if (n.op === "input") {
            n.value = this.inputs[n.operands[0]];
            n.full = lift(n.value);
            n.exact = n.value;
            return;
        }
        const x = this.valuesOf(n);
        n.value = computed(n.op, x, n.format);
        if (isDecision(n)) return this.decide(n);
        this.without(n, n.op === "constant" ? n.operands.map(lift) : n.operands.map((o) => this.at(o).full));
        n.exact = nearest(n.full);
        n.error = nearest(uncut.sub(lift(n.value), n.full));
        if (!n.turned) n.rounding = roundingOf(n, x);
        n.cancelled = cancellationOf(n, x);
        n.carried = n.op !== "constant" && n.operands.some((o) => this.at(o).error !== 0);
        n.local = this.localBits(n);
    }

    decide(n) {
        const [a, b] = n.operands.map((o) => (isComparison(n) ? this.at(o).full : this.at(o).exact));
        const rules = {
            less: () => isLess(a, b),
            less_equal: () => isLessOrEqual(a, b),
            greater: () => isLess(b, a),
            greater_equal: () => isLessOrEqual(b, a)
        };
        n.exact = isComparison(n) ? rules[n.op]() : computed(n.op, [a, b], n.format);
        n.turned = n.exact !== n.value;
    }

    /** The value without any rounding, every decision taken by exact values. */
    without(n, x) {
        if (isChoice(n)) return this.choose(n);
        if (n.op === "copysign") return this.sign(n, x);
        const plain = {
            constant: () => x[0],
            neg: () => negated(x[0]),
            abs: () => magnitude(x[0]),
            next_up: () => x[0],
            next_down: () => x[0],
            convert: () => x[0]
        };
        n.full = plain[n.op] ? plain[n.op]() : exactly[n.op](...x);
    }

    sidesOf(n) { return n.op === "select" ? n.operands.slice(1) : n.operands; }
    /** The operand that a choice took. */
    chosen(n) {
        if (!isChoice(n)) return -1;
        const [first, second] = this.sidesOf(n), a = this.at(first).value, b = this.at(second).value;
        return (n.op === "select" ? this.at(n.operands[0]).value : n.op === "min" ? a < b : a > b) ? first : second;
    }
    choose(n) {
        const [first, second] = this.sidesOf(n), taken = this.chosen(n), was = taken === first, a = this.at(first).full,
                      b = this.at(second).full;
        let is = was;
        if (n.op === "select") is = this.at(n.operands[0]).exact;
        else if (first !== second) is = n.op === "min" ? isLess(a, b) : isLess(b, a);
        const meant = is === was ? taken : was ? second : first;
        n.full = this.at(meant).full;
        n.turned = meant !== taken;
        if (n.turned) n.rounding = nearest(uncut.sub(this.isCut(taken) ? lift(n.value) : this.at(taken).full, n.full));
    }
    /** Whether a side taken by mistake has no exact value. */
    isCut(taken) { return !Number.isFinite(this.at(taken).exact) && this.at(taken).op !== "input"; }
    sign(n, [a, b]) {
        const by = nearest(b), was = signBit(this.at(n.operands[1]).value), size = magnitude(a);
        const negative = by !== 0 && !Number.isNaN(by) ? isLess(b, 0) : was;
        n.full = negative ? negated(size) : size;
        n.turned = negative !== was;
        if (n.turned) n.rounding = nearest(was ? uncut.sub(negated(size), size) : uncut.add(size, size));
    }

    /** Bits that the operation loses when rerun on exact operands, each rounded once. */
    localBits(n) {
        if (!isOperation(n) || isChoice(n) || ["neg", "next_up", "next_down"].includes(n.op)) return 0;
        const x = n.operands.map((o) => toFormat(this.at(o).full, n.op === "convert" ? n.format : this.at(o).format));
        const off = nearest(uncut.sub(lift(computed(n.op, x, n.format)), n.full));
        if (!Number.isFinite(off) || off === 0) return 0;
        const size = Math.abs(off / ulpOf(n, n.exact));
        return size > 0.5 ? Math.min(Math.log2(size) + 1, n.format.precision) : 0;
    }

    attribute(subject) {
        Object.assign(this.at(subject), { live: true, adjoint: 1 });
        for (let i = subject; i >= 0; --i) this.backward(this.at(i));
        for (let i = 0; i <= subject; ++i) this.sumUp(i);
        const n = this.at(subject), [a, b] = n.operands;
        this.error = isDecision(n) ? this.at(a).error - this.at(b).error : n.error;
        const broken = this.noNumberIn(subject);
        if (broken >= 0) this.culprit = this.origin(broken);
    }
    backward(n) {
        if (!n.live || n.op === "input" || n.op === "constant") return;
        const taken = this.chosen(n);
        if (n.turned && taken >= 0 && this.isCut(taken)) return;
        const weights = quotients(n, this.valuesOf(n), n.operands.map((o) => this.at(o).exact), taken);
        weights.forEach((weight, k) => {
            if (weight === null) return;
            const operand = this.at(n.operands[k]);
            operand.live = true;
            operand.adjoint += n.adjoint * weight;
        });
    }
    sumUp(i) {
        const n = this.at(i);
        if (!n.live || n.rounding === 0) return;
        n.contribution = n.rounding * n.adjoint;
        this.explained += n.contribution;
        if (this.culprit < 0 || Math.abs(n.contribution) > Math.abs(this.at(this.culprit).contribution))
            this.culprit = i;
    }

    turnedComparison(decision) {
        while (decision !== undefined && !isComparison(this.at(decision)))
            decision = this.at(decision).operands.find((o) => this.at(o).turned);
        return decision !== undefined && this.at(decision).turned ? decision : -1;
    }
    /**
     * The subject where it is not finite; of a comparison, the side that is not finite and would be without
     * rounding.
     */
    noNumberIn(subject) {
        const n = this.at(subject);
        if (!isDecision(n)) return Number.isFinite(n.value) ? -1 : subject;
        return n.operands.find(
                   (o) => !Number.isFinite(this.at(o).value) && Number.isFinite(this.at(o).exact) &&
                       this.origin(o) >= 0) ??
            -1;
    }
    /** The operation that made a value infinite or NaN. */
    origin(i) {
        for (;;) {
            const n = this.at(i), taken = this.chosen(n);
            if (n.op === "input" || n.op === "constant") return -1;
            const next = n.operands.find((o) => (taken < 0 || o === taken) && !Number.isFinite(this.at(o).value));
            if (next === undefined) return i;
            i = next;
        }
    }
    /** The ulp of the format at the subject's exact value, of a comparison at its larger side. */
    ulpOfSubject(format) {
        const n = this.at(this.subject),
              sizes = isDecision(n) ? n.operands.map((o) => Math.abs(this.at(o).exact)) : [n.exact];
        return ulpOf({ format }, Math.max(...sizes.map(Math.abs)));
    }
}

/** The ulp of a value in its own format, where it is zero without rounding the ulp of what was computed. */
const ownUlp = (n) => ulpOf(n, n.exact === 0 ? n.value : n.exact);

function ulpOf({ format }, x) {
    const e = x === 0 || !Number.isFinite(x) ? format.emin : Math.max(binade(x), format.emin);
    return scaled(1, e - format.precision + 1);
}
