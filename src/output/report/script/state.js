// The state of the page: the view that the reader has chosen. All of it is stored in location.hash, so that a link
// restores the view.

const classes = {
    name: "outcome",
    kind: "classes",
    unit: "",
    meaning: "agreement of form and truth on the ray"
};
const metricsOf = (map) => [...map.metrics, classes];

const initial = {
    // other: null stands for `companion`, and "" for nothing to compare with.
    ...{
        scene: "",
        form: "",
        format: "",
        metric: "",
        other: null,
        split: 0.5,
        x: -1,
        y: -1,
        zoom: 1,
        cx: 0.5,
        cy: 0.5
    },
    ...{ sweep: "", statistic: "", line: "", judged: "", u: -1, v: -1, shape: "", set: "" }
};
const state = {...initial };
const listeners = [];
let drawing = Promise.resolve();  // the drawing in progress
const notes = [];

const mapNow = () => index.maps.find((m) => m.id === state.scene);
const rowNow = () => mapNow().rows.find((r) => r.form === state.form && r.format === state.format);
const otherRow = () => mapNow().rows.find((r) => keyOf(r) === state.other);

/** Rank of a row: fewest wrong decisions first, then the least p99 of lost bits. */
const rankOf = (row) =>
    [total([...wrongDecisions, outcomeNames.indexOf("not_a_number")].map((o) => row.outcomes[o])),
     asNumber(row.statistics.lost_bits?.[1] ?? "inf")];

/** Key of the row that stands beside the chosen one at first: the best in its format, or the worst beside the best. */
function companion() {
    const row = rowNow(), rows = mapNow().rows.filter((r) => r.format === row.format);
    const compare = (a, b) => {
        const [[wrong, lost], [otherWrong, otherLost]] = [rankOf(a), rankOf(b)];
        return wrong - otherWrong || (lost === otherLost ? 0 : lost < otherLost ? -1 : 1);
    };
    const order = [...rows].sort(compare), other = order[0] === row ? order.at(-1) : order[0];
    return other === row ? "" : keyOf(other);
}
const metricNow = () => metricsOf(mapNow()).find((m) => m.name === state.metric);
/** Metrics of a march exist only for forms that march. */
const marches = (form) => form.startsWith("sdf.");
const metricsOfForm = (map) => metricsOf(map).filter((m) => !m.marches || marches(state.form));

const sweepHas = (key) => index.sweeps.find((s) => s.id === state.sweep)?.rows.includes(key) === true;

/** Replaces choices that this page does not have by choices that it has. `asked` holds the choices of a link. */
function settle(asked = {}) {
    const choose = (key, names) => {
        if (names.includes(state[key])) return;
        if (asked[key]) notes.push(`${key} "${asked[key]}" is not on this page`);
        state[key] = names[0] ?? "";
    };
    if (index.sweeps.length > 0) {
        choose("sweep", index.sweeps.map((s) => s.id));
        const charted = index.sweeps.filter((s) => s.kind === "line")
                            .flatMap((s) => s.charts.map((name) => name.slice(0, name.indexOf("."))));
        const cases = index.sweeps.find((s) => s.id === state.sweep).kind === "cases";
        choose("statistic", ["", ...(cases ? ["verdict"] : []), ...index.statistics, ...charted]);
    }
    if (index.maps.length > 0) {
        choose("scene", index.maps.map((m) => m.id));
        const map = mapNow();
        // A link to a sweep names one of its rows, which the map need not have.
        const alongSweep = asked.sweep && !asked.scene && sweepHas(state.line);
        if (alongSweep) asked = {...asked, form: "", format: "" };
        choose("form", map.rows.map((r) => r.form));
        choose("format", map.rows.filter((r) => r.form === state.form).map((r) => r.format));
        choose("metric", metricsOfForm(map).map((m) => m.name));
        if (state.other) choose("other", ["", ...map.rows.map(keyOf)]);
        if (state.other === null || state.other === keyOf(rowNow())) state.other = companion();
        if (!(state.x >= 0 && state.x < map.width && state.y >= 0 && state.y < map.height)) state.x = state.y = -1;
    }
    const limit = (key, low, high) =>
        (state[key] = Number.isFinite(state[key]) ? within(state[key], low, high) : initial[key]);
    limit("zoom", 1, 64);
    for (const key of ["cx", "cy"]) limit(key, 0.5 / state.zoom, 1 - 0.5 / state.zoom);
    limit("split", 0, 1);
    if (state.line !== "" && !sweepHas(state.line)) state.line = "";
    for (const key of ["u", "v"]) state[key] = state[key] >= 0 ? Math.trunc(state[key]) : -1;
    if (index.trades.length > 0) {
        choose("shape", index.trades.map((t) => t.shape));
        choose("set", index.trades.find((t) => t.shape === state.shape).sets.map((s) => s.name));
    }
}

/** The parts of the state that differ from what the page shows by default. */
function hashOf() {
    const usual = (key) => (key === "other" && index.maps.length > 0 ? companion() : initial[key]);
    const isListed = (key, value) => (key !== "split" || state.other !== "") && value !== usual(key) &&
        !(key === "line" && value === `${state.form}.${state.format}`);
    const text = (value) => (typeof value === "number" ? Number(value.toFixed(4)) : encodeURIComponent(value));
    const listed = Object.entries(state).filter(([key, value]) => isListed(key, value));
    return "#" + listed.map(([key, value]) => `${key}=${text(value)}`).join("&");
}

/** Reads the state from a hash; returns false for a plain anchor. */
function readHash(hash) {
    const text = hash.replace(/^#/, "");
    if (!text.includes("=")) return false;
    const asked = Object.fromEntries(new URLSearchParams(text));
    notes.length = 0;
    for (const [key, value] of Object.entries(asked)) {
        if (!(key in state)) notes.push(`"${key}" is not a key that links can have`);
        else state[key] = typeof state[key] === "number" ? (value === "" ? NaN : Number(value)) : value;
    }
    const resetKeys = ["line", "judged", "u", "v", ...(asked.zoom ? [] : ["zoom", "cx", "cy"])];
    if (asked.scene) resetKeys.push("other", ...("x" in asked ? [] : ["x", "y"]));
    for (const key of resetKeys)
        if (!(key in asked) || key === "y") state[key] = initial[key];
    if (asked.sweep && !asked.scene && asked.form) state.line = `${asked.form}.${asked.format ?? state.format}`;
    state.x = Math.trunc(state.x);
    state.y = Math.trunc(state.y);
    settle(asked);
    return true;
}

/** Changes the state and shows it. */
function goTo(changes) {
    if (("form" in changes || "format" in changes) && !("line" in changes))
        state.line = "";  // the sweep shows the form of the map again
    Object.assign(state, changes);
    settle();
    history.replaceState(null, "", hashOf());
    return drawAll();
}

const drawAll = () => (drawing = Promise.all(listeners.map((show) => show())));

// Small helpers for the parts below.

/** Creates an element from `tag.class#id`. Its properties, if any, come before its children. */
function make(what, ...children) {
    const [, tag, classes, , id] = what.match(/^(\w+)((?:\.[\w-]+)*)(#(.+))?$/), element = document.createElement(tag);
    element.className = classes.slice(1).replaceAll(".", " ");
    if (id) element.id = id;
    const properties = children[0]?.constructor === Object ? children.shift() : {};
    for (const [key, value] of Object.entries(properties)) {
        if (key === "data") Object.assign(element.dataset, value);
        else if (key.includes("-")) element.setAttribute(key, value);
        else element[key] = value;
    }
    element.append(...children);
    return element;
}

const button = (what, onclick, ...children) => make(`button${what}`, { type: "button", onclick }, ...children);
const hint = (...children) => make("p.hint", ...children);

function choice(label, id, options, value, onchange) {
    const select = make(`select#${id}`, { onchange: () => onchange(select.value) });
    for (const [key, text] of options)
        select.append(make("option", { value: key, textContent: text, selected: key === value }));
    return make("label", label + " ", select);
}

/** Replaces the pickers in an element. The picker that was just used keeps the focus. */
function showPickers(element, ...pickers) {
    const focusedId = document.activeElement?.id;
    element.replaceChildren(...pickers);
    if (focusedId) element.querySelector(`#${focusedId}`)?.focus();
}

/**
 * Names for a picker: the title, or the file's name if the title is empty. Equal titles are followed by their file
 * names.
 */
const titled = (parts) => parts.map(
    ({
        id,
        title
    }) => [id, parts.some((p) => p.id !== id && title && p.title === title) ? `${title} (${id})` : title || id]);

const words = (name) => name.replace(/^agree_/, "correct_").replaceAll("_", " ");
const total = (counts) => counts.reduce((sum, n) => sum + n, 0);
const within = (x, low, high) => Math.min(high, Math.max(low, x));

/** Binds keys on an element. Keys with Ctrl, Alt or Meta are left to the browser. */
function onKeys(element, keys) {
    element.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
        event.preventDefault();
        keys[event.key]();
    });
}

/** Copies a text to the clipboard and shows it, so that it can be selected where a browser offers no clipboard. */
function copyText(text, output) {
    output.hidden = false;
    output.textContent = text;
    navigator.clipboard?.writeText(text).catch(() => {});
}

const copiedBox = () => make("pre.copied", { hidden: true });
/** Makes buttons that copy a text. Each entry is an id, a caption, and a function that returns the text. */
const copyButtons = (output, ...all) =>
    all.map(([id, words, text]) => button(`#${id}`, async () => copyText(await text(), output), words));
