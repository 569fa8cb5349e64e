// Reads the packed data of the page into numbers. map_data.cpp defines the layouts.

const index = JSON.parse(document.getElementById("index").textContent);
const outcomeNames = index.outcomes.map(([name]) => name);
const agreeHit = 0;
const wrongDecisions = ["false_miss", "false_hit", "wrong_primitive", "crack", "double_hit", "out_of_order"].map(
    (name) => outcomeNames.indexOf(name));
const keyOf = (row) => `${row.form}.${row.format}`;
const shortName = (row) => row.form.slice(row.form.indexOf(".") + 1);

/** True if quantiles over this many agreed hits stand for the form; `tooFew` is the text if not. See agreement.hpp. */
const isEnough = (agreed, hits) => hits === 0 || (agreed > 0 && agreed >= index.least_agreement * hits);
const tooFew = (agreed, hits) =>
    `${agreed} of ${hits} hit${hits === 1 ? "" : "s"} ${agreed === 1 ? "agrees" : "agree"}`;

/** Returns `read()`, a result or a promise. Calls `read` only once for each name. */
const cachedResults = new Map();
function once(name, read) {
    if (!cachedResults.has(name)) cachedResults.set(name, read());
    return cachedResults.get(name);
}

async function bytesOf(name) {
    const element = document.getElementById(name), text = atob(element.textContent),
          packed = new Uint8Array(text.length);
    element.remove();  // the packed text is not needed again
    for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads a packed part as JSON. */
const jsonOf = (name) => once(name, async () => JSON.parse(new TextDecoder().decode(await bytesOf(name))));

/**
 * Reads numbers from planes: plane k holds byte k of all numbers, the lowest byte first. Browsers run on little-endian
 * machines, so the bytes are used in this order.
 */
class Planes {
    constructor(bytes, count) {
        this.bytes = bytes;
        this.count = count;
        this.position = 0;
    }
    read(Type) {
        const n = this.count, width = Type.BYTES_PER_ELEMENT, bytes = new Uint8Array(n * width);
        for (let k = 0; k < width; ++k, this.position += n) {
            for (let i = 0; i < n; ++i) bytes[i * width + k] = this.bytes[this.position + i];
        }
        return new Type(bytes.buffer);
    }
}

// Undo `folded_difference` (pack.hpp): for 32 bits, and for 64 bits as two 32-bit halves, the low one first.

const unfold = (d) => (d >>> 1) ^ -(d & 1);

function unfoldPair(words, at) {
    const sign = -(words[at] & 1);
    words[at] = ((words[at] >>> 1) | (words[at + 1] << 31)) ^ sign;
    words[at + 1] = (words[at + 1] >>> 1) ^ sign;
}

function addPair(words, at, low, high) {
    const sum = words[at] + (low >>> 0);
    words[at] = sum;
    words[at + 1] += high + (sum > 0xffffffff ? 1 : 0);
}

/**
 * Calls `undo(i, last, before)` for each true hit, row by row and from left to right. `last` and `before` are the
 * indices of the two true hits to the left, or `none`.
 */
function forEachHit(width, decision, none, undo) {
    for (let i = 0, last = none, before = none; i < decision.length; ++i) {
        if (i % width === 0) last = before = none;
        if (decision[i] !== 1) continue;
        undo(i, last, before);
        [before, last] = [last, i];
    }
}

/**
 * Undoes `HitPredictor` (pack.hpp) for doubles: the stored bits are the bits minus (2 last - before). The bits are 0
 * where nothing is hit.
 */
function undoPrediction(doubles, width, decision) {
    const n = doubles.length, words = new Uint32Array(2 * n + 2);  // one more for `none`, whose bits are 0
    words.set(new Uint32Array(doubles.buffer));
    forEachHit(width, decision, n, (i, last, before) => {
        unfoldPair(words, 2 * i);
        addPair(words, 2 * i, words[2 * last], words[2 * last + 1]);
        if (words[2 * before] === 0 && words[2 * before + 1] === 0) return;
        addPair(words, 2 * i, words[2 * last], words[2 * last + 1]);
        addPair(words, 2 * i, ~words[2 * before], ~words[2 * before + 1]);  // complement plus one: subtracts `before`
        addPair(words, 2 * i, 1, 0);
    });
    return new Float64Array(words.buffer, 0, n);
}

async function truthOf(map, group) {
    const planes = new Planes(await bytesOf(`truth:${map.id}:${group}`), map.width * map.height);
    const decision = planes.read(Uint8Array);
    return {
        decision,
        object: planes.read(Uint32Array),
        truth: undoPrediction(planes.read(Float64Array), map.width, decision),
        rest: planes.read(Float32Array),
        bound: planes.read(Int16Array),
        condition: planes.read(Float32Array),
    };
}

/** Undoes `HitPredictor` for floats: the stored bits are the bits minus (2 last - before). NaN where nothing is hit. */
function undoFloatPrediction(d, width, decision) {
    const values = new Float32Array(d.length + 1).fill(NaN), bits = new Uint32Array(values.buffer), none = d.length;
    bits[none] = 0;
    forEachHit(width, decision, none, (i, last, before) => {
        bits[i] = unfold(d[i]) + (bits[before] === 0 ? bits[last] : 2 * bits[last] - bits[before]);
    });
    return values.subarray(0, none);
}

/** Reads the answers. The stored bits are the bits minus those of the truth in the same format. */
function readAnswers(planes, { coding }, { truth }) {
    if (coding === "plain64") return planes.read(Float64Array);
    if (coding === "bits32") {
        const bits = new Uint32Array(Float32Array.from(truth).buffer);
        planes.read(Uint32Array).forEach((d, i) => (bits[i] += unfold(d)));
        return Float64Array.from(new Float32Array(bits.buffer));
    }
    const t = planes.read(Float64Array), words = new Uint32Array(t.buffer),
          truthWords = new Uint32Array(Float64Array.from(truth).buffer);
    for (let i = 0; i < words.length; i += 2) {
        unfoldPair(words, i);
        addPair(words, i, truthWords[i], truthWords[i + 1]);
    }
    return t;
}

/** The pixels of a row: outcome, object, t, the stored metrics, and the truth, which rows may share. */
const pixelsOf = (map, row) => once(`row:${map.id}:${keyOf(row)}`, () => readRow(map, row));

async function readRow(map, row) {
    const shared = once(`truth:${map.id}:${row.group}`, () => truthOf(map, row.group));
    const [bytes, truth] = await Promise.all([bytesOf(`row:${map.id}:${keyOf(row)}`), shared]);
    const planes = new Planes(bytes, map.width * map.height), stored = {};
    const pixels = {
        ...{ row, truth, stored, painted: new Map() },
        outcome: planes.read(Uint8Array),
        object: planes.read(Uint32Array),
        t: readAnswers(planes, row, truth)
    };
    for (const metric of map.metrics) {
        if (metric.kind === "stored") stored[metric.name] = planes.read(Float32Array);
        if (metric.kind === "hits")
            stored[metric.name] = undoFloatPrediction(planes.read(Uint32Array), map.width, truth.decision);
    }
    return pixels;
}

const sampleAt = (pixels, i) =>
    ({ t: pixels.t[i], truth: pixels.truth.truth[i], rest: pixels.truth.rest[i], row: pixels.row });

/** Value of a metric at pixel i; NaN where it is undefined. */
function valueAt(pixels, metric, i) {
    if (metric.kind === "stored") return pixels.stored[metric.name][i];
    if (pixels.outcome[i] !== agreeHit) return NaN;
    if (metric.kind === "hits") return pixels.stored[metric.name][i];
    return metric.kind === "shared" ? pixels.truth.condition[i] : derived[metric.name](sampleAt(pixels, i));
}

// Colours: the tables and the arithmetic of the PNGs.

const ramp = Array.from(
    { length: 256 }, (_, i) => [0, 2, 4].map((k) => parseInt(index.ramp.slice(6 * i + k, 6 * i + k + 2), 16)));

const spacings = {
    linear: (x) => x / 2,
    root: Math.sqrt,
    log2: Math.log2
};

function rampAt(scale, value) {
    if (value <= scale.lo) return ramp[0];
    if (value >= scale.hi) return ramp[255];
    const spaced = spacings[scale.spacing];
    const p = (spaced(value) - spaced(scale.lo)) / (spaced(scale.hi) - spaced(scale.lo));
    return ramp[Math.round(within(p, 0, 1) * 255)];
}

/** Colour scale of a metric in the format of a row. */
const scaleOf = (metric, row) => metric.scales[row.format];

function colourOf(metric, row, outcome, value) {
    if (metric.kind === "classes") return index.outcomes[outcome][1];
    if (metric.blamed)
        return Number.isNaN(value) && outcome !== agreeHit ? index.outcomes[outcome][1] :
                                                             metric.categories[Number.isNaN(value) ? 0 : value][1];
    if (metric.marches || metric.every_ray) {
        if (Number.isNaN(value)) return index.outcomes[outcomeNames.indexOf("not_a_number")][1];
        return metric.categories ? metric.categories[value][1] : rampAt(scaleOf(metric, row), value);
    }
    if (outcome !== agreeHit) return index.outcomes[outcome][1];
    return Number.isNaN(value) ? index.no_value : rampAt(scaleOf(metric, row), Math.abs(value));
}

/** Paints a metric on a canvas with one pixel per ray. */
function paint(map, pixels, metric) {
    if (!pixels.painted.has(metric.name)) {
        const canvas = document.createElement("canvas");
        canvas.width = map.width;
        canvas.height = map.height;
        const context = canvas.getContext("2d"), image = context.createImageData(map.width, map.height);
        for (let i = 0; i < pixels.outcome.length; ++i) {
            const value = metric.kind === "classes" ? NaN : valueAt(pixels, metric, i);
            const [r, g, b] = colourOf(metric, pixels.row, pixels.outcome[i], value);
            image.data.set([r, g, b, 255], 4 * i);
        }
        context.putImageData(image, 0, 0);
        pixels.painted.set(metric.name, canvas);
    }
    return pixels.painted.get(metric.name);
}
