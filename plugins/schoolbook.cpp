// The schoolbook formula in float and in double: a first plugin, and a check of the plugin interface. Its answers equal
// those of sphere.schoolbook to the bit, as long as the compiler contracts nothing.
#include <cmath>

#include <lostbits_plugin.hpp>

using namespace lostbits_plugin;

template <class T>
Answer<T> schoolbook(const Ray<T>& ray, const Sphere<T>& sphere) {
    const T f[3] = {ray.origin[0] - sphere.centre[0], ray.origin[1] - sphere.centre[1],
                    ray.origin[2] - sphere.centre[2]};
    const T* const d = ray.direction;
    const T a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const T b = 2 * (f[0] * d[0] + f[1] * d[1] + f[2] * d[2]);
    const T c = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] - sphere.radius * sphere.radius;
    const T disc = b * b - 4 * a * c;
    if (disc < 0) return miss;
    const T root = std::sqrt(disc);
    return {(-b - root) / (2 * a), (-b + root) / (2 * a)};
}

LOSTBITS_FORMS(form<schoolbook<float>>("example.schoolbook").whole_line().titled("the schoolbook formula as a plugin"),
               form<schoolbook<double>>("example.schoolbook").whole_line().titled("the schoolbook formula as a plugin"))
