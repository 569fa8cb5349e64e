#include "intersect/shader/loops.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

namespace lostbits::intersect::shader {
namespace {

/// Names that stand for whole numbers, by #define or const int.
std::map<std::string_view, long long> whole_constants(const std::vector<Token>& tokens) {
    std::map<std::string_view, long long> found;
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
        const bool defined = tokens[i].in_directive && tokens[i].text == "define";
        const bool constant =
            (tokens[i].text == "int" || tokens[i].text == "uint") && i + 3 < tokens.size() && tokens[i + 2].text == "=";
        if (!defined && !constant) continue;
        const Token& value = tokens[i + (defined ? 2 : 3)];
        if (value.kind == Token::Kind::number && value.text.find_first_of(".xX") == std::string_view::npos)
            found[tokens[i + 1].text] = std::atoll(std::string(value.text).c_str());
    }
    return found;
}

/// Where things end, for each place in the code; its size where they do not. All at once, so that a file of brackets
/// alone takes no longer than another.
struct Ends {
    std::vector<std::size_t> bracket;    ///< behind the bracket that closes the one here; behind anything else itself
    std::vector<std::size_t> semicolon;  ///< the next one from here on
    std::vector<std::size_t> statement;  ///< behind the one that begins here: a block, or all to the next semicolon

    explicit Ends(const std::vector<Token>& code) : semicolon(code.size() + 1, code.size()), statement(semicolon) {
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < code.size(); ++i) {
            const std::string_view t = code[i].text;
            bracket.push_back(t == "(" || t == "{" ? code.size() : i + 1);
            if (t == "(" || t == "{") open.push_back(i);
            if ((t != ")" && t != "}") || open.empty()) continue;
            bracket[open.back()] = i + 1;
            open.pop_back();
        }
        for (std::size_t i = code.size(); i-- > 0;) {
            semicolon[i] = code[i].text == ";" ? i : semicolon[i + 1];
            statement[i] = std::min(semicolon[i] + 1, code.size());
            if (code[i].text == "{") statement[i] = bracket[i];
            if (code[i].text == "for" && i + 1 < code.size()) statement[i] = statement[bracket[i + 1]];
        }
    }
};

/// Whether a loop begins here whose condition says nothing: `while (true)`, `for (;;)`.
bool is_endless(const std::vector<Token>& code, const Ends& ends, std::size_t at) {
    if (code[at].text == "for") at = ends.semicolon[at];
    else if (code[at].text != "while") return false;
    if (at + 2 >= code.size()) return false;
    const bool says_true = code[at + 1].text == "true" || (code[at + 1].text == "(" && code[at + 2].text == "true");
    return says_true || (code[at].text == ";" && code[at + 1].text == ";");
}

/// The largest whole number between the `for` here and its second semicolon; 0 without one.
long long bound_of(const std::vector<Token>& code, std::size_t at,
                   const std::map<std::string_view, long long>& constants) {
    long long most = 0;
    int semicolons = 0;
    for (std::size_t k = at + 1; k < code.size() && semicolons < 2 && code[k].text != "for"; ++k) {
        semicolons += code[k].text == ";";
        const auto constant = constants.find(code[k].text);
        if (constant != constants.end()) most = std::max(most, constant->second);
        if (code[k].kind == Token::Kind::number && code[k].text.find('.') == std::string_view::npos)
            most = std::max(most, std::atoll(std::string(code[k].text).c_str()));
    }
    return std::min(most, 1'000'000'000LL);
}

}  // namespace

std::vector<CountedLoop> loops_of(const std::vector<Token>& all, const std::vector<Token>& code) {
    const auto constants = whole_constants(all);
    const Ends ends(code);
    std::vector<CountedLoop> loops;
    std::vector<std::pair<std::size_t, long long>> around;  // where they end, and how often they run together
    for (std::size_t i = 0; i + 1 < code.size(); ++i) {
        while (!around.empty() && around.back().first <= i) around.pop_back();
        if (is_endless(code, ends, i)) loops.push_back({code[i].line, CountedLoop::endless, CountedLoop::endless});
        if (code[i].text != "for") continue;
        const long long most = bound_of(code, i, constants);
        if (most <= 0) continue;
        constexpr long long largest = 1'000'000'000'000LL;
        const auto [end, times] = around.empty() ? std::pair(code.size(), 1LL) : around.back();
        const long long together = times > largest / most ? largest : most * times;
        loops.push_back({code[i].line, most, together});
        around.emplace_back(std::min(ends.statement[i], end), together);
    }
    return loops;
}

}  // namespace lostbits::intersect::shader
