// A constant that is not a whole number: in every other format it would have the bits of one format.
#include <lostbits_form.hpp>

using namespace lostbits;

struct Mine {
    static constexpr intersect::Info info{.name = "my.own"};
    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const T t = T(0.5) * (ray.origin.x + sphere.radius);
        return {t >= T(0), t, t, t};
    }
};

LOSTBITS_FORMULAS(Mine)
