// What each pixel of a scene requires: the cheapest form and format that meets a wish there, and the narrowest format
// in which any form does.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/choice/candidates.hpp"

namespace lostbits::measure::choice {

/// Of each pixel, whether a row meets the wish there: it decides rightly and, where the ray hits, t keeps the wished
/// bits, within the tolerance. The wish's shares (`wrong`, `quantile`) are of many pixels and say nothing of one. The
/// metrics of the request are the wish's.
class MeetsAt {
public:
    MeetsAt(std::size_t pixels, const Wish& wish, int precision)
        : wish_(wish), precision_(precision), meets_(pixels), unresolved_(pixels) {}

    void band(const evaluate::BandResult& result);
    [[nodiscard]] bool meets(std::size_t pixel) const { return meets_[pixel]; }
    /// Nobody knows: the truth was not proved.
    [[nodiscard]] bool unresolved(std::size_t pixel) const { return unresolved_[pixel]; }
    [[nodiscard]] std::uint64_t count() const;

private:
    Wish wish_;
    int precision_;
    std::vector<bool> meets_, unresolved_;
};

/// One for each row of the request, and what `evaluate_rows` takes.
struct Meetings {
    std::vector<MeetsAt> rows;
    explicit Meetings(const ChoiceRequest& request, const std::vector<evaluate::TestedForm>& of);
    [[nodiscard]] std::vector<evaluate::Show> shows() { return evaluate::shown_to_each(rows); }
};

struct Requirement {
    static constexpr int none = -1;        ///< nothing meets the wish at the pixel
    static constexpr int unresolved = -2;  ///< the truth is not known there
    int width = 0, height = 0;
    std::vector<int> cheapest{};    ///< by pixel, from the top left: a place among the candidates, or one of the above
    std::vector<int> narrowest{};   ///< the same, a place among `formats`
    std::vector<Format> formats{};  ///< that rows compute in, narrowest significand first
    std::vector<std::uint64_t> met{};        ///< by candidate: pixels on which it meets the wish
    std::vector<std::uint64_t> taken{};      ///< by candidate: pixels on which it is the cheapest that does
    std::vector<std::uint64_t> any_meets{};  ///< by format: pixels on which any form does
    std::vector<std::uint64_t> needed{};     ///< by format: pixels on which it is the narrowest in which any form does
    std::uint64_t none_meets = 0, unknown = 0;  ///< pixels

    [[nodiscard]] std::uint64_t pixels() const { return cheapest.size(); }
    /// Seconds a ray and solid if each pixel on which anything meets the wish took its cheapest, on average: no way of
    /// switching between forms takes less. NaN where there is no such pixel.
    [[nodiscard]] double least_time(const std::vector<Candidate>& all) const;
};

/// `meetings` are of the request's rows, in their order, and filled. `untimed` are forms in emulated formats, which
/// have no time: they are measured here, and count among the formats alone.
Requirement requirement_of(const ChoiceRequest& request, const std::vector<Candidate>& all, const Meetings& meetings);

}  // namespace lostbits::measure::choice
