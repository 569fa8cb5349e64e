// Charts are SVGs that the program drew. A group of marks says which rows it shows (`data-keys`) and where steps,
// points or the edges of cells lie (`data-x`, `data-y`), in units of the viewBox. This file adds the pointer, keys and
// zoom.

const isFraction = (statistic) => statistic.endsWith("_fraction");

/** The figures of a part of the page. */
const chartsOf = (part) => [...document.querySelectorAll(`#${CSS.escape(part)} figure.chart`)];

const numbersIn = (text) => (text ? text.split(" ").map(Number) : []);

/** Vertices of the lines in a group, in the order in which they were drawn: lines come before their markers. */
function verticesOf(group) {
    const all = [];
    for (const path of group.querySelectorAll("path[fill=none]")) {
        let x = 0, y = 0, pair = [];
        for (const [token] of path.getAttribute("d").matchAll(/[Ml]|-?[\d.]+/g)) {
            if (token === "M") x = y = 0;
            if (token === "M" || token === "l") continue;
            pair.push(Number(token));
            if (pair.length < 2) continue;
            x += pair[0];
            y += pair[1];
            all.push([x, y]);
            pair = [];
        }
    }
    return all;
}

/**
 * The groups of a figure, read once: `lines` with their vertices, `points`, and `frame`, the group of steps or cells.
 */
function readChart(figure) {
    const svg = figure.querySelector("svg"), home = numbersIn(svg.getAttribute("viewBox"));
    const chart = { figure, svg, home, view: home, lines: [], points: [], frame: null };
    for (const group of svg.querySelectorAll("g[data-keys]")) {
        const keys = group.dataset.keys.split(" ").filter(Boolean), x = numbersIn(group.dataset.x),
              y = numbersIn(group.dataset.y);
        if (x.length === 0 && keys.length > 0) chart.lines.push({ group, keys, vertices: verticesOf(group) });
        else if (x.length === 1 && keys.length > 0) chart.points.push({ group, keys, x: x[0], y: y[0] });
        else chart.frame = { group, keys, x, y };
    }
    chart.pin = document.createElementNS(svg.namespaceURI, "g");
    chart.pin.setAttribute("class", "pin");
    svg.append(chart.pin);
    enableZoom(chart);
    return chart;
}
const chartOf = (figure) => once(figure, () => readChart(figure));

/** Position of the pointer in units of the viewBox. */
function pointerPosition({ svg }, { clientX, clientY }) {
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(svg.getScreenCTM().inverse());
    return [x, y];
}

const nearestOf = (places, at) => places.reduce(
    (best, place, k) => (Math.abs(place - at) < Math.abs((places[best] ?? Infinity) - at) ? k : best), -1);

/** Height of a line at a step, or NaN where it has a gap. */
const heightAt = ({ frame }, line, step) => line.vertices.find(([x]) => Math.abs(x - frame.x[step]) < 0.02)?.[1] ?? NaN;

/** The step under the pointer and the line nearest to it, if one is near. */
function stepUnder(chart, event) {
    const [x, y] = pointerPosition(chart, event), { frame } = chart, step = nearestOf(frame.x, x);
    if (step < 0 || y < frame.y[0] || y > frame.y[1] || x < frame.x[0] - 15 || x > frame.x.at(-1) + 15) return null;
    const away = chart.lines.map((line) => Math.abs(heightAt(chart, line, step) - y)), k = nearestOf(away, 0);
    return { step, line: away[k] < 24 ? chart.lines[k] : null };
}

/** Column and line of the cell under the pointer. Columns of a table have gaps; lines may run upwards. */
function cellUnder(chart, event) {
    const [x, y] = pointerPosition(chart, event), { frame } = chart, pairs = frame.keys.length > 0;
    const between = (places, at, by) => {
        for (let k = 0; k + 1 < places.length; k += by)
            if ((at - places[k]) * (at - places[k + 1]) <= 0) return k / by;
        return -1;
    };
    const at = [between(frame.x, x, pairs ? 2 : 1), between(frame.y, y, 1)];
    return at[0] >= 0 && at[1] >= 0 ? at : null;
}

function pointUnder(chart, event) {
    const [x, y] = pointerPosition(chart, event), away = chart.points.map((p) => Math.hypot(p.x - x, p.y - y)),
              k = nearestOf(away, 0);
    return away[k] < 20 ? chart.points[k] : null;
}

/** Replaces the marks that are drawn over a chart. Each element is a name and its attributes. */
function pinOn({ svg, pin }, ...elements) {
    pin.replaceChildren(...elements.map(([name, attributes]) => {
        const element = document.createElementNS(svg.namespaceURI, name);
        for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
        return element;
    }));
}

/** Marks a step: a vertical line, and a ring where it meets a line of the chart. */
function pinStep(chart, step, line) {
    const x = chart.frame?.x[step], y = line ? heightAt(chart, line, step) : NaN, [top, foot] = chart.frame?.y ?? [];
    if (!Number.isFinite(x)) return pinOn(chart);
    pinOn(
        chart, ["line", { x1: x, x2: x, y1: top, y2: foot }],
        ...(Number.isFinite(y) ? [["circle", { cx: x, cy: y, r: 5 }]] : []));
}

function pinCell(chart, at) {
    if (!at) return pinOn(chart);
    const { frame: { keys, x, y } } = chart, i = at[0] * (keys.length > 0 ? 2 : 1),
                                  top = Math.min(y[at[1]], y[at[1] + 1]);
    pinOn(chart, ["rect", { x: x[i], y: top, width: x[i + 1] - x[i], height: Math.abs(y[at[1] + 1] - y[at[1]]) }]);
}

const pinPoint = (chart, point) => pinOn(chart, ...(point ? [["circle", { cx: point.x, cy: point.y, r: 8 }]] : []));

/** Draws the line of a row thick and above the others, and fades all lines but the one under the pointer. */
function emphasize(chart, key, under) {
    for (const line of chart.lines) {
        const isChosen = line.keys.includes(key);
        if (isChosen && !line.group.classList.contains("chosen")) chart.svg.insertBefore(line.group, chart.pin);
        line.group.classList.toggle("chosen", isChosen);
        line.group.classList.toggle("faded", Boolean(under) && line !== under);
    }
}

/** Shows a part of the chart. */
function zoomChart(chart, [x, y, w, h]) {
    const [left, top, width, height] = chart.home, wide = within(w, width / 64, width),
                             high = within(h, height / 64, height);
    chart.view = [within(x, left, left + width - wide), within(y, top, top + height - high), wide, high];
    chart.svg.setAttribute("viewBox", chart.view.join(" "));
}
const unzoom = (chart) => zoomChart(chart, chart.home);
function zoomChartBy(chart, factor) {
    const [x, y, w, h] = chart.view;
    zoomChart(chart, [x + (w - w / factor) / 2, y + (h - h / factor) / 2, w / factor, h / factor]);
}

/**
 * Dragging zooms to a rectangle, and a double click shows all again. Dragging over text selects it. `dragged` tells a
 * drag from a click.
 */
function enableZoom(chart) {
    const { svg } = chart;
    let from = null;
    svg.addEventListener("pointerdown", (event) => {
        chart.dragged = false;
        from = null;
        if (event.pointerType !== "mouse" || event.button !== 0 || event.target.closest("text")) return;
        from = pointerPosition(chart, event);
        event.preventDefault();  // selects nothing on the way
    });
    svg.addEventListener("pointerup", (event) => {
        if (!from) return;
        const to = pointerPosition(chart, event), w = Math.abs(to[0] - from[0]), h = Math.abs(to[1] - from[1]);
        chart.dragged = Math.max(w, h) > 6;
        if (w > 6 && h > 6) zoomChart(chart, [Math.min(from[0], to[0]), Math.min(from[1], to[1]), w, h]);
        from = null;
    });
    svg.addEventListener("dblclick", () => unzoom(chart));
}

/** Keys that zoom the chart that `now` returns. */
const zoomKeys = (now) =>
    ({ "+": () => zoomChartBy(now(), 1.5), "-": () => zoomChartBy(now(), 1 / 1.5), 0: () => unzoom(now()) });
