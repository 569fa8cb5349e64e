#include "analysis/shell/renamed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lostbits::analysis::shell {

namespace {

constexpr std::string_view every_command = "*";

struct RenamedOption {
    const char* command;  ///< "*" for every command
    const char* old_name;
    const char* new_name;  ///< an option, or the name of an argument
};

/// All renamed options; CHANGELOG.md has the same table.
constexpr RenamedOption renamed[] = {
    {"*", "--intersector", "--form"},
    {"diff", "--tolerance", "--allow"},
    {"diff", "--pictures", "--compare-pictures"},
    {"explain", "--at", "--at-step"},
    {"explain", "--boxes", "--pieces"},
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

/// The index of the command among the arguments: it comes after the program's own options and their values.
std::size_t index_of_command(const Command& program, const std::vector<std::string>& arguments) {
    std::size_t index = 1;
    for (; index < arguments.size() && arguments[index].starts_with("-"); ++index) {
        const Option option = program.option(arguments[index]);
        if (option && option.takes_value()) ++index;
    }
    return index;
}

bool is_list_name(const RenamedOption& option) { return option.old_name[0] != '-'; }
/// True if the value of the option is now an argument of the command.
bool has_become_argument(const RenamedOption& option) { return !is_list_name(option) && option.new_name[0] != '-'; }

std::string advice_text(const std::string& command, const RenamedOption& option) {
    const char* const change = is_list_name(option)          ? "the list has been renamed to {}"
                               : has_become_argument(option) ? "the option is not needed any more; write {} without it"
                                                             : "the option has been renamed to {}";
    return fmt::format("{} {}: {}", command, option.old_name, fmt::format(fmt::runtime(change), option.new_name));
}

}  // namespace

UpdatedArguments replace_former_names(const Command& program, const std::vector<std::string>& arguments) {
    UpdatedArguments result{arguments, {}};
    const std::size_t command = index_of_command(program, arguments);
    if (command >= arguments.size()) return result;
    for (std::size_t i = command + 1; i < result.arguments.size() && result.arguments[i] != "--"; ++i) {
        std::string& argument = result.arguments[i];
        const std::size_t name_end = std::min(argument.find('='), argument.size());
        const auto row = std::ranges::find_if(renamed, [&](const RenamedOption& option) {
            const bool is_of_command = option.command == every_command || arguments[command] == option.command;
            return is_of_command && argument.substr(0, name_end) == option.old_name;
        });
        if (row == std::end(renamed)) continue;

        std::string sentence = advice_text(arguments[command], *row);
        if (std::ranges::find(result.advice, sentence) == result.advice.end())
            result.advice.push_back(std::move(sentence));
        if (!has_become_argument(*row)) {
            argument.replace(0, name_end, row->new_name);
        } else if (name_end < argument.size()) {
            argument.erase(0, name_end + 1);
        } else {
            result.arguments.erase(result.arguments.begin() + static_cast<std::ptrdiff_t>(i));
            --i;
        }
    }
    return result;
}

}  // namespace lostbits::analysis::shell
