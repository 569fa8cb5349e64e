// A form that is written once for every number type (C++20), in a library that contains it for all of them: float,
// double, the widths between, enclosures, tapes, packs. Unlike a function behind lostbits_plugin.h, it can be
// explained, and lostbits can find the bits that it needs. A complete library:
//
//   #include <lostbits_form.hpp>
//   using namespace lostbits;
//
//   struct Mine {
//       static constexpr intersect::Info info{.name = "mylib.mine"};
//       template <Number T>
//       static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
//           …                                         // no if on numbers: select(mask, a, b)
//           return {hit, t, t, t};
//       }
//   };
//   LOSTBITS_FORMULAS(Mine)
//
// and its CMakeLists.txt
//
//   find_package(lostbits REQUIRED)
//   lostbits_add_formulas(mylib mine.cpp)
//
// This compiles the file once for all number types, and once more for each register width. A form for a box takes
// `(const Ray<T>&, const Box<T>&, const T& tmax)`. A form that marches takes `(const Ray<T>&, const Field& field,
// const intersect::MarchConstants<T>&, Watch& watch)`. docs/your-own-form.md starts from a function with `if`.
#pragma once

#include "intersect/info.hpp"
#include "shapes/box/box.hpp"
#include "shapes/sphere/sphere.hpp"

#if defined(LOSTBITS_ISA)  // an object for one register width, which includes only what packs need

#include "intersect/simd/packed_batch.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::external {

template <class Width, class... Form>
void fill_own_rows(simd::RawFormKernels* row) {
    ((*row++ = simd::raw_form_kernels<Form, Width>()), ...);
}

}  // namespace lostbits::intersect::external

#define LOSTBITS_FORMULAS(...)                                               \
    namespace lostbits::intersect::external {                                \
    void LOSTBITS_WITH_WIDTH_SUFFIX(fill_own)(simd::RawFormKernels * rows);  \
    void LOSTBITS_WITH_WIDTH_SUFFIX(fill_own)(simd::RawFormKernels * rows) { \
        fill_own_rows<BuildRegisters, __VA_ARGS__>(rows);                    \
    }                                                                        \
    }

#else

#include "intersect/external/build_id.hpp"
#include "intersect/external/formula_of.hpp"
#include "number/archetype.hpp"

namespace lostbits::intersect::external {

// Null for register widths that are not linked.
[[gnu::weak]] void fill_own_w128(simd::RawFormKernels* rows);
[[gnu::weak]] void fill_own_w256(simd::RawFormKernels* rows);
[[gnu::weak]] void fill_own_w512(simd::RawFormKernels* rows);

}  // namespace lostbits::intersect::external

/// Exports forms from the library. Use it once, outside of every namespace.
#define LOSTBITS_FORMULAS(...)                                                                                       \
    extern "C" [[gnu::visibility("default")]] const lostbits::intersect::external::FormulaList* lostbits_formulas(   \
        const lostbits::intersect::external::FormulaWatch* watch) {                                                  \
        namespace external = lostbits::intersect::external;                                                          \
        return external::Formulas<__VA_ARGS__>::list(                                                                \
            watch, external::build_id, {external::fill_own_w128, external::fill_own_w256, external::fill_own_w512}); \
    }                                                                                                                \
    const lb_form* lostbits_forms(int abi, std::size_t* count) {                                                     \
        return lostbits::intersect::external::Formulas<__VA_ARGS__>::plain(abi, count);                              \
    }

#endif
