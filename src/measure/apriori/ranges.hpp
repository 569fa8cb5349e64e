// The ranges of a form's inputs over the rays of a scene or of a step of a sweep, its bound over them, and what rays
// show of it.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "intersect/table/table.hpp"
#include "measure/apriori/tape_bound.hpp"
#include "measure/truth/truth.hpp"
#include "scene/file/scene.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::apriori {

/// Errors are |t^ − t| of hits with and without rounding, in units of t.
struct SeenErrors {
    std::uint64_t hits = 0, bounded_hits = 0;  ///< pairs of a ray and a solid; of these, in boxes with a bound
    double error = 0;                          ///< the largest in a box with a bound
    double share = 0;                ///< the largest error over the bound of its box: at most 1, or some bound is wrong
    std::uint64_t running_hits = 0;  ///< in a box with a bound, where `Bounded` has a bound, too
    double running = 0;              ///< the largest of those
    std::uint64_t wider = 0;         ///< rays whose running bound is above that of their box

    void append(const SeenErrors& after);
};

/// What a form is asked: `like` is the solid of the ranges.
struct Asking {
    const intersect::table::Intersector& form;
    const Format& format;
    const Subdivided& parts;
    const Solid<double>& like;
    const intersect::process::StopToken& stop;
};

/// Of these inputs, all of them in the ranges.
SeenErrors see(const Asking& asking, const std::vector<std::vector<double>>& rays);

/// Inputs drawn in the boxes with the largest bounds, each a number of the format: `each` in each of so many boxes.
std::vector<std::vector<double>> drawn(const Asking& asking, std::size_t boxes, int each);

/// A range in the place of the scene's, of the input of that name (`intersect::table::input_names`).
struct GivenRange {
    std::string name;
    Between range;
};

/// The rays of a step of a sweep. Of a family these are the ones that it draws: others of its kind may lie beyond them.
struct StepRays {
    std::string id;  ///< of the sweep
    std::vector<scene::rays::RayGroup> groups;
};

struct RangesRequest {
    std::variant<scene::file::Scene, StepRays> rays = {};  ///< those of a scene, or of a step
    const intersect::table::Intersector* form = nullptr;
    Format format = {};
    std::vector<GivenRange> asked = {};
    std::size_t boxes = 4096;  ///< over all solids
    truth::TruthLimit limit = {};

    [[nodiscard]] bool is_of_step() const { return std::holds_alternative<StepRays>(rays); }
    [[nodiscard]] const std::string& id() const {
        return std::visit([](const auto& of) -> const std::string& { return of.id; }, rays);
    }
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
    SeenErrors given, drawn;  ///< by the rays of the scene or the step, and by rays drawn where bounds are largest
    std::size_t rays = 0;     ///< of the scene or the step
};

/// Every solid of the scene by itself, over the hull of all rays as the form is given them; the groups of a step, of
/// which each has solids of its own, in one.
/// InputError for a form whose operations differ from ray to ray (`tape::tape_of`), for more than 64 solids, and for a
/// name that no input has.
RangesBound bound_over_ranges(const RangesRequest& request);

}  // namespace lostbits::measure::apriori
