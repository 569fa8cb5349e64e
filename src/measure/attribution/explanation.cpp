#include "measure/attribution/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/external/contract.hpp"
#include "intersect/table/sets.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/answer/answers.hpp"
#include "measure/answer/owners.hpp"
#include "measure/attribution/culprits.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/range_on_tape.hpp"
#include "measure/tape/tape_form.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/reach.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::attribution {

using answer::OneRay;
using answer::Outcome;
using intersect::bounding_box::innermost_form;
using intersect::bounding_box::with_other_form;
using intersect::table::Intersector;
using truth::FormatInputs;
using truth::missing;

namespace {

/// Draws −1, 0 or 1 from the high bits of Knuth's MMIX generator, which are more random than its low bits. Every run
/// draws the same sequence.
class RandomMoves {
public:
    int next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<int>((state_ >> 33) % 3) - 1;
    }

private:
    std::uint64_t state_ = 1;
};

double move_by_ulps(double x, int ulps, const FloatFormat& format) {
    return x == 0 || !std::isfinite(x) ? x : x + ulps * ulp_at(x, format);
}

/// Result of a form with this answer. If the form answers only hit or miss, t does not count.
FormResult result_of_answer(const Intersector& form, const Format& format, const OneRay& ray, bool hit, double t) {
    const bool returns_t = form.info->roots != intersect::Roots::none;
    FormResult result{&form, answer::classify(ray.find_truth(*form.info).decision, hit, returns_t ? t : 0), t};
    if (result.outcome != Outcome::agree_hit || !returns_t) return result;
    result.ulps = truth::ulp_error(t, ray.true_t(*form.info), format.parameters);
    result.lost_bits = truth::lost_bits(result.ulps, format.parameters.precision);
    return result;
}

/// Result of the form's nearest answer over the primitives of the scene, as in a picture.
FormResult evaluate_form(const Intersector& form, const Format& format, const OneRay& ray) {
    const OneRay::Inputs in = ray.inputs(form, format);
    const answer::Answers answers = answer::evaluate(form, in.format_inputs);
    return result_of_answer(form, format, ray, answers.hit[in.index] != 0, answers.t[in.index]);
}

/// Rays near the explained one, on which forms are compared.
struct NearbyRays {
    std::span<const OneRay> rays;
    bool skips_misses = false;  ///< skips correct misses: they say nothing about t
};

/// Mean lost bits over the rays whose truth is known. A wrong decision loses all bits. If t does not count, a right
/// decision loses none.
double compute_mean_lost_bits(const Intersector& form, const Format& format, const NearbyRays& nearby_rays,
                              bool counts_t) {
    double sum = 0;
    int counted = 0;
    for (const OneRay& ray : nearby_rays.rays) {
        const FormResult result = evaluate_form(form, format, ray);
        if (result.outcome == Outcome::unresolved ||
            (nearby_rays.skips_misses && result.outcome == Outcome::agree_miss))
            continue;
        sum += !result.is_right()                          ? format.parameters.precision
               : !counts_t || std::isnan(result.lost_bits) ? 0
                                                           : result.lost_bits;
        ++counted;
    }
    return counted == 0 ? missing : sum / counted;
}

/// Primitives that the form hits and that the ray truly meets. For a march, all primitives, since its distance field
/// includes all.
std::vector<Primitive<double>> primitives_around(const Explanation& explanation, const OneRay::Inputs& in,
                                                 int true_primitive) {
    std::vector<Primitive<double>> primitives;
    for (std::size_t i = 0; i < in.format_inputs.primitives.size(); ++i) {
        const int index = static_cast<int>(i);
        if (!is_primitive(explanation.form->shape) || index == explanation.primitive_index || index == true_primitive)
            primitives.push_back(in.format_inputs.primitives[i]);
    }
    return primitives;
}

/// True if the true answers of two forms, each for its own ray, differ. If only one of the forms takes unit directions,
/// their t have different units, so only hit or miss is compared.
bool have_different_truths(const Intersector& a, const OneRay& ray_a, const Intersector& b, const OneRay& ray_b) {
    const truth::Truth truth_a = ray_a.find_truth(*a.info), truth_b = ray_b.find_truth(*b.info);
    if (truth_a.decision != truth_b.decision) return true;
    return truth_a.is_hit() && a.info->direction == b.info->direction &&
           ray_a.rounded_truth(*a.info, binary64) != ray_b.rounded_truth(*b.info, binary64);
}

/// The form to compare with the explained one: a form of the same shape. For a set, the same set with `other` for the
/// explained primitive, or another set of the same shapes. Null if `other` is neither.
const Intersector* substitute_form(const Intersector& explained, Shape shape, const Intersector& other) {
    if (!explained.is_set() && other.shape != explained.shape) return nullptr;
    if (!explained.is_set()) return &innermost_form(other) == &other ? &with_other_form(explained, other) : &other;
    if (other.is_set()) return other.shapes() == explained.shapes() ? &other : nullptr;
    if (other.shape != shape) return nullptr;
    std::vector<const Intersector*> parts(explained.parts.begin(), explained.parts.end());
    *std::ranges::find(parts, shape, &Intersector::shape) = &other;
    return intersect::table::refusal_of_set(parts).empty() ? &intersect::table::find_or_add_set(parts) : nullptr;
}

/// The same form with the ray generator of `explained`.
const Intersector* with_generator_of(const Intersector& explained, const Intersector* form) {
    const auto* const generator = scene::rays::generator_of(explained);
    return generator && form ? &scene::rays::with_generator(*generator, *form) : form;
}

/// Result of another form on a ray and, if it is right there, on the rays around it.
FormResult evaluate_other_form(const Explanation& explanation, const OneRay& ray, const Intersector& form,
                               const OneRay& form_ray, const NearbyRays& nearby_rays) {
    FormResult result = evaluate_form(form, explanation.format, form_ray);
    result.has_other_truth = have_different_truths(*explanation.form, ray, form, form_ray);
    const bool lost_all =
        result.outcome == Outcome::agree_hit && !(result.lost_bits < explanation.format.parameters.precision);
    // A form that answers only hit or miss loses no bits of t, but it is not better than a form with a right t.
    const bool answers_no_t = std::isnan(result.lost_bits) && !std::isnan(explanation.result.lost_bits);
    if (result.is_right() && !lost_all && !answers_no_t && !result.has_other_truth)
        result.mean_lost_nearby =
            compute_mean_lost_bits(form, explanation.format, nearby_rays, explanation.returns_t());
    return result;
}

void add_if_better(Explanation& explanation, const FormResult& result) {
    if (result.mean_lost_nearby < explanation.result.mean_lost_nearby) explanation.better_forms.push_back(result);
}

/// The forms that may be compared with the explained one: all forms, the same form with other transforms or behind
/// other boxes, and the sets that the user names.
std::vector<const Intersector*> collect_other_forms(const Explanation& explanation,
                                                    std::span<const Intersector* const> named_forms) {
    std::vector<const Intersector*> candidates;
    for (const Intersector& other : intersect::table::intersectors()) candidates.push_back(&other);
    if (const auto parts = intersect::transform::find_transformed_parts(*explanation.form); parts.method != nullptr)
        for (const auto& method : intersect::transform::transform_methods())
            candidates.push_back(&intersect::transform::transformed_form(method, *parts.form));
    if (const auto parts = intersect::bounding_box::find_boxed_parts(*explanation.form); parts.form != nullptr)
        for (const Intersector& box : intersect::table::intersectors(parts.box->shape))
            if (intersect::external::is_safe_to_run(box))
                candidates.push_back(&intersect::bounding_box::boxed_form(*parts.method, box, *parts.form));
    std::ranges::copy_if(named_forms, std::back_inserter(candidates), &Intersector::is_set);
    return candidates;
}

void compare_with_other_forms(Explanation& explanation, const OneRay& ray, const NearbyRays& nearby_rays,
                              std::span<const Intersector* const> named_forms) {
    explanation.result.mean_lost_nearby =
        compute_mean_lost_bits(*explanation.form, explanation.format, nearby_rays, explanation.returns_t());

    for (const Intersector* const other : collect_other_forms(explanation, named_forms)) {
        // The user learns which of the named forms cannot be compared; others are skipped.
        const bool is_named = std::ranges::find(named_forms, other) != named_forms.end();
        const Intersector* const candidate =
            with_generator_of(*explanation.form, substitute_form(*explanation.form, explanation.shape, *other));
        if (candidate == explanation.form) continue;
        if (candidate == nullptr || !candidate->exists_in(explanation.format)) {
            if (is_named) explanation.incomparable_forms.push_back(other);
            continue;
        }
        if (!intersect::external::is_safe_to_run(innermost_form(*other)) && !is_named) continue;

        try {
            const FormResult result = evaluate_other_form(explanation, ray, *candidate, ray, nearby_rays);
            add_if_better(explanation, result);
            if (is_named) explanation.compared_forms.push_back(result);
        } catch (const EnvironmentError& error) {
            explanation.failures.emplace_back(error.what());
        }
    }
}

std::vector<OneRay> make_pixels_around(const ScenePixel& pixel, const scene::file::Scene& scene,
                                       std::optional<intersect::Touching> touching) {
    std::vector<OneRay> rays = OneRay::make_pixels_around(scene, pixel.x, pixel.y, pixel.limit);
    for (OneRay& ray : rays) ray.set_touching(touching);
    return rays;
}

/// Pixels around the first one. If the ray hits, only the other hits count: they show the error that generating the ray
/// causes.
NearbyRays nearby_pixels(const Explanation& explanation, std::span<const OneRay> pixels) {
    return {pixels.subspan(1), explanation.truth == truth::Truth::Decision::hit};
}

/// Compares the form with itself on the same pixel, with every other ray generator. Skips a generator that cannot make
/// the ray.
void find_better_generators(Explanation& explanation, const OneRay& ray, const ScenePixel& pixel) {
    const Intersector& form = scene::rays::strip_generator(*explanation.form);
    if (form.is_set() || form.has_transform_method) return;
    for (const scene::camera::RayGenerator& generator : scene::camera::ray_generators()) {
        if (&generator == pixel.scene->camera.ray_generator) continue;
        try {
            const scene::file::Scene scene = with_ray_generator(*pixel.scene, generator);
            const auto rays = make_pixels_around(pixel, scene, ray.touching());
            const FormResult result =
                evaluate_other_form(explanation, ray, scene::rays::with_generator(generator, form), rays.front(),
                                    nearby_pixels(explanation, rays));
            add_if_better(explanation, result);
        } catch (const InputError&) {}
    }
}

/// Evaluates the form on the primitive that the ray truly meets; called when the form answers another primitive.
std::optional<TruePrimitive> answer_at_true_primitive(const Intersector& form, const Format& format,
                                                      const OneRay::Inputs& in,
                                                      const std::optional<scene::rays::RecordedRay>& recorded_ray,
                                                      int true_primitive) {
    TruePrimitive result{.index = true_primitive,
                         .ray_and_primitive = scene::rays::make_group(in.format_inputs.rays[in.index])};
    const auto index = static_cast<std::size_t>(true_primitive);
    result.ray_and_primitive.primitives = {in.format_inputs.primitives[index]};
    result.ray_and_primitive.rays.push_range(in.format_inputs.rays, in.index);

    const Range<double> range = in.format_inputs.rays_for(*form.info).range(in.index);
    const FormatInputs::OwnedTarget aim = in.format_inputs.target_for(form, index);
    const intersect::Target<double> target = aim;

    // Records and attributes the form on this primitive, as it is done for the one that the form hits.
    Tape tape;
    form.record(format, in.ray(*form.info), target, range.tmax, tape);
    std::vector<std::string> names =
        names_of_inputs(form, target, recorded_ray && recorded_ray->try_prepend_to(tape) ? &*recorded_ray : nullptr);
    append_range_checks(tape, names, form.form_for(target.primitives.front().shape), format, range);
    const Attribution tape_attribution = attribute(tape);

    result.hit = tape[tape.outputs.hit].value != 0;
    result.t = tape[tape.outputs.t].value;
    result.is_exact_hit = tape_attribution.is_exact_hit;
    result.exact_t = tape_attribution[tape.outputs.t].exact;
    return result;
}

/// The true t of the ray under another range; nothing if it misses.
std::optional<double> find_true_t_in_range(const Range<double>& range, const OneRay& ray, const OneRay::Inputs& in,
                                           const intersect::Info& info) {
    scene::rays::RayGroup group = scene::rays::make_group(in.format_inputs.rays[in.index]);
    group.rays.tmin = {range.tmin};
    group.rays.tmax = {range.tmax};
    group.rays.open_ends = range.open_ends;
    for (std::size_t i = 0; i < in.format_inputs.primitives.size(); ++i)
        group.primitives.push_back(in.format_inputs.primitives[i]);
    group.march = in.format_inputs.march;
    OneRay ray_with_range(std::move(group));
    ray_with_range.set_touching(ray.touching());
    if (!ray_with_range.find_truth(info).is_hit()) return {};
    return ray_with_range.rounded_truth(info, binary64);
}

/// Finds the hits that the range of a ray excludes, if the ray truly misses.
void find_hits_out_of_range(Explanation& explanation, const OneRay& ray, const OneRay::Inputs& in) {
    const Range<double> range = in.format_inputs.rays.range(in.index);
    if (range.is_whole() || !range.holds_any()) return;
    const intersect::Info& info = *explanation.form->info;
    explanation.t_beyond_tmax =
        find_true_t_in_range({range.tmin, HUGE_VAL, {.tmin = range.open_ends.tmin}}, ray, in, info);
    explanation.t_before_tmin = find_true_t_in_range({0, range.tmax, {.tmax = range.open_ends.tmax}}, ray, in, info);
}

/// True for equal numbers and for two NaN.
bool is_same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

std::vector<answer::OneRay> make_neighbours(const answer::OneRay& ray, const answer::OneRay::Inputs& in,
                                            const FloatFormat& format,
                                            const std::vector<Primitive<double>>& primitives) {
    std::vector<answer::OneRay> rays;
    RandomMoves moves;
    const Ray<double> original = in.format_inputs.rays[in.index];
    for (int k = 0; k < neighbour_count; ++k) {
        Ray<double> neighbour = original;
        for (Vec<double>* const v : {&neighbour.origin, &neighbour.direction}) {
            for (double* const number : {&v->x, &v->y, &v->z}) *number = move_by_ulps(*number, moves.next(), format);
        }
        scene::rays::RayGroup group = scene::rays::make_group(neighbour);
        group.rays.push_range(in.format_inputs.rays, in.index);
        group.primitives = primitives;
        group.march = in.format_inputs.march;
        rays.emplace_back(std::move(group)).set_touching(ray.touching());
    }
    return rays;
}

double Explanation::ulp_of_subject() const {
    const NodeId s = attribution.subject;
    if (s == no_node) return missing;
    if (!is_decision(tape[s].op)) return ulp_at(attribution[s].exact, format.parameters);
    const auto side = [&](std::size_t k) { return std::fabs(attribution[tape[s].operands[k]].exact); };
    return ulp_at(std::max(side(0), side(1)), format.parameters);
}

NodeId Explanation::find_amplifier(NodeId from) const {
    if (from == no_node) return no_node;
    std::vector<bool> is_reached(tape.nodes.size());
    is_reached[from] = true;

    NodeId largest = no_node;
    int bits = 1;
    for (NodeId i = from + 1; i < tape.size(); ++i) {
        const OperationError& e = attribution[i];
        if (!e.is_live) continue;

        for (const NodeId operand : tape.operands_of(i)) {
            if (is_reached[operand]) is_reached[i] = true;
        }
        if (is_reached[i] && e.operands_have_error && e.cancelled_bits > bits) {
            largest = i;
            bits = e.cancelled_bits;
        }
    }
    return largest;
}

bool Explanation::rounding_changed_order() const {
    if (!missed_primitive || !missed_primitive->is_exact_hit) return false;
    return !attribution.is_exact_hit || missed_primitive->exact_t < attribution[tape.outputs.t].exact;
}

std::vector<NodeId> Explanation::find_changed_decisions() const {
    std::vector<NodeId> nodes;
    for (NodeId i = 0; i < tape.size(); ++i) {
        const OperationError& e = attribution[i];
        if (e.decision_changed && e.is_live && (is_decision(tape[i].op) || e.rounding != 0)) nodes.push_back(i);
    }
    return nodes;
}

namespace {

/// Explains a form of our own by the operations on its tape.
void explain_template(Explanation& explanation, const OneRay& ray, const OneRay::Inputs& in,
                      const intersect::Target<double>& target) {
    const Intersector& form = *explanation.form;
    const Format& format = explanation.format;
    Tape& tape = explanation.tape;

    // Records the form, with the operations that made the ray in front and the comparisons with its range behind.
    form.record(format, in.ray(*form.info), target, explanation.range.tmax, tape);
    const auto recorded_ray = ray.recorded_ray(format);
    explanation.is_generated_ray = recorded_ray.has_value();
    explanation.input_names =
        names_of_inputs(form, target, recorded_ray && recorded_ray->try_prepend_to(tape) ? &*recorded_ray : nullptr);
    append_range_checks(tape, explanation.input_names, form.form_for(explanation.shape), format, explanation.range);
    for (const TapeNode& node : tape.nodes) {
        if (node.op == TapeOp::input) explanation.input_values.push_back(node.value);
    }

    // Attributes the error to its operations.
    explanation.attribution = attribute(tape, {.full = true});
    if (explanation.attribution.culprit != no_node)
        explanation.culprit_alone = run_counterfactuals(tape, explanation.attribution.culprit);
    explanation.hit = tape[tape.outputs.hit].value != 0;
    explanation.result = result_of_answer(form, format, ray, explanation.hit, tape[tape.outputs.t].value);
}

/// Explains a form that has no tape: only by its inputs and its answer.
void explain_external(Explanation& explanation, const OneRay& ray, const OneRay::Inputs& in,
                      const intersect::Target<double>& target, const answer::Answers& answers) {
    const Intersector& form = *explanation.form;
    explanation.input_names = intersect::bounding_box::find_names_on_tape(form, target);
    explanation.input_values = tape::inputs_of(
        in.ray(*form.info), in.format_inputs.primitives[explanation.primitive_index], explanation.range.tmax);
    if (!explanation.range.is_whole()) {
        explanation.input_names.emplace_back("ray.tmin");
        explanation.input_values.push_back(explanation.range.tmin);
    }
    explanation.hit = answers.hit[in.index] != 0;
    explanation.result = result_of_answer(form, explanation.format, ray, explanation.hit, answers.t[in.index]);
}

/// Records the direction before it was normalised, if the form received another one.
void set_given_direction(Explanation& explanation, const OneRay::Inputs& in) {
    const Vec<double> given = in.format_inputs.rays[in.index].direction;
    const Vec<double> received = in.ray(*explanation.form->info).direction;
    if (!is_same_number(given.x, received.x) || !is_same_number(given.y, received.y) ||
        !is_same_number(given.z, received.z))
        explanation.given_direction = given;
}

/// Changes the result if the form hits another primitive than the ray truly meets, or if the outcome is one that only
/// meshes have.
void compare_primitives(Explanation& explanation, const OneRay& ray, const OneRay::Inputs& in,
                        const answer::Answers& answers, const truth::Truth& ray_truth) {
    const Intersector& form = *explanation.form;
    if (!explanation.returns_t() || !is_primitive(form.shape)) return;
    const bool hits_wrong_primitive =
        explanation.hit && ray_truth.is_hit() && !ray.meets_first(answers.primitive[in.index], *form.info);
    if (hits_wrong_primitive) {
        if (explanation.has_tape())
            explanation.missed_primitive = answer_at_true_primitive(
                form, explanation.format, in, ray.recorded_ray(explanation.format), ray_truth.primitive);

        // Distances between two primitives are not errors.
        explanation.result.outcome = answer::Outcome::wrong_primitive;
        explanation.result.ulps = explanation.result.lost_bits = missing;
    }

    const Outcome outcome = ray.outcome(in, answers, *form.info, explanation.result.outcome);
    if (outcome != explanation.result.outcome) explanation.mesh_outcome = outcome;
}

}  // namespace

Explanation explain_alone(const Intersector& form, const Format& format, const OneRay& ray) {
    const OneRay::Inputs in = ray.inputs(form, format);
    const answer::Answers answers = answer::evaluate(form, in.format_inputs);
    const truth::Truth ray_truth = ray.find_truth(*form.info);
    Explanation explanation{
        .form = &form, .format = format, .has_rounded_inputs = !ray.is_unrounded(in), .touching = ray.touching()};
    set_given_direction(explanation, in);

    // Explains one primitive: the one that the form hits or, for a miss, the one that the ray truly meets.
    explanation.primitive_count = static_cast<int>(in.format_inputs.primitives.size());
    const std::size_t primitive = answer::measured_primitive(
        in.format_inputs, in.index, answers.hit[in.index] != 0 ? answers.primitive[in.index] : ray_truth.primitive);
    explanation.primitive_index = static_cast<int>(primitive);
    explanation.shape = in.format_inputs.primitives[primitive].shape;
    const FormatInputs::OwnedTarget aim = in.format_inputs.target_for(form, primitive);
    const intersect::Target<double> target = aim;
    explanation.range = in.format_inputs.rays_for(*form.info).range(in.index);
    if (form.is_template()) explain_template(explanation, ray, in, target);
    else explain_external(explanation, ray, in, target, answers);

    // The truth, and how far the inputs determine it.
    explanation.truth = ray_truth.decision;
    explanation.condition = explanation.inherent_bits = missing;
    double reach = missing;
    if (ray_truth.is_hit()) {
        explanation.true_t = ray.rounded_truth(*form.info, binary64);
        explanation.condition = ray.condition(*form.info);
        reach = ray.reach(*form.info, format);
        explanation.inherent_bits = truth::inherent_bits(reach, ray.true_t(*form.info), format.parameters);
    }
    if (ray_truth.decision == truth::Truth::Decision::miss) find_hits_out_of_range(explanation, ray, in);

    compare_primitives(explanation, ray, in, answers, ray_truth);
    if (explanation.result.outcome == Outcome::agree_hit)
        explanation.excess_bits =
            truth::excess_bits(explanation.result.t, ray.true_t(*form.info), format.parameters, reach);
    return explanation;
}

Explanation explain(const Intersector& form, const Format& format, const OneRay& ray,
                    std::span<const Intersector* const> named_forms, const std::optional<ScenePixel>& pixel) {
    Explanation explanation = explain_alone(form, format, ray);
    if (!explanation.is_generated_ray || !pixel) {
        const OneRay::Inputs in = ray.inputs(form, format);
        const auto primitives = primitives_around(explanation, in, ray.find_truth(*form.info).primitive);
        const auto neighbour_rays = make_neighbours(ray, in, format.parameters, primitives);
        compare_with_other_forms(explanation, ray, {neighbour_rays}, named_forms);
    } else {
        const auto pixels = make_pixels_around(*pixel, *pixel->scene, ray.touching());
        const NearbyRays nearby_rays = nearby_pixels(explanation, pixels);
        explanation.nearby_pixel_count = static_cast<int>(nearby_rays.rays.size());
        compare_with_other_forms(explanation, ray, nearby_rays, named_forms);
        find_better_generators(explanation, ray, *pixel);
    }
    std::ranges::stable_sort(explanation.better_forms, {}, &FormResult::mean_lost_nearby);
    return explanation;
}

}  // namespace lostbits::measure::attribution
