// What is looked at; all of it stands in location.hash, so that a link restores the view.

const classes = {
    name: "outcome",
    kind: "classes",
    unit: "",
    meaning: "whether form and truth agree about the ray"
};
const metricsOf = (map) => [...map.metrics, classes];

const state = {
    scene: "",
    form: "",
    format: "",
    metric: "",
    other: "",
    split: 0.5,
    x: -1,
    y: -1,
    zoom: 1,
    cx: 0.5,
    cy: 0.5,
    sweep: "",
    statistic: "",
    line: "",
    judged: "",
    u: -1,
    v: -1,
    shape: "",
    set: ""
};
const listeners = [];
const notes = [];

const mapNow = () => index.maps.find((m) => m.id === state.scene);
const rowNow = () => mapNow().rows.find((r) => r.form === state.form && r.format === state.format);
const otherRow = () => mapNow().rows.find((r) => keyOf(r) === state.other);
const metricNow = () => metricsOf(mapNow()).find((m) => m.name === state.metric);

const sweepHas = (key) => index.sweeps.find((s) => s.id === state.sweep)?.rows.includes(key) === true;

/** Puts what does not exist right; `asked` says in words what a link asked for in vain. */
function settle(asked = {}) {
    const choose = (key, names) => {
        if (names.includes(state[key])) return;
        if (asked[key]) notes.push(`${key} "${asked[key]}" is not on this page`);
        state[key] = names[0] ?? "";
    };
    if (index.sweeps.length > 0) {
        choose("sweep", index.sweeps.map((s) => s.id));
        const cases = index.sweeps.find((s) => s.id === state.sweep).kind === "cases";
        choose("statistic", ["", ...(cases ? ["verdict"] : []), ...index.statistics]);
    }
    if (index.maps.length > 0) {
        choose("scene", index.maps.map((m) => m.id));
        const map = mapNow();
        // A link to a sweep names a row of it, which the map need not have.
        const alongSweep = asked.sweep && !asked.scene && sweepHas(state.line);
        if (alongSweep) asked = {...asked, form: "", format: "" };
        choose("form", map.rows.map((r) => r.form));
        choose("format", map.rows.filter((r) => r.form === state.form).map((r) => r.format));
        const able = metricsOf(map).filter((m) => !m.marches || state.form.startsWith("sdf."));
        choose("metric", able.map((m) => m.name));
        if (state.other !== "") choose("other", ["", ...map.rows.map(keyOf)]);
        if (!(state.x >= 0 && state.x < map.width && state.y >= 0 && state.y < map.height)) state.x = state.y = -1;
    }
    const limited = (x, low, high, otherwise) => (Number.isFinite(x) ? Math.min(high, Math.max(low, x)) : otherwise);
    state.zoom = limited(state.zoom, 1, 64, 1);
    const margin = 0.5 / state.zoom;
    state.cx = limited(state.cx, margin, 1 - margin, 0.5);
    state.cy = limited(state.cy, margin, 1 - margin, 0.5);
    state.split = limited(state.split, 0, 1, 0.5);
    if (state.line !== "" && !sweepHas(state.line)) state.line = "";
    for (const key of ["u", "v"]) state[key] = state[key] >= 0 ? Math.trunc(state[key]) : -1;
    if (index.trades.length > 0) {
        choose("shape", index.trades.map((t) => t.shape));
        choose("set", index.trades.find((t) => t.shape === state.shape).sets.map((s) => s.name));
    }
}

const short = (x) => String(Number(x.toFixed(4)));

/** Only what differs from what the page would show by itself. */
function hashOf() {
    const parts = [];
    const add = (key, text) => parts.push(`${key}=${encodeURIComponent(text)}`);
    for (const key of ["scene", "form", "format", "metric", "other", "sweep", "statistic", "shape", "set"]) {
        if (state[key] !== "") add(key, state[key]);
    }
    if (state.x >= 0) parts.push(`x=${state.x}`, `y=${state.y}`);
    if (state.zoom > 1) parts.push(`zoom=${short(state.zoom)}`, `cx=${short(state.cx)}`, `cy=${short(state.cy)}`);
    if (state.line !== "" && state.line !== `${state.form}.${state.format}`) add("line", state.line);
    if (state.judged !== "") add("judged", state.judged);
    for (const key of ["u", "v"]) {
        if (state[key] >= 0) parts.push(`${key}=${state[key]}`);
    }
    if (state.other !== "") parts.push(`split=${short(state.split)}`);
    return "#" + parts.join("&");
}

/** Takes what a hash says; false where it is a plain anchor. */
function readHash(hash) {
    const text = hash.replace(/^#/, "");
    if (!text.includes("=")) return false;
    const asked = Object.fromEntries(new URLSearchParams(text));
    notes.length = 0;
    for (const [key, value] of Object.entries(asked)) {
        if (!(key in state)) notes.push(`"${key}" is not known in a link`);
        else state[key] = typeof state[key] === "number" ? (value === "" ? NaN : Number(value)) : value;
    }
    if (!("zoom" in asked)) Object.assign(state, { zoom: 1, cx: 0.5, cy: 0.5 });
    if (asked.scene && !("x" in asked)) state.x = state.y = -1;
    if (asked.scene && !("other" in asked)) state.other = "";
    for (const [key, none] of [["line", ""], ["judged", ""], ["u", -1], ["v", -1]]) {
        if (!(key in asked)) state[key] = none;
    }
    if (asked.sweep && !asked.scene && asked.form) state.line = `${asked.form}.${asked.format ?? state.format}`;
    state.x = Math.trunc(state.x);
    state.y = Math.trunc(state.y);
    settle(asked);
    return true;
}

/** Changes what is looked at and shows it. */
function goTo(changes) {
    if (("form" in changes || "format" in changes) && !("line" in changes))
        state.line = "";  // what the map shows is shown along the sweep
    Object.assign(state, changes);
    settle();
    history.replaceState(null, "", hashOf());
    return Promise.all(listeners.map((show) => show(Object.keys(changes))));
}

// Small helpers for the parts below.

function make(tag, properties = {}, ...children) {
    const element = document.createElement(tag);
    for (const [key, value] of Object.entries(properties)) {
        if (key === "data") Object.assign(element.dataset, value);
        else if (key.includes("-")) element.setAttribute(key, value);
        else element[key] = value;
    }
    element.append(...children);
    return element;
}

function choice(label, id, options, value, onchange) {
    const select = make("select", { id });
    for (const [key, text] of options)
        select.append(make("option", { value: key, textContent: text, selected: key === value }));
    select.addEventListener("change", () => onchange(select.value));
    return make("label", {}, label + " ", select);
}

/** For a picker; two of one title are told apart by their files. */
const titled = (parts) => parts.map(
    ({ id, title }) => [id, parts.some((p) => p.id !== id && p.title === title) ? `${title} (${id})` : title]);

const words = (name) =>
    name.replace(/^agree_/, "correct_").replace(/^wrong_object/, "wrong_solid").replaceAll("_", " ");

/** Puts a text on the clipboard and shows it: it can be read and selected where a browser lends no clipboard. */
function copyText(text, output) {
    output.hidden = false;
    output.textContent = text;
    navigator.clipboard?.writeText(text).catch(() => {});
}
