// Ranges of a form's inputs over the rays of a scene or of a step of a sweep, the form's error bound over them, and the
// errors of rays to compare it with.
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

/// Errors that rays show: |t^ − t| of hits with and without rounding, in units of t.
struct ObservedErrors {
    std::uint64_t hits = 0, bounded_hits = 0;  ///< pairs of a ray and a primitive; those of them in boxes with a bound
    double error = 0;                          ///< largest error in a box with a bound
    double share = 0;                ///< largest ratio of an error to the bound of its box; above 1, a bound is wrong
    std::uint64_t running_hits = 0;  ///< hits in a box with a bound for which `Bounded` has a running bound too
    double running = 0;              ///< largest running bound of these
    std::uint64_t wider = 0;         ///< rays whose running bound is larger than the bound of their box

    void append(const ObservedErrors& after);
};

/// Form, format and parts whose bounds are checked; `like` is the primitive of the ranges.
struct BoundQuery {
    const intersect::table::Intersector& form;
    const Format& format;
    const Subdivided& parts;
    const Primitive<double>& like;
    const intersect::process::StopToken& stop;
};

/// Errors of these inputs, all of which lie in the ranges.
ObservedErrors observe(const BoundQuery& query, const std::vector<std::vector<double>>& rays);

/// Draws inputs in the `boxes` boxes with the largest bounds, `each` in each. Each number is one of the format.
std::vector<std::vector<double>> draw_inputs(const BoundQuery& query, std::size_t boxes, int each);

/// Range that replaces the scene's for the input of this name (`intersect::table::input_names`).
struct GivenRange {
    std::string name;
    InputRange range;
};

/// Rays of a step of a sweep. For a ray distribution these are the ones that it draws; others of its kind may lie
/// outside of their ranges.
struct StepRays {
    std::string id;  ///< id of the sweep
    std::vector<scene::rays::RayGroup> groups;
};

struct RangesRequest {
    std::variant<scene::file::Scene, StepRays> rays = {};  ///< of a scene, or of a step
    const intersect::table::Intersector* form = nullptr;
    Format format = {};
    std::vector<GivenRange> given_ranges = {};
    std::size_t boxes = 4096;  ///< total for all primitives
    truth::TruthLimit limit = {};

    [[nodiscard]] bool is_of_step() const { return std::holds_alternative<StepRays>(rays); }
    [[nodiscard]] const std::string& id() const {
        return std::visit([](const auto& subject) -> const std::string& { return subject.id; }, rays);
    }
};

/// Bound on the rounding errors of hits over a share of the ranges: no error in that share is above it, in units of t
/// and in ulps of t. The share is of the volume in which there may be hits.
struct Quantile {
    double share, error, ulps;
};

struct RangesBound {
    Tape tape = {};
    std::vector<std::string> names = {};  ///< of the inputs
    std::vector<InputBox> ranges;         ///< one box for each primitive
    double missed = 0;                    ///< share of the ranges in which there is no hit
    double unknown = 0;                   ///< share in which the bound is unknown
    double undecided = 0;                 ///< share with a bound in which hit or miss is not settled
    std::size_t boxes = 0;
    double largest = 0, largest_ulps = 0;  ///< over the boxes with a bound
    std::vector<Quantile> quantiles;       ///< for 50, 90 and 99 % of what is not missed; infinite where unknown
    std::vector<double> shares;   ///< contributions by node, in ulps, in the box with the largest bound in ulps
    ObservedErrors given, drawn;  ///< errors of the given rays, and of rays drawn where bounds are largest
    std::size_t rays = 0;         ///< of the scene or the step
};

/// Bounds the errors of each primitive of the scene separately. The box of inputs is the bounding box of all rays as
/// the form receives them; for a step, it joins the groups, each of which has primitives of its own. Throws InputError
/// for a form whose operations differ from ray to ray (`tape::tape_of`), for more than 64 primitives, and for a name
/// that no input has.
RangesBound bound_over_ranges(const RangesRequest& request);

}  // namespace lostbits::measure::apriori
