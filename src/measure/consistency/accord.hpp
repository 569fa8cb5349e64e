// How the answers to two questions that should have one answer stand to each other.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/truth/missing.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::consistency {

/// `not_asked`: there is no such pair of questions at this pixel. `first_alone`, `second_alone`: one is answered with
/// yes (a hit) and the other with no, and at least one of the two answers is wrong. `other_number`: the decisions are
/// alike, the numbers are further apart than they may be. `by_inputs`: they differ as the exact answers do, because the
/// stored numbers of the two questions are not quite the same problem. `unresolved`: the exact answers are not proved.
enum class Accord : std::uint8_t { not_asked, agree, first_alone, second_alone, other_number, by_inputs, unresolved };
inline constexpr std::array<std::string_view, 7> accord_names{
    "not_asked", "agree", "first_alone", "second_alone", "other_number", "by_inputs", "unresolved"};

/// Whether the form is to blame.
inline constexpr bool is_disagreement(Accord a) {
    return a == Accord::first_alone || a == Accord::second_alone || a == Accord::other_number;
}

/// The rays of both questions of a pixel, which `lostbits explain` takes; directions as they are before a form that
/// assumes unit length gets them.
struct TwoRays {
    std::size_t pixel = 0;  ///< of the band
    scene::rays::RayGroup first, second;
};

/// What came of a check over a band: a value a pixel.
struct AccordOfPixels {
    explicit AccordOfPixels(std::size_t pixels) : accord(pixels, Accord::not_asked) {}

    std::vector<Accord> accord;
    /// Of checks that compare numbers: by how many ulps they are apart, and by how many more (or fewer) than the exact
    /// ones; NaN where nothing is compared. Empty for the others.
    std::vector<double> apart, excess;
    std::optional<TwoRays> shown;  ///< the first disagreement

    /// `rays()` makes the two rays; asked of the first disagreement alone.
    template <class Rays>
    void set(std::size_t pixel, Accord how, const Rays& rays) {
        accord[pixel] = how;
        if (is_disagreement(how) && !shown) {
            shown = rays();
            shown->pixel = pixel;
        }
    }
};

/// How two decisions stand to each other, where the exact ones are known.
inline constexpr Accord accord_of(bool first, bool second, bool exact_first, bool exact_second) {
    if (first == second) return Accord::agree;
    if (first == exact_first && second == exact_second) return Accord::by_inputs;
    return first ? Accord::first_alone : Accord::second_alone;
}

}  // namespace lostbits::measure::consistency
