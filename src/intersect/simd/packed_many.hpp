// The query of a traversal: one ray against many primitives, structure of arrays, at each register width. The answers
// have the same bits as the forms' scalar answers.
#pragma once

#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

/// n primitives of one shape, with a column for each number of the shape in the order of `Primitive`. S is float or
/// double.
template <class S>
struct PrimitiveArrays {
    std::array<std::span<const S>, max_number_count> numbers;
    [[nodiscard]] std::size_t size() const { return numbers[0].size(); }
};

/// Runs one ray against an array of primitives, one by one or over packs. Converts to false if the form has no such
/// kernel. t[i] and hit[i] (0 or 1) become the form's answers for primitive i. If the form takes tmax, t[i] holds tmax
/// at the call (the closest hit found so far, or infinity) and stays if there is no hit; `hit` is then not used. (This
/// is the interface of Barnes's article, part 3.)
template <class S>
class ManyKernel {
public:
    using Plain = void (*)(const Ray<S>&, const PrimitiveArrays<S>&, std::span<S>, std::span<std::uint8_t>);
    using Packed = void (*)(const RawPrimitives<S>&);

    constexpr ManyKernel(Plain plain = nullptr) : plain_(plain) {}
    constexpr ManyKernel(Packed packed, std::size_t lane_count) : packed_(packed), lane_count_(lane_count) {}

    void operator()(const Ray<S>& ray, const PrimitiveArrays<S>& primitives, std::span<S> t,
                    std::span<std::uint8_t> hit = {}) const;
    explicit constexpr operator bool() const { return plain_ != nullptr || packed_ != nullptr; }

private:
    Plain plain_ = nullptr;
    Packed packed_ = nullptr;
    std::size_t lane_count_ = 0;
};

/// The kernels of a form. Both are null for a march. `f64` is also null if the shape has no kernels for many
/// primitives, or if the form has no binary64 version (see `Info::formats`). A kernel takes any number of primitives,
/// allocates no memory, and does not access memory beyond the spans.
struct ManyFormKernels {
    const Info* info = nullptr;
    bool takes_tmax = false;
    ManyKernel<float> f32;
    ManyKernel<double> f64;
};

/// Appends the rows of a part of the catalogue (`FirstForms`, `SecondForms`), which run the primitives one by one.
template <class Forms>
void append_many_kernels(std::vector<ManyFormKernels>& rows);

/// The rows of all forms, in the order of `catalogue()`; `scalar` runs the primitives one by one. Empty if `isa` is not
/// available.
std::span<const ManyFormKernels> all_many_kernels(Isa isa);

/// The kernels of a row of the catalogue at `current_isa()`; all null for any other row.
ManyFormKernels many_kernels(const table::Intersector& form);

}  // namespace lostbits::intersect::simd
