// The geometric formula of docs/your-own-form.md: the distance along the ray to the point nearest to the centre, minus
// half the chord.
#include <lostbits_form.hpp>

using namespace lostbits;

struct Geometric {
    static constexpr intersect::Info info{
        .name = "example.geometric",
        .title = "geometric: nearest point minus half the chord",
        .source = "docs/your-own-form.md",
        .direction = intersect::Direction::unit,
        .roots = intersect::Roots::near_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> l = sphere.centre - ray.origin;
        const T tca = named("tca", dot(l, ray.direction));
        const T d2 = named("d2", dot(l, l) - tca * tca);
        const T r2 = sphere.radius * sphere.radius;
        const T t = named("t", tca - sqrt(r2 - d2));
        return {!(t < T(0) || d2 > r2), t, t, t};
    }
};

LOSTBITS_FORMULAS(Geometric)
