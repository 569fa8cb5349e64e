// What the page promises of sweeps, planes, cases and trades.
"use strict";

const assert = require("node:assert/strict");
const { stateOf, settled } = require("./common.js");
const { readCsv } = require("./files.js");

/** The plot's numbers are those of samples.csv, and a line leads to its form's map. */
async function sweeps({ browser, report, at, sweep }) {
    const page = await browser.page(report, { hash: `#sweep=${sweep}` });
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
    // With the keyboard alone: a step, and its numbers.
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

async function trade({ browser, report }) {
    const page = await browser.page(report, { hash: "#shape=sphere" });
    assert.ok(await page.locator("#trade-plot canvas").count() > 0, "no plot");
    const place = await page.evaluate(() => {
        // With a map of its own, and apart from all others: times vary, and any two may lie on one another.
        const at = (q) => [tradeParts.plot.valToPos(q.time_ns, "x"), tradeParts.plot.valToPos(q.kept_bits, "y")],
              gap = (p) => Math.min(...tradeParts.points.filter((q) => q !== p)
                                        .map((q) => Math.hypot(at(q)[0] - at(p)[0], at(q)[1] - at(p)[1]))),
              p = tradeParts.points.filter((q) => mapOf(q)).sort((a, b) => gap(b) - gap(a))[0],
              box = document.querySelector("#trade-plot .u-over").getBoundingClientRect();
        return {
            name: p.name,
            number: tradeParts.points.indexOf(p),
            x: box.left + tradeParts.plot.valToPos(p.time_ns, "x"),
            y: box.top + tradeParts.plot.valToPos(p.kept_bits, "y")
        };
    });
    await page.evaluate(() => document.getElementById("trade-plot").scrollIntoView());
    const box = await page.locator("#trade-plot .u-over").boundingBox();
    const local = await page.evaluate((number) => {
        const p = tradeParts.points[number];
        return { x: tradeParts.plot.valToPos(p.time_ns, "x"), y: tradeParts.plot.valToPos(p.kept_bits, "y") };
    }, place.number);
    await page.mouse.move(box.x + local.x, box.y + local.y);
    await settled(page);
    assert.match(await page.locator("#trade-view .hint").innerText(), /ns per ray, keeps/);
    const named = await page.evaluate(() => tradeParts.under.name);
    await page.mouse.click(box.x + local.x, box.y + local.y);
    assert.equal((await stateOf(page)).form, named);
    // Names of the front lie on no point and on no other name.
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
    // By the keyboard: from point to point by time, Enter for the map of one that has a map here (variants of compiler
    // flags have none).
    const walked = [],
          under = () =>
              page.evaluate(() => [tradeParts.under.time_ns, tradeParts.under.name, Boolean(mapOf(tradeParts.under))]);
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

module.exports = {
    sweeps,
    trade
};
