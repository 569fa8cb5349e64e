#include "analysis/diff/made_by.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <system_error>

#include "analysis/selection/options.hpp"
#include "output/file/result_folder.hpp"
#include "shapes/solid.hpp"

namespace lostbits::analysis::diff {

namespace fs = std::filesystem;

namespace {

/// Options that change what is measured, and not only of what, or how it is shown.
const std::vector<std::string>& of_what_is_measured() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names{"--bits",      "--wrong",    "--at",          "--single",   "--bulk",   "--size",
                                       "--set",       "--variant",  "--steps",       "--seeds",    "--scene",  "--miss",
                                       "--direction", "--touching", "--at-origin",   "--inside",   "--facing", "--skip",
                                       "--quick",     "--stage",    "--repetitions", "--open-ends"};
        for (const ShapeRow& row : shape_rows) names.push_back("--" + std::string(row.name));
        return names;
    }();
    return all;
}

using Settings = std::map<std::string, std::set<std::string>>;

/// The values of each of the options above.
Settings settings_of(const std::string& command) {
    Settings settings;
    const auto words = selection::words_in(command);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (std::ranges::find(of_what_is_measured(), words[i]) == of_what_is_measured().end()) continue;
        if (words[i] == "--quick" || words[i] == "--single" || words[i] == "--bulk" || i + 1 == words.size())
            settings[words[i]].insert("");
        else if (words[i] != "--set") settings[words[i]].insert(words[i + 1]);
        else
            std::ranges::copy(shell::assignments_in(words[i + 1]),
                              std::inserter(settings[words[i]], settings[words[i]].end()));
    }
    return settings;
}

/// ` 8x8`; nothing of a flag.
std::string value_text(const std::string& value) { return value.empty() ? "" : " " + value; }

std::vector<std::string> only_in(const std::set<std::string>& one, const std::set<std::string>& other) {
    std::vector<std::string> values;
    std::ranges::set_difference(one, other, std::back_inserter(values));
    return values;
}

}  // namespace

std::vector<std::string> made_differently(const fs::path& a, const fs::path& b) {
    const auto left = output::file::ResultFolder::made_by_in(a), right = output::file::ResultFolder::made_by_in(b);
    if (!left || !right) return {};
    Settings of_a = settings_of(left->command), of_b = settings_of(right->command);
    std::vector<std::string> lines;
    for (const std::string& name : of_what_is_measured()) {
        const std::string option(name);
        const auto only_a = only_in(of_a[option], of_b[option]), only_b = only_in(of_b[option], of_a[option]);
        if (only_a.size() == 1 && only_b.size() == 1) {
            lines.push_back(fmt::format("{}{} in {},{} in {}", option, value_text(only_a.front()), a.string(),
                                        value_text(only_b.front()), b.string()));
            continue;
        }
        for (const std::string& value : only_a)
            lines.push_back(fmt::format("{}{} only in {}", option, value_text(value), a.string()));
        for (const std::string& value : only_b)
            lines.push_back(fmt::format("{}{} only in {}", option, value_text(value), b.string()));
    }
    return lines;
}

std::vector<std::string> made_differently_below(const fs::path& a, const fs::path& b) {
    std::vector<std::string> lines = made_differently(a, b);
    std::set<fs::path> folders;
    std::error_code none;
    for (auto at = fs::recursive_directory_iterator(a, none); at != fs::end(at); at.increment(none)) {
        if (at->is_directory(none)) folders.insert(at->path().lexically_relative(a));
    }
    for (const fs::path& folder : folders)
        std::ranges::move(made_differently(a / folder, b / folder), std::back_inserter(lines));
    return lines;
}

void print_made_differently(const std::vector<std::string>& lines) {
    if (lines.empty()) return;
    fmt::print("made with other numbers, which may be all that differs:\n");
    for (const std::string& line : lines) fmt::print("  {}\n", line);
}

}  // namespace lostbits::analysis::diff
