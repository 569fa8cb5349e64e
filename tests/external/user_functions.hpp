// Functions of users in tests: their files, the messages about them, and their operations beside their compiled code.
#pragma once

#include <filesystem>
#include <memory>
#include <random>
#include <regex>
#include <string>
#include <string_view>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/function/function.hpp"
#include "intersect/table/random_rays.hpp"
#include "number/error.hpp"
#include "scratch.hpp"

namespace lostbits::test {

inline const std::string functions_folder = std::string(LOSTBITS_SOURCE_DIR) + "/tests/external/functions/";

/// The message of a function that is refused; empty if it is not.
inline std::string find_refusal(const std::string& named) {
    try {
        intersect::function::load_function(named, {});
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// Compares two rows on random rays, a million in the long tests. Returns how many answers differ in a bit.
template <class S>
std::size_t count_differences(const intersect::table::Kernel<S>& a, const intersect::table::Kernel<S>& b, Shape shape) {
    const intersect::table::RandomRays<S> rays(shape, is_long() ? 1'000'000 : 20'000, false);
    const auto some = rays.answers(a), others = rays.answers(b);
    std::size_t differ = 0, hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hits += some.hit[i];
        differ += some.are_same(others, i) ? 0 : 1;
    }
    CHECK(hits > rays.size() / 50);
    return differ;
}

/// Compares a function's operations with its compiled code, in its own format.
inline std::size_t count_differences(const intersect::function::UserFunction& function) {
    const auto alone = function.written->make_intersector(function.answers->info);
    if (function.answers->batch32)
        return count_differences(function.intersector.native32, alone.native32, function.intersector.shape);
    return count_differences(function.intersector.native64, alone.native64, function.intersector.shape);
}

/// The text of a file with double in place of float, and float in place of double.
inline std::string exchange_formats(const std::string& text) {
    std::string made;
    static const std::regex word(R"(\b(float|double)([2-4]?)\b|\bf(32|64)\b|\bvec([2-4])\b)");
    auto from = text.begin();
    for (std::sregex_iterator at(text.begin(), text.end(), word); at != std::sregex_iterator(); ++at) {
        made.append(from, (*at)[0].first);
        if ((*at)[1].matched) made += ((*at)[1] == "float" ? "double" : "float") + (*at)[2].str();
        else if ((*at)[3].matched) made += (*at)[3] == "32" ? "f64" : "f32";
        else made += "dvec" + (*at)[4].str();
        from = (*at)[0].second;
    }
    return made.append(from, text.end());
}

/// Compares the operations of a function with its compiled code after float and double are exchanged in its file.
/// Returns false if a constant or a call, such as sqrtf, keeps its format: such a function is refused.
inline bool agrees_in_other_format(const std::string& named, int bits) {
    const std::size_t colon = named.find(':', named.rfind('/'));
    const std::filesystem::path file = named.substr(0, colon);
    const Scratch made;
    const std::string other =
        made.write(file.filename().string(), exchange_formats(contents(file))) + named.substr(colon);
    if (const std::string why = find_refusal(other); !why.empty()) {
        CHECK(why.find("that computes in float inside is not followed") != std::string::npos);
        return false;
    }
    const auto f = intersect::function::load_function(other, {});
    CHECK(f->bits + bits == 96);
    CHECK(count_differences(*f) == 0);
    return true;
}

/// Changes up to four places of a text: a letter becomes one of `letters`, or up to `most` of them are left out.
inline std::string damage(std::string text, std::mt19937& random, std::string_view letters, unsigned most) {
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
        const std::size_t at = random() % text.size();
        if (random() % 2 == 0) text[at] = letters[random() % letters.size()];
        else text.erase(at, 1 + random() % most);
    }
    return text;
}

}  // namespace lostbits::test
