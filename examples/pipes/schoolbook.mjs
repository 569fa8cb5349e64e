#!/usr/bin/env node
// A ray/sphere intersector in JavaScript behind a pipe:
//   lostbits map near-benign --pipe 'node examples/pipes/schoolbook.mjs' -o out
// Replace `schoolbook` by your own function. Print only to standard error (console.error).
import { read, write } from "./lostbits_pipe.mjs";

/** Returns the first t >= 0 at which the ray hits the sphere, or undefined. Numbers of JavaScript are doubles. */
function schoolbook(ox, oy, oz, dx, dy, dz, x, y, z, radius) {
    const fx = ox - x, fy = oy - y, fz = oz - z;
    const a = dx * dx + dy * dy + dz * dz;
    const b = 2 * (fx * dx + fy * dy + fz * dz);
    const c = fx * fx + fy * fy + fz * fz - radius * radius;
    const disc = b * b - 4 * a * c;
    if (disc < 0) return undefined;
    const near = (-b - Math.sqrt(disc)) / (2 * a), far = (-b + Math.sqrt(disc)) / (2 * a);
    const t = near < 0 ? far : near;
    return t < 0 ? undefined : t;
}

const header = ["lostbits-pipe/1", "name=js.schoolbook", "shape=sphere", "format=f64", "roots=first",
    "title=the schoolbook formula in JavaScript", "", ""].join("\n");

write(new TextEncoder().encode(header));
for (let request = read(20); request; request = read(20)) {
    const [, , n, primitives, ends] = new Uint32Array(request);  // magic, form, rays, primitives, ends
    const rays = new Float64Array(read(48 * n));
    if (ends > 0) read(8 * ends);  // ends of the rays, not used here
    const spheres = new Float64Array(read(32 * primitives));
    const answer = new ArrayBuffer(8 + 17 * n);
    new Uint8Array(answer).set(new TextEncoder().encode("LBA1"));
    const nearFar = new Float64Array(answer, 8, 2 * n), hit = new Uint8Array(answer, 8 + 16 * n, n);
    for (let i = 0; i < n; ++i) {
        const s = primitives === 1 ? 0 : 4 * i;
        const t = schoolbook(...rays.subarray(6 * i, 6 * i + 6), ...spheres.subarray(s, s + 4));
        hit[i] = t === undefined ? 0 : 1;
        nearFar[2 * i] = t ?? 0;
    }
    write(new Uint8Array(answer));
}
