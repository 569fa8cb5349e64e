// three 0.187.0, src/math/Ray.js:313, Ray.intersectSphere: d2 = |L|^2 - tca^2 subtracts two squares of the distance, so
// from far away it misses spheres that Ray.intersectsSphere, thirty lines on, hits. Mesh.raycast, which is in
// src/objects/Mesh.js:267, culls by the first. A limit of the formula, with the better one beside it.
//   npm install three@0.187.0 && node three.mjs                (or LOSTBITS_NPM=the folder that holds node_modules)
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const folder = process.env.LOSTBITS_NPM || process.cwd();
const math = async (name) =>
    (await import(pathToFileURL(join(folder, 'node_modules/three/src/math', `${name}.js`)).href))[name];
const [Ray, Sphere, Vector3] = await Promise.all(['Ray', 'Sphere', 'Vector3'].map(math));

/// As in Ray.js, with the square of the perpendicular in place of the difference of squares; t or null.
const mended = (ray, sphere) => {
    const l = sphere.center.clone().sub(ray.origin), tca = l.dot(ray.direction);
    const d2 = l.addScaledVector(ray.direction, -tca).lengthSq(), r2 = sphere.radius ** 2;
    if (d2 > r2) return null;
    const thc = Math.sqrt(r2 - d2);
    return tca + thc < 0 ? null : tca - thc < 0 ? tca + thc : tca - thc;
};

let state = 1;  // Lehmer's numbers, so that every run has the same rays
const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
for (const distance of [2 ** 20, 2 ** 24, 2 ** 26, 2 ** 28]) {
    const n = 10000;
    const missed = { intersectSphere: 0, intersectsSphere: 0, mended: 0 };
    for (let i = 0; i < n; ++i) {
        const d = new Vector3(random() - 0.5, random() - 0.5, random() - 0.5).normalize();
        const aside = new Vector3(random() - 0.5, random() - 0.5, random() - 0.5).cross(d).setLength(0.9 * random());
        const sphere = new Sphere(d.clone().multiplyScalar(distance).add(aside), 1);  // 0.1 radii from the silhouette
        const ray = new Ray(new Vector3(), d);
        missed.intersectSphere += ray.intersectSphere(sphere, new Vector3()) === null;
        missed.intersectsSphere += !ray.intersectsSphere(sphere);
        missed.mended += mended(ray, sphere) === null;
    }
    console.log(`${distance} radii away, ${n} rays at most 0.9 radii off the centre: expected 0 misses, got ` +
        `${missed.intersectSphere} by intersectSphere, ${missed.intersectsSphere} by intersectsSphere, ` +
        `mended ${missed.mended}`);
}
