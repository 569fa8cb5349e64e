// Output of a command about the ray that a table names.
#pragma once

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace lostbits::test {

/// The JSON of `lostbits explain …`, run in a folder.
inline nlohmann::json run_explain(const std::string& command, const fs::path& folder = ".") {
    INFO(command);
    REQUIRE(command.starts_with("lostbits explain "));
    return nlohmann::json::parse(must(command.substr(9) + " --json -q", folder).out);
}

/// A number of the JSON as a cell of a table shows it: `inf` and `nan` are words.
inline double number_in(const nlohmann::json& j) {
    return j.is_string() ? std::strtod(j.get<std::string>().c_str(), nullptr) : j.get<double>();
}
inline std::string hex_in(const nlohmann::json& j) { return j.is_null() ? "" : j["hex"].get<std::string>(); }

}  // namespace lostbits::test
