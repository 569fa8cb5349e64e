// Sweeps along one axis: a line per form, drawn by uPlot; the thick one is the chosen form's.

function plotSweep({ sweep, rows, chosen, statistic }) {
    const s = sweep.statistics.indexOf(statistic), log = sweep.spacing === "log2" && Math.min(...sweep.steps) > 0;
    const order = sweep.steps.map((_, k) => k).sort((a, b) => sweep.steps[a] - sweep.steps[b]);  // some run downwards
    const finite = (y) => (typeof y === "number" ? y : null);
    const data = [order.map((k) => sweep.steps[k]), ...rows.map((r) => order.map((k) => finite(r.values[s][k])))];
    const bits = statistic.includes("bits");
    const { element } = sweepParts;
    sweepParts.order = order;
    element.replaceChildren();
    element.setAttribute(
        "aria-label",
        `${sweep.title}: ${words(statistic)} in ${
            chosen.format}, one line per form; arrow keys move from step to step and from form to form`);
    const ends = log ? logEnds(sweep.steps) : apart(Math.min(...sweep.steps), Math.max(...sweep.steps));
    return new uPlot(
        {
            ...plotSize(element),
            scales: {
                x: { time: false, distr: log ? 3 : 1, log: 2, range: () => ends },
                y: { range: (_, low, high) => [0, bits ? Math.max(2, high * 1.05) : Math.max(0.05, high * 1.05)] }
            },
            axes: [
                {
                    ...axisLook(axisTitle({ name: sweep.axis, unit: sweep.unit })),
                    values: (_, ticks) => ticks.map(tickText)
                },
                axisLook(words(statistic))
            ],
            cursor: { focus: { prox: 24 }, points: { size: 6 } },
            focus: { alpha: 0.25 },
            legend: { live: true },
            series: [
                { label: words(sweep.axis), value: (_, x) => (typeof x === "number" ? rounded(x) : "–") },
                ...rows.map((r, k) => ({
                                label: r.form,
                                stroke: lineColours[k % lineColours.length],
                                width: r === chosen ? 3.5 : 1.25,
                                dash: k < lineColours.length ? undefined : [6, 4],
                                points: { show: false },
                                value: (_, y) => (typeof y === "number" ? rounded(y) : "–")
                            }))
            ],
            hooks: {
                setSeries: [(u, k, options) => {
                    if (options.focus !== null) sweepParts.focused = k;
                }],
                draw: [drawStep]
            },
        },
        data, element);
}

/** A line at the chosen step, and a ring where it meets the chosen form. */
function drawStep(plot) {
    if (state.u < 0) return;
    const { sweep, chosen, statistic } = sweepParts.now, { cell } = stepAt(state.u),
                                     x = plot.valToPos(sweep.steps[cell], "x", true),
                                     value = cellValue(sweep, chosen, statistic, cell);
    const { ctx: context, bbox } = plot;
    if (!(x >= bbox.left && x <= bbox.left + bbox.width)) return;
    context.save();
    context.strokeStyle = ink("--ink");
    context.lineWidth = devicePixelRatio;
    context.beginPath();
    context.moveTo(x, bbox.top);
    context.lineTo(x, bbox.top + bbox.height);
    context.stroke();
    if (Number.isFinite(value)) {
        context.beginPath();
        context.arc(x, plot.valToPos(value, "y", true), 5 * devicePixelRatio, 0, 2 * Math.PI);
        context.stroke();
    }
    context.restore();
}

/** The k-th step in rising order, under the chosen form. */
function stepAt(k) {
    const { sweep, chosen } = sweepParts.now, cell = sweepParts.order[k], value = sweep.steps[cell];
    return {
        row: chosen,
        cell,
        place: [[axisTitle({ name: sweep.axis, unit: sweep.unit }), decimal(value), hex(value)]]
    };
}

function onsetLines(row) {
    if (row.onsets.length === 0) return [make("p", {}, "No threshold is crossed along this sweep.")];
    const body = make("tbody");
    for (const [event, statistic, threshold, good, bad, low, high] of row.onsets)
        body.append(cells(
            "td", `${words(event)} ${statistic}`, decimal(threshold), good === null ? "–" : decimal(good), decimal(bad),
            low === high ? "–" : `${decimal(low)} to ${decimal(high)}`));
    return [make(
        "details", {}, make("summary", {}, `Onsets of ${title(row)}: ${row.onsets.length}`),
        make("table", {}, header("event", "threshold", "last good", "first bad", "first bad over draws"), body))];
}

function walkSteps(by) {
    const last = sweepParts.now.sweep.steps.length - 1;
    return goTo({ u: state.u < 0 ? last >> 1 : Math.min(last, Math.max(0, state.u + by)) });
}

const lineKeys = {
    ArrowLeft: () => walkSteps(-1),
    ArrowRight: () => walkSteps(1),
    ArrowUp: () => turnRow(-1),
    ArrowDown: () => turnRow(1),
    Escape: () => goTo({ u: -1 })
};

function buildLines() {
    const element = make("div", { className: "plot", id: "sweep-plot", tabIndex: 0, role: "group" });
    element.addEventListener("click", (event) => {
        if (!event.target.closest(".u-over")) return;
        const { rows } = sweepParts.now, { idx } = sweepParts.plot.cursor;
        element.focus();
        goAlong(
            rows[(sweepParts.focused ?? 0) - 1] ?? sweepParts.now.chosen, typeof idx === "number" ? { u: idx } : {});
    });
    walkedByKeys(element, lineKeys);
    return element;
}
