// Rays for the stages, as columns, and what MPFI says of each.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "measure/stages/stages.hpp"
#include "measure/truth/enclose.hpp"

namespace lostbits::testing {

/// first + second + rest, each at most 2^-53 of the one before: the stages are given the first, or the first two.
struct StageNumber {
    double first, second = 0, rest = 0;
};

/// A ray with its solid.
struct StageProblem {
    std::array<StageNumber, 6> ray;
    Shape shape;
    std::array<StageNumber, 6> solid;
    Range<double> range = {};
};

/// What a stage says of one problem.
struct StageFinding {
    bool settled, hit;
    double hi, lo, bound;
    friend bool operator==(const StageFinding&, const StageFinding&) = default;
};

enum class StageName { binary64, double_double, of_two_words };

/// Runs a stage over problems of one shape. Numbers are stored as the stage takes them: rounded to float, to double, or
/// to two words.
std::vector<StageFinding> run_stage(StageName stage, bool distance, const std::vector<StageProblem>& problems,
                                    intersect::simd::Isa isa);

/// Empty where MPFI says the same: the decision, and the length within its bound. `checked` counts the hits.
std::string contradiction(const StageProblem& problem, const StageFinding& found, bool distance);

std::string paste(const StageProblem& problem);

}  // namespace lostbits::testing
