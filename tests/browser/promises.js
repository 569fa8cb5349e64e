// What the page promises, each held by a browser against files that other commands wrote.
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { readCsv, readNumber, readPng } = require("./files.js");

const schoolbook = "#scene=near-benign&form=sphere.schoolbook&format=f32";
const stateOf = (page) => page.evaluate(() => ({ ...state }));
const settled = (page) => page.evaluate(() => new Promise((done) => setTimeout(done, 150)));
/** To six digits, and for ulps to a millionth: the page keeps t* - RN64(t*) as a float. */
const near = (a, b) => a === b || (Number.isNaN(a) && Number.isNaN(b)) || Math.abs(a - b) <= 1e-6 + 1e-6 * Math.abs(b);

/** No request, no complaint, and the policy forbids both scripts and requests of others. */
async function alone({ browser, report }) {
    const page = await browser.page(report);
    for (const key of ["m", "]", "ArrowRight", "+"]) await page.locator("#map").press(key);
    await settled(page);
    assert.deepEqual(page.requested.filter((url) => !url.startsWith("data:")), [page.url().replace(/#.*/, "")]);
    assert.deepEqual(page.complaints, []);
    const refused = await page.evaluate(async () => {
        window.ran = false;
        document.body.append(Object.assign(document.createElement("script"), { textContent: "window.ran = true;" }));
        const fetched = await fetch(location.href).then(() => true, () => false);
        return { ran: window.ran, fetched };
    });
    assert.deepEqual(refused, { ran: false, fetched: false });
}

/** Every pixel of every row is what the CSV says. */
async function pixels({ browser, small, at }) {
    const page = await browser.page(small);
    const maps = await page.evaluate(() => index.maps.map((m) => ({ id: m.id, rows: m.rows.map((r) => [r.form, r.format]), metrics: m.metrics.map((x) => [x.name, x.categories?.map((c) => c[0])]) })));
    const compared = {};
    for (const map of maps) {
        for (const [form, format] of map.rows) {
            const csv = readCsv(at(`map/${map.id}/${form}.${format}.csv`));
            const shown = JSON.parse(await page.evaluate(async ([id, form, format]) => {
                const map = index.maps.find((m) => m.id === id), p = await pixelsOf(map, map.rows.find((r) => r.form === form && r.format === format));
                return JSON.stringify(Array.from(p.outcome, (outcome, i) => {
                    const hit = p.object[i] > 0, truly = p.truth.decision[i] === 1;
                    const texts = [outcomeNames[outcome], hit ? p.object[i] - 1 : "", hit ? decimal(p.t[i]) : "", hit ? hex(p.t[i]) : "", truly ? p.truth.object[i] - 1 : "",
                        truly ? decimal(p.truth.truth[i]) : "", truly ? hex(p.truth.truth[i]) : ""];
                    return [texts.join(" "), map.metrics.map((m) => decimal(valueAt(p, m, i)))];
                }));
            }, [map.id, form, format]));
            assert.equal(shown.length, csv.length);
            csv.forEach((row, i) => {
                const [texts, values] = shown[i];
                const where = () => `${map.id} ${form} ${format} pixel ${row.x}, ${row.y}`;
                assert.ok(texts === [row.outcome, row.object, row.t, row.t_hex, row.truth_object, row.truth, row.truth_hex].join(" "), `${where()}: ${texts}; the CSV has ${Object.values(row).join(" ")}`);
                map.metrics.forEach(([metric, categories], m) => {
                    if (row[metric] === undefined) return;
                    const expected = categories && row[metric] !== "" ? categories.indexOf(row[metric]) : readNumber(row[metric]);
                    assert.ok(near(readNumber(values[m]), expected), `${where()}: ${metric} is ${values[m]}, the CSV has ${row[metric]}`);
                    compared[metric] = (compared[metric] ?? 0) + !Number.isNaN(expected);
                });
            });
        }
    }
    for (const metric of ["lost_bits", "ulp_error", "relative_error", "residual", "condition", "inherent_bits", "excess_bits", "iterations", "stop"]) assert.ok(compared[metric] > 1000, `${metric}: ${compared[metric]} compared`);
}

/** The field on the page is the field in the PNG, colour by colour, whatever is around it there. */
async function colours({ browser, small, at }) {
    const page = await browser.page(small);
    const cases = [["near-benign", "sphere.schoolbook", "bf16", "lost_bits"], ["world-offset", "sphere.unified", "f32", "ulp_error"], ["near-benign", "sphere.unified", "f64", "excess_bits"],
        ["sdf-sphere", "sdf.sphere_trace", "f32", "stop"], ["sdf-sphere", "sdf.sphere_trace", "f32", "iterations"]];
    for (const [id, form, format, metric] of cases) {
        const field = await page.evaluate(async ([id, form, format, metric]) => {
            const map = index.maps.find((m) => m.id === id), row = map.rows.find((r) => r.form === form && r.format === format);
            const canvas = paint(map, await pixelsOf(map, row), map.metrics.find((m) => m.name === metric)), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height), rgb = [];
            for (let i = 0; i < data.length; i += 4) rgb.push((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
            return { width: canvas.width, height: canvas.height, rgb };
        }, [id, form, format, metric]);
        const png = readPng(at(`map/${id}/${form}.${format}.${metric}.png`)), factor = Math.max(1, Math.ceil(384 / field.width));
        let best = Infinity;  // over the places where the field may lie in the picture
        for (let y0 = 0; y0 + field.height * factor <= png.height && best > 0; ++y0) {
            for (let x0 = 0; x0 < 40; ++x0) {
                let wrong = 0;
                for (let i = 0; i < field.rgb.length && wrong < best; ++i) {
                    if (png.at(x0 + (i % field.width) * factor, y0 + Math.floor(i / field.width) * factor) !== field.rgb[i]) ++wrong;
                }
                best = Math.min(best, wrong);
            }
        }
        // ulp and kappa are floats on the page: a value may stand on the other side of the border between two steps of the ramp.
        assert.ok(best <= field.rgb.length * 1e-4, `${id} ${form} ${format} ${metric}: ${best} of ${field.rgb.length} pixels have another colour than in the PNG`);
    }
}

/** The inspector of a pixel is the row of the CSV; the large picture has the pixel's colour. */
async function inspector({ browser, small, at }) {
    const csv = readCsv(at("map/near-benign/sphere.schoolbook.f32.csv")), wide = readCsv(at("map/near-benign/sphere.schoolbook.f64.csv"));
    const i = csv.findIndex((row) => row.outcome === "agree_hit" && Number(row.lost_bits) > 4), { x, y } = csv[i];
    const page = await browser.page(small, { hash: `${schoolbook}&metric=lost_bits&x=${x}&y=${y}` });
    const text = await page.locator("#inspector").innerText();
    for (const expected of [`Pixel ${x}, ${y}`, "agree hit", csv[i].t, csv[i].t_hex, csv[i].truth, csv[i].truth_hex, wide[i].t, wide[i].t_hex, Number(csv[i].lost_bits).toFixed(2), "within 2^"]) {
        assert.ok(text.includes(expected), `the inspector lacks ${expected}: ${text}`);
    }
    for (const metric of ["ulp_error", "relative_error", "condition", "excess_bits", "residual"]) {
        const shown = await page.locator(`#inspector tr[data-metric=${metric}] td`).innerText();
        assert.ok(near(parseFloat(shown), Number(csv[i][metric])), `${metric}: ${shown}, the CSV has ${csv[i][metric]}`);
    }
    const miss = csv.find((row) => row.outcome === "agree_miss");
    await page.evaluate(([x, y]) => look({ x, y }), [Number(miss.x), Number(miss.y)]);
    assert.match(await page.locator("#inspector").innerText(), /truly misses/);
    // A click chooses what lies under it; pointing at something else says so in a line.
    const box = await page.locator("#map").boundingBox();
    await page.mouse.click(box.x + box.width * 0.25, box.y + box.height * 0.5);
    const chosen = await stateOf(page);
    assert.ok(Math.abs(chosen.x - 18) <= 1 && Math.abs(chosen.y - 28) <= 1, `clicked a quarter in and half down of 72 x 56, chosen ${chosen.x}, ${chosen.y}`);
    await page.mouse.move(box.x + box.width * 0.75, box.y + box.height * 0.5);
    await settled(page);
    assert.match(await page.locator("#under").innerText(), /^5[345], 2[789]: /);
}

async function keyboard({ browser, report }) {
    const page = await browser.page(report, { hash: `${schoolbook}&x=10&y=20` });
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
    assert.deepEqual({ x: worst.x, y: worst.y }, await page.evaluate(() => ({ ...rowNow().worst })));
    assert.equal((await press("Escape")).x, -1);
    // Tab reaches the pickers, the picture and the buttons; each has a name.
    const unnamed = await page.evaluate(() => [...document.querySelectorAll("button, select, input, canvas[tabindex]")].filter((e) => !(e.textContent.trim() || e.labels?.length || e.ariaLabel || e.getAttribute("aria-label"))).length);
    assert.equal(unnamed, 0);
}

/** A link restores the view, one to what is not there says so, and backwards goes back. */
async function link({ browser, report }) {
    const page = await browser.page(report, { hash: `${schoolbook}&metric=ulp_error&other=sphere.unified.f64&split=0.3&x=100&y=90&zoom=3.375&cx=0.4&cy=0.3&sweep=sphere-tilt&statistic=lost_bits_max` });
    await page.locator("#map").press("ArrowDown");
    await settled(page);
    const picture = () => document.getElementById("map").toDataURL(), before = await stateOf(page);
    const again = await browser.page(report, { hash: await page.evaluate(() => location.hash) });
    assert.deepEqual(await stateOf(again), before);
    assert.equal(await again.evaluate(picture), await page.evaluate(picture));
    assert.equal(await again.locator("#pick-statistic").inputValue(), "lost_bits_max");
    const wrong = await browser.page(report, { hash: "#scene=nowhere&x=5&y=5" });
    assert.match(await wrong.locator("#note").innerText(), /scene "nowhere" is not on this page/);
    assert.deepEqual(wrong.complaints, []);
}

/** The small pictures show the part that the large one shows. */
async function zoom({ browser, report }) {
    const page = await browser.page(report, { hash: schoolbook });
    await settled(page);
    const pane = (key) => page.evaluate((key) => document.querySelector(`.pane[data-row="${key}"] canvas`).toDataURL(), key), before = await pane("sphere.unified.f64");
    const box = await page.locator("#map").boundingBox();
    await page.mouse.move(box.x + box.width * 0.75, box.y + box.height * 0.25);
    for (let k = 0; k < 4; ++k) await page.mouse.wheel(0, -100);
    await settled(page);
    const now = await stateOf(page);
    assert.ok(near(now.zoom, 1.5 ** 4) && now.cx > 0.6 && now.cy < 0.4, JSON.stringify(now));
    const expected = await page.evaluate(async () => {
        const map = mapNow(), row = map.rows.find((r) => keyOf(r) === "sphere.unified.f64"), { canvas } = paneParts.cells.get(keyOf(row)), copy = document.createElement("canvas");
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const w = map.width / state.zoom, h = map.height / state.zoom, context = copy.getContext("2d");
        context.imageSmoothingEnabled = false;
        context.drawImage(paint(map, await pixelsOf(map, row), metricNow()), state.cx * map.width - w / 2, state.cy * map.height - h / 2, w, h, 0, 0, copy.width, copy.height);
        return copy.toDataURL();
    });
    assert.notEqual(await pane("sphere.unified.f64"), before);
    assert.equal(await pane("sphere.unified.f64"), expected);
    await page.locator('.pane[data-row="sphere.unified.f64"] b').click();
    assert.equal((await stateOf(page)).format, "f64");
}

/** Left of the border the one form, right of it the other. */
async function compare({ browser, report }) {
    const page = await browser.page(report, { hash: `${schoolbook}&other=sphere.unified.f32&split=0.5` });
    const differing = () => page.evaluate(async () => {
        const map = mapNow(), shown = document.getElementById("map"), factor = shown.width / map.width, data = shown.getContext("2d").getImageData(0, 0, shown.width, shown.height).data;
        const fields = [];
        for (const row of [rowNow(), otherRow()]) fields.push(paint(map, await pixelsOf(map, row), metricNow()).getContext("2d").getImageData(0, 0, map.width, map.height).data);
        let wrong = 0;
        for (let i = 0; i < map.width * map.height; ++i) {
            const x = i % map.width, y = Math.floor(i / map.width), from = fields[x < state.split * map.width ? 0 : 1];
            if (Math.abs(x - state.split * map.width) < 3) continue;  // the line between them
            for (let k = 0; k < 3; ++k) wrong += data[4 * (y * factor * shown.width + x * factor) + k] !== from[4 * i + k];
        }
        return wrong;
    });
    assert.equal(await differing(), 0);
    await page.locator("#split").fill("0.25");
    await settled(page);
    assert.equal((await stateOf(page)).split, 0.25);
    assert.equal(await differing(), 0);
}

/** The plot's numbers are those of samples.csv, and a line leads to its form's map. */
async function sweeps({ browser, report, at, sweep }) {
    const page = await browser.page(report, { hash: `#sweep=${sweep}` });
    assert.ok(await page.locator("#sweep-plot canvas").count() > 0, "no plot");
    const csv = readCsv(at(`sweep/${sweep}/samples.csv`)), plotted = await page.evaluate((id) => sweepOf(id), sweep);
    assert.equal(plotted.rows.length * plotted.steps.length, csv.length);
    let compared = 0;
    for (const sample of csv) {
        const row = plotted.rows.find((r) => r.form === sample.form && r.format === sample.format), k = plotted.steps.indexOf(Number(sample[plotted.axis]));
        plotted.statistics.forEach((statistic, s) => {
            const cell = sample[statistic];
            assert.equal(String(row.values[s][k]), cell === "" ? "null" : String(Number(cell)), `${sample.form} ${sample.format} ${statistic} at ${sample[plotted.axis]}`);
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
}

async function trade({ browser, report }) {
    const page = await browser.page(report, { hash: "#shape=sphere" });
    assert.ok(await page.locator("#trade-plot canvas").count() > 0, "no plot");
    const place = await page.evaluate(() => {
        const p = tradeParts.points.find((q) => q.name === "sphere.unified" && !q.dominated) ?? tradeParts.points[0], box = document.querySelector("#trade-plot .u-over").getBoundingClientRect();
        return { name: p.name, x: box.left + tradeParts.plot.valToPos(p.time_ns, "x"), y: box.top + tradeParts.plot.valToPos(p.kept_bits, "y") };
    });
    await page.evaluate(() => document.getElementById("trade-plot").scrollIntoView());
    const box = await page.locator("#trade-plot .u-over").boundingBox();
    const local = await page.evaluate((name) => {
        const p = tradeParts.points.find((q) => q.name === name);
        return { x: tradeParts.plot.valToPos(p.time_ns, "x"), y: tradeParts.plot.valToPos(p.kept_bits, "y") };
    }, place.name);
    await page.mouse.move(box.x + local.x, box.y + local.y);
    await settled(page);
    assert.match(await page.locator("#trade-view .hint").innerText(), /ns a ray, keeps/);
    const named = await page.evaluate(() => tradeParts.under.name);
    await page.mouse.click(box.x + local.x, box.y + local.y);
    assert.equal((await stateOf(page)).form, named);
}

/** A claim leads to its pixel or its plot; the filter leaves what it says. */
async function claims({ browser, report }) {
    const page = await browser.page(report);
    const place = page.locator("table.claims a.jump[href*='scene=near-benign']").first(), target = await place.getAttribute("href");
    await place.click();
    const now = await stateOf(page), asked = new URLSearchParams(target.slice(1));
    for (const key of ["scene", "form", "format"]) assert.equal(now[key], asked.get(key));
    if (asked.has("x")) assert.equal(String(now.x), asked.get("x"));
    await page.locator(`table.claims a.jump[href*='sweep=']`).first().click();
    assert.equal((await stateOf(page)).sweep, "sphere-tilt");
    await page.goBack();
    await settled(page);
    assert.equal((await stateOf(page)).scene, "near-benign");
    const all = await page.locator("table.claims tbody tr").count();
    await page.fill("#filter", "tilt schoolbook");
    const left = await page.locator("table.claims tbody tr:visible").count();
    assert.ok(left > 0 && left < all, `${left} of ${all}`);
}

/** What is copied runs: the command makes the map, the claims measure as stated. */
async function copies({ browser, report, lostbits }) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "lostbits-copies-"));
    try {
        const page = await browser.page(report, { hash: "#scene=rtg-fig-7-3-4100-oblique&form=sphere.schoolbook&format=f64&metric=ulp_error&sweep=sphere-tilt&statistic=lost_bits_p99" });
        const copied = async (button) => {
            await page.locator(button).click();
            return page.locator(button).evaluate((e) => e.closest("section, .side").querySelector("pre.copied").textContent);
        };
        let text = 'schema = "lostbits-claims/1"\n' + (await copied("#copy-claim"));
        await page.locator("#copy-sweep-claim").click();
        text += await page.locator("#sweep-view pre.copied").textContent();
        fs.writeFileSync(path.join(folder, "claims.toml"), text);
        assert.equal(lostbits("check", path.join(folder, "claims.toml"), "--strict"), "", text);
        const command = await copied("#copy-command");
        assert.match(command, /^lostbits map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -f f64 --metric ulp_error --pixels csv -o out$/);
        lostbits(...command.replace("-o out", `-o ${folder}/out`).split(" ").slice(1));
        assert.ok(fs.existsSync(path.join(folder, "out/rtg-fig-7-3-4100-oblique/sphere.schoolbook.f64.csv")));
    } finally {
        fs.rmSync(folder, { recursive: true });
    }
}

/** Without scripts: counts, tables and pictures are there to be read. */
async function plain({ browser, report }) {
    const page = await browser.page(report, { scripts: false });
    const text = await page.locator("body").innerText();
    assert.match(text, /\d+\s+hold/);
    assert.match(text, /\d+\s+are refuted/);
    for (const part of ["Four spheres close by", "sphere.schoolbook", "lost bits p50", "p99 loses half"]) assert.ok(text.includes(part), `"${part}" cannot be read`);
    assert.ok((await page.locator("table.claims tbody tr:visible").count()) > 0);
    assert.equal(await page.locator("#map-view:visible").count(), 0);
    const pictures = await page.locator("img:visible").count();
    assert.ok(pictures >= 4, `${pictures} pictures`);
    assert.deepEqual(page.requested.filter((url) => !url.startsWith("data:")), [page.url()]);
}

/** 512 x 512 rays with six layers: below 3 MB, and ready in a second. */
async function ready({ browser, large }) {
    const size = fs.statSync(large).size, times = [];
    for (let k = 0; k < 3; ++k) {
        const page = await browser.page(large);
        assert.deepEqual(await page.evaluate(() => [mapNow().width, mapNow().height, mapNow().metrics.length >= 6]), [512, 512, true]);
        times.push(Number(await page.evaluate(() => document.documentElement.dataset.ready)));
        await page.context().close();
    }
    console.log(`${size} bytes; ready after ${times.join(", ")} ms`);
    assert.ok(size < 3e6, `${size} bytes`);
    assert.ok(Math.min(...times) < 1000, `ready after ${times.join(", ")} ms`);
}

module.exports = { alone, pixels, colours, inspector, keyboard, link, zoom, compare, sweeps, trade, claims, copies, plain, ready };
