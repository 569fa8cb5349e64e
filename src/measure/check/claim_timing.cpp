// Measures claims about speed: ratios of speeds within one run. Also measures claims about a choice for a scene:
// which forms meet a requirement, which of them is the cheapest, and ratios of times on the scene's own rays. All times
// are those of a claim's form in its format, in the widest registers in use.
#include <algorithm>

#include "measure/check/claim_subjects.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/trade/timing.hpp"
#include "measure/trade/timing_work.hpp"

namespace lostbits::measure::check {

using choose::ChoiceRequest;
using evaluate::TestedForm;
using scene::check::ChoiceSubject;
using scene::check::Claim;
using trade::TimedKernel;
using trade::TimedWork;

namespace {

using scene::check::TimingSubject;
using OptionalTasks = std::vector<std::optional<TimedWork>>;

template <class Work>
OptionalTasks make_tasks(std::span<const TimedKernel> kernels, std::size_t bytes) {
    Work work(bytes);
    OptionalTasks result;
    for (const TimedKernel& kernel : kernels) result.push_back(work.work_for(kernel));
    return result;
}

constexpr std::pair<std::string_view, OptionalTasks (*)(std::span<const TimedKernel>, std::size_t)> work_kinds[] = {
    {"one_ray_many_boxes", make_tasks<trade::BoxWork>}, {"many_rays_one_primitive", make_tasks<trade::RayWork>}};

/// Makes the timed work of each kernel, on the same data.
std::vector<TimedWork> make_timed_work(const Claim& claim, const std::vector<TimedKernel>& kernels, std::size_t bytes) {
    const std::string& subject_name = claim.subject_name();
    const auto found = std::ranges::find(work_kinds, subject_name, [](const auto& entry) { return entry.first; });
    if (found == std::end(work_kinds))
        scene::toml::fail(claim.where,
                          "unknown work \"" + subject_name + "\"; write one_ray_many_boxes or many_rays_one_primitive");
    std::vector<TimedWork> result;
    auto optional_tasks = found->second(kernels, bytes);
    for (std::size_t i = 0; i < optional_tasks.size(); ++i) {
        if (!optional_tasks[i])
            scene::toml::fail(claim.where,
                              "no form \"" + std::string(kernels[i].form_name) + "\" in the kernel \"" +
                                  std::string(kernels[i].kernel_name) + "\" for " + subject_name + " in " +
                                  claim.format +
                                  "; kernels are scalar, 128, 256 and 512, and plain-256 and plain-structs-256 for "
                                  "boxes in f32; `lostbits list forms` has the forms");
        result.push_back(std::move(*optional_tasks[i]));
    }
    return result;
}

/// Median over interleaved repetitions of (seconds for one item of `baseline`)/(seconds for one item of the kernel).
double speed_ratio(const Claim& claim, const TimingSubject& subject, std::size_t bytes,
                   intersect::process::StopToken stop) {
    const auto work = make_timed_work(
        claim,
        {{subject.baseline_form, subject.baseline_kernel, claim.format}, {claim.form, subject.kernel, claim.format}},
        bytes);
    const auto samples = trade::sample_interleaved(
        work, {.repetitions = trade::fits_in_cache(bytes) ? 101 : 15, .min_seconds = 1e-3, .stop = stop});
    return trade::summarise_ratios(samples[0], samples[1]).median;
}

/// Median of (rate of all allowed processors)/(rate of one · their number); 1 is perfect.
double speedup_per_processor(const Claim& claim, const TimingSubject& subject, std::size_t bytes,
                             intersect::process::StopToken stop) {
    const auto work = [&](std::size_t) {
        return make_timed_work(claim, {{claim.form, subject.kernel, claim.format}}, bytes).front().pass;
    };
    return trade::summarise_samples(trade::measure_thread_speedups(work, {.stop = stop})).median /
           static_cast<double>(trade::allowed_processors().size());
}

}  // namespace

void measure(const SubjectClaims<TimingSubject>& claims, const ClaimRequest& run) {
    for (const auto& [claim, subject, result] : claims) {
        const std::size_t bytes = trade::working_set_bytes(subject.data, trade::read_cache_sizes());
        if (bytes == 0) scene::toml::fail(claim.where, "unknown data \"" + subject.data + "\"; write l1, l2 or memory");
        const std::string_view metric = subject.uses_all_processors ? "speedup_per_processor" : "speed_ratio";
        if (claim.metric != metric)
            scene::toml::fail(claim.where, "unknown metric \"" + claim.metric + "\"; write " + std::string(metric));
        const auto measure_metric = subject.uses_all_processors ? speedup_per_processor : speed_ratio;
        result = judge_measured_value(claim, measure_metric(claim, subject, bytes, run.stop), nullptr);
    }
}

using OtherForms = ChoiceSubject::OtherForms;
using scene::file::Scene;

namespace {

/// Form and format of a claim, which must be possible to time on the scene.
TestedForm timeable_form(const Claim& claim, const Scene& scene) {
    const TestedForm tested_form = tested_form_for(claim, scene);
    if (!is_primitive(tested_form.form->shape))
        scene::toml::fail(claim.where, claim.form +
                                           " marches, and the time of a march depends on its steps; name a "
                                           "form of a primitive, such as sphere.half_b");
    if (tested_form.format.is_emulated())
        scene::toml::fail(claim.where, claim.format + " is emulated, so its time means nothing; write f32 or f64");
    return tested_form;
}

/// The claim's form, followed by every other form that fits the scene, in the formats that the requirement names.
std::vector<TestedForm> list_candidates(const Claim& claim, const OtherForms& others, const Scene& scene) {
    std::vector<TestedForm> tested_forms{timeable_form(claim, scene)};
    for (const std::string& name : others.formats) {
        Claim candidate = claim;
        candidate.format = name;
        const Format format = claim_format(candidate);
        for (const intersect::table::Intersector& form :
             intersect::table::intersectors(tested_forms.front().form->shape)) {
            if (!form.exists_in(format)) continue;
            candidate.form = form.info->name;
            find_or_add_tested_form(tested_forms, timeable_form(candidate, scene));
        }
    }
    return tested_forms;
}

ChoiceRequest make_request(const Claim& claim, const OtherForms& others, const Scene& scene,
                           intersect::process::StopToken stop) {
    ChoiceRequest request{.scene = &scene};
    request.requirement = {.bits = others.requirement.bits,
                           .max_wrong_fraction = others.requirement.max_wrong_fraction};
    request.requirement.quantile =
        find_for_claim(claim, [&] { return choose::parse_quantile(others.requirement.quantile); });
    request.limit.stop = request.plan.stop = stop;
    return request;
}

/// Median over interleaved repetitions of (seconds of the claim's form)/(seconds of `baseline`), each for one ray and
/// primitive.
double time_ratio(const Claim& claim, const ChoiceSubject::RelativeTime& baseline, const Scene& scene,
                  intersect::process::StopToken stop) {
    Claim baseline_claim = claim;
    baseline_claim.form = baseline.form;
    baseline_claim.format = baseline.format;
    trade::SceneWork scene_work(scene, {.stop = stop});
    std::vector<trade::TimedWork> work;
    for (const TestedForm& tested_form : {timeable_form(claim, scene), timeable_form(baseline_claim, scene)})
        work.push_back(scene_work.work_for(tested_form, intersect::simd::packed_kernels(*tested_form.form)));
    const auto samples = trade::sample_interleaved(work, {.repetitions = 101, .min_seconds = 1e-3, .stop = stop});
    return trade::summarise_ratios(samples[0], samples[1]).median;
}

/// 1 if the claim's form meets the requirement, else 0.
double meets_as_number(const Claim& claim, const OtherForms& others, const Scene& scene,
                       intersect::process::StopToken stop) {
    ChoiceRequest request = make_request(claim, others, scene, stop);
    request.tested_forms = {timeable_form(claim, scene)};
    return measure_quality(request).front().meets(request.requirement) ? 1 : 0;
}

/// Number of other forms that fit the scene and meet the requirement, over all of the formats.
double count_others_that_meet(const Claim& claim, const OtherForms& others, const Scene& scene,
                              intersect::process::StopToken stop) {
    ChoiceRequest request = make_request(claim, others, scene, stop);
    request.tested_forms = list_candidates(claim, others, scene);
    std::erase_if(request.tested_forms,
                  [&claim](const TestedForm& tested_form) { return tested_form.form->info->name == claim.form; });
    if (request.tested_forms.empty()) return 0;
    const auto qualities = measure_quality(request);
    return static_cast<double>(std::ranges::count_if(
        qualities, [&request](const choose::FormQuality& quality) { return quality.meets(request.requirement); }));
}

/// 1 if the claim's form is the cheapest that meets the requirement, else 0.
double chosen_as_number(const Claim& claim, const OtherForms& others, const Scene& scene,
                        intersect::process::StopToken stop) {
    ChoiceRequest request = make_request(claim, others, scene, stop);
    request.tested_forms = list_candidates(claim, others, scene);
    choose::TimedRays timed;
    return find_cheapest(measure_candidates(request, timed), request.requirement) == std::size_t{0} ? 1 : 0;
}

constexpr std::pair<std::string_view,
                    double (*)(const Claim&, const OtherForms&, const Scene&, intersect::process::StopToken)>
    requirement_metrics[] = {
        {"meets", meets_as_number}, {"others_that_meet", count_others_that_meet}, {"chosen", chosen_as_number}};

double choice_value(const Claim& claim, const ChoiceSubject& subject, const ClaimRequest& run) {
    const Scene scene = load_single_scene(claim, run);
    if (const auto* const baseline = std::get_if<ChoiceSubject::RelativeTime>(&subject.against)) {
        if (claim.metric == "time_ratio") return time_ratio(claim, *baseline, scene, run.stop);
        scene::toml::fail(claim.where, "unknown metric \"" + claim.metric + "\"; with `over`, write time_ratio");
    }
    const auto found =
        std::ranges::find(requirement_metrics, claim.metric, [](const auto& entry) { return entry.first; });
    if (found == std::end(requirement_metrics))
        scene::toml::fail(claim.where, "unknown metric \"" + claim.metric +
                                           "\"; with a requirement, write meets, others_that_meet or chosen");
    return found->second(claim, std::get<OtherForms>(subject.against), scene, run.stop);
}

}  // namespace

void measure(const SubjectClaims<ChoiceSubject>& claims, const ClaimRequest& run) {
    for (const auto& [claim, subject, result] : claims)
        result = judge_measured_value(claim, choice_value(claim, subject, run), nullptr);
}

}  // namespace lostbits::measure::check
