// A library with one form, which marches, as in docs/your-own-form.md.
#include <lostbits_form.hpp>

#include "intersect/sdf/march_loop.hpp"

using namespace lostbits;

struct HalfSteps {  // steps of half the field
    static constexpr intersect::Info info{.name = "mylib.half", .direction = intersect::Direction::unit};

    template <Number T, class Field, class Watch>
    static Hit<T> intersect(const Ray<T>& ray, const Field& field, const intersect::MarchConstants<T>& constants,
                            Watch& watch) {
        const auto half = [&](const Vec<T>& p) { return field(p) / T(2); };
        const auto m = intersect::sdf::march(ray, half, constants, watch,
                                             [&](const T& d, const T&) { return d < constants.hit_eps; });
        return single_hit(m.hit, m.t);
    }
};

LOSTBITS_FORMULAS(HalfSteps)
