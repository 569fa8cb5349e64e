// The function under test. Replace it with yours; see docs/your-own-intersector.md.
#include <cmath>
#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

Answer<float> mine(const Ray<float>& ray, const Sphere<float>& sphere) {
    float f[3], a = 0, b = 0, c = -sphere.radius * sphere.radius;
    for (int k = 0; k < 3; ++k) {
        f[k] = ray.origin[k] - sphere.centre[k];
        a += ray.direction[k] * ray.direction[k];
        b += 2 * f[k] * ray.direction[k];
        c += f[k] * f[k];
    }
    const float disc = b * b - 4 * a * c;
    if (disc < 0) return miss;
    const float t = (-b - std::sqrt(disc)) / (2 * a);
    return t < 0 ? Answer<float>(miss) : t;
}

LOSTBITS_FORMS(form<mine>("mylib.mine").near_root().titled("my quadratic"))
