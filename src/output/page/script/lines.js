// Sweeps along one axis, drawn by uPlot. Forms with the same values share a line, and each line is named at its end.
// The chosen form's line is thick.

const endGap = 14;  // pixels between the names of lines

/**
 * Maps a value to a height on the axis of the statistic. Fractions are shown by their logarithms. A fraction of 0 is
 * drawn half a decade below the smallest fraction that a step can have.
 */
function heights({ rows, statistic }) {
    if (!isFraction(statistic)) return { of: (value) => value };
    const most = Math.max(1, ...rows.flatMap((row) => row.outcomes.map((o) => total(o)))), low = Math.log10(1 / most),
          foot = low - 0.5, decades = [];
    for (let e = Math.ceil(low); e <= 0; ++e) decades.push(e);
    return {
        of: (value) =>
            (value > 0       ? Math.log10(value) :
                 value === 0 ? foot :
                               NaN),
        range: [foot - 0.1, 0.05],
        ticks: [foot, ...decades],
        text: (e) => (e === foot ? "0" : decimal(Number((10 ** e).toPrecision(6))))
    };
}

/**
 * Groups forms that have the same values at every step. A group shares one line, in the look and at the place of its
 * first form.
 */
function lineGroups({ sweep, rows, statistic }, order) {
    const groups = new Map();
    for (const row of rows) {
        const y = order.map((k) => {
            const value = sweepParts.heights.of(drawnValue(sweep, row, statistic, k));
            return Number.isFinite(value) ? value : null;
        });
        const key = JSON.stringify(y), group = groups.get(key);
        if (group) group.rows.push(row);
        else groups.set(key, { rows: [row], y });
    }
    return [...groups.values()].map((g) => ({...g, ...lineLook(g.rows[0].look) }));
}

/** `unified and 4 with the same values` */
const groupName = ({ rows }, most) =>
    (rows.length <= most ? rows.map(shortName).join(", ") :
                           `${shortName(rows[0])} and ${rows.length - 1} with the same values`);

/** Index of the last value of a line, or -1. */
const lastOf = (group) => group.y.reduce((last, y, k) => (y === null ? last : k), -1);

/**
 * Positions for labels of equal height. They keep their order, do not overlap, and lie as near to the wished positions
 * as possible.
 */
function spreadOut(wishes, gap, low, high) {
    const blocks = [];
    for (const wish of wishes) {
        blocks.push({ sum: wish, n: 1 });
        // A block is centred on the mean of its wished positions. Blocks that touch become one.
        for (;;) {
            const b = blocks.at(-1), a = blocks.at(-2);
            if (!a || a.sum / a.n + ((a.n + b.n) * gap) / 2 <= b.sum / b.n) break;
            a.sum += b.sum;
            a.n += b.n;
            blocks.pop();
        }
    }
    const places =
        blocks.flatMap(({ sum, n }) => Array.from({ length: n }, (_, k) => sum / n + (k - (n - 1) / 2) * gap));
    const from = Math.max(0, low - (places[0] ?? low)), to = Math.min(0, high - (places.at(-1) ?? high));
    return places.map((place) => place + (from || to));
}

/** Writes the names at the right, each beside the end of its line. */
function drawEnds(plot) {
    const { ctx: context, bbox } = plot, k = devicePixelRatio, right = bbox.left + bbox.width;
    const ends = sweepParts.groups.filter((g) => lastOf(g) >= 0)
                     .map((group) => {
                         const at = lastOf(group);
                         return {
                             group,
                             x: Math.min(right, plot.valToPos(plot.data[0][at], "x", true)),
                             y: plot.valToPos(group.y[at], "y", true)
                         };
                     })
                     .filter(({ x, y }) => x >= bbox.left && y >= bbox.top - 1 && y <= bbox.top + bbox.height + 1)
                     .sort((a, b) => a.y - b.y);
    const places = spreadOut(ends.map((e) => e.y), endGap * k, bbox.top, bbox.top + bbox.height);
    context.save();
    context.font = `${11 * k}px sans-serif`;
    context.textBaseline = "middle";
    context.textAlign = "left";
    context.lineWidth = k;
    ends.forEach(({ group, x, y }, i) => {
        context.strokeStyle = group.colour;
        // A line that stops before the right edge is continued by dots.
        context.setLineDash(x < right - 2 * k ? [k, 4 * k] : []);
        strokeAlong(context, [x, y], [right, y]);
        context.setLineDash([]);
        strokeAlong(context, [right, y], [right + 12 * k, places[i]], [right + 16 * k, places[i]]);
        context.fillStyle = ink("--ink");
        context.fillText(endName(group), right + 19 * k, places[i]);
    });
    context.restore();
}

const endName = (group) => shortName(group.rows[0]) + (group.rows.length > 1 ? ` +${group.rows.length - 1}` : "");

/**
 * Shades the part of a sweep where an ulp of the distance is at least as wide as the sphere. No answer of a form is
 * useful there. The shade lies behind the lines.
 */
function shadeTooFar(plot) {
    const { sweep, chosen } = sweepParts.now, part = sweep.too_far[chosen.format];
    if (!part) return;
    const { ctx: context, bbox } = plot, right = bbox.left + bbox.width;
    const [from, to] = part.map((v) => within(plot.valToPos(asNumber(v), "x", true), bbox.left, right));
    context.save();
    context.fillStyle = ink("--shade");
    context.fillRect(
        from, bbox.top, (to >= plot.valToPos(plot.data[0].at(-1), "x", true) ? right : to) - from, bbox.height);
    context.restore();
}

/** Describes the lines and the shade in words, for readers who cannot read the names in the plot. */
function drawLineKey() {
    const { sweep, chosen, rows } = sweepParts.now, { groups, lineKey } = sweepParts;
    const entries = groups.map((group) => {
        const names = make("span", ` ${group.rows.map(shortName).join(", ")}`);
        if (group.rows.length > 1) names.append(make("small", ` (${group.rows.length} forms with the same values)`));
        if (lastOf(group) < 0) names.append(make("small", " (no values)"));
        const entry = make("li", lineSample(group), names);
        entry.classList.toggle("chosen", group.rows.includes(chosen));
        return entry;
    });
    if (groups.length < rows.length) entries.unshift(make("li.hint", `${rows.length} forms, ${groups.length} lines:`));
    if (sweep.too_far[chosen.format]) entries.push(make("li", make("span.shade"), ` ${sweep.too_far_means}`));
    if (rows.some((row) => row.outcomes.some((_, k) => isWithheld(row, sweepParts.now.statistic, k))))
        entries.push(make("li.hint", sweep.gap_means));
    lineKey.replaceChildren(...entries);
}

function plotSweep(now) {
    const { sweep, rows, chosen, statistic } = now;
    const log = sweep.spacing === "log2" && Math.min(...sweep.steps) > 0;
    const order = sweep.steps.map((_, k) => k).sort((a, b) => sweep.steps[a] - sweep.steps[b]);  // some run downwards
    sweepParts.heights = heights(now);
    const groups = lineGroups(now, order), { element } = sweepParts, size = plotSize(element);
    const data = [order.map((k) => sweep.steps[k]), ...groups.map((g) => g.y)];
    const bits = statistic.includes("bits"), named = size.width >= 560, { range, ticks, text } = sweepParts.heights;
    Object.assign(sweepParts, { order, groups });
    element.replaceChildren();
    element.setAttribute(
        "aria-label",
        `${sweep.title}: ${words(statistic)} of ${rows.length} forms in ${chosen.format}, ${
            groups.length} lines; arrow keys move from step to step and from form to form`);
    drawLineKey();
    const ends = log ? logEnds(sweep.steps) : apart(Math.min(...sweep.steps), Math.max(...sweep.steps));
    const longest = Math.max(...groups.map((g) => endName(g).length));
    return new uPlot(
        {
            ...size,
            padding: [null, named ? 24 + 7 * longest : null, null, null],
            scales: {
                x: { time: false, distr: log ? 3 : 1, log: 2, range: () => ends },
                y: { range: (_, low, high) => range ?? [0, bits ? Math.max(2, high * 1.05) : Math.max(0.05, high * 1.05)] }
            },
            axes: [
                {
                    ...axisLook(sweep.label),
                    values: (_, ticks) => ticks.map(tickText)
                },
                range ? {
                    ...axisLook(`${words(statistic)} (log axis, 0 drawn below it)`),
                    size: 66,
                    splits: () => ticks,
                    values: (_, places) => places.map(text)
                } :
                        axisLook(words(statistic))
            ],
            cursor: { focus: { prox: 24 }, points: { size: 6 } },
            focus: { alpha: 0.25 },
            legend: { show: false },
            series: [
                {}, ...groups.map((g) => ({
                                      label: groupName(g, 2),
                                      stroke: g.colour,
                                      width: g.rows.includes(chosen) ? 3.5 : 1.25,
                                      dash: g.dash,
                                      points: { show: false }
                                  }))
            ],
            hooks: {
                setSeries: [(u, k, options) => {
                    if (options.focus !== null) sweepParts.focused = k;
                }],
                setCursor: [({ cursor }) => showCell(stepUnder(cursor))],
                drawClear: [shadeTooFar],
                draw: [...(named ? [drawEnds] : []), drawStep]
            },
        },
        data, element);
}

/** The row whose line is under the pointer. In a group that holds the chosen row, the chosen one. */
function rowUnder() {
    const { chosen } = sweepParts.now, group = sweepParts.groups[(sweepParts.focused ?? 0) - 1];
    return !group || group.rows.includes(chosen) ? chosen : group.rows[0];
}

function stepUnder({ left, idx }) {
    return sweepParts.plot && left >= 0 && typeof idx === "number" ? {...stepAt(idx), row: rowUnder() } : null;
}

/** Draws a line at the chosen step, and a ring where it meets the chosen form's line. */
function drawStep(plot) {
    if (state.u < 0) return;
    const { sweep, chosen, statistic } = sweepParts.now, { cell } = stepAt(state.u),
                                     x = plot.valToPos(sweep.steps[cell], "x", true),
                                     value = drawnValue(sweep, chosen, statistic, cell);
    const { ctx: context, bbox } = plot;
    if (!(x >= bbox.left && x <= bbox.left + bbox.width)) return;
    context.save();
    context.strokeStyle = ink("--ink");
    context.lineWidth = devicePixelRatio;
    strokeAlong(context, [x, bbox.top], [x, bbox.top + bbox.height]);
    if (Number.isFinite(value)) {
        context.beginPath();
        context.arc(x, plot.valToPos(sweepParts.heights.of(value), "y", true), 5 * devicePixelRatio, 0, 2 * Math.PI);
        context.stroke();
    }
    context.restore();
}

/** The k-th step in rising order, for the chosen form. */
function stepAt(k) {
    const { sweep, chosen } = sweepParts.now, cell = sweepParts.order[k], value = sweep.steps[cell];
    return { row: chosen, cell, place: [[sweep.label, decimal(value), hex(value)]] };
}

function onsetLines(row) {
    if (row.onsets.length === 0) return [make("p", "No threshold is crossed along this sweep.")];
    const body = make("tbody");
    for (const [event, statistic, threshold, good, bad, low, high] of row.onsets)
        body.append(cells(
            "td", `${words(event)} ${statistic}`, decimal(threshold), good === null ? "–" : decimal(good), decimal(bad),
            low === high ? "–" : `${decimal(low)} to ${decimal(high)}`));
    return [make(
        "details", make("summary", `Onsets of ${title(row)}: ${row.onsets.length}`),
        make("table", header("event", "threshold", "last good", "first seen bad", "range over draws"), body))];
}

function walkSteps(by) {
    const last = sweepParts.now.sweep.steps.length - 1;
    return goTo({ u: state.u < 0 ? last >> 1 : within(state.u + by, 0, last) });
}

const lineKeys = {
    ArrowLeft: () => walkSteps(-1),
    ArrowRight: () => walkSteps(1),
    ArrowUp: () => turnRow(-1),
    ArrowDown: () => turnRow(1),
    Escape: () => goTo({ u: -1 })
};

function buildLines() {
    const element = make("div.plot#sweep-plot", { tabIndex: 0, role: "group" });
    element.addEventListener("click", (event) => {
        if (!event.target.closest(".u-over")) return;
        const { idx } = sweepParts.plot.cursor;
        element.focus();
        goAlong(rowUnder(), typeof idx === "number" ? { u: idx } : {});
    });
    walkedByKeys(element, lineKeys);
    return element;
}
