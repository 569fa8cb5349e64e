// Reads the files that the page is compared with, without any code of the page.
"use strict";

const fs = require("node:fs");

/** Reads a CSV file by RFC 4180. Returns an object of columns for each row. */
function readCsv(file) {
    const rows = [[]];
    for (const [, quoted, plain, end] of fs.readFileSync(file, "utf8")
             .matchAll(/(?:"((?:[^"]|"")*)"|([^",\n]*))(,|\n)/g)) {
        rows.at(-1).push(quoted?.replaceAll("\"\"", "\"") ?? plain);
        if (end === "\n") rows.push([]);
    }
    rows.pop();
    const [names, ...body] = rows;
    return body.map((cells) => Object.fromEntries(names.map((name, k) => [name, cells[k]])));
}

/**
 * Returns true if a field of colours (0xRRGGBB, or null for any) lies somewhere in a PNG, as a browser decodes it. At
 * most `most` cells may differ. It may lie there in one of several `ways`: cell k is in column k % columns, each cell
 * is `w` x `h` pixels, and its pixel at (`at`, `at`) is compared.
 */
const liesIn = (page, file, cells, ways, most = 0) => page.evaluate(async ([base64, cells, ways, most]) => {
    const image = Object.assign(new Image(), { src: `data:image/png;base64,${base64}` });
    await image.decode();
    const { width, height } = image, context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, width, height),
                 rgb = (x, y, i = 4 * (y * width + x)) => (data[i] << 16) | (data[i + 1] << 8) | data[i + 2];
    const isAt = (x0, y0, { columns, w, h, at }) => {
        let wrong = 0;
        return cells.every((colour, k) => {
            const x = x0 + (k % columns) * w + at, y = y0 + Math.floor(k / columns) * h + at;
            wrong += colour !== null && (x >= width || y >= height || rgb(x, y) !== colour);
            return wrong <= most;
        });
    };
    for (let i = 0; i < width * height; ++i)
        if (ways.some((way) => isAt(i % width, Math.floor(i / width), way))) return true;
    return false;
}, [fs.readFileSync(file, "base64"), cells, ways, most]);

/** Reads a number from a cell of a CSV, or from the value that JSON has for it. */
function readNumber(cell) {
    if (cell === "" || cell === "nan" || cell === null) return NaN;
    return cell === "inf" ? Infinity : cell === "-inf" ? -Infinity : Number(cell);
}

module.exports = {
    liesIn,
    readCsv,
    readNumber
};
