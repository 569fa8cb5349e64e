// Time against kept bits; a point is a form, and a click shows its map.

const tradeParts = {
    shown: ""
};

function plotTrade(trade, set) {
    const points = set.points.filter((p) => typeof p.kept_bits === "number").sort((a, b) => a.time_ns - b.time_ns);
    const x = points.map((p) => p.time_ns), pick = (test) => points.map((p) => (test(p) ? p.kept_bits : null));
    const look32 = { stroke: "#4477aa", fill: "#4477aa" }, look64 = { stroke: "#ee6677", fill: "#ee6677" };
    const dots = (label, look, filled, size) => ({
        label,
        ...look,
        paths: () => null,
        points: { show: true, size, width: 1.5, stroke: look.stroke, fill: filled ? look.fill : ink("--page") }
    });
    const best = (p) => !p.dominated;
    const timeAxis = {...axisLook(trade.axes[0]), values: (_, ticks) => ticks.map(tickText) };
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
                hooks: { setCursor: [(u) => pointUnder(u)] },
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
