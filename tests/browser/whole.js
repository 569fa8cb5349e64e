// Promises of the whole page: links, claims, copies, and what works without scripts.
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { follow, schoolbook, settled, stateOf, sticksOut } = require("./browser.js");

/** The page makes no request and no complaint, and its policy forbids scripts and requests of others. */
async function alone({ open }) {
    const page = await open("report");
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

/** A link restores the view. A link to something that does not exist says so. Going back works. */
async function link({ open }) {
    const page = await open("report", {
        hash: `${
            schoolbook}&metric=ulp_error&other=sphere.unified.f64&split=0.3&x=100&y=90&zoom=3.375&cx=0.4&cy=0.3&sweep=sphere-tilt&statistic=lost_bits_p50`
    });
    await page.locator("#map").press("ArrowDown");
    await settled(page);
    const picture = () => document.getElementById("map").toDataURL(), before = await stateOf(page);
    const again = await open("report", { hash: await page.evaluate(() => location.hash) });
    assert.deepEqual(await stateOf(again), before);
    assert.equal(await again.evaluate(picture), await page.evaluate(picture));
    assert.equal(await again.locator("#pick-statistic").inputValue(), "lost_bits_p50");
    await follow(page, "#scene=nowhere&x=5&y=5");
    assert.match(await page.locator("#note").innerText(), /scene "nowhere" is not on this page/);
    await follow(page, "#sweep=sphere-tilt&statistic=lost_bits_p98");
    assert.match(await page.locator("#note").innerText(), /statistic "lost_bits_p98" is not on this page/);
    assert.equal((await stateOf(page)).statistic, "");
    assert.deepEqual(page.complaints, []);
}

/** A claim leads to its pixel or its plot. The filter keeps what it says. */
async function claims({ open }) {
    const page = await open("report");
    await page.locator("#open-claims").click();
    const place = page.locator("table.claims a.jump[href*='scene=near-benign']").first(),
          target = await place.getAttribute("href");
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

/**
 * Claims about planes and cases lead to their cell. Claims without a picture here name the command. Every link has a
 * target.
 */
async function places({ open, at }) {
    const page = await open("grids");
    await page.locator("#open-claims").click();
    const jump = async (id) => {
        await page.locator(`#claim-${id.replaceAll(".", "\\.")} a.jump`).click();
        await settled(page);
        assert.ok(await page.locator("#note").isHidden(), `${id}: ${await page.locator("#note").innerText()}`);
        return stateOf(page);
    };
    const corner = await jump("rtg7.plane.unified-f32-1e3-1e6-innocence");
    assert.deepEqual([corner.sweep, corner.line, corner.u, corner.v], ["sphere-height", "sphere.unified.f32", 0, 45]);
    const inside = await jump("box.baseline-inside-innocence");
    assert.deepEqual(
        [inside.sweep, inside.line, inside.v, inside.statistic],
        ["box-boundary", "box.baseline.f32", 0, "false_miss_fraction"]);
    assert.match(await page.locator("#sweep-facts").innerText(), /through the inside/);
    for (const name of ["grids", "report"]) {
        const checked = await open(name), found = await checked.evaluate(() => {
            const rows = [...document.querySelectorAll("table.claims tbody tr")],
                  links = [...document.querySelectorAll("a.jump")];
            return {
                rows: rows.length,
                silent: rows.filter((r) => !r.querySelector("a.jump") && !r.cells[2].querySelector("code"))
                            .map((r) => r.id),
                noted: links.filter((a) => !readHash(a.hash) || notes.length > 0).map((a) => `${a.hash}: ${notes}`)
            };
        });
        assert.ok(found.rows > 5, `${found.rows} claims`);
        assert.deepEqual(found, { rows: found.rows, silent: [], noted: [] });
        // Without scripts, a link leads to the part of the page with the numbers.
        const html = fs.readFileSync(at(`${name}/index.html`), "utf8");
        for (const [, anchor] of html.matchAll(/<a class="jump" href="#([^"]*)"/g))
            assert.ok(html.includes(`id="${anchor}"`), `${anchor} leads nowhere`);
        if (name === "report") await holdsNamedRays(checked);
    }
}

/** The page holds the operations of the rays that links of claims lead to. */
async function holdsNamedRays(page) {
    const { asked, missing } = await page.evaluate(async () => {
        const found = { asked: 0, missing: [] };
        for (const link of document.querySelectorAll("a.jump[data-view*='x=']")) {
            const view = Object.fromEntries(new URLSearchParams(link.dataset.view)),
                  map = index.maps.find((m) => m.id === view.scene),
                  row = map.rows.find((r) => r.form === view.form && r.format === view.format);
            if (!row.formula) continue;
            ++found.asked;
            if (!(await raysOf(map, row)).some(isAt(Number(view.x), Number(view.y))))
                found.missing.push(link.dataset.view);
        }
        return found;
    });
    assert.deepEqual(missing, []);
    assert.ok(asked > 5, `${asked} links`);
}

/** Copied text runs: the command makes the map, and the claims measure what they state. */
async function copies({ open, lostbits }) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "lostbits-copies-"));
    try {
        const page = await open("report", {
            hash:
                "#scene=rtg-fig-7-3-4100-oblique&form=sphere.schoolbook&format=f64&metric=ulp_error&sweep=sphere-tilt&statistic=lost_bits_p99"
        });
        const copied = async (button) => {
            await page.locator(button).click();
            return page.locator(button).evaluate(
                (e) => e.closest("section, .side").querySelector("pre.copied").textContent);
        };
        let text = "schema = \"lostbits-claims/1\"\n" + (await copied("#copy-claim"));
        await page.locator("#copy-sweep-claim").click();
        text += await page.locator("#sweep-view pre.copied").textContent();
        const cells = await open("grids");
        for (const hash
                 of ["#sweep=sphere-height&form=sphere.schoolbook&format=f32&u=9&v=30&statistic=lost_bits_max",
                     "#sweep=box-boundary&form=box.baseline&format=f32&judged=open&v=12&statistic=false_hit_fraction",
                     "#sweep=contact&form=sphere.unified&format=f64&v=3"]) {
            await follow(cells, hash);
            await cells.locator("#copy-sweep-claim").click();
            text += await cells.locator("#sweep-view pre.copied").textContent();
        }
        fs.writeFileSync(path.join(folder, "claims.toml"), text);
        assert.equal(lostbits("check", path.join(folder, "claims.toml"), "--strict"), "", text);
        const command = await copied("#copy-command");
        assert.match(
            command,
            /^lostbits map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -f f64 --metric ulp_error --pixels csv -o out$/);
        await cells.locator("#copy-sweep-command").click();
        assert.equal(
            await cells.locator("#sweep-view pre.copied").textContent(),
            "lostbits sweep extremes/contact -i sphere.unified -f f64 -o out");
        lostbits(...command.replace("-o out", `-o ${folder}/out`).split(" ").slice(1));
        assert.ok(fs.existsSync(path.join(folder, "out/rtg-fig-7-3-4100-oblique/sphere.schoolbook.f64.csv")));
    } finally { fs.rmSync(folder, { recursive: true }); }
}

/** Without scripts, counts, tables and pictures can still be read. */
async function plain({ open }) {
    const page = await open("report", { scripts: false });
    const text = await page.locator("body").innerText();
    assert.match(text, /\d+\s+hold/);
    assert.match(text, /\d+\s+refuted/);
    for (const part of ["Four spheres close by", "sphere.schoolbook", "lost bits p50", "p99 loses half"])
        assert.ok(text.includes(part), `"${part}" cannot be read`);
    assert.ok((await page.locator("table.claims tbody tr:visible").count()) > 0);
    assert.equal(await page.locator("#map-view:visible").count(), 0);
    const pictures = await page.locator("img:visible, .chart:visible").count();
    assert.ok(pictures >= 4, `${pictures} pictures`);
    assert.deepEqual(page.requested.filter((url) => !url.startsWith("data:")), [page.url()]);
    // Every format has its plots, and so have planes and cases.
    const saysOf = (all) => all.map((e) => e.getAttribute("aria-label"));
    const alts = await page.locator("#sweeps .chart:visible").evaluateAll(saysOf);
    for (const format of ["f32", "f64"])
        assert.equal(
            alts.filter((alt) => alt.startsWith("99th percentile") && alt.endsWith(`, ${format}`)).length, 1,
            `${alts}`);
    const bare = await open("grids", { scripts: false }),
          cells = await bare.locator("#sweeps .chart:visible").evaluateAll(saysOf);
    for (const alt of ["sphere.unified in f64", "by the closed primitive", "by the open primitive", "exact tangents"])
        assert.ok(cells.some((p) => p.includes(alt)), `${alt} is not among ${cells}`);
}

/**
 * Extreme pages, in a narrow window, in the dark style and with the keyboard alone: nothing sticks out, nothing
 * complains, every key works.
 */
async function odd({ open, at }) {
    let page;
    for (const where
             of ["odd#scene=one-pixel", "#scene=no-hit&sweep=box-boundary", "#sweep=sdf-max-steps&format=p40",
                 "#sweep=sphere-height&format=p2", "odd/sweep", "odd/cases"]) {
        const [name, hash] = where.split("#");
        if (name) page = await open(name, { hash: hash && `#${hash}`, width: 400, height: 800 });
        else await page.evaluate(() => goTo({ x: -1, y: -1, u: -1, v: -1 })).then(() => follow(page, where));
        await page.emulateMedia({ colorScheme: "dark" });
        await settled(page);
        assert.equal(await sticksOut(page), 0, `${where} is wider than its window`);
        const [paper, text] = await page.evaluate(
            () => [getComputedStyle(document.body).backgroundColor, getComputedStyle(document.body).color].map(
                (c) => Math.max(...c.match(/\d+/g).map(Number))));
        assert.ok(paper < 64 && text > 192, `${where}: text ${text} on ${paper}`);
        const inside = await page.evaluate(
            () => [...document.querySelectorAll("#map, #sweep-chart")].filter((e) => e.offsetParent).map((e) => e.id));
        assert.ok(inside.length > 0, where);
        for (const id of inside) {
            for (const key of ["ArrowRight", "ArrowDown", "m", "]", "[", "M", "ArrowLeft", "ArrowUp"])
                await page.locator(`#${id}`).press(key);
        }
        await settled(page);
        const now = await stateOf(page);
        assert.ok(inside.includes("map") ? now.x >= 0 : now.u >= 0 || now.v >= 0, `${where}: ${JSON.stringify(now)}`);
        assert.ok(
            inside.every((id) => id === "map") ||
                (await page.locator("#sweep-facts tr[data-fact=lost_bits_p99]").count()) === 1,
            `${where}: no numbers of a step`);
        assert.deepEqual(page.complaints, [], where);
    }
}

/**
 * A page of 512 x 512 rays with six layers is below 3 MB and has culprits only if asked for. The time until it is ready
 * is only printed, since other tests run beside it.
 */
async function ready({ open, at }) {
    const { size } = fs.statSync(at("large/index.html")), page = await open("large");
    const [width, height, metrics, after] = await page.evaluate(
        () =>
            [mapNow().width, mapNow().height, mapNow().metrics.map((m) => m.name),
             document.documentElement.dataset.ready]);
    assert.deepEqual([width, height, metrics.length >= 6, metrics.includes("culprit")], [512, 512, true, false]);
    console.log(`${size} bytes; ready after ${after} ms`);
    assert.ok(size < 3e6, `${size} bytes`);
}

exports.promises = {
    alone,
    link,
    claims,
    places,
    copies,
    plain,
    odd,
    ready
};
