// A statistic along a sweep, over a plane or for named cases: the pickers, and the numbers of one cell.

const sweepParts = {
    shown: "",
    plot: null
};

const sweepOf = (id) => jsonOf(`sweep:${id}`);

const asNumber = (v) => (v === null ? NaN : v === "inf" ? Infinity : v === "-inf" ? -Infinity : v);

/** Key of the chosen row: the one asked for here, else the map's, else the nearest to it that the sweep has. */
function sweepKey() {
    const { rows } = index.sweeps.find((s) => s.id === state.sweep);
    return [state.line, `${state.form}.${state.format}`].find((key) => rows.includes(key)) ??
        rows.find((key) => state.form && key.startsWith(`${state.form}.`)) ??
        rows.find((key) => key.endsWith(`.${state.format}`)) ?? rows[0];
}

/** Chooses a row of the sweep, and the same row in the map if the map has it. */
function goAlong(row, more = {}) {
    const inMap = index.maps.length > 0 && mapNow().rows.some((r) => keyOf(r) === keyOf(row));
    return goTo({ line: keyOf(row), ...(inMap ? { form: row.form, format: row.format } : {}), ...more });
}

const statisticsOf = (sweep) => (sweep.kind === "cases" ? ["verdict", ...sweep.statistics] : sweep.statistics);

function statisticOf(sweep) {
    const all = statisticsOf(sweep);
    return all.includes(state.statistic) ? state.statistic : all.includes("verdict") ? "verdict" : "lost_bits_p99";
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
        statistic: statisticOf(sweep)
    };
}

/** Value of a statistic in a cell of a row. A cell is a step, a cell of a plane, or a case. */
const cellValue = (sweep, row, statistic, cell) => asNumber(row.values[sweep.statistics.indexOf(statistic)][cell]);

/** True if the statistic is a quantile over too few of the hits to stand for the form. */
const isWithheld = (row, statistic, cell) =>
    !isFraction(statistic) && !isEnough(row.outcomes[cell][agreeHit], row.true_hits[cell]);
/** The value that pictures show: NaN where a quantile is withheld. */
const drawnValue = (sweep, row, statistic, cell) =>
    (isWithheld(row, statistic, cell) ? NaN : cellValue(sweep, row, statistic, cell));
const fewHits = (row, cell) => tooFew(row.outcomes[cell][agreeHit], row.true_hits[cell]);

/** The chosen cell, or null: its row, its index, and its position as triples of name, value and exact value. */
function cellNow() {
    const { sweep, rows, chosen } = sweepParts.now;
    if (sweep.kind === "line") return state.u < 0 ? null : stepAt(state.u);
    const at = gridCell(sweep, rows, chosen);
    return at && cellAt(...at);
}

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
                    "Point at the plot for the numbers of a step. Click, or use the arrow keys, to keep them. " +
                        "A click also chooses the form whose line is under the pointer. " +
                        "Drag to zoom; double-click to see all." :
                    "Point at a cell for its numbers. Click, or use the arrow keys, to keep them. Escape lets go."));
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

function turnRow(by) {
    const { rows, chosen } = sweepParts.now;
    return goAlong(rows[(rows.indexOf(chosen) + by + rows.length) % rows.length]);
}

const turnStatistic = (by) => {
    const { sweep, statistic } = sweepParts.now, all = statisticsOf(sweep);
    return goTo({ statistic: all[(all.indexOf(statistic) + by + all.length) % all.length] });
};

/** Binds the arrow keys of `keys`. m and M change the statistic, [ and ] the form, as on a map. */
const walkedByKeys = (element, keys) => onKeys(
    element,
    {...keys, m: () => turnStatistic(1), M: () => turnStatistic(-1), "]": () => turnRow(1), "[": () => turnRow(-1) });

function drawSweepPickers() {
    const { sweep, judged, rows, chosen, statistic } = sweepParts.now;
    const picker = (label, id, options, value, onchange) =>
        choice(label, `pick-${id}`, options.map((o) => (Array.isArray(o) ? o : [o, o])), value, onchange);
    const ofFormat = (format) => {
        const all = sweep.rows.filter((r) => r.format === format);
        return goAlong(all.find((r) => r.form === chosen.form) ?? all[0]);
    };
    showPickers(
        sweepParts.pickers,
        picker("sweep", "sweep", titled(index.sweeps), sweep.id, (id) => goTo({ sweep: id, u: -1, v: -1 })),
        picker(
            "statistic", "statistic", statisticsOf(sweep).map((s) => [s, words(s)]), statistic,
            (s) => goTo({ statistic: s })),
        picker("format", "sweep-format", [...new Set(sweep.rows.map((r) => r.format))], chosen.format, ofFormat),
        picker(
            "form", "sweep-form", rows.map((r) => r.form), chosen.form,
            (form) => goAlong(rows.find((r) => r.form === form))),
        ...(sweep.conventions?.length > 1 ?
                [picker(
                    "judged by", "judged", sweep.conventions.map((c) => [c, `the ${c} primitive`]), judged,
                    (c) => goTo({ judged: c }))] :
                []));
}

async function drawSweep() {
    const sweep = await sweepOf(state.sweep);
    if (sweep.id !== state.sweep) return;
    const now = sweepNow(sweep), { element, grid, legend, onsets, lineKey } = sweepParts, line = sweep.kind === "line";
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
        drawSweepPickers();
        sweepParts.plot?.destroy();
        sweepParts.plot = null;
        element.hidden = !line;
        grid.hidden = line;
        lineKey.replaceChildren();
        if (line) sweepParts.plot = plotSweep(now);
        sweepParts.showNote(index.sweeps.find((s) => s.id === sweep.id).note);
        legend.replaceChildren(...(line ? [] : gridLegend()));
        onsets.replaceChildren(...(line ? onsetLines(now.chosen) : []));
    }
    if (line) sweepParts.plot.redraw(false);
    else drawGrid();
    showCell(null);
}

function buildSweeps() {
    const root = document.getElementById("sweep-view"), copied = copiedBox(), [note, showNote] = noteBox("sweep-note");
    const parts = Object.assign(sweepParts, {
        showNote,
        lineKey: make("ul.line-key#line-key"),
        pickers: make("div.pickers"),
        element: buildLines(),
        grid: make("div.grid", buildGrid()),
        under: make("p.hint#sweep-under", "\u00a0"),
        legend: make("div.legend"),
        facts: make("div.facts#sweep-facts", { "aria-live": "polite" }),
        onsets: make("div")
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
            "div.stage", make("div.picture.wide", parts.element, parts.grid, parts.under, parts.legend),
            make("div.side", parts.lineKey, parts.facts, make("div.buttons", ...buttons), copied)),
        parts.onsets);
    root.hidden = false;
    listeners.push(drawSweep);
}
