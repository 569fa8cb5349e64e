// What forms that do not meet a wish are mended to, as candidates of a choice.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/mend/price.hpp"
#include "output/choice/choice_text.hpp"

namespace lostbits::analysis {

/// Mended forms, which stay loaded as long as this.
struct Mending {
    struct Made {
        intersect::doors::Formula formula;
        Format format;
    };
    std::vector<Made> made;
    std::vector<output::choice::MendedCandidate> candidates;  ///< in the same order
};

/// Of every row of the request that does not meet its wish and whose operations can be seen: all that
/// `measure::mend::mend` makes of it that does, compiled, and as a file in `folder`. Two forms that are mended to the
/// same count once. EnvironmentError where nothing can be compiled. `command` is what asks for it.
Mending mended(const measure::choice::ChoiceRequest& request, const measure::mend::Workshop& workshop,
               const std::filesystem::path& folder, const std::string& command);

}  // namespace lostbits::analysis
