// node tests/browser/screenshots.js REPORT.html FOLDER: takes the pictures of reports/screenshots from a page in a
// browser.
"use strict";

const path = require("node:path");
const { launch, missing, open } = require("./browser.js");

const views = [
    {
        name: "maps",
        hash:
            "#scene=rtg-fig-7-3-4100-oblique&form=sphere.schoolbook&format=f32&other=sphere.half_b.f64&split=0.6&x=110&y=120",
        height: 1020
    },
    {
        name: "operations",
        hash: "#scene=rtg-fig-7-3-4100-oblique&form=sphere.schoolbook&format=f32&metric=culprit&x=153&y=38",
        at: "#maps",
        height: 1820
    },
    {
        name: "sweeps",
        hash: "#sweep=sphere-distance&statistic=lost_bits_p99&form=sphere.unified&format=f32",
        at: "#sweeps",
        height: 720
    },
    { name: "claims", at: "#claims", height: 720 },
];

async function main([report, folder]) {
    if (!folder) throw new Error("usage: node tests/browser/screenshots.js REPORT.html FOLDER");
    const lack = missing();
    if (lack) throw new Error(lack);
    const browser = await launch(false);
    try {
        for (const view of views) {
            const page = await open(browser, report, { hash: view.hash, height: view.height });
            if (view.at) await page.$eval(view.at, (e) => e.scrollIntoView());
            await page.waitForTimeout(300);  // the small pictures are drawn after the large one
            await page.screenshot({ path: path.join(folder, view.name + ".png") });
            await page.context().close();
        }
    } finally { await browser.close(); }
}

main(process.argv.slice(2)).catch((error) => {
    console.error(String(error.message ?? error));
    process.exitCode = 2;
});
