// Ranges of a form's inputs over the rays of a scene or of a step of a sweep, the form's error bound over these ranges,
// and the errors of rays for comparison with the bound.
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

/// Observed errors of rays: |t^ − t| of hits with and without rounding, in units of t.
struct ObservedErrors {
    /// Number of pairs of a ray and a primitive that hit; `bounded_hit_count` are those in boxes with a bound.
    std::uint64_t hit_count = 0, bounded_hit_count = 0;
    double largest_error = 0;             ///< of the bounded hits
    double largest_ratio = 0;             ///< of an error to the bound of its box; if it is above 1, a bound is wrong
    std::uint64_t running_hit_count = 0;  ///< number of bounded hits for which `Bounded` has a running bound too
    double largest_running_bound = 0;     ///< of the running hits
    /// Number of running bounds that are larger than the bound of their box.
    std::uint64_t larger_running_bound_count = 0;

    void append(const ObservedErrors& other);
};

/// The form, the format and the boxes whose bounds are checked, for one primitive of the scene.
struct BoundQuery {
    const intersect::table::Intersector& form;
    const Format& format;
    const BoxSubdivision& boxes;
    const Primitive<double>& primitive;
    const intersect::process::StopToken& stop;
};

/// Observes the errors of rays with these inputs, all of which lie in the ranges.
ObservedErrors observe_errors(const BoundQuery& query, const std::vector<std::vector<double>>& rays);

/// Draws inputs in the `box_count` boxes with the largest bounds, `rays_per_box` in each box. Each number is a number
/// of the format.
std::vector<std::vector<double>> draw_inputs(const BoundQuery& query, std::size_t box_count, int rays_per_box);

/// A range that replaces the scene's for the input of this name (`intersect::table::input_names`).
struct GivenRange {
    std::string name;
    InputRange range;
};

/// The rays of a step of a sweep. For a ray distribution these are the rays that it draws; other rays of the
/// distribution may lie outside the ranges of these.
struct StepRays {
    std::string id;  ///< id of the sweep
    std::vector<scene::rays::RayGroup> groups;
};

struct RangesRequest {
    std::variant<scene::file::Scene, StepRays> rays = {};  ///< the rays of a scene, or of a step
    const intersect::table::Intersector* form = nullptr;
    Format format = {};
    std::vector<GivenRange> given_ranges = {};
    std::size_t max_box_count = 4096;  ///< for all primitives together
    truth::ProofLimit limit = {};

    [[nodiscard]] bool is_step() const { return std::holds_alternative<StepRays>(rays); }
    [[nodiscard]] const std::string& id() const {
        return std::visit([](const auto& subject) -> const std::string& { return subject.id; }, rays);
    }
};

/// Bound on the rounding errors of hits over a fraction of the ranges: no error in that part is above the bound, in
/// units of t and in ulps of t. The fraction is relative to the volume in which hits are possible.
struct Quantile {
    double fraction, error, ulps;
};

struct RangesBound {
    Tape tape = {};
    std::vector<std::string> names = {};  ///< names of the inputs
    std::vector<InputBox> ranges;         ///< one box for each primitive
    double missed_fraction = 0;           ///< fraction of the ranges that no ray hits in
    double unknown_fraction = 0;          ///< fraction of the ranges in which the bound is unknown
    double undecided_fraction = 0;        ///< fraction of the ranges with a bound in which the decision is not proved
    std::size_t box_count = 0;
    double largest = 0, largest_ulps = 0;  ///< largest bound over the boxes with a bound, in units of t and in ulps
    /// Quantiles for 50, 90 and 99 % of the ranges in which hits are possible; infinite if the bound is unknown.
    std::vector<Quantile> quantiles;
    /// Contribution of each node, in ulps, in the box with the largest bound in ulps.
    std::vector<double> node_contributions;
    ObservedErrors errors_of_given_rays;
    ObservedErrors errors_of_drawn_rays;  ///< of rays drawn where the bounds are largest
    std::size_t ray_count = 0;            ///< number of rays of the scene or the step
};

/// Bounds the errors of each primitive of the scene separately. The box of inputs is the bounding box of all rays as
/// the form receives them; for a step, it encloses the rays of all groups, each of which has its own primitives. Throws
/// InputError for a form whose operations differ from ray to ray (`tape::record_tape`), for more than 64 primitives,
/// and for a name that no input has.
RangesBound bound_over_ranges(const RangesRequest& request);

}  // namespace lostbits::measure::apriori
