// Aims rays at edges and vertices of a mesh, with a seed: counts those that a form lets through or counts twice, and
// searches for the smallest distance from which it does so.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "scene/sweep/search_file.hpp"

namespace lostbits::measure::edges {

/// Outcomes that are searched for, each by itself.
inline constexpr std::array searched_outcomes{answer::Outcome::crack, answer::Outcome::double_hit};

/// The nearest ray found with an outcome.
struct NearestRay {
    double distance = 0;  ///< from the eye to the point of an edge that it is aimed at, in lengths of that edge
    Ray<double> ray{};    ///< in numbers of binary32, or of the format if that is narrower
    std::array<std::uint32_t, 2> faces{};  ///< the faces that share the edge, or an edge of the vertex it is aimed at
    double t = 0;                          ///< the form's answer; NaN for a miss
    double truth = 0;                      ///< t*, correctly rounded to binary64
};

/// Targets of the rays of a census.
enum class EdgeTarget : std::uint8_t { edge, vertex };
inline constexpr std::array<std::string_view, 2> edge_target_names{"edge", "vertex"};

/// Number of rays of a census at one kind of target, and of those with an outcome, in the order of `searched_outcomes`.
struct EdgeCount {
    std::uint64_t rays = 0;
    std::array<std::uint64_t, searched_outcomes.size()> outcomes{};
};

/// Results of a search for one row, in the order of `searched_outcomes`.
struct EdgeFinding {
    std::array<EdgeCount, edge_target_names.size()> census{};  ///< by target
    std::array<std::optional<NearestRay>, searched_outcomes.size()> nearest;
    /// Number of rays tested: all, or those until one was found at the smallest distance of the search.
    std::array<std::uint64_t, searched_outcomes.size()> rays{};
};

struct EdgeRequest {
    scene::sweep::EdgeSearchFile search;
    std::vector<evaluate::TestedForm> rows;  ///< with forms for triangles
    truth::TruthLimit limit{};
    shard::Share share = {};    ///< share of the rows
    bool census_alone = false;  ///< runs the census, but does not search for the nearest ray
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Units of progress of one row: one for the census, and one for the search for each outcome.
inline constexpr std::size_t edge_units = 1 + searched_outcomes.size();

/// Counts for each row, and searches for each row and outcome separately; the results have one element for each row of
/// the share. The result depends only on the file and its scene, not on the number of threads.
///
/// A batch has 512 rays, aimed from 16 eyes at a point of an edge each; one point in four is an end of the edge. Of an
/// eye's 32 rays, all but the first have the components of their directions moved by up to `ulps` places of the format.
/// Eyes are drawn from all distances up to the nearest found, each octave as often as another. Once there is a nearest
/// ray, every other eye is its eye, moved to between its distance and a sixteenth of it. The eyes of the census are all
/// drawn anew from the whole range, the same for each row.
///
/// A ray counts if it truly meets first a face of the edge or vertex that it is aimed at. For double hits, no other
/// face that the form claims may truly be at the same t: rounding has no part in such a tie. A ray is tested again
/// alone before it is kept.
std::vector<EdgeFinding> find_nearest(const EdgeRequest& request);

}  // namespace lostbits::measure::edges
