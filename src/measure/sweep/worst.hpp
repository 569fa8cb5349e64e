// Finds the worst ray of a form in a box of parameters, by seeded local search.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/shard/share.hpp"
#include "scene/sweep/search_file.hpp"

namespace lostbits::measure::sweep {

/// Result of a search, for one row.
struct WorstResult {
    answer::Outcome outcome = answer::Outcome::agree_hit;
    double value = -1;  ///< value of the metric; meaningless for a wrong decision
    Ray<double> ray{};  ///< in numbers of the format
    Primitive<double> primitive{};
    double t = 0;         ///< the form's answer
    double truth = 0;     ///< t*, correctly rounded to binary64; NaN for a miss
    double distance = 0;  ///< from the ray's origin to the centre of a sphere, in radii; NaN for other primitives
    std::uint64_t evaluation_count = 0;
};

struct WorstRequest {
    scene::sweep::SearchFile search;
    std::vector<evaluate::TestedForm> tested_forms;
    std::vector<const metric::Metric*> metrics;  ///< metrics of the search, by `searched`
    truth::ProofLimit limit{};
    shard::Share share = {};  ///< share of the tested forms
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Searches from each of `start_count` random rays. Each of the `generation_count` generations tries 32 neighbours of
/// the current ray, which differ from it in one to three numbers by a few ordinals of the format (a random power of
/// two). The search goes on from the neighbour with the worst error if that error is not smaller than before. A wrong
/// decision ends the search of its row, unless the nearest wrong decision is requested: then the nearer of two wrong
/// decisions counts as worse, and later starts lie nearer than the nearest found so far. One result per row of the
/// share, empty if no ray of the box hits. The result depends on the file alone, not on the number of threads.
std::vector<std::optional<WorstResult>> find_worst(const WorstRequest& request);

}  // namespace lostbits::measure::sweep
