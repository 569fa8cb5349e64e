// Beside the picture of a map: the names of its halves, what to look for, and the form's own numbers while no ray is
// chosen.

/** Writes A and B on the halves, each no wider than its half. */
function nameHalves() {
    const { halfA, halfB } = mapParts, other = otherRow();
    for (const [half, letter, row, share] of [
             [halfA, "A", rowNow(), state.split], [halfB, "B", other, 1 - state.split]]) {
        half.hidden = !other || share < 0.08;
        if (half.hidden) continue;
        half.replaceChildren(make("b", {}, letter), ` ${shortName(row)} ${row.format}`);
        half.style.maxWidth = `${100 * share}%`;
    }
}

/** `A: `, while another form is compared with. */
const letterA = () => (otherRow() ? "A: " : "");

/** The answer of the form that is compared with, in a line. */
async function otherAnswer(map, row, x, y) {
    const p = await pixelsOf(map, row), i = y * map.width + x, outcome = p.outcome[i];
    const answer = p.object[i] > 0 ? `, t ${decimal(p.t[i])}` : "",
          lost = outcome === agreeHit ? `, ${derived.lost_bits(sampleAt(p, i)).toFixed(2)} bits lost` : "";
    return make(
        "p", { className: "outcome-b" }, swatch(index.outcomes[outcome][1]),
        ` B: ${words(outcomeNames[outcome])}: ${title(row)}${answer}${lost}`);
}

/** What a scene or sweep is to show, open until it is closed. */
function noteBox(id) {
    const text = make("p"),
          box = make("details", { className: "note", id, open: true }, make("summary", {}, "What to look for"), text);
    return [
        box,
        (note) => {
            box.hidden = !note;
            if (text.textContent !== note) text.textContent = note ?? "";
        }
    ];
}

/** The form over the whole picture: its decisions, then its quantiles, where enough hits agree. */
function summaryOf(map, row) {
    const rays = row.outcomes.reduce((a, b) => a + b, 0), agreed = row.outcomes[agreeHit], body = make("tbody");
    row.outcomes.forEach((n, o) => n > 0 && body.append(cells("td", words(outcomeNames[o]), `${n} of ${rays} rays`)));
    const table = make("table", {}, make("caption", {}, `${title(row)}, the whole picture`), body);
    if (row.true_hits === 0) return [table];
    if (!isEnough(agreed, row.true_hits))
        return [table, make("p", { className: "few" }, `${tooFew(agreed, row.true_hits)}: too few for a quantile.`)];
    const quantiles = make("tbody");
    for (const metric of map.metrics) {
        const values = row.statistics[metric.name];
        if (!values || (metric.marches && !row.form.startsWith("sdf.")) || !values.some((v) => typeof v === "number"))
            continue;
        quantiles.append(cells("td", words(metric.name), ...values.map((v) => rounded(asNumber(v)))));
    }
    return [make(
        "div", { className: "pair" }, table,
        make(
            "table", {}, make("caption", {}, `quantiles of ${agreed} agreed hits`),
            header("metric", ...index.quantiles), quantiles))];
}
