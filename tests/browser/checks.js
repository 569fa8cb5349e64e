// node checks.js PROGRAM DATA FOLDER [PROMISE...]: makes pages in FOLDER and checks every promise on them. With
// PROMISE, checks only those promises, on the pages that are already there. All use one browser; each promise opens its
// own pages.
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { launch, missing, open, sweep } = require("./browser.js");
const operations = require("./operations.js");

const [program, data, folder, ...named] = process.argv.slice(2);
const at = (file) => path.join(folder, file);
const lostbits = (...args) => execFileSync(program, ["--data", at("data"), "-q", ...args], { encoding: "utf8" });

const forms = ["-i", "sphere.schoolbook", "-i", "sphere.unified", "-i", "sphere.unit_half_b"],
      march = ["-i", "sdf.sphere_trace"], three = ["-f", "f32", "-f", "f64", "-f", "bf16"],
      two = ["-f", "f32", "-f", "f64"];
const grids = ["sphere-height", "box-boundary", "extremes/contact"],
      gridForms = ["-i", "sphere.schoolbook", "-i", "sphere.unified", "-i", "box.baseline", "-i", "box.signs"];

/** A scene of one sphere, `depth` in front of the eye (below 0: behind it), with an extreme title. */
const oddScene = (width, height, depth) =>
    `schema = "lostbits-scene/1"
title = "A title with <b>markup</b>, ${
    "no_place_to_break_it_".repeat(8)} and more words than any line holds, of a picture of ${width} by ${height}"
source = "-"
size = [${width}, ${height}]
[camera]
kind = "pinhole"
eye = [0, 0, 0]
look_at = [0.1, 0, -4]
up = [0, 1, 0]
fov_deg = 45
[[sphere]]
centre = [0, 0, ${
        - depth}]
radius = 1
`;

/** Writes a shipped sweep with other numbers to a file. */
function changedSweep(file, name, changes) {
    let text = fs.readFileSync(path.join(data, "sweeps", `${name}.toml`), "utf8");
    for (const [key, was, is] of changes) {
        assert.ok(text.includes(`\n${key} = ${was}\n`), `${name}: ${key}`);
        text = text.replace(`\n${key} = ${was}\n`, `\n${key} = ${is}\n`);
    }
    fs.writeFileSync(at(file), text);
    return at(file);
}

/**
 * Makes the pages. `report` is a typical page. `small` is compared pixel by pixel with files of `lostbits map`, and
 * `grids` cell by cell with files of `lostbits sweep`. `large` is timed. `taped` has rays of every kind. `odd` has
 * extreme inputs.
 */
function makePages() {
    fs.rmSync(folder, { recursive: true, force: true });
    fs.cpSync(data, at("data"), { recursive: true });
    // A quarter of its rays is enough: all cells are checked, and the claims still hold.
    changedSweep("data/sweeps/sphere-height.toml", "sphere-height", [["views", 256, 64]]);
    fs.writeFileSync(at("data/scenes/few.toml"), oddScene(16, 12, 5));
    const page = (name, ...args) => lostbits("report", ...args, "-o", at(name));
    const once = ["--seeds", "0"], one = ["-i", "sphere.unified", "-f", "f32"];
    page(
        "report", "near-benign", "rtg-fig-7-3-4100-oblique", sweep, ...forms, ...two, "--seeds", "1", "--claims",
        "tilt.*,rtg7.fig3*,rtg7.roots.*,shader.unit-half-b*", "--trade", "--choose", "few:18", "--mend",
        "few:sphere.half_b:16", "--offsets", "few");
    lostbits("mend", "box-slabs", "-i", "box.baseline", "--bits", "20", "--size", "8x8", "-o", at("mend"));
    page("large", "near-benign", ...one, "--size", "512x512", "--no-claims");
    page("taped", ...operations.taped);
    page("grids", ...grids, ...gridForms, ...two, ...once);
    // The page shows commands with this path, which is wider than the window.
    const far = `odd/${"no_place_to_break_it_".repeat(4)}`;
    fs.mkdirSync(at(far), { recursive: true });
    fs.writeFileSync(at(`${far}/one-pixel.toml`), oddScene(1, 1, 5));
    fs.writeFileSync(at(`${far}/no-hit.toml`), oddScene(24, 16, -5));
    // Numbers of these formats are computed one at a time, so a few rays per step must do.
    const plane = changedSweep("odd/sphere-height.toml", "sphere-height", [["views", 256, 1]]),
          steps = changedSweep("odd/sdf-max-steps.toml", "sdf-max-steps", [["views", 256, 16], ["steps", 64, 16]]);
    page(
        "odd", at(`${far}/one-pixel.toml`), at(`${far}/no-hit.toml`), plane, "box-boundary", steps, ...forms, ...march,
        "-i", "sphere.hearn_baker", "-i", "box.signs", "-f", "p2", "-f", "p40", "-f", "f32", "--no-claims");
    page("odd/sweep", sweep, ...one, ...once, "--no-claims");
    page("odd/cases", "box-boundary", "-i", "box.signs", "-f", "f32", "--no-claims");
    lostbits("sweep", grids[0], ...gridForms, ...two, ...once, "--pictures", "all", "-o", at("sweep"));
    lostbits("sweep", ...grids.slice(1), ...gridForms, ...two, ...once, "-o", at("sweep"));
    lostbits("sweep", sweep, ...forms, ...two, ...once, "-o", at("sweep"));
    const drawn = (...metrics) => metrics.flatMap((m) => ["--metric", m]), size = ["--size", "72x56"],
          map = (folder, ...args) => lostbits("map", ...args, ...size, "-o", at(folder));
    page(
        "small", "near-benign", "world-offset", "sdf-sphere", ...forms, ...march, ...three, ...size,
        ...drawn("residual", "culprit"), "--no-claims");
    const columns = ["lost_bits", "ulp_error", "excess_bits", "inherent_bits", "condition"];
    map("map", "near-benign", "world-offset", ...forms, ...three, ...drawn(...columns, "culprit"), "--pixels", "csv");
    map("map", "sdf-sphere", ...forms, ...march, ...three, ...drawn(...columns, "iterations", "stop"), "--pixels",
        "csv");
    // All forms together, because the colours depend on the operations of all of them.
    map("pictures", "near-benign", ...forms, ...three, ...drawn("lost_bits", "ulp_error", "culprit"), "--pictures",
        "all");
    map("pictures", "sdf-sphere", ...march, "-f", "f32", ...drawn("iterations", "stop"), "--pictures", "all");
}

/** Checks a promise. Returns true if the pages keep it. */
async function keeps(browser, name, promise) {
    const begun = Date.now(), opened = [];
    const opens = async (page, options) => {
        opened.push(await open(browser, at(`${page}/index.html`), options));
        return opened.at(-1);
    };
    try {
        await promise({ open: opens, at, lostbits });
    } catch (error) {
        console.error(`${name}: ${error.stack ?? error}`);
        return false;
    } finally {
        for (const page of opened) await page.context().close();
    }
    console.log(`${name}: kept, ${((Date.now() - begun) / 1000).toFixed(1)} s`);
    return true;
}

async function main() {
    const lack = missing();
    if (lack) {
        console.log(`skipped: ${lack}`);
        return 77;
    }
    const all = ["maps", "sweeps", "operations", "whole", "manners", "result"].flatMap(
        (file) => Object.entries(require(`./${file}.js`).promises));
    const unknown = named.filter((name) => !all.some(([known]) => known === name));
    if (unknown.length > 0)
        throw new Error(`unknown promise ${unknown}; known are ${all.map(([known]) => known).join(", ")}`);
    if (named.length === 0) makePages();
    const asked = all.filter(([name]) => named.length === 0 || named.includes(name)), browser = await launch();
    let kept = 0;
    try {
        for (const [name, promise] of asked) kept += await keeps(browser, name, promise);
    } finally { await browser.close(); }
    console.log(`${kept} of ${asked.length} promises kept`);
    return kept === asked.length ? 0 : 1;
}

main().then((code) => (process.exitCode = code), (error) => {
    console.error(error.stack ?? error);
    process.exitCode = 1;
});
