// `lostbits explain --ranges`: all rays of a scene's ranges at once.
#pragma once

#include <string>
#include <vector>

#include "analysis/choice/ray_words.hpp"
#include "commands.hpp"

namespace lostbits::analysis {

/// What is asked beside the scene.
struct RangeWords {
    bool asked = false;               ///< --ranges
    std::vector<std::string> ranges;  ///< NAME=LOW..HIGH
    int boxes = 4096;

    [[nodiscard]] bool any() const { return asked || !ranges.empty(); }
};

/// InputError for words that name a ray, and for ranges that are none.
Exit explain_ranges(const choice::RayWords& ray, const RangeWords& words, const measure::map::MapRow& row, bool json,
                    const Common& common);

}  // namespace lostbits::analysis
