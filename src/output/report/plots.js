// What the plots of sweeps and trades share.

const hasPlots = typeof uPlot === "function";
const lineColours = ["#4477aa", "#ee6677", "#228833", "#aa7700", "#0099bb", "#aa3377", "#555555", "#882255", "#117733", "#dd7711", "#332288", "#999933"];

const plotSize = (element) => ({ width: Math.max(320, Math.min(1100, element.clientWidth)), height: 380 });

/** `2^10` for powers of two beyond what reads well plainly. */
function tickText(x) {
    if (x === null || x === undefined) return "";
    const e = Math.log2(x);
    return Number.isInteger(e) && (e < -3 || e > 10) ? `2^${e}` : rounded(x);
}

/** Ends of a logarithmic axis: powers of two, so that its ticks are too. */
const logEnds = (values) => [2 ** Math.floor(Math.log2(Math.min(...values))), 2 ** Math.ceil(Math.log2(Math.max(...values)))];

const axisLook = (label) => ({ label, stroke: "#202024", grid: { stroke: "#e2e2e0", width: 1 }, ticks: { stroke: "#b0b0b4", width: 1 }, font: "12px sans-serif", labelFont: "12px sans-serif" });
