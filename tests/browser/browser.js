// Opens pages from files in a headless Chromium, and collects what goes wrong on them.
"use strict";

const fs = require("node:fs");
const path = require("node:path");
const { pathToFileURL } = require("node:url");

const candidates =
    ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executable = () => process.env.LOSTBITS_CHROMIUM || candidates.find((c) => fs.existsSync(c));

/** Returns a sentence about what this machine lacks for the tests, or "" if nothing is missing. */
function missing() {
    try {
        require("playwright-core");
    } catch { return "playwright-core is not in node_modules; npm ci installs it"; }
    if (!executable())
        return "Chromium is missing; install chromium-headless-shell, or set LOSTBITS_CHROMIUM to another one";
    return "";
}

/** Time limit in milliseconds for everything that is waited for. A busy machine takes far longer than an idle one. */
const patience = 600000;

/** Starts a browser. With `bars`, its pages have scroll bars. */
const launch = (bars = true) => require("playwright-core").chromium.launch({
    timeout: patience,
    executablePath: executable(),
    args: ["--no-sandbox"],  // root, as in CI, has no sandbox
    ignoreDefaultArgs: bars ? ["--hide-scrollbars"] : []
});

/** Opens a file as a page, with lists of its requests and complaints. `scripts`: true to run its scripts. */
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

/** Waits until everything is drawn, also after keys, links and pointers, whose events arrive a little later. */
const settled = (page) => page.evaluate(async () => {
    await new Promise((done) => setTimeout(done, 40));
    for (let last = null; last !== drawing;) {
        last = drawing;
        await last;
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    }
});

/** Follows a link within the page. */
async function follow(page, hash) {
    await page.evaluate((hash) => void (location.hash = hash), hash);
    await settled(page);
}

/** Resizes the window. The page redraws a tenth of a second later. */
async function resize(page, width, height) {
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(120);
    await settled(page);
}

/** Compares to six digits, and ulps to a millionth, since the page keeps t* - RN64(t*) as a float. */
const near = (a, b) => a === b || (Number.isNaN(a) && Number.isNaN(b)) || Math.abs(a - b) <= 1e-6 + 1e-6 * Math.abs(b);

/** The box of an element on the page, in pixels. */
const boxOf = (page, selector) => page.$eval(selector, (e) => {
    const { left, right, top, bottom } = e.getBoundingClientRect();
    return { left, right, top, bottom };
});

/** Pixels by which the page is wider than its window. */
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
    schoolbook : "#scene=near-benign&form=sphere.schoolbook&format=f32&other=",
    sweep : "sphere-tilt"
};
