// Ray tests of npm packages behind a pipe (docs/pipe.md): three, @cesium/engine and @babylonjs/core, whichever are
// installed (`npm ci --prefix plugins/npm`, or the folder that LOSTBITS_NPM names). All of them compute in double.
//
//   lostbits map near-benign --pipe 'node plugins/npm_intersectors.mjs' -i 'three.*' -f f64 -o out
//
// three promises a normalised direction (math/Ray.js:27); so do Cesium (Core/Ray.js, whose constructor normalises) and
// Babylon by its formula. A package's t is taken as it computes it, before it makes a point of it. A predicate that
// tells yes or no is a form without roots.
import { readFileSync, readSync, writeSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const folder = process.env.LOSTBITS_NPM || fileURLToPath(new URL('npm', import.meta.url));
const within = (file) => import(pathToFileURL(join(folder, 'node_modules', file)).href);
const all = async (base, files) => (await Promise.all(files.map((f) => within(`${base}/${f}.js`))));

/// { name, words, make }: make() loads the package and returns solid -> (ray) -> null or [near, far].
const three = async () => {
    const [{ Ray }, { Sphere }, { Box3 }, { Vector3 }] =
        await all('three/src/math', ['Ray', 'Sphere', 'Box3', 'Vector3']);
    const ray = new Ray(), at = new Vector3();
    const caught = { t: NaN, copy() { return this; }, addScaledVector(_, t) { this.t = t; return this; } };
    const set = (r) => { ray.origin.fromArray(r, 0); ray.direction.fromArray(r, 3); return ray; };
    const sphere = (s) => new Sphere(at.clone().set(s[0], s[1], s[2]), s[3]);
    const box = (b) => new Box3(at.clone().set(b[0], b[1], b[2]), at.clone().set(b[3], b[4], b[5]));
    const t = (point) => (point === null ? null : [caught.t, caught.t]);
    return {
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
    const interval = (i) => (i === undefined ? null : [i.start, i.stop]);
    const at = (s, k) => new point(s[k], s[k + 1], s[k + 2]);
    return {
        'cesium.sphere': (s, v = new ball(at(s, 0), s[3])) => (r) => interval(tests.raySphere(set(r), v)),
        'cesium.ellipsoid': (s, v = new ellipsoid(s[3], s[3], s[3])) => (r) =>
            interval(tests.rayEllipsoid(set(r, s), v)),
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
    return {
        'babylon.sphere_test': (s, v = { center: at(s, 0), radius: s[3] }) => (r) => set(r).intersectsSphere(v),
        'babylon.box_test': (s, lo = at(s, 0), hi = at(s, 3)) => (r) => set(r).intersectsBoxMinMax(lo, hi),
    };
};

const offered = [
    [three, 'three', 'src/math/Ray.js', {
        'three.sphere': ['307, intersectSphere', 'roots=first'],
        'three.sphere_test': ['345, intersectsSphere', 'roots=none'],
        'three.box': ['449, intersectBox', 'roots=first', 'inside=exit'],
        'three.box_test': ['521, intersectsBox', 'roots=none'] }],
    [cesium, '@cesium/engine', 'Source/Core/IntersectionTests.js', {
        'cesium.sphere': ['349, raySphere', 'roots=both', 'at_origin=exit'],
        'cesium.ellipsoid': ['420, rayEllipsoid, three equal radii, about the centre', 'roots=both', 'at_origin=miss'],
        'cesium.box': ['509, rayAxisAlignedBoundingBox', 'roots=both'] }],
    [babylon, '@babylonjs/core', 'Culling/ray.core.js', {
        'babylon.sphere_test': ['151, intersectsSphere', 'roots=none'],
        'babylon.box_test': ['55, intersectsBoxMinMax', 'roots=none'] }],
];

const forms = [];
let header = 'lostbits-pipe/1\n';
for (const [load, name, file, contracts] of offered) {
    try {
        const { version } = JSON.parse(readFileSync(join(folder, 'node_modules', name, 'package.json'), 'utf8'));
        const made = await load();
        for (const [form, [where, ...words]] of Object.entries(contracts)) {
            const shape = form.includes('box') ? 'box' : 'sphere';
            const clipped = words.some((word) => word.startsWith('at_origin')) ? ',clipped' : '';
            header += [`name=${form}`, `title=${where.split(' ')[1].replace(',', '')} of ${name}`,
                `source=${name} ${version}, ${file}:${where}`, `shape=${shape}`, 'format=f64', 'direction=unit',
                ...words, `flags=no_end${clipped}`].join('\n') + '\n';
            forms.push({ of: made[form], numbers: shape === 'box' ? 6 : 4 });
        }
    } catch (error) {
        const why = error.message.split('\n')[0];
        console.error(`npm_intersectors: left out ${name}: ${why}; npm ci --prefix plugins/npm`);
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
const numbers = (count) => new Float64Array(read(8 * count).buffer);

write(Buffer.from(header + '\n'));
for (;;) {
    const head = read(20);
    const [form, n, solids, ends] = [4, 8, 12, 16].map((place) => head.readUInt32LE(place));
    const rays = numbers(6 * n);
    numbers(ends);
    const { of, numbers: width } = forms[form];
    const held = numbers(width * solids);
    const near_far = new Float64Array(2 * n), hit = new Uint8Array(n);
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
