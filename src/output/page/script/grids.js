// Planes of two axes and tables of named cases: cells in the colours of the PNGs. Arrow keys move from cell to cell.

const gridParts = {};

const isFraction = (statistic) => statistic.endsWith("_fraction");

const shortTick = (x) => tickText(Number(x.toPrecision(3)));

/** Columns and lines in drawing order. The top line is the highest second value of a plane, or the first case. */
function layoutOf(sweep, rows) {
    if (sweep.kind === "plane") {
        const [x, y] = sweep.axes;
        return {
            columns: x.values.length,
            lines: y.values.length,
            cell: (i, j) => [null, j * x.values.length + i],
            up: true,
            across: x.values.map(shortTick),
            down: y.values.map(shortTick)
        };
    }
    return {
        columns: rows.length,
        lines: sweep.cases.length,
        cell: (i, j) => [rows[i], j],
        up: false,
        across: rows.map(shortName),
        down: sweep.cases.map(([name]) => name)
    };
}

const wrongOutcomes = [outcomeNames.indexOf("not_a_number"), ...wrongDecisions];

/** The most frequent wrong outcome if more than half of the rays are wrong, else -1. Ties go to the first. */
function mostlyWrong(counts) {
    return total(wrongOutcomes.map((o) => counts[o])) / total(counts) > 0.5 ?
        wrongOutcomes.reduce((best, o) => (counts[o] > counts[best] ? o : best)) :
        -1;
}

/** Colour and text of a cell. The colour is null where there is no value. */
function cellLook(sweep, row, statistic, cell) {
    const counts = row.outcomes[cell];
    if (statistic === "verdict") {
        const verdict = row.verdicts[cell], outcome = outcomeNames.indexOf(verdict);
        if (verdict === "right") return { colour: sweep.right, text: "" };
        if (outcome < 0) {
            const bits = cellValue(sweep, row, "lost_bits_max", cell), colour = rampAt(sweep.scales[row.format], bits);
            return verdict === "within_inputs" ? {
                colour: paler(sweep, colour),
                text: `${bits.toFixed(0)}/${asNumber(row.inherent[cell]).toFixed(0)} b`
            } :
                                                 { colour, text: `${bits.toFixed(0)} b` };
        }
        const all = total(counts);
        return { colour: index.outcomes[outcome][1], text: counts[outcome] < all ? `${counts[outcome]}/${all}` : "" };
    }
    const value = drawnValue(sweep, row, statistic, cell), wrong = isFraction(statistic) ? -1 : mostlyWrong(counts);
    if (wrong >= 0) return { colour: index.outcomes[wrong][1], text: "" };
    if (Number.isNaN(value)) return { colour: null, text: "" };
    return {
        colour: rampAt(isFraction(statistic) ? { lo: 0, hi: 1, spacing: "linear" } : sweep.scales[row.format], value),
        text: ""
    };
}

const paler = (sweep, colour) => colour.map((x, k) => (x + sweep.paper[k]) >> 1);

/** True if the form, and not the problem, loses the bits of a cell of a plane. */
function isBlamed(sweep, row, cell) {
    return mostlyWrong(row.outcomes[cell]) < 0 && drawnValue(sweep, row, "lost_bits_p99", cell) >= 1 &&
        cellValue(sweep, row, "excess_bits_p99", cell) >= 1;
}

/** Draws lines around the cells whose bits the form loses. */
function outlineBlamed(context, { sweep, chosen, statistic }, layout, frame) {
    if (!layout.up || statistic !== "lost_bits_p99") return;
    const inside = (i, j) =>
        i >= 0 && j >= 0 && i < layout.columns && j < layout.lines && isBlamed(sweep, chosen, layout.cell(i, j)[1]);
    for (const [colour, wide, off] of [["#fff", 1, -0.5], ["#202024", 2, 1]]) {
        context.fillStyle = colour;
        for (let j = 0; j < layout.lines; ++j) {
            for (let i = 0; i < layout.columns; ++i) {
                if (!inside(i, j)) continue;
                const [x, y] = placeOf(layout, frame, i, j), { w, h } = frame, at = off - wide / 2;
                if (!inside(i - 1, j)) context.fillRect(x + at, y, wide, h);
                if (!inside(i + 1, j)) context.fillRect(x + w - at - wide, y, wide, h);
                if (!inside(i, j + 1)) context.fillRect(x, y + at, w, wide);
                if (!inside(i, j - 1)) context.fillRect(x, y + h - at - wide, w, wide);
            }
        }
    }
}

/** Black or white, whichever contrasts more with a colour. Both contrasts are equal at a relative luminance of 0.18. */
function inkOn(colour) {
    const [r, g, b] = colour.map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.18 ? "#202024" : "#fff";
}

function paintCell(context, look, x, y, w, h) {
    context.fillStyle = look.colour ? `rgb(${look.colour.join(",")})` : "#f0f0ee";
    context.fillRect(x, y, w, h);
    if (!look.colour) {
        context.strokeStyle = "#c8c8ca";
        strokeAlong(context, [x, y + h], [x + w, y]);
    }
    if (!look.text) return;
    context.fillStyle = inkOn(look.colour);
    context.textAlign = "center";
    context.fillText(look.text, x + w / 2, y + h / 2 + 1);
}

/**
 * Position of the field in the canvas, in CSS pixels. Labels stand to the left, and above (names) or below (values).
 */
function frameOf(context, { sweep, rows, statistic }, layout) {
    const wide = (texts) => Math.ceil(Math.max(...texts.map((t) => context.measureText(t).width)));
    if (layout.up) {
        const w = Math.max(3, Math.floor(560 / layout.columns)), h = Math.max(3, Math.floor(400 / layout.lines));
        return { left: wide(layout.down) + 30, top: 6, w, h, gap: 0, below: 44 };
    }
    const written = rows.flatMap((row) => row.outcomes.map((_, cell) => cellLook(sweep, row, statistic, cell).text));
    return {
        left: Math.min(420, wide(layout.down)) + 10,
        top: Math.min(240, wide(layout.across)) + 10,
        w: Math.max(26, wide(written) + 8),
        h: 22,
        gap: 1,
        below: 4
    };
}

function drawLabels(context, sweep, layout, frame) {
    const { left, top, w, h } = frame, every = layout.up ? [Math.ceil(56 / w), Math.ceil(22 / h)] : [1, 1];
    context.fillStyle = ink("--ink");
    context.textAlign = "right";
    layout.down.forEach(
        (text, j) => j % every[1] === 0 &&
            context.fillText(text, left - 6, top + (layout.up ? layout.lines - 1 - j : j) * h + h / 2, left - 8));
    layout.across.forEach((text, i) => {
        if (i % every[0] !== 0) return;
        context.save();
        context.translate(left + (i + 0.5) * w, layout.up ? top + layout.lines * h + 12 : top - 5);
        if (!layout.up) context.rotate(-Math.PI / 2);
        context.textAlign = layout.up ? "center" : "left";
        context.fillText(text, 0, 0, layout.up ? undefined : top - 8);
        context.restore();
    });
    if (!layout.up) return;
    const [x, y] = sweep.axes.map((axis) => axis.label);
    context.textAlign = "center";
    context.fillText(x, left + (layout.columns * w) / 2, top + layout.lines * h + 32);
    context.translate(10, top + (layout.lines * h) / 2);
    context.rotate(-Math.PI / 2);
    context.fillText(y, 0, 0);
}

function drawGrid() {
    const { sweep, rows, chosen, statistic } = sweepParts.now, canvas = gridParts.canvas,
                                           layout = layoutOf(sweep, rows), font = "12px sans-serif";
    const sharp = Math.max(1, Math.min(3, Math.ceil(devicePixelRatio))), context = canvas.getContext("2d");
    context.font = font;
    const frame = frameOf(context, sweepParts.now, layout), width = frame.left + layout.columns * frame.w + 8,
          height = frame.top + layout.lines * frame.h + frame.below;
    canvas.width = width * sharp;
    canvas.height = height * sharp;
    canvas.style.width = `${width}px`;
    context.scale(sharp, sharp);
    context.font = font;
    context.textBaseline = "middle";
    for (let j = 0; j < layout.lines; ++j) {
        for (let i = 0; i < layout.columns; ++i) {
            const [row, cell] = layout.cell(i, j), [x, y] = placeOf(layout, frame, i, j);
            paintCell(
                context, cellLook(sweep, row ?? chosen, statistic, cell), x, y, frame.w - frame.gap,
                frame.h - frame.gap);
        }
    }
    outlineBlamed(context, sweepParts.now, layout, frame);
    const at = gridCell(sweep, rows, chosen);
    if (at) {
        const [x, y] = placeOf(layout, frame, ...at);
        ringAround(context, x, y, frame.w - frame.gap, frame.h - frame.gap);
    }
    drawLabels(context, sweep, layout, frame);
    Object.assign(gridParts, { layout, frame, width, height });
    canvas.setAttribute(
        "aria-label",
        `${sweep.title}: ${words(statistic)} ${
            layout.up ? `of ${title(chosen)}` : `in ${chosen.format}`}; arrow keys move from cell to cell`);
}

const placeOf =
    (layout, frame, i, j) => [frame.left + i * frame.w, frame.top + (layout.up ? layout.lines - 1 - j : j) * frame.h];

/** The chosen cell: column and line of a plane, form and case of a table; null if none is chosen. */
function gridCell(sweep, rows, chosen) {
    if (state.v < 0) return null;
    return sweep.kind === "plane" ? [state.u, state.v] : [rows.indexOf(chosen), state.v];
}

function gridUnder(event) {
    const { canvas, layout, frame, width, height } = gridParts, [x, y] = shareOf(canvas, event);
    const i = Math.floor((x * width - frame.left) / frame.w), line = Math.floor((y * height - frame.top) / frame.h);
    return i >= 0 && i < layout.columns && line >= 0 && line < layout.lines ?
        [i, layout.up ? layout.lines - 1 - line : line] :
        null;
}

/** Values of both axes at a cell of a plane. */
function placesOf(sweep, cell) {
    const [x, y] = sweep.axes.map((axis) => axis.values);
    return [x[cell % x.length], y[Math.floor(cell / x.length)]];
}

/** The cell in column i of line j: its row, its index, and its position in words. */
function cellAt(i, j) {
    const { sweep, chosen } = sweepParts.now, [row, cell] = gridParts.layout.cell(i, j);
    const place = sweep.kind === "cases" ?
        [["case", sweep.cases[cell][0], ""]] :
        placesOf(sweep, cell).map((value, k) => [sweep.axes[k].label, decimal(value), hex(value)]);
    return { row: row ?? chosen, cell, place };
}

function chooseCell(i, j) {
    const { sweep, rows } = sweepParts.now;
    return sweep.kind === "plane" ? goTo({ u: i, v: j }) : goAlong(rows[i], { v: j });
}

function walkGrid(dx, dy) {
    const { sweep, rows, chosen } = sweepParts.now, { layout } = gridParts, at = gridCell(sweep, rows, chosen);
    if (!at)
        return chooseCell(
            sweep.kind === "plane" ? layout.columns >> 1 : rows.indexOf(chosen),
            sweep.kind === "plane" ? layout.lines >> 1 : 0);
    return chooseCell(
        within(at[0] + dx, 0, layout.columns - 1), within(at[1] + (layout.up ? -dy : dy), 0, layout.lines - 1));
}

/** Legend of the grid: the colour bar, and the outcomes that occur. */
function gridLegend() {
    const { sweep, rows, chosen, statistic } = sweepParts.now, isVerdict = statistic === "verdict",
                                           isPlane = sweep.kind === "plane", shown = isPlane ? [chosen] : rows;
    const cells = shown.flatMap((row) => row.outcomes.map((counts, cell) => ({ row, counts, cell })));
    const outcomeOf = ({ row, counts, cell }) => isVerdict ? outcomeNames.indexOf(row.verdicts[cell]) :
        isFraction(statistic)                              ? -1 :
                                                             mostlyWrong(counts);
    const seen = new Set(cells.map(outcomeOf).filter((outcome) => outcome >= 0));
    const scale =
        isFraction(statistic) ? [0, 0.25, 0.5, 0.75, 1].map((x) => [x, String(x)]) : sweep.scales[chosen.format].ticks;
    const entries = [rampBar(scale, isVerdict ? "lost bits, max" : words(statistic))];
    const say = (text) => entries.push(make("span.class", text));
    if (isVerdict) {
        entries.push(ofColour(sweep.right, `right: ${sweep.right_means}`));
        if (rows.some((row) => row.verdicts.includes("within_inputs")))
            say(`22/21 b, paler colour: ${sweep.within_means}`);
        say(sweep.numbers_mean);
    }
    for (const outcome of [...seen].sort())
        entries.push(
            ofColour(index.outcomes[outcome][1], `${words(outcomeNames[outcome])}${isVerdict ? "" : " on most rays"}`));
    if (statistic === "lost_bits_p99" && isPlane) {
        const any = cells.some(({ cell }) => isBlamed(sweep, chosen, cell));
        entries.push(make("span.class#outlined", any ? sweep.outlined_means : sweep.nowhere_outlined));
    }
    if (!isFraction(statistic) && !isVerdict && cells.some(({ row, cell }) => isWithheld(row, statistic, cell)))
        say(`crossed out: ${sweep.gap_means}`);
    return entries;
}

const gridKeys = {
    ArrowLeft: () => walkGrid(-1, 0),
    ArrowRight: () => walkGrid(1, 0),
    ArrowUp: () => walkGrid(0, -1),
    ArrowDown: () => walkGrid(0, 1),
    Escape: () => goTo({ u: -1, v: -1 })
};

function buildGrid() {
    const canvas = gridParts.canvas = make("canvas#grid", { tabIndex: 0, role: "img", "aria-label": "cells" });
    canvas.addEventListener("click", (event) => {
        const at = gridUnder(event);
        canvas.focus();
        if (at) chooseCell(...at);
    });
    canvas.addEventListener("pointermove", (event) => {
        const at = gridUnder(event);
        showCell(at && cellAt(...at));
    });
    canvas.addEventListener("pointerleave", () => showCell(null));
    walkedByKeys(canvas, gridKeys);
    return canvas;
}
