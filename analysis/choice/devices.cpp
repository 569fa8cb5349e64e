#include "analysis/choice/devices.hpp"

#include "intersect/process/child.hpp"
#include "number/error.hpp"

namespace lostbits::analysis::choice {

DeviceTold ask_device(std::string_view kind, const DoorWords& words) {
    DeviceTold told{.kind = std::string(kind), .facts = {}, .lacks = {}};
    try {
        intersect::process::Child child(this_program("shader probe " + told.kind),
                                        {.who = told.kind, .duty = "", .seconds = words.seconds, .stop = words.stop});
        for (std::string line = child.read_line(); !line.empty(); line = child.read_line()) {
            const std::size_t equals = line.find('=');
            if (equals == std::string::npos) child.fail("says " + line + " where a fact is due");
            if (line.starts_with("missing=")) told.lacks = line.substr(equals + 1);
            else told.facts.emplace_back(line.substr(0, equals), line.substr(equals + 1));
        }
    } catch (const EnvironmentError& dead) {  // a driver that crashes or hangs while it is asked
        told.lacks = dead.what();
    }
    return told;
}

}  // namespace lostbits::analysis::choice
