// Time against kept bits; a point is a form, and a click shows its map.

const tradeParts = { shown: "" };

function plotTrade(set) {
    const points = set.points.filter((p) => typeof p.kept_bits === "number").sort((a, b) => a.time_ns - b.time_ns);
    const x = points.map((p) => p.time_ns), pick = (test) => points.map((p) => (test(p) ? p.kept_bits : null));
    const look32 = { stroke: "#4477aa", fill: "#4477aa" }, look64 = { stroke: "#ee6677", fill: "#ee6677" };
    const dots = (label, look, filled, size) => ({ label, ...look, paths: () => null, points: { show: true, size, width: 1.5, stroke: look.stroke, fill: filled ? look.fill : ink("--page") } });
    const best = (p) => !p.dominated;
    tradeParts.points = points;
    tradeParts.element.replaceChildren();
    const plot = new uPlot({
        ...plotSize(tradeParts.element),
        scales: { x: { time: false, distr: 3, log: 2, range: () => logEnds(x) }, y: { range: (_, low, high) => [0, Math.max(4, high + 2)] } },
        axes: [{ ...axisLook("time a ray, ns"), values: (_, ticks) => ticks.map(tickText) }, axisLook("bits that 99 % of the hits keep")],
        legend: { live: false, markers: { fill: (u, k) => (k >= 4 ? ink("--page") : u.series[k].stroke()) } },
        cursor: { points: { show: false } },
        series: [{}, { label: "nothing beats these", stroke: ink("--ink"), width: 1.25, spanGaps: true, paths: uPlot.paths.stepped({ align: 1 }), points: { show: false } },
            dots("f32", look32, true, 9), dots("f64", look64, true, 9), dots("f32, dominated or at times wrong", look32, false, 6), dots("f64, dominated or at times wrong", look64, false, 6)],
        hooks: { setCursor: [(u) => pointUnder(u)] },
    }, [x, pick(best), pick((p) => best(p) && p.wrong_fraction === 0 && p.format === "f32"), pick((p) => best(p) && p.wrong_fraction === 0 && p.format === "f64"),
        pick((p) => !(best(p) && p.wrong_fraction === 0) && p.format === "f32"), pick((p) => !(best(p) && p.wrong_fraction === 0) && p.format === "f64")], tradeParts.element);
    return plot;
}

function pointUnder(plot) {
    const { left, top } = plot.cursor;
    let nearest = null, least = 20;
    for (const p of tradeParts.points) {
        const d = Math.hypot(plot.valToPos(p.time_ns, "x") - left, plot.valToPos(p.kept_bits, "y") - top);
        if (d < least) [nearest, least] = [p, d];
    }
    tradeParts.under = nearest;
    tradeParts.words.textContent = nearest ? `${nearest.form} in ${nearest.format}, ${nearest.isa === "scalar" ? "one ray at a time" : `${nearest.isa}-bit registers`}: ${rounded(nearest.time_ns)} ns a ray, keeps ${rounded(nearest.kept_bits)} bits${nearest.wrong_fraction > 0 ? `, decides ${rounded(nearest.wrong_fraction)} of the rays wrongly` : ""}` : " ";
}

function drawTrade() {
    const trade = index.trades.find((t) => t.shape === state.shape), set = trade.sets.find((s) => s.name === state.set);
    const shown = `${trade.shape} ${set.name}`;
    if (shown === tradeParts.shown) return;
    tradeParts.shown = shown;
    tradeParts.pickers.replaceChildren(choice("shape", "pick-shape", index.trades.map((t) => [t.shape, t.shape]), trade.shape, (shape) => look({ shape })),
        choice("rays", "pick-set", trade.sets.map((s) => [s.name, s.title]), set.name, (name) => look({ set: name })));
    tradeParts.plot?.destroy();
    tradeParts.plot = plotTrade(set);
}

function buildTrade() {
    const root = document.getElementById("trade-view");
    Object.assign(tradeParts, { pickers: make("div", { className: "pickers" }), element: make("div", { className: "plot", id: "trade-plot" }), words: make("p", { className: "hint", "aria-live": "polite" }, " ") });
    root.append(tradeParts.pickers, tradeParts.element, tradeParts.words);
    root.hidden = false;
    tradeParts.element.addEventListener("click", () => {
        const p = tradeParts.under, map = p && index.maps.find((m) => m.rows.some((r) => r.form === p.name && r.format === p.format));
        if (!map) return;
        const here = index.maps.length > 0 && mapNow().rows.some((r) => r.form === p.name && r.format === p.format);
        look({ form: p.name, format: p.format, ...(here ? {} : { scene: map.id, x: -1, y: -1 }) });
        document.getElementById("maps").scrollIntoView();
    });
    listeners.push(drawTrade);
}
