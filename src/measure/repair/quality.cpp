#include "measure/repair/quality.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

#include "intersect/process/parallel.hpp"
#include "intersect/table/in_range.hpp"
#include "intersect/transform/transform_method.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/answer/chunk.hpp"
#include "measure/evaluate/measure_form.hpp"
#include "measure/study/bands.hpp"
#include "number/error.hpp"

namespace lostbits::measure::repair {

using evaluate::TestedForm;
using scene::file::Scene;
using tape::TapeForm;

namespace {

/// Number of tapes that are measured together; more would only cost memory.
constexpr std::size_t tapes_per_call = 48;

/// Hash of the bits of all answers of a form, in order.
class AnswerHash {
public:
    void add_band(const evaluate::BandResult& result) {
        const answer::Answers& a = *result.answers;
        for (std::size_t i = 0; i < a.hit.size(); ++i) {
            add(a.hit[i]);
            if (a.hit[i] != 0) add(std::isnan(a.t[i]) ? 1 : std::bit_cast<std::uint64_t>(a.t[i]));
        }
    }
    friend bool operator==(const AnswerHash& a, const AnswerHash& b) { return a.hash_ == b.hash_; }

private:
    /// FNV-1a, a word at a time.
    void add(std::uint64_t x) { hash_ = (hash_ ^ x) * 0x100000001b3U; }
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

/// The tested form that runs a tape, with the format and convention of another tested form.
TestedForm make_tested_form(const TestedForm& tested_form, const TapeForm& form) {
    return {.form = &form.form(), .format = tested_form.format, .touching = tested_form.touching};
}

/// Runs a tape on rays that have candidates among many primitives, with many pairs of a ray and a primitive in one
/// call. `answer::evaluate` calls a form for one primitive after the other, and one call of a tape costs as much as
/// some hundred rays.
template <class S>
void evaluate_pairs(const TapeForm& form, const truth::FormatInputs& in, answer::Answers& answers) {
    constexpr std::size_t rays_per_call = 512;
    const scene::rays::RayBlock& rays = in.rays_for(*form.form().info);
    answers.claimed.resize(in.candidates->pair_count());
    for (std::size_t begin = 0; begin < rays.size(); begin += rays_per_call) {
        answer::PairColumns<S> pairs(rays, in, begin, std::min(begin + rays_per_call, rays.size()));
        pairs.evaluate_at_once([&](const auto& batch, const intersect::Target<S>& target, const auto& hits) {
            form.program().run<S>(batch, target, hits);
            intersect::table::limit_batch_to_range(*form.form().info, form.form().shape, batch, hits);
        });
        pairs.write_to(answers);
    }
}

std::optional<answer::Answers> evaluate_pairs_of_tape(const TapeForm& form, const truth::FormatInputs& in) {
    if (!in.candidates) return std::nullopt;
    const std::size_t ray_count = in.rays_for(*form.form().info).size();
    answer::Answers answers{std::vector<double>(ray_count), std::vector<std::uint8_t>(ray_count),
                            std::vector<std::int32_t>(ray_count, -1)};
    if (in.format.engine == Format::Engine::native32) evaluate_pairs<float>(form, in, answers);
    else evaluate_pairs<double>(form, in, answers);
    return answers;
}

/// Quality of a form, and whether its answers are those of a tape, to the bit.
struct Comparison {
    FormQuality quality;
    bool is_same;
};
Comparison compare_with_tape(const TestedForm& form, const Tape& tape, const RepairRequest& request,
                             QualityMeasurer& measurer) {
    const TapeForm tape_form(*request.tested_form.form, request.tested_form.format, tape, "tape", "");
    std::array<AnswerHash, 2> hashes;
    const auto quality =
        measurer.measure_quality({form, make_tested_form(form, tape_form)}, evaluate::show_to_each(hashes));
    return {quality.front(), hashes[0] == hashes[1]};
}

}  // namespace

const std::string& RepairRequest::id() const { return scene ? scene->id : rays->result_name; }

/// Part of the rays, their truth, and the data that all forms with the request's contract and format share.
class QualityMeasurer::Part {
public:
    Part(const RepairRequest& request, const study::Bands& bands, std::size_t k, culling::Culler& culler)
        : band(bands.at(k, request.limit, culler)),
          tested_form_(request.tested_form),
          shared_(band, {tested_form_}, request.requirement.metrics()) {}
    Part(const RepairRequest& request, const scene::rays::RayGroup& rays)
        : band(rays, request.limit),
          tested_form_(request.tested_form),
          shared_(band, {tested_form_}, request.requirement.metrics()) {}
    Part(const RepairRequest& request, const choose::IdealRays& rays)
        : band(rays.band(request.limit)),
          tested_form_(request.tested_form),
          shared_(band, {tested_form_}, request.requirement.metrics()) {}

    [[nodiscard]] evaluate::FormInputs form_inputs() const { return shared_.inputs_of(tested_form_); }

    truth::Band band;

private:
    const TestedForm& tested_form_;
    evaluate::SharedBandTruth shared_;
};

QualityMeasurer::QualityMeasurer(const RepairRequest& request, const Scene* scene) : request_(request), scene_(scene) {
    if (!scene) {
        parts_.push_back(std::make_unique<Part>(request_, request_.rays->sample));
        return;
    }
    culler_ = std::make_unique<culling::Culler>(*scene);
    if (scene->pixel_count() > max_kept_rays) return;
    const study::Bands bands(*scene);
    for (std::size_t k = 0; k < bands.size(); ++k)
        parts_.push_back(std::make_unique<Part>(request_, bands, k, *culler_));
}

QualityMeasurer::QualityMeasurer(const RepairRequest& request, const MovedRays& rays)
    : request_(request), scene_(nullptr) {
    parts_.push_back(
        std::visit([&](const auto& moved_rays) { return std::make_unique<Part>(request_, moved_rays); }, rays));
}

QualityMeasurer::~QualityMeasurer() = default;

std::uint64_t QualityMeasurer::rays() const {
    return scene_ ? scene_->pixel_count() : parts_.front()->band.pixel_count();
}

void QualityMeasurer::for_each_part(const std::function<void(const Part&)>& action) {
    for (const auto& part : parts_) action(*part);
    if (!parts_.empty()) return;
    const study::Bands bands(*scene_);
    for (std::size_t k = 0; k < bands.size(); ++k) action(Part(request_, bands, k, *culler_));
}

std::vector<FormQuality> QualityMeasurer::measure_quality(const std::vector<TestedForm>& tested_forms,
                                                          const evaluate::ShowForms& show) {
    return measure_quality(tested_forms, show, {});
}

std::vector<FormQuality> QualityMeasurer::measure_quality(const std::vector<TestedForm>& tested_forms,
                                                          const evaluate::ShowForms& show,
                                                          const std::vector<std::unique_ptr<TapeForm>>& tapes) {
    const std::vector<const metric::Metric*> metrics = request_.requirement.metrics();
    std::vector<evaluate::FormSummary> summaries;
    for (std::size_t r = 0; r < tested_forms.size(); ++r) summaries.emplace_back(metrics);

    for_each_part([&](const Part& part) {
        intersect::process::in_parallel(std::size_t{0}, tested_forms.size(), [&](std::size_t r) {
            request_.limit.stop.check();
            const auto pair_answers =
                tapes.empty() ? std::nullopt : evaluate_pairs_of_tape(*tapes[r], part.form_inputs().inputs);
            evaluate::FormRequest form_request{tested_forms[r], metrics};
            if (show) form_request.show = [&show, r](const evaluate::BandResult& band) { show(r, band); };
            if (pair_answers) form_request.answers = &*pair_answers;
            measure_form(form_request, part.form_inputs(), summaries[r]);
        });
    });

    std::vector<FormQuality> qualities;
    for (std::size_t r = 0; r < tested_forms.size(); ++r)
        qualities.push_back(choose::to_quality(summaries[r], tested_forms[r], request_.requirement));
    return qualities;
}

std::vector<FormQuality> QualityMeasurer::measure_quality(const std::vector<Tape>& tapes) {
    std::vector<FormQuality> qualities;
    for (std::size_t begin = 0; begin < tapes.size(); begin += tapes_per_call) {
        const std::size_t end = std::min(begin + tapes_per_call, tapes.size());
        std::vector<std::unique_ptr<TapeForm>> forms;
        std::vector<TestedForm> tested_forms;
        for (std::size_t k = begin; k < end; ++k) {
            forms.push_back(std::make_unique<TapeForm>(*request_.tested_form.form, request_.tested_form.format,
                                                       tapes[k], "candidate", ""));
            tested_forms.push_back(make_tested_form(request_.tested_form, *forms.back()));
        }

        const auto quality = measure_quality(tested_forms, {}, forms);
        qualities.insert(qualities.end(), quality.begin(), quality.end());
        tried_count_ += end - begin;
        request_.progress(end - begin);
    }
    return qualities;
}

bool is_more_accurate(const FormQuality& a, const FormQuality& b) {
    const auto known_bits = [](const FormQuality& quality) {
        return std::isnan(quality.kept_bits) ? -1 : quality.kept_bits;
    };
    return a.wrong_fraction() != b.wrong_fraction() ? a.wrong_fraction() < b.wrong_fraction()
                                                    : known_bits(a) > known_bits(b);
}

bool has_answers_of_tape(const TestedForm& form, const Tape& tape, const RepairRequest& request,
                         QualityMeasurer& measurer) {
    return compare_with_tape(form, tape, request, measurer).is_same;
}

FormQuality measure_own_quality(const RepairRequest& request, const Tape& tape, QualityMeasurer& measurer) {
    const Comparison comparison = compare_with_tape(request.tested_form, tape, request, measurer);
    if (comparison.is_same) return comparison.quality;
    throw InputError(
        std::string(request.tested_form.form->info->name) +
        ": its operations differ from ray to ray, because it uses more precision where a ray needs it; name a "
        "form that does the same operations for every ray");
}

std::vector<evaluate::TestedForm> list_comparable_forms(const evaluate::TestedForm& tested_form) {
    std::vector<evaluate::TestedForm> tested_forms;
    const auto parts = intersect::transform::find_transformed_parts(*tested_form.form);
    for (const auto& form : intersect::table::catalogue()) {
        if (form.shape != tested_form.form->shape || !form.exists_in(tested_form.format)) continue;
        tested_forms.push_back(
            {parts.form ? &intersect::transform::transformed_form(*parts.method, form) : &form, tested_form.format});
    }
    for (const auto& method : intersect::transform::transform_methods())
        if (parts.form && &method != parts.method)
            tested_forms.push_back({&intersect::transform::transformed_form(method, *parts.form), tested_form.format});
    return tested_forms;
}

std::vector<FormWithQuality> rank_catalogue(const RepairRequest& request) {
    choose::ChoiceRequest choice_request{.scene = request.scene,
                                         .tested_forms = list_comparable_forms(request.tested_form),
                                         .requirement = request.requirement};
    choice_request.limit = request.limit;
    const auto quality = request.scene ? measure_quality(choice_request) : request.rays->quality;
    std::vector<FormWithQuality> ranked;
    for (std::size_t k = 0; k < quality.size(); ++k) ranked.push_back({choice_request.tested_forms[k], quality[k]});
    std::ranges::stable_sort(ranked, is_more_accurate, &FormWithQuality::quality);
    return ranked;
}

std::vector<choose::GrowthMargin> find_margins_of_tape(const RepairRequest& request, const Tape& tape) {
    choose::ChoiceRequest choice_request{
        .scene = request.scene, .rays = request.rays, .requirement = request.requirement};
    choice_request.limit = request.limit;
    const tape::TapeForm form(*request.tested_form.form, request.tested_form.format, tape, "mended", "");
    return find_margins(choice_request, {.form = &form.form(), .format = request.tested_form.format}, few_rays_count);
}

}  // namespace lostbits::measure::repair
