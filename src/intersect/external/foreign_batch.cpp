#include "intersect/external/foreign_batch.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

template <class S>
using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
/// Bits of the NaN that fills the answer buffers before a call. No form answers this NaN, so where it remains, the form
/// has written nothing.
template <class S>
constexpr Bits<S> unwritten = sizeof(S) == 4 ? static_cast<Bits<S>>(0x7FCAFE15U)
                                             : static_cast<Bits<S>>(0x7FFCAFE15BAD5EEDULL);
constexpr std::uint8_t unwritten_hit = 0xEE;

/// The columns of a batch interleaved ray by ray, and buffers for the answers. Each thread has its own.
template <class S>
struct InterleavedBatch {
    std::vector<S> rays, near_far, primitives, starts, ends;
    std::vector<std::uint8_t> hit;

    void fill_from(const table::RayBatch<S>& batch, const Target<S>& target) {
        const std::size_t n = batch.size();
        rays.resize(6 * n);
        const std::array columns{batch.ox.data(), batch.oy.data(), batch.oz.data(),
                                 batch.dx.data(), batch.dy.data(), batch.dz.data()};
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t k = 0; k < 6; ++k) rays[6 * i + k] = columns[k][i];
        }

        primitives.clear();
        for (const Primitive<S>& primitive : target.primitives) {
            const auto used = primitive.shape_numbers();
            primitives.insert(primitives.end(), used.begin(), used.end());
        }

        near_far.resize(2 * n);
        hit.resize(n);
        starts.clear();
        ends.clear();
        mark_unwritten<S>(near_far, hit);
    }
};

/// Appends where the closed range of each ray begins and ends.
template <class S>
void append_ranges(const table::RayBatch<S>& rays, std::vector<S>& starts, std::vector<S>& ends) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Range<S> range = rays.range(i).with_closed_ends();
        starts.push_back(range.tmin);
        ends.push_back(range.tmax);
    }
}

template <class S>
bool is_unwritten(S x) {
    return std::bit_cast<Bits<S>>(x) == unwritten<S>;
}

/// Calls `fail` with the problem if the form has not written its answer to a ray, or not as its contract says.
template <class S, class Fail>
void require_answer(const Contract& contract, std::uint8_t hit_byte, const S* near_far, const Fail& fail) {
    if (hit_byte == unwritten_hit) fail("did not write `hit`; it must be 1 or 0 for every ray");
    if (hit_byte > 1) fail("wrote " + std::to_string(hit_byte) + " to `hit`; it must be 1 or 0");
    if (hit_byte == 0 || contract.roots == Roots::none) return;
    const bool yields_both = contract.roots == Roots::both;
    if (is_unwritten(near_far[0]) || (yields_both && is_unwritten(near_far[1])))
        fail(yields_both ? "reported a hit but did not write both near and far; if it yields one root, set `roots` "
                           "accordingly"
                         : "reported a hit but did not write t");
}

}  // namespace

template <class S>
void mark_unwritten(std::span<S> near_far, std::span<std::uint8_t> hit) {
    std::ranges::fill(near_far, std::bit_cast<S>(unwritten<S>));
    std::ranges::fill(hit, unwritten_hit);
}
template void mark_unwritten(std::span<float>, std::span<std::uint8_t>);
template void mark_unwritten(std::span<double>, std::span<std::uint8_t>);

template <class S>
Hit<S> apply_contract(const Contract& contract, std::uint8_t hit_byte, const S* near_far, S end) {
    if (hit_byte == 0) return {false, 0, 0, 0};

    // A form without t only decides.
    if (contract.roots == Roots::none) {
        constexpr S no_t = std::numeric_limits<S>::quiet_NaN();
        return {true, no_t, no_t, no_t};
    }

    const S near = near_far[0], far = contract.roots == Roots::both ? near_far[1] : near_far[0];
    // One root is the answer. It does not count if it lies behind the origin and is the near side, or if it lies beyond
    // the end of a ray that the form does not know.
    if (contract.roots != Roots::both) {
        const bool near_is_behind = contract.roots == Roots::near_only && near < 0;
        return {!near_is_behind && ((contract.flags & LB_NO_END) == 0 || !(near > end)), near, near, far};
    }

    // Both roots: the near side is the answer if it lies ahead. At t = 0 it counts only under `at_origin = hit`. A near
    // side that is NaN stays the answer, so that it is seen as an error.
    const bool hits_at_origin = contract.at_origin == AtOrigin::hit,
               misses_at_origin = contract.at_origin == AtOrigin::miss;
    const bool near_is_ahead = std::isnan(near) || (hits_at_origin ? near >= 0 : near > 0);

    // If it is not, the origin lies inside, and `inside` says if the answer is 0, the far side or a miss.
    const Inside inside = inside_of(contract);
    const bool inside_gives_zero =
        inside == Inside::zero || (inside == Inside::usual && inside_returns_zero(contract.shape));
    const S t = near_is_ahead ? near : inside_gives_zero ? S(0) : far;
    bool hit = near_is_ahead || inside != Inside::miss;

    // Under `at_origin = miss`, a primitive that ends at the origin is a miss.
    if (misses_at_origin && far <= 0) hit = false;
    // A form for lines also reports primitives that lie behind the origin.
    if ((contract.flags & LB_LINE) != 0 && far < 0) hit = false;
    // A form that does not take the end of a ray also reports hits beyond it.
    if ((contract.flags & LB_NO_END) != 0) hit = hit && !(t > end);
    return {hit, t, near, far};
}
template Hit<float> apply_contract(const Contract&, std::uint8_t, const float*, float);
template Hit<double> apply_contract(const Contract&, std::uint8_t, const double*, double);

void ForeignBatch::evaluate(const lb_batch& batch) {
    if ((form_.contract.flags & LB_ONE_THREAD) == 0) return form_.answer(batch);
    const std::scoped_lock lock(one_at_a_time_);
    form_.answer(batch);
}

template <class S>
void ForeignBatch::answer_in_format(const table::RayBatch<S>& rays, const Target<S>& target,
                                    const table::HitBatch<S>& hits) {
    thread_local InterleavedBatch<S> buffers;
    const std::size_t n = rays.size();
    if (n == 0) return;

    // Forms that take a range get both of its ends, the others at most the end.
    buffers.fill_from(rays, target);
    const bool has_ranges = (form_.contract.flags & LB_RANGE) != 0 && rays.have_ranges();
    if (has_ranges) append_ranges(rays, buffers.starts, buffers.ends);
    const bool has_ends = !has_ranges && takes_tmax(form_.contract.shape) && !rays.tmax.empty();

    evaluate({.size = n,
              .rays = buffers.rays.data(),
              .ends = has_ranges ? buffers.ends.data()
                      : has_ends ? rays.tmax.data()
                                 : nullptr,
              .primitives = buffers.primitives.data(),
              .primitive_stride = target.primitives.size() == 1 ? 0 : target.primitives.front().shape_numbers().size(),
              .near_far = buffers.near_far.data(),
              .hit = buffers.hit.data(),
              .own = nullptr,
              .starts = has_ranges ? buffers.starts.data() : nullptr});

    for (std::size_t i = 0; i < n; ++i) {
        const S* const near_far = &buffers.near_far[2 * i];
        require_answer(form_.contract, buffers.hit[i], near_far, [&](const std::string& problem) {
            throw EnvironmentError(form_.provider + ": form \"" + form_.contract.name + "\" " + problem + " (ray " +
                                   std::to_string(i) + " of " + std::to_string(n) + " in a batch)");
        });
        const S end = has_ends ? rays.tmax[i] : std::numeric_limits<S>::infinity();
        const Hit<S> hit = apply_contract(form_.contract, buffers.hit[i], near_far, end);
        hits.hit[i] = hit.hit;
        hits.t[i] = hit.t;
        hits.near[i] = hit.near;
        hits.far[i] = hit.far;
    }
}

void ForeignBatch::answer(const table::RayBatch<float>& rays, const Target<float>& target,
                          const table::HitBatch<float>& hits) {
    answer_in_format(rays, target, hits);
}

void ForeignBatch::answer(const table::RayBatch<double>& rays, const Target<double>& target,
                          const table::HitBatch<double>& hits) {
    answer_in_format(rays, target, hits);
}

}  // namespace lostbits::intersect::external
