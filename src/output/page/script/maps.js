// The map of one form: pickers, the picture with its compared half, and the inspector.

const mapParts = {};

/** Part of the field that is looked at: left, top, width and height in pixels. */
function viewOf(map) {
    const w = map.width / state.zoom, h = map.height / state.zoom;
    return { left: state.cx * map.width - w / 2, top: state.cy * map.height - h / 2, w, h };
}

function drawView(canvas, map, field) {
    const { left, top, w, h } = viewOf(map), context = canvas.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.drawImage(field, left, top, w, h, 0, 0, canvas.width, canvas.height);
}

function pixelUnder(canvas, map, event) {
    const box = canvas.getBoundingClientRect(), { left, top, w, h } = viewOf(map);
    const inside = (x, n) => Math.min(n - 1, Math.max(0, Math.floor(x)));
    return {
        x: inside(left + ((event.clientX - box.left) / box.width) * w, map.width),
        y: inside(top + ((event.clientY - box.top) / box.height) * h, map.height)
    };
}

/** Zooms about the point under the pointer. */
function zoomBy(canvas, map, event, factor) {
    const box = canvas.getBoundingClientRect();
    const u = (event.clientX - box.left) / box.width - 0.5, v = (event.clientY - box.top) / box.height - 0.5;
    const zoom = Math.min(64, Math.max(1, state.zoom * factor));
    goTo({ zoom, cx: state.cx + u / state.zoom - u / zoom, cy: state.cy + v / state.zoom - v / zoom });
}

function crosshair(canvas, map) {
    if (state.x < 0) return;
    const { left, top, w, h } = viewOf(map), context = canvas.getContext("2d");
    const sx = canvas.width / w, sy = canvas.height / h;
    const x = (state.x - left) * sx, y = (state.y - top) * sy;
    for (const [colour, grow] of [["#fff", 2.5], ["#202024", 1.5]]) {
        context.strokeStyle = colour;
        context.strokeRect(x - grow, y - grow, sx + 2 * grow, sy + 2 * grow);
    }
}

async function drawMap() {
    const map = mapNow(), metric = metricNow(), other = otherRow(), { canvas } = mapParts;
    // All the width; where the numbers stand beside it, less what they need, and no higher than the window. In whole
    // pixels a ray, shown a little smaller.
    const wide = document.getElementById("map-view").clientWidth, tall = (0.86 * innerHeight * map.width) / map.height,
          room = Math.min(1024, wide >= 960 ? Math.min(wide - 484, Math.max(480, tall)) : wide);
    const factor = Math.max(1, Math.ceil(room / map.width));
    canvas.width = map.width * factor;
    canvas.height = map.height * factor;
    canvas.style.width = mapParts.picture.style.width = `${room}px`;  // and the slider is as long as the picture
    nameHalves();
    const fields = await Promise.all(
        [rowNow(), ...(other ? [other] : [])].map(async (row) => paint(map, await pixelsOf(map, row), metric)));
    if (map !== mapNow() || metric !== metricNow()) return;  // something newer is on its way
    drawView(canvas, map, fields[0]);
    if (other) {
        const context = canvas.getContext("2d"), at = Math.round(state.split * canvas.width);
        context.save();
        context.beginPath();
        context.rect(at, 0, canvas.width - at, canvas.height);
        context.clip();
        drawView(canvas, map, fields[1]);
        context.restore();
        context.fillStyle = "#202024";
        context.fillRect(at - 1, 0, 2, canvas.height);
    }
    crosshair(canvas, map);
    canvas.setAttribute(
        "aria-label",
        `${map.title}: ${words(metric.name)} of ${title(rowNow())}${
            other ? ` (A, left) against ${title(other)} (B, right)` : ""}; arrow keys move from pixel to pixel`);
}

function drawPickers() {
    const map = mapNow(), row = rowNow(), other = otherRow();
    const options = (names) => [...new Set(names)].map((n) => [n, n]);
    const able = metricsOf(map).filter((m) => !m.marches || state.form.startsWith("sdf."));
    const pickers = [
        choice(
            "scene", "pick-scene", titled(index.maps), state.scene,
            (scene) => goTo({ scene, x: -1, y: -1, zoom: 1, cx: 0.5, cy: 0.5, other: "" })),
        choice(
            `${letterA()}form`, "pick-form", options(map.rows.map((r) => r.form)), state.form,
            (form) => goTo({ form })),
        choice(
            "format", "pick-format", options(map.rows.filter((r) => r.form === state.form).map((r) => r.format)),
            state.format, (format) => goTo({ format })),
        choice(
            "metric", "pick-metric", able.map((m) => [m.name, words(m.name)]), state.metric,
            (metric) => goTo({ metric })),
        choice(
            other ? "B: against" : "against", "pick-other",
            [["", "nothing"], ...map.rows.filter((r) => r !== row).map((r) => [keyOf(r), title(r)])], state.other,
            (other) => goTo({ other })),
    ];
    const held = document.activeElement?.id;
    mapParts.pickers.replaceChildren(...pickers);
    if (held?.startsWith("pick-"))
        document.getElementById(held)?.focus();  // a picker that was just used keeps the keyboard
    mapParts.slider.hidden = state.other === "";
    mapParts.slider.value = state.split;
    mapParts.copyClaim.disabled = !map.own_size;  // a claim is of the scene at its own size
    mapParts.what.textContent = `${row.title}. ${metricNow().meaning}.`;
    mapParts.worst.replaceChildren(...worstOf(row));
    mapParts.showNote(map.note);
}

/** The worst pixel, and the command that explains it; nothing where none is worse than another. */
function worstOf({ worst, worst_explain }) {
    if (!worst) return [];
    return [
        `Worst pixel ${worst.x}, ${worst.y}${worst_explain ? ": " : ""}`,
        ...(worst_explain ? [make("code", {}, worst_explain)] : [])
    ];
}

async function drawInspector(at) {
    const map = mapNow(), pinned = at === undefined, { x, y } = at ?? state;
    if (x < 0) {
        mapParts.inspector.replaceChildren(
            make(
                "p", {},
                "Point at the picture to see a ray's numbers; click, or move with the arrow keys, to keep them."),
            ...summaryOf(map, rowNow()),
            make(
                "p", { className: "hint" },
                "Wheel, + and − zoom; drag moves; 0 shows all; m and M change the metric, " +
                    "[ and ] the form; w goes to the worst pixel, n and N to the rays whose operations are held; " +
                    "x swaps A and B."));
        delete mapParts.inspector.dataset.pixel;
        await showOperations(mapParts.operations, map, rowNow(), x, y);
        return;
    }
    await Promise.all([
        showPixel(mapParts.inspector, map, rowNow(), x, y, pinned),
        showOperations(mapParts.operations, map, rowNow(), x, y)
    ]);
}

/** The pixel under the pointer in a line, and, while none is chosen, in the inspector. */
async function hover({ x, y }) {
    const map = mapNow(), metric = metricNow(), pixels = await pixelsOf(map, rowNow()), i = y * map.width + x;
    const value = metric.kind === "classes" ? NaN : valueAt(pixels, metric, i);
    const text = Number.isNaN(value) ?
        "" :
        `, ${words(metric.name)} ${metric.categories ? categoryName(metric, value) : rounded(value)}`;
    mapParts.under.textContent = `${x}, ${y}: ${words(outcomeNames[pixels.outcome[i]])}${text}`;
    if (state.x < 0) await drawInspector({ x, y });
}

function toWorst() {
    const { worst } = rowNow();
    return worst && goTo({ x: worst.x, y: worst.y, ...(state.zoom > 1 ? centredAt(mapNow(), worst.x, worst.y) : {}) });
}

const mapKeys = {
    w: toWorst,
    n: () => turnRay(1),
    N: () => turnRay(-1),
    ArrowLeft: () => step(-1, 0),
    ArrowRight: () => step(1, 0),
    ArrowUp: () => step(0, -1),
    ArrowDown: () => step(0, 1),
    "+": () => goTo(centred(state.zoom * 2)),
    "=": () => goTo(centred(state.zoom * 2)),
    "-": () => goTo(centred(state.zoom / 2)),
    0: () => goTo({ zoom: 1 }),
    m: () => turn(
        "metric", metricsOf(mapNow()).filter((m) => !m.marches || state.form.startsWith("sdf.")).map((m) => m.name), 1),
    M: () => turn(
        "metric", metricsOf(mapNow()).filter((m) => !m.marches || state.form.startsWith("sdf.")).map((m) => m.name),
        -1),
    "]": () => turn("form", [...new Set(mapNow().rows.map((r) => r.form))], 1),
    "[": () => turn("form", [...new Set(mapNow().rows.map((r) => r.form))], -1),
    x: () => otherRow() && goTo({ form: otherRow().form, format: otherRow().format, other: keyOf(rowNow()) }),
};

function turn(key, names, by) {
    return goTo({ [key]: names[(names.indexOf(state[key]) + by + names.length) % names.length] });
}

/** Around the chosen pixel, or where the view is. */
function centred(zoom) {
    const map = mapNow();
    return state.x < 0 ? { zoom } : { zoom, cx: (state.x + 0.5) / map.width, cy: (state.y + 0.5) / map.height };
}

function step(dx, dy) {
    const map = mapNow();
    if (state.x < 0) return goTo({ x: map.width >> 1, y: map.height >> 1 });
    const x = Math.min(map.width - 1, Math.max(0, state.x + dx)),
          y = Math.min(map.height - 1, Math.max(0, state.y + dy));
    const { left, top, w, h } = viewOf(map);
    const seen = x >= left && x < left + w && y >= top && y < top + h;
    return goTo(seen ? { x, y } : { x, y, ...centredAt(map, x, y) });
}

const centredAt = (map, x, y) => ({ cx: (x + 0.5) / map.width, cy: (y + 0.5) / map.height });

/** Wheel, drag and click on a picture of the current map. */
function steer(canvas, onclick) {
    let held = null;
    canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        zoomBy(canvas, mapNow(), event, event.deltaY < 0 ? 1.5 : 1 / 1.5);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
        held = { x: event.clientX, y: event.clientY, cx: state.cx, cy: state.cy, moved: false };
        canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
        if (!held) return;
        const box = canvas.getBoundingClientRect(), dx = event.clientX - held.x, dy = event.clientY - held.y;
        held.moved ||= Math.hypot(dx, dy) > 3;
        if (held.moved && state.zoom > 1)
            goTo({ cx: held.cx - dx / box.width / state.zoom, cy: held.cy - dy / box.height / state.zoom });
    });
    canvas.addEventListener("pointerup", (event) => {
        if (held && !held.moved) onclick(event);
        held = null;
    });
}

function buildMaps() {
    const root = document.getElementById("map-view");
    const [note, showNote] = noteBox("scene-note");
    Object.assign(mapParts, {
        showNote,
        halfA: make("span", { className: "half a", hidden: true }),
        halfB: make("span", { className: "half b", hidden: true }),
        pickers: make("div", { className: "pickers" }),
        what: make("p", { className: "what" }),
        canvas: make("canvas", { id: "map", tabIndex: 0, role: "img" }),
        slider:
            make("input", { type: "range", min: 0, max: 1, step: "any", id: "split", "aria-label": "where B begins" }),
        under: make("p", { className: "hint", id: "under" }, "\u00a0"),
        worst: make("p", { className: "hint", id: "worst-line" }),
        legend: make("div", { className: "legend" }),
        inspector: make("div", { className: "inspector", id: "inspector", "aria-live": "polite" }),
        operations: make("div", { id: "operations" }),
        copied: make("pre", { className: "copied", hidden: true }),
    });
    const { canvas, slider, copied } = mapParts;
    const command = (which) =>
        commandsFor(mapNow(), rowNow(), Math.max(0, state.x), Math.max(0, state.y), metricNow())[which];
    const buttons = make(
        "div", { className: "buttons" },
        make("button", { type: "button", id: "worst", onclick: toWorst }, "worst pixel"),
        make(
            "button", { type: "button", id: "copy-command", onclick: () => copyText(command("map"), copied) },
            "copy the command"),
        make(
            "button", { type: "button", id: "copy-explain", onclick: () => copyText(command("explain"), copied) },
            "copy the command for this ray"),
        make(
            "button", {
                type: "button",
                id: "copy-claim",
                onclick: () => copyText(claimFor(mapNow(), rowNow(), metricNow()), copied)
            },
            "copy as claim"),
        make(
            "button", { type: "button", id: "copy-link", onclick: () => copyText(location.href, copied) },
            "copy the link"));
    mapParts.picture = make(
        "div", { className: "picture" }, make("div", { className: "halves" }, canvas, mapParts.halfA, mapParts.halfB),
        slider, mapParts.under, mapParts.worst, mapParts.legend);
    root.append(
        mapParts.pickers, mapParts.what, note,
        make(
            "div", { className: "stage" }, mapParts.picture,
            make("div", { className: "side" }, mapParts.inspector, buttons, copied)),
        mapParts.operations, make("div", { id: "panes" }));
    mapParts.copyClaim = buttons.querySelector("#copy-claim");
    root.hidden = false;

    steer(canvas, (event) => {
        canvas.focus();
        goTo(pixelUnder(canvas, mapNow(), event));
    });
    canvas.addEventListener("pointermove", (event) => hover(pixelUnder(canvas, mapNow(), event)));
    canvas.addEventListener("pointerleave", () => {
        mapParts.under.textContent = "\u00a0";
        if (state.x < 0) drawInspector();
    });
    canvas.addEventListener("keydown", (event) => {
        if (event.key === "Escape") goTo({ x: -1, y: -1 });
        else if (!event.ctrlKey && !event.metaKey && !event.altKey && mapKeys[event.key]) mapKeys[event.key]();
        else return;
        event.preventDefault();
    });
    slider.addEventListener("input", () => goTo({ split: Number(slider.value) }));
    listeners.push(async () => {
        drawPickers();
        await Promise.all([drawLegend(), drawMap(), drawInspector()]);
    });
}
