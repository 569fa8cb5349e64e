// A sphere in Rust: operators, an early return, and an option.
#[derive(Clone, Copy)]
pub struct Vec3 {
    pub x: f32,
    pub y: f32,
    pub z: f32,
}
impl std::ops::Sub for Vec3 {
    type Output = Vec3;
    fn sub(self, b: Vec3) -> Vec3 {
        Vec3 { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}
fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
}
pub struct Sphere {
    center: Vec3,
    radius: f32,
}

pub fn hit_sphere(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let f = ray.origin - sphere.center;
    let a = dot(ray.direction, ray.direction);
    let b = dot(f, ray.direction);
    let c = dot(f, f) - sphere.radius * sphere.radius;
    let disc = b * b - a * c;
    if disc < 0.0 {
        return None;
    }
    let t = (-b - disc.sqrt()) / a;
    if t < 0.0 { None } else { Some(t) }
}

pub fn hit_box(o: [f64; 3], d: [f64; 3], lo: [f64; 3], hi: [f64; 3]) -> Option<(f64, f64)> {
    let mut near = 0.0f64;
    let mut far = f64::INFINITY;
    for k in 0..3 {
        let a = (lo[k] - o[k]) / d[k];
        let b = (hi[k] - o[k]) / d[k];
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    if near <= far { Some((near, far)) } else { None }
}
