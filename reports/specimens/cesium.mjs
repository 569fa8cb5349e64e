// @cesium/engine 26.3.0, Source/Core/IntersectionTests.js: four answers that contradict its own words.
//   npm install @cesium/engine@26.3.0 && node cesium.mjs       (or LOSTBITS_NPM=the folder that holds node_modules)
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const folder = process.env.LOSTBITS_NPM || process.cwd();
const core = async (name) =>
    (await import(pathToFileURL(join(folder, 'node_modules/@cesium/engine/Source/Core', `${name}.js`)).href)).default;
const [tests, V, Ray, Ellipsoid, Sphere, Box] = await Promise.all(
    ['IntersectionTests', 'Cartesian3', 'Ray', 'Ellipsoid', 'BoundingSphere', 'AxisAlignedBoundingBox'].map(core));
const ray = (o, d) => new Ray(new V(...o), new V(...d));
const said = (i) => (i === undefined ? 'undefined' : `[${i.start}, ${i.stop}]`);
const show = (what, expected, got) => console.log(`${what}\n  expected ${expected}\n  got      ${said(got)}`);

// :491 tells -qw / w2; with q2 = 1 the equation w2 t^2 + 2 qw t = 0 has the root -2 qw / w2.
show('rayEllipsoid, unit sphere, from (1, 0, 0) on it, through its centre', '[0, 2]',
    tests.rayEllipsoid(ray([1, 0, 0], [-1, 0, 0]), new Ellipsoid(1, 1, 1)));
show('rayEllipsoid, the same from an ulp outside', '[2.220446049250313e-16, 2.0000000000000004]',
    tests.rayEllipsoid(ray([1 + 2 ** -52, 0, 0], [-1, 0, 0]), new Ellipsoid(1, 1, 1)));

// :509 "or undefined if there are no intersections", but nothing asks whether the box is behind; raySphere asks.
const box = new Box(new V(-1, -1, -1), new V(1, 1, 1));
show('rayAxisAlignedBoundingBox, a box behind the ray', 'undefined',
    tests.rayAxisAlignedBoundingBox(ray([5, 0, 0], [1, 0, 0]), box));
show('raySphere, a sphere behind the ray', 'undefined',
    tests.raySphere(ray([5, 0, 0], [1, 0, 0]), new Sphere(new V(0, 0, 0), 1)));

// :567 divides 0 by 0 where the ray runs in the plane of a face; what then happens depends on the axis and on the sign.
for (const zero of [0, -0]) {
    for (const [axis, o, d] of [['x', [-1, -3, 0.5], [zero, 1, 0]], ['y', [-3, -1, 0.5], [1, zero, 0]],
        ['z', [0.5, -3, -1], [0, 1, zero]]]) {
        show(`rayAxisAlignedBoundingBox, in the face ${axis} = -1, direction ${Object.is(zero, -0) ? '-0' : '+0'}`,
            '[2, 4]', tests.rayAxisAlignedBoundingBox(ray(o, d), box));
    }
}

// :299 tells "undefined" for a tangent at t = 0, and any other tangent a hit.
const s = new Sphere(new V(0, 0, 0), 1);
show('raySphere, touching at t = 0', '[0, 0]', tests.raySphere(ray([1, 0, 0], [0, 1, 0]), s));
show('raySphere, touching at t = 1', '[1, 1]', tests.raySphere(ray([1, -1, 0], [0, 1, 0]), s));
// :280 asks det < 0, then det > 0; NaN, from squares that overflow, falls into the branch of the tangent: a hit.
show('raySphere, a sphere of radius 1e154 missed by 1e155', 'undefined',
    tests.raySphere(ray([-3e155, 1.1e155, 0], [1, 0, 0]), new Sphere(new V(0, 0, 0), 1e154)));
