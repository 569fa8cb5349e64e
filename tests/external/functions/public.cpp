// Functions of public C++ programs: the same operations in the same order, written again.
#include <cmath>

template <class T>
struct Vector {
    T x, y, z;
    Vector operator-(const Vector& b) const { return {x - b.x, y - b.y, z - b.z}; }
    T operator*(const Vector& b) const { return x * b.x + y * b.y + z * b.z; }
};
using Vec3f = Vector<float>;
using vec3 = Vector<double>;

struct Ball {
    Vec3f center;
    float radius;
};

// sphere_ray_intersect of tinyraytracer, tinyraytracer.cpp:15 at 09bf2208: references, pow, mixed formats.
// lostbits: sphere(c, r, o, d, t), direction = unit
bool sphere_ray_intersect(const Ball& sphere, const Vec3f& orig, const Vec3f& dir, float& t0) {
    Vec3f L = sphere.center - orig;
    float tca = L * dir;
    float d2 = L * L - tca * tca;
    if (d2 > pow(sphere.radius, 2)) return false;
    float thc = sqrtf(pow(sphere.radius, 2) - d2);
    t0 = tca - thc;
    float t1 = tca + thc;
    if (t0 < 0) t0 = t1;
    if (t0 < 0) return false;
    return true;
}

class ray {
public:
    const vec3& origin() const { return orig; }
    const vec3& direction() const { return dir; }

private:
    vec3 orig, dir;
};

struct interval {
    double min, max;
    bool surrounds(double x) const { return min < x && x < max; }
};

struct hit_record {
    vec3 p, normal;
    double t;
};

// sphere::hit of Ray Tracing in One Weekend, src/InOneWeekend/sphere.h:11 at 037336b2: a method, structs by value.
class sphere {
public:
    bool hit(const ray& r, interval ray_t, hit_record& rec) const {
        vec3 oc = center - r.origin();
        auto a = r.direction() * r.direction();
        auto h = r.direction() * oc;
        auto c = oc * oc - radius * radius;
        auto discriminant = h * h - a * c;
        if (discriminant < 0) return false;
        auto sqrtd = sqrt(discriminant);
        auto root = (h - sqrtd) / a;
        if (!ray_t.surrounds(root)) {
            root = (h + sqrtd) / a;
            if (!ray_t.surrounds(root)) return false;
        }
        rec.t = root;
        return true;
    }

private:
    vec3 center;
    double radius;
};
