// The operations of a ray as the page runs them, held against the table and the JSON of `lostbits explain`.
"use strict";

const assert = require("node:assert/strict");
const { readNumber } = require("./files.js");

const scenes = [
    "near-benign", "rtg-fig-7-3-4100-oblique", "rtg-fig-7-4.r1e6", "camera-inside", "grazing", "world-offset-own",
    "raycast-course.small", "box-octree", "box-axis"
];
const size = "24x18";

/**
 * Every form of spheres and boxes, in formats of every engine, from cameras of every kind, with inputs shared and own.
 */
const pageOf = [
    "report", ...scenes, "-i", "sphere.*", "-i", "box.*", "-f", "f32", "-f", "f64", "-f", "bf16", "-f", "p9", "--size",
    size, "--no-claims"
];

/** Run again on the page, a form gives every answer to the bit. */
async function reruns({ browser, taped }) {
    const page = await browser.page(taped);
    const counts = await page.evaluate(async () => {
        const found = { rays: 0, wrong: [] };
        for (const map of index.maps) {
            for (const row of map.rows) {
                if (!row.taped) continue;
                const pixels = await pixelsOf(map, row);
                for (let i = map.rows.indexOf(row) % 19; i < map.width * map.height; i += 19) {
                    const [x, y] = [i % map.width, Math.floor(i / map.width)], { walk } = await walkOf(map, row, x, y);
                    const hit = walk.at(walk.hit).value, t = walk.at(walk.t).value;
                    ++found.rays;
                    if (hit !== pixels.object[i] > 0 || (hit && !Object.is(t, pixels.t[i])))
                        found.wrong.push(`${map.id} ${keyOf(row)} ${x}, ${y}: ${t}, not ${pixels.t[i]}`);
                }
            }
        }
        return found;
    });
    assert.ok(counts.rays > 8000, `${counts.rays} rays`);
    assert.deepEqual(counts.wrong, []);
}

/**
 * A relative 1e-12: what is beyond doubles on both sides is cut to 2048 bits, but a rounding is good to 2^-50 of
 * itself only.
 */
const agree = (a, b) =>
    Object.is(a, b) || (Number.isNaN(a) && Number.isNaN(b)) || a === b || Math.abs(a - b) <= 1e-12 * Math.abs(b);

function compare(walk, operations, where) {
    assert.equal(walk.nodes.length, operations.length, where);
    operations.forEach((o, i) => {
        const n = walk.nodes[i], place = `${where}, ${o.name} = ${o.expression}`;
        assert.equal(n.op, o.operation, place);
        assert.equal(n.turned, o.turned, `${place}: turned`);
        if (typeof o.computed === "boolean") return assert.deepEqual([n.value, n.exact], [o.computed, o.exact], place);
        assert.ok(agree(n.value, readNumber(o.computed.decimal)), `${place}: ${n.value}, not ${o.computed.decimal}`);
        assert.deepEqual([n.cancelled, n.live], [o.cancelled_bits, o.live], `${place}: cancelled, live`);
        if (n.cancelled > 0) assert.equal(n.carried, o.cancellation === "catastrophic", place);
        for (const [mine, theirs] of [
                 ["exact", "exact"], ["error", "error"], ["local", "local_error_bits"], ["rounding", "rounding"],
                 ["adjoint", "adjoint"], ["contribution", "contribution"]]) {
            assert.ok(
                agree(n[mine], readNumber(o[theirs])), `${place}: ${theirs} is ${n[mine]}, explain has ${o[theirs]}`);
        }
    });
}

/** The script knows every operation that a tape can have, and no other. */
async function rules({ browser, taped }) {
    const page = await browser.page(taped);
    const { known, all } = await page.evaluate(async () => {
        const { operations } = await tapeOf(index.maps[0].rows[0]);
        return { known: Object.keys(operationRules), all: Object.keys(operations) };
    });
    assert.deepEqual(known, all);
}

/**
 * Exact values, roundings, adjoints, contributions, culprits and the sentences about them are those of `lostbits
 * explain`.
 */
async function attributes({ browser, taped, lostbits }) {
    const page = await browser.page(taped);
    const rays = await page.evaluate(async () => {
        const picked = [];
        for (const map of index.maps) {
            for (const [r, row] of map.rows.entries()) {
                if ((r + index.maps.indexOf(map)) % 3 !== 0)
                    continue;  // three is prime to the four formats: all forms, each in some
                if (!row.taped) continue;
                const { worst } = row, k = (r * 7919 + index.maps.indexOf(map) * 104729) % (map.width * map.height);
                const [x, y] = r % 2 === 0 && worst ? [worst.x, worst.y] : [k % map.width, Math.floor(k / map.width)],
                          found = await walkOf(map, row, x, y), { walk } = found;
                // Through JSON: NaN and infinities as text.
                const plain = JSON.parse(JSON.stringify(
                    walk.nodes,
                    (key, v) =>
                        (key === "full"                                   ? undefined :
                             typeof v === "number" && !Number.isFinite(v) ? decimal(v) :
                             Object.is(v, -0)                             ? "-0" :
                                                                            v)));
                picked.push({
                    id: map.id,
                    form: row.form,
                    format: row.format,
                    x,
                    y,
                    nodes: plain,
                    culprit: walk.culprit,
                    equals: walk.equals,
                    explained: decimal(walk.explained),
                    sentence: culpritSentence(found, row, walk.subject < 0 ? NaN : walk.ulpOfSubject(row)),
                    verdict: verdictText(map, found.pixels, found.i)
                });
            }
        }
        return picked;
    });
    assert.ok(rays.length > 150, `${rays.length} rays`);
    let culprits = 0, turned = 0, ties = 0;
    for (const ray of rays) {
        const where = `${ray.id} --size ${size} --pixel ${ray.x},${ray.y} -i ${ray.form} -f ${ray.format}`;
        const told = JSON.parse(lostbits(
            "explain", ray.id, "--size", size, "--pixel", `${ray.x},${ray.y}`, "-i", ray.form, "-f", ray.format,
            "--json"));
        for (const n of ray.nodes) {
            for (const key of ["value", "exact", "error", "rounding", "adjoint", "contribution", "local"]) {
                if (typeof n[key] !== "boolean") n[key] = readNumber(n[key]);
            }
            turned += n.turned;
        }
        compare(ray, told.operations, where);
        const place = (name) => told.operations.findIndex((o) => o.name === name);
        assert.equal(ray.culprit, place(told.culprit), `${where}: culprit`);
        assert.deepEqual(ray.equals, told.equals.map(place), `${where}: equals`);
        assert.equal(ray.sentence, told.sentence, where);
        assert.equal(ray.verdict, told.verdict, where);
        culprits += ray.culprit >= 0;
        ties += ray.equals.length > 0;
        if (told.attribution.subject !== null)
            assert.ok(
                agree(readNumber(ray.explained), readNumber(told.attribution.explained)),
                `${where}: contributions sum to ${ray.explained}, not ${told.attribution.explained}`);
    }
    assert.ok(
        culprits > 80 && turned > 5 && ties > 5,
        `${culprits} culprits, ${turned} turned decisions, ${ties} rays with equals`);
}

/** The culprit is the same operation in whatever order the tape stands, each operation after its operands. */
async function ties({ browser, taped }) {
    const page = await browser.page(taped);
    const counts = await page.evaluate(async () => {
        const found = { rays: 0, ties: 0, wrong: [] };
        let seed = 1;
        const random = (n) => (seed = (seed * 48271) % 2147483647) % n;
        const shuffle = (tape) => {
            const isGivenNode = ([op]) => tape.operations[op] === "given", place = tape.nodes.map(() => -1), nodes = [],
                  waiting = tape.nodes.map((_, i) => i);
            while (waiting.length > 0) {
                const ready = waiting.filter(
                          (i) => isGivenNode(tape.nodes[i]) || tape.nodes[i].slice(2).every((o) => place[o] >= 0)),
                      i = ready[random(ready.length)], [op, format, ...operands] = tape.nodes[i];
                waiting.splice(waiting.indexOf(i), 1);
                place[i] = nodes.length;
                nodes.push([op, format, ...(isGivenNode(tape.nodes[i]) ? operands : operands.map((o) => place[o]))]);
            }
            return { tape: {...tape, nodes, outputs: tape.outputs.map((i) => place[i]) }, place };
        };
        for (const map of index.maps) {
            for (const [r, row] of map.rows.entries()) {
                if (!row.taped) continue;
                const k = (r * 7919 + 11 * index.maps.indexOf(map)) % (map.width * map.height), x = k % map.width,
                      y = Math.floor(k / map.width), { tape, walk } = await walkOf(map, row, x, y),
                      { tape: other, place } = shuffle(tape), again = new Walk(other, walk.inputs),
                      at = (i) => (i < 0 ? -1 : place[i]);
                ++found.rays;
                found.ties += walk.equals.length > 0;
                if (again.culprit !== at(walk.culprit) || String(again.equals) !== String(walk.equals.map(at)))
                    found.wrong.push(`${map.id} ${keyOf(row)} ${x}, ${y}`);
            }
        }
        return found;
    });
    assert.ok(counts.rays > 500 && counts.ties > 20, `${counts.rays} rays, ${counts.ties} with equals`);
    assert.deepEqual(counts.wrong, []);
}

/** What is read below the picture: the culprit, the sums, the verdict; and what a march has instead. */
async function table({ browser, report, lostbits }) {
    const at = "#scene=rtg-fig-7-3-4100-oblique&format=f32&x=60&y=60";
    const page = await browser.page(report, { hash: `${at}&form=sphere.schoolbook` });
    const told = JSON.parse(lostbits(
              "explain", "rtg-fig-7-3-4100-oblique", "--pixel", "60,60", "-i", "sphere.schoolbook", "-f", "f32",
              "--json")),
          ulp = readNumber(told.attribution.ulp);
    const culprit = told.operations.findIndex((o) => o.name === told.culprit);
    assert.equal(await page.locator("#operations tr.culprit").getAttribute("data-node"), String(culprit));
    const shown = await page.locator("#operations tbody tr")
                      .evaluateAll(
                          (rows) => rows.map(
                              (r) =>
                                  [Number(r.dataset.node), ...Array.from(r.children, (c) => c.textContent),
                                   r.children[2].title]));
    assert.ok(shown.length > 15, `${shown.length} operations`);
    for (const [node, name, , value, exact, off, cancelled, , , contribution, exactly] of shown) {
        const o = told.operations[node], close = (text, x) => Math.abs(Number(text) - x) <= 0.006 * Math.abs(x);
        assert.ok(o.live, name);
        assert.ok(
            Math.abs(Number(value) - o.computed.decimal) <= 1e-8 * Math.abs(o.computed.decimal) &&
                Math.abs(Number(exact) - o.exact) <= 1e-8 * Math.abs(o.exact),
            `${name}: ${value}, ${exact}`);
        assert.equal(exactly, o.computed.hex, name);
        assert.equal(cancelled, o.cancelled_bits === 0 ? "" : `${o.cancelled_bits} ${o.cancellation}`, name);
        assert.ok(
            contribution === "" ? o.rounding === 0 : close(contribution, o.contribution / ulp),
            `${name}: ${contribution} ulp of t, not ${o.contribution / ulp}`);
        assert.equal(off === "", o.error === 0, name);
    }
    const text = await page.locator("#operations .sentence").innerText(),
          [, parts, all] = text.match(/sum to (\S+) of (\S+) ulp/);
    assert.ok(
        Math.abs(parts - told.attribution.explained / ulp) < 1 && Math.abs(all - told.attribution.error / ulp) < 1,
        text);
    assert.ok(text.startsWith(`${told.sentence} `), text);
    const verdict = await page.locator("#inspector .verdict").innerText();
    assert.equal(verdict, told.verdict);
    assert.match(
        verdict, new RegExp(`the formula loses the other ${(told.lost_bits - told.inherent_bits).toFixed(1)} bits`));
    await page.locator("#map").press("ArrowRight");
    await page.waitForFunction(() => document.getElementById("operations").dataset.pixel === "61,60");
    const march =
        await browser.page(report, { hash: "#scene=sdf-sphere&form=sdf.sphere_trace&format=f32&x=100&y=100" });
    assert.match(
        await march.locator("#inspector .verdict").innerText(),
        /bits are lost where the march ended, at sample \d+, or/);
    assert.match(
        await march.locator("#operations").innerText(),
        /lostbits explain sdf-sphere --pixel 100,100 -i sdf.sphere_trace -f f32/);
}

module.exports = {
    pageOf,
    promises : { reruns, rules, attributes, ties, table }
};
