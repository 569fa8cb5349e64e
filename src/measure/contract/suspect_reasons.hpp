// The mistakes that a contract is suspected of, and how an answer tells of each.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "measure/contract/suspect.hpp"

namespace lostbits::measure::contract {

inline bool is_about(double x, double y) { return std::fabs(x - y) <= 0x1p-8 * std::fabs(y); }

/// Whether an answer has the right decision, and t to 2^-8 of itself.
inline bool is_right(const Judged& j) {
    if (j.hit != j.truly_hits) return false;
    return !j.hit || std::isnan(j.t) || j.t == j.true_t || is_about(j.t, j.true_t);
}

/// Something that a contract may have said wrongly: whether it explains an answer.
struct Reason {
    /// Which answers it speaks about, and has to explain.
    enum class About : std::uint8_t {
        t,      ///< the t of hits that should be: decisions are wrong beside it, by arithmetic as a rule
        wrong,  ///< every wrong answer
        all,    ///< as it would change every answer, the right ones too. A march that ends early misses near the rim,
                ///< as a smaller sphere would, and is right in the middle, where that is not
        decisions  ///< hits and misses alone, all of them, in both ways
    };
    std::string words;       ///< what seems to be wrong
    std::string to_library;  ///< what to write where an intersector answered
    std::string to_file;     ///< and where a file holds the answers
    std::function<bool(const Judged&)> explains;
    About about = About::t;
};

struct KnownUnits {
    double factor;
    const char* words;
};
inline constexpr KnownUnits known_units[] = {{1000, "millimetres for metres"}, {0.001, "metres for millimetres"},
                                             {100, "centimetres for metres"},  {0.01, "metres for centimetres"},
                                             {0.0254, "metres for inches"},    {1 / 0.0254, "inches for metres"},
                                             {0.3048, "metres for feet"},      {1 / 0.3048, "feet for metres"},
                                             {25.4, "millimetres for inches"}, {2.54, "centimetres for inches"}};

/// All of them, in the order in which they are asked.
const std::vector<Reason>& reasons();

}  // namespace lostbits::measure::contract
