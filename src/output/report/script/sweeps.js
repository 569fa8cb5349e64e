// A statistic along a sweep, over a plane or for named cases: the pickers, and the numbers of one cell.

const sweepParts = {
    shown: ""
};

const sweepOf = (id) => jsonOf(`sweep:${id}`);

const asNumber = (v) => (v === null ? NaN : v === "inf" ? Infinity : v === "-inf" ? -Infinity : v);

/** Key of the chosen row: the row asked for here, else the row of the map, else the nearest row that the sweep has. */
function sweepKey() {
    const { rows } = index.sweeps.find((s) => s.id === state.sweep);
    return [state.line, `${state.form}.${state.format}`].find((key) => rows.includes(key)) ??
        rows.find((key) => state.form && key.startsWith(`${state.form}.`)) ??
        rows.find((key) => key.endsWith(`.${state.format}`)) ?? rows[0];
}

/** Chooses a row of the sweep, and the same row in the map if the map has it. */
function goToRow(row, more = {}) {
    const inMap = index.maps.length > 0 && mapNow().rows.some((r) => keyOf(r) === keyOf(row));
    return goTo({ line: keyOf(row), ...(inMap ? { form: row.form, format: row.format } : {}), ...more });
}

/** Names of the charts of a sweep: `lost_bits_p99.f32`, the row of a plane, the convention of cases. */
const chartNames = ({ id }) => index.sweeps.find((s) => s.id === id).charts;
/** The statistics of which a sweep along a line has charts in a format. */
const statisticsOf = (sweep, format) =>
    (sweep.kind === "line" ? chartNames(sweep)
                                 .filter((name) => name.endsWith(`.${format}`))
                                 .map((name) => name.slice(0, name.indexOf("."))) :
                             []);

/** The statistic asked for, if the sweep has it; in cases, the verdict if none is. */
function statisticOf(sweep, format) {
    const all = sweep.kind === "line" ? statisticsOf(sweep, format) : sweep.statistics;
    return all.includes(state.statistic) ? state.statistic : sweep.kind === "cases" ? "verdict" : "lost_bits_p99";
}

/**
 * The chosen sweep, its rows in the chosen format and convention, the chosen row, and the statistic.
 */
function sweepNow(sweep) {
    const judged = sweep.conventions?.includes(state.judged) ? state.judged : sweep.conventions?.[0];
    const all = sweep.rows.filter((r) => r.judged === judged), chosen = all.find((r) => keyOf(r) === sweepKey());
    return {
        sweep,
        judged,
        rows: all.filter((r) => r.format === chosen.format),
        chosen,
        statistic: statisticOf(sweep, chosen.format)
    };
}

/** Value of a statistic in a cell of a row. A cell is a step, a cell of a plane, or a case. */
function cellValue(sweep, row, statistic, cell) {
    const values = row.values[sweep.statistics.indexOf(statistic)], counts = row.outcomes[cell];
    return values ? asNumber(values[cell]) :
                    counts[outcomeNames.indexOf(statistic.replace("_fraction", ""))] / total(counts);
}

/** True if the statistic is a quantile over too few of the hits to stand for the form. */
const isWithheld = (row, statistic, cell) =>
    !isFraction(statistic) && !isEnough(row.outcomes[cell][agreeHit], row.true_hits[cell]);
/** The value that pictures show: NaN where a quantile is withheld. */
const drawnValue = (sweep, row, statistic, cell) =>
    (isWithheld(row, statistic, cell) ? NaN : cellValue(sweep, row, statistic, cell));
const fewHits = (row, cell) => tooFew(row.outcomes[cell][agreeHit], row.true_hits[cell]);

/** The chosen cell, or null: its row, its index, and its position as triples of name, value and exact value. */
function cellNow() {
    const { sweep } = sweepParts.now;
    if (sweep.kind === "line") return state.u < 0 ? null : stepAt(state.u);
    const at = gridCell(sweepParts.now);
    return at && cellAt(...at);
}

/** The k-th step in rising order, for the chosen form or another. */
function stepAt(k, row = sweepParts.now.chosen) {
    const { sweep } = sweepParts.now, cell = sweepParts.order[k], value = sweep.steps[cell];
    return { row, cell, place: [[sweep.label, decimal(value), hex(value)]] };
}

/** The chosen cell: column and line of a plane, form and case of a table; null if none is chosen. */
function gridCell({ sweep, chosen }) {
    if (state.v < 0) return null;
    return [sweep.kind === "plane" ? state.u : sweepParts.chart.frame.keys.indexOf(keyOf(chosen)), state.v];
}

/** Values of both axes at a cell of a plane. */
function placesOf(sweep, cell) {
    const [x, y] = sweep.axes.map((axis) => axis.values);
    return [x[cell % x.length], y[Math.floor(cell / x.length)]];
}

/** The row of a column of a table of cases. */
function rowOfColumn(i) {
    const { sweep, judged } = sweepParts.now, key = sweepParts.chart.frame.keys[i];
    return sweep.rows.find((row) => keyOf(row) === key && row.judged === judged);
}

/** The cell in column i of line j: its row, its index, and its position in words. */
function cellAt(i, j) {
    const { sweep, chosen } = sweepParts.now;
    if (sweep.kind === "cases") return { row: rowOfColumn(i), cell: j, place: [["case", sweep.cases[j][0], ""]] };
    const cell = j * sweep.axes[0].values.length + i;
    return {
        row: chosen,
        cell,
        place: placesOf(sweep, cell).map((value, k) => [sweep.axes[k].label, decimal(value), hex(value)])
    };
}

const chooseCell = (i, j) =>
    (sweepParts.now.sweep.kind === "plane" ? goTo({ u: i, v: j }) : goToRow(rowOfColumn(i), { v: j }));

function factsTable({ row, cell, place }) {
    const { sweep } = sweepParts.now, body = make("tbody"), rays = total(row.outcomes[cell]);
    const add = (name, value, exactly, key) => {
        body.append(cells("td", name, value, ...(row.verdicts ? [] : [exactly])));
        body.lastChild.dataset.fact = key;
    };
    for (const [name, value, exactly] of place) add(name, value, exactly, "place");
    row.outcomes[cell].forEach((n, o) => n > 0 && add(words(outcomeNames[o]), `${n} of ${rays}`, "", outcomeNames[o]));
    if (row.verdicts) add("verdict", verdictWords(sweep, row, cell), "", "verdict");
    for (const statistic of sweep.statistics) {
        const value = cellValue(sweep, row, statistic, cell);
        const few = !Number.isNaN(value) && isWithheld(row, statistic, cell) ? `, but only ${fewHits(row, cell)}` : "";
        add(words(statistic), Number.isNaN(value) ? "–" : decimal(value) + few, "", statistic);
    }
    const [note] = row.verdicts ? [sweep.cases[cell][1]] : [""],
          by = row.judged && row.judged !== "own" ? `, judged by the ${row.judged} primitive` : "";
    return make("table", make("caption", `${title(row)}${by}${note ? `. ${note}` : ""}`), body);
}

/** Verdict on a case. If the inputs decide it, both numbers are given. */
function verdictWords(sweep, row, cell) {
    if (row.verdicts[cell] !== "within_inputs") return words(row.verdicts[cell]);
    const lost = cellValue(sweep, row, "lost_bits_max", cell), costs = asNumber(row.inherent[cell]);
    return `${sweep.within_means}: ${rounded(lost)} of ${row.precision} bits lost, the inputs cost ${rounded(costs)}`;
}

/**
 * Shows the cell under the pointer in one line, and the chosen cell in the table. If none is chosen, the table shows
 * the one under the pointer.
 */
function showCell(under) {
    const { sweep, statistic } = sweepParts.now, pinned = cellNow();
    const line = ({ row, cell, place }) => {
        const value =
            statistic === "verdict" ? verdictWords(sweep, row, cell) : rounded(drawnValue(sweep, row, statistic, cell));
        const none =
            isWithheld(row, statistic, cell) ? `is not shown, because only ${fewHits(row, cell)}` : "has no value";
        return `${title(row)}, ${place.map(([name, text]) => `${name} ${text}`).join("; ")}: ${words(statistic)} ${
            value === "nan" ? none : value}`;
    };
    sweepParts.under.textContent = under ? line(under) : "\u00a0";
    const known = pinned ?? under;
    sweepParts.facts.replaceChildren(
        known ?
            factsTable(known) :
            make(
                "p.hint",
                sweep.kind === "line" ?
                    "Point at the chart for the numbers of a step. Click, or use the arrow keys, to keep them. " +
                        "A click also chooses the form whose line is under the pointer. " +
                        "Drag to zoom; double-click to see all." :
                    "Point at a cell for its numbers. Click, or use the arrow keys, to keep them. Escape lets go."));
    if (sweep.kind === "line") pinStep(sweepParts.chart, state.u, lineOf(keyOf(sweepParts.now.chosen)));
    else pinCell(sweepParts.chart, gridCell(sweepParts.now));
}

/** Writes a claim about the chosen cell, or else about the last step or the first cell. */
function sweepClaim() {
    const { sweep, statistic } = sweepParts.now,
                             { row, cell } =
                                 cellNow() ?? (sweep.kind === "line" ? stepAt(sweep.steps.length - 1) : cellAt(0, 0));
    const known = statistic !== "verdict" && Number.isFinite(cellValue(sweep, row, statistic, cell));
    const [column, value] =
        known ? [statistic, cellValue(sweep, row, statistic, cell)] : ["agree_hit", row.outcomes[cell][agreeHit]];
    const at = sweep.kind === "cases" ?
        `case = ${JSON.stringify(sweep.cases[cell][0])}${
            row.judged === "own" ? "" : `\nconvention = "${row.judged}"`}` :
                                   `at = [${(sweep.kind === "line" ? [sweep.steps[cell]] : placesOf(sweep, cell)).map(decimal).join(", ")}]`;
    return claimText(
        sweep.id, `sweep = ${JSON.stringify(sweep.claimed)}\n${at}`, row, [column, value], total(row.outcomes[cell]),
        sweep.is_drawn);
}

function cycleRow(by) {
    const { rows, chosen } = sweepParts.now;
    return goToRow(rows[(rows.indexOf(chosen) + by + rows.length) % rows.length]);
}

function cycleStatistic(by) {
    const { sweep, chosen, statistic } = sweepParts.now, all = statisticsOf(sweep, chosen.format),
                                     at = all.indexOf(statistic);
    return at < 0 ? null : goTo({ statistic: all[(at + by + all.length) % all.length] });
}

const lineOf = (key) => sweepParts.chart.lines.find((line) => line.keys.includes(key));

/** Moves the chosen cell: along the steps and from form to form, or over the cells. */
function walk(dx, dy) {
    const { sweep } = sweepParts.now, { frame } = sweepParts.chart;
    if (sweep.kind === "line") {
        const last = sweep.steps.length - 1;
        if (dy !== 0) return cycleRow(-dy);
        return goTo({ u: state.u < 0 ? (last >> 1) : within(state.u + dx, 0, last) });
    }
    const isPlane = sweep.kind === "plane", columns = isPlane ? sweep.axes[0].values.length : frame.keys.length,
          lines = isPlane ? sweep.axes[1].values.length : sweep.cases.length, at = gridCell(sweepParts.now);
    if (!at) return isPlane ? chooseCell(columns >> 1, lines >> 1) : goTo({ v: 0 });
    return chooseCell(within(at[0] + dx, 0, columns - 1), within(at[1] + (isPlane ? dy : -dy), 0, lines - 1));
}

/** Arrow keys walk, m and M change the statistic, [ and ] the form, as on a map. */
const sweepKeys = {
    ArrowLeft: () => walk(-1, 0),
    ArrowRight: () => walk(1, 0),
    ArrowUp: () => walk(0, 1),
    ArrowDown: () => walk(0, -1),
    Escape: () => goTo({ u: -1, v: -1 }),
    m: () => cycleStatistic(1),
    M: () => cycleStatistic(-1),
    "]": () => cycleRow(1),
    "[": () => cycleRow(-1),
    ...zoomKeys(() => sweepParts.chart)
};

/** What is under the pointer: `row`, `cell` and `place` in words, and how to choose it. */
function underPointer(event) {
    const { sweep, chosen } = sweepParts.now, { chart } = sweepParts;
    if (sweep.kind !== "line") {
        const at = cellUnder(chart, event);
        if (!at) return null;
        const j = sweep.kind === "plane" ? at[1] : Math.min(at[1], sweep.cases.length - 1);
        return {...cellAt(at[0], j), choose: () => chooseCell(at[0], j) };
    }
    const found = stepUnder(chart, event);
    if (!found) return null;
    const { step, line } = found, { rows } = sweepParts.now,
                       key = !line || line.keys.includes(keyOf(chosen)) ? keyOf(chosen) : line.keys[0],
                       row = rows.find((r) => keyOf(r) === key);
    return {...stepAt(step, row), line, choose: () => goToRow(row, { u: step }) };
}

function drawSweepPickers() {
    const { sweep, judged, rows, chosen, statistic } = sweepParts.now;
    const picker = (label, id, options, value, onchange) =>
        choice(label, `pick-${id}`, options.map((o) => (Array.isArray(o) ? o : [o, o])), value, onchange);
    const ofFormat = (format) => {
        const all = sweep.rows.filter((r) => r.format === format);
        return goToRow(all.find((r) => r.form === chosen.form) ?? all[0]);
    };
    showPickers(
        sweepParts.pickers,
        picker("sweep", "sweep", titled(index.sweeps), sweep.id, (id) => goTo({ sweep: id, u: -1, v: -1 })),
        ...(sweep.kind === "line" ?
                [picker(
                    "statistic", "statistic", statisticsOf(sweep, chosen.format).map((s) => [s, words(s)]), statistic,
                    (s) => goTo({ statistic: s }))] :
                []),
        picker("format", "sweep-format", [...new Set(sweep.rows.map((r) => r.format))], chosen.format, ofFormat),
        picker(
            "form", "sweep-form", rows.map((r) => r.form), chosen.form,
            (form) => goToRow(rows.find((r) => r.form === form))),
        ...(sweep.conventions?.length > 1 ?
                [picker(
                    "judged by", "judged", sweep.conventions.map((c) => [c, `the ${c} primitive`]), judged,
                    (c) => goTo({ judged: c }))] :
                []));
}

/** The figure that shows the chosen statistic, row or convention. */
function figureNow({ sweep, chosen, statistic, judged }) {
    const name = sweep.kind === "line" ? `${statistic}.${chosen.format}` :
        sweep.kind === "plane" ? keyOf(chosen) :
                                 judged;
    return sweepParts.charts.get(sweep.id).find((figure) => figure.dataset.chart === name);
}

async function drawSweep() {
    const sweep = await sweepOf(state.sweep);
    if (sweep.id !== state.sweep) return;
    const now = sweepNow(sweep), { element, onsets } = sweepParts, line = sweep.kind === "line";
    sweepParts.now = now;
    const [columns, lines] = line ? [sweep.steps.length, 1] :
        sweep.kind === "plane"    ? sweep.axes.map((a) => a.values.length) :
                                    [1, sweep.cases.length];
    if ((sweep.kind !== "cases" && !(state.u < columns)) || (!line && !(state.v < lines)) ||
        (sweep.kind === "plane" && state.u < 0))
        state.u = state.v = -1;
    const shown = [sweep.id, now.statistic, keyOf(now.chosen), now.judged].join(" ");
    if (shown !== sweepParts.shown) {
        sweepParts.shown = shown;
        const figure = figureNow(now);
        if (element.firstChild !== figure) element.replaceChildren(figure);
        element.setAttribute("aria-label", `${figure.getAttribute("aria-label")}; arrow keys move over it`);
        sweepParts.chart = chartOf(figure);
        if (line) sweepParts.order = sweep.steps.map((_, k) => k).sort((a, b) => sweep.steps[a] - sweep.steps[b]);
        emphasize(sweepParts.chart, keyOf(now.chosen), null);
        sweepParts.names.replaceChildren(...(line ? lineNames(now) : []));
        drawSweepPickers();
        sweepParts.showNote(index.sweeps.find((s) => s.id === sweep.id).note);
        onsets.replaceChildren(
            ...(line ? [make("p.hint", sweep.absent[now.chosen.format]), ...onsetLines(now.chosen)] : []));
    }
    showCell(null);
}

/** A short piece of a line as in the chart: its colour, and its marker if it has one. */
function lineSample(group) {
    const line = group.querySelector("path"), marker = group.querySelector("circle, path:not([fill=none])");
    const svg = document.createElementNS(line.namespaceURI, "svg"), piece = line.cloneNode();
    svg.setAttribute("viewBox", "0 0 26 12");
    piece.setAttribute("d", "M1 6h24");
    svg.append(piece);
    if (marker) {
        const { x, y, width, height } = marker.getBBox(), copy = marker.cloneNode();
        copy.setAttribute("transform", `translate(${13 - x - width / 2} ${6 - y - height / 2})`);
        svg.append(copy);
    }
    return svg;
}

/** The lines of the chart by name, for windows in which the chart's own legend is out of sight. */
const lineNames = ({ rows }) => sweepParts.chart.lines.map(({ group, keys }) => {
    const names = rows.filter((row) => keys.includes(keyOf(row))).map(shortName);
    return make("span.class", lineSample(group), ` ${names.join(", ")}`);
});

function onsetLines(row) {
    if (row.onsets.length === 0) return [make("p", "No threshold is crossed along this sweep.")];
    const body = make("tbody");
    for (const [event, statistic, threshold, good, bad, low, high] of row.onsets)
        body.append(cells(
            "td", `${words(event)} ${statistic} ≥ ${decimal(threshold)}`, good === null ? "–" : decimal(good),
            decimal(bad), low === high ? "–" : `${rounded(low)} to ${rounded(high)}`));
    return [make(
        "details", { open: true }, make("summary", `Onsets of ${title(row)}: ${row.onsets.length}`),
        make("table", header("event", "last good", "first seen bad", "range over draws"), body))];
}

function buildChart() {
    const element = make("div.plot#sweep-chart", { tabIndex: 0, role: "group" });
    element.addEventListener("pointermove", (event) => {
        const under = underPointer(event);
        emphasize(sweepParts.chart, keyOf(sweepParts.now.chosen), under?.line);
        showCell(under);
    });
    element.addEventListener("pointerleave", () => {
        emphasize(sweepParts.chart, keyOf(sweepParts.now.chosen), null);
        showCell(null);
    });
    element.addEventListener("click", (event) => {
        element.focus();
        if (!sweepParts.chart.dragged) underPointer(event)?.choose();
    });
    onKeys(element, sweepKeys);
    return element;
}

function buildSweeps() {
    const root = document.getElementById("sweep-view"), copied = copiedBox(), [note, showNote] = noteBox("sweep-note");
    const parts = Object.assign(sweepParts, {
        showNote,
        charts: new Map(index.sweeps.map(({ id }) => [id, chartsOf(`sweep-${id}`)])),
        pickers: make("div.pickers"),
        element: buildChart(),
        names: make("div.legend.names"),
        under: make("p.hint#sweep-under", "\u00a0"),
        facts: make("div.facts#sweep-facts", { "aria-live": "polite" }),
        onsets: make("div.onsets")
    });
    const command = () => {
        const { sweep: { named }, chosen: { form, format, from } } = parts.now;
        return `lostbits sweep ${named} -i ${form} -f ${format}${from} -o out`;
    };
    const buttons = copyButtons(
        copied, ["copy-sweep-command", "copy the command", command], ["copy-sweep-claim", "copy as claim", sweepClaim],
        ["copy-sweep-link", "copy the link", () => location.href]);
    root.append(
        parts.pickers, note,
        make(
            "div.stage", make("div.picture.wide", parts.element, parts.names, parts.under),
            make("div.side", parts.facts, make("div.buttons", ...buttons), copied, parts.onsets)));
    root.hidden = false;
    listeners.push(drawSweep);
}
