// Serves a function of one ray behind a pipe (docs/pipe.md), in node:
//   import { serve } from "./lostbits_pipe.mjs";
//   serve({ name: "mylib.sphere", roots: "first" }, (origin, direction, sphere) => …);
// The function returns t, [near, far] or true for a hit; null, undefined or false for a miss. Print only to standard
// error (console.error).
import {readSync, writeSync} from "node:fs";

/** Reads exactly `bytes` bytes of standard input into a new buffer. Returns undefined if the input has ended. */
export function read(bytes) {
    const buffer = new ArrayBuffer(bytes), view = new Uint8Array(buffer);
    for (let got = 0; got < bytes;) {
        let more = 0;
        try {
            more = readSync(0, view, got, bytes - got);
        } catch (error) {
            if (error.code === "EAGAIN") continue;
            if (error.code !== "EOF") throw error;
        }
        if (more === 0) return undefined;
        got += more;
    }
    return buffer;
}

/** Writes all bytes of a Uint8Array to standard output. */
export function write(view) {
    for (let put = 0; put < view.length;) {
        try {
            put += writeSync(1, view, put, view.length - put);
        } catch (error) {
            if (error.code !== "EAGAIN") throw error;
        }
    }
}

const minus = (a, b) => a.map((x, k) => x - b[k]);
const primitives = {
    sphere: ([x, y, z, radius]) => ({ centre: [x, y, z], radius }),
    box: ([x, y, z, a, b, c]) => ({ lo: [x, y, z], hi: [a, b, c] }),
    ellipsoid: (n) => ({ centre: n.slice(0, 3), radii: n.slice(3), radius: Math.max(...n.slice(3)) }),
    cylinder: (n) => ({ base: n.slice(0, 3), top: n.slice(3, 6), radius: n[6] }),
    capsule: (n) => ({ start: n.slice(0, 3), end: n.slice(3, 6), radius: n[6] }),
    tube: (n) => ({ bottom: n.slice(0, 3), top: n.slice(3, 6), radius: n[6] }),
    cone: (n) => ({ base: n.slice(0, 3), top: n.slice(3, 6), base_radius: n[6], top_radius: n[7],
                    radius: Math.max(n[6], n[7]) }),
    disc: (n) => ({ centre: n.slice(0, 3), normal: n.slice(3, 6), outer_radius: n[6], inner_radius: n[7], radius: n[6] }),
    plane: (n) => ({ through: n.slice(0, 3), normal: n.slice(3) }),
    torus: (n) => ({ centre: n.slice(0, 3), axis: n.slice(3, 6), major_radius: n[6], minor_radius: n[7],
                     radius: n[6] + n[7] }),
    triangle: (n) => ({ a: n.slice(0, 3), b: n.slice(3, 6), c: n.slice(6) }),
};
/** Distance from the origin to a point behind the primitive: the distance of its middle plus its diameter or
    diagonal, or `end` if that is nearer. */
function reach(origin, primitive, end) {
    const low = primitive.centre ?? primitive.lo ?? primitive.base ?? primitive.start ?? primitive.bottom;
    const high = primitive.centre ?? primitive.hi ?? primitive.top ?? primitive.end;
    const middle = low.map((x, k) => (x + high[k]) / 2);
    const across = Math.hypot(...minus(high, low)) + 2 * (primitive.radius ?? 0);
    return Math.min(end, Math.hypot(...minus(middle, origin)) + across);
}

/** Converts the answer of a function to [near, far] in t. Numbers are multiplied by `length`; points are not. */
const answers = {
    t: (a, { length }) => [a, a].flat().slice(0, 2).map((t) => t * length),
    thickness: ([near, thickness], { length }) => [near * length, (near + thickness) * length],
    point: (point, { origin, direction }) => {
        const size = direction.map(Math.abs), k = size.indexOf(Math.max(...size));
        const t = (p) => (p[k] - origin[k]) / direction[k];
        return Array.isArray(point[0]) ? point.map(t) : [t(point), t(point)];
    },
};

/**
 * Answers batches with `mine(origin, direction, primitive, end, start)`, where `start` is 0 without `flags: "range"`.
 * If `takes` is "segment", calls `mine(from, to, primitive)`, and t and thickness are fractions of the segment's
 * length. `answers` says what `mine` returns: "t", "point" or "thickness". The other properties are keys of the header.
 * Numbers are doubles.
 */
export function serve({takes = "ray", answers: told = "t", ...words}, mine) {
    const keys = { shape: "sphere", direction: takes === "segment" ? "unit" : "any", ...words, format: "f64" };
    const { name, ...rest } = keys;
    if (takes === "segment" && ["triangle", "plane"].includes(keys.shape))
        throw new Error(`a ${keys.shape} gives a segment no end behind it; use takes: "ray"`);
    const lines = ["lostbits-pipe/1", `name=${name}`, ...Object.entries(rest).map(([k, v]) => `${k}=${v}`), "", ""];
    write(new TextEncoder().encode(lines.join("\n")));
    const primitive_of = primitives[keys.shape], t_of = answers[told];
    const width = { sphere: 4, box: 6, triangle: 9, ellipsoid: 6, cylinder: 7, capsule: 7, tube: 7, cone: 8, disc: 8,
                    plane: 6, torus: 8 }[keys.shape];
    const ranged = (keys.flags ?? "").split(",").includes("range");
    for (let request = read(20); request; request = read(20)) {
        const [, , n, many, ended] = new Uint32Array(request);  // magic, form, rays, primitives, ends
        const rays = new Float64Array(read(48 * n));
        const starts = new Float64Array(ranged ? read(8 * ended) : 0), ends = new Float64Array(read(8 * ended));
        const numbers = new Float64Array(read(8 * width * many));
        const bytes = new Uint8Array(8 + 17 * n);
        bytes.set(new TextEncoder().encode("LBA1"));
        const near_far = new Float64Array(bytes.buffer, 8, 2 * n);
        for (let i = 0; i < n; ++i) {
            const [origin, direction] = [0, 3].map((k) => [...rays.subarray(6 * i + k, 6 * i + k + 3)]);
            const first = many === 1 ? 0 : width * i, primitive = primitive_of([...numbers.subarray(first, first + width)]);
            const end = ended ? ends[i] : Infinity;
            const length = takes === "segment" ? reach(origin, primitive, end) : 1;
            const answer = takes === "segment" ? mine(origin, origin.map((x, k) => x + length * direction[k]), primitive) :
                                                 mine(origin, direction, primitive, end, starts[i] ?? 0);
            if (answer === undefined || answer === null || answer === false) continue;
            bytes[8 + 16 * n + i] = 1;
            if (answer !== true) near_far.set(t_of(answer, { origin, direction, length }), 2 * i);
        }
        write(bytes);
    }
}
