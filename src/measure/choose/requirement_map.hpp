// Finds for each pixel of a scene the cheapest form and format that meet a requirement there, and the narrowest format
// in which any form meets it.
#pragma once

#include <cstdint>
#include <vector>

#include "measure/choose/candidates.hpp"
#include "measure/evaluate/map.hpp"

namespace lostbits::measure::choose {

/// Pixels at which a row meets the requirement: its decision is right and, if the ray hits, t keeps the required bits
/// within the tolerance. The requirement's shares (`wrong`, `quantile`) are about many pixels and do not apply to one
/// pixel. The metrics of the map must be those of the requirement.
class PassingPixels {
public:
    PassingPixels(std::size_t pixels, const Requirement& requirement, int precision)
        : requirement_(requirement), precision_(precision), meets_(pixels), unresolved_(pixels) {}

    void add_band(const evaluate::BandResult& result);
    [[nodiscard]] bool meets(std::size_t pixel) const { return meets_[pixel]; }
    /// True if the truth is not proved, so that it is unknown whether the row meets the requirement.
    [[nodiscard]] bool is_unresolved(std::size_t pixel) const { return unresolved_[pixel]; }
    [[nodiscard]] std::uint64_t count() const;

private:
    Requirement requirement_;
    int precision_;
    std::vector<bool> meets_, unresolved_;
};

/// One `PassingPixels` for each row of the request, in the form that `run_map` takes.
struct PassingPixelsByForm {
    std::vector<PassingPixels> rows;
    explicit PassingPixelsByForm(const ChoiceRequest& request, const std::vector<evaluate::TestedForm>& forms);
    [[nodiscard]] evaluate::ShowForms show() { return evaluate::show_to_each(rows); }
};

struct RequirementMap {
    static constexpr int none = -1;        ///< nothing meets the requirement at the pixel
    static constexpr int unresolved = -2;  ///< the truth is unknown there
    int width = 0, height = 0;
    std::vector<int> cheapest{};    ///< by pixel, from the top left: index of the candidate, or one of the above
    std::vector<int> narrowest{};   ///< the same for indices of `formats`
    std::vector<Format> formats{};  ///< formats in which forms compute, narrowest significand first
    /// By candidate: number of pixels at which it meets the requirement, and at which it is the cheapest that does.
    std::vector<std::uint64_t> met_pixel_counts{}, cheapest_pixel_counts{};
    std::vector<std::uint64_t>
        met_by_any_form_pixel_counts{};  ///< by format: pixels at which any form meets the requirement
    std::vector<std::uint64_t>
        narrowest_pixel_counts{};           ///< by format: pixels at which it is the narrowest such format
    std::uint64_t unmet_pixel_count = 0;    ///< pixels at which nothing meets the requirement
    std::uint64_t unknown_pixel_count = 0;  ///< pixels whose truth is not proved

    [[nodiscard]] std::uint64_t pixel_count() const { return cheapest.size(); }
    /// Mean seconds for one ray and primitive if each pixel uses its cheapest candidate, over the pixels at which any
    /// candidate meets the requirement. Every method of switching between forms takes at least this long. NaN if there
    /// is no such pixel.
    [[nodiscard]] double min_time(const std::vector<Candidate>& candidates) const;
};

/// `passing_pixels` belongs to the request's forms, in their order, and is already filled. `untimed_forms` are in
/// emulated formats and have no time: they are measured here, and only the members about formats depend on them.
RequirementMap make_requirement_map(const ChoiceRequest& request, const std::vector<Candidate>& candidates,
                                    const PassingPixelsByForm& passing_pixels);

}  // namespace lostbits::measure::choose
