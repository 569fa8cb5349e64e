// What the page promises of planes over two axes and of named cases.
"use strict";

const assert = require("node:assert/strict");
const { stateOf, settled } = require("./common.js");
const { readCsv, readPng } = require("./files.js");

const exact = (cell) => (cell === "" ? "NaN" : String(Number(cell)));

/** What the page holds of a grid, each cell with its place, its numbers and its colour. */
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
            assert.equal(String(n), sample[outcome] ?? "0", `${where}: ${outcome}`);  // those of meshes are no columns
        for (const [statistic, value] of Object.entries(cell.values))
            assert.equal(value, exact(sample[statistic]), `${where}: ${statistic}`);
        assert.equal(cell.verdict, sample.verdict);
    }
    return mine.length;
}

/** How many cells of a field, wherever it lies in the picture, have another colour there. */
function misplaced(png, cells, columns, w, h, at) {
    let best = Infinity;
    for (let y0 = 0; y0 < png.height && best > 0; ++y0) {
        for (let x0 = 0; x0 < png.width; ++x0) {
            let wrong = 0;
            for (let k = 0; k < cells.length && wrong < best; ++k) {
                const x = x0 + (k % columns) * w + at, y = y0 + Math.floor(k / columns) * h + at;
                if (x >= png.width || y >= png.height || (cells[k] !== null && png.at(x, y) !== cells[k])) ++wrong;
            }
            best = Math.min(best, wrong);
        }
    }
    return best;
}

const packed = (colour) => colour && (colour[0] << 16) | (colour[1] << 8) | colour[2];

/** Every cell of every row is what samples.csv says, in the colour of the PNG. */
async function planes({ browser, grids, at }) {
    const page = await browser.page(grids), rows = await gridOf(page, "sphere-height"),
          csv = readCsv(at("sweep/sphere-height/samples.csv"));
    let compared = 0;
    for (const row of rows)
        compared += compareRow(row, csv, (c) => [c.radius, c.height].map((x) => String(Number(x))).join(" "));
    assert.equal(compared, csv.length);
    assert.ok(compared > 4000 && rows.some((row) => row.cells.some((c) => Number(c.values.lost_bits_p99) > 10)));
    const columns = 26, lines = 46;  // of sphere-height: 22 and 10 pixels a cell in the PNG
    for (const row of rows) {
        const cells = [];
        for (let j = lines - 1; j >= 0; --j)
            cells.push(...row.cells.slice(j * columns, (j + 1) * columns).map((c) => packed(c.colour)));
        const png = readPng(at(`sweep/sphere-height/${row.form}.${row.format}.png`));
        assert.equal(
            misplaced(png, cells, columns, 22, 10, 4), 0, `${row.form} ${row.format}: other colours than in the PNG`);
    }
}

/** Every case under every form and convention is what cases.csv says, in the colour of the PNG. */
async function cases({ browser, grids, at }) {
    const page = await browser.page(grids);
    for (const [id, picture] of [["box-boundary", "matrix.closed.png"], ["contact", "matrix.png"]]) {
        const rows = await gridOf(page, id), csv = readCsv(at(`sweep/${id}/cases.csv`));
        const compared = rows.reduce((n, row) => n + compareRow(row, csv, (c) => c.case), 0);
        assert.equal(compared, csv.length);
        const judged = rows.filter((row) => row.judged === rows[0].judged && row.format === "f32"), cells = [];
        for (let k = 0; k < judged[0].cells.length; ++k)
            cells.push(...judged.map((row) => packed(row.cells[k].colour)));
        const png = readPng(at(`sweep/${id}/${picture}`));
        let least = Infinity;  // over the widths of a column, which depend on what is written in the cells
        for (let w = 26; w < 60 && least > 0; ++w)
            least = Math.min(least, misplaced(png, cells, judged.length, w, 22, 1));
        assert.equal(least, 0, `${id}: other colours than in the PNG`);
    }
}

/**
 * Pointing, clicking, keys and links choose a cell; the read-out has its exact numbers; what is drawn has its colour.
 */
async function walk({ browser, grids, at }) {
    const csv = readCsv(at("sweep/sphere-height/samples.csv"));
    const page = await browser.page(grids, { hash: "#sweep=sphere-height&form=sphere.unified&format=f32&u=3&v=4" });
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
    // A link restores it; a click chooses what lies under the pointer; Escape lets it go.
    const again = await browser.page(grids, { hash: await page.evaluate(() => location.hash) });
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
    // Among cases left and right change the form; box forms are chosen beside maps that have none.
    await page.evaluate(() => goTo({ sweep: "box-boundary", statistic: "", u: -1, v: -1 }));
    await press("ArrowDown");
    assert.equal((await press("ArrowRight")).line, "box.signs.f32");
    assert.equal((await press("ArrowDown")).v, 1);
    assert.match(
        await page.locator("#sweep-facts caption").innerText(), /^box\.signs in f32, judged by the closed solid/);
    await page.selectOption("#pick-judged", "open");
    assert.match(await page.locator("#sweep-facts caption").innerText(), /judged by the open solid/);
    assert.deepEqual(
        page.complaints.filter((c) => !c.startsWith("Canvas2D")), []);  // that one is about reading pixels back, here
}

module.exports = {
    planes,
    cases,
    walk
};
