// The table of a ray's operations, as `lostbits explain` has it.

const tapes = new Map();
async function tapeOf(row) {
    const name = `tape:${keyOf(row)}`;
    if (!tapes.has(name)) tapes.set(name, JSON.parse(new TextDecoder().decode(await bytesOf(name))));
    return tapes.get(name);
}

/**
 * The walk of one ray and its tape; null where the page cannot make it: of a march or a form that filters, which
 * have a tape of their own for each ray.
 */
async function walkOf(map, row, x, y) {
    if (!row.taped) return null;
    const [tape, pixels] = await Promise.all([tapeOf(row), pixelsOf(map, row)]), i = y * map.width + x;
    const solid = Math.max(0, (pixels.object[i] > 0 ? pixels.object[i] : pixels.truth.object[i]) - 1);
    return { tape, solid, pixels, i, walk: new Walk(tape, formInputs(map, row, x, y, solid)) };
}

/** Halves to even, as the program has them; `longer` is the same number with more digits. */
function toEven(text, longer) {
    const rest = longer.slice(text.length).replace(".", "");
    return /^50*$/.test(rest) && Number(text.at(-1)) % 2 === 1 ? longer.slice(0, text.length) : text;
}
const fixed = (x, digits) => (Number.isFinite(x) ? toEven(x.toFixed(digits), x.toFixed(digits + 60)) : decimal(x));

/** Three digits. */
function brief(x) {
    if (!Number.isFinite(x)) return decimal(x);
    if (x === 0) return "0";
    const [coarse, exponent] = Math.abs(x).toExponential(2).split("e"), e = Number(exponent),
                   mantissa = toEven(coarse, Math.abs(x).toExponential(60).split("e")[0]), sign = x < 0 ? "-" : "",
                   plain = Math.abs(x) >= 0.01 && Math.abs(x) < 1e6;
    if (plain) return sign + String(Number(`${mantissa}e${e}`));
    return `${sign}${mantissa}e${e < 0 ? "-" : "+"}${String(Math.abs(e)).padStart(2, "0")}`;
}

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

/** The input that is not finite in the format, where the answer is not finite for that reason. */
function lostInput({ tape, walk }) {
    const subject = walk.at(walk.subject);
    if (isDecision(subject) || Number.isFinite(subject.value)) return -1;
    return walk.nodes.findIndex((n, i) => n.op === "input" && !Number.isFinite(n.value) && tape.names[i] !== "limit");
}

/** What the rounding of the culprit goes through, and what was lost before. */
function amplifierText({ tape, walk }) {
    const amplifier = walk.amplifier(walk.culprit);
    if (amplifier < 0) return "";
    const a = walk.at(amplifier),
          carried = a.operands.filter((o) => walk.at(o).error !== 0 && walk.at(o).op !== "constant").map((o) => {
              const n = walk.at(o);
              return `; ${tape.operands[o]} was already off by ${brief(Math.abs(n.error / ownUlp(n)))} ulp`;
          });
    return `${tape.definitions[amplifier]} cancels ${a.cancelled} of ${a.format.precision} bits${carried.join("")}. `;
}

/** The sentence of `lostbits explain`, letter by letter. */
function culpritSentence(found, row, ulp) {
    const { tape, walk, pixels, i } = found;
    if (walk.subject < 0 || walk.plainMiss)
        return "Rounding changed no decision of the form, so no operation is to blame.";
    if (walk.culprit < 0) {
        const lost = lostInput(found);
        return lost < 0 ? "No operation rounded on the way to the answer." :
                          `The input ${tape.names[lost]} is ${decimal(walk.at(lost).value)} in ${
                              row.format}. Everything after it follows from that.`;
    }
    const n = walk.at(walk.culprit), what = tape.definitions[walk.culprit];
    const harmless = pixels.outcome[i] === agreeHit && derived.lost_bits(sampleAt(pixels, i)) < 1;
    if (!Number.isFinite(n.value)) {
        return `${what} is ${decimal(n.value)}${
            harmless ? ", and so is the true t when it is rounded." : ". Everything after it follows from that."}`;
    }
    const equals = equalsOf(found), share = equals.sum / walk.error;
    let text =
        `${amplifierText(found)}${harmless ? "The largest contribution is that of" : "The culprit is"} ${what}: ` +
        `its ${n.turned ? "wrong choice" : "rounding"} of ${brief(Math.abs(n.rounding / ownUlp(n)))} ulp is assigned ` +
        `${brief(Math.abs(n.contribution / ulp))} ulp in ${
            isDecision(walk.at(walk.subject)) ? tape.expressions[walk.subject] : "t"}${equals.who}`;
    if (equals.cancel) return `${text}${restText(found, ulp)}.`;
    if (walk.equals.length > 0) text += `: together ${brief(Math.abs(equals.sum / ulp))} ulp`;
    if (share > 1 || share < 0)
        text += `; the other roundings cancel all but ${brief(Math.abs(walk.error / ulp))} ulp of it`;
    else if (Number.isFinite(share)) text += `, ${fixed(100 * share, 0)} % of the error`;
    return `${text}.`;
}

function sumsSentence({ walk }, ulp) {
    if (walk.subject < 0 || walk.plainMiss || !Number.isFinite(walk.error)) return "";
    return ` Contributions sum to ${brief(walk.explained / ulp)} of ${brief(walk.error / ulp)} ulp.`;
}

let operationsAsked = 0;

/** The operations of the form on the solid that it hit, or else that the ray truly hits. */
async function showOperations(element, map, row, x, y) {
    const number = ++operationsAsked, found = await walkOf(map, row, x, y);
    if (number !== operationsAsked) return;  // another pixel has been asked for since
    if (!found) {
        element.replaceChildren(make(
            "p", { className: "hint" },
            row.form.startsWith("sdf.") ? "A march has its own operations for every ray. " :
                row.formula             ? "This form has its own operations for every ray. " :
                                          "This form is compiled elsewhere, so its operations are not known. ",
            make("code", {}, commandsFor(map, row, x, y, metricNow()).explain),
            row.formula ? " shows them." : " shows what does better."));
        return;
    }
    const { walk, tape, solid } = found, ulp = walk.subject < 0 ? NaN : walk.ulpOfSubject(row), body = make("tbody");
    walk.nodes.forEach((_, i) => isShown(walk, tape, i) && body.append(operationRow(found, row, i, ulp)));
    const of = map.solid_count > 1 ? `, solid ${solid}` : "";
    element.replaceChildren(
        make("h3", {}, `Operation by operation: ${title(row)}${of}, pixel ${x}, ${y}`),
        make("p", { className: "sentence" }, culpritSentence(found, row, ulp) + sumsSentence(found, ulp)),
        make("p", { className: "hint sideways" }, "The table goes on to the right: scroll it sideways."),
        make(
            "div", { className: "scrolls", tabIndex: 0, role: "region", "aria-label": "operations, scrolled sideways" },
            make(
                "table", { className: "operations" },
                header(
                    "operation", "computed from", "computed", "without rounding", "off, ulp", "bits cancelled",
                    "local bits", "own, ulp", "of t, ulp"),
                body)),
        make(
            "p", { className: "hint" },
            "own: its rounding, in ulps of its own result. " +
                "of t: how much of the error of t is assigned to that rounding. " +
                "local: bits that the operation alone loses on exact operands. " +
                "Only operations on the way to t are shown, without those that are exact."));
    element.dataset.pixel = `${x},${y}`;
}
