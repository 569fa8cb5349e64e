// A formula with `if` on a comparison of numbers: it must not compile, and the compiler's message must say in one
// sentence what to write.
#include <lostbits_form.hpp>

using namespace lostbits;

struct Mine {
    static constexpr intersect::Info info{.name = "my.own"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> l = sphere.centre - ray.origin;
        const T tca = dot(l, ray.direction);
        const T t = tca - sqrt(square(sphere.radius) - (dot(l, l) - tca * tca));
        if (t < T(0)) return {t > t, t, t, t};
        return {t >= T(0), t, t, t};
    }
};

LOSTBITS_FORMULAS(Mine)
