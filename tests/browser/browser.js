// A headless Chromium on a page from a file, and what went wrong while it was there.
"use strict";

const fs = require("node:fs");
const path = require("node:path");
const { pathToFileURL } = require("node:url");

const candidates =
    ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** What the tests need and this machine lacks, in a sentence; nothing when all is there. */
function missing() {
    try {
        require("playwright-core");
    } catch { return "playwright-core is not in node_modules (npm ci puts it there)"; }
    if (!executable())
        return "no Chromium is installed (package chromium-headless-shell), or name one in LOSTBITS_CHROMIUM";
    return "";
}

function executable() {
    const named = process.env.LOSTBITS_CHROMIUM;
    return named ? named : candidates.find((c) => fs.existsSync(c));
}

class Browser {
    /** With `bars` a page has bars to scroll by, which are hidden otherwise. */
    static async open({ bars = false } = {}) {
        const { chromium } = require("playwright-core");
        return new Browser(await chromium.launch({
            executablePath: executable(),
            args: ["--no-sandbox"],  // root, in CI, has no sandbox
            ignoreDefaultArgs: bars ? ["--hide-scrollbars"] : []
        }));
    }
    constructor(browser) { this.browser = browser; }
    /** The page of a file, with lists of what it asked for and what it complained about. */
    async page(file, { hash = "", scripts = true, width = 1280, height = 900 } = {}) {
        const context = await this.browser.newContext({ javaScriptEnabled: scripts, viewport: { width, height } });
        const page = await context.newPage();
        page.requested = [];
        page.complaints = [];
        page.on("request", (r) => page.requested.push(r.url()));
        page.on("console", (m) => ["error", "warning"].includes(m.type()) && page.complaints.push(m.text()));
        page.on("pageerror", (e) => page.complaints.push(String(e)));
        await page.goto(pathToFileURL(path.resolve(file)).href + hash);
        if (scripts) await page.waitForSelector("html[data-ready]", { timeout: 20000, state: "attached" });
        return page;
    }
    close() { return this.browser.close(); }
}

module.exports = {
    Browser,
    missing
};
