// Rays as a file of cases, every number exact.
#pragma once

#include <string>

#include "scene/rays/rays.hpp"

namespace lostbits::output::sweep {

/// What stands in front of the first case.
std::string head_of_cases(const std::string& title, const std::string& source);

/// A `[[case]]`: the first ray of a group, with its end where it has one, and all solids of the group.
std::string case_text(const std::string& name, const scene::rays::RayGroup& one);

}  // namespace lostbits::output::sweep
