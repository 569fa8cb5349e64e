// Promises of the page about the user's own result: it comes first, fits, names its worst ray, and has a dark style.
"use strict";

const assert = require("node:assert/strict");
const { boxOf, resize, settled, sticksOut, sweep } = require("./browser.js");

/** The user's result comes first: maps before claims, claims before the command. A map uses the full width. */
async function order({ open }) {
    const page = await open("report");
    const sections = await page.$$eval("main > section", (all) => all.map((e) => e.id));
    assert.deepEqual(sections, ["maps", "sweeps", "trade", "choose", "mend", "offsets", "claims", "made"]);
    assert.equal(await page.locator("header .tiles").count(), 0);
    assert.equal(await page.locator("#claims .tiles").count(), 1);
    assert.match(await page.locator("#made pre").innerText(), /^lostbits report near-benign /);
    for (const width of [400, 900, 1280]) {
        await resize(page, width, 900);
        const map = await boxOf(page, "#map"), view = await boxOf(page, "#map-view"), room = view.right - view.left,
              wide = map.right - map.left;
        assert.ok(map.right <= view.right + 1, `${width}: the map ends at ${map.right} of ${view.right}`);
        assert.ok(wide >= (width >= 1000 ? 0.55 : 0.97) * room, `${width}: the map takes ${wide} of ${room}`);
    }
    // Two scenes with the same title also have their names; other scenes do not.
    const names = async () => page.$$eval("#pick-scene option", (all) => all.map((e) => e.textContent));
    assert.ok((await names()).every((name) => !name.includes("(near-benign)")));
    await page.evaluate(() => {
        index.maps[1].title = index.maps[0].title;
        return goTo({});
    });
    const both = await names();
    assert.equal(new Set(both).size, both.length, `${both}`);
    assert.ok(both[0].endsWith("(near-benign)") && both[1].endsWith("(rtg-fig-7-3-4100-oblique)"), `${both}`);
    // A scene without a title has its file's name.
    await page.evaluate(() => {
        index.maps[0].title = index.maps[1].title = "";
        return goTo({});
    });
    assert.deepEqual((await names()).slice(0, 2), ["near-benign", "rtg-fig-7-3-4100-oblique"]);
}

/**
 * Below the map is its worst pixel, with a command that explains it, also for a scene of the user. A click on the
 * button goes there.
 */
async function worst({ open, lostbits }) {
    for (const [name, scene] of [["report", "rtg-fig-7-3-4100-oblique"], ["odd", "one-pixel"]]) {
        const page = await open(name, { hash: `#scene=${scene}&form=sphere.schoolbook&format=f32` });
        const line = await page.locator("#worst-line").innerText(),
              [, x, y, command] = line.match(/^Worst pixel (\d+), (\d+): lostbits (explain .*)$/);
        await page.locator("#worst").click();
        const now = await page.evaluate(() => [state.x, state.y]);
        assert.deepEqual(now, [Number(x), Number(y)]);
        assert.match(lostbits(...command.split(" ")), /sphere\.schoolbook in f32/);
        // It is the same pixel that the program calls the worst.
        const [, named] = command.match(/^explain (.*) --pixel/),
                 told = lostbits("explain", named, "--worst", "-i", "sphere.schoolbook", "-f", "f32");
        assert.ok(told.startsWith(`Pixel ${x},${y}, the worst of `), told.slice(0, 80));
    }
}

/** At a width of 400 pixels the table of operations has a scroll bar, and a text says that there is more. */
async function sideways({ open }) {
    const hash = "#scene=rtg-fig-7-3-4100-oblique&form=sphere.schoolbook&format=f32";
    const atWorst = async (size) => {
        const page = await open("report", { hash, ...size });
        await page.locator("#map").press("w");
        await page.locator("#operations .scrolls").waitFor();
        return page;
    };
    const page = await atWorst({ width: 400, height: 800 }), box = page.locator("#operations .scrolls");
    const { hidden, bar } =
        await box.evaluate((e) => ({ hidden: e.scrollWidth - e.clientWidth, bar: e.offsetHeight - e.clientHeight }));
    assert.ok(hidden > 100, `only ${hidden} pixels are out of sight`);
    assert.ok(bar >= 8, `a bar of ${bar} pixels`);
    assert.ok(await page.locator("#operations .sideways").isVisible());
    await box.focus();
    await page.keyboard.press("ArrowRight");
    await settled(page);
    assert.ok(await box.evaluate((e) => e.scrollLeft) > 0, "the arrow key does not scroll it");
    assert.equal(await sticksOut(page), 0);
    const wide = await atWorst({ width: 1600, height: 900 });
    assert.ok(await wide.locator("#operations .sideways").isHidden());
}

/** At a width of 400 pixels no table is cut off: each lies in a box that is as wide as the page and scrolls. */
async function tables({ open }) {
    const page = await open("report", { scripts: false, width: 400, height: 800 });
    const boxes = await page.locator("table").evaluateAll((all) => all.map((table) => {
        const box = table.parentElement, { left, right } = box.getBoundingClientRect();
        return { overflow: getComputedStyle(box).overflowX, left, right };
    }));
    assert.ok(boxes.length > 3, `${boxes.length} tables`);
    for (const { overflow, left, right } of boxes) {
        assert.equal(overflow, "auto");
        assert.ok(left >= 0 && right <= 400, `a table from ${left} to ${right}`);
    }
    assert.equal(await sticksOut(page), 0);
}

/** In the dark style no chart has a white ground: those whose colours only tell things apart are inverted. */
async function dark({ open }) {
    const bare = await open("report", { scripts: false });
    const filters = (where) => bare.locator(where).evaluateAll((all) => all.map((e) => getComputedStyle(e).filter));
    await bare.emulateMedia({ colorScheme: "light" });
    assert.ok((await filters("img")).every((f) => f === "none"));
    await bare.emulateMedia({ colorScheme: "dark" });
    for (const where of ["#sweeps", "#trade", "#choose", "#mend"].map((part) => `${part} .chart svg`)) {
        const all = await filters(where);
        assert.ok(all.length > 0, where);
        assert.ok(all.every((f) => f.startsWith("invert(0.9)")), `${where}: ${all}`);
    }
    // Colours of maps mean numbers, so they do not change.
    const kept = await filters("#maps img, #offsets img");
    assert.ok(kept.length > 0 && kept.every((f) => !f.includes("invert")), `${kept}`);
    const grids = await open("grids", { scripts: false });
    await grids.emulateMedia({ colorScheme: "dark" });
    const cells =
        await grids.locator("#sweeps .chart svg").evaluateAll((all) => all.map((e) => getComputedStyle(e).filter));
    assert.ok(cells.length > 0 && cells.every((f) => !f.includes("invert")), `${cells}`);
}

/**
 * The page of `lostbits mend` begins by saying what it is. Removed and added lines look different, also in the dark
 * style.
 */
async function mended({ open, at }) {
    const page = await open("mend/box-slabs");
    assert.deepEqual(await page.$$eval("main > section", (all) => all.map((e) => e.id)), ["mend", "made"]);
    assert.match(await page.locator("#opening").innerText(), /First, read under Changes/);
    assert.match(await page.locator("#made").innerText(), /^The command\s+Made by:\s+lostbits mend box-slabs /);
    for (const colorScheme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme });
        const [gone, come, rest] = await page.evaluate(
            () => ["del", "ins", "pre.words"].map((e) => getComputedStyle(document.querySelector(`#mend ${e}`)).color));
        assert.equal(new Set([gone, come, rest]).size, 3, `${colorScheme}: ${gone}, ${come}, ${rest}`);
    }
    await page.setViewportSize({ width: 400, height: 800 });
    assert.equal(await sticksOut(page), 0);
}

exports.promises = {
    order,
    worst,
    sideways,
    dark,
    mended,
    tables
};
