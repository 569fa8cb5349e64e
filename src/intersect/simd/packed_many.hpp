// One ray against many primitives, structure of arrays, at each register width: the query of a traversal. The bits are
// those of the forms' scalar answers.
#pragma once

#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

/// n solids of one shape, a column for each of its numbers in the order of `Solid`; S is float or double.
template <class S>
struct SolidArrays {
    std::array<std::span<const S>, most_numbers> numbers;
    [[nodiscard]] std::size_t size() const { return numbers[0].size(); }
};

/// One ray against an array of solids: solid by solid, or over packs. Empty where there is none. t[i] and hit[i] (0 or
/// 1) become the form's answers for solid i. Of a form that is told where a ray ends, t[i] is that end on the way in,
/// the closest hit found so far or infinity; it stays where there is no hit, and `hit` is not looked at. (That is the
/// interface of Barnes's article, part 3.)
template <class S>
class ManyKernel {
public:
    using Plain = void (*)(const Ray<S>&, const SolidArrays<S>&, std::span<S>, std::span<std::uint8_t>);
    using Packed = void (*)(const RawSolids<S>&);

    constexpr ManyKernel(Plain plain = nullptr) : plain_(plain) {}
    constexpr ManyKernel(Packed packed, std::size_t lanes) : packed_(packed), lanes_(lanes) {}

    void operator()(const Ray<S>& ray, const SolidArrays<S>& solids, std::span<S> t,
                    std::span<std::uint8_t> hit = {}) const;
    explicit constexpr operator bool() const { return plain_ != nullptr || packed_ != nullptr; }

private:
    Plain plain_ = nullptr;
    Packed packed_ = nullptr;
    std::size_t lanes_ = 0;
};

/// A form's kernels. They are null for a march; in binary64 also if the shape does not come in many or the form does
/// not exist (see `Info::formats`). Any number of primitives; nothing is read or written beyond the spans, nothing
/// allocated.
struct ManyRow {
    const Info* info = nullptr;
    bool told_end = false;
    ManyKernel<float> f32;
    ManyKernel<double> f64;
};

/// Every form, in the order of `catalogue()`; `scalar` goes solid by solid. Empty where `isa` is not available.
std::span<const ManyRow> many_rows(Isa isa);

/// The kernels at `current_isa()` of a row of the table; all null for a row that is not the table's.
ManyRow many_kernels(const table::Intersector& form);

}  // namespace lostbits::intersect::simd
