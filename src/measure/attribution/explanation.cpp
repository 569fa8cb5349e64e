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
using intersect::bounding_box::innermost;
using intersect::bounding_box::with_other_form;
using intersect::table::Intersector;
using truth::FormatInputs;
using truth::missing;

namespace {

/// Draws −1, 0 or 1, the same in every run, with Knuth's generator (MMIX). Its high bits are the good ones.
class RandomMoves {
public:
    int next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<int>((state_ >> 33) % 3) - 1;
    }

private:
    std::uint64_t state_ = 1;
};

double moved(double x, int ulps, const FloatFormat& format) {
    return x == 0 || !std::isfinite(x) ? x : x + ulps * ulp_at(x, format);
}

/// Result of a form that has answered. For a form that answers no t, only the decision counts.
FormResult result_of_form(const Intersector& form, const Format& format, const OneRay& ray, bool hit, double t) {
    const bool tells_t = form.info->roots != intersect::Roots::none;
    FormResult s{&form, answer::classify(ray.truth(*form.info).decision, hit, tells_t ? t : 0), t};
    if (s.outcome != Outcome::agree_hit || !tells_t) return s;
    s.ulps = truth::ulp_error(t, ray.true_t(*form.info), format.parameters);
    s.lost = truth::lost_bits(s.ulps, format.parameters.precision);
    return s;
}

/// Result of the form's nearest answer over the primitives of the scene, as in a picture.
FormResult result_of_form(const Intersector& form, const Format& format, const OneRay& ray) {
    const OneRay::Inputs in = ray.inputs(form, format);
    const answer::Answers answers = answer::evaluate(form, in.all);
    return result_of_form(form, format, ray, answers.hit[in.index] != 0, answers.t[in.index]);
}

/// Rays near another one, on which forms are compared.
struct Surroundings {
    std::span<const OneRay> rays;
    bool hits_alone = false;  ///< skips correct misses: pixels beside the primitive say nothing about t
};

/// Mean lost bits over the rays whose truth is known. A wrong decision loses all bits. If t does not count, a right
/// decision loses none.
double lost_around(const Intersector& form, const Format& format, const Surroundings& around, bool asks_t) {
    double sum = 0;
    int known = 0;
    for (const OneRay& ray : around.rays) {
        const FormResult s = result_of_form(form, format, ray);
        if (s.outcome == Outcome::unresolved || (around.hits_alone && s.outcome == Outcome::agree_miss)) continue;
        sum += !s.is_right() ? format.parameters.precision : !asks_t || std::isnan(s.lost) ? 0 : s.lost;
        ++known;
    }
    return known == 0 ? missing : sum / known;
}

/// Primitives that the form hits and that the ray truly meets. For a march, all primitives, since its field includes
/// all.
std::vector<Primitive<double>> primitives_around(const Explanation& x, const OneRay::Inputs& in, int truly) {
    std::vector<Primitive<double>> primitives;
    for (std::size_t i = 0; i < in.all.primitives.size(); ++i) {
        const int place = static_cast<int>(i);
        if (!is_primitive(x.form->shape) || place == x.primitive || place == truly)
            primitives.push_back(in.all.primitives[i]);
    }
    return primitives;
}

/// True if two forms, each on its ray, have different truths. If only one of them normalises the direction, their t
/// have different units, and only the decision counts.
bool is_other_question(const Intersector& a, const OneRay& ray_a, const Intersector& b, const OneRay& ray_b) {
    const truth::Truth of_a = ray_a.truth(*a.info), of_b = ray_b.truth(*b.info);
    if (of_a.decision != of_b.decision) return true;
    return of_a.is_hit() && a.info->direction == b.info->direction &&
           ray_a.rounded_truth(*a.info, binary64) != ray_b.rounded_truth(*b.info, binary64);
}

/// The form to compare with the explained one: a form of the same shape. For a set, the same set with `other` for the
/// explained primitive, or another set of the same shapes. Null if `other` fits neither.
const Intersector* with_form(const Intersector& asked, Shape shape, const Intersector& other) {
    if (!asked.is_set() && other.shape != asked.shape) return nullptr;
    if (!asked.is_set()) return &innermost(other) == &other ? &with_other_form(asked, other) : &other;
    if (other.is_set()) return other.shapes() == asked.shapes() ? &other : nullptr;
    if (other.shape != shape) return nullptr;
    std::vector<const Intersector*> parts(asked.parts.begin(), asked.parts.end());
    *std::ranges::find(parts, shape, &Intersector::shape) = &other;
    return intersect::table::refusal_of_set(parts).empty() ? &intersect::table::set_of(parts) : nullptr;
}

/// The same form with the ray generator of `asked`.
const Intersector* with_generator_of(const Intersector& asked, const Intersector* held) {
    const auto* const generator = scene::rays::generator_of(asked);
    return generator && held ? &scene::rays::with_generator(*generator, *held) : held;
}

/// Result of another form on a ray and, if it is right there, on the rays around it.
FormResult result_of_other_form(const Explanation& x, const OneRay& ray, const Intersector& form, const OneRay& its_ray,
                                const Surroundings& around) {
    FormResult s = result_of_form(form, x.format, its_ray);
    s.other_question = is_other_question(*x.form, ray, form, its_ray);
    const bool lost_all = s.outcome == Outcome::agree_hit && !(s.lost < x.format.parameters.precision);
    // A form that answers no t loses no bits of it, but is not better than one that is right.
    const bool tells_less = std::isnan(s.lost) && !std::isnan(x.result.lost);
    if (s.is_right() && !lost_all && !tells_less && !s.other_question)
        s.lost_nearby = lost_around(form, x.format, around, x.tells_t());
    return s;
}

void add_if_better(Explanation& x, const FormResult& s) {
    if (s.lost_nearby < x.result.lost_nearby) x.better.push_back(s);
}

void find_better(Explanation& x, const OneRay& ray, const Surroundings& around,
                 std::span<const Intersector* const> beside) {
    x.result.lost_nearby = lost_around(*x.form, x.format, around, x.tells_t());
    std::vector<const Intersector*> all;
    for (const Intersector& other : intersect::table::intersectors()) all.push_back(&other);
    if (const auto parts = intersect::transform::transformed_parts_of(*x.form); parts.method != nullptr)
        for (const auto& space : intersect::transform::transform_methods())
            all.push_back(&intersect::transform::through(space, *parts.form));
    if (const auto parts = intersect::bounding_box::boxed_parts_of(*x.form); parts.form != nullptr)
        for (const Intersector& box : intersect::table::intersectors(parts.box->shape))
            if (intersect::external::is_safe_to_run(box))
                all.push_back(&intersect::bounding_box::behind(*parts.method, box, *parts.form));
    std::ranges::copy_if(beside, std::back_inserter(all), &Intersector::is_set);
    for (const Intersector* const other : all) {
        const bool named = std::ranges::find(beside, other) != beside.end();
        const Intersector* const held = with_generator_of(*x.form, with_form(*x.form, x.shape, *other));
        if (held == x.form) continue;
        if (held == nullptr || !held->exists_in(x.format)) {
            if (named) x.not_comparable.push_back(other);
            continue;
        }
        if (!intersect::external::is_safe_to_run(innermost(*other)) && !named) continue;
        try {
            const FormResult s = result_of_other_form(x, ray, *held, ray, around);
            add_if_better(x, s);
            if (named) x.compared.push_back(s);
        } catch (const EnvironmentError& error) {
            x.failures.emplace_back(error.what());
        }
    }
}

std::vector<OneRay> pixels_around(const ScenePixel& at, const scene::file::Scene& scene,
                                  std::optional<intersect::Touching> judged) {
    std::vector<OneRay> all = OneRay::pixels_around(scene, at.x, at.y, at.limit);
    for (OneRay& ray : all) ray.judge_by(judged);
    return all;
}

/// Pixels around the first one. If the ray hits, only the other hits count: they show the error of making such rays.
Surroundings around_pixel(const Explanation& x, std::span<const OneRay> pixels) {
    return {pixels.subspan(1), x.truth == truth::Truth::Decision::hit};
}

/// Compares the form with itself on the same pixel, with every other ray generator. Skips a generator that cannot make
/// the ray.
void find_better_generators(Explanation& x, const OneRay& ray, const ScenePixel& pixel) {
    const Intersector& form = scene::rays::strip_generator(*x.form);
    if (form.is_set() || form.is_placed) return;
    for (const scene::camera::RayGenerator& generator : scene::camera::ray_generators()) {
        if (&generator == pixel.scene->camera.rays) continue;
        try {
            const scene::file::Scene scene = with_rays(*pixel.scene, generator);
            const auto rays = pixels_around(pixel, scene, ray.touching());
            const FormResult s = result_of_other_form(x, ray, scene::rays::with_generator(generator, form),
                                                      rays.front(), around_pixel(x, rays));
            add_if_better(x, s);
        } catch (const InputError&) {}
    }
}

/// Evaluates the form on the primitive that the ray truly meets; called when the form answers another one.
std::optional<TruePrimitive> missed_primitive(const Intersector& form, const Format& format, const OneRay::Inputs& in,
                                              const std::optional<scene::rays::RecordedRay>& recorded_ray, int truly) {
    TruePrimitive found{.primitive = truly, .alone = scene::rays::group_of(in.all.rays[in.index])};
    const auto place = static_cast<std::size_t>(truly);
    found.alone.primitives = {in.all.primitives[place]};
    found.alone.rays.push_range(in.all.rays, in.index);
    const Range<double> range = in.all.rays_for(*form.info).range(in.index);
    const FormatInputs::AimedAt aim = in.all.target_for(form, place);
    const intersect::Target<double> target = aim;
    Tape tape;
    form.record(format, in.ray(*form.info), target, range.tmax, tape);
    std::vector<std::string> names =
        names_of_inputs(form, target, recorded_ray && recorded_ray->try_put_before(tape) ? &*recorded_ray : nullptr);
    append_range_checks(tape, names, form.of(target.primitives.front().shape), format, range);
    const Attribution of = attribute(tape);
    found.hit = tape[tape.outputs.hit].value != 0;
    found.t = tape[tape.outputs.t].value;
    found.exact_hit = of.exact_hit;
    found.exact_t = of[tape.outputs.t].exact;
    return found;
}

/// The true t of the ray under another range; nothing if it misses.
std::optional<double> hit_in(const Range<double>& range, const OneRay& ray, const OneRay::Inputs& in,
                             const intersect::Info& info) {
    scene::rays::RayGroup group = scene::rays::group_of(in.all.rays[in.index]);
    group.rays.tmin = {range.tmin}, group.rays.tmax = {range.tmax}, group.rays.open = range.open;
    for (std::size_t i = 0; i < in.all.primitives.size(); ++i) group.primitives.push_back(in.all.primitives[i]);
    group.march = in.all.march;
    OneRay other(std::move(group));
    other.judge_by(ray.touching());
    if (!other.truth(info).is_hit()) return {};
    return other.rounded_truth(info, binary64);
}

/// Finds the hits that the range of a ray excludes, if the ray truly misses.
void find_hits_out_of_range(Explanation& x, const OneRay& ray, const OneRay::Inputs& in) {
    const Range<double> range = in.all.rays.range(in.index);
    if (range.is_whole() || !range.holds_any()) return;
    const intersect::Info& info = *x.form->info;
    x.beyond_end = hit_in({range.tmin, HUGE_VAL, {.tmin = range.open.tmin}}, ray, in, info);
    x.before_begin = hit_in({0, range.tmax, {.tmax = range.open.tmax}}, ray, in, info);
}

/// True for equal numbers and for two NaN.
bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

std::vector<answer::OneRay> neighbours_of(const answer::OneRay& ray, const answer::OneRay::Inputs& in,
                                          const FloatFormat& format, const std::vector<Primitive<double>>& primitives) {
    std::vector<answer::OneRay> all;
    RandomMoves moves;
    const Ray<double> middle = in.all.rays[in.index];
    for (int k = 0; k < neighbours; ++k) {
        Ray<double> beside = middle;
        for (Vec<double>* const v : {&beside.origin, &beside.direction}) {
            for (double* const x : {&v->x, &v->y, &v->z}) *x = moved(*x, moves.next(), format);
        }
        scene::rays::RayGroup group = scene::rays::group_of(beside);
        group.rays.push_range(in.all.rays, in.index);
        group.primitives = primitives;
        group.march = in.all.march;
        all.emplace_back(std::move(group)).judge_by(ray.touching());
    }
    return all;
}

bool FormResult::beats(const FormResult& other) const {
    if (is_right() != other.is_right()) return is_right();
    return outcome == Outcome::agree_hit && other.outcome == Outcome::agree_hit && lost < other.lost;
}

double Explanation::ulp_of_subject() const {
    const NodeId s = attribution.subject;
    if (s == no_node) return missing;
    if (!is_decision(tape[s].op)) return ulp_at(attribution[s].exact, format.parameters);
    const auto side = [&](std::size_t k) { return std::fabs(attribution[tape[s].operands[k]].exact); };
    return ulp_at(std::max(side(0), side(1)), format.parameters);
}

NodeId Explanation::amplifier(NodeId from) const {
    if (from == no_node) return no_node;
    std::vector<bool> reached(tape.nodes.size());
    reached[static_cast<std::size_t>(from)] = true;
    NodeId most = no_node;
    int bits = 1;
    for (NodeId i = from + 1; i < tape.size(); ++i) {
        const OperationError& e = attribution[i];
        if (!e.live) continue;
        for (const NodeId operand : tape.operands_of(i)) {
            if (reached[static_cast<std::size_t>(operand)]) reached[static_cast<std::size_t>(i)] = true;
        }
        if (reached[static_cast<std::size_t>(i)] && e.carried && e.cancelled > bits) {
            most = i;
            bits = e.cancelled;
        }
    }
    return most;
}

bool Explanation::rounding_turned_order() const {
    if (!missed || !missed->exact_hit) return false;
    return !attribution.exact_hit || missed->exact_t < attribution[tape.outputs.t].exact;
}

std::vector<NodeId> Explanation::turned() const {
    std::vector<NodeId> all;
    for (NodeId i = 0; i < tape.size(); ++i) {
        const OperationError& e = attribution[i];
        if (e.turned && e.live && (is_decision(tape[i].op) || e.rounding != 0)) all.push_back(i);
    }
    return all;
}

Explanation explain_alone(const Intersector& form, const Format& format, const OneRay& ray) {
    const OneRay::Inputs in = ray.inputs(form, format);
    const answer::Answers answers = answer::evaluate(form, in.all);
    const truth::Truth& truth = ray.truth(*form.info);
    Explanation x{.form = &form, .format = format, .rounded_inputs = !ray.is_unrounded(in), .judged = ray.touching()};
    const Vec<double> given = in.all.rays[in.index].direction, received = in.ray(*form.info).direction;
    if (!is_same(given.x, received.x) || !is_same(given.y, received.y) || !is_same(given.z, received.z))
        x.given = given;
    x.primitives = static_cast<int>(in.all.primitives.size());
    const std::size_t primitive = answer::measured_primitive(
        in.all, in.index, answers.hit[in.index] != 0 ? answers.object[in.index] : truth.object);
    x.primitive = static_cast<int>(primitive);
    x.shape = in.all.primitives[primitive].shape;
    const FormatInputs::AimedAt aim = in.all.target_for(form, primitive);
    const intersect::Target<double> target = aim;
    x.range = in.all.rays_for(*form.info).range(in.index);
    if (form.is_template()) {
        form.record(format, in.ray(*form.info), target, x.range.tmax, x.tape);
        const auto recorded_ray = ray.recorded_ray(format);
        x.is_generated_ray = recorded_ray.has_value();
        x.names = names_of_inputs(form, target,
                                  recorded_ray && recorded_ray->try_put_before(x.tape) ? &*recorded_ray : nullptr);
        append_range_checks(x.tape, x.names, form.of(x.shape), format, x.range);
        for (const TapeNode& n : x.tape.nodes) {
            if (n.op == TapeOp::input) x.inputs.push_back(n.value);
        }
        x.attribution = attribute(x.tape, {.full = true});
        if (x.attribution.culprit != no_node) x.culprit_alone = counterfactuals(x.tape, x.attribution.culprit);
        x.hit = x.tape[x.tape.outputs.hit].value != 0;
        x.result = result_of_form(form, format, ray, x.hit, x.tape[x.tape.outputs.t].value);
    } else {
        x.names = intersect::bounding_box::names_on_tape(form, target);
        x.inputs =
            tape::inputs_of(in.ray(*form.info), in.all.primitives[static_cast<std::size_t>(x.primitive)], x.range.tmax);
        if (!x.range.is_whole()) x.names.emplace_back("ray.tmin"), x.inputs.push_back(x.range.tmin);
        x.hit = answers.hit[in.index] != 0;
        x.result = result_of_form(form, format, ray, x.hit, answers.t[in.index]);
    }
    x.truth = truth.decision;
    x.condition = x.inherent = missing;
    double reach = missing;
    if (truth.is_hit()) {
        x.true_t = ray.rounded_truth(*form.info, binary64);
        x.condition = ray.condition(*form.info);
        reach = ray.reach(*form.info, format);
        x.inherent = truth::inherent_bits(reach, ray.true_t(*form.info), format.parameters);
    }
    if (truth.decision == truth::Truth::Decision::miss) find_hits_out_of_range(x, ray, in);
    const int met = answers.object[in.index];
    const bool elsewhere =
        x.tells_t() && is_primitive(form.shape) && x.hit && truth.is_hit() && !ray.meets_first(met, *form.info);
    if (elsewhere && x.has_tape())
        x.missed = missed_primitive(form, format, in, ray.recorded_ray(format), truth.object);
    if (elsewhere) {  // distances between two primitives are not errors
        x.result.outcome = answer::Outcome::wrong_primitive;
        x.result.ulps = x.result.lost = missing;
    }
    if (is_primitive(form.shape) && x.tells_t()) {
        const Outcome outcome = ray.outcome(in, answers, *form.info, x.result.outcome);
        if (outcome != x.result.outcome) x.in_mesh = outcome;
    }
    if (x.result.outcome == Outcome::agree_hit)
        x.beyond = truth::excess_bits(x.result.t, ray.true_t(*form.info), format.parameters, reach);
    return x;
}

Explanation explain(const Intersector& form, const Format& format, const OneRay& ray,
                    std::span<const Intersector* const> beside, const std::optional<ScenePixel>& pixel) {
    Explanation x = explain_alone(form, format, ray);
    if (!x.is_generated_ray || !pixel) {
        const OneRay::Inputs in = ray.inputs(form, format);
        const auto primitives = primitives_around(x, in, ray.truth(*form.info).object);
        const auto near = neighbours_of(ray, in, format.parameters, primitives);
        find_better(x, ray, {near}, beside);
    } else {
        const auto pixels = pixels_around(*pixel, *pixel->scene, ray.touching());
        const Surroundings around = around_pixel(x, pixels);
        x.pixels_around = static_cast<int>(around.rays.size());
        find_better(x, ray, around, beside);
        find_better_generators(x, ray, *pixel);
    }
    std::ranges::stable_sort(x.better, {}, &FormResult::lost_nearby);
    return x;
}

}  // namespace lostbits::measure::attribution
