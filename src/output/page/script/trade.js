// Time against kept bits. A point is a form, and a click shows its map.

const tradeParts = {
    shown: ""
};

function plotTrade(trade, set) {
    const points = set.points.filter((p) => typeof p.kept_bits === "number").sort((a, b) => a.time_ns - b.time_ns);
    const x = points.map((p) => p.time_ns), pick = (test) => points.map((p) => (test(p) ? p.kept_bits : null));
    const best = (p) => !p.dominated, right = (p) => best(p) && p.wrong_fraction === 0;
    // Full dots are on the front and never wrong; small rings are not.
    const kinds = [true, false].flatMap(
        (full) => ["f32", "f64"].map((format, k) => ({
                                         full,
                                         stroke: onPage(lineColours[k]),
                                         of: (p) => right(p) === full && p.format === format,
                                         label: `${format}${full ? "" : ", not on the front or sometimes wrong"}`
                                     })));
    const dots = ({ full, stroke, label }) => ({
        ...{ label, stroke, fill: stroke, paths: () => null },
        points: { show: true, size: full ? 9 : 6, width: 1.5, stroke, fill: full ? stroke : ink("--page") }
    });
    const front = { label: "Pareto front", stroke: ink("--ink"), width: 1.25, spanGaps: true };
    tradeParts.points = points;
    tradeParts.element.replaceChildren();
    return new uPlot(
        {
            ...plotSize(tradeParts.element),
            scales: {
                x: { time: false, distr: 3, log: 2, range: () => logEnds(x) },
                y: { range: (_, low, high) => [0, Math.max(4, high + 2)] }
            },
            axes: [
                {...axisLook(trade.axes[0]), values: (_, ticks) => ticks.map((x) => (x ? rounded(x) : "")) },
                axisLook(trade.axes[1])
            ],
            legend: { live: false, markers: { fill: (u, k) => (k >= 4 ? ink("--page") : u.series[k].stroke()) } },
            cursor: { points: { show: false } },
            series: [
                {}, {...front, paths: uPlot.paths.stepped({ align: 1 }), points: { show: false } }, ...kinds.map(dots)
            ],
            hooks: { setCursor: [pointUnder], draw: [nameFront] },
        },
        [x, pick(best), ...kinds.map(({ of }) => pick(of))], tradeParts.element);
}

/**
 * Writes names beside the points of the front. A name covers no point and no other name; without free space it is
 * omitted.
 */
function nameFront(plot) {
    const { ctx: context, bbox } = plot, k = devicePixelRatio, taken = [];
    const placed = tradeParts.points.map(
        (p) => ({ p, x: plot.valToPos(p.time_ns, "x", true), y: plot.valToPos(p.kept_bits, "y", true) }));
    for (const { x, y } of placed) taken.push([x - 6 * k, y - 6 * k, 12 * k, 12 * k]);
    // Names do not cover the steps of the front either: right, then up or down.
    const front = placed.filter((q) => !q.p.dominated);
    front.slice(1).forEach(({ x, y }, i) => {
        const from = front[i];
        taken.push([from.x, from.y - k, x - from.x, 2 * k]);
        taken.push([x - k, Math.min(y, from.y), 2 * k, Math.abs(y - from.y)]);
    });
    const free = ([x, y, w, h]) => x >= bbox.left && y >= bbox.top && x + w <= bbox.left + bbox.width &&
        y + h <= bbox.top + bbox.height &&
        taken.every(([a, b, c, d]) => x >= a + c || a >= x + w || y >= b + d || b >= y + h);
    context.save();
    context.font = `${11 * k}px sans-serif`;
    context.textBaseline = "middle";
    context.textAlign = "left";
    tradeParts.named = [];
    for (const { p, x, y } of front) {
        const text = shortName(p), w = context.measureText(text).width + 4 * k, h = 14 * k;
        // Try positions to the right, above, below and to the left, then diagonal ones, at growing distances.
        const boxes = [8, 20, 34, 50, 70].flatMap((away) => {
            const d = away * k, right = (d) => x + d, left = (d) => x - d - w, above = (d) => y - d - h,
                  below = (d) => y + d;
            return [
                ...[[right(d), y - h / 2], [x - w / 2, above(d)], [x - w / 2, below(d)], [left(d), y - h / 2]],
                ...[right(0.7 * d), left(0.7 * d)].flatMap((at) => [[at, above(0.7 * d)], [at, below(0.7 * d)]])
            ].map(([x, y]) => [x, y, w, h]);
        });
        const box = boxes.find(free);
        if (!box) continue;
        taken.push(box);
        tradeParts.named.push({ text, box, at: [x, y] });
        const [left, top] = box, near = [within(x, left, left + w), within(y, top, top + h)];
        context.strokeStyle = ink("--line");
        context.lineWidth = k;
        if (Math.hypot(near[0] - x, near[1] - y) > 14 * k) strokeAlong(context, [x, y], near);
        context.fillStyle = ink("--ink");
        context.fillText(text, left + 2 * k, top + h / 2);
    }
    context.restore();
}

function pointUnder(plot) {
    const { left, top } = plot.cursor;
    let nearest = null, least = 20;
    for (const p of tradeParts.points) {
        const d = Math.hypot(plot.valToPos(p.time_ns, "x") - left, plot.valToPos(p.kept_bits, "y") - top);
        if (d < least) [nearest, least] = [p, d];
    }
    sayPoint(nearest);
}

function sayPoint(p) {
    tradeParts.under = p;
    const wrong = p && p.wrong_fraction > 0 ? `, wrong on a share of ${rounded(p.wrong_fraction)} of the rays` : "";
    tradeParts.words.textContent = p ?
        `${p.form} in ${p.format}, ${p.registers}: ${rounded(p.time_ns)} ns per ray, keeps ${
            rounded(p.kept_bits)} bits${wrong}${mapOf(p) ? "; click, or press Enter, for its map" : ""}` :
        "\u00a0";
}

/** Moves the cursor to the next point by time, for the keyboard. */
function walkPoints(by) {
    const { points, plot, under } = tradeParts, last = points.length - 1;
    const next = under ? within(points.indexOf(under) + by, 0, last) : by > 0 ? 0 : last;
    const p = points[next];
    plot.setCursor({ left: plot.valToPos(p.time_ns, "x"), top: plot.valToPos(p.kept_bits, "y") }, false);
    sayPoint(p);
}

const hasRow = (map, p) => map.rows.some((r) => r.form === p.form && r.format === p.format);
/** The map that is shown if it has the point's form, otherwise the first map that has it. */
const mapOf = (p) => (index.maps.length > 0 && hasRow(mapNow(), p) ? mapNow() : index.maps.find((m) => hasRow(m, p)));

function showMapOf(p) {
    const map = p && mapOf(p);
    if (!map) return;
    goTo({ form: p.form, format: p.format, ...(map === mapNow() ? {} : { scene: map.id, x: -1, y: -1 }) });
    document.getElementById("maps").scrollIntoView();
}

function drawTrade() {
    const trade = index.trades.find((t) => t.shape === state.shape), set = trade.sets.find((s) => s.name === state.set);
    const shown = `${trade.shape} ${set.name}`;
    if (shown === tradeParts.shown) return;
    tradeParts.shown = shown;
    showPickers(
        tradeParts.pickers,
        choice(
            "shape", "pick-shape", index.trades.map((t) => [t.shape, t.shape]), trade.shape,
            (shape) => goTo({ shape })),
        choice("rays", "pick-set", trade.sets.map((s) => [s.name, s.title]), set.name, (name) => goTo({ set: name })));
    tradeParts.plot?.destroy();
    tradeParts.plot = plotTrade(trade, set);
}

function buildTrade() {
    const root = document.getElementById("trade-view");
    Object.assign(tradeParts, {
        pickers: make("div.pickers"),
        element: make("div", {
            className: "plot",
            id: "trade-plot",
            tabIndex: 0,
            role: "group",
            "aria-label": "time against kept bits; arrow keys move from point to point, Enter shows the map"
        }),
        words: make("p.hint", { "aria-live": "polite" }, " ")
    });
    root.append(tradeParts.pickers, tradeParts.element, tradeParts.words);
    root.hidden = false;
    tradeParts.element.addEventListener("click", () => showMapOf(tradeParts.under));
    onKeys(
        tradeParts.element,
        { ArrowRight: () => walkPoints(1), ArrowLeft: () => walkPoints(-1), Enter: () => showMapOf(tradeParts.under) });
    listeners.push(drawTrade);
}
