// Functions of Rust crates about which users have reported wrong answers: the same operations in the same order,
// written again, each beside its repaired form.
pub type Vector = [f32; 3];

fn dot(a: &Vector, b: &Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

// simd_min and simd_max of simba, which min and max of nalgebra call: b if either is a NaN.
fn least(a: f32, b: f32) -> f32 {
    if a <= b { a } else { b }
}
fn greatest(a: f32, b: f32) -> f32 {
    if a >= b { a } else { b }
}

// Ray::intersection_slice_for_aabb of svenstaro/bvh, src/ray/ray_impl.rs:117 at 204a1c98. Issue 140: the answer has a
// NaN for a ray in the plane of a face.
// lostbits: box(o, 1/d, lo, hi)
pub fn slice(origin: &Vector, inv_direction: &Vector, min: &Vector, max: &Vector) -> Option<(f32, f32)> {
    let mut near = [0.0; 3];
    let mut far = [0.0; 3];
    for k in 0..3 {
        let lbr = (min[k] - origin[k]) * inv_direction[k];
        let rtr = (max[k] - origin[k]) * inv_direction[k];
        near[k] = least(lbr, rtr);
        far[k] = greatest(lbr, rtr);
    }
    let tmin = greatest(greatest(near[0], near[1]), near[2]);
    let tmax = least(least(far[0], far[1]), far[2]);
    if tmin > tmax || tmax < 0.0 {
        return None;
    }
    Some((if tmin > 0.0 { tmin } else { 0.0 }, tmax))
}

// Pull request 149: a NaN is a miss.
// lostbits: box(o, 1/d, lo, hi)
pub fn slice_repaired(origin: &Vector, inv_direction: &Vector, min: &Vector, max: &Vector) -> Option<(f32, f32)> {
    let mut near = [0.0; 3];
    let mut far = [0.0; 3];
    for k in 0..3 {
        let lbr = (min[k] - origin[k]) * inv_direction[k];
        let rtr = (max[k] - origin[k]) * inv_direction[k];
        if lbr.is_nan() | rtr.is_nan() {
            return None;
        }
        near[k] = least(lbr, rtr);
        far[k] = greatest(lbr, rtr);
    }
    let entry = greatest(greatest(near[0], near[1]), near[2]);
    let tmin = if entry > 0.0 { entry } else { 0.0 };
    let tmax = least(least(far[0], far[1]), far[2]);
    if tmin > tmax {
        return None;
    }
    Some((tmin, tmax))
}

// Sphere::intersection of rustgd/collision-rs, src/volume/sphere.rs:65 at 29090c42, which returns the point at
// tca - thc in place of tca - thc. Issue 97: it is wrong for directions of other lengths than 1.
// lostbits: sphere(o, d, c, r)
pub fn sphere(origin: &Vector, direction: &Vector, center: &Vector, radius: f32) -> Option<f32> {
    let l = [center[0] - origin[0], center[1] - origin[1], center[2] - origin[2]];
    let tca = dot(&l, direction);
    if tca < 0.0 {
        return None;
    }
    let d2 = dot(&l, &l) - tca * tca;
    if d2 > radius * radius {
        return None;
    }
    let thc = (radius * radius - d2).sqrt();
    Some(tca - thc)
}

// The change that the issue asks for.
// lostbits: sphere(o, d, c, r)
pub fn sphere_asked(origin: &Vector, direction: &Vector, center: &Vector, radius: f32) -> Option<f32> {
    let l = [center[0] - origin[0], center[1] - origin[1], center[2] - origin[2]];
    let tca = dot(&l, direction) / dot(direction, direction).sqrt();
    if tca < 0.0 {
        return None;
    }
    let d2 = dot(&l, &l) - tca * tca;
    if d2 > radius * radius {
        return None;
    }
    let thc = (radius * radius - d2).sqrt();
    Some(tca - thc)
}

// The same with t divided by the length again, as the point of the crate needs it.
// lostbits: sphere(o, d, c, r)
pub fn sphere_repaired(origin: &Vector, direction: &Vector, center: &Vector, radius: f32) -> Option<f32> {
    let length = dot(direction, direction).sqrt();
    match sphere_asked(origin, direction, center, radius) {
        Some(distance) => Some(distance / length),
        None => None,
    }
}
