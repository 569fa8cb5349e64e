// @babylonjs/core 9.34.0, Culling/ray.core.js:64: a component of the direction below 1e-7 counts as parallel to the
// axis, however far the box is and however long the direction. The test is the one that culls meshes before picking.
//   npm install @babylonjs/core@9.34.0 && node babylon.mjs     (or LOSTBITS_NPM=the folder that holds node_modules)
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const folder = process.env.LOSTBITS_NPM || process.cwd();
const from = (file) => import(pathToFileURL(join(folder, 'node_modules/@babylonjs/core', file)).href);
const { Ray } = await from('Culling/ray.core.js');
const { Vector3 } = await from('Maths/math.vector.pure.js');
const v = (x) => new Vector3(...x);
const show = (what, expected, o, d, lo, hi) =>
    console.log(`${what}\n  expected ${expected}, got ${new Ray(v(o), v(d)).intersectsBoxMinMax(v(lo), v(hi))}`);

show('a box 1e8 ahead, met at y = 9', 'true', [0, 0, 0], [1, 9e-8, 0], [1e8, 8, -1], [1e8 + 1, 10, 1]);
show('the same box, passed 9 beside it', 'false', [0, 0, 0], [1, 9e-8, 0], [1e8, -1, -1], [1e8 + 1, 1, 1]);
show('a direction 9e-8 long, straight at a box 4 ahead', 'true', [-5, 0, 0], [9e-8, 0, 0], [-1, -1, -1], [1, 1, 1]);
show('the same direction, 9e-7 long', 'true', [-5, 0, 0], [9e-7, 0, 0], [-1, -1, -1], [1, 1, 1]);
