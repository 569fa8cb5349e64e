// Every form and format of the scene side by side: one range, one view, moved together.

const paneParts = {
    scene: "",
    cells: new Map()
};

function buildPane(map, row) {
    const factor = 144 / Math.max(map.width, map.height);
    const canvas = make("canvas", { width: Math.round(map.width * factor), height: Math.round(map.height * factor) });
    const lost = row.statistics.lost_bits?.[1], agreed = row.outcomes[agreeHit];
    const quantile = !isEnough(agreed, row.true_hits) ? `${tooFew(agreed, row.true_hits)}: no quantile` :
        lost === null || lost === undefined ? "no correct hit" :
                                              `p99 ${rounded(lost)} of ${row.precision} bits lost`;
    const wrong = index.outcomes.map(([name], o) => [name, row.outcomes[o]]).filter(([name, n], o) => o >= 2 && n > 0);
    const button = make(
        "button", {
            type: "button",
            className: "pane",
            title: `${row.title}; click to look at it, shift-click to compare with it`,
            data: { row: keyOf(row) }
        },
        make("span", { className: "thumbnail" }, canvas),
        make("span", { className: "name" }, make("b", {}, shortName(row)), ` ${row.format}`),
        ...wrong.map(([name, n]) => make("small", {}, `${n} ${words(name)}`)), make("small", {}, quantile));
    steer(canvas, () => {});
    button.addEventListener(
        "click", (event) => goTo(event.shiftKey ? { other: keyOf(row) } : { form: row.form, format: row.format }));
    return { row, canvas, button };
}

async function drawPanes() {
    const map = mapNow(), metric = metricNow();
    if (paneParts.scene !== map.id) {
        paneParts.scene = map.id;
        paneParts.cells = new Map(map.rows.map((row) => [keyOf(row), buildPane(map, row)]));
        document.getElementById("panes").replaceChildren(...[...paneParts.cells.values()].map((c) => c.button));
    }
    for (const { row, canvas, button } of paneParts.cells.values()) {
        if (metric.marches && !row.form.startsWith("sdf.")) continue;
        const field = paint(map, await pixelsOf(map, row), metric);
        if (map !== mapNow() || metric !== metricNow()) return;
        drawView(canvas, map, field);
        button.classList.toggle("chosen", row === rowNow());
        button.classList.toggle("other", row === otherRow());
        button.dataset.half = !otherRow() ? "" : row === rowNow() ? "A" : row === otherRow() ? "B" : "";
    }
}

function buildPanes() {
    let waiting = false;
    // After the large picture, and once for many moves.
    listeners.push(() => {
        if (waiting) return;
        waiting = true;
        setTimeout(() => {
            waiting = false;
            drawPanes();
        }, 0);
    });
}
