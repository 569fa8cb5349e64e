// From how near a form lets a ray through an edge of a mesh, or counts it twice: by seeded search.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "scene/sweep/search_file.hpp"

namespace lostbits::measure::edges {

/// What is searched for, each by itself.
inline constexpr std::array sought{answer::Outcome::crack, answer::Outcome::double_hit};

/// The nearest ray of an outcome.
struct NearestRay {
    double distance = 0;  ///< from the eye to the point of an edge that it is aimed at, in lengths of that edge
    Ray<double> ray{};    ///< numbers of binary32, and of the format where that is narrower
    std::array<std::uint32_t, 2> faces{};  ///< that share the edge, or an edge from the vertex that it is aimed at
    double t = 0;                          ///< the form's answer; NaN for a miss
    double truth = 0;                      ///< t*, correctly rounded to binary64
};

/// What a search came to, for one row: by the places of `sought`.
struct EdgeFinding {
    std::array<std::optional<NearestRay>, sought.size()> nearest;
    /// Rays tried: all, or those until one was found as near as the search goes.
    std::array<std::uint64_t, sought.size()> rays{};
};

struct EdgeRequest {
    scene::sweep::EdgeSearchFile search;
    std::vector<evaluate::TestedForm> rows;  ///< of forms for triangles
    truth::TruthLimit limit{};
    shard::Share share = {};  ///< of the rows
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// For each row and outcome by itself: litters of 512 rays, aimed from 16 eyes at a point of an edge each, one in four
/// at an end of the edge. Of an eye's 32 rays all but the first have the components of their directions moved by up to
/// `ulps` places of the format. Eyes are drawn from all distances up to the nearest found, each octave as often as
/// another; every other eye, once there is a nearest ray, by moving its eye to between its distance and a sixteenth. A
/// ray counts where it truly meets first a face of what it is aimed at and, of double hits, no other face that the
/// form claims at the same t, where rounding has no part in it. It is asked again by itself before it is kept. One a
/// row of the share. The result depends on the file and its scene alone, not on the number of threads.
std::vector<EdgeFinding> find_nearest(const EdgeRequest& request);

}  // namespace lostbits::measure::edges
