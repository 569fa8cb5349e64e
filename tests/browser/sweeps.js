// Promises of the page about sweeps, planes, cases and trades.
"use strict";

const assert = require("node:assert/strict");
const { settled, stateOf, sweep } = require("./browser.js");
const { liesIn, readCsv } = require("./files.js");

/** The plot's numbers equal those of samples.csv, and a line leads to its form's map. */
async function sweeps({ open, at }) {
    const page = await open("report", { hash: `#sweep=${sweep}` });
    assert.ok(await page.locator("#sweep-plot canvas").count() > 0, "no plot");
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
    const ink = () => page.evaluate(() => document.querySelector("#sweep-plot canvas").toDataURL());
    const before = await ink();
    await page.selectOption("#pick-statistic", "excess_bits_p99");
    await settled(page);
    assert.notEqual(await ink(), before);
    // The keyboard alone reaches a step and its numbers.
    await page.selectOption("#pick-statistic", "lost_bits_p99");
    for (const key of ["ArrowRight", "ArrowRight", "ArrowDown"]) await page.locator("#sweep-plot").press(key);
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
    assert.ok(await page.locator("#trade-plot canvas").count() > 0, "no plot");
    const [x, y] = await page.evaluate(() => {
        // Chooses a point that has a map and is apart from all others. Times vary, so any two points may overlap.
        const { plot, points } = tradeParts,
                             at = (q) => [plot.valToPos(q.time_ns, "x"), plot.valToPos(q.kept_bits, "y")],
                             away = (p, q) => Math.hypot(at(q)[0] - at(p)[0], at(q)[1] - at(p)[1]),
                             gap = (p) => Math.min(...points.filter((q) => q !== p).map((q) => away(p, q)));
        document.getElementById("trade-plot").scrollIntoView();
        const box = document.querySelector("#trade-plot .u-over").getBoundingClientRect(),
              [px, py] = at(points.filter((q) => mapOf(q)).sort((a, b) => gap(b) - gap(a))[0]);
        return [box.left + px, box.top + py];
    });
    await page.mouse.move(x, y);
    await settled(page);
    assert.match(await page.locator("#trade-view .hint").innerText(), /ns per ray, keeps/);
    const named = await page.evaluate(() => tradeParts.under.form);
    await page.mouse.click(x, y);
    assert.equal((await stateOf(page)).form, named);
    // Names of points on the front overlap neither points nor other names.
    const covered = await page.evaluate(() => {
        const { plot, points, named } = tradeParts, boxes = named.map((n) => n.box);
        const on = ([x, y, w, h], [a, b, c, d]) => x < a + c && a < x + w && y < b + d && b < y + h;
        const dots =
            points.map((p) => [plot.valToPos(p.time_ns, "x", true), plot.valToPos(p.kept_bits, "y", true), 1, 1]);
        return {
            names: boxes.length,
            points: boxes.filter((b) => dots.some((d) => on(b, d))).length,
            others: boxes.filter((b, i) => boxes.some((o, j) => i !== j && on(b, o))).length
        };
    });
    assert.ok(covered.names > 0);
    assert.deepEqual([covered.points, covered.others], [0, 0]);
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

/** The cells of a grid on the page, each with its position, its numbers and its colour. */
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
                        colour: cellLook(sweep, row, plane ? "lost_bits_p99" : "verdict", cell).colour,
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

const packed = (colour) => colour && (colour[0] << 16) | (colour[1] << 8) | colour[2];

/** Every cell of every row equals that of samples.csv, and has the colour of the PNG. */
async function planes({ open, at }) {
    const page = await open("grids"), rows = await gridOf(page, "sphere-height"),
          csv = readCsv(at("sweep/sphere-height/samples.csv"));
    let compared = 0;
    for (const row of rows)
        compared += compareRow(row, csv, (c) => [c.radius, c.height].map((x) => String(Number(x))).join(" "));
    assert.equal(compared, csv.length);
    assert.ok(compared > 4000 && rows.some((row) => row.cells.some((c) => Number(c.values.lost_bits_p99) > 10)));
    const columns = 26, lines = 46;  // of sphere-height; a cell is 22 x 10 pixels in the PNG
    for (const row of rows) {
        const cells =
            Array.from({ length: lines }, (_, j) => row.cells.slice(j * columns, (j + 1) * columns)).reverse();
        const png = at(`sweep/sphere-height/${row.form}.${row.format}.png`),
              colours = cells.flat().map((c) => packed(c.colour));
        assert.ok(
            await liesIn(page, png, colours, [{ columns, w: 22, h: 10, at: 4 }]),
            `${row.form} ${row.format}: other colours than in the PNG`);
    }
}

/** Every case with every form and convention equals that of cases.csv, and has the colour of the PNG. */
async function cases({ open, at }) {
    const page = await open("grids");
    for (const [id, picture] of [["box-boundary", "matrix.closed.png"], ["contact", "matrix.png"]]) {
        const rows = await gridOf(page, id), csv = readCsv(at(`sweep/${id}/cases.csv`));
        const compared = rows.reduce((n, row) => n + compareRow(row, csv, (c) => c.case), 0);
        assert.equal(compared, csv.length);
        const judged = rows.filter((row) => row.judged === rows[0].judged && row.format === "f32"),
              cells = judged[0].cells.flatMap((_, k) => judged.map((row) => packed(row.cells[k].colour))),
              // The width of a column depends on the text in its cells.
            ways = Array.from({ length: 34 }, (_, k) => ({ columns: judged.length, w: 26 + k, h: 22, at: 1 }));
        assert.ok(
            await liesIn(page, at(`sweep/${id}/${picture}`), cells, ways), `${id}: other colours than in the PNG`);
    }
}

/**
 * Pointing, clicking, keys and links choose a cell. The read-out has its exact numbers, and the drawn cell its colour.
 */
async function walk({ open, at }) {
    const csv = readCsv(at("sweep/sphere-height/samples.csv"));
    const page = await open("grids", { hash: "#sweep=sphere-height&form=sphere.unified&format=f32&u=3&v=4" });
    const press = async (key, where = "#grid") => {
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
    const pixel = () => page.evaluate(() => {
        const { canvas, layout, frame, width } = gridParts, [x, y] = placeOf(layout, frame, state.u, state.v),
                                             k = canvas.width / width;
        return [...canvas.getContext("2d").getImageData((x + frame.w / 2) * k, (y + frame.h / 2) * k, 1, 1).data].slice(
            0, 3);
    });
    const colour = () => page.evaluate(
        () => cellLook(sweepParts.now.sweep, sweepParts.now.chosen, sweepParts.now.statistic, cellNow().cell).colour);
    assert.deepEqual(await pixel(), await colour());
    await press("m");
    assert.equal((await stateOf(page)).statistic, "lost_bits_max");
    assert.deepEqual(await pixel(), await colour());
    // A link restores the choice. A click chooses the cell under the pointer. Escape clears the choice.
    const again = await open("grids", { hash: await page.evaluate(() => location.hash) });
    assert.deepEqual(await stateOf(again), await stateOf(page));
    assert.equal(await again.locator("#sweep-facts").innerText(), await page.locator("#sweep-facts").innerText());
    const place = await page.evaluate(() => {
        gridParts.canvas.scrollIntoView();
        const box = gridParts.canvas.getBoundingClientRect(),
              [x, y] = placeOf(gridParts.layout, gridParts.frame, 20, 40), k = box.width / gridParts.width;
        return { x: box.left + (x + 3) * k, y: box.top + (y + 3) * k };
    });
    await page.mouse.move(place.x, place.y);
    assert.match(
        await page.locator("#sweep-under").innerText(),
        /^sphere\.unified in f32, radius, in world units .*: lost bits max /);
    await page.mouse.click(place.x, place.y);
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
    assert.deepEqual(
        page.complaints.filter((c) => !c.startsWith("Canvas2D")), []);  // it warns of reading pixels back, as here
}

exports.promises = {
    sweeps,
    trade,
    planes,
    cases,
    walk
};
