// Time against kept bits; a point is a form, and a click shows its map.

const tradeParts = {
    shown: ""
};

function plotTrade(trade, set) {
    const points = set.points.filter((p) => typeof p.kept_bits === "number").sort((a, b) => a.time_ns - b.time_ns);
    const x = points.map((p) => p.time_ns), pick = (test) => points.map((p) => (test(p) ? p.kept_bits : null));
    const look = (k) => ({ stroke: onPage(lineColours[k]), fill: onPage(lineColours[k]) }), look32 = look(0),
          look64 = look(1);
    const dots = (label, look, filled, size) => ({
        label,
        ...look,
        paths: () => null,
        points: { show: true, size, width: 1.5, stroke: look.stroke, fill: filled ? look.fill : ink("--page") }
    });
    const best = (p) => !p.dominated;
    const timeAxis = {...axisLook(trade.axes[0]), values: (_, ticks) => ticks.map((x) => (x ? rounded(x) : "")) };
    tradeParts.points = points;
    tradeParts.element.replaceChildren();
    const plot =
        new uPlot(
            {
                ...plotSize(tradeParts.element),
                scales: {
                    x: { time: false, distr: 3, log: 2, range: () => logEnds(x) },
                    y: { range: (_, low, high) => [0, Math.max(4, high + 2)] }
                },
                axes: [timeAxis, axisLook(trade.axes[1])],
                legend: { live: false, markers: { fill: (u, k) => (k >= 4 ? ink("--page") : u.series[k].stroke()) } },
                cursor: { points: { show: false } },
                series: [
                    {}, {
                        label: "the Pareto front",
                        stroke: ink("--ink"),
                        width: 1.25,
                        spanGaps: true,
                        paths: uPlot.paths.stepped({ align: 1 }),
                        points: { show: false }
                    },
                    dots("f32", look32, true, 9), dots("f64", look64, true, 9),
                    dots("f32, not on the front, or sometimes wrong", look32, false, 6),
                    dots("f64, not on the front, or sometimes wrong", look64, false, 6)
                ],
                hooks: { setCursor: [(u) => pointUnder(u)], draw: [nameFront] },
            },
            [
                x, pick(best), pick((p) => best(p) && p.wrong_fraction === 0 && p.format === "f32"),
                pick((p) => best(p) && p.wrong_fraction === 0 && p.format === "f64"),
                pick((p) => !(best(p) && p.wrong_fraction === 0) && p.format === "f32"),
                pick((p) => !(best(p) && p.wrong_fraction === 0) && p.format === "f64")
            ],
            tradeParts.element);
    return plot;
}

/** Names beside the points of the front, on no point and on no other name; what finds no place stays without. */
function nameFront(plot) {
    const { ctx: context, bbox } = plot, k = devicePixelRatio, taken = [];
    const placed = tradeParts.points.map(
        (p) => ({ p, x: plot.valToPos(p.time_ns, "x", true), y: plot.valToPos(p.kept_bits, "y", true) }));
    for (const { x, y } of placed) taken.push([x - 6 * k, y - 6 * k, 12 * k, 12 * k]);
    // Nor on the steps of the front: right, then up or down.
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
        const text = p.form.slice(p.form.indexOf(".") + 1), w = context.measureText(text).width + 4 * k, h = 14 * k;
        const boxes = [8, 20, 34, 50, 70].flatMap((away) => {
            const d = away * k;
            return [
                [x + d, y - h / 2, w, h], [x - w / 2, y - d - h, w, h], [x - w / 2, y + d, w, h],
                [x - d - w, y - h / 2, w, h], [x + d * 0.7, y - d * 0.7 - h, w, h], [x + d * 0.7, y + d * 0.7, w, h],
                [x - d * 0.7 - w, y - d * 0.7 - h, w, h], [x - d * 0.7 - w, y + d * 0.7, w, h]
            ];
        });
        const box = boxes.find(free);
        if (!box) continue;
        taken.push(box);
        tradeParts.named.push({ text, box, at: [x, y] });
        const [left, top] = box, nearX = Math.min(Math.max(x, left), left + w),
                     nearY = Math.min(Math.max(y, top), top + h);
        context.strokeStyle = ink("--line");
        context.lineWidth = k;
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(nearX, nearY);
        if (Math.hypot(nearX - x, nearY - y) > 14 * k) context.stroke();
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
    const wrong = p && p.wrong_fraction > 0 ? `, decides ${rounded(p.wrong_fraction)} of the rays wrongly` : "";
    tradeParts.words.textContent = p ?
        `${p.form} in ${p.format}, ${p.registers}: ${rounded(p.time_ns)} ns per ray, keeps ${
            rounded(p.kept_bits)} bits${wrong}${mapOf(p) ? "; click, or Enter, for its map" : ""}` :
        "\u00a0";
}

/** The next point by time, with the cursor on it: for the keyboard. */
function walkPoints(by) {
    const { points, plot, under } = tradeParts, last = points.length - 1;
    const next = under ? Math.min(last, Math.max(0, points.indexOf(under) + by)) : by > 0 ? 0 : last;
    const p = points[next];
    plot.setCursor({ left: plot.valToPos(p.time_ns, "x"), top: plot.valToPos(p.kept_bits, "y") }, false);
    sayPoint(p);
}

const hasRow = (map, p) => map.rows.some((r) => r.form === p.name && r.format === p.format);
/** The map that is shown where it has the point's form, otherwise the first that has. */
const mapOf = (p) => (index.maps.length > 0 && hasRow(mapNow(), p) ? mapNow() : index.maps.find((m) => hasRow(m, p)));

function showMapOf(p) {
    const map = p && mapOf(p);
    if (!map) return;
    goTo({ form: p.name, format: p.format, ...(map === mapNow() ? {} : { scene: map.id, x: -1, y: -1 }) });
    document.getElementById("maps").scrollIntoView();
}

function drawTrade() {
    const trade = index.trades.find((t) => t.shape === state.shape), set = trade.sets.find((s) => s.name === state.set);
    const shown = `${trade.shape} ${set.name}`;
    if (shown === tradeParts.shown) return;
    tradeParts.shown = shown;
    tradeParts.pickers.replaceChildren(
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
        pickers: make("div", { className: "pickers" }),
        element: make("div", {
            className: "plot",
            id: "trade-plot",
            tabIndex: 0,
            role: "group",
            "aria-label": "time against kept bits; arrow keys move from point to point, Enter shows the map"
        }),
        words: make("p", { className: "hint", "aria-live": "polite" }, " ")
    });
    root.append(tradeParts.pickers, tradeParts.element, tradeParts.words);
    root.hidden = false;
    tradeParts.element.addEventListener("click", () => showMapOf(tradeParts.under));
    const keys = {
        ArrowRight: () => walkPoints(1),
        ArrowLeft: () => walkPoints(-1),
        Enter: () => showMapOf(tradeParts.under)
    };
    tradeParts.element.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
        keys[event.key]();
        event.preventDefault();
    });
    listeners.push(drawTrade);
}
