// What the words of a sentence say of the evidence that it needs.
#include <regex>

#include "scene/claim/claims_file.hpp"

namespace lostbits::scene::claim {

std::string universal_word(const std::string& statement) {
    static const std::regex word(
        R"(\b(sound|never|always|every|everywhere|none|nothing|no|cannot|any|all|at most|at least)\b)",
        std::regex::icase);
    std::smatch found;
    return std::regex_search(statement, found, word) ? found[1].str() : "";
}

bool tells_of_a_sample(const std::string& text) {
    static const std::regex words(R"(\b(samples?|random|[0-9][0-9,]* (rays|pixels|points|numbers|marches))\b)",
                                  std::regex::icase);
    return std::regex_search(text, words);
}

}  // namespace lostbits::scene::claim
