// Functions of public Rust crates: the same operations in the same order, written again.
#[derive(Clone, Copy)]
pub struct Vector3<T> {
    pub x: T,
    pub y: T,
    pub z: T,
}
macro_rules! vectors {
    ($t:ty) => {
        impl std::ops::Sub for Vector3<$t> {
            type Output = Self;
            fn sub(self, b: Self) -> Self {
                Vector3 { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
            }
        }
        impl Vector3<$t> {
            fn dot(&self, b: &Self) -> $t {
                self.x * b.x + self.y * b.y + self.z * b.z
            }
            fn cross(&self, b: &Self) -> Self {
                Vector3 {
                    x: self.y * b.z - self.z * b.y,
                    y: self.z * b.x - self.x * b.z,
                    z: self.x * b.y - self.y * b.x,
                }
            }
        }
    };
}
vectors!(f32);
vectors!(f64);

pub struct Ray<T> {
    pub origin: Vector3<T>,
    pub direction: Vector3<T>,
}

pub struct Sphere {
    center: Vector3<f64>,
    radius: f64,
}
impl Sphere {
    // Sphere::intersect of bheisler/raytracer, src/rendering.rs:112 at 71305561: an Option from four branches.
    // lostbits: direction = unit
    pub fn intersect(&self, ray: &Ray<f64>) -> Option<f64> {
        let l = self.center - ray.origin;
        let adj = l.dot(&ray.direction);
        let d2 = l.dot(&l) - (adj * adj);
        let radius2 = self.radius * self.radius;
        if d2 > radius2 {
            return None;
        }
        let thc = (radius2 - d2).sqrt();
        let t0 = adj - thc;
        let t1 = adj + thc;
        if t0 < 0.0 && t1 < 0.0 {
            None
        } else if t0 < 0.0 {
            Some(t1)
        } else if t1 < 0.0 {
            Some(t0)
        } else {
            let distance = if t0 < t1 { t0 } else { t1 };
            Some(distance)
        }
    }
}

pub struct Intersection {
    pub distance: f32,
    pub u: f32,
    pub v: f32,
}

// Ray::intersects_triangle of the crate bvh, src/ray/ray_impl.rs:154 at a866b584: a struct, infinity for a miss.
pub fn intersects_triangle(ray: &Ray<f32>, a: &Vector3<f32>, b: &Vector3<f32>, c: &Vector3<f32>) -> Intersection {
    let miss = |u, v| Intersection { distance: f32::INFINITY, u, v };
    let a_to_b = *b - *a;
    let a_to_c = *c - *a;
    let u_vec = ray.direction.cross(&a_to_c);
    let det = a_to_b.dot(&u_vec);
    if det < f32::EPSILON {
        return miss(0.0, 0.0);
    }
    let inv_det = 1.0 / det;
    let a_to_origin = ray.origin - *a;
    let u = a_to_origin.dot(&u_vec) * inv_det;
    if !(0.0..=1.0).contains(&u) {
        return miss(u, 0.0);
    }
    let v_vec = a_to_origin.cross(&a_to_b);
    let v = ray.direction.dot(&v_vec) * inv_det;
    if v < 0.0 || u + v > 1.0 {
        return miss(u, v);
    }
    let dist = a_to_c.dot(&v_vec) * inv_det;
    if dist > f32::EPSILON { Intersection { distance: dist, u, v } } else { miss(u, v) }
}

pub struct Aabb {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

// Ray::intersection_slice_for_aabb of the crate bvh, src/ray/ray_impl.rs:118 at a866b584: a loop, NaN is a miss.
pub fn intersection_slice_for_aabb(origin: &[f32; 3], inv_direction: &[f32; 3], aabb: &Aabb) -> Option<(f32, f32)> {
    let mut near = f32::NEG_INFINITY;
    let mut far = f32::INFINITY;
    for k in 0..3 {
        let lbr = (aabb.min[k] - origin[k]) * inv_direction[k];
        let rtr = (aabb.max[k] - origin[k]) * inv_direction[k];
        if lbr.is_nan() | rtr.is_nan() {
            return None;
        }
        near = near.max(lbr.min(rtr));
        far = far.min(lbr.max(rtr));
    }
    let tmin = if near > 0.0 { near } else { 0.0 };
    if matches!(tmin.partial_cmp(&far), Some(std::cmp::Ordering::Greater) | None) {
        return None;
    }
    Some((tmin, far))
}
