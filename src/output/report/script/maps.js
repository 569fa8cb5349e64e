// The map of one form: pickers, the picture with a second form in its right half, and the inspector.

const mapParts = {};

/** The visible part of the map: left, top, width and height in pixels of the map. */
function viewOf(map) {
    const w = map.width / state.zoom, h = map.height / state.zoom;
    return { left: state.cx * map.width - w / 2, top: state.cy * map.height - h / 2, w, h };
}

function drawView(canvas, map, field) {
    const { left, top, w, h } = viewOf(map), context = canvas.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.drawImage(field, left, top, w, h, 0, 0, canvas.width, canvas.height);
}

/** Position of an event in a canvas, from 0 to 1 in each direction. */
function shareOf(canvas, { clientX, clientY }) {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return [(clientX - left) / width, (clientY - top) / height];
}

function pixelUnder(canvas, map, event) {
    const { left, top, w, h } = viewOf(map), [u, v] = shareOf(canvas, event);
    return {
        x: within(Math.floor(left + u * w), 0, map.width - 1),
        y: within(Math.floor(top + v * h), 0, map.height - 1)
    };
}

/** Zooms about the point under the pointer. */
function zoomBy(canvas, event, factor) {
    const [u, v] = shareOf(canvas, event).map((x) => x - 0.5), zoom = within(state.zoom * factor, 1, 64);
    goTo({ zoom, cx: state.cx + u / state.zoom - u / zoom, cy: state.cy + v / state.zoom - v / zoom });
}

/** Draws a ring around a pixel or cell: a light line outside a dark one. */
function ringAround(context, x, y, w, h) {
    for (const [colour, grow] of [["#fff", 2.5], ["#202024", 1.5]]) {
        context.strokeStyle = colour;
        context.strokeRect(x - grow, y - grow, w + 2 * grow, h + 2 * grow);
    }
}

async function drawMap() {
    const map = mapNow(), metric = metricNow(), other = otherRow(), { canvas } = mapParts;
    // The picture has the full width. If the numbers stand beside it, it leaves them space and stays within the height
    // of the window. The canvas has a whole number of pixels per ray and is shown a little smaller.
    const viewWidth = document.getElementById("map-view").clientWidth,
          fittingWidth = (0.86 * innerHeight * map.width) / map.height,
          pictureWidth =
              Math.min(1024, viewWidth >= 960 ? Math.min(viewWidth - 484, Math.max(480, fittingWidth)) : viewWidth);
    const factor = Math.max(1, Math.ceil(pictureWidth / map.width));
    canvas.width = map.width * factor;
    canvas.height = map.height * factor;
    canvas.style.width = mapParts.picture.style.width = `${pictureWidth}px`;  // the slider is as long as the picture
    nameHalves();
    const fields = await Promise.all(
        [rowNow(), ...(other ? [other] : [])].map(async (row) => paint(map, await pixelsOf(map, row), metric)));
    if (map !== mapNow() || metric !== metricNow()) return;  // a newer picture is on its way
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
    if (state.x >= 0) {
        const { left, top, w, h } = viewOf(map), sx = canvas.width / w, sy = canvas.height / h;
        ringAround(canvas.getContext("2d"), (state.x - left) * sx, (state.y - top) * sy, sx, sy);
    }
    canvas.setAttribute(
        "aria-label",
        `${map.title}: ${words(metric.name)} of ${title(rowNow())}${
            other ? ` (A, left) compared with ${title(other)} (B, right)` : ""}; arrow keys move from pixel to pixel`);
}

function drawPickers() {
    const map = mapNow(), row = rowNow(), others = map.rows.filter((r) => r !== row);
    const picker = (label, id, key, options) =>
        choice(label, id, options, state[key], (value) => goTo({ [key]: value }));
    const names = (all) => [...new Set(all)].map((n) => [n, n]);
    showPickers(
        mapParts.pickers,
        choice(
            "scene", "pick-scene", titled(index.maps), state.scene,
            (scene) => goTo({ scene, x: -1, y: -1, zoom: 1, cx: 0.5, cy: 0.5, other: null })),
        picker(`${letterA()}form`, "pick-form", "form", names(map.rows.map((r) => r.form))),
        picker(
            "format", "pick-format", "format",
            names(map.rows.filter((r) => r.form === state.form).map((r) => r.format))),
        picker("metric", "pick-metric", "metric", metricsOfForm(map).map((m) => [m.name, words(m.name)])),
        picker(
            otherRow() ? "B: compare with" : "compare with", "pick-other", "other",
            [["", "nothing"], ...others.map((r) => [keyOf(r), title(r)])]));
    mapParts.slider.hidden = state.other === "";
    mapParts.slider.value = state.split;
    mapParts.copyClaim.disabled = !map.own_size;
    mapParts.noClaim.hidden = map.own_size;
    mapParts.what.textContent = `${row.title}. ${metricNow().meaning}.`;
    mapParts.worst.replaceChildren(...worstOf(row));
    mapParts.showNote(map.note);
}

/** The worst pixel, and the command that explains it; nothing if no pixel is worse than another. */
function worstOf({ worst, worst_explain }) {
    if (!worst) return [];
    return [
        `Worst pixel ${worst.x}, ${worst.y}${worst_explain ? ": " : ""}`,
        ...(worst_explain ? [make("code", worst_explain)] : [])
    ];
}

async function drawInspector(at) {
    const map = mapNow(), row = rowNow(), { inspector, operations } = mapParts, { x, y } = at ?? state;
    if (x < 0) {
        inspector.replaceChildren(
            make("p", "Point at the picture to see a ray's numbers. Click, or use the arrow keys, to keep them."),
            ...summaryOf(map, row),
            hint(
                "Wheel, + and − zoom; drag moves; 0 shows all; m and M change the metric; [ and ] change the " +
                "form; w goes to the worst pixel; n and N go to the rays whose operations this page holds; x swaps " +
                "A and B."));
        delete inspector.dataset.pixel;
    }
    await Promise.all([
        x < 0 ? null : showPixel(inspector, map, row, x, y, at === undefined),
        showOperations(operations, map, row, x, y)
    ]);
}

/** Shows the pixel under the pointer in one line. If no pixel is chosen, the inspector shows it too. */
async function hover({ x, y }) {
    const map = mapNow(), metric = metricNow(), pixels = await pixelsOf(map, rowNow()), i = y * map.width + x;
    const value = metric.kind === "classes" ? NaN : valueAt(pixels, metric, i);
    const text = Number.isNaN(value) ?
        "" :
        `, ${words(metric.name)} ${metric.categories ? categoryName(metric, value) : rounded(value)}`;
    mapParts.under.textContent = `${x}, ${y}: ${words(outcomeNames[pixels.outcome[i]])}${text}`;
    if (state.x < 0) await drawInspector({ x, y });
}

/** Chooses the pixel of a ray, and centres it if the view is zoomed in. */
const goToPixel = ({ x, y }) => goTo({ x, y, ...(state.zoom > 1 ? centredAt(mapNow(), x, y) : {}) });
const goToWorst = () => rowNow().worst && goToPixel(rowNow().worst);

const cycleMetric = (by) => cycle("metric", metricsOfForm(mapNow()).map((m) => m.name), by);
const cycleForm = (by) => cycle("form", [...new Set(mapNow().rows.map((r) => r.form))], by);

const mapKeys = {
    w: goToWorst,
    n: () => cycleRay(1),
    N: () => cycleRay(-1),
    ArrowLeft: () => step(-1, 0),
    ArrowRight: () => step(1, 0),
    ArrowUp: () => step(0, -1),
    ArrowDown: () => step(0, 1),
    "+": () => goTo(centred(state.zoom * 2)),
    "=": () => goTo(centred(state.zoom * 2)),
    "-": () => goTo(centred(state.zoom / 2)),
    0: () => goTo({ zoom: 1 }),
    m: () => cycleMetric(1),
    M: () => cycleMetric(-1),
    "]": () => cycleForm(1),
    "[": () => cycleForm(-1),
    x: () => otherRow() && goTo({ form: otherRow().form, format: otherRow().format, other: keyOf(rowNow()) }),
    Escape: () => goTo({ x: -1, y: -1 })
};

function cycle(key, names, by) {
    return goTo({ [key]: names[(names.indexOf(state[key]) + by + names.length) % names.length] });
}

const centredAt = (map, x, y) => ({ cx: (x + 0.5) / map.width, cy: (y + 0.5) / map.height });
/** Zooms about the chosen pixel, or about the centre of the view if none is chosen. */
const centred = (zoom) => ({ zoom, ...(state.x < 0 ? {} : centredAt(mapNow(), state.x, state.y)) });

function step(dx, dy) {
    const map = mapNow();
    if (state.x < 0) return goTo({ x: map.width >> 1, y: map.height >> 1 });
    const x = within(state.x + dx, 0, map.width - 1), y = within(state.y + dy, 0, map.height - 1);
    const { left, top, w, h } = viewOf(map), seen = x >= left && x < left + w && y >= top && y < top + h;
    return goTo({ x, y, ...(seen ? {} : centredAt(map, x, y)) });
}

/** Handles wheel, drag and click on a picture of the current map. */
function handlePointer(canvas, onclick) {
    let held = null;
    canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        zoomBy(canvas, event, event.deltaY < 0 ? 1.5 : 1 / 1.5);
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
    const root = document.getElementById("map-view"), copied = copiedBox(), [note, showNote] = noteBox("scene-note");
    const command = (which) =>
        commandsFor(mapNow(), rowNow(), Math.max(0, state.x), Math.max(0, state.y), metricNow())[which];
    const buttons = copyButtons(
        copied, ["copy-command", "copy the command", () => command("map")],
        ["copy-explain", "copy the command for this ray", () => command("explain")],
        ["copy-claim", "copy as claim", () => claimFor(mapNow(), rowNow(), metricNow(), state.x, state.y)],
        ["copy-link", "copy the link", () => location.href]);
    const parts = Object.assign(mapParts, {
        showNote,
        copied,
        copyClaim: buttons[2],
        noClaim: make(
            "p.hint.no-claim",
            "No claim can be copied here: claims are measured at the scene's own size, and this map has another " +
                "(--size)."),
        halfA: make("span.half.a", { hidden: true }),
        halfB: make("span.half.b", { hidden: true }),
        pickers: make("div.pickers"),
        what: make("p.what"),
        canvas: make("canvas#map", { tabIndex: 0, role: "img" }),
        slider: make(
            "input#split", { type: "range", min: 0, max: 1, step: "any", "aria-label": "position where B begins" }),
        under: make("p.hint#under", "\u00a0"),
        worst: make("p.hint#worst-line"),
        legend: make("div.legend"),
        inspector: make("div.inspector#inspector", { "aria-live": "polite" }),
        operations: make("div#operations")
    });
    const { canvas, slider } = parts;
    parts.picture = make(
        "div.picture", parts.legend, make("div.halves", canvas, parts.halfA, parts.halfB), slider, parts.under,
        parts.worst);
    root.append(
        parts.pickers, parts.what, note,
        make(
            "div.stage", parts.picture,
            make(
                "div.side", parts.inspector,
                make("div.buttons", button("#worst", goToWorst, "worst pixel"), ...buttons), parts.noClaim, copied)),
        parts.operations, make("div#panes"));
    root.hidden = false;

    handlePointer(canvas, (event) => {
        canvas.focus();
        goTo(pixelUnder(canvas, mapNow(), event));
    });
    canvas.addEventListener("pointermove", (event) => hover(pixelUnder(canvas, mapNow(), event)));
    canvas.addEventListener("pointerleave", () => {
        mapParts.under.textContent = "\u00a0";
        if (state.x < 0) drawInspector();
    });
    onKeys(canvas, mapKeys);
    slider.addEventListener("input", () => goTo({ split: Number(slider.value) }));
    listeners.push(async () => {
        drawPickers();
        await Promise.all([drawLegend(), drawMap(), drawInspector()]);
    });
}
