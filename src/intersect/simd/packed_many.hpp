// One ray against many solids, structure of arrays, at each register width: what a traversal asks. The bits are those
// of the forms' scalar answers.
#pragma once

#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

/// n boxes; S is float or double.
template <class S>
struct BoxArrays {
    std::span<const S> lo_x, lo_y, lo_z, hi_x, hi_y, hi_z;
    [[nodiscard]] std::size_t size() const { return lo_x.size(); }
};

/// n spheres.
template <class S>
struct SphereArrays {
    std::span<const S> x, y, z, radius;
    [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// One ray against an array of solids, `Solids` by `Solids`: solid by solid, or over packs. Empty where there is none.
template <class S, class Solids, class... Answers>
class ManyKernel {
public:
    using Plain = void (*)(const Ray<S>&, const Solids&, Answers...);
    using Packed = void (*)(const RawSolids<S>&);

    constexpr ManyKernel(Plain plain = nullptr) : plain_(plain) {}
    constexpr ManyKernel(Packed packed, std::size_t lanes) : packed_(packed), lanes_(lanes) {}

    void operator()(const Ray<S>& ray, const Solids& solids, Answers... answers) const;
    explicit constexpr operator bool() const { return plain_ != nullptr || packed_ != nullptr; }
    friend constexpr bool operator==(const ManyKernel&, const ManyKernel&) = default;

private:
    Plain plain_ = nullptr;
    Packed packed_ = nullptr;
    std::size_t lanes_ = 0;
};

/// t[i] is where the ray ends for box i: the closest hit found so far, or infinity. On a hit it becomes the form's t,
/// where the ray enters the box; otherwise it stays. (The interface is that of Barnes's article, part 3.)
template <class S>
using ManyBoxes = ManyKernel<S, BoxArrays<S>, std::span<S>>;

/// t[i] and hit[i] (0 or 1) are the form's answers for sphere i.
template <class S>
using ManySpheres = ManyKernel<S, SphereArrays<S>, std::span<S>, std::span<std::uint8_t>>;

/// A form's kernels; null for the other shape and where the form does not exist (see `Info::formats`). Any number of
/// solids; nothing is read or written beyond the spans, nothing allocated.
struct ManyRow {
    const Info* info = nullptr;
    ManyBoxes<float> boxes32;
    ManyBoxes<double> boxes64;
    ManySpheres<float> spheres32;
    ManySpheres<double> spheres64;
};

/// Every form, in the order of `catalogue()`; `scalar` goes solid by solid. Empty where `isa` is not available.
std::span<const ManyRow> many_rows(Isa isa);

/// The kernels at `current_isa()` of a row of the table; all null for a row that is not the table's.
ManyRow many_kernels(const table::Intersector& form);

}  // namespace lostbits::intersect::simd
