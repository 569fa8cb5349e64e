// Time against kept bits. A point is a form, and a click shows its map.

const tradeParts = {
    shown: ""
};

/** The numbers of a point of the chart. The keys of a point are its row and its index. */
const tradePoint = (point) => point && tradeParts.points[Number(point.keys[1])];

function sayPoint(point) {
    const p = tradePoint(point);
    tradeParts.under = p;
    pinPoint(tradeParts.chart, point);
    const wrong = p && p.wrong_fraction > 0 ? `, wrong on a share of ${rounded(p.wrong_fraction)} of the rays` : "";
    tradeParts.words.textContent = p ?
        `${p.form} in ${p.format}, ${p.registers}: ${rounded(p.time_ns)} ns per ray, keeps ${
            rounded(p.kept_bits)} bits${wrong}${mapOf(p) ? "; click, or press Enter, for its map" : ""}` :
        "\u00a0";
}

/** Goes to the next point by time, for the keyboard. */
function walkPoints(by) {
    const points = [...tradeParts.chart.points].sort((a, b) => a.x - b.x), last = points.length - 1;
    const at = points.findIndex((point) => tradePoint(point) === tradeParts.under);
    sayPoint(points[at >= 0 ? within(at + by, 0, last) : by > 0 ? 0 : last]);
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
    const figure = tradeParts.charts.get(trade.shape).find((f) => f.dataset.chart === set.name);
    tradeParts.element.replaceChildren(figure);
    tradeParts.chart = chartOf(figure);
    tradeParts.points = set.points;
    sayPoint(null);
}

function buildTrade() {
    const root = document.getElementById("trade-view");
    Object.assign(tradeParts, {
        charts: new Map(index.trades.map((t) => [t.shape, chartsOf(`trade-${t.shape}`)])),
        pickers: make("div.pickers"),
        element: make("div.plot#trade-plot", {
            tabIndex: 0,
            role: "group",
            "aria-label": "time against kept bits; arrow keys move from point to point, Enter shows the map"
        }),
        words: make("p.hint", { "aria-live": "polite" }, " ")
    });
    const { element, words, pickers } = tradeParts;
    root.append(pickers, element, words);
    root.hidden = false;
    element.addEventListener("pointermove", (event) => sayPoint(pointUnder(tradeParts.chart, event)));
    element.addEventListener("click", () => tradeParts.chart.dragged || showMapOf(tradeParts.under));
    onKeys(element, {
        ArrowRight: () => walkPoints(1),
        ArrowLeft: () => walkPoints(-1),
        Enter: () => showMapOf(tradeParts.under),
        ...zoomKeys(() => tradeParts.chart)
    });
    listeners.push(drawTrade);
}
