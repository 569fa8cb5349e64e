// Promises of the page to a reader: where to begin, what belongs together, what is withheld, what is distinguishable.
"use strict";

const assert = require("node:assert/strict");
const { boxOf, resize, schoolbook, settled, sweep } = require("./browser.js");

/** Contrast of two colours as WCAG 2 defines it. */
function contrast(a, b) {
    const light = (colour) => {
        const [r, g, bl] =
            colour.map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * bl;
    };
    const [low, high] = [light(a), light(b)].sort((x, y) => x - y);
    return (high + 0.05) / (low + 0.05);
}

const rgbOf = (text) =>
    (text.startsWith("#") ? text.match(/[0-9a-f]{2}/g).map((x) => parseInt(x, 16)) :
                            text.match(/\d+/g).slice(0, 3).map(Number));

/**
 * The first paragraph says what the page is and what to do first. The description of a scene is open. Neither half of
 * a wide window is blank.
 */
async function opening({ open }) {
    const page = await open("report");
    const first = await page.locator("main, header").first().locator("p").first().innerText();
    assert.match(first, /^This page shows where ray intersectors lose significand bits/);
    assert.match(first, /First, choose a scene and a form under Maps and point at the picture/);
    // A page without maps names its contents, and its end counts nothing else.
    const grids = await open("grids");
    assert.match(await grids.locator("#opening").innerText(), /First, choose a statistic under Sweeps/);
    assert.match(await grids.locator("#made").innerText(), /^The command\s+3 sweeps\. Made by:/);
    for (const [view, note] of [["#map-view", "#scene-note"], ["#sweep-view", "#sweep-note"]]) {
        assert.equal(await page.$eval(note, (e) => e.open), true, note);
        assert.ok((await page.locator(`${note} p`).innerText()).length > 20, note);
    }
    for (const width of [1280, 1920]) {
        await resize(page, width, 1000);
        for (const view of ["#map-view", "#sweep-view"]) {
            const whole = await boxOf(page, `${view} .stage`), picture = await boxOf(page, `${view} .picture`),
                  side = await boxOf(page, `${view} .side`);
            assert.ok(whole.right - whole.left > 0.9 * width, `${view} takes ${whole.right - whole.left} of ${width}`);
            assert.ok(
                side.left >= picture.right && side.top < picture.bottom, `${view} at ${width}: one below the other`);
            assert.ok(
                (side.bottom - side.top) > 0.3 * (picture.bottom - picture.top), `${view} at ${width}: blank side`);
        }
    }
    await contrasts(page);
}

/** Claims are grouped by subject and closed. The keyboard alone sorts and filters them. */
async function subjects({ open }) {
    const page = await open("report", { width: 400, height: 800 });
    const subject = page.locator("details.subject"), count = await subject.count();
    assert.ok(count >= 3, `${count} subjects`);
    assert.equal(await page.locator("details.subject[open]").count(), 0);
    const height = await page.$eval("#claims", (e) => e.offsetHeight);
    assert.ok(height < 250 + 110 * count, `${height} px for ${count} closed subjects`);
    const red = rgbOf(await page.$eval(".tiles .refuted b", (e) => getComputedStyle(e).color));
    assert.ok(red[0] < 2 * red[1], `a finding, not an alarm: refuted is ${red}`);
    assert.match(await subject.first().locator("summary").innerText(), /\d+ claims?: .*(holds?|refuted)/);

    await page.locator("#open-claims").press("Enter");
    assert.equal(await page.locator("details.subject[open]").count(), count);
    // Sort by the measured number, up and then down.
    const measured = () => page.$$eval("table.claims tbody", (bodies) => bodies.map((b) => {
        const said = [...b.rows].map((r) => r.dataset.measured).filter((x) => x !== "");
        return said.map((x) => Number(asNumber(x)));
    }));
    await resize(page, 1280, 900);
    const head = page.locator("table.claims").first().locator("thead th", { hasText: "measured" }).last();
    await head.locator("button").press("Enter");
    const rising = (lists, sign) => lists.every((l) => l.every((x, k) => k === 0 || sign * (x - l[k - 1]) >= 0));
    assert.ok(rising(await measured(), 1));
    assert.equal(await head.getAttribute("aria-sort"), "ascending");
    await head.locator("button").press("Enter");
    assert.ok(rising(await measured(), -1));
    assert.ok((await measured()).some((l) => new Set(l).size > 2));
    // A narrow page has no heads of columns, so the picker sorts.
    await resize(page, 400, 800);
    await page.selectOption("#pick-order", "measured");
    assert.ok(rising(await measured(), 1));
    await page.selectOption("#pick-order", "as in the files");
    const places = await page.$$eval("table.claims tbody tr", (rows) => rows.map((r) => Number(r.dataset.place)));
    assert.deepEqual(places, [...places].sort((a, b) => a - b));

    await page.locator("#close-claims").press("Enter");
    await page.fill("#filter", "tilt schoolbook");
    assert.ok(await page.locator("details.subject[open]").count() > 0, "what was found is closed");
    assert.equal(await page.locator("details.subject:not([open]):visible").count(), 0);
    await page.fill("#filter", "");
    assert.equal(await page.locator("details.subject[open]").count(), 0);
}

/** A and B are marked on the picture, in the pickers, on the small pictures and in the text. */
async function halves({ open }) {
    const page = await open("report", { hash: `${schoolbook}&other=sphere.unified.f64&split=0.5&x=128&y=128` });
    await settled(page);
    assert.equal(await page.locator(".half.a").innerText(), "A schoolbook f32");
    assert.equal(await page.locator(".half.b").innerText(), "B unified f64");
    const a = await boxOf(page, ".half.a"), b = await boxOf(page, ".half.b"), map = await boxOf(page, "#map");
    assert.ok(Math.abs(a.left - map.left) < 3 && Math.abs(b.right - map.right) < 3 && a.right < b.left);
    const pickers = await page.locator("#map-view .pickers").innerText();
    assert.ok(pickers.includes("A: form") && pickers.includes("B: compare with"), pickers);
    for (const [half, key] of [["A", "sphere.schoolbook.f32"], ["B", "sphere.unified.f64"]])
        assert.equal(await page.$eval(`.pane[data-row="${key}"]`, (e) => e.dataset.half), half);
    const inspector = await page.locator("#inspector").innerText();
    assert.match(inspector, /A: .*sphere\.schoolbook in f32/);
    assert.match(inspector, /B: .*sphere\.unified in f64/);
    // Each half has its classes in the legend, and bars of two formats differ.
    const lines = page.locator("#map-view .half-legend"), bar = page.locator("#map-view .legend .ramp");
    assert.equal(await lines.count(), 2);
    assert.equal(await bar.count(), 2);
    const counted = await page.evaluate(
        () => [rowNow(), otherRow()].map((row) => row.outcomes[outcomeNames.indexOf("agree_miss")]));
    for (const k of [0, 1]) {
        const text = await lines.nth(k).innerText();
        assert.ok(text.startsWith("AB"[k]) && text.includes(`correct miss ${counted[k]}`), text);
    }
    await page.locator("#map").press("x");
    await settled(page);
    assert.equal(await page.locator(".half.a").innerText(), "A unified f64");
    await page.selectOption("#pick-other", "");
    await settled(page);
    assert.equal(await page.locator(".half:visible").count(), 0);
    assert.equal(await lines.count(), 0);
    // Two forms are compared from the start: the best one beside the first. Links need not say so.
    const fresh = await open("report", { hash: schoolbook.replace("&other=", "") });
    await settled(fresh);
    assert.equal(await fresh.locator(".half:visible").count(), 2);
    const least = await fresh.evaluate(() => {
        const [wrong, lost] = rankOf(otherRow());
        return mapNow()
            .rows.filter((row) => row.format === "f32")
            .every((row) => rankOf(row)[0] > wrong || (rankOf(row)[0] === wrong && rankOf(row)[1] >= lost));
    });
    assert.ok(least);
    await fresh.locator("#map").press("w");
    await settled(fresh);
    assert.ok(!(await fresh.evaluate(() => location.hash)).includes("other"));
}

/** In a narrow window the colours are explained above the picture, and the lines of a chart below it. */
async function narrow({ open }) {
    const page = await open("report", { hash: `${schoolbook}&sweep=${sweep}`, width: 400, height: 800 });
    await settled(page);
    const legend = await boxOf(page, "#map-view .legend"), map = await boxOf(page, "#map");
    assert.ok(legend.bottom <= map.top && legend.right <= 400);
    for (const chart of ["#sweep-chart", "#trade-plot"]) {
        const [shown, all] = await page.$eval(`${chart} .chart`, (e) => [e.clientWidth, e.scrollWidth]);
        assert.ok(all > shown);
        assert.equal(await page.locator(`${chart} .sideways:visible`).count(), 1, "it says that it scrolls");
    }
    const names = page.locator(".names .class"), lines = await page.evaluate(() => sweepParts.chart.lines.length);
    assert.ok(lines > 1);
    assert.equal(await page.locator(".names .class:visible").count(), lines);
    assert.match(await names.first().innerText(), /\w/);
    await resize(page, 1280, 900);
    assert.equal(await page.locator(".names:visible").count(), 0);
}

/** Small pictures of a row start at the same height, and so do their names. They say why they have no quantile. */
async function thumbnails({ open }) {
    const page = await open("report", { hash: schoolbook });
    await settled(page);
    const places = await page.$$eval(".pane", (panes) => panes.map((p) => {
        const top = (e) => Math.round(e.getBoundingClientRect().top), box = p.getBoundingClientRect();
        return { row: Math.round(box.top), picture: top(p.querySelector("canvas")), name: top(p.querySelector("b")) };
    }));
    assert.ok(places.length >= 6);
    for (const { row, picture, name } of places) {
        const first = places.find((p) => p.row === row);
        assert.deepEqual([picture, name], [first.picture, first.name]);
    }
    const words = async () => {
        await page.evaluate(() => {
            paneParts.scene = "";
            return goTo({ x: -1 });
        });
        await settled(page);
        return [
            await page.locator(".pane[data-row='sphere.schoolbook.f32']").innerText(),
            await page.locator("#inspector").innerText()
        ];
    };
    for (const text of await words()) assert.doesNotMatch(text, /agree:|too few/);
    assert.match((await words())[0], /p99 [\d.]+ of 24 bits lost/);
    // A form that agrees on less than a tenth of the hits has no representative quantile.
    const agreed = await page.evaluate(() => {
        const row = rowNow();
        row.true_hits = 11 * row.outcomes[agreeHit];
        return row.outcomes[agreeHit];
    });
    for (const text of await words()) {
        assert.ok(text.includes(`${agreed} of ${11 * agreed} hits agree`), text);
        assert.doesNotMatch(text, /p99/);
    }
}

/**
 * The chosen form's line is thick, and pointing at a step shows its numbers. The text of a chart is text. A number that
 * is not drawn can be read, with the reason.
 */
async function lines({ open }) {
    const page =
        await open("report", { hash: `#sweep=${sweep}&form=sphere.unified&format=f32&statistic=lost_bits_p99` });
    assert.match(await page.locator("#sweep-chart svg").textContent(), /Lost bits, 99th percentile in f32/);
    const widths = () =>
        page.locator("#sweep-chart g[data-keys]:not([data-x]) path[stroke]")
            .evaluateAll(
                (all) => all.map((e) => [e.parentNode.dataset.keys, parseFloat(getComputedStyle(e).strokeWidth)]));
    for (const [keys, width] of await widths())
        assert.equal(width > 3, keys.split(" ").includes("sphere.unified.f32"), `${keys}: ${width}`);
    await page.evaluate(() => {
        const row = sweepParts.now.chosen;
        row.true_hits = row.true_hits.map((n, k) => (k < 5 ? 1e9 : n));
        return goTo({ u: 0 });
    });
    await settled(page);
    assert.match(
        await page.locator("#sweep-facts tr[data-fact=lost_bits_p99] td").first().innerText(),
        /, but only \d+ of 1000000000 hits agree$/);
    await page.evaluate(() => goTo({ u: -1 }));
    const place = await page.evaluate(() => {
        const { svg, frame } = sweepParts.chart;
        svg.scrollIntoView();
        const { x, y } =
            new DOMPoint(frame.x.at(-3), (frame.y[0] + frame.y[1]) / 2).matrixTransform(svg.getScreenCTM());
        return [x, y];
    });
    await page.mouse.move(...place);
    await settled(page);
    assert.match(await page.locator("#sweep-under").innerText(), /in f32, .*: lost bits p99 /);
    assert.ok(await page.locator("#sweep-facts table").isVisible());
}

/** Contrast of text to the page, light and dark, is at least 4.5 to 1, by WCAG 2. */
async function contrasts(page) {
    for (const colorScheme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme });
        await settled(page);
        const colours = await page.evaluate(() => {
            const of = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
            return ["--page", "--ink", "--soft", "--link", "--refuted", "--bad"].map(of);
        });
        for (const colour of colours.slice(1))
            assert.ok(contrast(rgbOf(colour), rgbOf(colours[0])) >= 4.5, `${colorScheme}: words in ${colour}`);
    }
}

/** A copied claim has an interval around the measured number, and states the number. */
async function margins({ open }) {
    const page =
        await open("report", { hash: `${schoolbook}&metric=lost_bits&sweep=${sweep}&statistic=lost_bits_p99` });
    const about = (...args) => page.evaluate((args) => intervalAbout(...args), args);
    assert.deepEqual(await about("lost_bits_p99", 13.24, 1024), [12.7, 13.8]);
    assert.deepEqual(await about("lost_bits_p99", 0.2, 1024), [0, 0.7]);
    assert.deepEqual(await about("false_miss_fraction", 0.995, 1024), [0.985, 1]);
    assert.deepEqual(await about("agree_hit", 1020, 1024), [1009, 1024]);
    assert.deepEqual(await about("ulp_error_p99", 2041, 1024), [1840, 2250]);
    assert.deepEqual(await about("ulp_error_p99", 0, 1024), [0, 0]);
    for (const [button, pre] of [["#copy-claim", "#map-view"], ["#copy-sweep-claim", "#sweep-view"]]) {
        await page.locator(button).click();
        const text = await page.locator(`${pre} pre.copied`).textContent(),
              [, measured] = text.match(/^# measured ([\d.e+-]+);/m),
              [, low, high] = text.match(/^in = \[(.*), (.*)\]$/m);
        assert.ok(Number(low) < Number(measured) && Number(measured) < Number(high), text);
    }
    assert.match(await page.locator("#sweep-view pre.copied").textContent(), /lostbits check --measure --seeds 31/);
    // Where no claim can be copied, the page says why.
    assert.equal(await page.locator("#map-view .no-claim:visible").count(), 0);
    const small = await open("small");
    assert.ok(await small.locator("#copy-claim").isDisabled());
    assert.match(await small.locator("#map-view .no-claim").innerText(), /the scene's own size/);
}

exports.promises = {
    opening,
    subjects,
    halves,
    narrow,
    thumbnails,
    lines,
    margins
};
