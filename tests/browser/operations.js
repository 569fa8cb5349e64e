// Promises about the rays whose operations the page holds: their choice, the way to them, and that the page shows the
// same as `lostbits explain` for the same ray.
"use strict";

const assert = require("node:assert/strict");
const { readNumber } = require("./files.js");
const { settled, stateOf } = require("./browser.js");

const size = "24x18";

/**
 * Arguments of a page with forms of spheres and boxes, formats of every engine, cameras of every kind, and inputs both
 * shared and own.
 */
const taped = [
    ...["near-benign", "rtg-fig-7-4.r1e6", "camera-inside", "world-offset-own", "raycast-course.small", "box-octree"],
    ...["sphere.schoolbook", "sphere.expanded", "sphere.unit_half_b", "sphere.early_exit", "sphere.pbrt_interval",
        "sphere.closest_approach", "sphere.newton_refined", "sphere.filtered", "box.baseline", "box.ieee_minmax",
        "box.embree_padded", "box.filtered"]
        .flatMap((form) => ["-i", form]),
    ...["-f", "f32", "-f", "f64", "-f", "bf16", "--size", size, "--no-claims"]
];

/** The held rays are the worst, the first of each wrong decision, the median, and the worst of each part. */
async function chosen({ open }) {
    const page = await open("taped");
    const seen = await page.evaluate(async () => {
        const found = { rows: 0, rays: 0, medians: 0, wrong: [] };
        for (const map of index.maps) {
            for (const row of map.rows) {
                const rays = await raysOf(map, row), pixels = await pixelsOf(map, row),
                      where = `${map.id} ${keyOf(row)}`;
                const held = (x, y) => rays.find(isAt(x, y)),
                      complain = (what) => found.wrong.push(`${where}: ${what}`);
                const isWrong = (i) => ![0, 1, 5, 9].includes(pixels.outcome[i]);
                const sizes = Array.from(
                    pixels.outcome,
                    (o, i) =>
                        (isWrong(i)         ? Infinity :
                             o === agreeHit ? Math.fround(Math.abs(derived.ulp_error(sampleAt(pixels, i)))) :
                                              -1));
                ++found.rows;
                found.rays += rays.length;
                if (new Set(rays.map((r) => `${r.x},${r.y}`)).size !== rays.length) complain("a ray is held twice");
                if (row.worst && !isAt(row.worst.x, row.worst.y)(rays[0])) complain("the worst ray is not the first");
                for (const [o, [name]] of index.outcomes.entries()) {
                    const first = pixels.outcome.indexOf(o);
                    if (first < 0 || !isWrong(first)) continue;
                    const ray = held(first % map.width, Math.floor(first / map.width));
                    if (!ray?.why.includes(`${name}: the first`)) complain(`the first ${name} is not held`);
                }
                const hits = sizes.filter((s, i) => pixels.outcome[i] === agreeHit && Number.isFinite(s));
                const median = rays.find((r) => r.why.includes("median error"));
                if ((median !== undefined) !== hits.length > 0) complain("the median");
                if (median) {
                    const middle = sizes[median.y * map.width + median.x];
                    const below = hits.filter((s) => s < middle * (1 - 1e-6) - 1e-6).length,
                          above = hits.filter((s) => s > middle * (1 + 1e-6) + 1e-6).length;
                    found.medians += middle > 0;
                    if (2 * below > hits.length || 2 * above > hits.length) complain(`${middle} is not the median`);
                }
                for (let part = 0; part < 16; ++part) {
                    const inPart = (x, y) => Math.floor(4 * (x + 0.5) / map.width) === part % 4 &&
                        Math.floor(4 * (y + 0.5) / map.height) === part >> 2;
                    const worst =
                        Math.max(...sizes.map((s, i) => (inPart(i % map.width, Math.floor(i / map.width)) ? s : -1)));
                    const best =
                        Math.max(-1, ...rays.filter((r) => inPart(r.x, r.y)).map((r) => sizes[r.y * map.width + r.x]));
                    if (worst === Infinity ? best !== worst : best < worst * (1 - 1e-6) - 1e-6)
                        complain(`part ${part}: ${best} is held of ${worst}`);
                }
            }
        }
        return found;
    });
    assert.deepEqual(seen.wrong, []);
    // A map of few rays names the culprit of each ray by default.
    const culprits = await page.evaluate(
        async () => (await pixelsOf(index.maps[0], index.maps[0].rows[0])).stored.culprit.filter((c) => c > 0).length);
    assert.ok(culprits > 20, `${culprits} culprits`);
    assert.ok(seen.rows > 100 && seen.rays > 1000 && seen.medians > 75, JSON.stringify(seen));
}

/** Rays of a page with everything that is shown of each: sentences, cells, exact values, marks. */
const shownOf = (page, every) => page.evaluate(async (every) => {
    const picked = [];
    let k = 0;
    for (const map of index.maps) {
        for (const row of map.rows) {
            const rays = await raysOf(map, row);
            if (rays.length === 0 || k++ % every !== 0) continue;
            const ray = rays[k % rays.length], shown = document.createElement("div");
            shown.append(...operationTable(row, ray));
            picked.push({
                id: map.id,
                form: row.form,
                format: row.format,
                x: ray.x,
                y: ray.y,
                caption: shown.querySelector("caption").textContent,
                sentences: [...shown.querySelectorAll(".sentence")].map((e) => e.textContent),
                rows: [...shown.querySelectorAll("tbody tr")].map((e) => ({
                                                                      node: Number(e.dataset.node),
                                                                      culprit: e.className === "culprit",
                                                                      cells: [...e.children].map((c) => c.textContent),
                                                                      exactly: e.children[2].title,
                                                                      meant: e.children[3].title
                                                                  }))
            });
        }
    }
    return picked;
}, every);

/** Compares a row of the page with the operation in the JSON, bit by bit, and with the line of the text. */
function compare(row, operation, line, where) {
    const [name, , computed, exact, off, cancelled, local, own, share] = row.cells, place = `${where}, ${name}`;
    if (typeof operation.computed === "boolean")
        return assert.deepEqual([computed, exact], [String(operation.computed), String(operation.exact)], place);
    assert.equal(row.exactly, operation.computed.hex.replace("-nan", "nan"), place);
    assert.ok(Object.is(readNumber(row.meant), readNumber(operation.exact)), `${place}: ${row.meant}`);
    const digits = 1 + Math.ceil(operation.precision * 0.30103),
          close = (text, x) =>
              Object.is(readNumber(text), x) || Math.abs(Number(text) - x) <= 10 ** (1 - digits) * Math.abs(x);
    assert.ok(close(computed, readNumber(operation.computed.decimal)), `${place}: ${computed}`);
    assert.ok(close(exact, readNumber(operation.exact)), `${place}: ${exact}`);
    if (line.includes("(an earlier sample)")) return undefined;
    assert.equal(
        cancelled, operation.cancelled_bits === 0 ? "" : `${operation.cancelled_bits} ${operation.cancellation}`,
        place);
    assert.equal(row.culprit, line.startsWith("*"), `${place}: culprit`);
    const tail = [off, cancelled, local, own, share].filter((text) => text !== "").join(" ");
    const told = line.replace(/ {2}(rounding chose the other side|on purpose)$/, "").split(/\s+/).join(" ");
    assert.ok(told.endsWith(` ${tail}`), `${place}: ${tail}\n${line}`);
    return assert.equal(
        operation.turned && operation.rounding !== 0, row.cells[1].endsWith("chose the other side"), place);
}

/** Compares a ray's table and sentences with the text and the JSON of `explain`. Returns its number of operations. */
function hold(ray, lostbits, options) {
    const where = `${ray.id} --pixel ${ray.x},${ray.y} -i ${ray.form} -f ${ray.format}`;
    const asked = ["explain", ray.id, ...options, "--pixel", `${ray.x},${ray.y}`, "-i", ray.form, "-f", ray.format];
    const text = lostbits(...asked), { operations } = JSON.parse(lostbits(...asked, "--json"));
    // The page tries no other forms, so it names none that do better.
    const lines = text.replace(/\n {54}/g, "   ").replaceAll(" Other forms do better (see below).", "").split("\n");
    const table =
        lines.slice(lines.findIndex((line) => line.startsWith("  operation ")) + 1).filter((line) => / = /.test(line));
    assert.equal(ray.caption, `The ray of pixel ${ray.x}, ${ray.y}`);
    assert.ok(ray.sentences.length >= 3, where);
    for (const sentence of ray.sentences) assert.ok(lines.includes(sentence), `${where}: ${sentence}`);
    ray.rows.forEach((row, k) => {
        assert.ok(table[k].slice(2).startsWith(`${row.cells[0]} `), `${where}: ${row.cells[0]} beside ${table[k]}`);
        compare(row, operations[row.node], table[k], where);
    });
    return ray.rows.length;
}

/** The page shows the same about a held ray as `lostbits explain`, bit by bit. */
async function table({ open, lostbits }) {
    let operations = 0, culprits = 0, turned = 0;
    const rays = await shownOf(await open("taped"), 4);
    assert.ok(rays.length > 30, `${rays.length} rays`);
    for (const ray of rays) {
        operations += hold(ray, lostbits, ["--size", size]);
        culprits += ray.rows.some((row) => row.culprit);
        turned += ray.sentences.some((sentence) => sentence.startsWith("Rounding changed"));
    }
    assert.ok(operations > 300 && culprits > 10 && turned > 2, `${operations}, ${culprits}, ${turned}`);
    const marches = (await shownOf(await open("small"), 1)).filter((ray) => ray.form.startsWith("sdf."));
    assert.ok(marches.length > 0);
    for (const ray of marches) assert.ok(hold(ray, lostbits, ["--size", "72x56"]) > 5);
}

const oblique = "#scene=rtg-fig-7-3-4100-oblique&form=sphere.schoolbook&format=f32";

/** The mouse and the keyboard reach every held ray, and the table says to which ray it belongs. */
async function reach({ open, lostbits }) {
    const page = await open("report", { hash: oblique });
    const rays = await page.evaluate(() => raysOf(mapNow(), rowNow())), [first] = rays;
    assert.ok(rays.length > 4, `${rays.length} rays`);
    const isShown = async ({ x, y }) => {
        await page.waitForFunction((at) => document.getElementById("operations").dataset.pixel === at, `${x},${y}`);
        assert.deepEqual([(await stateOf(page)).x, (await stateOf(page)).y], [x, y]);
        const shown = page.locator("#operations");
        assert.ok((await shown.locator("h3").innerText()).includes(`pixel ${x}, ${y} (`));
        assert.equal(await shown.locator("caption").innerText(), `The ray of pixel ${x}, ${y}`);
        assert.ok((await shown.locator("#pick-ray option:checked").innerText()).startsWith(`${x}, ${y}: `));
        assert.match(await page.locator("#inspector h3").innerText(), new RegExp(`Pixel ${x}, ${y}$`));
    };
    for (let k = (rays.length - 1) % 3; k < rays.length; k += 3) {  // includes the last one
        await page.selectOption("#pick-ray", String(k));
        await isShown(rays[k]);
    }
    for (const ray of [...rays, first]) {
        await page.locator("#map").press("n");
        await isShown(ray);
    }
    await page.locator("#map").press("N");
    await isShown(rays.at(-1));
    await page.selectOption("#pick-ray", "0");
    await isShown(first);
    await page.locator("#pick-ray").focus();
    for (const ray of rays.slice(1, 3)) {
        await page.keyboard.press("ArrowDown");  // to the next ray
        await isShown(ray);
        assert.equal(await page.evaluate(() => document.activeElement.id), "pick-ray");
    }
    // Another pixel has no table, but a link to the nearest one that has, and the command.
    const beside = rays.some((r) => r.x === first.x + 1 && r.y === first.y) ? -1 : 1;
    await page.evaluate(([x, y]) => goTo({ x, y }), [first.x + beside, first.y]);
    await settled(page);
    assert.equal(await page.locator("#operations table").count(), 0);
    const text = await page.locator("#operations p").innerText();
    assert.ok(text.includes(`does not hold the operations of pixel ${first.x + beside}, ${first.y}.`), text);
    assert.match(text, /The nearest ray whose operations it holds is 1 pixel away: pixel \d+, \d+ \(/);
    await page.locator("#copy-elsewhere").click();
    const command = await page.locator("#map-view pre.copied").innerText();
    assert.match(lostbits(...command.split(" ").slice(1)), /^sphere\.schoolbook in f32/);
    await page.locator("#nearest-ray").click();
    await settled(page);
    const now = await stateOf(page);
    assert.ok(text.includes(`1 pixel away: pixel ${now.x}, ${now.y} (`), `${now.x}, ${now.y}: ${text}`);
    assert.equal(await page.locator("#operations table").count(), 1);
    // A link restores the table. A link to a pixel beside it restores the text that is shown there.
    const again = await open("report", { hash: `${oblique}&x=${first.x}&y=${first.y}` });
    await again.locator("#operations table").waitFor();
    assert.equal(await again.locator("#operations caption").innerText(), `The ray of pixel ${first.x}, ${first.y}`);
}

exports.taped = taped;
exports.promises = {
    chosen,
    table,
    reach
};
