// Ray tests of npm packages behind a pipe (docs/pipe.md): those of the list `offered` that are installed, by `npm ci
// --prefix plugins/npm` or in the folder that LOSTBITS_NPM names. All compute in double, except rapier, which is
// WebAssembly in float.
//
//   lostbits map near-benign --pipe 'node plugins/npm_intersectors.mjs' -i 'three.*' -f f64 -o out
//
// three promises a normalised direction (math/Ray.js:27). So do Cesium (Core/Ray.js, whose constructor normalises) and
// Babylon (by its formula). t is taken as a package computes it, before the package computes a point from it. A test
// that returns yes or no is a form with roots=none.
import { readFileSync, readSync, writeSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const folder = process.env.LOSTBITS_NPM || fileURLToPath(new URL('npm', import.meta.url));
const within = (file) => import(pathToFileURL(join(folder, 'node_modules', file)).href);
const all = async (base, files) => (await Promise.all(files.map((f) => within(`${base}/${f}.js`))));

/// Each loader below loads one package. It returns an object from the name of a form to primitive -> (ray) -> null or
/// [near, far], or a boolean for a test.
const three = async () => {
    const [{ Ray }, { Sphere }, { Box3 }, { Vector3 }] =
        await all('three/src/math', ['Ray', 'Sphere', 'Box3', 'Vector3']);
    const ray = new Ray(), at = new Vector3();
    const caught = { t: NaN, copy() { return this; }, addScaledVector(_, t) { this.t = t; return this; } };
    const set = (r) => { ray.origin.fromArray(r, 0); ray.direction.fromArray(r, 3); return ray; };
    const sphere = (s) => new Sphere(at.clone().set(s[0], s[1], s[2]), s[3]);
    const box = (b) => new Box3(at.clone().set(b[0], b[1], b[2]), at.clone().set(b[3], b[4], b[5]));
    const corner = (c, k) => at.clone().set(c[k], c[k + 1], c[k + 2]);
    const t = (point) => (point === null ? null : [caught.t, caught.t]);
    const triangle = (culled) => (c, v = [0, 3, 6].map((k) => corner(c, k))) => (r) =>
        t(set(r).intersectTriangle(v[0], v[1], v[2], culled, caught));
    return {
        'three.triangle': triangle(false),
        'three.triangle_culled': triangle(true),
        'three.sphere': (s, v = sphere(s)) => (r) => t(set(r).intersectSphere(v, caught)),
        'three.sphere_test': (s, v = sphere(s)) => (r) => set(r).intersectsSphere(v),
        'three.box': (s, v = box(s)) => (r) => t(set(r).intersectBox(v, caught)),
        'three.box_test': (s, v = box(s)) => (r) => set(r).intersectsBox(v),
    };
};
const cesium = async () => {
    const [tests, point, line, ball, ellipsoid, cuboid] = (await all('@cesium/engine/Source/Core',
        ['IntersectionTests', 'Cartesian3', 'Ray', 'BoundingSphere', 'Ellipsoid', 'AxisAlignedBoundingBox']))
        .map((m) => m.default);
    const ray = new line();
    const set = (r, c = [0, 0, 0]) => {
        point.fromElements(r[0] - c[0], r[1] - c[1], r[2] - c[2], ray.origin);
        point.fromElements(r[3], r[4], r[5], ray.direction);
        return ray;
    };
    const parameter = (t) => (t === undefined ? null : [t, t]);
    const interval = (i) => (i === undefined ? null : [i.start, i.stop]);
    const at = (s, k) => new point(s[k], s[k + 1], s[k + 2]);
    return {
        'cesium.sphere': (s, v = new ball(at(s, 0), s[3])) => (r) => interval(tests.raySphere(set(r), v)),
        'cesium.ellipsoid': (s, v = new ellipsoid(s[3], s[3], s[3])) => (r) =>
            interval(tests.rayEllipsoid(set(r, s), v)),
        'cesium.ellipsoid_radii': (s, v = new ellipsoid(s[3], s[4], s[5])) => (r) =>
            interval(tests.rayEllipsoid(set(r, s), v)),
        'cesium.triangle': (c, v = [0, 3, 6].map((k) => at(c, k))) => (r) =>
            parameter(tests.rayTriangleParametric(set(r), v[0], v[1], v[2])),
        'cesium.box': (s, v = new cuboid(at(s, 0), at(s, 3))) => (r) =>
            interval(tests.rayAxisAlignedBoundingBox(set(r), v)),
    };
};
const babylon = async () => {
    const [{ Ray }, { Vector3 }] = [await within('@babylonjs/core/Culling/ray.core.js'),
        await within('@babylonjs/core/Maths/math.vector.pure.js')];
    const ray = new Ray(Vector3.Zero(), Vector3.Zero());
    const set = (r) => {
        ray.origin.copyFromFloats(r[0], r[1], r[2]);
        ray.direction.copyFromFloats(r[3], r[4], r[5]);
        return ray;
    };
    const at = (s, k) => new Vector3(s[k], s[k + 1], s[k + 2]);
    const parameter = (met) => (met === null ? null : [met.distance, met.distance]);
    return {
        'babylon.triangle': (c, v = [0, 3, 6].map((k) => at(c, k))) => (r) =>
            parameter(set(r).intersectsTriangle(v[0], v[1], v[2])),
        'babylon.sphere_test': (s, v = { center: at(s, 0), radius: s[3] }) => (r) => set(r).intersectsSphere(v),
        'babylon.box_test': (s, lo = at(s, 0), hi = at(s, 3)) => (r) => set(r).intersectsBoxMinMax(lo, hi),
    };
};

const playcanvas = async () => {
    const [{ Ray }, { BoundingSphere }, { BoundingBox }, { Tri }, { Vec3 }] = await Promise.all(
        ['shape/ray', 'shape/bounding-sphere', 'shape/bounding-box', 'shape/tri', 'math/vec3'].map(
            (f) => within(`playcanvas/build/playcanvas/src/core/${f}.js`)));
    const ray = new Ray();
    const self = () => point, point = { t: NaN, copy: self, add: self, mulScalar: (t) => (point.t = t, point) };
    const set = (r) => { ray.origin.set(r[0], r[1], r[2]); ray.direction.set(r[3], r[4], r[5]); return ray; };
    const box = (b, v = new BoundingBox()) => {
        v.setMinMax(new Vec3(b[0], b[1], b[2]), new Vec3(b[3], b[4], b[5]));
        return v;
    };
    return {
        'playcanvas.sphere': (s, v = new BoundingSphere(new Vec3(s[0], s[1], s[2]), s[3])) => (r) =>
            (v.intersectsRay(set(r), point) ? [point.t, point.t] : null),
        'playcanvas.box': (s, v = box(s)) => (r) => (v.intersectsRay(set(r), point) ? [point.t, point.t] : null),
        // It returns a point only if it is given a Vec3.
        'playcanvas.triangle': (c, v = [0, 3, 6].map((k) => new Vec3(c[k], c[k + 1], c[k + 2]))) => {
            const triangle = new Tri(v[0], v[1], v[2]), met = Object.assign(new Vec3(), point);
            return (r) => (triangle.intersectsRay(set(r), met) ? [point.t, point.t] : null);
        },
        'playcanvas.box_test': (s, v = box(s)) => (r) => v.intersectsRay(set(r)),
    };
};
const cannon = async () => {
    const { AABB, Body, Box, Ray, RaycastResult, Sphere, Vec3 } = await within('cannon-es/dist/cannon-es.js');
    const ray = new Ray(), result = new RaycastResult();
    ray.mode = Ray.CLOSEST;
    // A ray of cannon is a segment. Its end lies `reach` behind the centre of the body, and so behind the body.
    const cast = (body, reach) => (r) => {
        const { x, y, z } = body.position;
        const length = Math.hypot(x - r[0], y - r[1], z - r[2]) + reach;
        ray.from.set(r[0], r[1], r[2]);
        ray.to.set(r[0] + length * r[3], r[1] + length * r[4], r[2] + length * r[5]);
        result.reset();
        ray.intersectBody(body, result);
        return result.hasHit ? [result.distance, result.distance] : null;
    };
    const body = (shape, x, y, z) => new Body({ shape, position: new Vec3(x, y, z) });
    const corner = (b, k) => new Vec3(b[k], b[k + 1], b[k + 2]);
    return {
        'cannon.sphere': (s) => cast(body(new Sphere(s[3]), s[0], s[1], s[2]), 2 * s[3]),
        // cannon's box is hollow: from inside it returns the exit. The box of lostbits is solid and hit at t = 0.
        'cannon.box': (b) => {
            const lo = corner(b, 0), hi = corner(b, 3), half = hi.vsub(lo).scale(0.5), middle = hi.vadd(lo).scale(0.5);
            const shape = new Box(half), test = cast(body(shape, middle.x, middle.y, middle.z), 2 * half.length());
            const { convexPolyhedronRepresentation: solid } = shape;
            return (r) => (solid.pointIsInside(corner(r, 0).vsub(middle)) ? [0, 0] : test(r));
        },
        'cannon.aabb_test': (b, v = new AABB({ lowerBound: corner(b, 0), upperBound: corner(b, 3) })) => (r) => {
            ray.from.set(r[0], r[1], r[2]);
            ray.direction.set(r[3], r[4], r[5]);
            return v.overlapsRay(ray);
        },
    };
};
const ogl = async () => {
    const [{ Raycast }, { Vec3 }] = [await within('ogl/src/extras/Raycast.js'), await within('ogl/src/math/Vec3.js')];
    const cast = new Raycast();
    const set = (r) => { cast.origin.set(r[0], r[1], r[2]); cast.direction.set(r[3], r[4], r[5]); return cast; };
    const at = (s, k) => new Vec3(s[k], s[k + 1], s[k + 2]);
    const t = (distance) => (distance ? [distance, distance] : null);  // ogl returns 0 for a miss
    // From inside, intersectBox returns the exit. intersectBounds of ogl makes these comparisons first.
    const inside = (b, o) => !(o[0] < b[0] || o[0] > b[3] || o[1] < b[1] || o[1] > b[4] || o[2] < b[2] || o[2] > b[5]);
    return {
        'ogl.triangle': (c, v = [0, 3, 6].map((k) => at(c, k))) => (r) =>
            t(set(r).intersectTriangle(v[0], v[1], v[2], false)),
        'ogl.sphere': (s, v = { center: at(s, 0), radius: s[3] }) => (r) => t(set(r).intersectSphere(v)),
        'ogl.box': (s, b = s.slice(), v = { min: at(s, 0), max: at(s, 3) }) => (r) =>
            (inside(b, r) ? [0, 0] : t(set(r).intersectBox(v))),
    };
};
const yuka = async () => {
    const { AABB, BoundingSphere, Ray, Vector3 } = await within('yuka/build/yuka.module.js');
    const ray = new Ray(), point = {};
    ray.at = (t, target) => { target.t = t; return target; };
    const set = (r) => { ray.origin.set(r[0], r[1], r[2]); ray.direction.set(r[3], r[4], r[5]); return ray; };
    const at = (s, k) => new Vector3(s[k], s[k + 1], s[k + 2]);
    const sphere = (s) => new BoundingSphere(at(s, 0), s[3]);
    const t = (met) => (met === null ? null : [met.t, met.t]);
    return {
        'yuka.sphere': (s, v = sphere(s)) => (r) => t(set(r).intersectBoundingSphere(v, point)),
        'yuka.triangle': (c, v = { a: at(c, 0), b: at(c, 3), c: at(c, 6) }) => (r) =>
            t(set(r).intersectTriangle(v, false, point)),
        'yuka.sphere_test': (s, v = sphere(s)) => (r) => set(r).intersectsBoundingSphere(v),
        // yuka follows three, which returns the exit from inside.
        'yuka.box': (s, v = new AABB(at(s, 0), at(s, 3))) => (r) =>
            (v.containsPoint(set(r).origin) ? [0, 0] : t(ray.intersectAABB(v, point))),
    };
};
const rapier = async () => {
    const { default: R } = await within('@dimforge/rapier3d-compat/dist/rapier.mjs');
    await R.init();
    const still = { x: 0, y: 0, z: 0, w: 1 }, ray = new R.Ray({}, {});
    const cast = (shape, position, solid, turn = still) => (r) => {
        ray.origin = { x: r[0], y: r[1], z: r[2] };
        ray.dir = { x: r[3], y: r[4], z: r[5] };
        const t = shape.castRay(ray, position, turn, Infinity, solid);
        return t === null || t === undefined || t < 0 ? null : [t, t];
    };
    const f = Math.fround, middle = (a, b) => f(f(a + b) / 2), half = (a, b) => f(f(b - a) / 2);
    return {
        'rapier.sphere': (s) => cast(new R.Ball(s[3]), { x: s[0], y: s[1], z: s[2] }, false),
        'rapier.box': (b) => cast(new R.Cuboid(half(b[0], b[3]), half(b[1], b[4]), half(b[2], b[5])),
            { x: middle(b[0], b[3]), y: middle(b[1], b[4]), z: middle(b[2], b[5]) }, true),
        'rapier.triangle': (c, v = [0, 3, 6].map((k) => ({ x: c[k], y: c[k + 1], z: c[k + 2] }))) =>
            cast(new R.Triangle(v[0], v[1], v[2]), { x: 0, y: 0, z: 0 }, false),
        // A cylinder of rapier lies along y, so it is rotated from y to the axis.
        'rapier.cylinder': (c) => {
            const v = [0, 1, 2].map((k) => c[k + 3] - c[k]), height = Math.hypot(...v);
            const [x, z, w] = [v[2], -v[0], height + v[1]], size = Math.hypot(x, z, w);
            const turn = size > 0 ? { x: x / size, y: 0, z: z / size, w: w / size } : { x: 1, y: 0, z: 0, w: 0 };
            const at = { x: middle(c[0], c[3]), y: middle(c[1], c[4]), z: middle(c[2], c[5]) };
            return cast(new R.Cylinder(height / 2, c[6]), at, false, turn);
        },
    };
};

const single = ['format=f32', 'direction=any'];
const offered = [
    [three, 'three', 'src/math/Ray.js', {
        'three.sphere': ['307, intersectSphere', 'roots=first'],
        'three.sphere_test': ['345, intersectsSphere', 'roots=none'],
        'three.box': ['449, intersectBox', 'roots=first', 'inside=exit'],
        'three.box_test': ['521, intersectsBox', 'roots=none'],
        'three.triangle': ['538, intersectTriangle', 'roots=first'],
        'three.triangle_culled': ['538, intersectTriangle with backfaceCulling', 'roots=first', 'facing=front'] }],
    [cesium, '@cesium/engine', 'Source/Core/IntersectionTests.js', {
        'cesium.sphere': ['349, raySphere', 'roots=both', 'at_origin=exit'],
        'cesium.ellipsoid': ['420, rayEllipsoid, three equal radii, about the centre', 'roots=both', 'at_origin=miss'],
        'cesium.ellipsoid_radii': ['420, rayEllipsoid, about the centre', 'shape=ellipsoid', 'roots=both',
            'at_origin=miss'],
        'cesium.box': ['509, rayAxisAlignedBoundingBox', 'roots=both'],
        'cesium.triangle': ['83, rayTriangleParametric', 'roots=near'] }],
    [babylon, '@babylonjs/core', 'Culling/ray.core.js', {
        'babylon.sphere_test': ['151, intersectsSphere', 'roots=none'],
        'babylon.box_test': ['55, intersectsBoxMinMax', 'roots=none'],
        'babylon.triangle': ['175, intersectsTriangle', 'roots=first'] }],
    [playcanvas, 'playcanvas', 'core/shape', {
        'playcanvas.sphere': ['bounding-sphere.js:16, intersectsRay with a point', 'roots=first'],
        'playcanvas.box': ['bounding-box.js:79, intersectsRay with a point', 'roots=first'],
        'playcanvas.box_test': ['bounding-box.js:114, intersectsRay without a point', 'roots=none'],
        'playcanvas.triangle': ['tri.js:21, intersectsRay with a point', 'roots=first', 'at_origin=miss'] }],
    [cannon, 'cannon-es', 'dist/cannon-es.js', {
        'cannon.sphere': ['4987, Ray._intersectSphere', 'roots=first'],
        'cannon.box': ['5031, Ray._intersectConvex of a Box', 'roots=first'],
        'cannon.aabb_test': ['1241, AABB.overlapsRay', 'roots=none'] }],
    [ogl, 'ogl', 'src/extras/Raycast.js', {
        'ogl.sphere': ['271, intersectSphere', 'roots=first', 'at_origin=miss'],
        'ogl.box': ['287, intersectBox', 'roots=first'],
        'ogl.triangle': ['310, intersectTriangle', 'roots=first', 'at_origin=miss'] }],
    [yuka, 'yuka', 'build/yuka.module.js', {
        'yuka.sphere': ['5511, intersectBoundingSphere', 'roots=first'],
        'yuka.sphere_test': ['5553, intersectsBoundingSphere', 'roots=none'],
        'yuka.box': ['5587, intersectAABB', 'roots=first'],
        'yuka.triangle': ['5901, intersectTriangle', 'roots=first'] }],
    [rapier, '@dimforge/rapier3d-compat', 'parry 0.31.1', {
        'rapier.sphere': ['query/ray/ray_ball.rs, Ball.castRay', 'roots=first', 'at_origin=exit', ...single],
        'rapier.box': ['query/ray/ray_aabb.rs, Cuboid.castRay, solid', 'roots=first', ...single],
        'rapier.triangle': ['query/ray/ray_triangle.rs, Triangle.castRay', 'roots=first', ...single],
        'rapier.cylinder': ['query/ray/ray_support_map.rs, Cylinder.castRay', 'shape=cylinder', 'roots=first',
            'at_origin=exit', ...single] }],
];

const forms = [];
let header = 'lostbits-pipe/1\n';
for (const [load, name, file, contracts] of offered) {
    try {
        const { version } = JSON.parse(readFileSync(join(folder, 'node_modules', name, 'package.json'), 'utf8'));
        const made = await load();
        for (const [form, [where, ...words]] of Object.entries(contracts)) {
            const said = words.find((word) => word.startsWith('shape='))?.slice(6);
            const shape = said ?? (form.includes('sphere') || form.includes('ellipsoid') ? 'sphere' :
                form.includes('triangle') ? 'triangle' : 'box');
            // With both roots and an `at_origin`, the near root is clipped to the ray: an entry at the origin counts
            // like one behind it.
            const clipped = words.includes('roots=both') && words.some((word) => word.startsWith('at_origin'));
            header += [`name=${form}`, `title=${where.split(' ')[1].replace(',', '')} of ${name}`,
                `source=${name} ${version}, ${file}:${where}`, `shape=${shape}`,
                ...['format=f64', 'direction=unit'].filter((w) => !words.some((o) => o.startsWith(w.split('=')[0]))),
                ...words.filter((word) => !word.startsWith('shape=')),
                `flags=no_end${clipped ? ',clipped' : ''}`].join('\n') + '\n';
            forms.push({ of: made[form], numbers: { sphere: 4, box: 6, triangle: 9, ellipsoid: 6, cylinder: 7 }[shape],
                Numbers: words.includes('format=f32') ? Float32Array : Float64Array });
        }
    } catch (error) {
        const why = error.message.split('\n')[0];
        console.error(`npm_intersectors: ${name} is left out: ${why}; install it with npm ci --prefix plugins/npm`);
    }
}

const read = (bytes) => {
    const buffer = Buffer.alloc(bytes);
    for (let done = 0; done < bytes;) {
        let got = 0;
        try {
            got = readSync(0, buffer, done, bytes - done, null);
        } catch (error) {
            if (error.code !== 'EAGAIN') throw error;
            continue;
        }
        if (got === 0) process.exit(0);
        done += got;
    }
    return buffer;
};
const write = (buffer) => {
    for (let done = 0; done < buffer.length;) done += writeSync(1, buffer, done);
};
const numbers = (Numbers, count) => new Numbers(read(Numbers.BYTES_PER_ELEMENT * count).buffer);

write(Buffer.from(header + '\n'));
for (;;) {
    const head = read(20);
    const [form, n, solids, ends] = [4, 8, 12, 16].map((place) => head.readUInt32LE(place));
    const { of, numbers: width, Numbers } = forms[form];
    const rays = numbers(Numbers, 6 * n);
    numbers(Numbers, ends);
    const held = numbers(Numbers, width * solids);
    const near_far = new Numbers(2 * n), hit = new Uint8Array(n);
    let test = of(held.subarray(0, width));
    for (let i = 0; i < n; ++i) {
        if (solids > 1) test = of(held.subarray(width * i, width * (i + 1)));
        const answer = test(rays.subarray(6 * i, 6 * i + 6));
        if (!answer) continue;
        hit[i] = 1;
        if (answer !== true) near_far.set(answer, 2 * i);
    }
    write(Buffer.concat([Buffer.from('LBA1\0\0\0\0'), Buffer.from(near_far.buffer), Buffer.from(hit)]));
}
