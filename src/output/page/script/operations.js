// The table of a ray's operations, as `lostbits explain` has it.

const tapes = new Map();
async function tapeOf(row) {
    const name = `tape:${keyOf(row)}`;
    if (!tapes.has(name)) tapes.set(name, JSON.parse(new TextDecoder().decode(await bytesOf(name))));
    return tapes.get(name);
}

/**
 * The walk of one ray and its tape; null where the page cannot make it: of a march, which has a tape of its own for
 * each ray.
 */
async function walkOf(map, row, x, y) {
    if (!row.taped) return null;
    const [tape, pixels] = await Promise.all([tapeOf(row), pixelsOf(map, row)]), i = y * map.width + x;
    const solid = Math.max(0, (pixels.object[i] > 0 ? pixels.object[i] : pixels.truth.object[i]) - 1);
    return { tape, solid, walk: new Walk(tape, formInputs(map, row, x, y, solid)) };
}

/** Three digits. */
const brief = (x) =>
    (!Number.isFinite(x)                          ? decimal(x) :
         x === 0                                  ? "0" :
         Math.abs(x) >= 0.01 && Math.abs(x) < 1e6 ? String(Number(x.toPrecision(3))) :
                                                    x.toExponential(2));

function operationRow({ tape, walk }, row, i, ulp) {
    const n = walk.at(i), digits = 1 + Math.ceil(n.format.precision * 0.30103),
          number = (x) => decimal(Number.isFinite(x) ? Number(x.toPrecision(digits)) : x);
    const ownUlps = (error) => (error === 0 ? "" : brief(error / ownUlp(n)));
    const line = cells(
        "td", tape.names[i], tape.expressions[i], number(n.value), number(n.exact), ownUlps(n.error),
        n.cancelled === 0 ? "" : `${n.cancelled} ${n.carried ? "catastrophic" : "benign"}`,
        n.local === 0 ? "" : n.local.toFixed(1), ownUlps(n.rounding),
        n.live && n.rounding !== 0 ? brief(n.contribution / ulp) : "");
    line.children[1].className = "expression";
    line.children[2].title = hex(n.value);
    line.dataset.node = i;
    if (i === walk.culprit) line.className = "culprit";
    if (n.turned && n.rounding !== 0) line.children[1].append(make("em", {}, " rounding chose the other side"));
    return line;
}

function isShown(walk, tape, i) {
    const n = walk.at(i);
    return isOperation(n) && n.live && (tape.labelled[i] || n.rounding !== 0 || n.cancelled > 1 || i === walk.culprit);
}

function culpritSentence({ tape, walk }, ulp) {
    if (walk.subject < 0 || walk.plainMiss)
        return "Rounding changed no decision of the form, so no operation is to blame.";
    const subject = walk.at(walk.subject), n = walk.at(walk.culprit);
    if (walk.culprit < 0)
        return !isDecision(subject) && !Number.isFinite(subject.value) ?
            "An input is not finite in this format. Everything after it follows from that." :
            "No operation rounded on the way to the answer.";
    const what = tape.names[walk.culprit] === tape.expressions[walk.culprit] ?
        tape.expressions[walk.culprit] :
        `${tape.names[walk.culprit]} = ${tape.expressions[walk.culprit]}`;
    if (!Number.isFinite(n.value)) return `${what} is ${decimal(n.value)}. Everything after it follows from that.`;
    const arrives = isDecision(subject) ? tape.expressions[walk.subject] : "t";
    return `The largest contribution is that of ${what}: its ${n.turned ? "wrong choice" : "rounding"} of ${
               brief(
                   Math.abs(n.rounding / ownUlp(n)))} ulp becomes ${brief(n.contribution / ulp)} ulp in ${arrives}. ` +
        `All contributions sum to ${brief(walk.explained / ulp)} of ${brief(walk.error / ulp)} ulp.`;
}

let operationsAsked = 0;

/** The operations of the form on the solid that it hit, or else that the ray truly hits. */
async function showOperations(element, map, row, x, y) {
    const number = ++operationsAsked, found = await walkOf(map, row, x, y);
    if (number !== operationsAsked) return;  // another pixel has been asked for since
    if (!found) {
        element.replaceChildren(make(
            "p", { className: "hint" }, "A march has its own operations for every ray. ",
            make("code", {}, commandsFor(map, row, x, y, metricNow()).explain), " shows them."));
        return;
    }
    const { walk, tape, solid } = found, ulp = walk.subject < 0 ? NaN : walk.ulpOfSubject(row), body = make("tbody");
    walk.nodes.forEach((_, i) => isShown(walk, tape, i) && body.append(operationRow(found, row, i, ulp)));
    const of = map.solid_count > 1 ? `, solid ${solid}` : "";
    element.replaceChildren(
        make("h3", {}, `Operation by operation: ${title(row)}${of}, pixel ${x}, ${y}`),
        make("p", { className: "sentence" }, culpritSentence(found, ulp)),
        make(
            "table", { className: "operations" },
            header(
                "operation", "computed from", "computed", "without rounding", "off, ulp", "bits cancelled",
                "local bits", "own, ulp", "of t, ulp"),
            body),
        make(
            "p", { className: "hint" },
            "own: its rounding, in ulps of its own result. of t: what that rounding adds to the error of t. local: bits that the operation alone loses on exact operands. Only operations on the way to t are shown, without those that are exact."));
    element.dataset.pixel = `${x},${y}`;
}
