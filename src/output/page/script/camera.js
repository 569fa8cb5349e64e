// The ray of a pixel, as the program makes it: src/scene/rays/camera.hpp in the same order, over doubles or exact
// numbers.

const inDoubles = {
    of: (x) => x,
    exact: lift,
    add: (a, b) => a + b,
    sub: (a, b) => a - b,
    mul: (a, b) => a * b,
    div: (a, b) => a / b,
    sqrt: Math.sqrt,
};
const inExact = {
    of: readExact,
    exact: (x) => x,
    ...exactly
};

/** Origin and direction, six numbers of the arithmetic. */
function cameraRay(camera, x, y, arithmetic) {
    const { of, add, sub, mul, div, sqrt } = arithmetic;
    const whole = (n) => of(n), vec = (v) => v.map(of), half = div(whole(1), whole(2));
    const origin = vec(camera.origin), pitch = of(camera.pitch);
    const right = (from) => sub(add(whole(x), half), from), plus = (a, b) => a.map((p, k) => add(p, b[k]));
    if (camera.kind === "pixel_plane") {
        const across = add(of(camera.left), mul(add(whole(x), half), pitch)),
              down = sub(of(camera.top), mul(add(whole(y), half), of(camera.pitch_down)));
        return [...origin, sub(across, origin[0]), sub(down, origin[1]), sub(whole(0), origin[2])];
    }
    const a = mul(right(of(camera.centre_x)), pitch), b = mul(sub(of(camera.centre_y), add(whole(y), half)), pitch);
    const across = vec(camera.right), up = vec(camera.up), forward = vec(camera.forward);
    const aside = across.map((p, k) => add(mul(a, p), mul(b, up[k])));
    if (camera.kind === "orthographic") return [...plus(origin, aside), ...forward];
    const d = plus(forward, aside);
    if (!camera.normalise) return [...origin, ...d];
    const size = sqrt(add(add(mul(d[0], d[0]), mul(d[1], d[1])), mul(d[2], d[2])));
    return [...origin, ...d.map((p) => div(p, size))];
}

/** d/|d|, each component correctly rounded. */
function unitDirection(d, format) {
    const [x, y, z] = d.map(lift), size = exactly.sqrt(exactly.fma(z, z, exactly.fma(y, y, exactly.mul(x, x))));
    return d.map((p) => (p === 0 ? p : toFormat(exactly.div(lift(p), size), format)));
}

/**
 * What a form is given in a format: the ray of a pixel and the numbers of a solid. Shared inputs pass through
 * binary32.
 */
function formInputs(map, row, x, y, solid) {
    const own = map.inputs === "own", through = (v) => toFormat(own ? v : lift(toFormat(v, binary32)), row);
    const arithmetic = own ? inExact : inDoubles,
          ray = cameraRay(map.camera, x, y, arithmetic).map((v) => through(arithmetic.exact(v)));
    const direction = row.direction === "unit" ? unitDirection(ray.slice(3), row) : ray.slice(3);
    return [...ray.slice(0, 3), ...direction, ...map.solids[solid].map((v) => through(readExact(v))), Infinity];
}
