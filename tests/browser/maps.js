// Promises of the page about maps. A browser compares every pixel, colour and key with files that other commands wrote.
"use strict";

const assert = require("node:assert/strict");
const { follow, near, schoolbook, settled, stateOf } = require("./browser.js");
const { liesIn, readCsv, readNumber } = require("./files.js");

/** Every pixel of every row equals that of the CSV. */
async function pixels({ open, at }) {
    const page = await open("small");
    const maps = await page.evaluate(
        () => index.maps.map((m) => ({
                                 id: m.id,
                                 rows: m.rows.map((r) => [r.form, r.format]),
                                 metrics: m.metrics.map((x) => [x.name, x.categories?.map((c) => c[0])])
                             })));
    const compared = {};
    for (const map of maps) {
        for (const [form, format] of map.rows) {
            const csv = readCsv(at(`map/${map.id}/${form}.${format}.csv`));
            const shown = JSON.parse(await page.evaluate(async ([id, form, format]) => {
                const map = index.maps.find((m) => m.id === id),
                      p = await pixelsOf(map, map.rows.find((r) => r.form === form && r.format === format));
                return JSON.stringify(Array.from(p.outcome, (outcome, i) => {
                    const hit = p.object[i] > 0, truly = p.truth.decision[i] === 1;
                    const texts = [
                        outcomeNames[outcome], hit ? p.object[i] - 1 : "", hit ? decimal(p.t[i]) : "",
                        hit ? hex(p.t[i]) : "", truly ? p.truth.object[i] - 1 : "",
                        truly ? decimal(p.truth.truth[i]) : "", truly ? hex(p.truth.truth[i]) : ""
                    ];
                    return [texts.join(" "), map.metrics.map((m) => decimal(valueAt(p, m, i)))];
                }));
            }, [map.id, form, format]));
            assert.equal(shown.length, csv.length);
            csv.forEach((row, i) => {
                const [texts, values] = shown[i];
                const where = () => `${map.id} ${form} ${format} pixel ${row.x}, ${row.y}`;
                assert.ok(
                    texts ===
                        [row.outcome, row.object, row.t, row.t_hex, row.truth_object, row.truth, row.truth_hex].join(
                            " "),
                    `${where()}: ${texts}; the CSV has ${Object.values(row).join(" ")}`);
                map.metrics.forEach(([metric, categories], m) => {
                    if (row[metric] === undefined) return;
                    // Tables put an apostrophe before text that a spreadsheet would take for a formula.
                    const word = row[metric].replace(/^'/, "");
                    const expected = categories && word !== "" ? categories.indexOf(word) : readNumber(row[metric]);
                    assert.ok(
                        near(readNumber(values[m]), expected),
                        `${where()}: ${metric} is ${values[m]}, the CSV has ${row[metric]}`);
                    compared[metric] = (compared[metric] ?? 0) + !Number.isNaN(expected);
                });
            });
        }
    }
    for (const metric
             of ["lost_bits", "ulp_error", "relative_error", "residual", "condition", "inherent_bits", "excess_bits",
                 "culprit", "iterations", "stop"])
        assert.ok(compared[metric] > 1000, `${metric}: ${compared[metric]} compared`);
}

/** The field on the page equals the field in the PNG, colour by colour, whatever is around it there. */
async function colours({ open, at }) {
    const page = await open("small");
    const cases = [
        ["near-benign", "sphere.schoolbook", "bf16", "lost_bits"],
        ["near-benign", "sphere.unified", "f32", "ulp_error"], ["near-benign", "sphere.unified", "f32", "culprit"],
        ["near-benign", "sphere.schoolbook", "bf16", "culprit"], ["sdf-sphere", "sdf.sphere_trace", "f32", "stop"],
        ["sdf-sphere", "sdf.sphere_trace", "f32", "iterations"]
    ];
    for (const [id, form, format, metric] of cases) {
        const { columns, rgb } = await page.evaluate(async ([id, form, format, metric]) => {
            const map = index.maps.find((m) => m.id === id),
                  row = map.rows.find((r) => r.form === form && r.format === format);
            const canvas = paint(map, await pixelsOf(map, row), map.metrics.find((m) => m.name === metric)),
                  { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height), rgb = [];
            for (let i = 0; i < data.length; i += 4) rgb.push((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
            return { columns: canvas.width, rgb };
        }, [id, form, format, metric]);
        const png = at(`pictures/${id}/${form}.${format}.${metric}.png`), w = Math.ceil(384 / columns);
        // The page keeps ulp and kappa as floats, so a value may fall on the other side of a border between two
        // colours.
        assert.ok(
            await liesIn(page, png, rgb, [{ columns, w, h: w, at: 0 }], rgb.length * 1e-4),
            `${id} ${form} ${format} ${metric}: other colours than in the PNG`);
    }
}

/** The inspector of a pixel shows the row of the CSV. The large picture has the pixel's colour. */
async function inspector({ open, at }) {
    const csv = readCsv(at("map/near-benign/sphere.schoolbook.f32.csv")),
          wide = readCsv(at("map/near-benign/sphere.schoolbook.f64.csv"));
    const i = csv.findIndex((row) => row.outcome === "agree_hit" && Number(row.lost_bits) > 4), { x, y } = csv[i];
    const page = await open("small", { hash: `${schoolbook}&metric=lost_bits&x=${x}&y=${y}` });
    const text = await page.locator("#inspector").innerText();
    for (const expected
             of [`Pixel ${x}, ${y}`, "correct hit", csv[i].t, csv[i].t_hex, csv[i].truth, csv[i].truth_hex, wide[i].t,
                 wide[i].t_hex, Number(csv[i].lost_bits).toFixed(2), "within 2^"]) {
        assert.ok(text.includes(expected), `the inspector lacks ${expected}: ${text}`);
    }
    for (const metric of ["ulp_error", "relative_error", "condition", "excess_bits", "residual"]) {
        const shown = await page.locator(`#inspector tr[data-metric=${metric}] td`).innerText();
        assert.ok(
            near(parseFloat(shown), Number(csv[i][metric])), `${metric}: ${shown}, the CSV has ${csv[i][metric]}`);
    }
    const miss = csv.find((row) => row.outcome === "agree_miss");
    await page.evaluate(([x, y]) => goTo({ x, y }), [Number(miss.x), Number(miss.y)]);
    assert.match(await page.locator("#inspector").innerText(), /truly misses/);
    // A click chooses the pixel under it. A line says when the pointer is on another one.
    const box = await page.locator("#map").boundingBox();
    await page.mouse.click(box.x + box.width * 0.25, box.y + box.height * 0.5);
    const chosen = await stateOf(page);
    assert.ok(
        Math.abs(chosen.x - 18) <= 1 && Math.abs(chosen.y - 28) <= 1,
        `clicked a quarter in and half down of 72 x 56, chosen ${chosen.x}, ${chosen.y}`);
    await page.mouse.move(box.x + box.width * 0.75, box.y + box.height * 0.5);
    await settled(page);
    assert.match(await page.locator("#under").innerText(), /^5[345], 2[789]: /);
}

async function keyboard({ open }) {
    const page = await open("report", { hash: `${schoolbook}&x=10&y=20` });
    const press = async (key) => {
        await page.locator("#map").press(key);
        await settled(page);
        return stateOf(page);
    };
    assert.equal((await press("ArrowRight")).x, 11);
    assert.equal((await press("ArrowUp")).y, 19);
    assert.match(await page.locator("#inspector h3").innerText(), /Pixel 11, 19/);
    assert.notEqual((await press("m")).metric, "lost_bits");
    assert.equal((await press("M")).metric, "lost_bits");
    assert.equal((await press("]")).form, "sphere.unit_half_b");
    assert.equal((await press("[")).form, "sphere.schoolbook");
    assert.equal((await press("+")).zoom, 2);
    assert.equal((await press("0")).zoom, 1);
    const worst = await press("w");
    assert.deepEqual({ x: worst.x, y: worst.y }, await page.evaluate(() => ({...rowNow().worst })));
    assert.equal((await press("Escape")).x, -1);
    // Tab reaches the pickers, the picture and the buttons. Each has a name.
    const unnamed = await page.evaluate(
        () => [...document.querySelectorAll("button, select, input, canvas[tabindex]")]
                  .filter(
                      (e) => !(e.textContent.trim() || e.labels?.length || e.ariaLabel || e.getAttribute("aria-label")))
                  .length);
    assert.equal(unnamed, 0);
    await follow(page, schoolbook);
    await zoom(page);
}

/** The small pictures show the same part as the large one. */
async function zoom(page) {
    const pane = (key) =>
              page.evaluate((key) => document.querySelector(`.pane[data-row="${key}"] canvas`).toDataURL(), key),
          before = await pane("sphere.unified.f64");
    await page.$eval("#map", (e) => e.scrollIntoView());
    const box = await page.locator("#map").boundingBox();
    await page.mouse.move(box.x + box.width * 0.75, box.y + box.height * 0.25);
    for (let k = 0; k < 4; ++k) await page.mouse.wheel(0, -100);
    await settled(page);
    const now = await stateOf(page);
    assert.ok(near(now.zoom, 1.5 ** 4) && now.cx > 0.6 && now.cy < 0.4, JSON.stringify(now));
    const expected = await page.evaluate(async () => {
        const map = mapNow(), row = map.rows.find((r) => keyOf(r) === "sphere.unified.f64"),
              { canvas } = paneParts.cells.get(keyOf(row)), copy = document.createElement("canvas");
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const w = map.width / state.zoom, h = map.height / state.zoom, context = copy.getContext("2d");
        context.imageSmoothingEnabled = false;
        context.drawImage(
            paint(map, await pixelsOf(map, row), metricNow()), state.cx * map.width - w / 2,
            state.cy * map.height - h / 2, w, h, 0, 0, copy.width, copy.height);
        return copy.toDataURL();
    });
    assert.notEqual(await pane("sphere.unified.f64"), before);
    assert.equal(await pane("sphere.unified.f64"), expected);
    await page.locator(".pane[data-row=\"sphere.unified.f64\"] b").click();
    assert.equal((await stateOf(page)).format, "f64");
}

/** The picture shows one form left of the border and the other right of it. */
async function compare({ open }) {
    const page = await open("report", { hash: `${schoolbook}&other=sphere.unified.f32&split=0.5` });
    const differing = () => page.evaluate(async () => {
        const map = mapNow(), shown = document.getElementById("map"), factor = shown.width / map.width,
              data = shown.getContext("2d").getImageData(0, 0, shown.width, shown.height).data;
        const fields = [];
        for (const row of [rowNow(), otherRow()])
            fields.push(paint(map, await pixelsOf(map, row), metricNow())
                            .getContext("2d")
                            .getImageData(0, 0, map.width, map.height)
                            .data);
        let wrong = 0;
        for (let i = 0; i < map.width * map.height; ++i) {
            const x = i % map.width, y = Math.floor(i / map.width), from = fields[x < state.split * map.width ? 0 : 1];
            if (Math.abs(x - state.split * map.width) < 3) continue;  // the line between them
            for (let k = 0; k < 3; ++k)
                wrong += data[4 * (y * factor * shown.width + x * factor) + k] !== from[4 * i + k];
        }
        return wrong;
    });
    assert.equal(await differing(), 0);
    await page.locator("#split").fill("0.25");
    await settled(page);
    assert.equal((await stateOf(page)).split, 0.25);
    assert.equal(await differing(), 0);
}

exports.promises = {
    pixels,
    colours,
    inspector,
    keyboard,
    compare
};
