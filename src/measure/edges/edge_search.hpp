// Aims seeded random rays at the edges and vertices of a mesh. Counts the rays that a form lets through or hits twice,
// and searches for the smallest distance from which such a ray exists.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/shard/share.hpp"
#include "scene/sweep/search_file.hpp"

namespace lostbits::measure::edges {

/// Outcomes that are searched for, one at a time.
inline constexpr std::array searched_outcomes{answer::Outcome::crack, answer::Outcome::double_hit};

/// Nearest ray that was found to have an outcome.
struct NearestRay {
    double distance = 0;                   ///< from the eye to the point aimed at, in lengths of the edge
    Ray<double> ray{};                     ///< in numbers of binary32, or of the format if that is narrower
    std::array<std::uint32_t, 2> faces{};  ///< faces that share the edge aimed at, or an edge of the vertex aimed at
    double t = 0;                          ///< the form's answer; NaN for a miss
    double true_t = 0;                     ///< t*, correctly rounded to binary64
};

/// Targets of the rays of a census.
enum class EdgeTarget : std::uint8_t { edge, vertex };
inline constexpr std::array<std::string_view, 2> edge_target_names{"edge", "vertex"};

/// Number of rays of a census at one kind of target, and the number with each outcome of `searched_outcomes`.
struct EdgeCounts {
    std::uint64_t ray_count = 0;
    std::array<std::uint64_t, searched_outcomes.size()> outcome_counts{};
};

/// Results of a search for one tested form, in the order of `searched_outcomes`.
struct EdgeResults {
    std::array<EdgeCounts, edge_target_names.size()> census{};  ///< by target
    std::array<std::optional<NearestRay>, searched_outcomes.size()> nearest;
    /// Number of rays tested. The search stops early when it finds a ray at the smallest distance of its range.
    std::array<std::uint64_t, searched_outcomes.size()> searched_ray_counts{};
};

struct EdgeRequest {
    scene::sweep::EdgeSearchFile search;
    std::vector<evaluate::TestedForm> tested_forms;  ///< with forms for triangles
    truth::ProofLimit limit{};
    shard::Share share = {};   ///< share of the tested forms
    bool census_only = false;  ///< runs the census, but does not search for the nearest ray
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Units of progress of one tested form: one for the census, and one for the search for each outcome.
inline constexpr std::size_t progress_units_per_form = 1 + searched_outcomes.size();

/// Runs the census of each tested form of the share, and searches separately for each of its outcomes. The result has
/// one element for each of them. It depends only on the file and its scene, not on the number of threads.
///
/// A batch has 16 eyes with 32 rays each. An eye aims at one point of an edge; one point in four is an end of the edge.
/// Its first ray has the direction to that point. In its other rays, each component of that direction is moved by up to
/// `ulps` numbers of the format.
///
/// The search draws the distance of an eye from the smallest distance of the file up to the distance of the nearest ray
/// found so far; every octave is equally likely. Once it has found a ray, it draws half of the eyes close to that ray's
/// eye, at 1/16 to 1 times its distance. The census draws each eye independently and over all distances of the file;
/// every tested form gets the same eyes.
///
/// A ray counts if the first face that it truly meets contains the edge or vertex that it is aimed at. If another face
/// that the form claims is truly at the same t, this is a tie and not a double hit: rounding did not cause it.
/// A ray is tested again by itself before the search accepts it.
std::vector<EdgeResults> search_edges(const EdgeRequest& request);

}  // namespace lostbits::measure::edges
