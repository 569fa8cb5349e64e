// Interface of a form that also takes the matrix of its primitive: a form that was repaired with a transform. It is
// compiled outside of the program and run over columns of rays. Only this program and the code that it compiles itself
// use the interface; the C interface and `LOSTBITS_FORMULAS` pass no matrix.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "shapes/primitive.hpp"

#if defined(LOSTBITS_ISA)
#include "number/wide/wide_pack.hpp"
#include "number/width.hpp"
#endif

namespace lostbits::measure::repair {

/// Rays and answers as a structure of arrays, for one primitive with its transform as it is stored.
template <class F>
struct ColumnsWithTransform {
    const F* ray[6];
    const F* tmax;  ///< null: the rays have no end
    const F *primitive, *matrix;
    F* results[3];  ///< results: t, near and far
    std::uint8_t* hit;
    std::size_t size;  ///< for packs, a multiple of their lanes
};

template <class F>
using KernelWithTransform = void (*)(const ColumnsWithTransform<F>*);

/// Runs `Form::intersect` over T, which is F or a pack of it. In an object file for one register width, T has internal
/// linkage, and so has everything instantiated here (see `Width`).
template <class Form, template <class> class S, class T, class F>
[[gnu::flatten]] void answer_with_transform(const ColumnsWithTransform<F>* columns) {
    const ColumnsWithTransform<F> local =
        *columns;  // a copy, since the compiler must assume that stores change `*columns`
    const auto load = [](const F* source) {
        if constexpr (std::same_as<T, F>) return *source;
        else return T::load(source);
    };
    const auto store = [](const auto& value, auto* target) {
        if constexpr (std::same_as<T, F>) *target = value;
        else value.store(target);
    };

    // The numbers of the primitive and its matrix are the same for all rays.
    std::array<T, Affine<T>::number_count> matrix;
    for (std::size_t k = 0; k < matrix.size(); ++k) matrix[k] = T(local.matrix[k]);
    const S<T> primitive = primitive_from<S, T>([&local](std::size_t k) { return T(local.primitive[k]); });

    for (std::size_t i = 0; i < local.size; i += sizeof(T) / sizeof(F)) {
        const auto component = [&](std::size_t k) { return load(local.ray[k] + i); };
        const Ray<T> ray{{component(0), component(1), component(2)}, {component(3), component(4), component(5)}};
        const auto answer = [&] {
            if constexpr (!S<T>::takes_tmax) return Form::intersect(ray, primitive, matrix);
            else {
                const T end = local.tmax ? load(local.tmax + i) : T(std::numeric_limits<F>::infinity());
                return Form::intersect(ray, primitive, matrix, end);
            }
        }();

        store(answer.t, local.results[0] + i);
        store(answer.near, local.results[1] + i);
        store(answer.far, local.results[2] + i);
        store(answer.hit, reinterpret_cast<bool*>(local.hit + i));  // bytes provide storage for bools
    }
}

}  // namespace lostbits::measure::repair

#if defined(LOSTBITS_ISA)
#define LOSTBITS_TRANSFORMED_NAME(name) name##_packs
#define LOSTBITS_TRANSFORMED_NUMBER(F) lostbits::Pack<F, lostbits::BuildRegisters>
#else
#define LOSTBITS_TRANSFORMED_NAME(name) name##_alone
#define LOSTBITS_TRANSFORMED_NUMBER(F) F
#endif
/// Exports `name_alone`, or `name_packs` in an object of a register width: the answers of a form over F to one
/// Primitive.
#define LOSTBITS_TRANSFORMED_FORM(name, Form, Primitive, F)                                                         \
    extern "C" [[gnu::visibility("default")]] void LOSTBITS_TRANSFORMED_NAME(name)(                                 \
        const lostbits::measure::repair::ColumnsWithTransform<F>* columns) {                                        \
        lostbits::measure::repair::answer_with_transform<Form, lostbits::Primitive, LOSTBITS_TRANSFORMED_NUMBER(F), \
                                                         F>(columns);                                               \
    }
