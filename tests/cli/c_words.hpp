// Parts of the C programs of `explain --c`. The short tests compile a few of the programs that have the same parts.
#pragma once

#include <cctype>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace lostbits::test {

/// The functions that main calls, and its operators.
inline std::set<std::string> find_words_of_main(const std::string& source) {
    std::set<std::string> words;
    std::string name;
    for (std::size_t i = source.find("int main"); i < source.size(); ++i) {
        if (source.compare(i, 2, "/*") == 0) i = source.find("*/", i) + 2;
        const char c = source[i], next = source[i + 1];
        if (std::string_view("+-*/<>=!&|?").find(c) != std::string_view::npos)
            words.insert(c == next || next == '=' ? std::string{c, next} : std::string{c});
        if (c == '(' && !name.empty()) words.insert(name);
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') name += c;
        else name.clear();
    }
    return words;
}

/// Counts the words of a program: returns true if the program has a word that fewer than two programs before it had.
inline bool add_words(const std::string& source, std::map<std::string, int>& seen) {
    bool adds = false;
    for (const std::string& word : find_words_of_main(source)) adds |= seen[word]++ < 2;
    return adds;
}

}  // namespace lostbits::test
