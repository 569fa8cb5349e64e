// The libraries that tests load, by name, and what a summary says of their forms.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace lostbits::test {

inline std::string library(const std::string& name) { return std::string(LOSTBITS_LIBRARIES) + "/" + name + ".so"; }
inline std::string plugin(const std::string& name) { return " --plugin " + library(name); }

/// The line of a form in a summary, without its name.
inline std::map<std::string, std::string> row_of(const std::filesystem::path& summary, const std::string& form,
                                                 const std::string& format) {
    for (auto& row : read_csv(summary)) {
        if (row["form"] == form && row["format"] == format) return row;
    }
    FAIL("no row " << form << " " << format);
    return {};
}

}  // namespace lostbits::test
