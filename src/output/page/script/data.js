// From the packed text of the page to numbers. Layouts are those of map_data.cpp.

const index = JSON.parse(document.getElementById("index").textContent);
const outcomeNames = index.outcomes.map(([name]) => name);
const agreeHit = 0;
const keyOf = (row) => `${row.form}.${row.format}`;
const shortName = (row) => row.form.slice(row.form.indexOf(".") + 1);

/** Whether quantiles over so many agreed hits stand for a form, and what is said where they do not: agreement.hpp. */
const isEnough = (agreed, hits) => hits === 0 || (agreed > 0 && agreed >= index.least_agreement * hits);
const tooFew = (agreed, hits) =>
    `${agreed} of ${hits} hit${hits === 1 ? "" : "s"} ${agreed === 1 ? "agrees" : "agree"}`;

const unpacked = new Map();

/** The bytes of a packed part; a promise. Each is unpacked once. */
function bytesOf(name) {
    if (!unpacked.has(name)) unpacked.set(name, unpack(name));
    return unpacked.get(name);
}

async function unpack(name) {
    const element = document.getElementById(name);
    const text = atob(element.textContent);
    element.remove();  // it is not needed twice
    const packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads planes: byte k of all numbers, lowest first. */
class Planes {
    constructor(bytes, count) {
        this.bytes = bytes;
        this.count = count;
        this.at = 0;
    }
    unsigned(width, Type) {
        const values = new Type(this.count), n = this.count;
        for (let k = 0; k < width; ++k) {
            const plane = this.bytes.subarray(this.at, this.at + n);
            for (let i = 0; i < n; ++i) values[i] |= plane[i] << (8 * k);
            this.at += n;
        }
        return values;
    }
    floats() { return new Float32Array(this.unsigned(4, Uint32Array).buffer); }
    /** Pairs of words, low and high. */
    wide() {
        const low = this.unsigned(4, Uint32Array);
        return { low, high: this.unsigned(4, Uint32Array) };
    }
    doubles() {
        const { low, high } = this.wide(), values = new Float64Array(this.count);
        for (let i = 0; i < values.length; ++i) values[i] = doubleOf(high[i], low[i]);
        return values;
    }
}

/**
 * Undoes what `MapData::Group` does: bits less 2 last - before, folded, along each row of the picture. In two words of
 * 32 bits.
 */
function pointedTo({ low, high }, width, decision) {
    const values = new Float64Array(low.length);
    let lastLow = 0, lastHigh = 0, beforeLow = 0, beforeHigh = 0;
    for (let i = 0; i < values.length; ++i) {
        if (i % width === 0) lastLow = lastHigh = beforeLow = beforeHigh = 0;
        if (decision[i] !== 1) continue;
        const sign = -(low[i] & 1);
        let l = (((low[i] >>> 1) | (high[i] << 31)) ^ sign) >>> 0, h = (high[i] >>> 1) ^ sign;
        const add = (a, b) => {
            const sum = l + a;
            l = sum >>> 0;
            h = (h + b + (sum > 0xffffffff ? 1 : 0)) | 0;
        };
        add(lastLow, lastHigh);
        if (beforeLow !== 0 || beforeHigh !== 0) {
            add(lastLow, lastHigh);
            add(~beforeLow >>> 0, ~beforeHigh);  // less `before`: plus its complement and one
            add(1, 0);
        }
        [beforeLow, beforeHigh, lastLow, lastHigh] = [lastLow, lastHigh, l, h];
        values[i] = doubleOf(h, l);
    }
    return values;
}

async function truthOf(map, group) {
    const planes = new Planes(await bytesOf(`truth:${map.id}:${group}`), map.width * map.height);
    const decision = planes.unsigned(1, Uint8Array);
    return {
        decision,
        object: planes.unsigned(4, Uint32Array),
        truth: pointedTo(planes.wide(), map.width, decision),
        rest: planes.floats(),
        bound: planes.unsigned(2, Int16Array),
        condition: planes.floats(),
    };
}

/** Undoes `folded_difference` in 32 bits. */
const unfold = (d) => (d >>> 1) ^ -(d & 1);

/** Floats of the true hits, whose bits are kept less 2 last - before, folded, along each row; NaN elsewhere. */
function floatsPointedTo(d, width, decision) {
    const bits = new Uint32Array(d.length), values = new Float32Array(bits.buffer);
    let last = 0, before = 0;
    for (let i = 0; i < d.length; ++i) {
        if (i % width === 0) last = before = 0;
        if (decision[i] !== 1) {
            values[i] = NaN;
            continue;
        }
        bits[i] = unfold(d[i]) + (before === 0 ? last : 2 * last - before);
        before = last;
        last = bits[i];
    }
    return values;
}

function answers32(planes, truth) {
    const d = planes.unsigned(4, Uint32Array), bits = new Uint32Array(d.length), near = new Float32Array(1),
          nearBits = new Uint32Array(near.buffer);
    for (let i = 0; i < d.length; ++i) {
        near[0] = truth.decision[i] === 1 ? truth.truth[i] : 0;
        bits[i] = nearBits[0] + unfold(d[i]);
    }
    return Float64Array.from(new Float32Array(bits.buffer));
}

function answers64(planes, truth) {
    const { low, high } = planes.wide(), t = new Float64Array(low.length);
    for (let i = 0; i < t.length; ++i) {
        const sign = -(low[i] & 1);  // shifted right by one in 64 bits, then turned over where negative
        const l = ((low[i] >>> 1) | (high[i] << 31)) ^ sign, h = (high[i] >>> 1) ^ sign;
        const near = truth.decision[i] === 1 ? truth.truth[i] : 0;
        const sum = (lowOf(near) >>> 0) + (l >>> 0);
        t[i] = doubleOf(highOf(near) + h + (sum > 0xffffffff ? 1 : 0), sum);
    }
    return t;
}

const rowsRead = new Map();

/** The pixels of a row: outcome, object, t, the stored metrics and the truth they share with others. */
function pixelsOf(map, row) {
    const name = `row:${map.id}:${keyOf(row)}`;
    if (!rowsRead.has(name)) rowsRead.set(name, readRow(map, row, name));
    return rowsRead.get(name);
}

const truthsRead = new Map();
function sharedTruth(map, group) {
    const name = `${map.id}:${group}`;
    if (!truthsRead.has(name)) truthsRead.set(name, truthOf(map, group));
    return truthsRead.get(name);
}

async function readRow(map, row, name) {
    const [bytes, truth] = await Promise.all([bytesOf(name), sharedTruth(map, row.group)]);
    const planes = new Planes(bytes, map.width * map.height);
    const outcome = planes.unsigned(1, Uint8Array), object = planes.unsigned(4, Uint32Array);
    const t = row.coding === "bits32" ? answers32(planes, truth) :
        row.coding === "bits64"       ? answers64(planes, truth) :
                                        planes.doubles();
    const stored = {};
    for (const metric of map.metrics) {
        if (metric.kind === "stored") stored[metric.name] = planes.floats();
        if (metric.kind === "hits")
            stored[metric.name] = floatsPointedTo(planes.unsigned(4, Uint32Array), map.width, truth.decision);
    }
    return { row, truth, outcome, object, t, stored, painted: new Map() };
}

const sampleAt = (pixels, i) =>
    ({ t: pixels.t[i], truth: pixels.truth.truth[i], rest: pixels.truth.rest[i], row: pixels.row });

/** A metric at pixel i; NaN where it does not exist. */
function valueAt(pixels, metric, i) {
    if (metric.kind === "stored") return pixels.stored[metric.name][i];
    if (pixels.outcome[i] !== agreeHit) return NaN;
    if (metric.kind === "hits") return pixels.stored[metric.name][i];
    return metric.kind === "shared" ? pixels.truth.condition[i] : derived[metric.name](sampleAt(pixels, i));
}

// Colours: the same tables and the same arithmetic as the PNGs.

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
    return ramp[Math.round(Math.min(1, Math.max(0, p)) * 255)];
}

/** The scale of a metric in the format of a row. */
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

/** The field of a metric as a canvas of one pixel a ray. */
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
