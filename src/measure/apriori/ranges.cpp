#include "measure/apriori/ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "intersect/process/parallel.hpp"
#include "intersect/table/recording.hpp"
#include "measure/answer/without_rounding.hpp"
#include "measure/tape/tape_form.hpp"
#include "measure/truth/band.hpp"
#include "number/rounded.hpp"
#include "scene/rays/random.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::apriori {

namespace {

ObservedErrors observe_ray(const BoundQuery& query, const std::vector<double>& inputs) {
    const SubBox& part = query.boxes.part_of(inputs);
    const Ray<double> ray = tape::ray_of(inputs);
    const Primitive<double> primitive = tape::primitive_of(inputs, query.primitive);
    Tape tape;
    query.form.record(query.format, ray, intersect::Target<double>(primitive), inputs.back(), tape);
    if (tape[tape.outputs.hit].value == 0) return {};

    const auto exact = answer::evaluate_exactly(query.form, ray, intersect::Target<double>(primitive));
    if (!exact) return {};

    // Compares the error of the hit with the bound of its box.
    ObservedErrors observed{.hit_count = 1};
    if (part.bound.misses) observed.largest_ratio = HUGE_VAL;  // the bound says that there is no hit
    if (!(part.bound.error < HUGE_VAL)) return observed;
    observed.bounded_hit_count = 1;
    observed.largest_error =
        std::fabs(truth::scaled_difference(truth::as_certified(tape[tape.outputs.t].value), *exact, 0));
    observed.largest_ratio = observed.largest_error == 0 ? 0 : observed.largest_error / part.bound.error;

    // Compares the bound that the form itself computes, if it does.
    if (!query.form.bounded) return observed;
    const auto running_bound =
        query.form.bounded(query.format, ray, intersect::Target<double>(primitive), inputs.back());
    if (!running_bound || !(running_bound->error < HUGE_VAL)) return observed;
    observed.running_hit_count = 1;
    observed.largest_running_bound = running_bound->error;
    observed.larger_running_bound_count = running_bound->error > part.bound.error ? 1 : 0;
    return observed;
}

constexpr std::size_t max_primitives = 64;
/// Numbers of rays that check the bounds: `drawn_rays_per_box` rays in each of `drawn_box_count` boxes.
constexpr std::size_t drawn_box_count = 64;
constexpr int drawn_rays_per_box = 64;

/// The rays and primitives of a request, as the form receives them.
class GivenRays {
public:
    explicit GivenRays(const RangesRequest& request) : info_(*request.form->info) {
        if (const auto* const step = std::get_if<StepRays>(&request.rays))
            for (const scene::rays::RayGroup& group : step->groups) bands_.emplace_back(group, request.limit);
        else if (const auto* const scene = std::get_if<scene::file::Scene>(&request.rays))
            bands_.emplace_back(*scene, 0, scene->height, request.limit);
        for (const truth::Band& band : bands_) inputs_.push_back(band.inputs_for(request.format, info_));
    }
    [[nodiscard]] std::size_t primitive_count() const { return inputs_.front().primitives.size(); }
    [[nodiscard]] Primitive<double> primitive(std::size_t s) const { return inputs_.front().primitives[s]; }
    /// Inputs of all rays, each with the primitive of this index in its group.
    [[nodiscard]] std::vector<std::vector<double>> inputs_of_rays(std::size_t primitive) const {
        std::vector<std::vector<double>> result;
        for (std::size_t b = 0; b < bands_.size(); ++b) {
            const auto& rays = inputs_[b].rays_for(info_);
            for (std::size_t i = 0; i < bands_[b].pixel_count(); ++i)
                result.push_back(tape::inputs_of(rays[i], inputs_[b].primitives[primitive], bands_[b].range(i).tmax));
        }
        return result;
    }

private:
    const intersect::Info& info_;
    std::deque<truth::Band> bands_;
    std::deque<truth::FormatInputs> inputs_;
};

InputBox input_box_of(const std::vector<std::vector<double>>& rays) {
    InputBox box;
    for (const double x : rays.front()) box.push_back({x, x});
    for (const auto& ray : rays) {
        for (std::size_t k = 0; k < box.size(); ++k) {
            box[k].low = std::fmin(box[k].low, ray[k]);
            box[k].high = std::fmax(box[k].high, ray[k]);
        }
    }
    return box;
}

void apply_given_ranges(InputBox& box, const RangesRequest& request, const std::vector<std::string>& names) {
    for (const GivenRange& given_range : request.given_ranges) {
        const auto found = std::ranges::find(names, given_range.name);
        if (found == names.end())
            throw InputError(fmt::format("--input-range {}: {} has no input of that name; {}", given_range.name,
                                         request.form->info->name, text::did_you_mean(given_range.name, names)));
        box[found - names.begin()] = {rounding::to_format(given_range.range.low, 0, request.format.parameters),
                                      rounding::to_format(given_range.range.high, 0, request.format.parameters)};
    }
}

bool contains(const InputBox& box, const std::vector<double>& ray) {
    for (std::size_t k = 0; k < box.size(); ++k)
        if (ray[k] < box[k].low || ray[k] > box[k].high) return false;
    return true;
}

/// Error bound in ulps of the smallest |t| of a box.
double ulps_of(const BoxBound& bound, const FloatFormat& format) {
    if (!(bound.error < HUGE_VAL)) return HUGE_VAL;
    const long exponent = bound.min_t > 0 ? std::ilogb(bound.min_t) : format.emin;
    return std::ldexp(bound.error, -static_cast<int>(ulp_exponent(format, exponent)));
}

/// Smallest x such that the numbers up to x have at least this fraction of the total weight.
double quantile(std::vector<std::pair<double, double>>& weighted, double fraction) {
    std::ranges::sort(weighted);
    double total_weight = 0, weight_so_far = 0;
    for (const auto& [x, weight] : weighted) total_weight += weight;
    for (const auto& [x, weight] : weighted)
        if ((weight_so_far += weight) >= fraction * total_weight) return x;
    return HUGE_VAL;
}

void summarise(RangesBound& result, const std::vector<std::pair<const SubBox*, double>>& leaves, const TapeBound& bound,
               const FloatFormat& format) {
    std::vector<std::pair<double, double>> errors, ulps;
    const SubBox* worst = nullptr;
    for (const auto& [part, fraction] : leaves) {
        const BoxBound& box_bound = part->bound;
        if (box_bound.misses) {
            result.missed_fraction += fraction;
            continue;
        }

        const double in_ulps = ulps_of(box_bound, format);
        errors.emplace_back(box_bound.error, fraction);
        ulps.emplace_back(in_ulps, fraction);
        if (!(box_bound.error < HUGE_VAL)) {
            result.unknown_fraction += fraction;
            continue;
        }

        if (!box_bound.decides) result.undecided_fraction += fraction;
        result.largest = std::fmax(result.largest, box_bound.error);
        if (!worst || in_ulps > result.largest_ulps) worst = part;
        result.largest_ulps = std::fmax(result.largest_ulps, in_ulps);
    }

    result.box_count = leaves.size();
    for (const double fraction_of_ranges : {0.5, 0.9, 0.99})
        result.quantiles.push_back(
            {fraction_of_ranges, quantile(errors, fraction_of_ranges), quantile(ulps, fraction_of_ranges)});

    // Shows which operations the bound of the worst box comes from.
    if (!worst) return;
    for (const double contribution : bound.node_contributions(worst->box))
        result.node_contributions.push_back(ulps_of({.error = contribution, .min_t = worst->bound.min_t}, format));
}

}  // namespace

void ObservedErrors::append(const ObservedErrors& other) {
    hit_count += other.hit_count;
    bounded_hit_count += other.bounded_hit_count;
    largest_error = std::fmax(largest_error, other.largest_error);
    largest_ratio = std::fmax(largest_ratio, other.largest_ratio);
    running_hit_count += other.running_hit_count;
    largest_running_bound = std::fmax(largest_running_bound, other.largest_running_bound);
    larger_running_bound_count += other.larger_running_bound_count;
}

ObservedErrors observe_errors(const BoundQuery& query, const std::vector<std::vector<double>>& rays) {
    std::vector<ObservedErrors> errors(rays.size());
    intersect::process::in_parallel(std::size_t{0}, rays.size(), [&](std::size_t i) {
        query.stop.check();
        errors[i] = observe_ray(query, rays[i]);
    });
    ObservedErrors result;
    for (const ObservedErrors& observed : errors) result.append(observed);
    return result;
}

std::vector<std::vector<double>> draw_inputs(const BoundQuery& query, std::size_t box_count, int rays_per_box) {
    auto leaves = query.boxes.leaves();
    std::erase_if(leaves, [](const SubBox* p) { return p->bound.misses || !(p->bound.error < HUGE_VAL); });
    std::ranges::stable_sort(leaves, [](const SubBox* p, const SubBox* q) { return p->bound.error > q->bound.error; });
    if (leaves.size() > box_count) leaves.resize(box_count);
    scene::rays::Random random(1);
    std::vector<std::vector<double>> result;
    for (const SubBox* const part : leaves) {
        for (int k = 0; k < rays_per_box; ++k) {
            std::vector<double> inputs;
            for (const auto& [low, high] : part->box) {
                // Rounding may lead out of the box, but not out of the ranges, because their ends are numbers of the
                // format.
                const double x = low == high ? low : random.between(low, high);
                inputs.push_back(rounding::to_format(x, 0, query.format.parameters));
            }
            result.push_back(std::move(inputs));
        }
    }
    return result;
}

RangesBound bound_over_ranges(const RangesRequest& request) {
    const GivenRays given(request);
    const std::size_t primitive_count = given.primitive_count();
    if (primitive_count > max_primitives)
        throw InputError(
            fmt::format("{}: it has {} primitives. Bounds over ranges are computed for each primitive separately, "
                        "for at most {} of them; write the primitives that you need into a scene of their own",
                        request.id(), primitive_count, max_primitives));

    // The operations of the form, which are the same for all primitives.
    const Primitive<double> first = given.primitive(0);
    RangesBound result;
    result.tape = tape::record_tape(*request.form, request.format, first.transform && first.transform->is_inverse);
    result.names = intersect::table::input_names(*request.form, intersect::Target<double>(first));
    const TapeBound bound(result.tape);

    std::deque<BoxSubdivision> divided;
    std::vector<std::pair<const SubBox*, double>> leaves;
    for (std::size_t s = 0; s < primitive_count; ++s) {
        const Primitive<double> primitive = given.primitive(s);
        auto rays = given.inputs_of_rays(s);
        result.ray_count = rays.size();
        result.ranges.push_back(input_box_of(rays));
        apply_given_ranges(result.ranges.back(), request, result.names);

        // Divides the ranges of the rays into boxes, each with a bound.
        divided.emplace_back(bound, result.ranges.back(),
                             std::max<std::size_t>(request.max_box_count / primitive_count, 1), request.limit.stop);
        for (const SubBox* const part : divided.back().leaves())
            leaves.emplace_back(part, part->volume_fraction / static_cast<double>(primitive_count));

        // Checks the bounds with the given rays in the ranges, and with drawn ones.
        std::erase_if(rays, [&](const std::vector<double>& ray) { return !contains(result.ranges.back(), ray); });
        const BoundQuery query{*request.form, request.format, divided.back(), primitive, request.limit.stop};
        result.errors_of_given_rays.append(observe_errors(query, rays));
        result.errors_of_drawn_rays.append(
            observe_errors(query, draw_inputs(query, drawn_box_count, drawn_rays_per_box)));
    }

    summarise(result, leaves, bound, request.format.parameters);
    return result;
}

}  // namespace lostbits::measure::apriori
