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
    double distance = 0;  ///< from the eye to the point of the edge that it is aimed at, in lengths of the edge
    Ray<double> ray{};    ///< numbers of binary32, and of the format where that is narrower
    std::array<std::uint32_t, 2> faces{};  ///< that share the edge
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

/// For each row and outcome by itself: litters of 512 rays, aimed from 16 eyes at a point of an edge each. Of an eye's
/// 32 rays all but the first have the components of their directions moved by up to `ulps` places of the format. Eyes
/// are drawn between the nearest distance found and a sixteenth of it, every other one by moving that of the nearest
/// ray. A ray counts where it truly meets one of the edge's two faces first and, of double hits, no other face that the
/// form claims at the same t, where rounding has no part in it. It is asked again by itself before it is kept. One a
/// row of the share. The result depends on the file and its scene alone, not on the number of threads.
std::vector<EdgeFinding> find_nearest(const EdgeRequest& request);

}  // namespace lostbits::measure::edges
