// What runs shaders here, asked in a process of its own.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/choice/doors.hpp"

namespace lostbits::analysis::choice {

/// A device as its process told it.
struct DeviceTold {
    std::string kind;
    std::vector<std::pair<std::string, std::string>> facts;
    std::string lacks;  ///< why it does not compute; empty where it does
};

/// Starts a driver, asks it how it rounds within the seconds of the words, and ends it. A driver that crashes or hangs
/// is one that is not here.
DeviceTold ask_device(std::string_view kind, const DoorWords& words);

}  // namespace lostbits::analysis::choice
