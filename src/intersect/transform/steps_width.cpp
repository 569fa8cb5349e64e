// The transform methods in registers of one width. This file is compiled once for each width.
#include "intersect/transform/list.hpp"
#include "intersect/transform/raw_steps.hpp"
#include "number/wide/wide_pack.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::transform {
namespace {

template <class P, class F>
MatrixPair<P> maps_from(const F* numbers) {
    const auto read_matrix = [numbers](std::size_t first) {
        return Affine<P>::of([numbers, first](std::size_t k) { return P(numbers[first + k]); });
    };
    return {read_matrix(0), read_matrix(Affine<P>::number_count)};
}

template <class P, class Columns>
Ray<P> ray_at(const Columns& columns, std::size_t i) {
    const auto load_column = [&columns, i](int k) { return P::load(columns[k] + i); };
    return {{load_column(0), load_column(1), load_column(2)}, {load_column(3), load_column(4), load_column(5)}};
}

template <class Method, class F>
[[gnu::flatten]] void to_object(const RawSteps<F>& raw) {
    using P = Pack<F, BuildRegisters>;
    const RawSteps<F> arrays = raw;  // a copy, which the stores below cannot change
    const MatrixPair<P> maps = maps_from<P>(arrays.maps);
    F scales[P::lanes] = {};
    for (std::size_t i = 0; i < arrays.size; i += P::lanes) {
        const Ray<P> world = ray_at<P>(arrays.world, i);
        const ObjectRay<P> object_ray = Method::finish(
            maps, world.origin, Ray<P>{Method::origin(maps, world.origin), Method::direction(maps, world.direction)});
        for (int k = 0; k < 3; ++k) {
            object_ray.ray.origin[k].store(arrays.object[k] + i);
            object_ray.ray.direction[k].store(arrays.object[k + 3] + i);
        }
        object_ray.length.store(arrays.length + i);
        object_ray.scale.store(scales);
        *arrays.scale = scales[0];
    }
}

template <class Method, class F>
[[gnu::flatten]] void back(const RawSteps<F>& raw) {
    using P = Pack<F, BuildRegisters>;
    const RawSteps<F> arrays = raw;
    const MatrixPair<P> maps = maps_from<P>(arrays.maps);
    const P scale(*arrays.scale);
    for (std::size_t i = 0; i < arrays.size; i += P::lanes) {
        const Ray<P> world = ray_at<P>(arrays.world, i);
        const ObjectRay<P> object_ray{ray_at<P>(arrays.object, i), P::load(arrays.length + i), scale};
        for (F* const t : arrays.line_parameters) Method::back(maps, world, object_ray, P::load(t + i)).store(t + i);
    }
}

}  // namespace

void LOSTBITS_WITH_WIDTH_SUFFIX(fill_transforms)(RawTransformKernels* rows) {
    for_each_transform_method([&rows]<class Method>() {
        *rows++ = {{to_object<Method, float>, back<Method, float>}, {to_object<Method, double>, back<Method, double>}};
    });
}

}  // namespace lostbits::intersect::transform
