#include "analysis/shell/renamed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lostbits::analysis::shell {

namespace {

constexpr std::string_view every_command = "*";
constexpr RenamedOption renamed[] = {
    {"*", "--intersector", "--form"},
    {"diff", "--tolerance", "--allow"},
    {"diff", "--pictures", "--compare-pictures"},
    {"explain", "--at", "--at-step"},
    {"explain", "--range", "--input-range"},
    {"judge", "--format", "--answer-format"},
    {"judge", "--file-format", "--answer-format"},
    {"choose", "--file-format", "--answer-format"},
    {"mend", "--file-format", "--answer-format"},
    {"judge", "--worst", "--worst-rays"},
    {"map", "--bits-needed", "--bits"},
    {"trade", "--scene", "SCENE"},
    {"list", "hulls", "boxes"},
    {"list", "makers", "generators"},
    {"list", "spaces", "transforms"},
};

/// The place of the command among the words, behind the program's own options and their values.
std::size_t index_of_command(const Command& program, const std::vector<std::string>& words) {
    std::size_t at = 1;
    for (; at < words.size() && words[at].starts_with("-"); ++at) {
        const Option option = program.option(words[at]);
        if (option && option.takes_value()) ++at;
    }
    return at;
}

}  // namespace

std::span<const RenamedOption> renamed_options() { return renamed; }

UpdatedArguments with_new_names(const Command& program, const std::vector<std::string>& words) {
    UpdatedArguments found{words, {}};
    const std::size_t command = index_of_command(program, words);
    if (command >= words.size()) return found;
    for (std::size_t i = command + 1; i < found.words.size() && found.words[i] != "--"; ++i) {
        std::string& word = found.words[i];
        const std::size_t end = std::min(word.find('='), word.size());
        const auto row = std::ranges::find_if(renamed, [&](const RenamedOption& one) {
            const bool is_of_command = one.command == every_command || words[command] == one.command;
            return is_of_command && word.substr(0, end) == one.before;
        });
        if (row == std::end(renamed)) continue;
        const bool is_value = row->before[0] != '-', is_argument = !is_value && row->now[0] != '-';
        std::string says =
            is_value      ? fmt::format("{} {}: the list is called {} now", words[command], row->before, row->now)
            : is_argument ? fmt::format("{} {}: the option is not needed any more; write {} without it", words[command],
                                        row->before, row->now)
                          : fmt::format("{} {}: the option is called {} now", words[command], row->before, row->now);
        if (std::ranges::find(found.advice, says) == found.advice.end()) found.advice.push_back(std::move(says));
        if (!is_argument) word.replace(0, end, row->now);
        else if (end < word.size()) word.erase(0, end + 1);
        else found.words.erase(found.words.begin() + static_cast<std::ptrdiff_t>(i)), --i;
    }
    return found;
}

}  // namespace lostbits::analysis::shell
