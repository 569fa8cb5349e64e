// Promises of the page about sweeps, planes, cases and trades.
"use strict";

const assert = require("node:assert/strict");
const { settled, stateOf, sweep } = require("./browser.js");
const { readCsv } = require("./files.js");

/** Position on the screen of a place in a chart of the page. */
const onScreen = (page, parts, place) => page.evaluate(([parts, [x, y]]) => {
    const { svg } = (parts === "trade" ? tradeParts : sweepParts).chart;
    svg.scrollIntoView();
    const at = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
    return [at.x, at.y];
}, [parts, place]);

/** The page's numbers equal those of samples.csv, its lines lie at them, and a line leads to its form's map. */
async function sweeps({ open, at }) {
    const page = await open("report", { hash: `#sweep=${sweep}` });
    assert.ok(await page.locator("#sweep-chart svg path").count() > 0, "no chart");
    const csv = readCsv(at(`sweep/${sweep}/samples.csv`)), plotted = await page.evaluate((id) => sweepOf(id), sweep);
    assert.equal(plotted.rows.length * plotted.steps.length, csv.length);
    let compared = 0;
    for (const sample of csv) {
        const row = plotted.rows.find((r) => r.form === sample.form && r.format === sample.format),
              k = plotted.steps.indexOf(Number(sample[plotted.axis]));
        plotted.statistics.forEach((statistic, s) => {
            const cell = sample[statistic];
            assert.equal(String(row.outcomes[k][0]), sample.agree_hit);
            assert.equal(
                String(row.values[s][k]), cell === "" ? "null" : String(Number(cell)),
                `${sample.form} ${sample.format} ${statistic} at ${sample[plotted.axis]}`);
            ++compared;
        });
    }
    assert.ok(compared > 1000);
    await page.selectOption("#pick-sweep-form", "sphere.unified");
    assert.equal((await stateOf(page)).form, "sphere.unified");
    // The height of each line is a linear function of its form's values.
    const heights = await page.evaluate(() => {
        const { sweep, rows } = sweepParts.now, { chart, order } = sweepParts;
        return rows.flatMap(
            (row) => order.map(
                (cell, k) => [drawnValue(sweep, row, "lost_bits_p99", cell), heightAt(chart, lineOf(keyOf(row)), k)]));
    });
    const sure = heights.filter((pair) => pair.every(Number.isFinite)).sort((a, b) => a[0] - b[0]),
          [low, high] = [sure[0], sure.at(-1)];
    assert.ok(sure.length > 100 && high[0] > low[0]);
    assert.equal(heights.filter(([value]) => Number.isFinite(value)).length, sure.length, "a value is not drawn");
    for (const [value, y] of sure) {
        const wanted = low[1] + (value - low[0]) / (high[0] - low[0]) * (high[1] - low[1]);
        assert.ok(Math.abs(y - wanted) < 0.05, `${value} is drawn at ${y} instead of ${wanted}`);
    }
    const named = () => page.locator("#sweep-chart figure").getAttribute("data-chart");
    assert.match(await named(), /^lost_bits_p99\.f/);
    await page.selectOption("#pick-statistic", "false_miss_fraction");
    await settled(page);
    assert.match(await named(), /^false_miss_fraction\.f/);
    // The keyboard alone reaches a step and its numbers.
    await page.selectOption("#pick-statistic", "lost_bits_p99");
    for (const key of ["ArrowRight", "ArrowRight", "ArrowDown"]) await page.locator("#sweep-chart").press(key);
    await settled(page);
    const now = await stateOf(page),
          facts = (key) => page.locator(`#sweep-facts tr[data-fact=${key}] td`).first().innerText();
    assert.equal(now.u, ((plotted.steps.length - 1) >> 1) + 1);
    const forms = plotted.rows.filter((r) => r.format === now.format).map((r) => r.form);
    assert.equal(now.form, forms[(forms.indexOf("sphere.unified") + 1) % forms.length]);
    const step = csv.find(
        (c) => c.form === now.form && c.format === now.format &&
            Number(c[plotted.axis]) === [...plotted.steps].sort((a, b) => a - b)[now.u]);
    assert.equal(await facts("lost_bits_p99"), step.lost_bits_p99);
    assert.equal(await facts("place"), step[plotted.axis]);
}

async function trade({ open }) {
    const page = await open("report", { hash: "#shape=sphere" });
    const place = await page.evaluate(() => {
        // Chooses a point that has a map and is apart from all others. Times vary, so any two points may overlap.
        const { points } = tradeParts.chart, away = (p, q) => Math.hypot(q.x - p.x, q.y - p.y),
                       gap = (p) => Math.min(...points.filter((q) => q !== p).map((q) => away(p, q)));
        const { x, y } = points.filter((q) => mapOf(tradePoint(q))).sort((a, b) => gap(b) - gap(a))[0];
        return [x, y];
    });
    const [x, y] = await onScreen(page, "trade", place);
    await page.mouse.move(x, y);
    await settled(page);
    assert.match(await page.locator("#trade-view > .hint").innerText(), /ns per ray, keeps/);
    const named = await page.evaluate(() => tradeParts.under.form);
    await page.mouse.click(x, y);
    assert.equal((await stateOf(page)).form, named);
    // Keys go from point to point by time. Enter opens the map of a point that has a map here.
    const walked = [],
          under = () =>
              page.evaluate(() => [tradeParts.under.time_ns, tradeParts.under.form, Boolean(mapOf(tradeParts.under))]);
    await page.evaluate(() => sayPoint(null));
    do {
        await page.locator("#trade-plot").press("ArrowRight");
        walked.push(await under());
    } while (walked.length < 3 || !walked.at(-1)[2]);
    assert.deepEqual(walked.map(([time]) => time), walked.map(([time]) => time).sort((x, y) => x - y));
    await page.locator("#trade-plot").press("Enter");
    assert.equal((await stateOf(page)).form, walked.at(-1)[1]);
    assert.match(
        await page.locator("#trade").innerText(),
        /Times were measured briefly by the run that made this page, on its machine/);
}

const exact = (cell) => (cell === "" ? "NaN" : String(Number(cell)));

/** The cells of a grid on the page, each with its position and its numbers. */
function gridOf(page, id) {
    return page.evaluate(async (id) => {
        const sweep = await sweepOf(id), plane = sweep.kind === "plane",
              across = plane ? sweep.axes[0].values.length : 1;
        return sweep.rows.map(
            (row) => ({
                form: row.form,
                format: row.format,
                judged: row.judged,
                cells: row.outcomes.map(
                    (outcomes, cell) => ({
                        place: plane ?
                            [sweep.axes[0].values[cell % across], sweep.axes[1].values[Math.floor(cell / across)]]
                                .map(String)
                                .join(" ") :
                            sweep.cases[cell][0],
                        outcomes: Object.fromEntries(outcomes.map((n, o) => [outcomeNames[o], n])),
                        verdict: row.verdicts?.[cell],
                        values: Object.fromEntries(
                            sweep.statistics.map((s) => [s, String(cellValue(sweep, row, s, cell))])),
                    })),
            }));
    }, id);
}

function compareRow(row, csv, placeOf) {
    const mine = csv.filter(
        (c) => c.form === row.form && c.format === row.format &&
            (row.judged === undefined || c.convention === row.judged));
    assert.equal(row.cells.length, mine.length);
    const byPlace = new Map(mine.map((c) => [placeOf(c), c]));
    for (const cell of row.cells) {
        const sample = byPlace.get(cell.place), where = `${row.form} ${row.format} at ${cell.place}`;
        assert.ok(sample, `${where} is not in the CSV`);
        for (const [outcome, n] of Object.entries(cell.outcomes))
            assert.equal(String(n), sample[outcome] ?? "0", `${where}: ${outcome}`);  // meshes have no columns
        for (const [statistic, value] of Object.entries(cell.values))
            assert.equal(value, exact(sample[statistic]), `${where}: ${statistic}`);
        assert.equal(cell.verdict, sample.verdict);
    }
    return mine.length;
}

/** Every cell of every row equals that of samples.csv. */
async function planes({ open, at }) {
    const page = await open("grids"), rows = await gridOf(page, "sphere-height"),
          csv = readCsv(at("sweep/sphere-height/samples.csv"));
    let compared = 0;
    for (const row of rows)
        compared += compareRow(row, csv, (c) => [c.radius, c.height].map((x) => String(Number(x))).join(" "));
    assert.equal(compared, csv.length);
    assert.ok(compared > 4000 && rows.some((row) => row.cells.some((c) => Number(c.values.lost_bits_p99) > 10)));
    // The chart has an edge on each side of every cell.
    assert.deepEqual(
        await page.evaluate(() => ["x", "y"].map((axis) => sweepParts.chart.frame[axis].length)), [27, 47]);
}

/** Every case with every form and convention equals that of cases.csv. */
async function cases({ open, at }) {
    const page = await open("grids");
    for (const id of ["box-boundary", "contact"]) {
        const rows = await gridOf(page, id), csv = readCsv(at(`sweep/${id}/cases.csv`));
        const compared = rows.reduce((n, row) => n + compareRow(row, csv, (c) => c.case), 0);
        assert.equal(compared, csv.length);
        assert.ok(compared > 0);
    }
}

/**
 * Pointing, clicking, keys and links choose a cell. The read-out has its exact numbers.
 */
async function walk({ open, at }) {
    const csv = readCsv(at("sweep/sphere-height/samples.csv"));
    const page = await open("grids", { hash: "#sweep=sphere-height&form=sphere.unified&format=f32&u=3&v=4" });
    const press = async (key, where = "#sweep-chart") => {
        await page.locator(where).press(key);
        await settled(page);
        return stateOf(page);
    };
    const fact = (key) => page.locator(`#sweep-facts tr[data-fact=${key}] td`).first().innerText();
    const check = async () => {
        const places = await page.locator("#sweep-facts tr[data-fact=place] td:nth-child(2)").allInnerTexts();
        const sample = csv.find(
            (c) =>
                c.form === "sphere.unified" && c.format === "f32" && c.radius === places[0] && c.height === places[1]);
        assert.ok(sample, `no sample at ${places}`);
        for (const statistic of ["lost_bits_p99", "inherent_bits_p99"])
            assert.equal(await fact(statistic), sample[statistic]);
        assert.equal(await fact("agree_hit"), `${sample.agree_hit} of ${sample.rays}`);
    };
    await check();
    assert.deepEqual([(await press("ArrowRight")).u, (await press("ArrowUp")).v], [4, 5]);
    await check();
    const middle = ([i, j]) => page.evaluate(([i, j]) => {
        const { x, y } = sweepParts.chart.frame;
        return [(x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2];
    }, [i, j]);
    // The chosen cell has a frame.
    const [mx, my] = await middle([4, 5]),
               pinned = await page.locator("#sweep-chart .pin rect")
                            .evaluate((r) => ["x", "y", "width", "height"].map((a) => Number(r.getAttribute(a))));
    assert.ok(Math.abs(pinned[0] + pinned[2] / 2 - mx) < 1e-6 && Math.abs(pinned[1] + pinned[3] / 2 - my) < 1e-6);
    // A link restores the choice. A click chooses the cell under the pointer. Escape clears the choice.
    const again = await open("grids", { hash: await page.evaluate(() => location.hash) });
    assert.deepEqual(await stateOf(again), await stateOf(page));
    assert.equal(await again.locator("#sweep-facts").innerText(), await page.locator("#sweep-facts").innerText());
    const place = await onScreen(page, "sweep", await middle([20, 40]));
    await page.mouse.move(...place);
    assert.match(
        await page.locator("#sweep-under").innerText(),
        /^sphere\.unified in f32, radius, in world units .*: lost bits p99 /);
    await page.mouse.click(...place);
    assert.deepEqual([(await stateOf(page)).u, (await stateOf(page)).v], [20, 40]);
    await check();
    assert.deepEqual([(await press("Escape")).u, (await press("["))["line"]], [-1, "sphere.schoolbook.f32"]);
    // In cases, the left and right keys change the form. Box forms can be chosen although no map has them.
    await page.evaluate(() => goTo({ sweep: "box-boundary", statistic: "", u: -1, v: -1 }));
    await press("ArrowDown");
    assert.equal((await press("ArrowRight")).line, "box.signs.f32");
    assert.equal((await press("ArrowDown")).v, 1);
    assert.match(
        await page.locator("#sweep-facts caption").innerText(), /^box\.signs in f32, judged by the closed primitive/);
    await page.selectOption("#pick-judged", "open");
    assert.match(await page.locator("#sweep-facts caption").innerText(), /judged by the open primitive/);
    assert.deepEqual(page.complaints, []);
}

/** Dragging, a double click and keys change the part of a chart that is shown, and nothing else. */
async function zoom({ open }) {
    const page = await open("report", { hash: `#sweep=${sweep}&form=sphere.unified&format=f32` });
    const view = () => page.locator("#sweep-chart svg").getAttribute("viewBox"), home = await view(),
          chosen = await stateOf(page);
    const [from, to] = [await onScreen(page, "sweep", [200, 200]), await onScreen(page, "sweep", [400, 300])];
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 4 });
    await page.mouse.up();
    const [x, y, w, h] = (await view()).split(" ").map(Number);
    for (const [is, wanted] of [[x, 200], [y, 200], [w, 200], [h, 100]])
        assert.ok(Math.abs(is - wanted) < 2, await view());
    assert.deepEqual(await stateOf(page), chosen);
    await page.locator("#sweep-chart").press("0");
    assert.equal(await view(), home);
    await page.locator("#sweep-chart").press("+");
    assert.notEqual(await view(), home);
    await page.locator("#sweep-chart svg").dblclick({ position: { x: 5, y: 5 } });
    assert.equal(await view(), home);
}

exports.promises = {
    sweeps,
    zoom,
    trade,
    planes,
    cases,
    walk
};
