// A sphere's form that takes the end of the ray, which is not one of the three signatures.
#include <lostbits_form.hpp>

using namespace lostbits;

struct Mine {
    static constexpr intersect::Info info{.name = "my.own"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere, const T& end) {
        const T t = ray.origin.x + sphere.radius;
        return {t <= end, t, t, t};
    }
};

LOSTBITS_FORMULAS(Mine)
