// Rewrites messages of the program for the C and Python interfaces: replaces the command-line options in a message by
// the names of the arguments that stand for them.
#include <array>
#include <cctype>
#include <string_view>

#include "analysis/library/handles.hpp"

namespace lostbits::analysis::library {

namespace {

/// Options whose arguments have another name.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> renamed{{{"-i", "forms"},
                                                                                {"-f", "formats"},
                                                                                {"--metric", "metrics"},
                                                                                {"--form", "forms"},
                                                                                {"--strategy", "strategies"},
                                                                                {"--check", "checks"},
                                                                                {"--stage", "stages"},
                                                                                {"--answer-format", "format"}}};
/// The advice of the message about a t below 0 in a file without a column hit.
constexpr std::string_view miss_advice = "; add a column hit, or write --miss";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Name of the argument that stands for an option.
std::string argument(std::string_view option) {
    for (const auto& [name, argument_name] : renamed)
        if (option == name) return std::string(argument_name);
    std::string word(option.substr(2));
    std::ranges::replace(word, '-', '_');
    return word;
}

}  // namespace

std::string name_arguments(std::string text) {
    if (const std::size_t at = text.find(miss_advice); at != std::string::npos)
        text.replace(at, std::string::npos, "; give hit too: hit = t >= 0 if a negative t means a miss");
    std::string rewritten;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_word_start = i == 0 || text[i - 1] == ' ' || text[i - 1] == '(';
        std::size_t end = i;
        while (is_word_start && text[i] == '-' && end < text.size() && (text[end] == '-' || is_letter(text[end])))
            ++end;
        const std::string_view word = std::string_view(text).substr(i, end - i);
        const bool is_option =
            word.size() > 2 ? word.starts_with("--") && is_letter(word[2]) : word == "-i" || word == "-f";
        if (!is_option) {
            rewritten += text[i];
            continue;
        }
        rewritten += argument(word);
        i = end - 1;
    }
    return rewritten;
}

}  // namespace lostbits::analysis::library
