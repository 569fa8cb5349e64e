// Which step on the way into the space of a solid and back loses what: each done as the format rounds it, one after the
// other, and all that is left to do exactly.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "intersect/space/spaced.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::measure::answer {

inline constexpr std::size_t step_count = intersect::space::step_names.size();

/// What a ray is named by: nothing where form and truth miss, or nothing is lost.
inline constexpr auto step_categories = [] {
    std::array<std::string_view, step_count + 1> all{"nothing"};
    std::ranges::copy(intersect::space::step_names, all.begin() + 1);
    return all;
}();

/// With tₖ the answer where the first k steps are rounded and the others are exact, t₀ is true for the stored numbers
/// and the last is the form's answer: step k is assigned tₖ − tₖ₋₁, and these sum to the whole error.
struct Steps {
    /// t₀ to t₆, lengths as the row answers them; nothing for a ray that misses there.
    std::array<std::optional<truth::Certified>, step_count + 1> t;

    /// What step k is assigned, in units of 2^exponent; NaN where it, or what it began with, misses.
    [[nodiscard]] double error(std::size_t k, std::int64_t exponent) const;
    /// The step of the largest error where all of them hit, of a decision that comes out wrong the first that makes it
    /// so; nothing where all of them miss, or nothing is lost.
    [[nodiscard]] std::optional<std::size_t> worst() const;
};

/// Of a row that `space::through` made, one of our own templates; the ray as the form received it, the solid under a
/// matrix. By the convention of the row, and in a range.
Steps steps_of(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
               const Solid<double>& solid, const Range<double>& range = {});

}  // namespace lostbits::measure::answer
