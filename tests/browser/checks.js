// node checks.js PROGRAM DATA FOLDER CHECK: makes the pages (`make`), or holds one of them to one promise.
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { Browser, missing } = require("./browser.js");
const operations = require("./operations.js");

const [program, data, folder, name] = process.argv.slice(2);
const at = (file) => path.join(folder, file);
const lostbits = (...args) => execFileSync(program, ["--data", data, "-q", ...args], { encoding: "utf8" });

const forms = ["-i", "sphere.schoolbook", "-i", "sphere.unified", "-i", "sphere.unit_half_b", "-i", "sdf.sphere_trace"];
const three = ["-f", "f32", "-f", "f64", "-f", "bf16"], two = ["-f", "f32", "-f", "f64"];
const sweep = "sphere-tilt";
const grids = ["sphere-height", "box-boundary", "extremes/contact"],
      gridForms = ["-i", "sphere.schoolbook", "-i", "sphere.unified", "-i", "box.baseline", "-i", "box.signs"];

/** A scene of one sphere, `depth` in front of the eye (below 0: behind it), with a title that nobody foresaw. */
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

/**
 * `report` is one as a reader would make it; `small` is compared pixel by pixel with what `lostbits map` writes,
 * `grids` cell by cell with `lostbits sweep`; `large` is timed; `taped` has every form; `odd` is what nobody would make
 * on purpose.
 */
function make() {
    fs.rmSync(folder, { recursive: true, force: true });
    const once = ["--seeds", "0"];
    lostbits(
        "report", "near-benign", "rtg-fig-7-3-4100-oblique", "sdf-sphere", sweep, ...forms, ...two, "--seeds", "1",
        "--claims", "tilt.*,rtg7.*,sdf3.*,every.*,shader.unit-half-b-nearest*", "--trade", "--choose", "near-benign:18",
        "--mend", "rtg-fig-7-3-4100-oblique:sphere.half_b:16", "--offsets", "offset-tiny,offset-thin-box", "-o",
        at("report"));
    lostbits("mend", "box-slabs", "-i", "box.baseline", "--bits", "20", "--size", "24x24", "-o", at("mend"));
    lostbits(
        "report", "near-benign", "-i", "sphere.unified", "-f", "f32", "--size", "512x512", "--no-claims", "-o",
        at("large"));
    lostbits(...operations.pageOf, "-o", at("taped"));
    lostbits("report", ...grids, ...gridForms, ...two, ...once, "-o", at("grids"));
    fs.mkdirSync(at("odd"), { recursive: true });
    // Commands with this path stand on the page, whose window is narrower than the path.
    const far = `odd/${"no_place_to_break_it_".repeat(4)}`;
    fs.mkdirSync(at(far), { recursive: true });
    fs.writeFileSync(at(`${far}/one-pixel.toml`), oddScene(1, 1, 5));
    fs.writeFileSync(at(`${far}/no-hit.toml`), oddScene(24, 16, -5));
    // A plane of every form in numbers that are worked out one at a time: four rays a step are enough to look at.
    const plane = fs.readFileSync(path.join(data, "sweeps/sphere-height.toml"), "utf8");
    assert.match(plane, /^views = 256$/m);
    fs.writeFileSync(at("odd/sphere-height.toml"), plane.replace(/^views = 256$/m, "views = 4"));
    lostbits(
        "report", at(`${far}/one-pixel.toml`), at(`${far}/no-hit.toml`), at("odd/sphere-height.toml"), "box-boundary",
        "sdf-max-steps", "-i", "sphere.*", "-i", "box.signs", "-i", "sdf.sphere_trace", "-f", "p2", "-f", "p40", "-f",
        "f32", "--no-claims", "-o", at("odd"));
    lostbits("report", sweep, "-i", "sphere.unified", "-f", "f32", ...once, "--no-claims", "-o", at("odd/sweep"));
    lostbits("report", "box-boundary", "-i", "box.signs", "-f", "f32", "--no-claims", "-o", at("odd/cases"));
    lostbits("sweep", ...grids, ...gridForms, ...two, ...once, "-o", at("sweep"));
    lostbits("sweep", sweep, ...forms, ...two, ...once, "-o", at("sweep"));
    const drawn = (...metrics) => metrics.flatMap((m) => ["--metric", m]), size = ["--size", "72x56"];
    const errors = drawn("lost_bits", "ulp_error", "excess_bits", "inherent_bits", "condition"),
          rest = [...size, "--pixels", "csv", "--pictures", "all", "-o", at("map")];
    lostbits(
        "report", "near-benign", "world-offset", "grazing", "sdf-sphere", ...forms, ...three, ...size, "--metric",
        "residual", "--metric", "culprit", "--no-claims", "-o", at("small"));
    lostbits(
        "map", "near-benign", "world-offset", "grazing", ...forms, ...three, ...errors, ...drawn("culprit"), ...rest);
    lostbits("map", "sdf-sphere", ...forms, ...three, ...errors, ...drawn("iterations", "stop"), ...rest);
}

async function main() {
    const lack = missing();
    if (lack) {
        console.log(`skipped: ${lack}`);
        return 77;
    }
    if (name === "make") {
        make();
        return 0;
    }
    const checks = {
        ...require("./maps.js"),
        ...require("./sweeps.js"),
        ...require("./grids.js"),
        ...require("./whole.js"),
        ...require("./manners.js"),
        ...require("./result.js"),
        ...operations.promises
    };
    if (!checks[name]) throw new Error(`no check is called ${name}; there are ${Object.keys(checks).join(", ")}`);
    const browser = await Browser.open();
    try {
        await checks[name]({
            browser,
            at,
            lostbits,
            report: at("report/index.html"),
            small: at("small/index.html"),
            large: at("large/index.html"),
            taped: at("taped/index.html"),
            grids: at("grids/index.html"),
            odd: at("odd/index.html"),
            sweep
        });
    } finally { await browser.close(); }
    return 0;
}

main().then((code) => (process.exitCode = code), (error) => {
    console.error(`${name}: ${error.stack ?? error}`);
    process.exitCode = 1;
});
