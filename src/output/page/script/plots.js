// Parts that the plots of sweeps and trades share.

const hasPlots = typeof uPlot === "function";
if (!hasPlots) index.sweeps = index.sweeps.filter((s) => s.kind !== "line");  // without uPlot they are pictures
const lineColours = [
    "#4477aa", "#d94f61", "#228833", "#aa7700", "#0085a3", "#aa3377", "#555555", "#882255", "#117733", "#c2600a",
    "#332288", "#80801a"
];

const lineDashes = [undefined, [6, 4], [2, 3], [10, 3, 2, 3]];

/**
 * Colour and dash of a form's line, the same in every plot. `look` is its index among the `look_count` looks of the
 * pictures.
 */
const lineLook = (look) => ({
    colour: onPage(lineColours[look % lineColours.length]),
    dash: lineDashes[Math.floor(look / lineColours.length)]
});

function strokeAlong(context, ...points) {
    context.beginPath();
    for (const [x, y] of points) context.lineTo(x, y);
    context.stroke();
}

/** A short piece of a line, for a key. */
function lineSample({ colour, dash }) {
    const sample = make("canvas", { width: 30, height: 10, className: "line-sample", "aria-hidden": "true" }),
          context = sample.getContext("2d");
    context.strokeStyle = colour;
    context.lineWidth = 2.5;
    context.setLineDash(dash ?? []);
    strokeAlong(context, [1, 5], [29, 5]);
    return sample;
}

/** Colour of a line on the page: on a dark page two fifths of the way to white. */
function onPage(colour) {
    if (!matchMedia("(prefers-color-scheme: dark)").matches) return colour;
    const lighter = (x) => Math.round(x + 0.4 * (255 - x)).toString(16).padStart(2, "0");
    return "#" + colour.match(/[0-9a-f]{2}/g).map((x) => lighter(parseInt(x, 16))).join("");
}

/** As wide as the element, from 240 to 1500 pixels. */
const plotSize = (element) => ({ width: Math.max(240, Math.min(1500, element.clientWidth)), height: 380 });

/** `2^10` for powers of two that are long to write plainly. */
function tickText(x) {
    if (x === null || x === undefined) return "";
    const e = Math.log2(x);
    return Number.isInteger(e) && (e < -3 || e > 10) ? `2^${e}` : rounded(x);
}

/** Ends of a logarithmic axis: powers of two, so that its ticks are powers of two. */
const logEnds = (values) => {
    const low = Math.floor(Math.log2(Math.min(...values)));
    return [2 ** low, 2 ** Math.max(low + 1, Math.ceil(Math.log2(Math.max(...values))))];
};

/** Ends of a linear axis. A single value gets some space on both sides. */
const apart = (low, high) =>
    (low < high ? [low, high] : [low - Math.abs(low || 1) / 10, high + Math.abs(high || 1) / 10]);

/** A colour of page.css, which has one set for light and one for dark pages. */
const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const axisLook = (label) => ({
    label,
    stroke: ink("--ink"),
    grid: { stroke: ink("--faint"), width: 1 },
    ticks: { stroke: ink("--line"), width: 1 },
    font: "12px sans-serif",
    labelFont: "12px sans-serif"
});
