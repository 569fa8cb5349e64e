// How texts speak of what a claim is measured on.
#pragma once

#include <string>

#include "scene/claim/claims_file.hpp"

namespace lostbits::output::claim {

struct SubjectWords {
    std::string heading;  ///< of all claims about it: `near-benign, rendered`
    std::string where;    ///< scene, sweep or table, and the place in it: `near-benign, rendered to stage phong`
    std::string place;    ///< that place under the heading: `stage phong`
    std::string command;  ///< what measures it again with every file
};

[[nodiscard]] SubjectWords words_of(const scene::claim::Claim& claim);

}  // namespace lostbits::output::claim
