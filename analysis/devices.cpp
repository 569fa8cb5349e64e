// What runs shaders here, and how it rounds.
#include "analysis/devices.hpp"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "analysis/choice/doors.hpp"
#include "commands.hpp"
#include "intersect/device/device.hpp"
#include "intersect/device/probe.hpp"
#include "intersect/doors/child.hpp"

namespace lostbits::analysis {

DeviceTold ask_device(std::string_view kind, double seconds) {
    DeviceTold told{.kind = std::string(kind), .facts = {}, .lacks = {}};
    try {
        intersect::doors::Child child(choice::this_program("shader probe " + told.kind), told.kind, seconds);
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

namespace {

void print(const DeviceTold& told) {
    if (!told.lacks.empty()) {
        fmt::print("{}\n  not here: {}\n", told.kind, told.lacks);
        return;
    }
    fmt::print("{}\n", told.kind);
    for (const auto& [key, value] : told.facts) {
        if (key != "device") fmt::print("  {:<22} {}\n", key, value);
    }
}

Exit show(bool json, const Common& common) {
    auto array = nlohmann::ordered_json::array();
    bool any = false;
    std::vector<std::string> kinds = choice::devices_of(common.doors.devices);
    if (common.doors.devices.empty()) kinds = choice::devices_of({"all"});
    for (const std::string& kind : kinds) {
        const DeviceTold told = ask_device(kind, common.doors.seconds);
        any = any || told.lacks.empty();
        nlohmann::ordered_json object{{"device", told.kind}};
        if (!told.lacks.empty()) object["missing"] = told.lacks;
        for (const auto& [key, value] : told.facts) object[key] = value;
        array.push_back(std::move(object));
        if (!json) print(told);
    }
    if (json) fmt::print("{}\n", array.dump(2));
    else if (any && !common.quiet) fmt::print("tried on {}\n", intersect::device::probed_set);
    if (!any) throw EnvironmentError("no driver can run shaders here; docs/shader.md says what to install");
    return Exit::done;
}

}  // namespace

void add_devices(CLI::App& program, const Common& common, Command& chosen) {
    auto* const command = program.add_subcommand(
        "devices", "What runs --shader here: drivers, and how each adds, multiplies, divides and rounds");
    const auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "As a JSON array");
    command->callback([json, &common, &chosen] { chosen = [json, &common] { return show(*json, common); }; });
}

}  // namespace lostbits::analysis
