// The transform methods in registers of one width. Compiled once for each width.
#include "intersect/transform/list.hpp"
#include "intersect/transform/raw_steps.hpp"
#include "number/wide/wide_pack.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::transform {
namespace {

template <class P, class F>
Maps<P> maps_from(const F* numbers) {
    const auto from = [numbers](std::size_t first) {
        return Affine<P>::of([numbers, first](std::size_t k) { return P(numbers[first + k]); });
    };
    return {from(0), from(Affine<P>::numbers)};
}

template <class P, class Columns>
Ray<P> ray_at(const Columns& columns, std::size_t i) {
    const auto at = [&columns, i](int k) { return P::load(columns[k] + i); };
    return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
}

template <class L, class F>
[[gnu::flatten]] void to_object(const RawSteps<F>& raw) {
    using P = Pack<F, Width>;
    const RawSteps<F> steps = raw;  // a copy, which the stores below cannot change
    const Maps<P> maps = maps_from<P>(steps.maps);
    F scales[P::lanes] = {};
    for (std::size_t i = 0; i < steps.size; i += P::lanes) {
        const Ray<P> world = ray_at<P>(steps.world, i);
        const ObjectRay<P> in =
            L::finish(maps, world.origin, Ray<P>{L::origin(maps, world.origin), L::direction(maps, world.direction)});
        for (int k = 0; k < 3; ++k) {
            in.ray.origin[k].store(steps.object[k] + i);
            in.ray.direction[k].store(steps.object[k + 3] + i);
        }
        in.length.store(steps.length + i);
        in.scale.store(scales);
        *steps.scale = scales[0];
    }
}

template <class L, class F>
[[gnu::flatten]] void back(const RawSteps<F>& raw) {
    using P = Pack<F, Width>;
    const RawSteps<F> steps = raw;
    const Maps<P> maps = maps_from<P>(steps.maps);
    const P scale(*steps.scale);
    for (std::size_t i = 0; i < steps.size; i += P::lanes) {
        const Ray<P> world = ray_at<P>(steps.world, i);
        const ObjectRay<P> in{ray_at<P>(steps.object, i), P::load(steps.length + i), scale};
        for (F* const t : steps.told) L::back(maps, world, in, P::load(t + i)).store(t + i);
    }
}

}  // namespace

void LOSTBITS_NAME_OF_WIDTH(fill_transforms)(RawTransformRow* rows) {
    for_each_transform_method([&rows]<class L>() {
        *rows++ = {{to_object<L, float>, back<L, float>}, {to_object<L, double>, back<L, double>}};
    });
}

}  // namespace lostbits::intersect::transform
