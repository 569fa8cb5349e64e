// Rewrites messages of the program for the C and Python interfaces: replaces the command-line options in a message by
// the names of the arguments that stand for them.
#include <array>
#include <cctype>
#include <string_view>

#include "analysis/library/handles.hpp"

namespace lostbits::analysis::library {

namespace {

/// Options whose arguments do not have the name of the option.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> argument_names{{{"-i", "forms"},
                                                                                       {"-f", "formats"},
                                                                                       {"--metric", "metrics"},
                                                                                       {"--form", "forms"},
                                                                                       {"--strategy", "strategies"},
                                                                                       {"--check", "checks"},
                                                                                       {"--stage", "stages"},
                                                                                       {"--answer-format", "format"}}};
/// The end of the message about a t below 0 in a file without a column `hit`.
constexpr std::string_view miss_advice = "; add a column hit, or write --miss";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Name of the argument that stands for an option.
std::string argument_name_of(std::string_view option) {
    for (const auto& [name, argument_name] : argument_names)
        if (option == name) return std::string(argument_name);
    std::string word(option.substr(2));
    std::ranges::replace(word, '-', '_');
    return word;
}

}  // namespace

std::string replace_options_by_arguments(std::string text) {
    if (const std::size_t advice_begin = text.find(miss_advice); advice_begin != std::string::npos)
        text.replace(advice_begin, std::string::npos, "; give hit too: hit = t >= 0 if a negative t means a miss");

    // An option begins a word, which may follow a bracket.
    std::string rewritten;
    for (std::size_t position = 0; position < text.size(); ++position) {
        const bool is_word_start = position == 0 || text[position - 1] == ' ' || text[position - 1] == '(';
        std::size_t option_end = position;
        while (is_word_start && text[position] == '-' && option_end < text.size() &&
               (text[option_end] == '-' || is_letter(text[option_end])))
            ++option_end;
        const std::string_view word = std::string_view(text).substr(position, option_end - position);
        const bool is_option =
            word.size() > 2 ? word.starts_with("--") && is_letter(word[2]) : word == "-i" || word == "-f";

        if (!is_option) {
            rewritten += text[position];
            continue;
        }
        rewritten += argument_name_of(word);
        position = option_end - 1;
    }
    return rewritten;
}

}  // namespace lostbits::analysis::library
