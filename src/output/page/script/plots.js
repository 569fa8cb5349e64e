// What the plots of sweeps and trades share.

const hasPlots = typeof uPlot === "function";
if (!hasPlots) index.sweeps = index.sweeps.filter((s) => s.kind !== "line");  // those are pictures then
const lineColours = [
    "#4477aa", "#ee6677", "#228833", "#aa7700", "#0099bb", "#aa3377", "#555555", "#882255", "#117733", "#dd7711",
    "#332288", "#999933"
];

/** As wide as there is room. */
const plotSize = (element) => ({ width: Math.max(240, Math.min(1100, element.clientWidth)), height: 380 });

/** `2^10` for powers of two beyond what reads well plainly. */
function tickText(x) {
    if (x === null || x === undefined) return "";
    const e = Math.log2(x);
    return Number.isInteger(e) && (e < -3 || e > 10) ? `2^${e}` : rounded(x);
}

/** Ends of a logarithmic axis: powers of two, so that its ticks are too. */
const logEnds = (values) => {
    const low = Math.floor(Math.log2(Math.min(...values)));
    return [2 ** low, 2 ** Math.max(low + 1, Math.ceil(Math.log2(Math.max(...values))))];
};

/** A linear axis of a single value is given room about it. */
const apart = (low, high) =>
    (low < high ? [low, high] : [low - Math.abs(low || 1) / 10, high + Math.abs(high || 1) / 10]);

/** A colour of page.css, which has two sets of them. */
const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const axisLook = (label) => ({
    label,
    stroke: ink("--ink"),
    grid: { stroke: ink("--faint"), width: 1 },
    ticks: { stroke: ink("--line"), width: 1 },
    font: "12px sans-serif",
    labelFont: "12px sans-serif"
});
