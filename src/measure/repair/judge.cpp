#include "measure/repair/judge.hpp"

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
#include "measure/evaluate/measure_row.hpp"
#include "measure/study/bands.hpp"
#include "number/error.hpp"

namespace lostbits::measure::repair {

using evaluate::TestedForm;
using scene::file::Scene;
using tape::TapeForm;

namespace {

/// Number of tapes that one call measures; more would only cost memory.
constexpr std::size_t at_once = 48;

/// Hash over the bits of all answers of a row, in order.
class Bits {
public:
    void band(const evaluate::BandResult& result) {
        const answer::Answers& a = *result.answers;
        for (std::size_t i = 0; i < a.hit.size(); ++i) {
            add(a.hit[i]);
            if (a.hit[i] != 0) add(std::isnan(a.t[i]) ? 1 : std::bit_cast<std::uint64_t>(a.t[i]));
        }
    }
    friend bool operator==(const Bits& a, const Bits& b) { return a.hash_ == b.hash_; }

private:
    /// FNV-1a, a word at a time.
    void add(std::uint64_t x) { hash_ = (hash_ ^ x) * 0x100000001b3U; }
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

TestedForm row_like(const TestedForm& row, const TapeForm& form) {
    return {.form = &form.row(), .format = row.format, .judged = row.judged};
}

/// Runs a tape on rays that have candidates among many primitives, with many pairs of a ray and a primitive in one
/// call. `answer::evaluate` calls a form for one primitive after the other, and one call of a tape costs as much as
/// some hundred rays.
template <class S>
void evaluate_among(const TapeForm& form, const truth::FormatInputs& in, answer::Answers& answers) {
    constexpr std::size_t rays_at_once = 512;
    const scene::rays::RayBlock& rays = in.rays_for(*form.row().info);
    answers.claimed.resize(in.candidates->pairs());
    for (std::size_t begin = 0; begin < rays.size(); begin += rays_at_once) {
        answer::PairColumns<S> pairs(rays, in, begin, std::min(begin + rays_at_once, rays.size()));
        pairs.evaluate_at_once([&](const auto& batch, const intersect::Target<S>& target, const auto& hits) {
            form.program().run<S>(batch, target, hits);
            intersect::table::keep_in_range(*form.row().info, form.row().shape, batch, hits);
        });
        pairs.write_to(answers);
    }
}

std::optional<answer::Answers> answers_among_many(const TapeForm& form, const truth::FormatInputs& in) {
    if (!in.candidates) return std::nullopt;
    const std::size_t n = in.rays_for(*form.row().info).size();
    answer::Answers answers{std::vector<double>(n), std::vector<std::uint8_t>(n), std::vector<std::int32_t>(n, -1)};
    if (in.format.engine == Format::Engine::native32) evaluate_among<float>(form, in, answers);
    else evaluate_among<double>(form, in, answers);
    return answers;
}

struct Compared {
    RowQuality quality;  ///< of the form
    bool same;
};
Compared compared(const TestedForm& form, const Tape& tape, const RepairRequest& request, Judge& judge) {
    const TapeForm other(*request.row.form, request.row.format, tape, "tape", "");
    std::array<Bits, 2> bits;
    const auto quality = judge.quality_of({form, row_like(form, other)}, evaluate::show_to_each(bits));
    return {quality.front(), bits[0] == bits[1]};
}

}  // namespace

const std::string& RepairRequest::id() const { return scene ? scene->id : rays->id; }

/// Some of the rays, with their truth and everything that rows with the contract and format of the request's row share.
class Judge::Part {
public:
    Part(const RepairRequest& request, const study::Bands& bands, std::size_t k, culling::Culler& culler)
        : band(bands.at(k, request.limit, culler)),
          row_(request.row),
          shared_(band, {row_}, request.requirement.metrics()) {}
    Part(const RepairRequest& request, const scene::rays::RayGroup& rays)
        : band(rays, request.limit), row_(request.row), shared_(band, {row_}, request.requirement.metrics()) {}
    Part(const RepairRequest& request, const choice::IdealRays& rays)
        : band(rays.band(request.limit)), row_(request.row), shared_(band, {row_}, request.requirement.metrics()) {}

    [[nodiscard]] evaluate::RowInputs rows() const { return shared_.of(row_); }

    truth::Band band;

private:
    const TestedForm& row_;
    evaluate::SharedBandTruth shared_;
};

Judge::Judge(const RepairRequest& request, const Scene* scene) : request_(request), scene_(scene) {
    if (!scene) {
        kept_.push_back(std::make_unique<Part>(request_, request_.rays->sample));
        return;
    }
    culler_ = std::make_unique<culling::Culler>(*scene);
    if (scene->pixels() > most_kept) return;
    const study::Bands bands(*scene);
    for (std::size_t k = 0; k < bands.size(); ++k)
        kept_.push_back(std::make_unique<Part>(request_, bands, k, *culler_));
}

Judge::Judge(const RepairRequest& request, const MovedRays& rays) : request_(request), scene_(nullptr) {
    kept_.push_back(std::visit([&](const auto& moved) { return std::make_unique<Part>(request_, moved); }, rays));
}

Judge::~Judge() = default;

std::uint64_t Judge::rays() const { return scene_ ? scene_->pixels() : kept_.front()->band.pixels(); }

void Judge::each_part(const std::function<void(const Part&)>& act) {
    for (const auto& part : kept_) act(*part);
    if (!kept_.empty()) return;
    const study::Bands bands(*scene_);
    for (std::size_t k = 0; k < bands.size(); ++k) act(Part(request_, bands, k, *culler_));
}

std::vector<RowQuality> Judge::quality_of(const std::vector<TestedForm>& rows, const evaluate::ShowRows& show) {
    return quality_of(rows, show, {});
}

std::vector<RowQuality> Judge::quality_of(const std::vector<TestedForm>& rows, const evaluate::ShowRows& show,
                                          const std::vector<std::unique_ptr<TapeForm>>& tapes) {
    const std::vector<const metric::Metric*> metrics = request_.requirement.metrics();
    std::vector<evaluate::FormSummary> summaries;
    for (std::size_t r = 0; r < rows.size(); ++r) summaries.emplace_back(metrics);
    each_part([&](const Part& part) {
        intersect::process::in_parallel(std::size_t{0}, rows.size(), [&](std::size_t r) {
            request_.limit.stop.check();
            const auto among = tapes.empty() ? std::nullopt : answers_among_many(*tapes[r], part.rows().inputs);
            evaluate::RowRequest asked{rows[r], metrics};
            if (show) asked.show = [&show, r](const evaluate::BandResult& band) { show(r, band); };
            if (among) asked.answers = &*among;
            measure_row(asked, part.rows(), summaries[r]);
        });
    });
    std::vector<RowQuality> all;
    for (std::size_t r = 0; r < rows.size(); ++r)
        all.push_back(choice::quality_of(summaries[r], rows[r], request_.requirement));
    return all;
}

std::vector<RowQuality> Judge::quality_of(const std::vector<Tape>& tapes) {
    std::vector<RowQuality> all;
    for (std::size_t begin = 0; begin < tapes.size(); begin += at_once) {
        const std::size_t end = std::min(begin + at_once, tapes.size());
        std::vector<std::unique_ptr<TapeForm>> forms;
        std::vector<TestedForm> rows;
        for (std::size_t k = begin; k < end; ++k) {
            forms.push_back(
                std::make_unique<TapeForm>(*request_.row.form, request_.row.format, tapes[k], "candidate", ""));
            rows.push_back(row_like(request_.row, *forms.back()));
        }
        const auto quality = quality_of(rows, {}, forms);
        all.insert(all.end(), quality.begin(), quality.end());
        tried_ += end - begin;
        request_.progress(end - begin);
    }
    return all;
}

bool is_more_accurate(const RowQuality& a, const RowQuality& b) {
    const auto bits = [](const RowQuality& w) { return std::isnan(w.kept_bits) ? -1 : w.kept_bits; };
    return a.wrong_fraction() != b.wrong_fraction() ? a.wrong_fraction() < b.wrong_fraction() : bits(a) > bits(b);
}

bool answers_as(const TestedForm& form, const Tape& tape, const RepairRequest& request, Judge& judge) {
    return compared(form, tape, request, judge).same;
}

RowQuality own_quality(const RepairRequest& request, const Tape& tape, Judge& judge) {
    const Compared both = compared(request.row, tape, request, judge);
    if (both.same) return both.quality;
    throw InputError(
        std::string(request.row.form->info->name) +
        ": its operations differ from ray to ray, because it uses more precision where a ray needs it; name a "
        "form that does the same operations for every ray");
}

std::vector<evaluate::TestedForm> catalogue_beside(const evaluate::TestedForm& row) {
    std::vector<evaluate::TestedForm> rows;
    const auto made = intersect::transform::transformed_parts_of(*row.form);
    for (const auto& form : intersect::table::catalogue()) {
        if (form.shape != row.form->shape || !form.exists_in(row.format)) continue;
        rows.push_back({made.form ? &intersect::transform::through(*made.method, form) : &form, row.format});
    }
    for (const auto& space : intersect::transform::transform_methods())
        if (made.form && &space != made.method)
            rows.push_back({&intersect::transform::through(space, *made.form), row.format});
    return rows;
}

std::vector<Ranked> ranked_catalogue(const RepairRequest& request) {
    choice::ChoiceRequest all{
        .scene = request.scene, .rows = catalogue_beside(request.row), .requirement = request.requirement};
    all.limit = request.limit;
    const auto quality = request.scene ? quality_of(all) : request.rays->quality;
    std::vector<Ranked> ranked;
    for (std::size_t k = 0; k < quality.size(); ++k) ranked.push_back({all.rows[k], quality[k]});
    std::ranges::stable_sort(ranked, is_more_accurate, &Ranked::quality);
    return ranked;
}

std::vector<choice::GrowthMargin> margins_of_tape(const RepairRequest& request, const Tape& tape) {
    choice::ChoiceRequest asked{.scene = request.scene, .rays = request.rays, .requirement = request.requirement};
    asked.limit = request.limit;
    const tape::TapeForm form(*request.row.form, request.row.format, tape, "mended", "");
    return margins_of(asked, {.form = &form.row(), .format = request.row.format}, few_rays);
}

}  // namespace lostbits::measure::repair
