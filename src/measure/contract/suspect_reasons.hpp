// Mistakes that a contract may be suspected of, each with a test for an answer.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "measure/contract/suspect.hpp"

namespace lostbits::measure::contract {

/// True if x and y are equal to 2^-8 of y.
inline bool is_about(double x, double y) { return std::fabs(x - y) <= 0x1p-8 * std::fabs(y); }

/// True if an answer has the right decision, and t to 2^-8 of itself.
inline bool is_right(const AnswerSample& sample) {
    if (sample.hit != sample.truly_hits) return false;
    return !sample.hit || std::isnan(sample.t) || sample.t == sample.true_t || is_about(sample.t, sample.true_t);
}

/// Mistake that a contract may contain, with a test: does the mistake explain an answer?
struct SuspectedMistake {
    /// Answers that the mistake affects and has to explain.
    enum class AffectedAnswers : std::uint8_t {
        t,         ///< the t of right hits; wrong decisions beside them are usually due to arithmetic
        wrong,     ///< every wrong answer
        all,       ///< every answer, right ones too: a march that ends early misses near the rim, as a smaller sphere
                   ///< would, but is right in the middle, where a smaller sphere would not be
        decisions  ///< all decisions, hits and misses, but no t
    };
    std::string mistake;         ///< the suspected mistake
    std::string library_remedy;  ///< what to write if an intersector answered
    std::string file_remedy;     ///< what to write if a file holds the answers
    std::function<bool(const AnswerSample&)> explains;
    AffectedAnswers scope = AffectedAnswers::t;
};

/// Factor between two units of length.
struct KnownUnits {
    double factor;
    const char* text;
};
inline constexpr KnownUnits known_units[] = {{1000, "millimetres for metres"}, {0.001, "metres for millimetres"},
                                             {100, "centimetres for metres"},  {0.01, "metres for centimetres"},
                                             {0.0254, "metres for inches"},    {1 / 0.0254, "inches for metres"},
                                             {0.3048, "metres for feet"},      {1 / 0.3048, "feet for metres"},
                                             {25.4, "millimetres for inches"}, {2.54, "centimetres for inches"}};

/// All reasons, in the order in which they are tested.
const std::vector<SuspectedMistake>& reasons();

}  // namespace lostbits::measure::contract
