// A form from outside, asked directly: what it says itself, before the table makes it keep its contract.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "intersect/doors/contract.hpp"
#include "intersect/doors/foreign_batch.hpp"

namespace lostbits::measure::contract {

/// One ray against one solid, in numbers that binary32 holds.
struct Question {
    std::array<double, 6> ray;               ///< origin, direction
    std::array<double, most_numbers> solid;  ///< as in `Solid::numbers`
    double end = std::numeric_limits<double>::infinity();
    double start = 0;
};

struct Reply {
    std::uint8_t hit = 0;
    double near = 0, far = 0;
    friend bool operator==(const Reply&, const Reply&) = default;
};

/// A flat solid around a point shows its back to rays that go up. Whom it is not there to is asked in the mirror z →
/// −z, where it shows its front.
inline Question from_its_side(Question q, const intersect::doors::Contract& contract) {
    if (contract.facing != intersect::Facing::front) return q;
    for (const std::size_t z : {2, 5}) q.ray[z] = -q.ray[z];
    std::size_t first = 0;
    for (const Key& key : row_of(contract.shape).keys) {
        if (key.kind == Key::Kind::point) q.solid[first + 2] = -q.solid[first + 2];
        first += key.count();
    }
    return q;
}

/// The questions as one batch, each with a solid of its own unless `one_solid`, which is the first's.
template <class S>
std::vector<Reply> ask_in(const intersect::doors::ForeignForm& form, std::span<const Question> questions,
                          bool one_solid) {
    const std::size_t n = questions.size(), numbers = row_of(form.contract.shape).numbers;
    const bool ranged = (form.contract.flags & LB_RANGE) != 0;
    std::vector<S> rays, starts, ends, solids, near_far(2 * n);
    std::vector<std::uint8_t> hit(n);
    for (const Question& asked : questions) {
        const Question q = from_its_side(asked, form.contract);
        for (const double x : q.ray) rays.push_back(static_cast<S>(x));
        starts.push_back(static_cast<S>(q.start));
        ends.push_back(static_cast<S>(q.end));
        for (std::size_t k = 0; k < numbers; ++k) solids.push_back(static_cast<S>(q.solid[k]));
    }
    intersect::doors::mark_unwritten<S>(near_far, hit);
    form.answer({.size = n,
                 .rays = rays.data(),
                 .ends = ends.data(),
                 .solids = solids.data(),
                 .solid_stride = one_solid ? 0 : numbers,
                 .near_far = near_far.data(),
                 .hit = hit.data(),
                 .own = nullptr,
                 .starts = ranged ? starts.data() : nullptr});
    std::vector<Reply> replies;
    for (std::size_t i = 0; i < n; ++i) {
        const bool told = hit[i] == 1 && form.contract.roots != intersect::Roots::none;
        const bool both = told && form.contract.roots == intersect::Roots::both;
        replies.push_back({hit[i], told ? static_cast<double>(near_far[2 * i]) : 0,
                           both ? static_cast<double>(near_far[2 * i + 1]) : 0});
    }
    return replies;
}

inline std::vector<Reply> ask(const intersect::doors::ForeignForm& form, std::span<const Question> questions,
                              bool one_solid = false) {
    return form.contract.bits == 32 ? ask_in<float>(form, questions, one_solid)
                                    : ask_in<double>(form, questions, one_solid);
}

inline Reply ask(const intersect::doors::ForeignForm& form, const Question& question) {
    return ask(form, std::span(&question, 1)).front();
}

}  // namespace lostbits::measure::contract
