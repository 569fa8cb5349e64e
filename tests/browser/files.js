// The files that the page is held against, read without any code of the page.
"use strict";

const fs = require("node:fs");
const zlib = require("node:zlib");

/** RFC 4180, as objects by column. */
function readCsv(file) {
    const text = fs.readFileSync(file, "utf8"), rows = [[""]];
    let quoted = false;
    for (let i = 0; i < text.length; ++i) {
        const c = text[i], row = rows.at(-1);
        if (quoted && c === "\"" && text[i + 1] === "\"") row[row.length - 1] += text[++i];
        else if (c === "\"") quoted = !quoted;
        else if (!quoted && c === ",") row.push("");
        else if (!quoted && c === "\n") rows.push([""]);
        else row[row.length - 1] += c;
    }
    rows.pop();
    const [names, ...body] = rows;
    return body.map((cells) => Object.fromEntries(names.map((name, k) => [name, cells[k]])));
}

/** An 8-bit RGB PNG without interlace: { width, height, at(x, y) }. */
function readPng(file) {
    const bytes = fs.readFileSync(file), parts = [];
    let width = 0, height = 0;
    for (let at = 8; at < bytes.length; at += 12 + bytes.readUInt32BE(at)) {
        const type = bytes.toString("latin1", at + 4, at + 8),
              body = bytes.subarray(at + 8, at + 8 + bytes.readUInt32BE(at));
        if (type === "IHDR") {
            [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
            if (body[8] !== 8 || body[9] !== 2 || body[12] !== 0) throw new Error(`${file}: not 8-bit RGB`);
        }
        if (type === "IDAT") parts.push(body);
    }
    const raw = zlib.inflateSync(Buffer.concat(parts)), stride = 3 * width, pixels = Buffer.alloc(stride * height);
    const paeth = (a, b, c) => {
        const pa = Math.abs(b - c), pb = Math.abs(a - c), pc = Math.abs(a + b - 2 * c);
        return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
    };
    for (let y = 0; y < height; ++y) {
        const filter = raw[y * (stride + 1)];
        for (let k = 0; k < stride; ++k) {
            const a = k < 3 ? 0 : pixels[y * stride + k - 3], b = y === 0 ? 0 : pixels[(y - 1) * stride + k],
                  c = k < 3 || y === 0 ? 0 : pixels[(y - 1) * stride + k - 3];
            pixels[y * stride + k] = raw[y * (stride + 1) + 1 + k] + [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
        }
    }
    return {
        width,
        height,
        at: (x, y) =>
            (pixels[y * stride + 3 * x] << 16) | (pixels[y * stride + 3 * x + 1] << 8) | pixels[y * stride + 3 * x + 2]
    };
}

/** A cell of a CSV, or what JSON has for a number. */
function readNumber(cell) {
    if (cell === "" || cell === "nan" || cell === null) return NaN;
    return cell === "inf" ? Infinity : cell === "-inf" ? -Infinity : Number(cell);
}

module.exports = {
    readCsv,
    readNumber,
    readPng
};
