// A headless Chromium on pages from files, and what went wrong while they were there.
"use strict";

const fs = require("node:fs");
const path = require("node:path");
const { pathToFileURL } = require("node:url");

const candidates =
    ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executable = () => process.env.LOSTBITS_CHROMIUM || candidates.find((c) => fs.existsSync(c));

/** What the tests need and this machine lacks, in a sentence; nothing when all is there. */
function missing() {
    try {
        require("playwright-core");
    } catch { return "playwright-core is not in node_modules (npm ci puts it there)"; }
    if (!executable())
        return "no Chromium is installed (package chromium-headless-shell), or name one in LOSTBITS_CHROMIUM";
    return "";
}

/**
 * Milliseconds after which what does not come will not: a machine with other work takes far longer than an idle one.
 */
const patience = 600000;

/** A browser; with `bars` its pages have bars to scroll by. */
const launch = (bars = true) => require("playwright-core").chromium.launch({
    timeout: patience,
    executablePath: executable(),
    args: ["--no-sandbox"],  // root, in CI, has no sandbox
    ignoreDefaultArgs: bars ? ["--hide-scrollbars"] : []
});

/** The page of a file, with lists of what it asked for and what it complained about; `scripts`: whether they run. */
async function open(browser, file, { hash = "", scripts = true, width = 1280, height = 900 } = {}) {
    const context = await browser.newContext({ javaScriptEnabled: scripts, viewport: { width, height } });
    context.setDefaultTimeout(patience);
    context.setDefaultNavigationTimeout(patience);
    const page = Object.assign(await context.newPage(), { requested: [], complaints: [] });
    page.on("request", (r) => page.requested.push(r.url()));
    page.on("console", (m) => ["error", "warning"].includes(m.type()) && page.complaints.push(m.text()));
    page.on("pageerror", (e) => page.complaints.push(String(e)));
    await page.goto(pathToFileURL(path.resolve(file)).href + hash);
    if (scripts) await page.waitForSelector("html[data-ready]", { state: "attached" });
    return page;
}

const stateOf = (page) => page.evaluate(() => ({...state }));

/** Once all that was asked for is drawn: of keys, links and pointers too, which are told of it a little later. */
const settled = (page) => page.evaluate(async () => {
    await new Promise((done) => setTimeout(done, 40));
    for (let last = null; last !== drawing;) {
        last = drawing;
        await last;
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    }
});

/** Follows a link inside of the page. */
async function follow(page, hash) {
    await page.evaluate((hash) => void (location.hash = hash), hash);
    await settled(page);
}

/** Another window: the page draws itself anew a tenth of a second later. */
async function resize(page, width, height) {
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(120);
    await settled(page);
}

/** To six digits, and for ulps to a millionth: the page keeps t* - RN64(t*) as a float. */
const near = (a, b) => a === b || (Number.isNaN(a) && Number.isNaN(b)) || Math.abs(a - b) <= 1e-6 + 1e-6 * Math.abs(b);

/** What stands in an element's box on the page, in pixels. */
const boxOf = (page, selector) => page.$eval(selector, (e) => {
    const { left, right, top, bottom } = e.getBoundingClientRect();
    return { left, right, top, bottom };
});

/** By how many pixels the page is wider than its window. */
const sticksOut = (page) =>
    page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

module.exports = {
    boxOf,
    follow,
    launch,
    missing,
    near,
    open,
    resize,
    settled,
    stateOf,
    sticksOut,
    schoolbook : "#scene=near-benign&form=sphere.schoolbook&format=f32",
    sweep : "sphere-tilt"
};
