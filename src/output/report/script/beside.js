// The parts beside the picture of a map: the legend of its colours, the names of its halves, the note on what to look
// for, the form's own numbers while no ray is chosen, and the small pictures.

/** Draws the colour ramp with its ticks and the name of the quantity. */
function rampBar(ticks, text) {
    const bar = make("canvas", { width: 256, height: 12, className: "bar", "aria-hidden": "true" }),
          context = bar.getContext("2d");
    ramp.forEach((c, i) => {
        context.fillStyle = `rgb(${c.join(",")})`;
        context.fillRect(i, 0, 1, 12);
    });
    const scale = make("span.scale", bar);
    for (const [position, label] of ticks) {
        const tick = make("span.tick", label);
        tick.style.left = `${position * 256}px`;
        scale.append(tick);
    }
    return make("span.ramp", scale, make("span.unit", text));
}

/** The name of a category: an operation's expression as it is, any other name with blanks. */
const categoryName = (metric, value) =>
    (metric.blamed ? metric.categories[value][0] : words(metric.categories[value][0]));

/** Draws a small square in the colour of a class. */
function swatch(colour) {
    const canvas = make("canvas.swatch", { width: 12, height: 12, "aria-hidden": "true" }),
          context = canvas.getContext("2d");
    context.fillStyle = `rgb(${colour.join(",")})`;
    context.fillRect(0, 0, 12, 12);
    return canvas;
}

/** A legend entry: the colour of a class, and its meaning. */
const ofColour = (colour, text) => make("span.class", swatch(colour), ` ${text}`);

/** Legend of culprits: the operations that are blamed most often, each with its number of pixels. */
function culpritLegend({ name, categories }, pixels) {
    const counts = new Map(), most = 8;
    for (const c of pixels.stored[name])
        if (!Number.isNaN(c)) counts.set(c, (counts.get(c) ?? 0) + 1);
    const order = [...counts].sort((a, b) => b[1] - a[1] || a[0] - b[0]),
          rest = total(order.slice(most).map(([, n]) => n));
    const shown = order.slice(0, most).map(([c, n]) => ofColour(categories[c][1], `${categories[c][0]} ${n}`));
    if (rest > 0) shown.push(make("span.class", `${order.length - most} more, each in its own colour ${rest}`));
    return shown;
}

/** The colour bar of a metric in the format of a row; none for categories. */
const barOf = (metric, row) => (
    metric.scales ?
        [rampBar(
            scaleOf(metric, row).ticks,
            words(metric.name) +
                (metric.unit && metric.unit !== "1" && !metric.name.includes(metric.unit) ? `, ${metric.unit}` : ""))] :
        []);

/** Colours of the classes that a row has, each with its number of pixels. */
async function classesOf(metric, row) {
    const { blamed, kind } = metric, shown = blamed ? culpritLegend(metric, await pixelsOf(mapNow(), row)) : [];
    if (metric.marches || metric.every_ray) return shown;
    index.outcomes.forEach(([word, colour], o) => {
        if (blamed && wrongDecisions.includes(o)) return;  // a culprit is named for wrong decisions too
        if (row.outcomes[o] > 0 && (o !== agreeHit || kind === "classes"))
            shown.push(ofColour(colour, `${words(word)} ${row.outcomes[o]}`));
    });
    return shown;
}

/** Draws the legend. Two halves have a line each: their classes and numbers differ, and so do bars of two formats. */
async function drawLegend() {
    const metric = metricNow(), row = rowNow(), other = otherRow(), halves = other ? [row, other] : [row];
    const isShared = !other || other.format === row.format;
    const classes = await Promise.all(halves.map((half) => classesOf(metric, half)));
    if (metricNow() !== metric || rowNow() !== row || otherRow() !== other) return;  // something else by now
    const parts = halves.map((half, k) => [...(isShared ? [] : barOf(metric, half)), ...classes[k]]);
    const lines = other ?
        parts.map((part, k) => (part.length > 0 ? make("div.legend.half-legend", make("b", "AB"[k]), ...part) : "")) :
        parts.flat();
    mapParts.legend.replaceChildren(
        ...(isShared ? barOf(metric, row) : []),
        ...(metric.blamed ? [] : metric.categories ?? []).map(([word, colour]) => ofColour(colour, words(word))),
        ...lines);
}

/** Writes A and B on the halves. Each name is at most as wide as its half. */
function nameHalves() {
    const { halfA, halfB } = mapParts, other = otherRow();
    for (const [half, letter, row, share] of [
             [halfA, "A", rowNow(), state.split], [halfB, "B", other, 1 - state.split]]) {
        half.hidden = !other || share < 0.08;
        if (half.hidden) continue;
        half.replaceChildren(make("b", letter), ` ${shortName(row)} ${row.format}`);
        half.style.maxWidth = `${100 * share}%`;
    }
}

/** `A: ` while a second form is compared, else nothing. */
const letterA = () => (otherRow() ? "A: " : "");

/** One line with the answer of the form B. */
async function otherAnswer(map, row, x, y) {
    const p = await pixelsOf(map, row), i = y * map.width + x, outcome = p.outcome[i];
    const answer = p.object[i] > 0 ? `, t ${decimal(p.t[i])}` : "",
          lost = outcome === agreeHit ? `, ${derived.lost_bits(sampleAt(p, i)).toFixed(2)} bits lost` : "";
    return make(
        "p.outcome-b", swatch(index.outcomes[outcome][1]),
        ` B: ${words(outcomeNames[outcome])}: ${title(row)}${answer}${lost}`);
}

/** A box for the note of a scene or sweep. It is open until the reader closes it. */
function noteBox(id) {
    const text = make("p"), box = make("details.note", { id, open: true }, make("summary", "What to look for"), text);
    return [
        box,
        (note) => {
            box.hidden = !note;
            // Between backquotes stands code.
            text.replaceChildren(
                ...(note ?? "").split(/`([^`]+)`/).map((part, k) => (k % 2 === 1 ? make("code", part) : part)));
        }
    ];
}

/** Summary of a form over the whole picture: its outcomes, then its quantiles if enough hits agree. */
function summaryOf(map, row) {
    const rays = total(row.outcomes), agreed = row.outcomes[agreeHit], body = make("tbody");
    row.outcomes.forEach((n, o) => n > 0 && body.append(cells("td", words(outcomeNames[o]), `${n} of ${rays} rays`)));
    const table = make("table", make("caption", `${title(row)}, the whole picture`), body);
    if (row.true_hits === 0) return [table];
    if (!isEnough(agreed, row.true_hits))
        return [table, make("p.few", `${tooFew(agreed, row.true_hits)}: too few for quantiles.`)];
    const quantiles = make("tbody");
    for (const metric of map.metrics) {
        const values = row.statistics[metric.name];
        if (!values || (metric.marches && !marches(row.form)) || !values.some((v) => typeof v === "number")) continue;
        quantiles.append(cells("td", words(metric.name), ...values.map((v) => rounded(asNumber(v)))));
    }
    return [make(
        "div.pair", table,
        make(
            "table", make("caption", `quantiles of ${agreed} agreed hits`), header("metric", ...index.quantiles),
            quantiles))];
}

// The small pictures of every form and format of the scene. All show the same part of the scene with the same colour
// scale, and they move together.

const paneParts = {
    scene: "",
    cells: new Map()
};

function buildPane(map, row) {
    const factor = 144 / Math.max(map.width, map.height);
    const canvas = make("canvas", { width: Math.round(map.width * factor), height: Math.round(map.height * factor) });
    const lost = row.statistics.lost_bits?.[1], agreed = row.outcomes[agreeHit];
    const quantile = !isEnough(agreed, row.true_hits) ? `${tooFew(agreed, row.true_hits)}: no quantiles` :
        lost === null || lost === undefined ? "no correct hit" :
                                              `p99 ${rounded(lost)} of ${row.precision} bits lost`;
    const wrong = index.outcomes.map(([name], o) => [name, row.outcomes[o]]).filter(([name, n], o) => o >= 2 && n > 0);
    const pane = button(
        ".pane", (event) => goTo(event.shiftKey ? { other: keyOf(row) } : { form: row.form, format: row.format }),
        make("span.thumbnail", canvas), make("span.name", make("b", shortName(row)), ` ${row.format}`),
        ...wrong.map(([name, n]) => make("small", `${n} ${words(name)}`)), make("small", quantile));
    pane.title = `${row.title}; click to show it, shift-click to compare with it`;
    pane.dataset.row = keyOf(row);
    handlePointer(canvas, () => {});
    return { row, canvas, pane };
}

async function drawPanes() {
    const map = mapNow(), metric = metricNow();
    if (paneParts.scene !== map.id) {
        paneParts.scene = map.id;
        paneParts.cells = new Map(map.rows.map((row) => [keyOf(row), buildPane(map, row)]));
        document.getElementById("panes").replaceChildren(...[...paneParts.cells.values()].map((c) => c.pane));
    }
    for (const { row, canvas, pane } of paneParts.cells.values()) {
        if (metric.marches && !marches(row.form)) continue;
        const field = paint(map, await pixelsOf(map, row), metric);
        if (map !== mapNow() || metric !== metricNow()) return;
        drawView(canvas, map, field);
        pane.classList.toggle("chosen", row === rowNow());
        pane.classList.toggle("other", row === otherRow());
        pane.dataset.half = !otherRow() ? "" : row === rowNow() ? "A" : row === otherRow() ? "B" : "";
    }
}

function buildPanes() {
    let waiting = false;
    // Draws after the large picture, and once for many moves.
    listeners.push(() => {
        if (waiting) return;
        waiting = true;
        setTimeout(() => {
            waiting = false;
            drawing = drawPanes();
        }, 0);
    });
}
