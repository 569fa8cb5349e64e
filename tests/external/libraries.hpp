// The libraries that tests load, by name, and readers of a summary's rows about their forms.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"

namespace lostbits::test {

inline std::string library(const std::string& name) { return std::string(LOSTBITS_LIBRARIES) + "/" + name + ".so"; }
inline std::string plugin(const std::string& name) { return " --plugin " + library(name); }

/// The line of a form in a summary.
inline std::map<std::string, std::string> row_of(const std::filesystem::path& summary, const std::string& form,
                                                 const std::string& format = "f32") {
    for (auto& row : read_csv(summary)) {
        if (row["form"] == form && row["format"] == format) return row;
    }
    FAIL("no row " << form << " " << format);
    return {};
}

/// Output of `plugin check` for a form in floats.
inline std::string find_output_of(const Outcome& checked, const std::string& form) {
    const auto at = checked.out.find(form + " in binary32");
    INFO(form << checked.out);
    REQUIRE(at != std::string::npos);
    return checked.out.substr(at, checked.out.find(" in binary", at + form.size() + 12) - at);
}

/// `lostbits list intersectors` with a pipe of a form a.x whose header has these lines too.
inline Outcome list_by_pipe(const std::string& words, const std::string& more = "") {
    return run("list intersectors" + more + " --pipe \"printf 'lostbits-pipe/1\\nname=a.x\\n" + words +
               "\\n\\n'; cat\"");
}

/// Headers that are refused, and why.
inline void check_refused_headers(const std::vector<std::pair<std::string, std::string>>& rows) {
    for (const auto& [words, says] : rows) {
        const Outcome o = list_by_pipe(words);
        INFO(words << ": " << o.err);
        CHECK(o.code == 2);
        CHECK(has(o.err, says));
    }
}

}  // namespace lostbits::test
