// Which of several operations that contribute the same is the culprit: what src/measure/blame/ties.cpp does, and what
// `lostbits explain` says of them.

const equalContributions = 2 ** -20;

/** The operands whose error goes through operation i, in the formula's order. */
function sourcesOf(walk, i) {
    const n = walk.at(i);
    return isGiven(n) ? [] : walk.quotientsOf(n).flatMap((quotient, k) => (quotient === null ? [] : [n.operands[k]]));
}

/** Of every node on the way to the subject: the operations up to it on the longest way, and when it is read. */
function waysOf(walk) {
    const steps = walk.nodes.map(() => 0), read = new Map(), left = [walk.subject];
    for (let i = walk.subject; i >= 0; --i) {
        if (walk.at(i).live) sourcesOf(walk, i).forEach((o) => (steps[o] = Math.max(steps[o], steps[i] + 1)));
    }
    while (left.length > 0) {
        const i = left.pop();
        if (read.has(i)) continue;
        read.set(i, read.size);
        left.push(...sourcesOf(walk, i).reverse());
    }
    return { steps, read };
}

/** The live operations of the largest contribution, of those smaller than `below`, the culprit first. */
function largestContributions(walk, below = NaN) {
    const size = (i) => {
        const { contribution } = walk.at(i);
        return Number.isNaN(contribution) ? -1 : Math.abs(contribution);
    };
    const asked =
        walk.nodes.map((_, i) => i).filter((i) => walk.at(i).live && walk.at(i).rounding !== 0 && !(size(i) >= below));
    const largest = Math.max(-1, ...asked.map(size)), least = Math.min(largest, largest * (1 - equalContributions)),
          equals = asked.filter((i) => size(i) >= least);
    if (equals.length < 2) return equals;
    const { steps, read } = waysOf(walk);
    return equals.sort((a, b) => steps[a] - steps[b] || read.get(a) - read.get(b));
}

/** The same, but wrong choices that undo each other are passed over while anything else was lost. */
function culpritAndEquals(walk) {
    const of = (i) => walk.at(i).contribution, sizes = (equals) => equals.map((i) => Math.abs(of(i))),
          undone = (equals) => equals.length > 1 && equals.every((i) => walk.at(i).turned) &&
        Math.abs(equals.reduce((sum, i) => sum + of(i), 0)) <= equalContributions * Math.max(...sizes(equals)),
          largest = largestContributions(walk);
    let equals = largest;
    while (undone(equals)) equals = largestContributions(walk, Math.min(...sizes(equals)));
    return equals.length > 0 && of(equals[0]) !== 0 ? equals : largest;
}

/** Whether the error of operation `from` goes through operation i. */
function isComputedFrom(walk, i, from) {
    const reached = new Set([i]);
    for (let k = i; k > from; --k) {
        if (reached.has(k) && walk.at(k).live) sourcesOf(walk, k).forEach((o) => reached.add(o));
    }
    return reached.has(from);
}

/** Of those that contribute as much as the culprit: who they are, and whether all of them undo each other. */
function equalsOf({ tape, walk }) {
    const { culprit, equals } = walk, of = (i) => walk.at(i).contribution,
                            opposite = equals.filter((i) => of(i) < 0 !== of(culprit) < 0).length,
                            sum = [culprit, ...equals].reduce((all, i) => all + of(i), 0);
    if (equals.length === 0) return { who: "", cancel: false, sum };
    const most = 3, named = equals.slice(0, most).map((i) => tape.operands[i]);
    if (equals.length > most) named.push(`${equals.length - most} more`);
    const last = named.pop(), names = named.length > 0 ? `${named.join(", ")} and ${last}` : last,
          before = equals.every((i) => isComputedFrom(walk, culprit, i)) ? ", from which it is computed," : "",
          signs = opposite === equals.length ? " with the opposite sign" :
        opposite > 0                         ? `, ${opposite} of them with the opposite sign` :
                                               "";
    return {
        who: `; ${names}${before} contribute${equals.length === 1 ? "s" : ""} the same${signs}`,
        cancel: 2 * opposite === equals.length + 1,
        sum
    };
}

/** Where the culprit and its equals undo each other: what the error is then, and the largest part of it. */
function restText({ tape, walk }, ulp) {
    const { culprit, equals } = walk,
                            undo = equals.length === 1 ? ". The two undo each other" : ". They undo each other";
    if (walk.error === 0) return `${undo}, and no error is left`;
    const least = Math.min(...[culprit, ...equals].map((i) => Math.abs(walk.at(i).contribution))),
          [other] = largestContributions(walk, least), left = brief(Math.abs(walk.error / ulp));
    if (other === undefined) return `${undo}, and an error of ${left} ulp is left`;
    return `${undo}: the error of ${left} ulp is assigned to the others, the most, ${
        brief(Math.abs(walk.at(other).contribution / ulp))} ulp, to ${tape.operands[other]}`;
}
