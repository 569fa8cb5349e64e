// A sphere by value, with operators, a method, and a result with hit and t.
#include <cmath>
#include <optional>

namespace scene {

template <class T>
struct Vec3 {
    T x, y, z;
    friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator*(T s, const Vec3& b) { return {s * b.x, s * b.y, s * b.z}; }
    friend T dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

template <class T>
struct Ray {
    Vec3<T> origin, direction;
    T tmin, tmax;
};

struct Hit {
    bool hit;
    double t;
    Vec3<double> normal;
};

struct Sphere {
    Vec3<float> center;
    float radius;

    std::optional<float> intersect(const Ray<float>& ray) const {
        const auto f = ray.origin - center;
        const float a = dot(ray.direction, ray.direction), b = dot(f, ray.direction);
        const auto nearest = f - (b / a) * ray.direction;
        const float disc = radius * radius - dot(nearest, nearest);
        if (disc < 0) return std::nullopt;
        const float q = std::sqrt(a * disc);
        const float t = b > 0 ? (-b - q) / a : (dot(f, f) - radius * radius) / (-b + q);
        if (t < 0) return {};
        return t;
    }
};

Hit intersect_sphere(Ray<double> ray, Vec3<double> center, double radius) {
    Hit h{false, 0, {}};
    const auto f = ray.origin - center;
    const double b = dot(f, ray.direction), a = dot(ray.direction, ray.direction);
    const double disc = b * b - a * (dot(f, f) - radius * radius);
    if (!(disc >= 0)) return h;
    for (const double sign : {-1.0, 1.0}) {
        const double t = (-b + sign * std::sqrt(disc)) / a;
        if (t < 0) continue;
        h.hit = true;
        h.t = t;
        h.normal = ray.origin + t * ray.direction - center;
        break;
    }
    return h;
}

}  // namespace scene
