// A statistic along a sweep, a line a form; the chosen form is the map's.

const sweepParts = { shown: "", plot: null };
const sweepsRead = new Map();

function sweepOf(id) {
    if (!sweepsRead.has(id)) sweepsRead.set(id, bytesOf(`sweep:${id}`).then((bytes) => JSON.parse(new TextDecoder().decode(bytes))));
    return sweepsRead.get(id);
}

/** The rows that are plotted: of the chosen format where the sweep has it, otherwise of its first. */
function plottedRows(sweep) {
    const formats = sweep.rows.map((r) => r.format);
    const format = formats.includes(state.format) ? state.format : formats[0];
    return sweep.rows.filter((r) => r.format === format);
}

function statisticOf(sweep) {
    return sweep.statistics.includes(state.statistic) ? state.statistic : sweep.statistics[1];
}

function plotSweep(sweep, rows, statistic) {
    const s = sweep.statistics.indexOf(statistic), log = sweep.spacing === "log2" && Math.min(...sweep.steps) > 0;
    const order = sweep.steps.map((_, k) => k).sort((a, b) => sweep.steps[a] - sweep.steps[b]);  // some run downwards
    const finite = (y) => (typeof y === "number" ? y : null);
    const data = [order.map((k) => sweep.steps[k]), ...rows.map((r) => order.map((k) => finite(r.values[s][k])))];
    const bits = statistic.includes("bits");
    const { element } = sweepParts;
    sweepParts.order = order;
    element.replaceChildren();
    return new uPlot({
        ...plotSize(element),
        scales: { x: { time: false, distr: log ? 3 : 1, log: 2, range: () => (log ? logEnds(sweep.steps) : [Math.min(...sweep.steps), Math.max(...sweep.steps)]) }, y: { range: (_, low, high) => [0, bits ? Math.max(2, high * 1.05) : Math.max(0.05, high * 1.05)] } },
        axes: [{ ...axisLook(words(sweep.axis) + (sweep.unit ? `, ${sweep.unit}` : "")), values: (_, ticks) => ticks.map(tickText) }, axisLook(words(statistic))],
        cursor: { focus: { prox: 24 }, points: { size: 6 } },
        focus: { alpha: 0.25 },
        legend: { live: true },
        series: [{ label: words(sweep.axis), value: (_, x) => (typeof x === "number" ? rounded(x) : "–") },
            ...rows.map((r, k) => ({ label: r.form, stroke: lineColours[k % lineColours.length], width: r.form === state.form ? 3.5 : 1.25, dash: k < lineColours.length ? undefined : [6, 4], points: { show: false },
                value: (_, y) => (typeof y === "number" ? rounded(y) : "–") }))],
        hooks: { setSeries: [(u, k, options) => { if (options.focus !== null) sweepParts.focused = k; }] },
    }, data, element);
}

function onsetLines(row) {
    if (!row || row.onsets.length === 0) return [make("p", {}, row ? "Nothing goes wrong along this sweep by the thresholds of lostbits." : "")];
    const body = make("tbody");
    for (const [event, statistic, threshold, good, bad] of row.onsets) body.append(cells("td", `${words(event)} ${statistic}`, decimal(threshold), good === null ? "–" : decimal(good), decimal(bad)));
    return [make("details", {}, make("summary", {}, `Onsets of ${title(row)}: ${row.onsets.length}`), make("table", {}, header("event", "threshold", "last good", "first bad"), body))];
}

/** A claim about the step under the cursor, or the last. */
function sweepClaim(sweep, row, statistic) {
    const at = sweepParts.order[sweepParts.plot?.cursor.idx ?? sweep.steps.length - 1], value = row.values[sweep.statistics.indexOf(statistic)][at];
    return `[[claim]]
id = "my.${sweep.id}.${row.form}.${row.format}.${statistic}"
statement = "Say in a sentence what is to hold"
source = "-"
verdict = "holds"
note = "From the report"
[claim.given]
sweep = "${sweep.id}"
at = [${decimal(sweep.steps[at])}]
form = "${row.form}"
format = "${row.format}"
[claim.expect]
metric = "${statistic}"
in = [${typeof value === "number" ? `${decimal(value)}, ${decimal(value)}` : ""}]
`;
}

async function drawSweep() {
    const sweep = await sweepOf(state.sweep);
    if (sweep.id !== state.sweep) return;
    const rows = plottedRows(sweep), statistic = statisticOf(sweep), chosen = rows.find((r) => r.form === state.form) ?? rows[0];
    const shown = [sweep.id, statistic, chosen.format, state.form].join(" ");
    if (shown === sweepParts.shown) return;
    sweepParts.shown = shown;
    sweepParts.pickers.replaceChildren(
        choice("sweep", "pick-sweep", index.sweeps.map((s) => [s.id, s.title]), sweep.id, (id) => look({ sweep: id })),
        choice("statistic", "pick-statistic", sweep.statistics.map((s) => [s, words(s)]), statistic, (s) => look({ statistic: s })),
        choice("format", "pick-sweep-format", [...new Set(sweep.rows.map((r) => r.format))].map((f) => [f, f]), chosen.format, (format) => look({ format })),
        choice("form", "pick-sweep-form", rows.map((r) => [r.form, r.form]), chosen.form, (form) => look({ form })));
    sweepParts.plot?.destroy();
    sweepParts.plot = plotSweep(sweep, rows, statistic);
    sweepParts.onsets.replaceChildren(...onsetLines(chosen));
    sweepParts.now = { sweep, rows, chosen, statistic };
}

function buildSweeps() {
    const root = document.getElementById("sweep-view");
    Object.assign(sweepParts, { pickers: make("div", { className: "pickers" }), element: make("div", { className: "plot", id: "sweep-plot" }), onsets: make("div"), copied: make("pre", { className: "copied", hidden: true }) });
    const { copied } = sweepParts;
    root.append(sweepParts.pickers, sweepParts.element, make("p", { className: "hint" }, "The thick line is the form whose map is above: click a line to choose its form, drag to zoom, double-click to see all."), sweepParts.onsets,
        make("div", { className: "buttons" },
            make("button", { type: "button", onclick: () => copyText(`lostbits sweep ${state.sweep} -i ${sweepParts.now.chosen.form} -f ${sweepParts.now.chosen.format} -o out`, copied) }, "copy the command"),
            make("button", { type: "button", id: "copy-sweep-claim", onclick: () => copyText(sweepClaim(sweepParts.now.sweep, sweepParts.now.chosen, sweepParts.now.statistic), copied) }, "copy as claim")), copied);
    root.hidden = false;
    sweepParts.element.addEventListener("click", () => {
        const row = sweepParts.now.rows[(sweepParts.focused ?? 0) - 1];
        if (row && row.form !== state.form) look({ form: row.form });
    });
    listeners.push(drawSweep);
}
