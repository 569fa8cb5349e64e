// The operations of one ray: a form's tape run again in its format and without rounding, and the error of t shared out
// among them. What src/measure/blame/attribution.cpp and operation_error.cpp do, over integers of any length where
// those have MPFR; the browser test holds the two against each other.

// Kinds come with the tape: number/tape.hpp has them.
const isGiven = (n) => n.kind === "given";
const isComparison = (n) => n.kind === "comparison";
const isDecision = (n) => isComparison(n) || n.kind === "logic";
const isOperation = (n) => !isGiven(n) && !isDecision(n);
const isChoice = (n) => n.kind === "choice";
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

/** From the exact value of an operand to the computed one; see `Step` in src/measure/blame/operation.hpp. */
const middle = ({ from, to }) => from / 2 + to / 2;
const ofSize = ({ from, to }) =>
    (signBit(to) === signBit(from) ? (signBit(to) ? -1 : 1) : (Math.abs(to) - Math.abs(from)) / (to - from));

/**
 * Every operation of a tape by its name in number/tape.hpp, with what its kind asks for. Rounded ones are in `uncut`
 * and `exactly` (exact.js) too. `quotients`: by how much each operand's error is multiplied; null: not at all. A judge
 * decides by values of its own.
 */
const operationRules = {
    input: {},
    constant: {},
    add: { addends: (a, b) => [a, b], quotients: () => [1, 1] },
    sub: { addends: (a, b) => [a, b], quotients: () => [1, -1] },
    mul: { addends: () => null, quotients: (a, b) => [middle(b), middle(a)] },
    div: {
        addends: () => null,
        quotients: (a, b) => [(1 / b.from + 1 / b.to) / 2, -(a.from / b.from / b.to + a.to / b.from / b.to) / 2]
    },
    sqrt: {
        addends: () => null,
        quotients(a) {
            const sum = Math.sqrt(a.from) + Math.sqrt(a.to);
            return [sum === 0 ? 0 : 1 / sum];
        }
    },
    fma: { addends: (a, b, c) => [a * b, c], quotients: (a, b) => [middle(b), middle(a), 1] },
    call: {},  // of forms that filter, which have no tape here
    neg: { computed: (a) => -a, exact: negated, quotients: () => [-1] },
    abs: { computed: Math.abs, exact: magnitude, quotients: (a) => [ofSize(a)] },
    copysign: {
        computed: (a, b) => (signBit(a) === signBit(b) ? a : -a),
        quotients: (a, b) => [signBit(b.to) ? -ofSize(a) : ofSize(a), null]
    },
    min: { sides: [0, 1], takesFirst: (judge) => judge.isLess(0, 1) },
    max: { sides: [0, 1], takesFirst: (judge) => judge.isLess(1, 0) },
    select: { sides: [1, 2], takesFirst: (judge) => judge.holds(0) },
    next_up: { computed: nextUp },
    next_down: { computed: (a, format) => -nextUp(-a, format) },
    convert: { computed: (a, format) => toFormat(lift(a), format) },
    less: { holds: (judge) => judge.isLess(0, 1) },
    less_equal: { holds: (judge) => judge.isLessOrEqual(0, 1) },
    greater: { holds: (judge) => judge.isLess(1, 0) },
    greater_equal: { holds: (judge) => judge.isLessOrEqual(1, 0) },
    both: { holds: (judge) => judge.holds(0) && judge.holds(1) },
    either: { holds: (judge) => judge.holds(0) || judge.holds(1) },
    opposite: { holds: (judge) => !judge.holds(0) },
    any: { holds: (judge) => judge.holds(0) },
};

/** What an operation makes of numbers of a format; not of choices and decisions. */
function resultOf({ op, kind, format }, x) {
    if (kind === "rounded") return toFormat(inFull(op, x.map(lift)), format);
    return operationRules[op].computed(...x, format);
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
    if (n.kind === "moved") return n.value - x[0];
    if (n.kind !== "rounded" || Number.isNaN(n.value) || (n.op === "div" && x[1] === 0)) return 0;
    if (!Number.isFinite(n.value)) return n.value;
    return nearest(uncut.sub(lift(n.value), exactly[n.op](...x.map(lift))));
}

/** max(exponent of operands) - exponent of result of a sum. */
function cancellationOf(n, x) {
    const addends = n.kind === "rounded" ? operationRules[n.op].addends(...x) : null;
    if (!addends) return 0;
    const largest = Math.max(...addends.map(Math.abs));
    if (!addends.every(Number.isFinite) || !Number.isFinite(n.value) || largest === 0) return 0;
    return n.value === 0 ? n.format.precision : Math.max(0, binade(largest) - binade(n.value));
}

/**
 * A tape as the page holds it and the inputs of a ray; see `Attribution` and `OperationError` in
 * src/measure/blame/attribution.hpp.
 */
class Walk {
    constructor(tape, inputs) {
        this.nodes = tape.nodes.map(([op, format, ...operands]) => ({
                                        op,
                                        kind: tape.operations[op],
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
        this.equals = [];
        if (this.subject >= 0) this.attribute(this.subject);
        // The t of a miss is not an answer, so no operation is its culprit.
        this.plainMiss = !this.at(this.hit).value && !this.at(this.hit).turned;
        if (this.plainMiss) [this.culprit, this.equals] = [-1, []];
    }
    at(i) { return this.nodes[i]; }
    valuesOf(n) { return n.operands.map((o) => this.at(o).value); }

    forward(n) {
        if (n.op === "input") {
            n.value = this.inputs[n.operands[0]];
            n.full = lift(n.value);
            n.exact = n.value;
            return;
        }
        const x = isGiven(n) ? n.operands : this.valuesOf(n);
        n.value = this.computed(n, x);
        if (isDecision(n)) return this.decide(n);
        this.findExact(n);
        n.exact = nearest(n.full);
        n.error = nearest(uncut.sub(lift(n.value), n.full));
        if (!n.turned) n.rounding = roundingOf(n, x);
        n.cancelled = cancellationOf(n, x);
        n.carried = !isGiven(n) && n.operands.some((o) => this.at(o).error !== 0);
        n.local = this.localBits(n);
    }

    computed(n, x) {
        if (isGiven(n)) return toFormat(lift(x[0]), n.format);
        if (isChoice(n)) return this.at(this.sideTaken(n)).value;
        return isDecision(n) ? operationRules[n.op].holds(this.computedJudge(n)) : resultOf(n, x);
    }
    /** Decides as the format does. */
    computedJudge(n) {
        const x = this.valuesOf(n);
        return { isLess: (k, l) => x[k] < x[l], isLessOrEqual: (k, l) => x[k] <= x[l], holds: (k) => x[k] };
    }
    /** Decides by exact values. */
    exactJudge(n) {
        const operand = (k) => this.at(n.operands[k]);
        return {
            isLess: (k, l) => n.operands[k] !== n.operands[l] && isLess(operand(k).full, operand(l).full),
            isLessOrEqual: (k, l) => isLessOrEqual(operand(k).full, operand(l).full),
            holds: (k) => operand(k).exact
        };
    }

    decide(n) {
        n.exact = operationRules[n.op].holds(this.exactJudge(n));
        n.turned = n.exact !== n.value;
    }

    /** The value without any rounding, every decision taken by exact values. */
    findExact(n) {
        if (isChoice(n)) return this.choose(n);
        const x = isGiven(n) ? n.operands.map(lift) : n.operands.map((o) => this.at(o).full);
        if (n.kind === "sign") return this.sign(n, x);
        if (n.kind === "rounded") n.full = exactly[n.op](...x);
        else n.full = n.kind === "exact" ? operationRules[n.op].exact(...x) : x[0];
    }

    sideOf(n, judge) {
        const { sides, takesFirst } = operationRules[n.op];
        return n.operands[sides[takesFirst(judge) ? 0 : 1]];
    }
    /** The operand that a choice took. */
    sideTaken(n) { return isChoice(n) ? this.sideOf(n, this.computedJudge(n)) : -1; }
    choose(n) {
        const taken = this.sideTaken(n), meant = this.sideOf(n, this.exactJudge(n));
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
        if (n.kind !== "rounded" && n.kind !== "sign") return 0;
        const x = n.operands.map((o) => toFormat(this.at(o).full, this.at(o).format));
        const off = nearest(uncut.sub(lift(resultOf(n, x)), n.full));
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
        else this.chooseCulprit();
    }
    backward(n) {
        if (!n.live || isGiven(n)) return;
        if (n.turned && isChoice(n) && this.isCut(this.sideTaken(n))) return;
        this.quotientsOf(n).forEach((quotient, k) => {
            if (quotient === null) return;
            const operand = this.at(n.operands[k]);
            operand.live = true;
            operand.adjoint += n.adjoint * quotient;
        });
    }
    /** Of a choice 1 for the side that it took; a comparison stands for the difference of its sides. */
    quotientsOf(n) {
        if (n.kind === "logic") return [];
        if (n.kind === "moved") return [1];
        if (isComparison(n)) return [1, -1];
        if (isChoice(n)) {
            const place = n.operands.indexOf(this.sideTaken(n));
            return n.operands.map((_, k) => (k === place ? 1 : null));
        }
        return operationRules[n.op].quotients(
            ...n.operands.map((o) => ({ from: this.at(o).exact, to: this.at(o).value })));
    }
    sumUp(i) {
        const n = this.at(i);
        if (!n.live || n.rounding === 0) return;
        n.contribution = n.rounding * n.adjoint;
        this.explained += n.contribution;
    }
    chooseCulprit() {
        const [culprit, ...equals] = culpritAndEquals(this);
        if (culprit === undefined) return;
        this.culprit = culprit;
        if (Math.abs(this.at(culprit).contribution) > 0) this.equals = equals;
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
            const n = this.at(i), taken = this.sideTaken(n);
            if (isGiven(n)) return -1;
            const next = n.operands.find((o) => (taken < 0 || o === taken) && !Number.isFinite(this.at(o).value));
            if (next === undefined) return i;
            i = next;
        }
    }
    /**
     * The live cancellation of most bits that the error of an operation goes through, of two bits or more; -1: none.
     */
    amplifier(from) {
        const reached = new Set([from]);
        let most = -1, bits = 1;
        for (let i = from + 1; i < this.nodes.length; ++i) {
            const n = this.at(i);
            if (!n.live || isGiven(n) || !n.operands.some((o) => reached.has(o))) continue;
            reached.add(i);
            if (n.carried && n.cancelled > bits) [most, bits] = [i, n.cancelled];
        }
        return most;
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
