// The ranges of a form's inputs over the rays of a scene, its bound over them, and what rays show of it.
#pragma once

#include <string>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/apriori/seen.hpp"
#include "measure/truth/truth.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::measure::apriori {

/// A range in the place of the scene's, of the input of that name (`intersect::table::input_names`).
struct GivenRange {
    std::string name;
    Between range;
};

struct RangesRequest {
    const scene::file::Scene* scene = nullptr;
    const intersect::table::Intersector* form = nullptr;
    Format format = {};
    std::vector<GivenRange> asked = {};
    std::size_t boxes = 4096;  ///< over all solids
    truth::TruthLimit limit = {};
};

/// Of a share of the ranges in which there may be hits, by volume: no rounding error of a hit is above it, in units of
/// t, and in ulps of t.
struct Quantile {
    double share, error, ulps;
};

struct RangesBound {
    Tape tape = {};
    std::vector<std::string> names = {};  ///< of its inputs
    std::vector<InputBox> ranges;         ///< of each solid
    double missed = 0;                    ///< share of the ranges in which there is no hit
    double unknown = 0;                   ///< share in which nothing is known: not settled
    double undecided = 0;                 ///< share with a bound in which hit or miss is not settled
    std::size_t boxes = 0;
    double largest = 0, largest_ulps = 0;  ///< of the boxes with a bound
    std::vector<Quantile> quantiles;       ///< of 50, 90 and 99 % of what is not missed; infinite where unknown
    std::vector<double> shares;            ///< of each node, in ulps, in the box with the largest bound in ulps
    SeenErrors scene, drawn;  ///< by the rays of the scene, and by rays drawn in the boxes with the largest bounds
};

/// Every solid by itself, over the hull of all rays of the scene as the form is given them.
/// InputError for a form whose operations differ from ray to ray (`tape::tape_of`), for more than 64 solids, and for a
/// name that no input has.
RangesBound bound_over_ranges(const RangesRequest& request);

}  // namespace lostbits::measure::apriori
